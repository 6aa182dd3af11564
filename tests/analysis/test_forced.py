"""Motions under forces that never come again: maps whose conditional exponent is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import Compared
from thermogear.analysis.forced import BATCHES, BESIDE, LENGTHS, RENEWED, ROUND, settle_forced
from thermogear.base.errors import ConvergenceError

Floats = NDArray[np.float64]
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
STARTS = np.array([[0.3, 0.1], [-0.8, 0.4]])


@dataclass(frozen=True)
class Driven:
    """x -> f(x + cos(2 pi golden n))."""

    step: Callable[[Floats], Floats]
    period: float = 0.25
    runs_away: int = 10**9

    @property
    def unit(self) -> Floats:
        return np.ones(2)

    def carry(self, start: Floats, periods: int, *, turn: int) -> Floats:
        found, x = [], start
        for n in range(turn, turn + periods):
            if n > self.runs_away:
                raise ConvergenceError("it runs away")
            x = self.step(x + np.cos(2.0 * np.pi * GOLDEN * n))
            found.append(x)
        return np.array(found)


def linear(matrix: Floats) -> Driven:
    return Driven(lambda x: matrix @ x)


def turning(size: float, angle: float) -> Floats:
    """Eigenvalues size e^(+-i angle), in a plane ten times as long as wide."""
    cos, sin = np.cos(angle), np.sin(angle)
    return size * np.array([[cos, -10.0 * sin], [0.1 * sin, cos]])


def test_a_linear_map_has_its_greatest_eigenvalue(compared: Compared) -> None:
    """Real ones, and pairs that turn slowly or fast: seed 83."""
    rng = np.random.default_rng(83)
    away = []
    for _ in range(20):
        size = rng.uniform(0.6, 0.985)
        matrix = turning(size, rng.uniform(0.1, 3.0))
        if rng.integers(2):
            spread = np.eye(2) + rng.uniform(-0.4, 0.4, (2, 2))
            matrix = spread @ np.diag([size, 0.8 * size]) @ np.linalg.inv(spread)
        found = settle_forced(linear(matrix), STARTS, cap=4000)
        assert found.name == "settled", found.reason
        away.append((found.lyapunov * 0.25 - np.log(size)) / (found.lyapunov_error * 0.25))
    compared("conditional exponent of a linear map, over its stated error",
             "ln |greatest eigenvalue|", away, 4.0)  # fmt: skip


def test_what_neither_grows_nor_decays_is_undecided() -> None:
    found = settle_forced(linear(turning(1.0, 0.7)), STARTS, cap=4 * ROUND)
    assert found.name == "undecided"
    assert abs(found.lyapunov) < 4.0 * found.lyapunov_error
    assert found.discarded == 4 * ROUND + BATCHES * RENEWED * sum(LENGTHS)


def test_a_folded_line_is_chaotic(compared: Compared) -> None:
    """The tent map stretches by 2 whatever drives it: ln 2 a period.

    A fold lies between motion and companion with a chance of twice their distance d, in either
    component, and takes ln |1 - 2 u|, -1 in the mean: 30 d of four periods together at most.
    """
    tent = Driven(lambda x: np.abs(2.0 * x - 2.0 * np.round(x)))
    found = settle_forced(tent, STARTS, cap=2 * ROUND)
    assert found.name == "chaotic"
    compared("conditional exponent of the tent map", "ln 2",
             found.lyapunov * 0.25 / np.log(2.0) - 1.0,
             30.0 * BESIDE / (RENEWED * np.log(2.0)))  # fmt: skip


def test_two_motions_are_told_apart() -> None:
    """Two wells: each start stays in its own, and both decay."""
    wells = Driven(lambda x: 0.5 * (x + np.sign(x) * 40.0))
    found = settle_forced(wells, STARTS + np.array([[40.0], [-40.0]]), cap=2 * ROUND)
    assert found.name == "undecided"
    assert found.lyapunov < 0.0
    assert "apart" in found.reason
    same = settle_forced(wells, STARTS + 40.0, cap=2 * ROUND)
    assert same.name == "settled"


@pytest.mark.parametrize("when", [5, ROUND + 40])
def test_a_motion_that_runs_away_has_diverged(when: int) -> None:
    away = Driven(lambda x: 0.5 * x, runs_away=when)
    assert settle_forced(away, STARTS, cap=2 * ROUND).name == "diverged"
