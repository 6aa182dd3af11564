"""A drive train's equation by scipy's DOP853 rule in a compiled loop, nothing of the engine in it.

Every step ends at the next jump of the friction and at the period's end; a contact that opens or
closes in a step is met by the step's error alone, which is small where the tolerance is. Slow: it
is for checking labels, whose motions are followed for thousands of mesh periods.

M q'' + C q' + K q = f0 - F_d g_d + c_m e_d' g_d - F_b g_b + F_d (chi_0 p_0 + chi_1 p_1) + bearings
+ what turns with a shaft; F_d = k <g_d.q - e_d - b'>+, F_b = k <g_b.q - e_b - b'>+.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import DOP853

from thermogear.base.excitation import Periodic
from thermogear.base.pieces import Pieces
from thermogear.dynamics.geared_equation import GearedEquation

Floats = NDArray[np.float64]
TOLERANCE = 1e-10
"""Error of a step, over the motion of the teeth by a half backlash."""
MOST_STEPS = 200_000
"""Steps in a mesh period at most."""


class Arrays(NamedTuple):
    """What the loop reads, in coordinates of unit mass."""

    linear: Floats
    force: Floats
    rows: Floats
    scalars: Floats
    """b', c_m, mesh frequency."""
    series: NDArray[np.complex128]
    """(2, orders): k, e."""
    starts: Floats
    pieces: Floats
    """(pieces, power, 2): chi_0, chi_1."""
    friction: Floats
    laws: Floats
    """(bearing, 5): coefficient, exponent, clearance, first ray, rays (0: a ring)."""
    rays: Floats
    outer: Floats
    """(force, 2 + n): turns a mesh period, shift; amplitude in coordinates."""
    wobbles: Floats
    stops: Floats
    rule: Floats
    """(15, 14): the rule's A, then B, E3, E5; C in the last column."""
    scale: Floats


def _rates(t: float, x: Floats, out: Floats, a: Arrays, side: float) -> None:
    """x' at time ``t``; ``side``: a phase inside the piece in which the step lies.

    ``x`` may go on with tangent vectors, 2n each: their rates by the derivatives of every force.
    """
    n = a.force.size
    columns = x.size // (2 * n) - 1
    b, damper, f = a.scalars[0], a.scalars[1], a.scalars[2]
    turn = t * f
    z = complex(math.cos(2.0 * math.pi * turn), math.sin(2.0 * math.pi * turn))
    k = e = rate = 0.0
    wave = complex(1.0, 0.0)
    for order in range(a.series.shape[1]):
        k += (a.series[0, order] * wave).real
        e += (a.series[1, order] * wave).real
        rate -= 2.0 * math.pi * f * order * (a.series[1, order] * wave).imag
        wave *= z
    back_error = -e
    for i in range(a.wobbles.shape[0]):
        angle = 2.0 * math.pi * a.wobbles[i, 0]
        c, s = math.cos(angle * turn), math.sin(angle * turn)
        e += a.wobbles[i, 1] * c - a.wobbles[i, 2] * s
        rate -= angle * f * (a.wobbles[i, 1] * s + a.wobbles[i, 2] * c)
        back_error += a.wobbles[i, 3] * c - a.wobbles[i, 4] * s
    for c in range(columns + 1):
        at = 2 * n * c
        for i in range(n):
            total = a.force[i] if c == 0 else 0.0
            for j in range(2 * n):
                total += a.linear[i, j] * x[at + j]
            out[at + i] = x[at + n + i]
            out[at + n + i] = total
    drive = back = 0.0
    for j in range(n):
        drive += a.rows[0, j] * x[j]
        back += a.rows[1, j] * x[j]
    pressed = k * max(drive - e - b, 0.0)
    other = k * max(back - back_error - b, 0.0)
    for j in range(n):
        out[n + j] += (damper * rate - pressed) * a.rows[0, j] - other * a.rows[1, j]
    if pressed > 0.0:
        _couple(a.rows[0], a.rows[0], -k, x, out, n, columns)
    if other > 0.0:
        _couple(a.rows[1], a.rows[1], -k, x, out, n, columns)
    if a.friction.shape[0] and pressed > 0.0:
        place = np.searchsorted(a.starts, side, side="right") - 1
        at = turn - math.floor(turn)
        if at - side > 0.5:
            at -= 1.0
        elif side - at > 0.5:
            at += 1.0
        at -= a.starts[place]
        chi0 = chi1 = 0.0
        for power in range(a.pieces.shape[1] - 1, -1, -1):
            chi0 = chi0 * at + a.pieces[place, power, 0]
            chi1 = chi1 * at + a.pieces[place, power, 1]
        for j in range(n):
            out[n + j] += pressed * (chi0 * a.friction[0, j] + chi1 * a.friction[1, j])
        _couple(a.friction[0], a.rows[0], k * chi0, x, out, n, columns)
        _couple(a.friction[1], a.rows[0], k * chi1, x, out, n, columns)
    for i in range(a.laws.shape[0]):
        ux = uy = 0.0
        for j in range(n):
            ux += a.rows[2 + 2 * i, j] * x[j]
            uy += a.rows[3 + 2 * i, j] * x[j]
        stiff, exponent, clearance = a.laws[i, 0], a.laws[i, 1], a.laws[i, 2]
        fx = fy = 0.0
        first, many = int(a.laws[i, 3]), int(a.laws[i, 4])
        if many == 0:
            r = math.sqrt(ux * ux + uy * uy)
            if r > clearance:
                size = stiff * (r - clearance) ** exponent / r
                fx, fy = -size * ux, -size * uy
                slope = exponent * stiff * (r - clearance) ** (exponent - 1.0) - size
                one, two = a.rows[2 + 2 * i], a.rows[3 + 2 * i]
                _couple(one, one, -size - slope * ux * ux / r**2, x, out, n, columns)
                _couple(one, two, -slope * ux * uy / r**2, x, out, n, columns)
                _couple(two, one, -slope * ux * uy / r**2, x, out, n, columns)
                _couple(two, two, -size - slope * uy * uy / r**2, x, out, n, columns)
        for m in range(first, first + many):
            deep = ux * a.rays[m, 0] + uy * a.rays[m, 1] - clearance
            if deep > 0.0:
                size = stiff * deep**exponent
                fx -= size * a.rays[m, 0]
                fy -= size * a.rays[m, 1]
                _ray(a, i, m, -exponent * size / deep, x, out, n, columns)
        for j in range(n):
            out[n + j] += fx * a.rows[2 + 2 * i, j] + fy * a.rows[3 + 2 * i, j]
    for i in range(a.outer.shape[0]):
        wave_of = math.cos(2.0 * math.pi * a.outer[i, 0] * turn + a.outer[i, 1])
        for j in range(n):
            out[n + j] += wave_of * a.outer[i, 2 + j]


@numba.njit(error_model="numpy")  # type: ignore[untyped-decorator]
def _couple(
    onto: Floats, felt: Floats, stiff: float, x: Floats, out: Floats, n: int, columns: int
) -> None:
    """Add ``stiff`` ``onto`` (``felt`` . q) to the rates of every tangent vector."""
    for c in range(1, columns + 1):
        at = 2 * n * c
        total = 0.0
        for j in range(n):
            total += felt[j] * x[at + j]
        total *= stiff
        for j in range(n):
            out[at + n + j] += total * onto[j]


@numba.njit(error_model="numpy")  # type: ignore[untyped-decorator]
def _ray(
    a: Arrays, bearing: int, ray: int, stiff: float, x: Floats, out: Floats, n: int, columns: int
) -> None:
    """The same of one rolling element, along its ray."""
    one, two = a.rows[2 + 2 * bearing], a.rows[3 + 2 * bearing]
    for c in range(1, columns + 1):
        at = 2 * n * c
        total = 0.0
        for j in range(n):
            total += (a.rays[ray, 0] * one[j] + a.rays[ray, 1] * two[j]) * x[at + j]
        total *= stiff
        for j in range(n):
            out[at + n + j] += total * (a.rays[ray, 0] * one[j] + a.rays[ray, 1] * two[j])


rates: Any = numba.njit(error_model="numpy")(_rates)


@numba.njit(error_model="numpy")  # type: ignore[untyped-decorator]
def _advance(
    x: Floats,
    first: int,
    periods: int,
    a: Arrays,
    scale: Floats,
    tolerance: float,
    sections: Floats,
) -> int:
    """Carry ``x`` in place from mesh period ``first`` on; the steps taken, -1 where it fails."""
    size = x.size
    f = a.scalars[2]
    stages = np.zeros((13, size))
    trial = np.zeros(size)
    step = 0.002 / f
    taken = 0
    for number in range(periods):
        for piece in range(a.stops.size - 1):
            t = (first + number + a.stops[piece]) / f
            end = (first + number + a.stops[piece + 1]) / f
            side = 0.5 * (a.stops[piece] + a.stops[piece + 1])
            fresh = True
            tried = 0
            while t < end:
                tried += 1
                if tried > MOST_STEPS:
                    return -1
                last = step >= 0.999999 * (end - t)
                h = end - t if last else step
                if fresh:
                    rates(t, x, stages[0], a, side)
                    fresh = False
                for s in range(1, 13):
                    for j in range(size):
                        total = 0.0
                        for r in range(s):
                            total += a.rule[s, r] * stages[r, j]
                        trial[j] = x[j] + h * total
                    rates(t + a.rule[s, 13] * h, trial, stages[s], a, side)
                five = three = 0.0
                for j in range(size):
                    e5 = e3 = 0.0
                    for r in range(13):
                        e5 += a.rule[14, r] * stages[r, j]
                        e3 += a.rule[13, r] * stages[r, j]
                    five += (e5 / scale[j]) ** 2
                    three += (e3 / scale[j]) ** 2
                error = 0.0
                if five > 0.0:
                    error = h * five / math.sqrt((five + 0.01 * three) * size) / tolerance
                if not error < 1e300:
                    return -1
                factor = 0.9 * max(error, 1e-12) ** -0.125
                if error <= 1.0:
                    taken += 1
                    t = end if last else t + h
                    for j in range(size):
                        x[j] = trial[j]
                        stages[0, j] = stages[12, j]
                    if not last or factor < 1.0:
                        step = h * min(factor, 6.0)
                    else:
                        step = max(step, h * min(factor, 6.0))
                else:
                    step = h * max(factor, 0.2)
        for j in range(sections.shape[1]):
            sections[number, j] = x[j]
    return taken


def _rule() -> Floats:
    """Rows 1 to 11: stages; 12: the step itself; 13, 14: its errors of order 3 and 5."""
    found = np.zeros((15, 14))
    found[:12, :12], found[:12, 13] = DOP853.A[:12, :12], DOP853.C[:12]
    found[12, :12], found[12, 13] = DOP853.B, 1.0
    found[13, :13], found[14, :13] = DOP853.E3, DOP853.E5
    return found


class Independent:
    """The motion of ``model`` by itself: :meth:`carry` like a return map's, by mesh periods."""

    def __init__(self, model: GearedEquation, tolerance: float = TOLERANCE) -> None:
        self.model, self.tolerance = model, tolerance
        self.to_q = np.linalg.inv(np.linalg.cholesky(model.mass)).T
        t, n, f = self.to_q, model.size, model.mesh_frequency
        rows = np.stack(
            [model.drive, model.back, *(r for one in model.bearings for r in one.directions.T)]
        )
        friction, starts, pieces = np.zeros((0, n)), np.zeros(1), np.zeros((1, 1, 2))
        if model.friction is not None:
            friction = np.asarray(model.friction) @ t
            starts, pieces = _pieces(model.friction_at_pitch, model.friction_per_metre)
        laws, rays = np.zeros((len(model.bearings), 5)), [np.zeros((0, 2))]
        for place, one in enumerate(model.bearings):
            before = sum(len(some) for some in rays)
            laws[place] = one.coefficient, one.exponent, one.clearance, before, one.elements
            rays.append(one.rays[: one.elements])
        outer = np.zeros((len(model.outer), 2 + n))
        for place, force in enumerate(model.outer):
            size = (2.0 * np.pi * force.order * f) ** 2 if force.rotating else 1.0
            outer[place] = np.r_[force.order, force.shift, size * (t.T @ force.vector)]
        assert isinstance(model.mesh_stiffness, Periodic)
        assert isinstance(model.error, Periodic)
        inertia = float(model.drive @ np.linalg.solve(model.mass, model.drive))
        size = model.half_backlash / np.sqrt(inertia)
        self.arrays = Arrays(
            linear=-np.hstack([t.T @ model.stiffness @ t, t.T @ model.damping @ t]),
            force=t.T @ model.force,
            rows=rows @ t,
            scalars=np.array([model.half_backlash, model.mesh_damping, f]),
            series=Periodic.columns([model.mesh_stiffness, model.error]),
            starts=starts,
            pieces=pieces,
            friction=friction,
            laws=laws,
            rays=np.concatenate(rays),
            outer=outer,
            wobbles=np.array([one.row for one in model.wobbles]).reshape(-1, 5),
            stops=np.append(starts, 1.0),
            rule=_rule(),
            scale=np.r_[np.full(n, size), np.full(n, 2.0 * np.pi * f * size)],
        )

    def carry(self, state: ArrayLike, periods: int, *, first: int = 0) -> Floats:
        """States (periods, 2n) after each mesh period from ``state`` at period ``first``."""
        n = self.model.size
        both = np.asarray(state, dtype=float).reshape(2, n)
        x = np.linalg.solve(self.to_q, both.T).T.ravel()
        sections = np.zeros((periods, 2 * n))
        a = self.arrays
        taken = _advance(x, first, periods, a, a.scale, self.tolerance, sections)
        if taken < 0:
            raise RuntimeError("the independent integration fails")
        return np.hstack([sections[:, :n] @ self.to_q.T, sections[:, n:] @ self.to_q.T])

    def jacobian(self, state: ArrayLike, periods: int) -> tuple[Floats, Floats]:
        """The state (2n,) after ``periods`` from ``state``, and its derivatives (2n, 2n).

        Tangent vectors in units of the motion's, their errors held to the same share of them.
        """
        n, a = self.model.size, self.arrays
        whole = np.kron(np.eye(2), self.to_q)
        x = np.linalg.solve(whole, np.asarray(state, dtype=float))
        both = np.concatenate([x, np.diag(a.scale).ravel()])
        scale = np.tile(a.scale, 2 * n + 1)
        sections = np.zeros((periods, 2 * n))
        if _advance(both, 0, periods, a, scale, self.tolerance, sections) < 0:
            raise RuntimeError("the independent integration fails")
        turned = both[2 * n :].reshape(2 * n, 2 * n).T / a.scale
        found: Floats = whole @ turned @ np.linalg.inv(whole)
        return whole @ both[: 2 * n], found


def _pieces(pitch: object, metre: object) -> tuple[Floats, Floats]:
    assert isinstance(pitch, Pieces)
    assert isinstance(metre, Pieces)
    width = max(len(row) for one in (pitch, metre) for row in one.coefficients)
    found = np.zeros((len(pitch.starts), width, 2))
    for column, one in enumerate((pitch, metre)):
        for place, row in enumerate(one.coefficients):
            found[place, : len(row), column] = row
    return np.array(pitch.starts), found
