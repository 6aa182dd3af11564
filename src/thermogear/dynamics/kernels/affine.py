"""The affine maps of a piecewise-linear oscillator on the sub-steps of its period.

Between contact changes x'' + c x' + k(t) (x - r b) = F(t) is linear, r = 1 on the drive side,
0 inside the backlash (where k acts on nothing), -1 on the back side. On a sub-step of half
width h, u in [-1, 1],

    x(u) - r b = phi(u) (x_0 - r b) + psi(u) y_0 + nu(u),     y = dx/dt,

with polynomials centred on the sub-step that depend on parameters only. ``curves`` holds lane by
lane their coefficients and what belongs to them, ``steps`` what a plain sub-step of eight lanes
needs: values and rates of phi, psi, nu, free psi, free nu at u = 1, and the half width.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Whole
from thermogear.dynamics.kernels.compiled import kernel
from thermogear.dynamics.kernels.vector import EIGHT, load, pick, store, turn

Real = NDArray[np.float64]

PHI, PSI, NU, FREE_PSI, FREE_NU = 0, 1, 2, 3, 4
# behind the polynomials of a lane's sub-step: their values and rates at u = 1, the half width, the
# time since the period began, the half backlash, and how far a hidden turn can swing
HALF, SINCE, GAP, REACH = 10, 11, 12, 13
BEHIND = 14


@kernel
def prepare(
    damping: Real,
    backlash: Real,
    reach: Real,
    half: Real,
    stiffness: Real,
    force: Real,
    steps: Real,
    curves: Real,
    work: Real,
    tables: Real,
    ends: Real,
    table: Real,
    turned: Real,
    at: Whole,
) -> None:
    """Fill ``steps`` (N, group, 11, 8), if it is not empty, and ``curves`` (N, lane, 5 (K + 1) +
    14 and more), which has the same numbers behind the polynomials.

    ``damping``, ``backlash`` and ``reach`` (lane), ``half`` (N, lane) half widths in time,
    ``stiffness`` and ``force`` (N, lane, K + 1): Taylor coefficients in u of k and F about the
    centre of each sub-step. Eight lanes are a group; what a last group has no lane for is zero. All
    are flat. Work space: ``work`` (5 (K + 1), 8), ``tables`` (2 (K + 1), 8), ``ends`` (10, 8),
    ``table`` (room, 8), ``turned`` (8, 8), ``at`` (2, 8).
    """
    lanes = damping.size
    count = half.size // lanes
    full = work.size // 5
    width = full // EIGHT
    order = width - 1
    groups = -(-lanes // EIGHT)
    full_steps = steps.size > 0
    room = table.size // EIGHT
    for group in range(groups):
        here = min(EIGHT, lanes - EIGHT * group)
        for i in range(EIGHT):
            at[i] = EIGHT * group + min(i, here - 1)
        c = pick(damping, 0, at, 0)
        elapsed = c * 0.0
        for n in range(count):
            row = (n * groups + group) * 11 * EIGHT
            h = pick(half, n * lanes, at, 0)
            ch = c * h
            hh = h * h
            for i in range(EIGHT):
                at[EIGHT + i] = at[i] * width
            for m in range(width):
                base = n * lanes * width + m
                store(tables, EIGHT * m, pick(stiffness, base, at, EIGHT))
                store(tables, full + EIGHT * m, pick(force, base, at, EIGHT))
            # from the centre: cosine-like, sine-like and forced solution, contact then free
            zero = h * 0.0
            for q in range(5):
                store(work, q * full, zero + (1.0 if q == 0 else 0.0))
                store(work, q * full + EIGHT, zero + (1.0 if q == 1 or q == 3 else 0.0))
            for m in range(order - 1):
                s0 = h * 0.0
                s1 = s0
                s2 = s0
                for i in range(m + 1):
                    k = load(tables, EIGHT * i)
                    past = EIGHT * (m - i)
                    s0 = s0 + k * load(work, past)
                    s1 = s1 + k * load(work, full + past)
                    s2 = s2 + k * load(work, 2 * full + past)
                scale = 1.0 / ((m + 2.0) * (m + 1.0))
                drag = ch * (m + 1.0)
                push = hh * load(tables, full + EIGHT * m)
                now = EIGHT * (m + 1)
                new = now + EIGHT
                store(work, new, -(drag * load(work, now) + hh * s0) * scale)
                store(work, full + new, -(drag * load(work, full + now) + hh * s1) * scale)
                pull = drag * load(work, 2 * full + now) + hh * s2
                store(work, 2 * full + new, (push - pull) * scale)
                store(work, 3 * full + new, -drag * load(work, 3 * full + now) * scale)
                store(work, 4 * full + new, (push - drag * load(work, 4 * full + now)) * scale)
            # values and slopes at the left end u = -1
            for q in range(5):
                value = h * 0.0
                rate = value
                for m in range(order, 0, -1):
                    sign = -1.0 if m % 2 else 1.0
                    part = load(work, q * full + EIGHT * m)
                    value = value + sign * part
                    rate = rate - sign * m * part
                store(ends, 2 * EIGHT * q, value + load(work, q * full))
                store(ends, 2 * EIGHT * q + EIGHT, rate)
            left0 = load(ends, 0)
            left1 = load(ends, 2 * EIGHT)
            left2 = load(ends, 4 * EIGHT)
            slope0 = load(ends, EIGHT)
            slope1 = load(ends, 3 * EIGHT)
            slope2 = load(ends, 5 * EIGHT)
            slope3 = load(ends, 7 * EIGHT)
            # hand the free constants to the left end: phi, psi, nu
            det = left0 * slope1 - left1 * slope0
            a = slope1 / det
            b = -slope0 / det
            bent = -h * left1 / det
            d = h * left0 / det
            e = (left1 * slope2 - slope1 * left2) / det
            f = (slope0 * left2 - left0 * slope2) / det
            g = h / slope3
            r = -load(ends, 9 * EIGHT) / slope3
            for m in range(width):
                w0 = load(work, EIGHT * m)
                w1 = load(work, full + EIGHT * m)
                w3 = load(work, 3 * full + EIGHT * m)
                store(table, PHI * full + EIGHT * m, a * w0 + b * w1)
                store(table, PSI * full + EIGHT * m, bent * w0 + d * w1)
                forced = load(work, 2 * full + EIGHT * m) + (e * w0 + f * w1)
                store(table, NU * full + EIGHT * m, forced)
                store(table, FREE_PSI * full + EIGHT * m, g * w3)
                forced = load(work, 4 * full + EIGHT * m) + r * w3
                store(table, FREE_NU * full + EIGHT * m, forced)
            left3 = load(ends, 6 * EIGHT)
            store(table, FREE_PSI * full, load(table, FREE_PSI * full) - g * left3)
            shift = load(ends, 8 * EIGHT) + r * left3
            store(table, FREE_NU * full, load(table, FREE_NU * full) - shift)
            for q in range(5):
                value = h * 0.0
                rate = value
                for m in range(order, 0, -1):
                    part = load(table, q * full + EIGHT * m)
                    value = value + part
                    rate = rate + float(m) * part
                value = value + load(table, q * full)
                rate = rate / h
                if full_steps:
                    store(steps, row + 2 * q * EIGHT, value)
                    store(steps, row + (2 * q + 1) * EIGHT, rate)
                store(table, 5 * full + 2 * q * EIGHT, value)
                store(table, 5 * full + (2 * q + 1) * EIGHT, rate)
            if full_steps:
                store(steps, row + HALF * EIGHT, h)
                for i in range(here, EIGHT):
                    for q in range(11):
                        steps[row + EIGHT * q + i] = 0.0
            store(table, 5 * full + HALF * EIGHT, h)
            store(table, 5 * full + SINCE * EIGHT, elapsed)
            store(table, 5 * full + GAP * EIGHT, pick(backlash, 0, at, 0))
            store(table, 5 * full + REACH * EIGHT, pick(reach, 0, at, 0))
            elapsed = elapsed + 2.0 * h
            for first in range(0, room, EIGHT):
                for i in range(EIGHT):
                    at[EIGHT + i] = EIGHT * (first + i)
                turn(table, at, EIGHT, turned, EIGHT)
                for i in range(here):
                    store(curves, (n * lanes + at[i]) * room + first, load(turned, EIGHT * i))


@kernel
def add_harmonics(
    real: Real,
    imag: Real,
    cosine: Real,
    sine: Real,
    even: Real,
    odd: Real,
    which: NDArray[np.int64],
    out: Real,
) -> None:
    """Add the Taylor coefficients of harmonics to ``out`` (N, lane, K + 1).

    ``real``, ``imag`` (rank, lane) of their coefficients, ``cosine``, ``sine`` (rank, N) of their
    angles at the centres; ``even``, ``odd`` (width, rank, K + 1) the derivatives of a cosine over
    the factorials where half a sub-step is one of several widths, ``which`` (N) of them.
    """
    for n in range(out.shape[0]):
        w = which[n]
        for lane in range(out.shape[1]):
            for k in range(real.shape[0]):
                whole = real[k, lane] * cosine[k, n] - imag[k, lane] * sine[k, n]
                turned = real[k, lane] * sine[k, n] + imag[k, lane] * cosine[k, n]
                for m in range(out.shape[2]):
                    out[n, lane, m] += whole * even[w, k, m] + turned * odd[w, k, m]
