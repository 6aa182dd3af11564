"""The return map of a smooth model: a derivative, its matrix by the state, and a period."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from thermogear.base.arrays import Floats
from thermogear.base.bounds import whole
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics.return_map import Stretch, Visit

LEAST = 2.5e-14
"""Smallest relative tolerance of the integration; below it rounding decides."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SmoothModel:
    """y' = f(t, y), f of ``period`` [model's unit of time] in t; a state has any length d >= 1.

    ``derivative`` f(t, y) -> (d,), ``jacobian`` df/dy(t, y) -> (d, d). ``unit`` (d,) the scales of
    a state, in which distances and tolerances are measured. ``divergence`` the trace of df/dy where
    it is the same everywhere, else nan; it is believed. ``tolerance`` of the integration (DOP853,
    of a state in its scales and relative). An autonomous f is taken with any period.

    Raises InputError for a period, a scale or a tolerance that is not positive and finite.

    >>> model = SmoothModel(
    ...     derivative=lambda t, y: -y, jacobian=lambda t, y: -np.eye(1), period=1.0, unit=[1.0]
    ... )
    >>> model.return_map().visit(np.ones(1)).points[-1].round(6)
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
        if not LEAST <= self.tolerance < 1.0:
            raise InputError("tolerance", self.tolerance, allowed=f"from {LEAST} to below 1")

    @property
    def dimension(self) -> int:
        """Length of a state."""
        return int(self.unit.size)

    def return_map(self, samples: int = 0) -> SmoothMap:
        """Its return map; ``samples`` a period of what a visit records."""
        return SmoothMap(self, samples)


class SmoothMap:
    """P of a :class:`SmoothModel`, with its variational equations Y' = df/dy Y."""

    def __init__(self, model: SmoothModel, samples: int = 0) -> None:
        self.model = model
        self.recorded = whole("samples", samples, least=0)
        self.period = model.period
        self.unit = model.unit

    @property
    def dimension(self) -> int:
        """Length of a state."""
        return self.model.dimension

    def determinant(self, periods: int) -> float:
        """det D P^n = exp(n T tr df/dy) where the trace is the same everywhere, else nan."""
        return float(np.exp(self.model.divergence * self.period * periods))

    def distance(self, one: Floats, other: Floats) -> Floats:
        """Largest component of the difference in units of ``unit``, over leading axes."""
        return np.asarray(np.max(np.abs(one - other) / self.unit, axis=-1))

    def carry(self, start: Floats, periods: int) -> Floats:
        """The states (periods, d) after 1, 2, ... periods from ``start``."""
        out = np.empty((periods, self.dimension))
        state = np.asarray(start, dtype=float)
        for number in range(periods):
            state = out[number] = self._over(state, 0)[0]
        return out

    def stretch(self, start: Floats, *, direction: Floats, periods: int) -> Stretch:
        """Carry ``start`` and a tangent vector ``direction``, made unit after every period."""
        state = np.asarray(start, dtype=float)
        along = np.asarray(direction, dtype=float) / self.unit
        along = along / np.linalg.norm(along)
        growth = np.zeros(periods)
        for number in range(periods):
            state, tangent, _ = self._over(state, 1, (along * self.unit)[:, None])
            along = tangent[:, 0] / self.unit
            size = float(np.linalg.norm(along))
            growth[number], along = np.log(size), along / size
        return Stretch(state=state, direction=along * self.unit, growth=growth)

    def visit(self, start: Floats, periods: int = 1, *, sampled: bool = False) -> Visit:
        """Run ``periods`` periods from ``start`` with the variational equations.

        A smooth model knows of no contact: no losses, no impacts, ``shares`` nan.
        """
        d = self.dimension
        points = np.empty((periods + 1, d))
        points[0] = start
        tangent = np.eye(d)
        samples = []
        for number in range(periods):
            points[number + 1], tangent, seen = self._over(points[number], d, tangent, sampled)
            samples.append(seen)
        return Visit(
            points=points,
            jacobian=tangent,
            contact_losses=0,
            back_impacts=0,
            shares=np.full(3, np.nan),
            samples=np.concatenate(samples) if samples else np.empty((0, d)),
        )

    def _over(
        self, state: Floats, columns: int, tangent: Floats | None = None, sampled: bool = False
    ) -> tuple[Floats, Floats, Floats]:
        """One period on: the state, its tangents (d, columns), what was recorded on the way."""
        d, model = self.dimension, self.model

        def rates(t: float, whole_state: Floats) -> Floats:
            y = whole_state[:d]
            slope = np.asarray(model.derivative(t, y), dtype=float)
            if not columns:
                return slope
            turned = model.jacobian(t, y) @ whole_state[d:].reshape(d, columns)
            return np.concatenate([slope, turned.ravel()])

        begin = np.asarray(state, dtype=float)
        if tangent is not None:
            begin = np.concatenate([begin, tangent.ravel()])
        scale = np.concatenate([self.unit, np.repeat(self.unit, columns)])
        count = self.recorded if sampled else 0
        found = solve_ivp(
            rates,
            (0.0, self.period),
            begin,
            method="DOP853",
            rtol=model.tolerance,
            atol=model.tolerance * scale,
            t_eval=np.append(np.arange(count) / max(count, 1), 1.0) * self.period,
        )
        end = found.y[:, -1] if found.success else np.array([np.nan])
        if not np.all(np.isfinite(end)):
            raise ConvergenceError(
                f"the integration of a smooth model does not reach the end of its period: "
                f"{found.message}"
            )
        return end[:d], end[d:].reshape(d, columns), found.y[:d, :-1].T
