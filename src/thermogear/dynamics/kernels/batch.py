"""Plain contact changes of many lanes at once, side by side in vector registers."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from thermogear.dynamics.kernels.affine import FREE_NU, FREE_PSI, NU, PHI, PSI
from thermogear.dynamics.kernels.vector import EIGHT, horner

Real = NDArray[np.float64]
Whole = NDArray[np.int64]

AT, MOVE, UP, DOWN, RISE, FALL = 0, 1, 2, 3, 4, 5
ROOM = 6  # rows of work space


@njit(nogil=True, cache=True, error_model="numpy")
def place(frame: Real, i: int, region: int, backlash: float) -> None:
    """Origin shift, whether the teeth touch, and the edges of the region lane ``i`` is in."""
    frame[0, i] = region * backlash
    frame[1, i] = 1.0 if region != 0 else 0.0
    frame[2, i] = -np.inf if region < 0 else (region * 2 - 1) * backlash
    frame[3, i] = np.inf if region > 0 else (region * 2 + 1) * backlash


@njit(nogil=True, cache=True, error_model="numpy")
def runs_on(y0: float, y1: float, h: float, reach: float) -> bool:
    """Whether the velocity keeps its sign between ``y0`` and ``y1``, a sub-step or less apart.

    It leaves the chord by half of |x'''| h**2 at most: half of ``reach`` / h from the force and,
    beside an edge, 0.045 of the speed from the stiffness (h sqrt(k) <= 0.3), less from its change
    and from the damping: an eighth of the speed bounds them together.
    """
    slow = abs(y0) if abs(y0) < abs(y1) else abs(y1)
    fast = abs(y1) if abs(y0) < abs(y1) else abs(y0)
    return y0 * y1 > 0.0 and h * (slow - 0.125 * fast) > reach


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
    other: Whole,
    lane: Whole,
    room: Real,
    curve: Real,
    basis: Real,
    found: Real,
) -> int:
    """Take the plain contact changes of one sub-step; the number of lanes left in ``queue``.

    A change is plain when the path starts inside its region, ends beyond one edge, has no room
    for a hidden turn there (the velocity or both distances exceed what the jerk can swing), and
    then stays in the next region. Of the first ``waiting`` lanes of ``queue`` the others are
    moved to its front. Cubic Hermite start from the two end states, two Newton updates on the
    exact polynomial, then the hand-over.

    ``frame`` and ``region`` follow, ``since`` (lane) is the time from the period's start.
    Work space, for eight lanes are taken at a time: ``other`` (lane), ``lane`` (8), ``room``
    (ROOM, 8), ``curve`` and ``basis`` (3, K + 1, 8), ``found`` (6, 3, 8).
    """
    width = polys.shape[2]
    # lanes in contact first: what follows then takes the same branch for long
    touching = 0
    free = 0
    for w in range(waiting):
        i = queue[w]
        contact = 1 if frame[1, i] != 0.0 else 0
        queue[touching] = i
        other[free] = i
        touching += contact
        free += 1 - contact
    for w in range(free):
        queue[touching + w] = other[w]
    left = 0
    w = 0
    while w < waiting:
        count = 0
        while w < waiting and count < EIGHT:
            i = queue[w]
            w += 1
            r = region[i]
            b = backlash[i]
            h = half[i]
            z0 = x[i] - r * b
            y0 = y[i]
            y1 = fresh_y[i]
            straight = runs_on(y0, y1, h, reach[i])
            if (
                straight
                and frame[2, i] < min(x[i], fresh_x[i])
                and max(x[i], fresh_x[i]) < frame[3, i]
            ):
                # it stays inside: only the tangent is left to do
                for c in range(columns):
                    a = tangent[c, i]
                    s = tangent[2 + c, i]
                    if r != 0:
                        tangent[c, i] = maps[0, i] * a + maps[2, i] * s
                        tangent[2 + c, i] = maps[1, i] * a + maps[3, i] * s
                    else:
                        tangent[c, i] = a + maps[6, i] * s
                        tangent[2 + c, i] = maps[7, i] * s
                continue
            z1 = fresh_x[i] - r * b
            level = 0.0
            if r == 0:
                level = b if z1 > 0.0 else -b
            d0 = z0 - level
            d1 = z1 - level
            near = abs(d0) if abs(d0) < abs(d1) else abs(d1)
            plain = straight or near > reach[i]
            if not (plain and d0 * d1 < 0.0 and (r == 0 or (d0 > 0.0) == (r > 0))):
                queue[left] = i
                left += 1
                continue
            lane[count] = i
            room[UP, count] = d0
            room[DOWN, count] = d1
            room[RISE, count] = 2.0 * h * y0
            room[FALL, count] = 2.0 * h * y1
            # the path, and the polynomials of the next region
            if r != 0:
                for m in range(width):
                    curve[0, m, count] = (
                        polys[i, PHI, m] * z0 + polys[i, PSI, m] * y0 + polys[i, NU, m]
                    )
                for m in range(width):
                    basis[1, m, count] = polys[i, FREE_PSI, m]
                    basis[2, m, count] = polys[i, FREE_NU, m]
            else:
                for m in range(width):
                    curve[0, m, count] = polys[i, FREE_PSI, m] * y0 + polys[i, FREE_NU, m]
                curve[0, 0, count] += z0
                for m in range(width):
                    basis[0, m, count] = polys[i, PHI, m]
                    basis[1, m, count] = polys[i, PSI, m]
                    basis[2, m, count] = polys[i, NU, m]
            curve[0, 0, count] -= level
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
            count += 1
        if count == 0:
            break
        for k in range(count):
            # a cubic through both ends gives the start
            d0 = room[UP, k]
            s0 = room[RISE, k]
            s1 = room[FALL, k]
            delta = room[DOWN, k] - d0
            c3 = s0 + s1 - 2.0 * delta
            c2 = 3.0 * delta - 2.0 * s0 - s1
            t = -d0 / delta
            t -= (((c3 * t + c2) * t + s0) * t + d0) / ((3.0 * c3 * t + 2.0 * c2) * t + s0)
            room[AT, k] = min(max(2.0 * t - 1.0, -1.0), 1.0)
        for _ in range(2):
            horner(curve[0], room[AT], found[0])
            for k in range(EIGHT):
                value = found[0, 0, k]
                slope = found[0, 1, k]
                move = value * slope / (value * found[0, 2, k] - slope * slope)
                room[AT, k] += move
                room[MOVE, k] = move
        for q in range(3):
            horner(basis[q], room[AT], found[1 + q])
        for c in range(columns):
            horner(curve[1 + c], room[AT], found[4 + c])
        for k in range(count):
            i = lane[k]
            r = region[i]
            b = backlash[i]
            h = half[i]
            u = room[AT, k]
            # the last move is so short that the velocity needs one Taylor term only
            y0 = (found[0, 1, k] + 2.0 * found[0, 2, k] * room[MOVE, k]) / h
            up = room[DOWN, k] > 0.0
            now = r + 1 if up else r - 1
            # where the edge stands, measured from the next region's own origin
            edge = 0.0 if now != 0 else (b if r > 0 else -b)
            f11 = found[1, 0, k] if now != 0 else 1.0
            f21 = found[1, 1, k] / h if now != 0 else 0.0
            f12 = found[2, 0, k]
            f22 = found[2, 1, k] / h
            dx = edge - found[3, 0, k]
            dy = y0 - found[3, 1, k] / h
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
            beyond = np.inf if now != 0 else 2.0 * b - (away if away > 0.0 else 0.0)
            slow = abs(y0) if abs(y0) < abs(y1) else abs(y1)
            swing = 2.0 * reach[i] + (h * slow if y0 * y1 <= 0.0 else 0.0)
            settled = abs(room[MOVE, k]) < 1e-7 and -1.0 <= u <= 1.0 and (y0 > 0.0) == up
            clear = away > reach[i] or (away > 0.0 and runs_on(y0, y1, h, reach[i]))
            if not (settled and clear and beyond > swing):
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
                ta = found[4 + c, 0, k]
                tb = found[4 + c, 1, k] / h
                za = (f22 * ta - f12 * tb) / det
                zb = (f11 * tb - f21 * ta) / det
                tangent[c, i] = m11 * za + m12 * zb
                tangent[2 + c, i] = m21 * za + m22 * zb
    return left
