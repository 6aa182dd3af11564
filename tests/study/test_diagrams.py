"""Two diagrams side by side: which bifurcation of one is which of the other."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from tests.analysis.test_event_curve import DOUBLING
from tests.analysis.test_event_curve import FORCED as BENT

from own_pair import OWN_PAIR
from thermogear.analysis.bifurcations import FLIP, FOLD, GRAZING
from thermogear.analysis.diagram import diagram_plan
from thermogear.analysis.matched import BEYOND, JOINED, MATCHED, matches
from thermogear.analysis.settle import PERIODIC
from thermogear.base.errors import InputError
from thermogear.base.plan import gather
from thermogear.base.units import RPM
from thermogear.base.vocabulary import ASSUMED
from thermogear.case.case import load_case, load_example
from thermogear.dynamics.models import TorsionalModel
from thermogear.results.work import carry_out
from thermogear.study import diagrams
from thermogear.study.diagrams import case_map, whole_or_spared
from thermogear.views.plots.lost_contact import PARTED

SCALED = ("damping_ratio", "frequency", "stiffness_amplitude", "mean_force", "force_amplitude")


def both(
    model: TorsionalModel, other: TorsionalModel, values: Any, period: int = 1
) -> tuple[list[xr.Dataset], tuple[Any, Any]]:
    """Two diagrams over the frequency, and their families."""
    plans = [diagram_plan(one, "frequency", values, branch_period=period) for one in (model, other)]
    return [gather(plan, threads=1) for plan in plans], (plans[0].family, plans[1].family)


def test_a_bifurcation_is_matched_by_following_it_not_by_its_order() -> None:
    """Scaled by s in time, the equation is the same one: the flip and the fold move by s.

    The flip's partner lies outside the range, and another flip inside it where it was: by their
    order, and by the least way, the two would be a pair.
    """
    s = 1.05
    model = DOUBLING
    other = model.replace(
        thermal_stiffness=s * s - 1.0,
        **{n: s ** (1 if n == "damping_ratio" else 2) * getattr(model, n) for n in SCALED
           if n != "frequency"},
    )  # fmt: skip
    data, families = both(model, other, np.linspace(1.2, 1.4, 5))
    (row,) = matches(*data, families)
    assert (row["kind"], row["period"], row["partner"], row["drawn"]) == (FLIP, 1, MATCHED, True)
    assert row["other"] == pytest.approx(s * row["one"], rel=1e-9)
    back = matches(*data[::-1], families[::-1])
    assert [back[0]["one"], back[0]["other"]] == pytest.approx([row["other"], row["one"]])

    data, families = both(model, other, np.linspace(1.26, 1.31, 5))
    (row,) = matches(*data, families)
    left = (1.31 - row["one"]) / ((s - 1.0) * row["one"])
    assert (row["other"], row["partner"]) == (None, BEYOND)
    assert row["share"] == pytest.approx(left, abs=0.05)


def test_folds_that_meet_on_the_way_have_no_partner() -> None:
    """Damping closes a bent resonance: both its folds end in one cusp, at one share of the way."""
    data, families = both(BENT, BENT.replace(damping_ratio=0.12), np.linspace(0.4, 1.1, 8))
    rows = [row for row in matches(*data, families, most=2) if row["kind"] == FOLD]
    assert [row["partner"] for row in rows] == [JOINED]
    (low, high) = sorted((rows[0]["one"], rows[0]["met"]))
    folds = data[0]["bifurcation_value"].values[data[0]["bifurcation_kind"].values == 0]
    assert [low, high] == pytest.approx(sorted(folds), rel=1e-9)
    assert rows[0]["other"] is None
    assert 0.0 < rows[0]["share"] < 1.0


def test_a_diagram_against_itself_moves_nothing() -> None:
    """Grazings too; what the other diagram has not drawn is said to be so."""
    plan = diagram_plan(BENT, "frequency", np.linspace(0.4, 1.1, 8), branch_period=1)
    data, families = [gather(plan, threads=1)] * 2, (plan.family, plan.family)
    rows = matches(*data, families)
    assert {FOLD, GRAZING} <= {row["kind"] for row in rows}
    assert {row["partner"] for row in rows} == {MATCHED}
    assert max(abs(row["one"] - row["other"]) for row in rows) < 1e-9
    bare = data[1].drop_isel(bifurcation=range(data[1].sizes["bifurcation"]))
    undrawn = matches(data[0], bare, families)
    assert [row["drawn"] for row in undrawn] == [False] * len(rows)
    few = matches(*data, families, most=1)
    assert [row["why"] for row in few if row["why"]] == [few[-1]["why"]] * (len(few) - 1)


PAIRS = (
    # teeth, shift, pressure angle, temperature of the teeth, torque
    ((19, 47), 0.3, 25, 90, 80),
    ((53, 53), 0.0, 20, 60, 20),
    ((24, 31), 0.1, 20, 120, 200),
    ((17, 61), 0.4, 20, 40, 30),
    ((38, 41), -0.1, 14.5, 100, 150),
    ((29, 35), 0.2, 17.5, 70, 60),
)


@pytest.mark.parametrize("place", range(len(PAIRS)))
def test_a_map_computed_in_part_says_no_more_than_the_whole_one(place: int) -> None:
    """Same numbers where both are computed; a periodic motion that is computed has all numbers."""
    (z1, z2), shift, angle, hot, torque = PAIRS[place]
    text = OWN_PAIR
    for old, new in (
        ("teeth = 19", f"teeth = {z1}"), ("teeth = 47", f"teeth = {z2}"),
        ("profile_shift = 0.3", f"profile_shift = {shift}"), ("25 deg", f"{angle} deg"),
        ("90 degC", f"{hot} degC"), ("80 N m", f"{torque} N m"),
    ):  # fmt: skip
        text = text.replace(old, new)
    case = load_case(text)
    axes = {
        "pinion_speed": np.linspace(2000.0, 12000.0, 9) * RPM,
        "damping_ratio": np.linspace(0.02, 0.08, 5),
    }
    whole = gather(case_map(case, axes), threads=1)
    some = gather(case_map(case, axes, refine=True), threads=1)
    assumed = some["status"].values == ASSUMED
    for name, values in some.data_vars.items():
        there, every = values.values, whole[name].values
        assert np.array_equal(there[~assumed], every[~assumed], equal_nan=True), name
        if name not in ("label", "period", "status"):
            assert np.isnan(there[assumed]).all()
    assert not (whole["status"].values == ASSUMED).any()
    periodic = (whole["status"].values == 0) & (whole["label"].values == PERIODIC)
    for name, values in whole.data_vars.items():
        assert np.isfinite(values.values[periodic]).all(), name
    moves = whole["status"].values == 0
    # the share in contact is known of every motion, chaos too, and the losses are its witness
    assert np.isfinite(whole["drive_share"].values[moves]).all()
    parts = whole["drive_share"].values[periodic] < 1.0 - PARTED
    assert np.array_equal(parts, whole["contact_losses"].values[periodic] > 0)


@pytest.mark.parametrize("limit", [0.0, 1e9])
def test_a_map_goes_on_as_it_was_begun_whatever_the_next_estimate_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: float
) -> None:
    axes = {"damping_ratio": [0.1, 0.2], "frequency": [0.5, 0.6]}
    plan = case_map(load_example("table-4.2"), axes)
    monkeypatch.setattr(diagrams, "WHOLE", limit)
    begun, told = whole_or_spared(plan, tmp_path / "m", threads=1)
    assert begun == (plan if limit else plan.sparing())
    # of all points, or of the middle between 3 of 3 x 3 and all of them
    assert told is not None
    assert (begun.visited, plan.visited) == (1.0, 1.0)
    first = carry_out(begun, tmp_path / "m", threads=1)
    monkeypatch.setattr(diagrams, "WHOLE", 1e9 - limit)
    again, _ = whole_or_spared(plan, tmp_path / "m", threads=1)
    assert again == begun
    assert carry_out(again, tmp_path / "m", threads=1).identical(first)
    (tmp_path / "file").touch()
    assert whole_or_spared(plan, tmp_path / "file", threads=1)[0] != begun  # refused later
    if limit:
        return
    with pytest.raises(InputError, match="refine: got false; allowed true; the store"):
        carry_out(plan, tmp_path / "m", threads=1)


def test_diagrams_without_branches_have_no_points_that_moved():
    """A KeyError ended the command line with --against and --branch-period 0."""
    data, families = both(BENT, BENT, np.linspace(0.4, 1.1, 2), period=0)
    assert matches(*data, families) == []
