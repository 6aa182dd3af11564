"""Plain contact changes of many lanes at once, side by side in vector registers."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from thermogear.dynamics.kernels.affine import FREE_NU, FREE_PSI, NU, PHI, PSI

Real = NDArray[np.float64]
Whole = NDArray[np.int64]

ROOM = 24  # rows of work space


@njit(nogil=True, cache=True, error_model="numpy")
def place(frame: Real, i: int, region: int, backlash: float) -> None:
    """Origin shift, whether the teeth touch, and the edges of the region lane ``i`` is in."""
    frame[0, i] = region * backlash
    frame[1, i] = 1.0 if region != 0 else 0.0
    frame[2, i] = -np.inf if region < 0 else (region * 2 - 1) * backlash
    frame[3, i] = np.inf if region > 0 else (region * 2 + 1) * backlash


@njit(nogil=True, cache=True, error_model="numpy")
def cross_together(
    polys: Real,
    maps: Real,
    half: Real,
    reach: Real,
    backlash: Real,
    x: Real,
    y: Real,
    region: Whole,
    fresh_x: Real,
    fresh_y: Real,
    frame: Real,
    since: Real,
    tangent: Real,
    columns: int,
    queue: Whole,
    waiting: int,
    counts: Whole,
    spent: Real,
    lane: Whole,
    room: Real,
    curve: Real,
    basis: Real,
) -> int:
    """Take the plain contact changes of one sub-step; the number of lanes left in ``queue``.

    A change is plain when the path starts inside its region, ends beyond one edge, has no room
    for a hidden turn there (the velocity or both distances exceed what the jerk can swing), and
    then stays in the next region. Of the first ``waiting`` lanes of ``queue`` the others are
    moved to its front. Cubic Hermite start from the two end states, two Newton updates on the
    exact polynomial, then the hand-over.

    ``frame`` and ``region`` follow, ``since`` (lane) is the time from the period's start.
    ``lane`` (lane), ``room`` (ROOM, lane), ``curve`` (3, K + 1, lane) and ``basis``
    (3, K + 1, lane) are work space.
    """
    width = polys.shape[2]
    left = 0
    count = 0
    for w in range(waiting):
        i = queue[w]
        r = region[i]
        b = backlash[i]
        h = half[i]
        z0 = x[i] - r * b
        y0 = y[i]
        y1 = fresh_y[i]
        slow = abs(y0) if abs(y0) < abs(y1) else abs(y1)
        z1 = fresh_x[i] - r * b
        level = 0.0
        if r == 0:
            level = b if z1 > 0.0 else -b
        d0 = z0 - level
        d1 = z1 - level
        near = abs(d0) if abs(d0) < abs(d1) else abs(d1)
        plain = (y0 * y1 > 0.0 and h * slow > reach[i]) or near > reach[i]
        if not (plain and d0 * d1 < 0.0 and (r == 0 or (d0 > 0.0) == (r > 0))):
            queue[left] = i
            left += 1
            continue
        lane[count] = i
        room[0, count] = level
        room[1, count] = d0
        room[2, count] = d1
        room[3, count] = 2.0 * h * y0
        room[4, count] = 2.0 * h * y1
        room[5, count] = h
        if r != 0:
            for m in range(width):
                curve[0, m, count] = polys[i, PHI, m] * z0 + polys[i, PSI, m] * y0 + polys[i, NU, m]
        else:
            for m in range(width):
                curve[0, m, count] = polys[i, FREE_PSI, m] * y0 + polys[i, FREE_NU, m]
            curve[0, 0, count] += z0
        # the tangent columns follow the same polynomials without the forced part
        for c in range(columns):
            a = tangent[c, i]
            s = tangent[2 + c, i]
            if r != 0:
                for m in range(width):
                    curve[1 + c, m, count] = polys[i, PHI, m] * a + polys[i, PSI, m] * s
            else:
                for m in range(width):
                    curve[1 + c, m, count] = polys[i, FREE_PSI, m] * s
                curve[1 + c, 0, count] += a
        # the next region's polynomials, lane by lane beside each other
        if r == 0:
            for m in range(width):
                basis[0, m, count] = polys[i, PHI, m]
                basis[1, m, count] = polys[i, PSI, m]
                basis[2, m, count] = polys[i, NU, m]
        else:
            for m in range(width):
                basis[0, m, count] = 0.0
                basis[1, m, count] = polys[i, FREE_PSI, m]
                basis[2, m, count] = polys[i, FREE_NU, m]
            basis[0, 0, count] = 1.0
        count += 1
    if count == 0:
        return left
    for k in range(count):
        d0 = room[1, k]
        s0 = room[3, k]
        s1 = room[4, k]
        delta = room[2, k] - d0
        c3 = s0 + s1 - 2.0 * delta
        c2 = 3.0 * delta - 2.0 * s0 - s1
        t = -d0 / delta
        t -= (((c3 * t + c2) * t + s0) * t + d0) / ((3.0 * c3 * t + 2.0 * c2) * t + s0)
        t -= (((c3 * t + c2) * t + s0) * t + d0) / ((3.0 * c3 * t + 2.0 * c2) * t + s0)
        u = 2.0 * t - 1.0
        u = -1.0 if u < -1.0 else u
        u = 1.0 if u > 1.0 else u
        room[6, k] = u
    for turn in range(2):
        for k in range(count):
            p = curve[0, width - 1, k]
            room[7, k] = p
            room[8, k] = (width - 1.0) * p
            room[9, k] = (width - 1.0) * (width - 2.0) * p
        for m in range(width - 2, 1, -1):
            for k in range(count):
                u = room[6, k]
                p = curve[0, m, k]
                room[7, k] = room[7, k] * u + p
                room[8, k] = room[8, k] * u + m * p
                room[9, k] = room[9, k] * u + m * (m - 1.0) * p
        for k in range(count):
            u = room[6, k]
            p = curve[0, 1, k]
            value = (room[7, k] * u + p) * u + (curve[0, 0, k] - room[0, k])
            slope = room[8, k] * u + p
            move = -value / slope
            u += move
            if turn == 0:
                u = -1.0 if u < -1.0 else u
                u = 1.0 if u > 1.0 else u
            room[6, k] = u
            # the last move is so short that the velocity needs one Taylor term only
            room[10, k] = (slope + room[9, k] * move) / room[5, k]
            room[11, k] = abs(move)
    for k in range(count):
        for q in range(6):
            room[12 + q, k] = 0.0
    for m in range(width - 1, 0, -1):
        for k in range(count):
            u = room[6, k]
            for q in range(3):
                p = basis[q, m, k]
                room[12 + 2 * q, k] = room[12 + 2 * q, k] * u + p
                room[13 + 2 * q, k] = room[13 + 2 * q, k] * u + m * p
    for c in range(columns):
        for k in range(count):
            room[18 + 2 * c, k] = 0.0
            room[19 + 2 * c, k] = 0.0
        for m in range(width - 1, 0, -1):
            for k in range(count):
                u = room[6, k]
                p = curve[1 + c, m, k]
                room[18 + 2 * c, k] = room[18 + 2 * c, k] * u + p
                room[19 + 2 * c, k] = room[19 + 2 * c, k] * u + m * p
    for k in range(count):
        i = lane[k]
        r = region[i]
        b = backlash[i]
        h = room[5, k]
        u = room[6, k]
        y0 = room[10, k]
        up = room[2, k] > 0.0
        now = r + 1 if up else r - 1
        # where the edge stands, measured from the next region's own origin
        edge = 0.0 if now != 0 else (b if r > 0 else -b)
        f11 = room[12, k] * u + basis[0, 0, k]
        f21 = room[13, k] / h
        f12 = room[14, k] * u + basis[1, 0, k]
        f22 = room[15, k] / h
        dx = edge - (room[16, k] * u + basis[2, 0, k])
        dy = y0 - room[17, k] / h
        det = f11 * f22 - f12 * f21
        z = (f22 * dx - f12 * dy) / det
        s = (f11 * dy - f21 * dx) / det
        if now != 0:
            m11 = maps[0, i]
            m21 = maps[1, i]
            m12 = maps[2, i]
            m22 = maps[3, i]
            z1 = m11 * z + m12 * s + maps[4, i]
            y1 = m21 * z + m22 * s + maps[5, i]
        else:
            m11 = 1.0
            m21 = 0.0
            m12 = maps[6, i]
            m22 = maps[7, i]
            z1 = z + m12 * s + maps[8, i]
            y1 = m22 * s + maps[9, i]
        # does the path stay in the next region, between its ends too?
        away = z1 - edge if up else edge - z1
        other = np.inf if now != 0 else 2.0 * b - (away if away > 0.0 else 0.0)
        slow = abs(y0) if abs(y0) < abs(y1) else abs(y1)
        swing = 2.0 * reach[i] + (h * slow if y0 * y1 <= 0.0 else 0.0)
        settled = room[11, k] < 1e-7 and -1.0 <= u <= 1.0 and (y0 > 0.0) == up
        if not (settled and away > reach[i] and other > swing):
            queue[left] = i
            left += 1
            continue
        fresh_x[i] = z1 + now * b
        fresh_y[i] = y1
        region[i] = now
        if not up:
            counts[0 if r == 1 else 1, i] += 1
        place(frame, i, now, b)
        # the caller books the whole period for the region at its end
        time = since[i] + (h * u + h)
        spent[r + 1, i] += time
        spent[now + 1, i] -= time
        for c in range(columns):
            ta = room[18 + 2 * c, k] * u + curve[1 + c, 0, k]
            tb = room[19 + 2 * c, k] / h
            za = (f22 * ta - f12 * tb) / det
            zb = (f11 * tb - f21 * ta) / det
            tangent[c, i] = m11 * za + m12 * zb
            tangent[2 + c, i] = m21 * za + m22 * zb
    return left
