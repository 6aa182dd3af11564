"""Event-exact propagation of many lanes; see ``affine`` for the maps it applies."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from thermogear.dynamics.kernels.affine import HALF, SINCE
from thermogear.dynamics.kernels.batch import (
    CARRIED,
    DOUBLE,
    HIGH,
    LOSSES,
    LOW,
    OWN_GAP,
    SHIFT,
    SPENT,
    TANGENT,
    X,
    Y,
    cross_eight,
)
from thermogear.dynamics.kernels.crossing import TURNS, step_through
from thermogear.dynamics.kernels.vector import EIGHT, aligned, bits, choose, load, store

Real = NDArray[np.float64]
Whole = NDArray[np.int64]


@njit(nogil=True, cache=True, error_model="numpy")
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
    sections: Real,
    stretch: Real,
    samples: Real,
    marks: NDArray[np.uint8],
    counts: Whole,
    spent: Real,
) -> None:
    """Advance all lanes by ``len(sections)`` periods, in place.

    ``steps`` (N, group of eight lanes, 11, 8) and ``curves`` (N, lane, 5 width + 14 and more) as
    ``affine.prepare`` fills them; ``reach`` (lane) how far a hidden turn can swing in a sub-step;
    ``columns`` 0, 1 or 2 tangent columns of ``tangent`` (4, lane) = m11, m12, m21, m22; with
    ``stretch`` (period, lane) not empty the first column is normalised every period and its
    logarithm stored. ``samples`` (period * marked, 2, lane): the state at the start of every
    sub-step that ``marks`` names, when not empty. ``counts`` (2, lane) and ``spent`` (3, lane)
    accumulate contact losses, back-side impacts, and the time in back, free and drive contact.
    """
    count = steps.shape[0]
    groups = steps.shape[1]
    one = steps.shape[2] * EIGHT  # numbers of a group's sub-step
    lanes = x.shape[0]
    stride = groups * EIGHT
    carried = aligned(CARRIED * stride).reshape((CARRIED, stride))
    # lanes that fill up the last group rest in the middle of a gap
    carried[LOW] = -1.0
    carried[HIGH] = 1.0
    carried[OWN_GAP] = 1.0
    for i in range(lanes):
        b = backlash[i]
        r = region[i]
        carried[X, i] = x[i]
        carried[Y, i] = y[i]
        carried[SHIFT, i] = r * b
        carried[LOW, i] = -np.inf if r < 0 else (r * 2 - 1) * b
        carried[HIGH, i] = np.inf if r > 0 else (r * 2 + 1) * b
        carried[DOUBLE, i] = 2.0 * reach[i]
        carried[OWN_GAP, i] = b
        for m in range(3):
            carried[SPENT + m, i] = spent[m, i]
        for m in range(2):
            carried[LOSSES + m, i] = counts[m, i]
        for m in range(4):
            carried[TANGENT + m, i] = tangent[m, i]
    # the period, summed as the sub-steps' own times are
    wholes = aligned(stride)
    for i in range(lanes):
        last = curves[count - 1, i, 5 * width :]
        wholes[i] = last[SINCE] + 2.0 * last[HALF]
    taking = samples.shape[0] > 0
    normal = stretch.shape[0] > 0
    taken = 0
    queue = np.zeros(stride + EIGHT, np.int64)
    own = np.empty(EIGHT, np.int64)
    rows = np.empty(EIGHT, np.int64)
    room = curves.shape[2]
    table = aligned(room * EIGHT).reshape((room, EIGHT))
    p = aligned(width * EIGHT).reshape((width, EIGHT))
    flat = curves.reshape(curves.size)
    path = np.empty(width)
    work = np.empty(width)
    found = np.empty(2 * TURNS)
    here = np.empty((3, 3))
    for period in range(sections.shape[0]):
        for n in range(count):
            if taking and marks[n] != 0:
                samples[taken, 0, :] = carried[X, :lanes]
                samples[taken, 1, :] = carried[Y, :lanes]
                taken += 1
            waiting = 0
            for g in range(groups):
                # contact and free step both, then the choice
                at = EIGHT * g
                row = (n * groups + g) * one
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
                    a = load(carried, (TANGENT + c) * stride + at)
                    w = load(carried, (TANGENT + 2 + c) * stride + at)
                    t1 = choose(contact, m11 * a + m12 * w, a + free12 * w)
                    t2 = choose(contact, m21 * a + m22 * w, free22 * w)
                    store(carried, (TANGENT + c) * stride + at, choose(sure, t1, a))
                    store(carried, (TANGENT + 2 + c) * stride + at, choose(sure, t2, w))
                doubt = bits(sure) ^ 255
                if doubt != 0:
                    for k in range(EIGHT):
                        queue[waiting] = at + k
                        waiting += (doubt >> k) & 1
            left = 0
            for first in range(0, waiting, EIGHT):
                many = min(EIGHT, waiting - first)
                for k in range(EIGHT):
                    i = queue[first + k] if k < many else queue[first]
                    own[k] = i
                    rows[k] = (n * lanes + i) * room
                undone = cross_eight(curves, carried, columns, own, rows, table, p)
                for k in range(many):
                    if (undone >> k) & 1:
                        queue[left] = own[k]
                        left += 1
            for w in range(left):
                i = queue[w]
                if not (abs(carried[X, i]) < np.inf):
                    carried[X, i] = np.nan
                    carried[Y, i] = np.nan
                    continue
                step_through(
                    flat, (n * lanes + i) * room, width, carried, i, columns, path, work, found, here
                )
        sections[period, 0, :] = carried[X, :lanes]
        sections[period, 1, :] = carried[Y, :lanes]
        for g in range(groups):
            at = EIGHT * g
            whole = load(wholes, at)
            shift = load(carried, SHIFT * stride + at)
            for m in range(3):
                place = (SPENT + m) * stride + at
                there = shift == (m - 1.0) * load(carried, OWN_GAP * stride + at)
                store(carried, place, load(carried, place) + choose(there, whole, 0.0))
            x0 = load(carried, X * stride + at)
            y0 = load(carried, Y * stride + at)
            within = abs(x0) <= 1e6 * load(carried, OWN_GAP * stride + at)
            within = within & (abs(y0) < np.inf)
            # out of every physical range: the lane stays NaN, its neighbours go on
            store(carried, X * stride + at, choose(within, x0, np.nan))
            store(carried, Y * stride + at, choose(within, y0, np.nan))
        if normal:
            for i in range(lanes):
                size = np.sqrt(carried[TANGENT, i] ** 2 + carried[TANGENT + 2, i] ** 2)
                stretch[period, i] = np.log(size)
                carried[TANGENT, i] /= size
                carried[TANGENT + 2, i] /= size
    for i in range(lanes):
        x[i] = carried[X, i]
        y[i] = carried[Y, i]
        region[i] = np.int64(np.sign(carried[SHIFT, i]))
        for m in range(3):
            spent[m, i] = carried[SPENT + m, i]
        for m in range(2):
            counts[m, i] = np.int64(carried[LOSSES + m, i])
        for m in range(4):
            tangent[m, i] = carried[TANGENT + m, i]
