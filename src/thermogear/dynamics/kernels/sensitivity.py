"""How the end of one trajectory moves with a parameter: dz/dp along the exact path.

With phases counted in periods the motion is z' = f(phase, z; p) with f continuous in z, also at
the edges of the backlash. So the parameter sensitivity s = dz/dp obeys

    s' = (df/dz) s + df/dp,

without a jump where contact changes (the saltation matrix is the identity and the crossing's own
move has no effect of first order): the sub-steps' affine maps are differentiated where they are,
with the crossings held at their phases. No trajectory of another parameter is run, so none can
have another contact.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.dynamics.kernels.compiled import kernel, part
from thermogear.dynamics.kernels.crossing import (
    FRONT,
    LOWER,
    MOST_CROSSINGS,
    NEITHER,
    UPPER,
    combined,
    frame,
    next_edge,
    slope,
    value_of,
)

Real = NDArray[np.float64]


@kernel
def sensitivity(
    polys: Real,
    half: Real,
    b: float,
    d_polys: Real,
    d_half: Real,
    d_b: float,
    start: Real,
    region: int,
    steps: int,
    p: Real,
    here: Real,
    found: Real,
) -> None:
    """Walk ``steps`` sub-steps from ``start`` (x, y) in ``region``; ``found`` (3,) out.

    ``polys`` (N, 5, K + 1), flat, and ``half`` (N) of one lane, ``b`` its half backlash; ``d_...``
    their derivatives by the parameter. ``found``: dx/dp, dy/dp at the end, and how near an extreme
    of x comes to an edge of the backlash anywhere on the way. Work space: ``p`` (2 (K + 1) +
    SCRATCH), ``here`` (12).
    """
    count = half.size
    width = polys.size // (5 * count)
    x = start[0]
    y = start[1]
    dx = 0.0
    dy = 0.0
    margin = np.inf
    for step in range(steps):
        n = step % count
        row = 5 * width * n
        h = half[n]
        slower = d_half[n] / h
        x0 = x - region * b
        y0 = y
        dx0 = dx - region * d_b
        dy0 = dy
        begin = -1.0
        skip = NEITHER
        for _ in range(MOST_CROSSINGS):
            combined(polys, row, width, region, x0, y0, p)
            at, edge = next_edge(p, width, begin, region, b, skip)
            margin = min(margin, _nearest_turn(p, width, begin, at, region * b, b))
            frame(polys, row, width, region, at, h, here, 0)
            frame(d_polys, row, width, region, at, h, here, 6)
            if region == 0:
                here[6] = 0.0
            for q in range(3):
                # the rate is a slope over h, and h moves too
                here[9 + q] -= here[3 + q] * slower
            x = here[0] * x0 + here[1] * y0 + here[2]
            y = here[3] * x0 + here[4] * y0 + here[5]
            dx = here[0] * dx0 + here[1] * dy0
            dx += here[6] * x0 + here[7] * y0 + here[8]
            dy = here[3] * dx0 + here[4] * dy0
            dy += here[9] * x0 + here[10] * y0 + here[11]
            x += region * b
            dx += region * d_b
            if edge == NEITHER:
                break
            if edge == LOWER:
                x = b if region == 1 else -b
                region -= 1
                skip = UPPER
            else:
                x = b if region == 0 else -b
                region += 1
                skip = LOWER
            frame(polys, row, width, region, at, h, here, 0)
            frame(d_polys, row, width, region, at, h, here, 6)
            if region == 0:
                here[6] = 0.0
            for q in range(3):
                here[9 + q] -= here[3 + q] * slower
            det = here[0] * here[4] - here[1] * here[3]
            right = x - region * b - here[2]
            below = y - here[5]
            x0 = (here[4] * right - here[1] * below) / det
            y0 = (here[0] * below - here[3] * right) / det
            right = dx - region * d_b - (here[6] * x0 + here[7] * y0 + here[8])
            below = dy - (here[9] * x0 + here[10] * y0 + here[11])
            dx0 = (here[4] * right - here[1] * below) / det
            dy0 = (here[0] * below - here[3] * right) / det
            begin = at
    found[0] = dx
    found[1] = dy
    found[2] = margin


@part
def _nearest_turn(p: Real, width: int, begin: float, end: float, shift: float, b: float) -> float:
    """Distance from an edge to the extreme of x in a piece; infinite where x does not turn."""
    first = slope(p, FRONT, width, begin)
    last = slope(p, FRONT, width, end)
    if first * last > 0.0 or first == last:
        return np.inf
    x = value_of(p, FRONT, width, begin + (end - begin) * first / (first - last)) + shift
    return min(abs(x - b), abs(x + b))
