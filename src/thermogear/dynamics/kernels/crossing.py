"""One lane through one sub-step with everything that can happen: turns, grazing, many edges.

A contact change is a root of the sub-step's polynomial, where the state is handed to the
polynomials of the next region. No fastmath: a lane gives the same bits in any company.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.dynamics.kernels.affine import (
    FREE_NU,
    FREE_PSI,
    GAP,
    HALF,
    NU,
    PHI,
    PSI,
    SINCE,
)
from thermogear.dynamics.kernels.batch import HIGH, LOSSES, LOW, SHIFT, SPENT, TANGENT, X, Y
from thermogear.dynamics.kernels.compiled import part

Real = NDArray[np.float64]

MOST_CROSSINGS = 64
TURNS = 16
# numbers of one kind: a plain 0 would have numba compile a function for itself
FRONT: Any = np.int64(0)
LOWER: Any = np.int64(0)
UPPER: Any = np.int64(1)
NEITHER: Any = np.int64(2)
SCRATCH = 2 * TURNS + 9  # beside two polynomials


@part
def value_of(p: Real, first: int, width: int, u: float) -> float:
    """The polynomial whose ``width`` coefficients begin at ``first``.

    Here and below no slice is taken: numba counts its users, which costs more than the sum.
    """
    total = 0.0
    for m in range(first + width - 1, first - 1, -1):
        total = total * u + p[m]
    return total


@part
def slope(p: Real, first: int, width: int, u: float) -> float:
    total = 0.0
    for m in range(width - 1, 0, -1):
        total = total * u + m * p[first + m]
    return total


@part
def root(p: Real, first: int, width: int, level: float, low: float, high: float) -> float:
    """The root of p(u) = level in a monotone piece [low, high]: Newton inside a bracket."""
    at_low = value_of(p, first, width, low) - level
    at_high = value_of(p, first, width, high) - level
    if at_low == 0.0 or (at_low > 0.0) == (at_high > 0.0):
        # both ends on one side: the start is on the edge but for rounding
        return low
    a = low
    b = high
    # cubic Hermite start from the two ends
    span = high - low
    s0 = slope(p, first, width, low) * span
    s1 = slope(p, first, width, high) * span
    delta = at_high - at_low
    t = -at_low / delta
    for _ in range(2):
        c3 = s0 + s1 - 2.0 * delta
        c2 = 3.0 * delta - 2.0 * s0 - s1
        down = (3.0 * c3 * t + 2.0 * c2) * t + s0
        if down != 0.0:
            t -= (((c3 * t + c2) * t + s0) * t + at_low) / down
    u = low + span * t
    if not (a < u < b):
        u = low + span * (-at_low / delta)
    for _ in range(60):
        value = 0.0
        rate = 0.0
        for m in range(width - 1, 0, -1):
            value = value * u + p[first + m]
            rate = rate * u + m * p[first + m]
        value = value * u + p[first] - level
        if value == 0.0:
            return u
        if (value > 0.0) == (at_high > 0.0):
            b = u
        else:
            a = u
        move = value / rate if rate != 0.0 else np.inf
        new = u - move
        if not (a <= new <= b):
            new = 0.5 * (a + b)
        if abs(new - u) <= 4e-16:
            return new
        u = new
    return u


@part
def turns_in(s: Real, width: int, start: float, low: float, high: float) -> int:
    """Roots of p' in (start, 1), ascending, behind twice ``width`` in the work space; their number.

    A single turn that stays between ``low`` and ``high`` need not be found and is not counted.
    Each derivative is monotone between the roots of the next one; the fourth is taken to keep
    its sign on the halves of a sub-step, which its width guarantees.
    """
    work = width
    found = 2 * width
    # quick exit: the straight part of the slope beats everything above it
    tail = 0.0
    for m in range(3, width):
        tail += m * abs(s[m])
    first = s[1] + 2.0 * s[2] * start
    last = s[1] + 2.0 * s[2]
    if (first > tail and last > tail) or (first < -tail and last < -tail):
        return 0
    # p'' keeps its sign: p' has one root at the most
    bend = 0.0
    for m in range(3, width):
        bend += m * (m - 1.0) * abs(s[m])
    if 2.0 * abs(s[2]) > bend:
        first = slope(s, FRONT, width, start)
        if (first > 0.0) == (slope(s, FRONT, width, 1.0) > 0.0):
            return 0
        swing = first * first / (2.0 * (2.0 * abs(s[2]) - bend))
        value = value_of(s, FRONT, width, start)
        if low < value - swing and value + swing < high:
            return 0
        for m in range(width - 1):
            s[work + m] = (m + 1.0) * s[m + 1]
        s[found] = root(s, work, width - 1, 0.0, start, 1.0)
        return 1
    count = 1
    s[found] = 0.0 if start < 0.0 else 0.5 * (start + 1.0)
    for level in range(3, 0, -1):
        # work = level-th derivative
        size = width - level
        for m in range(size):
            factor = 1.0
            for i in range(level):
                factor *= m + level - i
            s[work + m] = factor * s[m + level]
        for i in range(count):
            s[found + TURNS + i] = s[found + i]
        fresh = 0
        a = start
        fa = value_of(s, work, size, a)
        for i in range(count + 1):
            b = s[found + TURNS + i] if i < count else 1.0
            fb = value_of(s, work, size, b)
            if fa != 0.0 and (fa > 0.0) != (fb > 0.0) and fresh < TURNS:
                s[found + fresh] = root(s, work, size, 0.0, a, b)
                fresh += 1
            a = b
            fa = fb
        count = fresh
    return count


@part
def combined(
    curves: Real, row: int, width: int, region: int, x0: float, y0: float, s: Real
) -> None:
    """The sub-step's polynomial of x, measured from the edge of its region, to the front of ``s``.

    Its five polynomials begin at ``row`` of the flat ``curves``.
    """
    if region != 0:
        for m in range(width):
            s[m] = (
                curves[row + PHI * width + m] * x0
                + curves[row + PSI * width + m] * y0
                + curves[row + NU * width + m]
            )
    else:
        for m in range(width):
            s[m] = curves[row + FREE_PSI * width + m] * y0 + curves[row + FREE_NU * width + m]
        s[0] += x0


@part
def frame(
    curves: Real, row: int, width: int, region: int, u: float, h: float, out: Real, place: int
) -> None:
    """phi, psi, nu and their rates at ``u`` of one region: six numbers of ``out`` at ``place``."""
    out[place] = 1.0
    out[place + 3] = 0.0
    contact = region != 0
    for q in range(0 if contact else 1, 3):
        first = row + (q if contact else q + 2) * width
        out[place + q] = value_of(curves, first, width, u)
        out[place + 3 + q] = slope(curves, first, width, u) / h


@part
def next_edge(
    s: Real, width: int, start: float, region: int, b: float, skip: int
) -> tuple[float, int]:
    """Where the path first leaves its region after ``start``, and by which edge.

    LOWER, UPPER, or NEITHER before the end; ``skip`` the edge just crossed, not to be
    crossed in the first piece.
    """
    low = -np.inf if region < 0 else 0.0 if region > 0 else -b
    high = np.inf if region > 0 else 0.0 if region < 0 else b
    turns = turns_in(s, width, start, low, high)
    a = start
    for i in range(turns + 1):
        e = s[2 * width + i] if i < turns else 1.0
        value = value_of(s, FRONT, width, e)
        edge = LOWER if value < low else UPPER if value > high else NEITHER
        if edge != NEITHER and edge != skip:
            return root(s, FRONT, width, low if edge == LOWER else high, a, e), edge
        skip = NEITHER
        a = e
    return 1.0, NEITHER


@part
def step_through(
    curves: Real,
    row: int,
    width: int,
    carried: Real,
    stride: int,
    i: int,
    columns: int,
    scratch: Real,
) -> None:
    """One sub-step of one lane with contact changes, turning points and grazing.

    ``curves`` (flat) holds its polynomials and what belongs to them from ``row`` on; column ``i``
    of ``carried`` (CARRIED, ``stride``) follows: state, region, times and counts, and ``columns``
    of its tangent. Work space: ``scratch`` (2 (K + 1) + SCRATCH). All are flat.
    """
    maps = row + 5 * width
    here = 2 * width + 2 * TURNS
    h = curves[maps + HALF]
    b = curves[maps + GAP]
    shift = carried[SHIFT * stride + i]
    region = 1 if shift > 0.0 else -1 if shift < 0.0 else 0
    before = region
    for m in range(3):
        scratch[here + 6 + m] = 0.0
    j11 = 1.0
    j12 = 0.0
    j21 = 0.0
    j22 = 1.0
    x0 = carried[X * stride + i] - region * b
    y0 = carried[Y * stride + i]
    start = -1.0
    skip = NEITHER
    for _ in range(MOST_CROSSINGS):
        combined(curves, row, width, region, x0, y0, scratch)
        at, edge = next_edge(scratch, width, start, region, b, skip)
        if edge == NEITHER:
            break
        y = slope(scratch, FRONT, width, at) / h
        # Phi of the region left behind, at the crossing
        time = h * at
        scratch[here + 7 + region] += time
        frame(curves, row, width, region, at, h, scratch, here)
        e11 = scratch[here] * j11 + scratch[here + 1] * j21
        e12 = scratch[here] * j12 + scratch[here + 1] * j22
        e21 = scratch[here + 3] * j11 + scratch[here + 4] * j21
        e22 = scratch[here + 3] * j12 + scratch[here + 4] * j22
        if edge == LOWER:
            carried[(LOSSES if region == 1 else LOSSES + 1) * stride + i] += 1.0
            # upper edge of the region below; contact is measured from its own edge
            x = b if region == 1 else 0.0
            region -= 1
            skip = UPPER
        else:
            x = 0.0 if region == 0 else -b
            region += 1
            skip = LOWER
        scratch[here + 7 + region] -= time
        frame(curves, row, width, region, at, h, scratch, here)
        f11 = scratch[here]
        f12 = scratch[here + 1]
        f21 = scratch[here + 3]
        f22 = scratch[here + 4]
        x -= scratch[here + 2]
        y -= scratch[here + 5]
        det = f11 * f22 - f12 * f21
        x0 = (f22 * x - f12 * y) / det
        y0 = (f11 * y - f21 * x) / det
        j11 = (f22 * e11 - f12 * e21) / det
        j12 = (f22 * e12 - f12 * e22) / det
        j21 = (f11 * e21 - f21 * e11) / det
        j22 = (f11 * e22 - f21 * e12) / det
        start = at
    free = region == 0
    f11 = 1.0 if free else curves[maps]
    f21 = 0.0 if free else curves[maps + 1]
    f12 = curves[maps + 6] if free else curves[maps + 2]
    f22 = curves[maps + 7] if free else curves[maps + 3]
    carried[X * stride + i] = f11 * x0 + f12 * y0 + curves[maps + (8 if free else 4)] + region * b
    carried[Y * stride + i] = f21 * x0 + f22 * y0 + curves[maps + (9 if free else 5)]
    e11 = f11 * j11 + f12 * j21
    e12 = f11 * j12 + f12 * j22
    e21 = f21 * j11 + f22 * j21
    e22 = f21 * j12 + f22 * j22
    for m in range(columns):
        one = carried[(TANGENT + m) * stride + i]
        two = carried[(TANGENT + 2 + m) * stride + i]
        carried[(TANGENT + m) * stride + i] = e11 * one + e12 * two
        carried[(TANGENT + 2 + m) * stride + i] = e21 * one + e22 * two
    for m in range(3):
        carried[(SPENT + m) * stride + i] += scratch[here + 6 + m]
    if region != before:
        # the whole period is booked for the region at its end
        carried[(SPENT + before + 1) * stride + i] += curves[maps + SINCE] + h
        carried[(SPENT + region + 1) * stride + i] -= curves[maps + SINCE] + h
        carried[SHIFT * stride + i] = region * b
        carried[LOW * stride + i] = -np.inf if region < 0 else (region * 2 - 1) * b
        carried[HIGH * stride + i] = np.inf if region > 0 else (region * 2 + 1) * b
