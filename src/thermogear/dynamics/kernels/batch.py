"""Contact changes of eight lanes at once, wherever those lanes stand."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Whole
from thermogear.dynamics.kernels.affine import (
    FREE_NU,
    FREE_PSI,
    GAP,
    HALF,
    NU,
    PHI,
    PSI,
    REACH,
    SINCE,
)
from thermogear.dynamics.kernels.compiled import part
from thermogear.dynamics.kernels.vector import EIGHT, bits, choose, drop, load, pick, store, turn

Real = NDArray[np.float64]

# rows of what a lane carries along: state, origin and edges of its region, twice its reach, half
# backlash, period, time spent in back, free and drive contact, losses and impacts, tangent
X, Y, SHIFT, LOW, HIGH, DOUBLE, OWN_GAP, WHOLE, SPENT, LOSSES, TANGENT = (
    0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13,
)  # fmt: skip
CARRIED = 17
# the queue of waiting lanes stands behind the eight that are taken and the places of their curves
QUEUE = 16


@part
def runs_on(y0: Any, y1: Any, h: Any, reach: Any) -> Any:
    """Whether the velocity keeps its sign between ``y0`` and ``y1``, a sub-step or less apart.

    It leaves the chord by half of |x'''| h**2 at most: half of ``reach`` / h from the force and,
    beside an edge, 0.045 of the speed from the stiffness (h sqrt(k) <= 0.3), less from its change
    and from the damping: an eighth of the speed bounds them together.
    """
    less = abs(y0) < abs(y1)
    slow = choose(less, abs(y0), abs(y1))
    fast = choose(less, abs(y1), abs(y0))
    return (y0 * y1 > 0.0) & (h * (slow - 0.125 * fast) > reach)


@part
def cross_eight(
    curves: Real,
    carried: Real,
    stride: int,
    columns: int,
    taken: Whole,
    table: Real,
    p: Real,
    width: int,
) -> int:
    """Take the plain contact changes of eight lanes through their sub-step.

    A change is plain when the path starts inside its region, ends beyond one edge, has no room
    for a hidden turn there (the velocity or both distances exceed what the jerk can swing), and
    then stays in the next region. Cubic Hermite start from the two end states, two Newton updates
    on the exact polynomial, then the hand-over. The answer names the lanes, as bits, that are not
    done; a path that did stay inside is done too.

    ``taken`` (2, 8): where each lane stands in a row of ``carried`` (CARRIED, ``stride``), and the
    first number of its sub-step in ``curves``. A lane may be named more than once. Work space:
    ``table`` (as long as a row of ``curves``, 8), ``p`` (``width`` = K + 1, 8). All are flat.
    """
    turn(curves, taken, EIGHT, table, table.size // EIGHT)
    behind = 5 * width * EIGHT
    b = load(table, behind + GAP * EIGHT)
    reach = load(table, behind + REACH * EIGHT)
    h = load(table, behind + HALF * EIGHT)
    shift = pick(carried, SHIFT * stride, taken, 0)
    x_old = pick(carried, X * stride, taken, 0)
    y_old = pick(carried, Y * stride, taken, 0)
    contact = shift != 0.0
    drive = shift > 0.0
    # the whole sub-step in the region it begins in
    s11 = choose(contact, load(table, behind), 1.0)
    s21 = choose(contact, load(table, behind + EIGHT), 0.0)
    s12 = choose(contact, load(table, behind + 2 * EIGHT), load(table, behind + 6 * EIGHT))
    s22 = choose(contact, load(table, behind + 3 * EIGHT), load(table, behind + 7 * EIGHT))
    n1 = choose(contact, load(table, behind + 4 * EIGHT), load(table, behind + 8 * EIGHT))
    n2 = choose(contact, load(table, behind + 5 * EIGHT), load(table, behind + 9 * EIGHT))
    z0 = x_old - shift
    x_new = s11 * z0 + s12 * y_old + n1 + shift
    y_new = s21 * z0 + s22 * y_old + n2
    straight = runs_on(y_old, y_new, h, reach)
    rising = x_old < x_new
    low = choose(contact, choose(drive, b, -np.inf), -b)
    high = choose(contact, choose(drive, np.inf, -b), b)
    inside = straight & (low < choose(rising, x_old, x_new))
    inside = inside & (choose(rising, x_new, x_old) < high)
    z1 = x_new - shift
    level = choose(contact, 0.0, choose(z1 > 0.0, b, -b))
    d0 = z0 - level
    d1 = z1 - level
    near = choose(abs(d0) < abs(d1), abs(d0), abs(d1))
    up = d1 > 0.0
    good = (straight | (near > reach)) & (d0 * d1 < 0.0) & (~contact | ~((d0 > 0.0) ^ drive))
    # the path, measured from the edge
    for m in range(width):
        phi = load(table, EIGHT * (PHI * width + m))
        psi = load(table, EIGHT * (PSI * width + m))
        nu = load(table, EIGHT * (NU * width + m))
        free_psi = load(table, EIGHT * (FREE_PSI * width + m))
        free_nu = load(table, EIGHT * (FREE_NU * width + m))
        store(
            p, EIGHT * m, choose(contact, phi * z0 + psi * y_old + nu, free_psi * y_old + free_nu)
        )
    first = load(p, 0)
    store(p, 0, choose(contact, first, first + z0) - level)
    # a cubic through both ends gives the start
    s0 = 2.0 * h * y_old
    s1 = 2.0 * h * y_new
    delta = d1 - d0
    c3 = s0 + s1 - 2.0 * delta
    c2 = 3.0 * delta - 2.0 * s0 - s1
    t = -d0 / delta
    t = t - (((c3 * t + c2) * t + s0) * t + d0) / ((3.0 * c3 * t + 2.0 * c2) * t + s0)
    u = 2.0 * t - 1.0
    u = choose(u > -1.0, u, -1.0)
    u = choose(u < 1.0, u, 1.0)
    slope = u
    bend = u
    move = u
    for _ in range(2):
        value = load(p, EIGHT * (width - 1))
        slope = value * 0.0
        bend = slope
        for m in range(width - 2, -1, -1):
            bend = bend * u + slope
            slope = slope * u + value
            value = value * u + load(p, EIGHT * m)
        move = value * slope / (value * bend - slope * slope)
        u = u + move
    # the last move is so short that the velocity needs one Taylor term only
    y0 = (slope + 2.0 * bend * move) / h
    # the fundamental solutions of the next region at the crossing
    f11 = load(table, EIGHT * (PHI * width + width - 1))
    f12 = choose(
        contact,
        load(table, EIGHT * (FREE_PSI * width + width - 1)),
        load(table, EIGHT * (PSI * width + width - 1)),
    )
    g1 = choose(
        contact,
        load(table, EIGHT * (FREE_NU * width + width - 1)),
        load(table, EIGHT * (NU * width + width - 1)),
    )
    f21 = f11 * 0.0
    f22 = f21
    g2 = f21
    for m in range(width - 2, -1, -1):
        f21 = f21 * u + f11
        f22 = f22 * u + f12
        g2 = g2 * u + g1
        f11 = f11 * u + load(table, EIGHT * (PHI * width + m))
        f12 = f12 * u + choose(
            contact,
            load(table, EIGHT * (FREE_PSI * width + m)),
            load(table, EIGHT * (PSI * width + m)),
        )
        g1 = g1 * u + choose(
            contact,
            load(table, EIGHT * (FREE_NU * width + m)),
            load(table, EIGHT * (NU * width + m)),
        )
    f11 = choose(contact, 1.0, f11)
    f21 = choose(contact, 0.0, f21 / h)
    f22 = f22 / h
    # where the edge stands, measured from the next region's own origin
    edge = choose(contact, choose(drive, b, -b), 0.0)
    dx = edge - g1
    dy = y0 - g2 / h
    det = f11 * f22 - f12 * f21
    z = (f22 * dx - f12 * dy) / det
    s = (f11 * dy - f21 * dx) / det
    m11 = choose(contact, 1.0, load(table, behind))
    m21 = choose(contact, 0.0, load(table, behind + EIGHT))
    m12 = choose(contact, load(table, behind + 6 * EIGHT), load(table, behind + 2 * EIGHT))
    m22 = choose(contact, load(table, behind + 7 * EIGHT), load(table, behind + 3 * EIGHT))
    n1 = choose(contact, load(table, behind + 8 * EIGHT), load(table, behind + 4 * EIGHT))
    n2 = choose(contact, load(table, behind + 9 * EIGHT), load(table, behind + 5 * EIGHT))
    z1 = m11 * z + m12 * s + n1
    y1 = m21 * z + m22 * s + n2
    # does the path stay in the next region, between its ends too?
    away = choose(up, z1 - edge, edge - z1)
    beyond = choose(contact, 2.0 * b - choose(away > 0.0, away, 0.0), np.inf)
    slow = choose(abs(y0) < abs(y1), abs(y0), abs(y1))
    swing = 2.0 * reach + choose(y0 * y1 <= 0.0, h * slow, 0.0)
    good = good & (abs(move) < 1e-7) & (u >= -1.0) & (u <= 1.0) & ~((y0 > 0.0) ^ up)
    good = good & ((away > reach) | ((away > 0.0) & runs_on(y0, y1, h, reach)))
    good = good & (beyond > swing) & ~inside
    now = choose(contact, 0.0, choose(up, b, -b))
    drop(carried, X * stride, taken, choose(good, z1 + now, choose(inside, x_new, x_old)))
    drop(carried, Y * stride, taken, choose(good, y1, choose(inside, y_new, y_old)))
    drop(carried, SHIFT * stride, taken, choose(good, now, shift))
    border = choose(contact, -b, choose(up, b, -np.inf))
    drop(carried, LOW * stride, taken, choose(good, border, low))
    border = choose(contact, b, choose(up, np.inf, -b))
    drop(carried, HIGH * stride, taken, choose(good, border, high))
    # the caller books the whole period for the region at its end
    time = load(table, behind + SINCE * EIGHT) + (h * u + h)
    time = choose(good, time, 0.0)
    for m in range(3):
        # back, free, drive: what is left gains, what is entered loses
        here = (m - 1.0) * b
        gain = choose(shift == here, time, 0.0) - choose(now == here, time, 0.0)
        drop(
            carried,
            (SPENT + m) * stride,
            taken,
            pick(carried, (SPENT + m) * stride, taken, 0) + gain,
        )
    lost = choose(good & drive, 1.0, 0.0)
    hit = choose(good & ~contact & ~up, 1.0, 0.0)
    drop(carried, LOSSES * stride, taken, pick(carried, LOSSES * stride, taken, 0) + lost)
    drop(
        carried, (LOSSES + 1) * stride, taken, pick(carried, (LOSSES + 1) * stride, taken, 0) + hit
    )
    for c in range(columns):
        # the tangent follows the same polynomials without the forced part
        one = (TANGENT + c) * stride
        two = (TANGENT + 2 + c) * stride
        a = pick(carried, one, taken, 0)
        w = pick(carried, two, taken, 0)
        value = a * 0.0
        slope = value
        for m in range(width - 1, -1, -1):
            touched = load(table, EIGHT * (PHI * width + m)) * a
            touched = touched + load(table, EIGHT * (PSI * width + m)) * w
            loose = load(table, EIGHT * (FREE_PSI * width + m)) * w
            if m == 0:
                loose = loose + a
            slope = slope * u + value
            value = value * u + choose(contact, touched, loose)
        slope = slope / h
        za = (f22 * value - f12 * slope) / det
        zb = (f11 * slope - f21 * value) / det
        stayed = choose(inside, s11 * a + s12 * w, a)
        drop(carried, one, taken, choose(good, m11 * za + m12 * zb, stayed))
        stayed = choose(inside, s21 * a + s22 * w, w)
        drop(carried, two, taken, choose(good, m21 * za + m22 * zb, stayed))
    undone: int = bits(~(good | inside))
    return undone
