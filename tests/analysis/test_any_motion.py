"""What a start settles on, by the return map of any model alone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.dynamics.geared_trains import from_outputs, moving_six
from tests.dynamics.test_geared_truth import TRUTH

from thermogear.analysis.any_motion import settle
from thermogear.analysis.walk import Search
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import Visit, return_map

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


class Fading:
    """z' = mu z: its own steps, and finer ones that know better."""

    dimension, period, unit, slowest = 1, 1.0, np.ones(1), 0.999

    def __init__(self, mu: float, finer: float | None = None) -> None:
        self.mu = mu
        if finer is not None:
            self.finer = Fading(finer)

    def determinant(self, periods: int) -> float:
        return float("nan")

    def distance(self, one: Any, other: Any) -> Any:
        return np.max(np.abs(one - other), axis=-1)

    def carry(self, start: Any, periods: int) -> Any:
        return np.multiply.outer(self.mu ** np.arange(1.0, periods + 1.0), start)

    def visit(self, start: Any, periods: int = 1, *, sampled: bool = False) -> Visit:
        return Visit(
            points=np.vstack([start[None], self.carry(start, periods)]),
            jacobian=np.array([[self.mu**periods]]),
            contact_losses=0, back_impacts=0, shares=np.zeros(3), samples=np.empty((0, 1)),
        )  # fmt: skip


@pytest.mark.parametrize(
    ("finer", "name"), [(0.9992, "period-1"), (0.9994, "undecided"), (1.001, "undecided")]
)
def test_a_multiplier_near_one_must_hold_with_finer_steps(finer: float, name: str) -> None:
    """A decay of 0.999 at rest allows 0.9992, if finer steps change it little."""
    found = settle(Fading(0.9992, finer), np.array([0.01]))
    assert found.name == name
    # far from 1 they must find it stable, too
    assert settle(Fading(0.9, 1.5), np.array([0.01])).name == "undecided"
    sure = settle(Fading(0.9, 0.9001), np.array([0.01]))
    assert (sure.name, sure.multiplier_error) == ("period-1", pytest.approx(1e-4))
    # what is printed: all within the error agree on it
    assert "|0.900|" in sure.reason
