"""One lane through one sub-step with everything that can happen: turns, grazing, many edges.

A contact change is a root of the sub-step's polynomial, where the state is handed to the
polynomials of the next region. No fastmath: a lane gives the same bits in any company.
"""

from __future__ import annotations

import numpy as np
from numba import njit
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
from thermogear.dynamics.kernels.batch import HIGH, LOSSES, LOW, SHIFT, SPENT

Real = NDArray[np.float64]

MOST_CROSSINGS = 64


@njit(nogil=True, cache=True, error_model="numpy")
def value_of(p: Real, u: float) -> float:
    total = 0.0
    for m in range(p.shape[0] - 1, -1, -1):
        total = total * u + p[m]
    return total


@njit(nogil=True, cache=True, error_model="numpy")
def slope(p: Real, u: float) -> float:
    total = 0.0
    for m in range(p.shape[0] - 1, 0, -1):
        total = total * u + m * p[m]
    return total


@njit(nogil=True, cache=True, error_model="numpy")
def root(p: Real, level: float, low: float, high: float) -> float:
    """The root of p(u) = level in a monotone piece [low, high]: Newton inside a bracket."""
    at_low = value_of(p, low) - level
    at_high = value_of(p, high) - level
    if at_low == 0.0 or (at_low > 0.0) == (at_high > 0.0):
        # both ends on one side: the start is on the edge but for rounding
        return low
    a = low
    b = high
    # cubic Hermite start from the two ends
    width = high - low
    s0 = slope(p, low) * width
    s1 = slope(p, high) * width
    delta = at_high - at_low
    t = -at_low / delta
    for _ in range(2):
        c3 = s0 + s1 - 2.0 * delta
        c2 = 3.0 * delta - 2.0 * s0 - s1
        down = (3.0 * c3 * t + 2.0 * c2) * t + s0
        if down != 0.0:
            t -= (((c3 * t + c2) * t + s0) * t + at_low) / down
    u = low + width * t
    if not (a < u < b):
        u = low + width * (-at_low / delta)
    for _ in range(60):
        value = 0.0
        rate = 0.0
        for m in range(p.shape[0] - 1, 0, -1):
            value = value * u + p[m]
            rate = rate * u + m * p[m]
        value = value * u + p[0] - level
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


@njit(nogil=True, cache=True, error_model="numpy")
def turns_in(p: Real, start: float, low: float, high: float, found: Real, work: Real) -> int:
    """Roots of p' in (start, 1), ascending, into ``found``; their number.

    A single turn that stays between ``low`` and ``high`` need not be found and is not counted.
    Each derivative is monotone between the roots of the next one; the fourth is taken to keep
    its sign on the halves of a sub-step, which its width guarantees.
    """
    width = p.shape[0]
    # quick exit: the straight part of the slope beats everything above it
    tail = 0.0
    for m in range(3, width):
        tail += m * abs(p[m])
    first = p[1] + 2.0 * p[2] * start
    last = p[1] + 2.0 * p[2]
    if (first > tail and last > tail) or (first < -tail and last < -tail):
        return 0
    # p'' keeps its sign: p' has one root at the most
    bend = 0.0
    for m in range(3, width):
        bend += m * (m - 1.0) * abs(p[m])
    if 2.0 * abs(p[2]) > bend:
        first = slope(p, start)
        if (first > 0.0) == (slope(p, 1.0) > 0.0):
            return 0
        swing = first * first / (2.0 * (2.0 * abs(p[2]) - bend))
        value = value_of(p, start)
        if low < value - swing and value + swing < high:
            return 0
        for m in range(width - 1):
            work[m] = (m + 1.0) * p[m + 1]
        found[0] = root(work[: width - 1], 0.0, start, 1.0)
        return 1
    count = 1
    found[0] = 0.0 if start < 0.0 else 0.5 * (start + 1.0)
    for level in range(3, 0, -1):
        # work = level-th derivative
        for m in range(width - level):
            factor = 1.0
            for i in range(level):
                factor *= m + level - i
            work[m] = factor * p[m + level]
        q = work[: width - level]
        fresh = 0
        a = start
        fa = value_of(q, a)
        old = found[:count].copy()
        for i in range(count + 1):
            b = old[i] if i < count else 1.0
            fb = value_of(q, b)
            if fa != 0.0 and (fa > 0.0) != (fb > 0.0) and fresh < found.shape[0]:
                found[fresh] = root(q, 0.0, a, b)
                fresh += 1
            a = b
            fa = fb
        count = fresh
    return count


@njit(nogil=True, cache=True, error_model="numpy")
def combined(curves: Real, region: int, x0: float, y0: float, p: Real) -> None:
    """The sub-step's polynomial of x, measured from the edge of its region; ``curves`` (5, K+1)."""
    if region != 0:
        for m in range(p.shape[0]):
            p[m] = curves[PHI, m] * x0 + curves[PSI, m] * y0 + curves[NU, m]
    else:
        for m in range(p.shape[0]):
            p[m] = curves[FREE_PSI, m] * y0 + curves[FREE_NU, m]
        p[0] += x0


@njit(nogil=True, cache=True, error_model="numpy")
def frame(curves: Real, region: int, u: float, h: float, out: Real) -> None:
    """phi, psi, nu and their rates at ``u`` of one region into ``out`` (2, 3)."""
    out[0, 0] = 1.0
    out[1, 0] = 0.0
    contact = region != 0
    for q in range(0 if contact else 1, 3):
        row = curves[q if contact else q + 2]
        out[0, q] = value_of(row, u)
        out[1, q] = slope(row, u) / h


@njit(nogil=True, cache=True, error_model="numpy")
def next_edge(
    p: Real, start: float, region: int, b: float, skip: int, found: Real, work: Real
) -> tuple[float, int]:
    """Where the path first leaves its region after ``start``, and by which edge.

    0 the lower, 1 the upper, 2 none before the end; ``skip`` the edge just crossed, not to be
    crossed in the first piece.
    """
    low = -np.inf if region < 0 else 0.0 if region > 0 else -b
    high = np.inf if region > 0 else 0.0 if region < 0 else b
    turns = turns_in(p, start, low, high, found, work)
    a = start
    for i in range(turns + 1):
        e = found[i] if i < turns else 1.0
        value = value_of(p, e)
        edge = 0 if value < low else 1 if value > high else 2
        if edge != 2 and edge != skip:
            return root(p, low if edge == 0 else high, a, e), edge
        skip = 2
        a = e
    return 1.0, 2


@njit(nogil=True, cache=True, error_model="numpy")
def step_through(
    curves: Real,
    state: Real,
    carried: Real,
    jacobian: Real,
    scratch: Real,
    found: Real,
    here: Real,
) -> None:
    """One sub-step of one lane with contact changes, turning points and grazing.

    ``curves`` of this lane and sub-step, ``carried`` what the lane carries along:
    its region, its times and counts follow; ``state`` (2,) in and out; ``jacobian`` (4,) out: d
    end/d start row by row. Work space: ``scratch`` (2, K + 1), ``found`` (16,), ``here`` (3, 3).
    """
    width = scratch.shape[1]
    polys = curves[: 5 * width].reshape((5, width))
    p = scratch[0]
    clock = here[2]
    clock[:] = 0.0
    maps = curves[5 * width :]
    h = maps[HALF]
    b = maps[GAP]
    shift = carried[SHIFT]
    region = 1 if shift > 0.0 else -1 if shift < 0.0 else 0
    before = region
    jacobian[0] = 1.0
    jacobian[1] = 0.0
    jacobian[2] = 0.0
    jacobian[3] = 1.0
    x0 = state[0] - region * b
    y0 = state[1]
    start = -1.0
    skip = 2
    for _ in range(MOST_CROSSINGS):
        combined(polys, region, x0, y0, p)
        at, edge = next_edge(p, start, region, b, skip, found, scratch[1])
        if edge == 2:
            break
        y = slope(p, at) / h
        # Phi of the region left behind, at the crossing
        time = h * at
        clock[region + 1] += time
        frame(polys, region, at, h, here)
        j11 = here[0, 0] * jacobian[0] + here[0, 1] * jacobian[2]
        j12 = here[0, 0] * jacobian[1] + here[0, 1] * jacobian[3]
        j21 = here[1, 0] * jacobian[0] + here[1, 1] * jacobian[2]
        j22 = here[1, 0] * jacobian[1] + here[1, 1] * jacobian[3]
        if edge == 0:
            carried[LOSSES if region == 1 else LOSSES + 1] += 1.0
            # upper edge of the region below; contact is measured from its own edge
            x = b if region == 1 else 0.0
            region -= 1
            skip = 1
        else:
            x = 0.0 if region == 0 else -b
            region += 1
            skip = 0
        clock[region + 1] -= time
        frame(polys, region, at, h, here)
        f11 = here[0, 0]
        f12 = here[0, 1]
        f21 = here[1, 0]
        f22 = here[1, 1]
        x -= here[0, 2]
        y -= here[1, 2]
        det = f11 * f22 - f12 * f21
        x0 = (f22 * x - f12 * y) / det
        y0 = (f11 * y - f21 * x) / det
        jacobian[0] = (f22 * j11 - f12 * j21) / det
        jacobian[1] = (f22 * j12 - f12 * j22) / det
        jacobian[2] = (f11 * j21 - f21 * j11) / det
        jacobian[3] = (f11 * j22 - f21 * j12) / det
        start = at
    if region != 0:
        f11 = maps[0]
        f21 = maps[1]
        f12 = maps[2]
        f22 = maps[3]
        state[0] = f11 * x0 + f12 * y0 + maps[4] + region * b
        state[1] = f21 * x0 + f22 * y0 + maps[5]
    else:
        f11 = 1.0
        f21 = 0.0
        f12 = maps[6]
        f22 = maps[7]
        state[0] = x0 + f12 * y0 + maps[8]
        state[1] = f22 * y0 + maps[9]
    j11 = f11 * jacobian[0] + f12 * jacobian[2]
    j12 = f11 * jacobian[1] + f12 * jacobian[3]
    j21 = f21 * jacobian[0] + f22 * jacobian[2]
    j22 = f21 * jacobian[1] + f22 * jacobian[3]
    jacobian[0] = j11
    jacobian[1] = j12
    jacobian[2] = j21
    jacobian[3] = j22
    for m in range(3):
        carried[SPENT + m] += clock[m]
    if region != before:
        # the whole period is booked for the region at its end
        carried[SPENT + before + 1] += maps[SINCE] + h
        carried[SPENT + region + 1] -= maps[SINCE] + h
        carried[SHIFT] = region * b
        carried[LOW] = -np.inf if region < 0 else (region * 2 - 1) * b
        carried[HIGH] = np.inf if region > 0 else (region * 2 + 1) * b
