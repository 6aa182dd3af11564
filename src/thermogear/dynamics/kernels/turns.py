"""Fixed steps of a pair over its turn, many speeds side by side, with what the gears feel of it."""

from __future__ import annotations

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
