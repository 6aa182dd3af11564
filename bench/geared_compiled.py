"""Fixed steps compiled with numba: classical Runge-Kutta, and the generalised-alpha method.

In coordinates of unit mass and a diagonal stiffness (all contacts open), as a careful user would
write them. Contacts are judged at every stage, no step ends at a change.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from geared_trains import modes_by_part
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Modal:
    """The arrays of a train in modes without contacts: q = ``to_q`` z."""

    to_q: Floats
    square: Floats
    damping: Floats
    force: Floats
    outputs: Floats
    rings: Floats
    k: NDArray[np.complex128]
    e: NDArray[np.complex128]
    half_backlash: float
    mesh_damping: float
    frequency: float

    @classmethod
    def of(cls, p: Any) -> Modal:
        """The modes of ``p`` without its contacts."""
        square, t = modes_by_part(p.stiffness, p.mass)
        rows = [p.drive, p.back, *(row for one in p.bearings for row in one.directions.T)]
        rings = np.array([[b.coefficient, b.exponent, b.clearance] for b in p.bearings])
        return cls(
            to_q=t,
            square=square,
            damping=t.T @ p.damping @ t,
            force=t.T @ p.force,
            outputs=np.stack(rows) @ t,
            rings=rings.reshape(-1, 3),
            k=np.r_[p.mesh_stiffness.mean, p.mesh_stiffness.harmonics].astype(complex),
            e=np.r_[p.error.mean, p.error.harmonics].astype(complex),
            half_backlash=p.half_backlash,
            mesh_damping=p.mesh_damping,
            frequency=p.mesh_frequency,
        )

    def state(self, x: Floats) -> Floats:
        """(z, z') of a state (q, q')."""
        n = self.square.size
        return np.r_[np.linalg.solve(self.to_q, x[:n]), np.linalg.solve(self.to_q, x[n:])]

    def back(self, z: Floats) -> Floats:
        """(q, q') of a state (z, z')."""
        n = self.square.size
        return np.r_[self.to_q @ z[:n], self.to_q @ z[n:]]

    def tables(self, count: int) -> Floats:
        """(3, count): k, e and e' at uniform phases of a period."""
        phase = 2j * np.pi * np.arange(count) / count
        orders = np.arange(max(self.k.size, self.e.size))
        wave = np.exp(np.outer(phase, orders))
        k = (wave[:, : self.k.size] @ self.k).real
        e = wave[:, : self.e.size] * self.e
        rate = e @ (2j * np.pi * self.frequency * orders[: self.e.size])
        return np.stack([k, e.sum(axis=1).real, rate.real])

    def constants(self) -> tuple[Any, ...]:
        """What the kernels take."""
        across = np.ascontiguousarray(self.outputs)
        return (
            self.square,
            np.ascontiguousarray(self.damping),
            self.force,
            across,
            self.rings,
            self.half_backlash,
            self.mesh_damping,
        )


@numba.njit(fastmath=True)
def acceleration(z, v, k, e, slope, square, damping, force, rows, rings, b, c, push, closed, out):
    """z'' of a state; ``push`` takes the contacts' forces, ``closed`` whether they act."""
    n, m = z.size, rows.shape[0]
    for i in range(m):
        total = 0.0
        for j in range(n):
            total += rows[i, j] * z[j]
        push[i] = total
    closed[0] = push[0] - e - b > 0.0
    closed[1] = push[1] + e - b > 0.0
    push[0] = c * slope - (k * (push[0] - e - b) if closed[0] else 0.0)
    push[1] = -k * (push[1] + e - b) if closed[1] else 0.0
    for i in range(rings.shape[0]):
        x, y = push[2 + 2 * i], push[3 + 2 * i]
        r = np.sqrt(x * x + y * y)
        deep = r - rings[i, 2]
        closed[2 + i] = deep > 0.0
        size = 0.0
        if closed[2 + i]:
            size = -rings[i, 0] * (deep if rings[i, 1] == 1.0 else deep ** rings[i, 1]) / r
        push[2 + 2 * i], push[3 + 2 * i] = size * x, size * y
    for j in range(n):
        total = force[j] - square[j] * z[j]
        row = damping[j]
        for i in range(n):
            total -= row[i] * v[i]
        out[j] = total
    for i in range(m):
        if push[i] != 0.0:
            for j in range(n):
                out[j] += push[i] * rows[i, j]


@numba.njit(fastmath=True)
def along(row, z):
    """Their scalar product."""
    total = 0.0
    for j in range(z.size):
        total += row[j] * z[j]
    return total


@numba.njit(fastmath=True)
def rk4(
    start, periods, steps, h, table, kept, square, damping, force, rows, rings, b, c, track, changes
):
    """Runge-Kutta with ``steps`` a period, table at half steps; the state comes back.

    ``track`` (periods*kept,) takes delta_d, ``changes`` (contacts,) counts changes of contact.
    """
    n, m = start.size // 2, rows.shape[0]
    z, v = start[:n].copy(), start[n:].copy()
    push, closed = np.zeros(m), np.zeros(2 + rings.shape[0], np.bool_)
    before = np.zeros(2 + rings.shape[0], np.bool_)
    a = np.zeros((4, n))
    zs, vs = np.zeros(n), np.zeros(n)
    every = steps // kept
    for p in range(periods):
        for s in range(steps):
            if s % every == 0:
                track[p * kept + s // every] = along(rows[0], z)
            for stage in range(4):
                at = (2 * s + (stage + 1) // 2) % (2 * steps)
                w = 0.0 if stage == 0 else (h if stage == 3 else 0.5 * h)
                for j in range(n):
                    if stage == 0:
                        zs[j], vs[j] = z[j], v[j]
                    elif stage == 1:
                        zs[j], vs[j] = z[j] + w * v[j], v[j] + w * a[0, j]
                    elif stage == 2:
                        zs[j] = z[j] + w * (v[j] + 0.5 * h * a[0, j])
                        vs[j] = v[j] + w * a[1, j]
                    else:
                        zs[j] = z[j] + w * (v[j] + 0.5 * h * a[1, j])
                        vs[j] = v[j] + w * a[2, j]
                acceleration(
                    zs, vs, table[0, at], table[1, at], table[2, at], square, damping, force, rows,
                    rings, b, c, push, closed, a[stage],
                )  # fmt: skip
                if stage == 0:
                    for i in range(closed.size):
                        changes[i] += before[i] != closed[i] and p + s > 0
                        before[i] = closed[i]
            for j in range(n):
                z[j] += h * v[j] + h * h / 6.0 * (a[0, j] + a[1, j] + a[2, j])
                v[j] += h / 6.0 * (a[0, j] + 2.0 * a[1, j] + 2.0 * a[2, j] + a[3, j])
    out = np.empty(2 * n)
    out[:n], out[n:] = z, v
    return out


@numba.njit(fastmath=True)
def generalised_alpha(
    start, periods, steps, h, table, kept, inverse, am, af, beta, gamma, square, damping, force,
    rows, rings, b, c, track,
):  # fmt: skip
    """Chung and Hulbert's method; ``inverse`` of its matrix with all contacts closed.

    Contacts change little in one step: fixed-point corrections with that inverse to rounding.
    ``table`` at the steps' interpolated times.
    """
    n, m = start.size // 2, rows.shape[0]
    z, v = start[:n].copy(), start[n:].copy()
    push, closed = np.zeros(m), np.zeros(2 + rings.shape[0], np.bool_)
    a, an, found = np.zeros(n), np.zeros(n), np.zeros(n)
    zs, vs, zm, vm, left = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    acceleration(
        z, v, table[0, 0], table[1, 0], table[2, 0], square, damping, force, rows, rings, b, c,
        push, closed, a,
    )  # fmt: skip
    every = steps // kept
    for p in range(periods):
        for s in range(steps):
            if s % every == 0:
                track[p * kept + s // every] = along(rows[0], z)
            at = steps + s
            for j in range(n):
                an[j] = a[j]
            for _ in range(20):
                for j in range(n):
                    zs[j] = z[j] + h * v[j] + h * h * ((0.5 - beta) * a[j] + beta * an[j])
                    vs[j] = v[j] + h * ((1.0 - gamma) * a[j] + gamma * an[j])
                    zm[j] = (1.0 - af) * zs[j] + af * z[j]
                    vm[j] = (1.0 - af) * vs[j] + af * v[j]
                acceleration(
                    zm, vm, table[0, at], table[1, at], table[2, at], square, damping, force, rows,
                    rings, b, c, push, closed, found,
                )  # fmt: skip
                for j in range(n):
                    left[j] = found[j] - (1.0 - am) * an[j] - am * a[j]
                worst, size = 0.0, 0.0
                for j in range(n):
                    total = 0.0
                    for i in range(n):
                        total += inverse[j, i] * left[i]
                    an[j] += total
                    worst, size = max(worst, abs(total)), max(size, abs(an[j]))
                if worst <= 1e-10 * size:
                    break
            for j in range(n):
                z[j] += h * v[j] + h * h * ((0.5 - beta) * a[j] + beta * an[j])
                v[j] += h * ((1.0 - gamma) * a[j] + gamma * an[j])
                a[j] = an[j]
    out = np.empty(2 * n)
    out[:n], out[n:] = z, v
    return out


def run_rk4(
    modal: Modal, start: Floats, periods: int, steps: int, kept: int = 16
) -> tuple[Floats, Floats, Floats]:
    """End state (z, z'), delta_d at ``kept`` phases a period, changes of every contact."""
    track, changes = np.zeros(periods * kept), np.zeros(2 + len(modal.rings), np.int64)
    h = 1.0 / (modal.frequency * steps)
    table = modal.tables(2 * steps)
    end = rk4(start, periods, steps, h, table, kept, *modal.constants(), track, changes)
    return end, track, changes


def run_alpha(
    modal: Modal, start: Floats, periods: int, steps: int, kept: int = 16, radius: float = 0.9
) -> tuple[Floats, Floats]:
    """End state and delta_d; ``radius``: spectral radius at infinite frequency."""
    am, af = (2.0 * radius - 1.0) / (radius + 1.0), radius / (radius + 1.0)
    gamma, beta = 0.5 - am + af, 0.25 * (1.0 - am + af) ** 2
    h = 1.0 / (modal.frequency * steps)
    stiff = np.diag(modal.square) + modal.k[0].real * np.outer(modal.outputs[0], modal.outputs[0])
    for i, (size, _, _) in enumerate(modal.rings):
        rows = modal.outputs[2 + 2 * i : 4 + 2 * i]
        stiff = stiff + size * rows.T @ rows
    n = modal.square.size
    matrix = (1.0 - am) * np.eye(n) + (1.0 - af) * h * (gamma * modal.damping + beta * h * stiff)
    # k and e at t + (1 - af) h of every step; the first column is that of t = 0
    whole = modal.tables(steps)
    turn = np.exp(2j * np.pi * (1.0 - af) / steps * np.arange(max(modal.k.size, modal.e.size)))
    moved = Modal(**{**vars(modal), "k": modal.k * turn[: modal.k.size],
                     "e": modal.e * turn[: modal.e.size]})  # fmt: skip
    table = np.hstack([whole, moved.tables(steps)])
    track = np.zeros(periods * kept)
    end = generalised_alpha(
        start, periods, steps, h, table, kept, np.linalg.inv(matrix), am, af, beta, gamma,
        *modal.constants(), track,
    )  # fmt: skip
    return end, track
