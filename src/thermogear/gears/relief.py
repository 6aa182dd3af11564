"""Tip relief that makes the loaded mesh run evenly at one load and temperature."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.gears.deviations import Deviation, Relief
from thermogear.gears.loaded import LoadedModel, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.stiffness import Moduli

_SHORTEST = 0.05  # base pitches
STARTS = ((0.2, 0.15), (0.3, 0.3), (0.4, 0.45), (0.5, 0.3))
"""Amount and length from which the searches begin, parts of their bounds."""
MOST_EVALUATIONS = 400
"""Evaluations of the mesh period from one start, at most."""


@dataclass(frozen=True, kw_only=True)
class ReliefDesign:
    """The relief found and the peak-to-peak transmission error [m] without and with it."""

    pinion: Relief
    wheel: Relief
    unrelieved: float
    relieved: float
    evaluations: int


def optimise_tip_relief(
    pair: GearPair,
    normal_force: float,
    *,
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
    deviations: Sequence[Deviation] = (),
    model: LoadedModel | None = None,
    shape: str = "linear",
    largest: float | None = None,
    positions: int = 100,
    symmetric: bool = False,
    evaluations: int = MOST_EVALUATIONS,
    progress: Callable[[int], None] | None = None,
) -> ReliefDesign:
    """Amount and length of the tip relief of both gears with the least peak-to-peak error.

    Minimises max - min of the static transmission error over one mesh period by Nelder and
    Mead's simplex (the peak is not smooth) from several starts; the best of them and of no
    relief at all is returned, so that it is never worse than the unrelieved pair.

    normal_force: F_n [N] > 0; moduli and deviations (for example the hot pair's base-pitch
    difference) as :func:`loaded_contact`, without leading axes; shape: "linear" or "parabolic";
    largest: greatest amount [m], default three times the unrelieved error's mean height over its
    least value plus its peak-to-peak value; positions: of the mesh period; symmetric: both gears
    with one amount and one length; evaluations: at most so many from every start; progress: called
    with those so far. Lengths are between 0.05 base pitches and the active profile.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> design = optimise_tip_relief(pair, 4e3, positions=16, symmetric=True, evaluations=20)
    >>> design.relieved < design.unrelieved
    True
    """
    if not (np.isfinite(normal_force) and normal_force > 0.0):
        raise InputError("normal_force", f"{normal_force} N", allowed="> 0, finite")
    phase = np.arange(positions) / positions

    def error(extra: Sequence[Deviation]) -> Floats:
        solved = solve_mesh(
            pair,
            normal_force,
            phase,
            pinion=pinion,
            wheel=wheel,
            deviations=[*deviations, *extra],
            model=model,
        )
        return solved.checked().deflection

    plain = error(())
    unrelieved = float(np.ptp(plain))
    most = 3.0 * float(plain.mean() - plain.min() + np.ptp(plain)) if largest is None else largest
    longest = pair.path.e - pair.path.a
    shortest = _SHORTEST * pair.base_pitch

    def reliefs(x: Floats) -> tuple[Relief, Relief]:
        amount = most * np.clip(x[:2], 0.0, 1.0)
        length = shortest + (longest - shortest) * np.clip(x[2:], 0.0, 1.0)
        return (
            Relief("pinion", amount=float(amount[0]), length=float(length[0]), shape=shape),
            Relief("wheel", amount=float(amount[1]), length=float(length[1]), shape=shape),
        )

    from scipy.optimize import minimize

    def full(x: Floats) -> Floats:
        return np.repeat(x, 2) if symmetric else x

    best_x, best, done = np.array([0.0, 0.0, 0.3, 0.3]), unrelieved, 1

    def peak(x: Floats) -> float:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done)
        return float(np.ptp(error(reliefs(full(x)))))

    for amount, length in STARTS:
        start = np.array([amount, length] if symmetric else [amount, amount, length, length])
        found = minimize(
            peak,
            start,
            method="Nelder-Mead",
            bounds=[(0.0, 1.0)] * start.size,
            options={"xatol": 1e-3, "fatol": 1e-4 * unrelieved, "maxfev": evaluations},
        )
        if found.fun < best:
            best, best_x = float(found.fun), full(np.asarray(found.x))
    one, two = reliefs(best_x)
    return ReliefDesign(
        pinion=one, wheel=two, unrelieved=unrelieved, relieved=best, evaluations=done
    )
