"""What a start settles on under forces that never come again: by its conditional exponent.

Mesh and cages turn as they are driven, whatever the train does: states over their phases are a skew
product, and the driven motion (phases) carries the states by x_(n+1) = P(x_n, theta + n omega). A
motion is settled where two starts under the same driven motion come together and the largest
exponent of a small distance between states alone, the conditional one, is negative (Pecora and
Carroll, Physical Review A 44, 1991, 2374). It is taken of a companion that is put back beside its
motion again and again (Benettin's way): a train on rolling bearings carries ten such companions in
the time of one tangent.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from thermogear.analysis.torus import smooth_window
from thermogear.analysis.walk import Motion
from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError
from thermogear.base.plan import Alive, keep_going

TOGETHER = 1e-4
"""Distance in units of the map below which two starts have come together: chosen, above the 1e-5
that steps of 1e-9 miss where elements begin to carry, over the time a slow motion takes to die."""
ROUND = 128
"""Mesh periods between two looks at both starts."""
BESIDE = 1e-3
"""Distance of a companion in units of the map: a thousand times what a period's steps miss, and a
thousandth of a half backlash."""
RENEWED = 4
"""Mesh periods after which a companion is put back to that distance: it may come nearer by a
hundred in them and is still far from what steps miss."""
BATCHES = 8
LENGTHS = (32, 128)
"""Renewals in a batch of the exponent; the longer where the shorter do not show that it is
negative."""
SURE = 4.0
"""Errors that an exponent must be away from zero (chosen, as for other exponents)."""


class ForcedMap(Protocol):
    """A map of states (d,) whose forces know how many mesh periods went by: ``turn``."""

    @property
    def period(self) -> float:
        """Time of a mesh period [s]."""

    @property
    def unit(self) -> Floats:
        """Scales of a state (d,)."""

    def carry(self, start: Floats, periods: int, *, turn: int) -> Floats:
        """The states (periods, d) after 1, 2, ... periods from ``start``."""


def settle_forced(
    section: ForcedMap, starts: Floats, *, cap: int, alive: Alive = keep_going
) -> Motion:
    """Follow two ``starts`` (2, d) for ``cap`` mesh periods at most, and the exponent of the first.

    "settled": both come together, and the largest conditional exponent is negative beyond four of
    its errors. "chaotic": it is positive beyond them. Else "undecided", or "diverged" where one
    runs away. ``lyapunov`` [1/s] is that exponent in the second half of its record; its error is
    the greater of its scatter there and what it differs by from the first half. ``discarded``: mesh
    periods up to the state. A settled motion need not be the only one: other starts may settle on
    another. ``alive`` raises to end the work.
    """
    first, second = np.asarray(starts, dtype=float)
    turn, away = 0, np.inf
    try:
        while turn < cap and away > TOGETHER:
            alive()
            first, second = (section.carry(each, ROUND, turn=turn)[-1] for each in (first, second))
            turn += ROUND
            away = float(np.max(np.abs(first - second) / section.unit))
        # what is left of their distance decays most slowly
        separation = second - first if away > 0.0 else section.unit
        for length in LENGTHS:
            alive()
            growth = np.zeros(BATCHES * length)
            for place in range(growth.size):
                second = first + separation * (BESIDE / _size(separation / section.unit))
                first, second = (
                    section.carry(each, RENEWED, turn=turn)[-1] for each in (first, second)
                )
                separation, turn = second - first, turn + RENEWED
                growth[place] = np.log(max(_size(separation / section.unit), 1e-300) / BESIDE)
            # a slow pair turns in its plane: under a smooth window that falls out of the mean
            batches = growth.reshape(BATCHES, length) @ smooth_window(length) / RENEWED
            means = batches / section.period
            early, late = means.reshape(2, -1)
            value, scatter = float(late.mean()), float(late.std(ddof=1) / np.sqrt(late.size))
            # directions that decay nearly as slowly die out meanwhile
            error = max(scatter, abs(value - float(early.mean())))
            sure = abs(value) > SURE * error
            if sure and value < 0.0:
                break
    except ConvergenceError as why:
        return Motion(name="diverged", period=0, reason=str(why), state=first, discarded=turn)
    name = "undecided"
    if sure and value > 0.0:
        name = "chaotic"
    elif sure and away <= TOGETHER:
        name = "settled"
    reason = f"largest conditional exponent {value * section.period:.3g} +- "
    reason += f"{error * section.period:.1g} per mesh period, two starts {away:.1g} apart"
    return Motion(
        name=name,
        period=0,
        reason=f"{reason} after {turn} mesh periods driven alike",
        state=first,
        discarded=turn,
        lyapunov=value,
        lyapunov_error=error,
        batches=means,
        exponents=np.array([value]),
    )


def _size(vector: Floats) -> float:
    return float(np.linalg.norm(vector))
