"""Event-exact affine maps of a piecewise-linear oscillator.

Between contact changes x'' + c x' + k(t) (x - r b) = F(t) is linear, r = 1 on the drive side,
0 inside the backlash (where k acts on nothing), -1 on the back side. On a sub-step of half
width h, u in [-1, 1],

    x(u) - r b = phi(u) (x_0 - r b) + psi(u) y_0 + nu(u),     y = dx/dt,

with polynomials centred on the sub-step that depend on parameters only. ``maps`` holds their
values at u = 1, ``polys`` the coefficients; a contact change is a root of the polynomial, where
the state is handed to the polynomials of the next region. No fastmath, see ``rk4``.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Real = NDArray[np.float64]
Whole = NDArray[np.int64]

PHI, PSI, NU, FREE_PSI, FREE_NU = 0, 1, 2, 3, 4
MOST_CROSSINGS = 64


@njit(nogil=True, cache=True, error_model="numpy")
def prepare(
    damping: Real,
    half: Real,
    stiffness: Real,
    force: Real,
    maps: Real,
    polys: Real,
) -> None:
    """Fill ``maps`` (N, 10, lane) and ``polys`` (N, lane, 5, K + 1).

    ``damping`` (lane), ``half`` (N, lane) half widths in time, ``stiffness`` and ``force``
    (N, lane, K + 1): Taylor coefficients in u of k and F about the centre of each sub-step.
    """
    count, lanes, width = stiffness.shape
    order = width - 1
    work = np.empty((5, width))
    for n in range(count):
        for lane in range(lanes):
            h = half[n, lane]
            ch = damping[lane] * h
            hh = h * h
            # from the centre: cosine-like, sine-like and forced solution, contact then free
            work[:] = 0.0
            work[0, 0] = 1.0
            work[1, 1] = 1.0
            work[3, 1] = 1.0
            for m in range(order - 1):
                s0 = 0.0
                s1 = 0.0
                s2 = 0.0
                for i in range(m + 1):
                    k = stiffness[n, lane, i]
                    s0 += k * work[0, m - i]
                    s1 += k * work[1, m - i]
                    s2 += k * work[2, m - i]
                scale = 1.0 / ((m + 2.0) * (m + 1.0))
                drag = ch * (m + 1.0)
                push = hh * force[n, lane, m]
                work[0, m + 2] = -(drag * work[0, m + 1] + hh * s0) * scale
                work[1, m + 2] = -(drag * work[1, m + 1] + hh * s1) * scale
                work[2, m + 2] = (push - (drag * work[2, m + 1] + hh * s2)) * scale
                work[3, m + 2] = -drag * work[3, m + 1] * scale
                work[4, m + 2] = (push - drag * work[4, m + 1]) * scale
            # values and slopes at the left end u = -1
            left = np.zeros(5)
            slope = np.zeros(5)
            for q in range(5):
                value = 0.0
                rate = 0.0
                for m in range(order, 0, -1):
                    sign = -1.0 if m % 2 else 1.0
                    value += sign * work[q, m]
                    rate -= sign * m * work[q, m]
                left[q] = value + work[q, 0]
                slope[q] = rate
            # hand the free constants to the left end: phi, psi, nu
            det = left[0] * slope[1] - left[1] * slope[0]
            a = slope[1] / det
            b = -slope[0] / det
            c = -h * left[1] / det
            d = h * left[0] / det
            e = (left[1] * slope[2] - slope[1] * left[2]) / det
            f = (slope[0] * left[2] - left[0] * slope[2]) / det
            g = h / slope[3]
            r = -slope[4] / slope[3]
            for m in range(width):
                polys[n, lane, PHI, m] = a * work[0, m] + b * work[1, m]
                polys[n, lane, PSI, m] = c * work[0, m] + d * work[1, m]
                polys[n, lane, NU, m] = work[2, m] + (e * work[0, m] + f * work[1, m])
                polys[n, lane, FREE_PSI, m] = g * work[3, m]
                polys[n, lane, FREE_NU, m] = work[4, m] + r * work[3, m]
            polys[n, lane, FREE_PSI, 0] -= g * left[3]
            polys[n, lane, FREE_NU, 0] -= left[4] + r * left[3]
            for q in range(5):
                value = 0.0
                rate = 0.0
                for m in range(order, 0, -1):
                    value += polys[n, lane, q, m]
                    rate += m * polys[n, lane, q, m]
                maps[n, 2 * q, lane] = value + polys[n, lane, q, 0]
                maps[n, 2 * q + 1, lane] = rate / h


@njit(nogil=True, cache=True, error_model="numpy")
def _value(p: Real, u: float) -> float:
    total = 0.0
    for m in range(p.shape[0] - 1, -1, -1):
        total = total * u + p[m]
    return total


@njit(nogil=True, cache=True, error_model="numpy")
def _slope(p: Real, u: float) -> float:
    total = 0.0
    for m in range(p.shape[0] - 1, 0, -1):
        total = total * u + m * p[m]
    return total


@njit(nogil=True, cache=True, error_model="numpy")
def _root(p: Real, level: float, low: float, high: float) -> float:
    """The root of p(u) = level in a monotone piece [low, high]: Newton inside a bracket."""
    at_low = _value(p, low) - level
    at_high = _value(p, high) - level
    if at_low == 0.0 or (at_low > 0.0) == (at_high > 0.0):
        # both ends on one side: the start is on the edge but for rounding
        return low
    a = low
    b = high
    # cubic Hermite start from the two ends
    width = high - low
    s0 = _slope(p, low) * width
    s1 = _slope(p, high) * width
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
def _turns(p: Real, start: float, found: Real, work: Real) -> int:
    """Roots of p' in (start, 1), ascending, into ``found``; their number.

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
        fa = _value(q, a)
        old = found[:count].copy()
        for i in range(count + 1):
            b = old[i] if i < count else 1.0
            fb = _value(q, b)
            if fa != 0.0 and (fa > 0.0) != (fb > 0.0) and fresh < found.shape[0]:
                found[fresh] = _root(q, 0.0, a, b)
                fresh += 1
            a = b
            fa = fb
        count = fresh
    return count


@njit(nogil=True, cache=True, error_model="numpy")
def _contact_change(
    polys: Real,
    maps: Real,
    lane: int,
    h: float,
    b: float,
    state: Real,
    region: int,
    jacobian: Real,
    counts: Whole,
    spent: Real,
    scratch: Real,
    found: Real,
) -> int:
    """One sub-step of one lane with contact changes, turning points and grazing.

    ``polys`` (lane, 5, K + 1) and ``maps`` (10, lane) of this sub-step; ``state`` (2,) in and
    out; ``jacobian`` (4,) out: d end/d start row by row; ``counts`` losses of drive contact,
    back-side impacts; ``spent`` (3,) net time in back, free, drive. Returns the last region.
    """
    width = polys.shape[2]
    p = scratch[0, :width]
    jacobian[0] = 1.0
    jacobian[1] = 0.0
    jacobian[2] = 0.0
    jacobian[3] = 1.0
    x0 = state[0] - region * b
    y0 = state[1]
    start = -1.0
    skip = 2  # the edge just crossed (0 lower, 1 upper), not to be crossed in the first piece
    for _ in range(MOST_CROSSINGS):
        if region != 0:
            for m in range(width):
                p[m] = polys[lane, PHI, m] * x0 + polys[lane, PSI, m] * y0 + polys[lane, NU, m]
        else:
            for m in range(width):
                p[m] = polys[lane, FREE_PSI, m] * y0 + polys[lane, FREE_NU, m]
            p[0] += x0
        low = -np.inf
        high = np.inf
        if region == 1:
            low = 0.0
        elif region == 0:
            low = -b
            high = b
        else:
            high = 0.0
        turns = _turns(p, start, found, scratch[1])
        a = start
        at = 2.0
        edge = 2
        for i in range(turns + 1):
            e = found[i] if i < turns else 1.0
            value = _value(p, e)
            if value < low and skip != 0:
                at = _root(p, low, a, e)
                edge = 0
                break
            if value > high and skip != 1:
                at = _root(p, high, a, e)
                edge = 1
                break
            skip = 2
            a = e
        if edge == 2:
            break
        y = _slope(p, at) / h
        # Phi of the region left behind, at the crossing
        time = h * at
        spent[region + 1] += time
        if region != 0:
            f11 = _value(polys[lane, PHI], at)
            f12 = _value(polys[lane, PSI], at)
            f21 = _slope(polys[lane, PHI], at) / h
            f22 = _slope(polys[lane, PSI], at) / h
        else:
            f11 = 1.0
            f12 = _value(polys[lane, FREE_PSI], at)
            f21 = 0.0
            f22 = _slope(polys[lane, FREE_PSI], at) / h
        j11 = f11 * jacobian[0] + f12 * jacobian[2]
        j12 = f11 * jacobian[1] + f12 * jacobian[3]
        j21 = f21 * jacobian[0] + f22 * jacobian[2]
        j22 = f21 * jacobian[1] + f22 * jacobian[3]
        if edge == 0:
            if region == 1:
                counts[0] += 1
            else:
                counts[1] += 1
            # upper edge of the region below; contact is measured from its own edge
            x = b if region == 1 else 0.0
            region -= 1
            skip = 1
        else:
            x = 0.0 if region == 0 else -b
            region += 1
            skip = 0
        spent[region + 1] -= time
        if region != 0:
            f11 = _value(polys[lane, PHI], at)
            f12 = _value(polys[lane, PSI], at)
            f21 = _slope(polys[lane, PHI], at) / h
            f22 = _slope(polys[lane, PSI], at) / h
            x -= _value(polys[lane, NU], at)
            y -= _slope(polys[lane, NU], at) / h
        else:
            f11 = 1.0
            f12 = _value(polys[lane, FREE_PSI], at)
            f21 = 0.0
            f22 = _slope(polys[lane, FREE_PSI], at) / h
            x -= _value(polys[lane, FREE_NU], at)
            y -= _slope(polys[lane, FREE_NU], at) / h
        det = f11 * f22 - f12 * f21
        x0 = (f22 * x - f12 * y) / det
        y0 = (f11 * y - f21 * x) / det
        jacobian[0] = (f22 * j11 - f12 * j21) / det
        jacobian[1] = (f22 * j12 - f12 * j22) / det
        jacobian[2] = (f11 * j21 - f21 * j11) / det
        jacobian[3] = (f11 * j22 - f21 * j12) / det
        start = at
    if region != 0:
        f11 = maps[0, lane]
        f21 = maps[1, lane]
        f12 = maps[2, lane]
        f22 = maps[3, lane]
        state[0] = f11 * x0 + f12 * y0 + maps[4, lane] + region * b
        state[1] = f21 * x0 + f22 * y0 + maps[5, lane]
    else:
        f11 = 1.0
        f21 = 0.0
        f12 = maps[6, lane]
        f22 = maps[7, lane]
        state[0] = x0 + f12 * y0 + maps[8, lane]
        state[1] = f22 * y0 + maps[9, lane]
    j11 = f11 * jacobian[0] + f12 * jacobian[2]
    j12 = f11 * jacobian[1] + f12 * jacobian[3]
    j21 = f21 * jacobian[0] + f22 * jacobian[2]
    j22 = f21 * jacobian[1] + f22 * jacobian[3]
    jacobian[0] = j11
    jacobian[1] = j12
    jacobian[2] = j21
    jacobian[3] = j22
    return region


@njit(nogil=True, cache=True, error_model="numpy")
def advance_exact(
    maps: Real,
    polys: Real,
    half: Real,
    reach: Real,
    backlash: Real,
    x: Real,
    y: Real,
    region: Whole,
    tangent: Real,
    columns: int,
    sections: Real,
    stretch: Real,
    samples: Real,
    marks: NDArray[np.uint8],
    counts: Whole,
    spent: Real,
) -> None:
    """Advance all lanes by ``len(sections)`` periods, in place.

    ``reach`` (lane) how far a hidden turn can swing in a sub-step; ``columns`` 0, 1 or 2
    tangent columns of ``tangent`` (4, lane) = m11, m12, m21, m22; with ``stretch`` (period,
    lane) not empty the first column is normalised every period and its logarithm stored.
    ``samples`` (period * marked, 2, lane): the state at the start of every sub-step that
    ``marks`` names, when not empty. ``counts`` (2, lane) and ``spent`` (3, lane) accumulate
    contact losses, back-side impacts, and the time in back, free and drive contact.
    """
    count = maps.shape[0]
    lanes = x.shape[0]
    taking = samples.shape[0] > 0
    normal = stretch.shape[0] > 0
    taken = 0
    fresh_x = np.empty(lanes)
    fresh_y = np.empty(lanes)
    doubt = np.zeros(lanes, np.uint8)
    queue = np.empty(lanes, np.int64)
    shift = np.empty(lanes)
    low = np.empty(lanes)
    high = np.empty(lanes)
    touch = np.empty(lanes)
    for i in range(lanes):
        shift[i] = region[i] * backlash[i]
        touch[i] = 1.0 if region[i] != 0 else 0.0
        low[i] = -np.inf if region[i] < 0 else (region[i] * 2 - 1) * backlash[i]
        high[i] = np.inf if region[i] > 0 else (region[i] * 2 + 1) * backlash[i]
    jacobian = np.empty(4)
    state = np.empty(2)
    scratch = np.empty((2, polys.shape[3]))
    found = np.empty(16)
    tally = np.zeros(2, np.int64)
    clock = np.zeros(3)
    for period in range(sections.shape[0]):
        for n in range(count):
            if taking and marks[n] != 0:
                samples[taken, 0, :] = x
                samples[taken, 1, :] = y
                taken += 1
            for i in range(lanes):
                contact = touch[i] != 0.0
                f11 = maps[n, 0, i] if contact else 1.0
                f21 = maps[n, 1, i] if contact else 0.0
                f12 = maps[n, 2, i] if contact else maps[n, 6, i]
                f22 = maps[n, 3, i] if contact else maps[n, 7, i]
                g1 = maps[n, 4, i] if contact else maps[n, 8, i]
                g2 = maps[n, 5, i] if contact else maps[n, 9, i]
                z = x[i] - shift[i]
                w = y[i]
                xn = f11 * z + f12 * w + g1 + shift[i]
                yn = f21 * z + f22 * w + g2
                fresh_x[i] = xn
                fresh_y[i] = yn
                # can the path between the ends have left the region?
                below = x[i] if x[i] < xn else xn
                above = x[i] if x[i] > xn else xn
                room_low = below - low[i]
                room_high = high[i] - above
                room = room_low if room_low < room_high else room_high
                speed = abs(w) if abs(w) > abs(yn) else abs(yn)
                swing = reach[i] + (2.0 * half[n, i] * speed if w * yn <= 0.0 else 0.0)
                doubt[i] = not (room > swing)
            waiting = 0
            for i in range(lanes):
                queue[waiting] = i
                waiting += doubt[i]
            if columns > 0:
                for i in range(lanes):
                    contact = touch[i] != 0.0
                    f11 = maps[n, 0, i] if contact else 1.0
                    f21 = maps[n, 1, i] if contact else 0.0
                    f12 = maps[n, 2, i] if contact else maps[n, 6, i]
                    f22 = maps[n, 3, i] if contact else maps[n, 7, i]
                    keep = doubt[i] != 0
                    a = tangent[0, i]
                    b = tangent[2, i]
                    tangent[0, i] = a if keep else f11 * a + f12 * b
                    tangent[2, i] = b if keep else f21 * a + f22 * b
                    if columns > 1:
                        a = tangent[1, i]
                        b = tangent[3, i]
                        tangent[1, i] = a if keep else f11 * a + f12 * b
                        tangent[3, i] = b if keep else f21 * a + f22 * b
            for w in range(waiting):
                i = queue[w]
                if not (abs(x[i]) < np.inf):
                    continue
                state[0] = x[i]
                state[1] = y[i]
                before = region[i]
                now = _contact_change(
                    polys[n],
                    maps[n],
                    i,
                    half[n, i],
                    backlash[i],
                    state,
                    before,
                    jacobian,
                    tally,
                    clock,
                    scratch,
                    found,
                )
                fresh_x[i] = state[0]
                fresh_y[i] = state[1]
                for m in range(2):
                    counts[m, i] += tally[m]
                    tally[m] = 0
                for m in range(3):
                    spent[m, i] += clock[m]
                    clock[m] = 0.0
                if now != before:
                    # the plain part of the bookkeeping books the whole sub-step at its end
                    spent[before + 1, i] += half[n, i]
                    spent[now + 1, i] -= half[n, i]
                    region[i] = now
                    shift[i] = now * backlash[i]
                    touch[i] = 1.0 if now != 0 else 0.0
                    low[i] = -np.inf if now < 0 else (now * 2 - 1) * backlash[i]
                    high[i] = np.inf if now > 0 else (now * 2 + 1) * backlash[i]
                for m in range(columns):
                    a = tangent[m, i]
                    b = tangent[2 + m, i]
                    tangent[m, i] = jacobian[0] * a + jacobian[1] * b
                    tangent[2 + m, i] = jacobian[2] * a + jacobian[3] * b
            for i in range(lanes):
                x[i] = fresh_x[i]
                y[i] = fresh_y[i]
                spent[region[i] + 1, i] += 2.0 * half[n, i]
        for i in range(lanes):
            sections[period, 0, i] = x[i]
            sections[period, 1, i] = y[i]
            if not (abs(x[i]) <= 1e6 * backlash[i] and abs(y[i]) < np.inf):
                x[i] = np.nan
                y[i] = np.nan
            if normal:
                size = np.sqrt(tangent[0, i] ** 2 + tangent[2, i] ** 2)
                stretch[period, i] = np.log(size)
                tangent[0, i] /= size
                tangent[2, i] /= size
