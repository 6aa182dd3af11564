"""Five verdicts on the thesis recomputed by code of its own: by scipy, and by exact pieces.

python checks/verdicts.py [docs/trial_verdicts.md]

Nothing of the package computes the second and third column. The equation is

    x'' + 2 zeta x' + [1 + eps cos(w t) + eps_T] f(x; b') = F_m + F_h cos(w t)

with f = 0 inside the backlash. It is linear between two edges of the backlash, so a motion and its
two variations are followed from edge to edge: by ``scipy.integrate.solve_ivp`` with events, and by
the power series that solves each piece.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, newton

Floats = NDArray[np.float64]
START = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
"""(x, x') of the motion, at rest, and of its two variations."""
STEPS, ORDER = 16, 26
"""Pieces of a period at most, terms of the series of each: round-off decides."""
SETTLED = 600
"""Periods from rest after which a motion is read [1]; the slowest multiplier here is .96."""


@dataclass(frozen=True)
class Equation:
    """The numbers of the equation of motion, all dimensionless."""

    zeta: float = 0.1535
    w: float = 1.245
    eps: float = 0.335
    mean: float = 0.017
    swing: float = -1.16
    b: float = 1.0
    eps_t: float = 0.0

    @property
    def period(self) -> float:
        return 2.0 * np.pi / self.w


Period = Callable[[Equation, Floats], tuple[Floats, list[tuple[float, Callable[..., Floats]]]]]
"""State (2, 3) after a period from t = 0, and its pieces: (length, displacement over time)."""


def by_scipy(q: Equation, state: Floats) -> tuple[Floats, list[tuple[float, Callable[..., Floats]]]]:
    t, pieces = 0.0, []
    y = state.ravel()  # x, u1, u2, x', u1', u2'
    side = _side(q, state[0, 0], state[1, 0])
    while t < q.period:

        def slope(time: float, z: Floats, side: int = side) -> Floats:
            c = np.cos(q.w * time)
            stiffness = (1.0 + q.eps * c + q.eps_t) * abs(side)
            force = np.array([q.mean + q.swing * c + stiffness * side * q.b, 0.0, 0.0])
            return np.concatenate([z[3:], force - 2.0 * q.zeta * z[3:] - stiffness * z[:3]])

        edges = []
        for edge in (q.b, -q.b):
            def crossed(_: float, z: Floats, edge: float = edge) -> float:
                return float(z[0] - edge)

            crossed.terminal = True  # type: ignore[attr-defined]
            # into the backlash from its own side, out of it by either
            crossed.direction = np.sign(edge) * (-1 if side == np.sign(edge) else 1)  # type: ignore[attr-defined]
            edges.append(crossed)
        run = solve_ivp(
            slope, (t, q.period), y, method="DOP853", rtol=1e-12, atol=1e-13, events=edges,
            dense_output=True,
        )  # fmt: skip
        pieces.append((run.t[-1] - t, lambda h, s=run.sol, t=t: s(t + h)[0]))
        t, y = float(run.t[-1]), run.y[:, -1]
        side = _side(q, y[0], y[3])
    return y.reshape(2, 3), pieces


def by_pieces(q: Equation, state: Floats) -> tuple[Floats, list[tuple[float, Callable[..., Floats]]]]:
    t, pieces = 0.0, []
    side = _side(q, state[0, 0], state[1, 0])
    while t < q.period * (1.0 - 1e-14):
        series = _series(q, t, state, side)
        h = min(q.period / STEPS, q.period - t)
        x = series[:, 0].copy()
        edge = q.b * (side or (1 if x[1] > 0.0 else -1))
        cuts = []
        for wall in (q.b, -q.b) if side == 0 else (edge,):
            x[0] = series[0, 0] - wall
            grid = np.linspace(0.0, h, 9)
            out = polynomial.polyval(grid, x) * (np.sign(wall) if side == 0 else -np.sign(wall))
            for low, high, left, right in zip(grid, grid[1:], out, out[1:], strict=False):
                if right > 0.0 and (left <= 0.0):
                    cuts.append(brentq(polynomial.polyval, max(low, 1e-15), high, args=(x,), xtol=1e-15) if low else _first(x, high))
        h = min([h, *cuts])
        pieces.append((h, lambda s, c=series[:, 0]: polynomial.polyval(s, c)))
        powers = h ** np.arange(ORDER)
        state = np.stack([powers @ series, (np.arange(1, ORDER) * powers[:-1]) @ series[1:]])
        t += h
        side = _side(q, state[0, 0], state[1, 0])
    return state, pieces
