"""The return map of a smooth model: a derivative, its matrix by the state, and a period."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics.return_map import IteratedMap

LEAST_TOLERANCE = 2.5e-14
"""Smallest relative tolerance of the integration; below it rounding decides."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SmoothModel(IteratedMap):
    """y' = f(t, y), f of ``period`` [model's unit of time] in t; a state has any length d >= 1.

    ``derivative`` f(t, y) -> (d,), ``jacobian`` df/dy(t, y) -> (d, d). ``unit`` (d,) the scales of
    a state, in which distances and tolerances are measured. ``divergence`` the trace of df/dy where
    it is the same everywhere, else nan; it is believed. ``tolerance`` of the integration (DOP853,
    of a state in its scales and relative). An autonomous f is taken with any period. It is its own
    return map, with the variational equations Y' = df/dy Y. To vary a number in f, make it from the
    fields of a frozen dataclass, in its method ``return_map``.

    Raises InputError for a period, a scale or a tolerance that is not positive and finite.

    >>> model = SmoothModel(
    ...     derivative=lambda t, y: -y, jacobian=lambda t, y: -np.eye(1), period=1.0, unit=[1.0]
    ... )
    >>> model.visit(np.ones(1)).points[-1].round(6)
    array([0.367879])
    """

    derivative: Callable[[float, Floats], Floats]
    jacobian: Callable[[float, Floats], Floats]
    period: float
    unit: Floats
    divergence: float = float("nan")
    tolerance: float = 1e-12

    def __post_init__(self) -> None:
        unit = np.array(self.unit, dtype=float)
        if unit.ndim != 1 or unit.size == 0 or not np.all(np.isfinite(unit) & (unit > 0.0)):
            raise InputError("unit", unit.tolist(), allowed="scales > 0, finite, shape (d,)")
        object.__setattr__(self, "unit", unit)
        if not 0.0 < self.period < np.inf:
            raise InputError("period", self.period, allowed="> 0, finite")
        if not LEAST_TOLERANCE <= self.tolerance < 1.0:
            allowed = f"from {LEAST_TOLERANCE} to below 1"
            raise InputError("tolerance", self.tolerance, allowed=allowed)

    def determinant(self, periods: int) -> float:
        """det D P^n = exp(n T tr df/dy) where the trace is the same everywhere, else nan."""
        return float(np.exp(self.divergence * self.period * periods))

    def carry(self, start: Floats, periods: int) -> Floats:
        """The states (periods, d) after 1, 2, ... periods from ``start``."""
        states = np.empty((periods, self.dimension))
        for number in range(periods):
            start = states[number] = self._integrated(np.asarray(start, dtype=float))
        return states

    def iterate(self, state: Floats) -> tuple[Floats, Floats]:
        """The state one period later, and its Jacobian (d, d)."""
        d = self.dimension
        end = self._integrated(np.concatenate([state, np.eye(d).ravel()]))
        return end[:d], end[d:].reshape(d, d)

    def _integrated(self, begin: Floats) -> Floats:
        """A state (d,), alone or with its tangents row by row behind it, one period later."""
        d = self.dimension

        def rates(t: float, whole: Floats) -> Floats:
            slope = np.asarray(self.derivative(t, whole[:d]), dtype=float)
            if whole.size == d:
                return slope
            turned = self.jacobian(t, whole[:d]) @ whole[d:].reshape(d, d)
            return np.concatenate([slope, turned.ravel()])

        scale = np.append(self.unit, np.repeat(self.unit, d))[: begin.size]
        path = solve_ivp(
            rates, (0.0, self.period), begin, method="DOP853", rtol=self.tolerance,
            atol=self.tolerance * scale, t_eval=[self.period],
        )  # fmt: skip
        if not (path.success and np.all(np.isfinite(path.y))):
            raise ConvergenceError(
                "the integration of a smooth model does not reach the end of its period: "
                f"{path.message}"
            )
        return np.asarray(path.y[:, -1])
