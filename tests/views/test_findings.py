"""What a page of a sweep says it found is in the figures, and nothing else is said."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from thermogear.base.vocabulary import ASSUMED
from thermogear.views.pages.findings import SAME, finding
from thermogear.views.picture import Field, Hatch
from thermogear.views.plots.lost_contact import map_picture
from thermogear.views.plots.parameters import parameter_of, shown

RPM = 2.0 * np.pi / 60.0


def two_ways(apart: list[int], undecided: int = 0) -> xr.Dataset:
    speeds = np.arange(3000.0, 4000.0, 100.0) * RPM
    label, period = np.ones((2, speeds.size), int), np.ones((2, speeds.size), int)
    period[1, apart] = 2
    label[0, :undecided] = 0
    dims = ("direction", "pinion_speed")
    return xr.Dataset(
        {"label": (dims, label), "period": (dims, period)}, {"pinion_speed": speeds},
        {"kind": "diagram", "parameter": "pinion_speed"},
    )  # fmt: skip


@pytest.mark.parametrize("apart", [[], [4], [2, 3, 4]])
def test_where_up_and_down_differ_is_said_with_its_ends(apart: list[int]) -> None:
    data = two_ways(apart)
    rpm = np.round(data["pinion_speed"].values / RPM)
    here = rpm[(data["period"].values[0] != data["period"].values[1])]
    said = finding(data)
    if not here.size:
        assert SAME in said
        return
    assert f"{here.min():.0f}" in said
    assert f"{here.max():.0f} rpm" in said


@pytest.mark.parametrize("name", ["dte_peak_to_peak", "point_x"])
def test_two_orbits_of_one_period_are_two_motions(name: str) -> None:
    """A fold leaves period 1 both ways; what differs is the orbit."""
    data = two_ways([])
    values = np.ones((2, data.sizes["pinion_speed"]))
    same = data.assign({name: (data["label"].dims, values)})
    assert SAME in finding(same)
    values[1, 3:6] = 1.4
    said = finding(data.assign({name: (data["label"].dims, values)}))
    assert "3300 to 3500 rpm" in said


def test_undecided_points_are_counted() -> None:
    data = two_ways([], undecided=3)
    count, total = int((data["label"] == 0).sum()), data["label"].size
    assert f"{count} of {total} points are undecided" in finding(data)
    assert "undecided" not in finding(two_ways([]))


def test_what_a_map_assumes_is_told_apart_from_what_it_computed() -> None:
    label, status = np.ones((3, 4), int), np.zeros((3, 4), int)
    period = np.array([[1, 1, 1, 2]] * 3)
    status[1] = ASSUMED
    dims = ("frequency", "mean_force")
    variables = {"label": label, "period": period, "status": status}
    data = xr.Dataset({n: (dims, v) for n, v in variables.items()}, attrs={"kind": "map"})
    said = (
        "Of 12 points 8 were computed: period 1 at 6, period 2 at 2; equal neighbours speak for "
        "the others, which are assumed and not computed: period 1 at 3, period 2 at 1."
    )
    assert finding(data) == said
    every = data.assign(status=(dims, np.zeros((3, 4), int)))
    said = "Of 12 points: period 1 at 9, period 2 at 3."
    assert finding(every) == said


def test_a_map_draws_what_loses_contact_and_hatches_what_is_assumed() -> None:
    """Each cell has the colour of its own motion; a cell is hatched between its own borders."""
    share = {"drive_share": [[1.0, 0.9, 0.5], [1.0 - 1e-16, np.nan, 1.0]],
             "back_share": [[0.0, 0.0, 0.1], [0.0, np.nan, 0.0]]}  # fmt: skip
    whole = {"label": np.ones((2, 3), int), "period": np.ones((2, 3), int)}
    status = np.array([[0, 0, 0], [0, ASSUMED, 0]])
    data = xr.Dataset(
        {n: (("x", "y"), np.array(v)) for n, v in (share | whole | {"status": status}).items()},
        {"x": [1.0, 2.0], "y": [0.0, 1.0, 2.0]},
    )
    ((regime, teeth),) = map_picture(data).panels
    (colours,) = [mark for mark in teeth.marks if isinstance(mark, Field)]
    words = [[colours.classes[int(code)] for code in row] for row in np.asarray(colours.values).T]
    always, parts, hit, unknown = (
        "teeth always in contact", "drive flank parts", "drive flank parts, back flank is hit",
        "not known",
    )  # fmt: skip
    assert words == [[always, parts, hit], [always, unknown, always]]
    for panel in (regime, teeth):
        (hatch,) = [mark for mark in panel.marks if isinstance(mark, Hatch)]
        held = np.asarray(hatch.values).T > 0.5
        assert np.unique(np.asarray(hatch.x)[held.any(axis=1)]).tolist() == [1.5, 2.5]
        assert np.unique(np.asarray(hatch.y)[held.any(axis=0)]).tolist() == [0.5, 1.5]
    none = map_picture(data.assign(status=(("x", "y"), np.zeros((2, 3), int))))
    assert not any(isinstance(m, Hatch) for row in none.panels for p in row for m in p.marks)


@pytest.mark.parametrize("shares", [[1.0], [0.7, 0.3]])
def test_basins_say_how_many_attractors_and_their_shares(shares: list[float]) -> None:
    data = xr.Dataset(
        {
            "attractor_period": ("attractor_number", np.arange(1, len(shares) + 1)),
            "fraction": ("attractor_number", shares),
        },
        attrs={"kind": "basins"},
    )
    said = finding(data)
    assert said.startswith("One attractor" if len(shares) == 1 else f"{len(shares)} attractors")
    assert all(f"{100 * share:.0f}" in said for share in shares)


def test_a_range_without_any_motion_is_said_to_have_none() -> None:
    data = two_ways([])
    data["label"][:] = 4
    assert finding(data).startswith("No value has a motion")


@pytest.mark.parametrize(
    ("name", "unit", "value", "told"),
    [
        ("bearings.0.play", "m", 12e-6, (12.0, "µm")),
        ("temperatures.pinion_bore_below_addendum", "K", 20.0, (20.0, "K")),
        ("temperatures.housing", "K", 293.15, (20.0, "°C")),
        ("train.modal_ratio", "1", 0.01, (0.01, "")),
        ("rpm", "rad/s", 100.0 * RPM, (100.0, "rpm")),
    ],
)
def test_a_dotted_field_is_shown_by_the_unit_it_is_stored_in(
    name: str, unit: str, value: float, told: tuple[float, str]
) -> None:
    stored = xr.DataArray([value], attrs={"units": unit})
    assert shown(name, stored) == pytest.approx([told[0]])
    assert parameter_of(name, stored).shown == told[1]
