"""What a start settles on, by the return map of any model alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from tests.dynamics.geared_trains import from_outputs, moving_six
from tests.dynamics.test_geared_truth import TRUTH

from thermogear.analysis.any_motion import Search, settle
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import return_map

BASE = TorsionalModel(
    damping_ratio=0.1535, frequency=1.245, stiffness_amplitude=0.335, mean_force=0.017,
    force_amplitude=-1.16,
)  # fmt: skip
"""A set of one mass that goes from period 2 to chaos as damping falls."""


def test_one_mass_by_the_protocol_alone() -> None:
    found = settle(return_map(BASE), np.zeros(2))
    assert (found.name, found.period) == ("period-2", 2)
    assert abs(found.multiplier) < 1.0
    assert found.away < 0.05
    wild = settle(return_map(replace(BASE, damping_ratio=0.10)), np.zeros(2), Search(cap=512))
    assert wild.name == "chaotic"
    assert abs(wild.lyapunov - 0.0488) < 0.02


def test_a_train_that_swings_in_its_bearing() -> None:
    case = TRUTH["N1"]
    model, _, _ = moving_six(case["params"])
    section = case["values"]["section"]
    found = settle(return_map(model), from_outputs(model, section["y"], section["ydot"]))
    assert (found.name, found.period) == ("period-2", 2)
    known = max(abs(complex(*one)) for one in case["values"]["multipliers_largest"])
    assert abs(abs(found.multiplier) - known) < 1e-4


def test_a_search_that_ends_too_soon_is_undecided() -> None:
    case = TRUTH["N2"]
    model, start, _ = moving_six(case["params"])
    quick = Search(first=8, cap=8, exponent=False)
    found = settle(return_map(model), start + 1e-5, quick)
    assert (found.name, found.period) == ("undecided", 0)


def test_a_motion_that_runs_away() -> None:
    model, start, _ = moving_six(TRUTH["N2"]["params"])
    wild = replace(model, damping=-50.0 * np.abs(model.damping).max() * np.eye(model.size))
    assert settle(return_map(wild), start).name == "diverged"


def test_nearing_itself_counts_where_no_orbit_is_polished() -> None:
    model, start, _ = moving_six(TRUTH["N2"]["params"])
    how = Search(first=64, cap=4096, max_period=4, polish=False, exponent=False)
    found = settle(return_map(model), start, how)
    assert (found.name, found.orbit) == ("period-2", None)
    assert found.away < 1e-6
