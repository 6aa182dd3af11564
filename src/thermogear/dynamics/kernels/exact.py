"""Event-exact propagation of many lanes; see ``affine`` for the maps it applies."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from thermogear.dynamics.kernels.batch import ROOM, cross_together, place
from thermogear.dynamics.kernels.crossing import step_through
from thermogear.dynamics.kernels.vector import EIGHT

Real = NDArray[np.float64]
Whole = NDArray[np.int64]


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
    frame = np.empty((4, lanes))
    since = np.empty(lanes)
    for i in range(lanes):
        place(frame, i, region[i], backlash[i])
    shift = frame[0]
    touch = frame[1]
    low = frame[2]
    high = frame[3]
    other = np.empty(lanes, np.int64)
    lane = np.empty(EIGHT, np.int64)
    room = np.ones((ROOM, EIGHT))
    curve = np.ones((3, polys.shape[3], EIGHT))
    basis = np.ones((3, polys.shape[3], EIGHT))
    values = np.ones((6, 3, EIGHT))
    jacobian = np.empty(4)
    state = np.empty(2)
    scratch = np.empty((2, polys.shape[3]))
    found = np.empty(16)
    tally = np.zeros(2, np.int64)
    clock = np.zeros(3)
    for period in range(sections.shape[0]):
        since[:] = 0.0
        for n in range(count):
            if taking and marks[n] != 0:
                samples[taken, 0, :] = x
                samples[taken, 1, :] = y
                taken += 1
            for i in range(lanes):
                # contact and free step both, then the choice: choosing the maps' entries instead
                # would read them one by one
                z = x[i] - shift[i]
                w = y[i]
                xn = maps[n, 0, i] * z + maps[n, 2, i] * w + maps[n, 4, i]
                yn = maps[n, 1, i] * z + maps[n, 3, i] * w + maps[n, 5, i]
                xf = z + maps[n, 6, i] * w + maps[n, 8, i]
                yf = maps[n, 7, i] * w + maps[n, 9, i]
                contact = touch[i] != 0.0
                xn = (xn if contact else xf) + shift[i]
                yn = yn if contact else yf
                fresh_x[i] = xn
                fresh_y[i] = yn
                # can the path between the ends have left the region?
                below = x[i] if x[i] < xn else xn
                above = x[i] if x[i] > xn else xn
                room_low = below - low[i]
                room_high = high[i] - above
                spare = room_low if room_low < room_high else room_high
                # of a parabola, x turns at most h/2 times the smaller end speed beyond the ends
                slow = abs(w) if abs(w) < abs(yn) else abs(yn)
                swing = 2.0 * reach[i] + (half[n, i] * slow if w * yn <= 0.0 else 0.0)
                doubt[i] = not (spare > swing)
            waiting = 0
            for i in range(lanes):
                queue[waiting] = i
                waiting += doubt[i]
            for c in range(columns):
                for i in range(lanes):
                    moves = doubt[i] == 0
                    contact = touch[i] != 0.0
                    a = tangent[c, i]
                    b = tangent[2 + c, i]
                    an = maps[n, 0, i] * a + maps[n, 2, i] * b
                    bn = maps[n, 1, i] * a + maps[n, 3, i] * b
                    af = a + maps[n, 6, i] * b
                    bf = maps[n, 7, i] * b
                    an = an if contact else af
                    bn = bn if contact else bf
                    tangent[c, i] = an if moves else a
                    tangent[2 + c, i] = bn if moves else b
            if waiting > 0:
                waiting = cross_together(
                    polys[n],
                    maps[n],
                    half[n],
                    reach,
                    backlash,
                    x,
                    y,
                    region,
                    fresh_x,
                    fresh_y,
                    frame,
                    since,
                    tangent,
                    columns,
                    queue,
                    waiting,
                    counts,
                    spent,
                    other,
                    lane,
                    room,
                    curve,
                    basis,
                    values,
                )
            for w in range(waiting):
                i = queue[w]
                if not (abs(x[i]) < np.inf):
                    continue
                state[0] = x[i]
                state[1] = y[i]
                before = region[i]
                now = step_through(
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
                    # the whole period is booked for the region at its end
                    spent[before + 1, i] += since[i] + half[n, i]
                    spent[now + 1, i] -= since[i] + half[n, i]
                    region[i] = now
                    place(frame, i, now, backlash[i])
                for m in range(columns):
                    a = tangent[m, i]
                    b = tangent[2 + m, i]
                    tangent[m, i] = jacobian[0] * a + jacobian[1] * b
                    tangent[2 + m, i] = jacobian[2] * a + jacobian[3] * b
            for i in range(lanes):
                x[i] = fresh_x[i]
                y[i] = fresh_y[i]
                since[i] += 2.0 * half[n, i]
        for i in range(lanes):
            spent[region[i] + 1, i] += since[i]
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
