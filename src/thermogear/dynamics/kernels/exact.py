"""Event-exact propagation of many lanes; see ``affine`` for the maps it applies.

Between contact changes the oscillator is linear, so that a sub-step is one affine map, right to
rounding (a Taylor series in the sub-step); contact changes are roots of its polynomials. Against
steps of a Runge-Kutta method there is no error of a step that runs over a change of contact, and no
step to choose. It holds for one mass with a piecewise-linear force and coefficients of time alone.
Checked by ``tests/dynamics/test_exact.py``: extended precision, other sub-steps, grazing contacts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Whole
from thermogear.dynamics.kernels.affine import HALF, SINCE
from thermogear.dynamics.kernels.batch import (
    CARRIED,
    DOUBLE,
    HIGH,
    LOSSES,
    LOW,
    OWN_GAP,
    QUEUE,
    SHIFT,
    SPENT,
    TANGENT,
    WHOLE,
    X,
    Y,
    cross_eight,
)
from thermogear.dynamics.kernels.compiled import kernel
from thermogear.dynamics.kernels.crossing import step_through
from thermogear.dynamics.kernels.vector import EIGHT, bits, choose, load, store

Real = NDArray[np.float64]

LARGE = 2.0**400
OFTEN = 1024
"""Sub-steps after which a tangent smaller than 1/LARGE or larger than LARGE is scaled."""


@kernel
def advance_exact(
    steps: Real,
    curves: Real,
    width: int,
    reach: Real,
    backlash: Real,
    x: Real,
    y: Real,
    region: Whole,
    tangent: Real,
    columns: int,
    normalise: bool,
    sections: Real,
    stretch: Real,
    samples: Real,
    marks: NDArray[np.uint8],
    counts: Whole,
    spent: Real,
    carried: Real,
    table: Real,
    p: Real,
    scratch: Real,
    queue: Whole,
) -> None:
    """Advance all lanes by ``len(sections)`` periods, in place.

    ``steps`` (N, group of eight lanes, 11, 8) and ``curves`` (N, lane, 5 ``width`` + 14 and more)
    as ``affine.prepare`` fills them, or, of one lane, ``steps`` zeros of one sub-step: work space
    for what ``curves`` has; ``reach`` (lane) how far a hidden turn can swing in a
    sub-step; ``columns`` 0, 1 or 2 tangent columns of ``tangent`` (4, lane) = m11, m12, m21, m22;
    with ``normalise`` the first column is normalised every period and its logarithm added to
    ``stretch`` (period, lane). ``sections`` (period, 2, lane). ``samples`` (period marked, 2,
    lane): the state at the start of every sub-step that ``marks`` names, when not empty.
    ``counts`` (2, lane) and ``spent`` (3, lane) accumulate contact losses, back-side impacts, and
    the time in back, free and drive contact. All are flat. Work space: ``carried`` (CARRIED, lane
    of full groups), ``table`` (room, 8), ``p`` (width, 8), ``scratch`` (2 width + SCRATCH),
    ``queue`` (QUEUE + 8 and a place for every lane).
    """
    count = marks.size
    lanes = x.size
    stride = carried.size // CARRIED
    groups = stride // EIGHT
    one = 11 * EIGHT  # numbers of a group's sub-step
    room = table.size // EIGHT
    slim = steps.size < count * groups * one
    for i in range(stride):
        # lanes that fill up the last group rest in the middle of a gap
        real = i < lanes
        b = backlash[i] if real else 1.0
        r = region[i] if real else 0
        carried[X * stride + i] = x[i] if real else 0.0
        carried[Y * stride + i] = y[i] if real else 0.0
        carried[SHIFT * stride + i] = r * b
        carried[LOW * stride + i] = -np.inf if r < 0 else (r * 2 - 1) * b
        carried[HIGH * stride + i] = np.inf if r > 0 else (r * 2 + 1) * b
        carried[DOUBLE * stride + i] = 2.0 * reach[i] if real else 0.0
        carried[OWN_GAP * stride + i] = b
        # the period, summed as the sub-steps' own times are
        last = ((count - 1) * lanes + (i if real else 0)) * room + 5 * width
        carried[WHOLE * stride + i] = curves[last + SINCE] + 2.0 * curves[last + HALF]
        for m in range(3):
            carried[(SPENT + m) * stride + i] = spent[m * lanes + i] if real else 0.0
        for m in range(2):
            carried[(LOSSES + m) * stride + i] = counts[m * lanes + i] if real else 0.0
        for m in range(4):
            carried[(TANGENT + m) * stride + i] = tangent[m * lanes + i] if real else 0.0
    taken = 0
    for period in range(sections.size // (2 * lanes)):
        for n in range(count):
            if samples.size > 0 and marks[n] != 0:
                for i in range(lanes):
                    samples[taken + i] = carried[X * stride + i]
                    samples[taken + lanes + i] = carried[Y * stride + i]
                taken += 2 * lanes
            waiting = 0
            for g in range(groups):
                # contact and free step both, then the choice
                at = EIGHT * g
                row = 0 if slim else (n * groups + g) * one
                if slim:
                    for q in range(11):
                        steps[EIGHT * q] = curves[n * room + 5 * width + q]
                x0 = load(carried, X * stride + at)
                y0 = load(carried, Y * stride + at)
                shift = load(carried, SHIFT * stride + at)
                contact = shift != 0.0
                z = x0 - shift
                m11 = load(steps, row)
                m21 = load(steps, row + EIGHT)
                m12 = load(steps, row + 2 * EIGHT)
                m22 = load(steps, row + 3 * EIGHT)
                free12 = load(steps, row + 6 * EIGHT)
                free22 = load(steps, row + 7 * EIGHT)
                x1 = m11 * z + m12 * y0 + load(steps, row + 4 * EIGHT)
                y1 = m21 * z + m22 * y0 + load(steps, row + 5 * EIGHT)
                xf = z + free12 * y0 + load(steps, row + 8 * EIGHT)
                yf = free22 * y0 + load(steps, row + 9 * EIGHT)
                x1 = choose(contact, x1, xf) + shift
                y1 = choose(contact, y1, yf)
                # can the path between the ends have left the region?
                rising = x0 < x1
                room_low = choose(rising, x0, x1) - load(carried, LOW * stride + at)
                room_high = load(carried, HIGH * stride + at) - choose(rising, x1, x0)
                spare = choose(room_low < room_high, room_low, room_high)
                # of a parabola, x turns at most h/2 times the smaller end speed beyond the ends
                slow = choose(abs(y0) < abs(y1), abs(y0), abs(y1))
                half = load(steps, row + HALF * EIGHT)
                turning = choose(y0 * y1 <= 0.0, half * slow, 0.0)
                sure = spare > load(carried, DOUBLE * stride + at) + turning
                store(carried, X * stride + at, choose(sure, x1, x0))
                store(carried, Y * stride + at, choose(sure, y1, y0))
                for c in range(columns):
                    above = (TANGENT + c) * stride + at
                    below = (TANGENT + 2 + c) * stride + at
                    a = load(carried, above)
                    w = load(carried, below)
                    t1 = choose(contact, m11 * a + m12 * w, a + free12 * w)
                    t2 = choose(contact, m21 * a + m22 * w, free22 * w)
                    store(carried, above, choose(sure, t1, a))
                    store(carried, below, choose(sure, t2, w))
                doubt = bits(sure) ^ 255
                if doubt != 0:
                    for k in range(EIGHT):
                        queue[QUEUE + waiting] = at + k
                        waiting += (doubt >> k) & 1
            left = 0
            for first in range(QUEUE, QUEUE + waiting, EIGHT):
                many = min(EIGHT, QUEUE + waiting - first)
                for k in range(EIGHT):
                    i = queue[first + k] if k < many else queue[first]
                    queue[k] = i
                    queue[EIGHT + k] = (n * lanes + i) * room
                undone = cross_eight(curves, carried, stride, columns, queue, table, p, width)
                for k in range(many):
                    if (undone >> k) & 1:
                        queue[QUEUE + left] = queue[k]
                        left += 1
            for w in range(QUEUE, QUEUE + left):
                i = queue[w]
                if abs(carried[X * stride + i]) < np.inf:
                    step_through(
                        curves, (n * lanes + i) * room, width, carried, stride, i, columns, scratch
                    )
                else:
                    carried[X * stride + i] = np.nan
                    carried[Y * stride + i] = np.nan
            if normalise and n % OFTEN == OFTEN - 1:
                # a long turn shrinks or stretches it beyond all numbers: powers of 2 are exact
                for i in range(lanes):
                    above = TANGENT * stride + i
                    below = (TANGENT + 2) * stride + i
                    size = abs(carried[above]) + abs(carried[below])
                    scale = LARGE if size * LARGE < 1.0 else 1.0 / LARGE if size > LARGE else 1.0
                    carried[above] *= scale
                    carried[below] *= scale
                    stretch[period * lanes + i] -= np.log(scale)
        for i in range(lanes):
            sections[2 * period * lanes + i] = carried[X * stride + i]
            sections[(2 * period + 1) * lanes + i] = carried[Y * stride + i]
        for at in range(0, stride, EIGHT):
            whole = load(carried, WHOLE * stride + at)
            shift = load(carried, SHIFT * stride + at)
            gap = load(carried, OWN_GAP * stride + at)
            for m in range(3):
                place = (SPENT + m) * stride + at
                there = shift == (m - 1.0) * gap
                store(carried, place, load(carried, place) + choose(there, whole, 0.0))
            x0 = load(carried, X * stride + at)
            y0 = load(carried, Y * stride + at)
            within = (abs(x0) <= 1e6 * gap) & (abs(y0) < np.inf)
            # out of every physical range: the lane stays NaN, its neighbours go on
            store(carried, X * stride + at, choose(within, x0, np.nan))
            store(carried, Y * stride + at, choose(within, y0, np.nan))
        if normalise:
            for i in range(lanes):
                above = TANGENT * stride + i
                below = (TANGENT + 2) * stride + i
                size = np.sqrt(carried[above] ** 2 + carried[below] ** 2)
                stretch[period * lanes + i] += np.log(size)
                carried[above] /= size
                carried[below] /= size
    for i in range(lanes):
        x[i] = carried[X * stride + i]
        y[i] = carried[Y * stride + i]
        shift_now = carried[SHIFT * stride + i]
        region[i] = 1 if shift_now > 0.0 else -1 if shift_now < 0.0 else 0
        for m in range(3):
            spent[m * lanes + i] = carried[(SPENT + m) * stride + i]
        for m in range(2):
            counts[m * lanes + i] = int(carried[(LOSSES + m) * stride + i])
        for m in range(4):
            tangent[m * lanes + i] = carried[(TANGENT + m) * stride + i]
