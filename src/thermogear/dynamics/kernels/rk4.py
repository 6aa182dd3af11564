"""Lane-blocked classical Runge-Kutta steps.

Trajectories run in an inner loop of contiguous lanes, so that the compiler fills vector
registers with them. Of fastmath only the contraction of a product and a sum to one rounding is
taken: no sum here has two products, so every lane does the same operations whatever stands
beside it, which keeps results independent of lane and thread count and keeps the mirror and
scaling by powers of two exact to the last bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from thermogear.base.kernel_cache import rebuilt

Real = NDArray[np.floating[Any]]


@rebuilt
@njit(nogil=True, cache=True, error_model="numpy", fastmath={"contract"})
def advance_rk4(
    stiffness: Real,
    force: Real,
    damping: Real,
    backlash: Real,
    step: Real,
    x: Real,
    v: Real,
    sections: Real,
    samples: Real,
    stride: int,
) -> None:
    """Advance all lanes by ``len(sections)`` periods, in place.

    ``stiffness`` and ``force`` (2 N, lane): tables at the half steps of one period.
    ``sections`` (period, 2, lane) takes the state at the end of every period; ``samples``
    (period * N/stride, 2, lane) the state at the start of every ``stride``-th step, when it is
    not empty.
    """
    periods = sections.shape[0]
    steps = stiffness.shape[0] // 2
    lanes = x.shape[0]
    # constants of the lanes' own kind: a double would turn single precision into double
    two = step.dtype.type(2.0)
    halves = step / two
    sixth = step / step.dtype.type(6.0)
    taking = samples.shape[0] > 0
    taken = 0
    for period in range(periods):
        for i in range(steps):
            if taking and i % stride == 0:
                samples[taken, 0, :] = x
                samples[taken, 1, :] = v
                taken += 1
            here = 2 * i
            after = 0 if i == steps - 1 else 2 * i + 2
            for j in range(lanes):
                b = backlash[j]
                c = damping[j]
                h = step[j]
                half = halves[j]
                k_half = stiffness[here + 1, j]
                f_half = force[here + 1, j]
                x1 = x[j]
                v1 = v[j]
                z = -b if x1 < -b else x1
                z = b if z > b else z
                a1 = force[here, j] - c * v1 - stiffness[here, j] * (x1 - z)
                x2 = x1 + half * v1
                v2 = v1 + half * a1
                z = -b if x2 < -b else x2
                z = b if z > b else z
                a2 = f_half - c * v2 - k_half * (x2 - z)
                x3 = x1 + half * v2
                v3 = v1 + half * a2
                z = -b if x3 < -b else x3
                z = b if z > b else z
                a3 = f_half - c * v3 - k_half * (x3 - z)
                x4 = x1 + h * v3
                v4 = v1 + h * a3
                z = -b if x4 < -b else x4
                z = b if z > b else z
                a4 = force[after, j] - c * v4 - stiffness[after, j] * (x4 - z)
                x[j] = x1 + sixth[j] * ((v1 + v4) + two * (v2 + v3))
                v[j] = v1 + sixth[j] * ((a1 + a4) + two * (a2 + a3))
        for j in range(lanes):
            sections[period, 0, j] = x[j]
            sections[period, 1, j] = v[j]
            if not (abs(x[j]) <= 1e6 * backlash[j] and abs(v[j]) < np.inf):
                # out of every physical range: the lane stays NaN, its neighbours go on
                x[j] = np.nan
                v[j] = np.nan
