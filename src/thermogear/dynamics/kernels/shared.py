"""Runge-Kutta steps of a mesh whose tooth pairs come into contact one by one."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from thermogear.base.kernel_cache import rebuilt

Real = NDArray[np.float64]


@rebuilt
@njit(nogil=True, cache=True, error_model="numpy")
def pairs_push(springs: Real, stretch: Real, at: int, deflection: float) -> float:
    """sum_j k_j <w + S_j>_+ of one flank side at table column ``at``.

    ``springs`` (2, pair, column): k_j and S_j; ``stretch`` (2, column): knee and slope below it.
    """
    stiffness, added = springs[0], springs[1]
    if deflection < stretch[0, at]:
        deflection = stretch[0, at] - (stretch[0, at] - deflection) * stretch[1, at]
    total = 0.0
    for j in range(stiffness.shape[0]):
        overlap = deflection + added[j, at]
        # worded so that a nan pushes through
        if not overlap <= 0.0:
            total += stiffness[j, at] * overlap
    return total


@rebuilt
@njit(nogil=True, cache=True, error_model="numpy")
def advance_shared(
    drive: Real,
    back: Real,
    drive_stretch: Real,
    back_stretch: Real,
    force: Real,
    constants: Real,
    step: float,
    state: Real,
    sections: Real,
    samples: Real,
    stride: int,
    counts: NDArray[np.int64],
    spent: Real,
) -> None:
    """Advance by ``len(sections)`` periods, in place.

    ``drive`` and ``back`` (2, pair, 2 N): k_j and S_j at the half steps; their ``..._stretch``
    (2, 2 N): knee and slope below it, :class:`PairSprings`; ``force`` (2 N,);
    ``constants``: m, c, b; ``state`` (2,). ``counts`` (2,): losses of drive contact and
    back-side impacts; ``spent`` (3,): steps that end in back, free and drive contact.
    """
    mass, damping, backlash = constants
    steps = force.size // 2
    taking = samples.shape[0] > 0
    taken = 0
    half = 0.5 * step
    region = 0
    known = False
    for period in range(sections.shape[0]):
        for i in range(steps):
            if taking and i % stride == 0:
                samples[taken, :] = state
                taken += 1
            here = 2 * i
            after = 0 if i == steps - 1 else here + 2
            x1, v1 = state
            push = pairs_push(drive, drive_stretch, here, x1 - backlash)
            pull = pairs_push(back, back_stretch, here, -x1 - backlash)
            if push > 0.0:
                now = 1
            elif pull > 0.0:
                now = -1
            else:
                now = 0
            if known:
                if region == 1 and now != 1:
                    counts[0] += 1
                if now == -1 and region != -1:
                    counts[1] += 1
            region = now
            known = True
            spent[now + 1] += 1.0
            a1 = (force[here] - damping * v1 - push + pull) / mass
            x2, v2 = x1 + half * v1, v1 + half * a1
            push = pairs_push(drive, drive_stretch, here + 1, x2 - backlash)
            pull = pairs_push(back, back_stretch, here + 1, -x2 - backlash)
            a2 = (force[here + 1] - damping * v2 - push + pull) / mass
            x3, v3 = x1 + half * v2, v1 + half * a2
            push = pairs_push(drive, drive_stretch, here + 1, x3 - backlash)
            pull = pairs_push(back, back_stretch, here + 1, -x3 - backlash)
            a3 = (force[here + 1] - damping * v3 - push + pull) / mass
            x4, v4 = x1 + step * v3, v1 + step * a3
            push = pairs_push(drive, drive_stretch, after, x4 - backlash)
            pull = pairs_push(back, back_stretch, after, -x4 - backlash)
            a4 = (force[after] - damping * v4 - push + pull) / mass
            state[0] = x1 + step / 6.0 * ((v1 + v4) + 2.0 * (v2 + v3))
            state[1] = v1 + step / 6.0 * ((a1 + a4) + 2.0 * (a2 + a3))
        sections[period, :] = state
        if not abs(state[0]) <= 1e6 * backlash:
            state[:] = np.nan
