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
from numba import njit
from numpy.typing import NDArray

from thermogear.dynamics.kernels.crossing import (
    MOST_CROSSINGS,
    TURNS,
    combined,
    frame,
    next_edge,
    slope,
    value_of,
)

Real = NDArray[np.float64]


@njit(nogil=True, cache=True, error_model="numpy")
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
    found: Real,
) -> None:
    """Walk ``steps`` sub-steps from ``start`` (x, y) in ``region``; ``found`` (3,) out.

    ``polys`` (N, 5, K + 1), flat, and ``half`` (N) of one lane, ``b`` its half backlash; ``d_...`` their
    derivatives by the parameter. ``found``: dx/dp, dy/dp at the end, and how near an extreme of
    x comes to an edge of the backlash anywhere on the way.
    """
    count = half.size
    width = polys.size // (5 * count)
    p = np.empty(width)
    turns_at = np.empty(2 * TURNS)
    scratch = np.empty(width)
    here = np.empty((2, 3))
    moved = np.empty((2, 3))
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
        skip = 2
        for _ in range(MOST_CROSSINGS):
            combined(polys, row, width, region, x0, y0, p)
            at, edge = next_edge(p, width, begin, region, b, skip, turns_at, scratch)
            margin = min(margin, _nearest_turn(p, begin, at, region * b, b))
            frame(polys, row, width, region, at, h, here)
            frame(d_polys, row, width, region, at, h, moved)
            if region == 0:
                moved[0, 0] = 0.0
            for q in range(3):
                # the rate is a slope over h, and h moves too
                moved[1, q] -= here[1, q] * slower
            x = here[0, 0] * x0 + here[0, 1] * y0 + here[0, 2]
            y = here[1, 0] * x0 + here[1, 1] * y0 + here[1, 2]
            dx = here[0, 0] * dx0 + here[0, 1] * dy0
            dx += moved[0, 0] * x0 + moved[0, 1] * y0 + moved[0, 2]
            dy = here[1, 0] * dx0 + here[1, 1] * dy0
            dy += moved[1, 0] * x0 + moved[1, 1] * y0 + moved[1, 2]
            x += region * b
            dx += region * d_b
            if edge == 2:
                break
            if edge == 0:
                x = b if region == 1 else -b
                region -= 1
                skip = 1
            else:
                x = b if region == 0 else -b
                region += 1
                skip = 0
            frame(polys, row, width, region, at, h, here)
            frame(d_polys, row, width, region, at, h, moved)
            if region == 0:
                moved[0, 0] = 0.0
            for q in range(3):
                moved[1, q] -= here[1, q] * slower
            det = here[0, 0] * here[1, 1] - here[0, 1] * here[1, 0]
            right = x - region * b - here[0, 2]
            below = y - here[1, 2]
            x0 = (here[1, 1] * right - here[0, 1] * below) / det
            y0 = (here[0, 0] * below - here[1, 0] * right) / det
            right = dx - region * d_b - (moved[0, 0] * x0 + moved[0, 1] * y0 + moved[0, 2])
            below = dy - (moved[1, 0] * x0 + moved[1, 1] * y0 + moved[1, 2])
            dx0 = (here[1, 1] * right - here[0, 1] * below) / det
            dy0 = (here[0, 0] * below - here[1, 0] * right) / det
            begin = at
    found[0] = dx
    found[1] = dy
    found[2] = margin


@njit(nogil=True, cache=True, error_model="numpy")
def _nearest_turn(p: Real, begin: float, end: float, shift: float, b: float) -> float:
    """Distance from an edge to the extreme of x in a piece; infinite where x does not turn."""
    width = p.size
    first = slope(p, 0, width, begin)
    last = slope(p, 0, width, end)
    if first * last > 0.0 or first == last:
        return np.inf
    x = value_of(p, 0, width, begin + (end - begin) * first / (first - last)) + shift
    return min(abs(x - b), abs(x + b))
