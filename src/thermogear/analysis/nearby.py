"""A zero of a test function on a branch of orbits, looked for around a guess."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.curve import Curve, Point, Stretch
from thermogear.base.errors import ConvergenceError

MOST_LOOKS = 30
SHORTEST = 1e-4
"""Of the first step of a search: the shortest."""


def zero_near(
    curve: Curve,
    test: Callable[[Point], float],
    guess: NDArray[np.float64],
    *,
    farthest: float,
    first: float = 1e-4,
) -> Point | None:
    """The nearest zero of ``test`` on the branch through the neighbourhood of ``guess`` (d + 1,).

    Near a grazing multipliers run as the root of the distance from it, which no Newton follows. A
    test function may jump through 0, too: then it is the point on one side. None without a zero
    ``farthest`` (scaled) around. The search begins with the step ``first``.
    """
    gap, jacobian, section = curve.residual(guess)
    units = curve.unit[:-1]
    flat = np.column_stack(
        [
            jacobian / units[:, None] * units - np.eye(units.size),
            curve.in_parameter(guess, section)[0],
        ]
    )
    if not (np.all(np.isfinite(gap)) and np.all(np.isfinite(flat))):
        return None
    here = curve.correct(guess, normal=np.linalg.svd(flat)[2][-1], reach=farthest)
    if here is None:
        return None
    ends, steps = {1.0: here, -1.0: here}, {1.0: first, -1.0: first}
    for _ in range(MOST_LOOKS):
        for way in [w for w in ends if steps[w] > SHORTEST * first]:
            last, step = ends[way], way * steps[way]
            there = curve.correct(
                last.scaled + step * last.tangent,
                normal=last.tangent,
                old=last.tangent,
                reach=0.5 * steps[way],
            )
            if there is None or there.tangent @ last.tangent < 0.5:
                steps[way] *= 0.25
                continue
            if test(last) * test(there) < 0.0:
                stretch = Stretch(curve, *((last, there) if way > 0.0 else (there, last)))
                return stretch.at(_zero(stretch, test))
            ends[way] = there
            far = float(np.linalg.norm(there.scaled - here.scaled)) > farthest
            steps[way] = 0.0 if far else 2.0 * steps[way]
    return None


def _zero(stretch: Stretch, test: Callable[[Point], float]) -> float:
    """Where ``test`` vanishes, or how far its sign is known to last where orbits are missing."""
    try:
        return stretch.zero(test, low=0.0, high=stretch.length)
    except ConvergenceError:
        sign = test(stretch.first)
        return stretch.narrowed(lambda point: test(point) * sign > 0.0, 0.0)
