"""Fixed steps of a pair over its turn, many speeds side by side, with what the gears feel of it."""

from __future__ import annotations

import numpy as np
from numba import njit

from thermogear.base.arrays import Floats
from thermogear.base.kernel_cache import rebuilt


@rebuilt
@njit(nogil=True, cache=True, error_model="numpy", fastmath={"contract"})
def advance_turn(
    stiffness: Floats,
    bend: Floats,
    error: Floats,
    mean: Floats,
    scale: Floats,
    damping: Floats,
    backlash: Floats,
    step: Floats,
    first: int,
    count: int,
    x: Floats,
    v: Floats,
    felt: Floats,
    path: Floats,
) -> None:
    """Advance all lanes by ``count`` classical Runge-Kutta steps from step ``first``, in place.

    x'' + damping x' + k f(x; b) = mean + scale e''. ``stiffness`` k and ``bend`` e'' (2 N,) at the
    half steps of a turn of N steps, ``error`` e (N,), shared by the lanes. ``felt`` (5, lane) is
    kept up: greatest and least k f, greatest and least x + e, steps out of drive-side contact.
    ``path`` (sample, lane): x at so many evenly spaced steps, from the first on; none where empty.
    """
    steps = error.shape[0]
    stride = count // path.shape[0] if path.shape[0] else count
    for number in range(count):
        at = (first + number) % steps
        here = 2 * at
        after = 0 if at == steps - 1 else here + 2
        k0, k1, k2 = stiffness[here], stiffness[here + 1], stiffness[after]
        a0, a1, a2 = bend[here], bend[here + 1], bend[after]
        e0 = error[at]
        for j in range(x.shape[0]):
            b, c, h = backlash[j], damping[j], step[j]
            half = 0.5 * h
            x1, v1 = x[j], v[j]
            if path.shape[0] and number % stride == 0:
                path[number // stride, j] = x1
            force = k0 * (x1 - min(max(x1, -b), b))
            felt[0, j] = max(felt[0, j], force)
            felt[1, j] = min(felt[1, j], force)
            felt[2, j] = max(felt[2, j], x1 + e0)
            felt[3, j] = min(felt[3, j], x1 + e0)
            felt[4, j] += 1.0 if x1 <= b else 0.0
            b1 = mean[j] + scale[j] * a1
            f1 = mean[j] + scale[j] * a0 - c * v1 - force
            x2, v2 = x1 + half * v1, v1 + half * f1
            f2 = b1 - c * v2 - k1 * (x2 - min(max(x2, -b), b))
            x3, v3 = x1 + half * v2, v1 + half * f2
            f3 = b1 - c * v3 - k1 * (x3 - min(max(x3, -b), b))
            x4, v4 = x1 + h * v3, v1 + h * f3
            f4 = mean[j] + scale[j] * a2 - c * v4 - k2 * (x4 - min(max(x4, -b), b))
            x[j] = x1 + h / 6.0 * ((v1 + v4) + 2.0 * (v2 + v3))
            v[j] = v1 + h / 6.0 * ((f1 + f4) + 2.0 * (f2 + f3))


@rebuilt
@njit(nogil=True, cache=True, error_model="numpy", fastmath={"contract"})
def advance_parts(
    tables: Floats, lanes: Floats, state: Floats, felt: Floats, recorded: bool
) -> None:
    """Advance ``state`` [row, 3, part] over one mesh period, every row at a speed of its own.

    x'' + 2 g x' + s k f(x - e; b) = s load + 2 g e', time in mesh periods. ``tables`` [half step,
    3, part]: k over its mean, e and e' at the half steps, both ends included; ``lanes`` [row, 7,
    part]: s, 2 g, g^2, exp(g h/2) and its inverse, b and the load; ``state``: x, x' + g x and x''
    + 2 g x'. Where ``recorded``, ``felt`` [row, 3, part] is kept up: greatest and least k f and
    half steps out of drive-side contact. In z = exp(g t) x no force hangs on the velocity: a
    symplectic step of two forces, one with its gradient, is exact to fourth order, and where k is
    constant its phase to (h omega)^4/4320 per radian.
    Source: Chin 1997, algorithm A; for forces of time Chin and Chen 2002.
    """
    steps = (tables.shape[0] - 1) // 2
    count = state.shape[2]
    h = 1.0 / steps
    old, fast = np.empty(count), np.empty(count)
    for r in range(state.shape[0]):
        x, w, a = state[r, 0], state[r, 1], state[r, 2]
        scale, double, square = lanes[r, 0], lanes[r, 1], lanes[r, 2]
        grown, shrunk, backlash, load = lanes[r, 3], lanes[r, 4], lanes[r, 5], lanes[r, 6]
        most, least, lost = felt[r, 0], felt[r, 1], felt[r, 2]
        for number in range(steps):
            mid, end = 2 * number + 1, 2 * number + 2
            for j in range(count):
                s, q, b, f = scale[j], square[j], backlash[j], load[j]
                g, i = grown[j], shrunk[j]
                w0 = w[j] + h / 6.0 * (a[j] + q * x[j])
                z = x[j] + 0.5 * h * w0
                y = i * z - tables[mid, 1, j]
                free = 1.0 if abs(y) > b else 0.0
                behind = b if y > 0.0 else -b
                there = s * tables[mid, 0, j] * free
                force = double[j] * tables[mid, 2, j] + s * f - there * (y - behind) + q * i * z
                w0 += 2.0 / 3.0 * h * g * force * (1.0 + h * h / 24.0 * (q - there))
                z = i * i * (z + 0.5 * h * w0)
                y = z - tables[end, 1, j]
                free = 1.0 if abs(y) > b else 0.0
                behind = b if y > 0.0 else -b
                a2 = (
                    double[j] * tables[end, 2, j]
                    + s * f
                    - s * tables[end, 0, j] * free * (y - behind)
                )
                old[j], fast[j] = x[j], w[j]
                x[j], a[j] = z, a2
                w[j] = i * i * w0 + h / 6.0 * (a2 + q * z)
            if not recorded:
                continue
            for j in range(count):
                b, half = backlash[j], 0.5 * double[j]
                y = old[j] - tables[mid - 1, 1, j]
                before = tables[mid - 1, 0, j] * (y - b if y > b else y + b if y < -b else 0.0)
                y = 0.5 * (old[j] + x[j]) - tables[mid, 1, j]
                y += 0.125 * h * (fast[j] - half * old[j] - w[j] + half * x[j])
                force = tables[mid, 0, j] * (y - b if y > b else y + b if y < -b else 0.0)
                lost[j] += 1.0 if y <= b else 0.0
                y = x[j] - tables[end, 1, j]
                after = tables[end, 0, j] * (y - b if y > b else y + b if y < -b else 0.0)
                lost[j] += 1.0 if y <= b else 0.0
                low = force if force < after else after
                least[j] = low if low < least[j] else least[j]
                # the top of the parabola through all three, where it lies between them
                rise, bend = after - before, 2.0 * force - before - after
                inside = bend > 0.0 and abs(rise) <= 2.0 * bend
                top = force + 0.125 * rise * rise / bend if inside else after
                most[j] = top if top > most[j] else most[j]
