"""A drive train with flanks and ring bearings by scipy's DOP853, restarted at contact changes.

Independent of the package's engine: between two changes every contact is held as it is, so that
the right side is smooth, and the change is located on the step's dense output. Slow and
accurate to about 1e-12 of the motion.

M q'' + C q' + K q = f0 - F_d g_d + c_m e' g_d - F_b g_b + F_d (chi_0 p_0 + chi_1 p_1) + rings,
F_d = k <g_d.q - e - b>+,  F_b = k <g_b.q + e - b>+,  ring: -k_b <|u| - c>+^n u/|u| on u = D^T q;
C holds c_m g_d g_d^T. Phase 0 at t = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq

from thermogear.base.excitation import Periodic

Floats = NDArray[np.float64]

INSIDE = np.linspace(0.0, 1.0, 9)
"""Where in a step the contacts are looked at."""
BESIDE = 1e-12
"""Distance from a border of pieces, in periods, at which its one side is asked."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Ring:
    """A bearing with clearance: ``directions`` (n, 2), k_b [N/m^n], n, radial clearance c [m]."""

    directions: Floats
    coefficient: float
    exponent: float = 1.0
    clearance: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Plain:
    """The equation's arrays, without the rigid rotation; ``mesh_frequency`` [Hz], else SI."""

    mass: Floats
    damping: Floats
    stiffness: Floats
    force: Floats
    drive: Floats
    back: Floats
    mesh_stiffness: Periodic
    error: Periodic
    half_backlash: float
    mesh_damping: float
    mesh_frequency: float
    bearings: tuple[Ring, ...] = ()
    friction: Floats | None = None
    friction_at_pitch: Any = None
    friction_per_metre: Any = None


@dataclass(eq=False)
class Reference:
    """The motion of ``plain`` (or whatever has its fields) from a state (q, q')."""

    plain: Any
    rtol: float = 1e-12
    changes: list[tuple[float, int]] = field(default_factory=list)
    """(time, contact) of every change so far: 0 drive flank, 1 back flank, then the bearings."""

    def __post_init__(self) -> None:
        p = self.plain
        self.to_q = np.linalg.inv(np.linalg.cholesky(p.mass)).T
        t = self.to_q
        self.size = t.shape[0]
        self.linear = -np.hstack([t.T @ p.stiffness @ t, t.T @ p.damping @ t])
        self.force = t.T @ p.force
        rows = [p.drive, p.back, *(row for one in p.bearings for row in one.directions.T)]
        rows = np.stack(rows) @ t
        self.outputs = rows
        pushes = rows * np.r_[-1.0, -1.0, np.ones(len(rows) - 2)][:, None]
        if p.friction is not None:
            pushes = np.vstack([pushes, np.asarray(p.friction) @ t])
        self.pushes = pushes.T.copy()
        self.period = 1.0 / p.mesh_frequency
        self.k, self.e = (np.r_[f.mean, f.harmonics] for f in (p.mesh_stiffness, p.error))
        self.turns = 2j * np.pi * p.mesh_frequency * np.arange(max(self.k.size, self.e.size))
        self.ring = np.array([[b.coefficient, b.exponent, b.clearance] for b in p.bearings])
        self.ring = self.ring.reshape(-1, 3)
        self.window = (-np.inf, np.inf)

    def _periodic(self, t: float) -> tuple[float, float, float]:
        """k, e and e' at a time."""
        wave = np.exp(self.turns * t)
        e = self.e * wave[: self.e.size]
        rate = float((e * self.turns[: self.e.size]).sum().real)
        return float((self.k * wave[: self.k.size]).sum().real), float(e.sum().real), rate

    def gaps(self, t: float, x: Floats) -> Floats:
        """Depth of every contact [m], > 0 where it is closed, of a state in own coordinates."""
        _, e, _ = self._periodic(t)
        y = self.outputs @ x[: self.size]
        b = self.plain.half_backlash
        radius = np.hypot(y[2::2], y[3::2]) - self.ring[:, 2]
        return np.r_[y[0] - e - b, y[1] + e - b, radius]

    def _rate(self, closed: NDArray[np.bool_]) -> Any:
        p, n = self.plain, self.size
        b, c = p.half_backlash, p.mesh_damping
        clearance = self.ring[:, 2]
        stiff, exponent = np.where(closed[2:], self.ring[:, 0], 0.0), self.ring[:, 1]
        straight = bool(np.all(exponent == 1.0))
        loads = np.zeros(self.pushes.shape[1])
        rings = slice(2, 2 + 2 * closed[2:].size)

        def rate(t: float, x: Floats) -> Floats:
            k, e, slope = self._periodic(t)
            y = self.outputs @ x[:n]
            drive = k * (y[0] - e - b) if closed[0] else 0.0
            loads[0] = drive - c * slope
            loads[1] = k * (y[1] + e - b) if closed[1] else 0.0
            if clearance.size:
                u = y[2:].reshape(-1, 2)
                r = np.sqrt(u[:, 0] ** 2 + u[:, 1] ** 2)
                deep = r - clearance
                if not straight:
                    deep = np.maximum(deep, 0.0) ** exponent
                per = np.divide(stiff * deep, r, out=np.zeros_like(r), where=closed[2:])
                loads[rings] = (-per[:, None] * u).ravel()
            if p.friction is not None:
                turn = min(max(t, self.window[0]), self.window[1]) / self.period
                loads[-2] = drive * float(p.friction_at_pitch(turn))
                loads[-1] = drive * float(p.friction_per_metre(turn))
            return np.concatenate([x[n:], self.force + self.linear @ x + self.pushes @ loads])

        return rate

    def _borders(self, start: float, end: float) -> Floats:
        """Times in (start, end) at which the friction's pieces begin."""
        phases = {0.0} if self.plain.friction is not None else set()
        for one in (self.plain.friction_at_pitch, self.plain.friction_per_metre):
            phases |= set(getattr(one, "starts", ()))
        first, last = int(start // self.period), int(end // self.period) + 1
        every = [(i + p) * self.period for i in range(first, last + 1) for p in phases]
        slack = BESIDE * self.period
        return np.array(sorted(t for t in every if start + slack < t < end - slack))

    def states(self, state: ArrayLike, times: ArrayLike) -> Floats:
        """(q, q') at ``times`` [s], rising, (times, 2n); the first belongs to ``state``."""
        n, t = self.size, np.asarray(times, dtype=float)
        given = np.asarray(state, dtype=float)
        x = np.r_[np.linalg.solve(self.to_q, given[:n]), np.linalg.solve(self.to_q, given[n:])]
        size, speed = np.abs(x[:n]).max(), np.abs(x[n:]).max()
        speed = max(speed, 1e-2 * size / self.period)
        self.atol = 0.1 * self.rtol * np.r_[np.full(n, size), np.full(n, speed)]
        closed, step = self.gaps(t[0], x) > 0.0, self.period / 200.0
        found = [given]
        for start, end in pairwise(t):
            marks = np.r_[start, self._borders(start, end), end]
            for low, high in pairwise(marks):
                beside = BESIDE * self.period
                self.window = (low + beside, high - beside)
                x, closed, step = self._advance(low, high, x, closed, step)
            found.append(np.r_[self.to_q @ x[:n], self.to_q @ x[n:]])
        return np.array(found)

    def _advance(
        self, t: float, end: float, x: Floats, closed: NDArray[np.bool_], step: float
    ) -> tuple[Floats, NDArray[np.bool_], float]:
        while t < end:
            rate = self._rate(closed)
            solver = self._solver(rate, t, end, x, step)
            changed = None
            while solver.status == "running" and changed is None:
                before = solver.y.copy()
                solver.step()
                if solver.status == "failed":
                    raise RuntimeError(f"step too small at {t}")
                changed = self._change(solver, closed)
            step = solver.step_size if solver.t < end else max(step, solver.step_size)
            if changed is None:
                return solver.y, closed, step
            when, which = changed
            if when > solver.t_old:
                again = self._solver(rate, solver.t_old, when, before, when - solver.t_old)
                while again.status == "running":
                    again.step()
                before = again.y
            t, x = when, before
            closed = closed.copy()
            closed[which] = ~closed[which]
            self.changes.append((when, which))
        return x, closed, step

    def _solver(self, rate: Any, t: float, end: float, x: Floats, step: float) -> DOP853:
        first = min(step, end - t)
        return DOP853(rate, t, x, end, rtol=self.rtol, atol=self.atol, first_step=first)

    def _change(self, solver: DOP853, closed: NDArray[np.bool_]) -> tuple[float, int] | None:
        """The first time at which a contact is no longer as it is held, and which it is."""
        dense = solver.dense_output()
        times = solver.t_old + INSIDE * (solver.t - solver.t_old)
        gaps = np.array([self.gaps(t, dense(t)) for t in times])
        wrong = (gaps > 0.0) != closed
        first = np.flatnonzero(wrong[1:].any(axis=1))
        if not first.size:
            return None
        at = int(first[0]) + 1
        found: list[tuple[float, int]] = []
        for one in np.flatnonzero(wrong[at]):
            low, high = times[at - 1], times[at]
            if wrong[at - 1, one]:
                found.append((low, int(one)))
                continue
            root = brentq(
                lambda t, one=one: self.gaps(t, dense(t))[one], low, high, xtol=1e-18, rtol=1e-15
            )
            found.append((float(root), int(one)))
        return min(found)

    def after(self, state: ArrayLike, periods: int = 1) -> Floats:
        """(q, q') after so many mesh periods from phase 0."""
        return self.states(state, [0.0, periods * self.period])[-1]


def closing(plain: Any, state: ArrayLike, periods: int = 1, *, rounds: int = 6) -> Floats:
    """The periodic motion near ``state`` by Newton's method on differences, (2n,) at phase 0."""
    x = np.asarray(state, dtype=float)
    n = x.size // 2
    for _ in range(rounds):
        reference = Reference(plain)
        end = reference.after(x, periods)
        size = np.r_[np.full(n, np.abs(x[:n]).max()), np.full(n, np.abs(x[n:]).max())]
        if np.all(np.abs(end - x) < 1e-12 * size):
            break
        columns = []
        for i in range(2 * n):
            moved = x.copy()
            moved[i] += 1e-6 * size[i]
            columns.append((Reference(plain).after(moved, periods) - end) / (1e-6 * size[i]))
        x = x + np.linalg.solve(np.eye(2 * n) - np.stack(columns, axis=1), end - x)
    return x
