"""Diagrams side by side, and maps computed in part."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.analysis.test_event_curve import DOUBLING

from own_pair import OWN_PAIR
from thermogear.analysis.diagram import diagram_plan
from thermogear.analysis.settle import PERIODIC
from thermogear.base.errors import InputError
from thermogear.base.plan import gather
from thermogear.base.units import RPM
from thermogear.base.vocabulary import ASSUMED
from thermogear.case.case import load_case, load_example
from thermogear.results.work import carry_out
from thermogear.study import diagrams
from thermogear.study.diagrams import case_map, whole_or_spared
from thermogear.views.pages.sweeps import bifurcations
from thermogear.views.plots.lost_contact import PARTED

SCALED = ("damping_ratio", "stiffness_amplitude", "mean_force", "force_amplitude")


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


def test_two_diagrams_side_by_side_keep_their_own_bifurcations() -> None:
    """Scaled by s in time, the equation is the same one: its flip moves by s."""
    s = 1.05
    other = DOUBLING.replace(
        thermal_stiffness=s * s - 1.0,
        **{n: s ** (1 if n == "damping_ratio" else 2) * getattr(DOUBLING, n) for n in SCALED},
    )
    for period in (1, 0):
        found = [
            gather(diagram_plan(one, "frequency", np.linspace(1.2, 1.4, 5), branch_period=period),
                   threads=1)
            for one in (DOUBLING, other)
        ]  # fmt: skip
        rows = [row for one in found for row in bifurcations(one)[1]]
        assert len(rows) == 2 * period
        if rows:
            row, scaled = rows
            assert scaled["bifurcation_value"] == pytest.approx(
                s * row["bifurcation_value"], rel=1e-9
            )
