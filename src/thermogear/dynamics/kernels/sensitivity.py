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

from thermogear.dynamics.kernels.affine import FREE_NU, FREE_PSI, NU, PHI, PSI
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
def prepare_moved(
    damping: float,
    d_damping: float,
    half: Real,
    d_half: Real,
    stiffness: Real,
    d_stiffness: Real,
    force: Real,
    d_force: Real,
    work: Real,
    moved: Real,
    ends: Real,
    d_polys: Real,
) -> None:
    """The derivative of :func:`~thermogear.dynamics.kernels.affine.prepare`'s polynomials.

    Of one lane: ``half`` (N), ``stiffness`` and ``force`` (N, K + 1), ``d_...`` their derivatives
    by the parameter; ``d_polys`` (N, 5, K + 1) is filled. Work space: ``work`` and ``moved``
    (5 (K + 1)), ``ends`` (20).
    """
    count, width = stiffness.shape
    order = width - 1
    for n in range(count):
        h = half[n]
        dh = d_half[n]
        ch = damping * h
        d_ch = d_damping * h + damping * dh
        hh = h * h
        d_hh = 2.0 * h * dh
        for i in range(5 * width):
            work[i] = 0.0
            moved[i] = 0.0
        work[0] = 1.0
        work[width + 1] = 1.0
        work[3 * width + 1] = 1.0
        for m in range(order - 1):
            scale = 1.0 / ((m + 2.0) * (m + 1.0))
            drag = ch * (m + 1.0)
            d_drag = d_ch * (m + 1.0)
            for q in range(3):
                total = 0.0
                d_total = 0.0
                for i in range(m + 1):
                    total += stiffness[n, i] * work[q * width + m - i]
                    d_total += stiffness[n, i] * moved[q * width + m - i]
                    d_total += d_stiffness[n, i] * work[q * width + m - i]
                work[q * width + m + 2] = -(drag * work[q * width + m + 1] + hh * total) * scale
                d_total = d_hh * total + hh * d_total
                d_total += d_drag * work[q * width + m + 1] + drag * moved[q * width + m + 1]
                moved[q * width + m + 2] = -d_total * scale
            for q in range(3, 5):
                work[q * width + m + 2] = -drag * work[q * width + m + 1] * scale
                d_total = d_drag * work[q * width + m + 1] + drag * moved[q * width + m + 1]
                moved[q * width + m + 2] = -d_total * scale
            push = hh * force[n, m] * scale
            d_push = (d_hh * force[n, m] + hh * d_force[n, m]) * scale
            for q in range(2, 5, 2):
                work[q * width + m + 2] += push
                moved[q * width + m + 2] += d_push
        for q in range(5):
            ends[q] = value_of(work, q * width, width, -1.0)
            ends[5 + q] = slope(work, q * width, width, -1.0)
            ends[10 + q] = value_of(moved, q * width, width, -1.0)
            ends[15 + q] = slope(moved, q * width, width, -1.0)
        det = ends[0] * ends[6] - ends[1] * ends[5]
        d_det = ends[10] * ends[6] + ends[0] * ends[16]
        d_det -= ends[11] * ends[5] + ends[1] * ends[15]
        a = ends[6] / det
        d_a = (ends[16] - a * d_det) / det
        b = -ends[5] / det
        d_b = (-ends[15] - b * d_det) / det
        c = -h * ends[1] / det
        d_c = (-dh * ends[1] - h * ends[11] - c * d_det) / det
        d = h * ends[0] / det
        d_d = (dh * ends[0] + h * ends[10] - d * d_det) / det
        e = (ends[1] * ends[7] - ends[6] * ends[2]) / det
        d_e = ends[11] * ends[7] + ends[1] * ends[17] - ends[16] * ends[2] - ends[6] * ends[12]
        d_e = (d_e - e * d_det) / det
        f = (ends[5] * ends[2] - ends[0] * ends[7]) / det
        d_f = ends[15] * ends[2] + ends[5] * ends[12] - ends[10] * ends[7] - ends[0] * ends[17]
        d_f = (d_f - f * d_det) / det
        g = h / ends[8]
        d_g = (dh - g * ends[18]) / ends[8]
        r = -ends[9] / ends[8]
        d_r = (-ends[19] - r * ends[18]) / ends[8]
        for m in range(width):
            w0, w1, w3 = work[m], work[width + m], work[3 * width + m]
            v0, v1, v3 = moved[m], moved[width + m], moved[3 * width + m]
            d_polys[n, PHI, m] = d_a * w0 + a * v0 + d_b * w1 + b * v1
            d_polys[n, PSI, m] = d_c * w0 + c * v0 + d_d * w1 + d * v1
            d_polys[n, NU, m] = moved[2 * width + m] + d_e * w0 + e * v0 + d_f * w1 + f * v1
            d_polys[n, FREE_PSI, m] = d_g * w3 + g * v3
            d_polys[n, FREE_NU, m] = moved[4 * width + m] + d_r * w3 + r * v3
        d_polys[n, FREE_PSI, 0] -= d_g * ends[3] + g * ends[13]
        d_polys[n, FREE_NU, 0] -= ends[14] + d_r * ends[3] + r * ends[13]


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
    u = begin + (end - begin) * first / (first - last)
    for _ in range(8):
        bend = 0.0
        for m in range(width - 1, 1, -1):
            bend = bend * u + m * (m - 1.0) * p[FRONT + m]
        new = u - slope(p, FRONT, width, u) / bend
        if not begin <= new <= end:
            break
        close = abs(new - u) < 1e-9 * (end - begin)
        u = new
        if close:
            break
    x = value_of(p, FRONT, width, u) + shift
    return min(abs(x - b), abs(x + b))
