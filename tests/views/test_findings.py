"""What a page of a sweep says it found is in the figures, and nothing else is said."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from thermogear.views.pages.findings import SAME, finding

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
