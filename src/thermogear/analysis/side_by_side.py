"""Motions along one parameter, each handed on to its neighbours: where several exist at once.

A coarse look without branches: what is found at one lane is tried at the neighbouring lanes until
nothing new turns up, so that a motion is followed as far as it lives, up to one lane's distance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.settle import PERIODIC, Rule, Settled, settle
from thermogear.base.arrays import Floats, Whole
from thermogear.dynamics.lanes import Lanes

RULE = Rule(first=32, cap=1024, chaos_periods=200)
APART = 1e-2
"""Half backlashes between the sections of two motions that are not one."""
KEEP = 32


@dataclass(frozen=True)
class Motions:
    """One entry per motion: its ``lane``, the ``state`` (motion, 2) it goes on from at phase 0,
    ``label`` (code of :data:`~thermogear.analysis.settle.LABELS`) and ``period`` (0: none)."""

    lane: Whole
    state: Floats
    label: NDArray[np.int8]
    period: NDArray[np.int32]

    def count(self, lanes: int) -> Whole:
        """How many motions each of ``lanes`` lanes has."""
        return np.bincount(self.lane, minlength=lanes)


def motions_along(
    lanes: Lanes, starts: ArrayLike, *, rule: Rule = RULE, passes: int = 64
) -> Motions:
    """Every motion that the ``starts``, and the motions of neighbours, lead to.

    ``starts`` (start, 2) of every lane, or (lane, start, 2); a lane's first motion is that of its
    first start. ``lanes`` in the order of the parameter. Two periodic motions of one lane are one
    where their sections lie within :data:`APART`; others where their labels agree. At most
    ``passes`` rounds.
    """
    count = len(lanes)
    first = np.asarray(starts, dtype=float)
    index = np.repeat(np.arange(count), first.shape[-2])
    begin = np.broadcast_to(first, (count, *first.shape[-2:])).reshape(-1, 2)
    known: list[list[tuple[int, int, Floats, Floats]]] = [[] for _ in range(count)]
    for _ in range(passes):
        settled = settle(lanes.take(index), begin, rule, KEEP)
        fresh = [
            (int(lane), settled.state[row])
            for row, lane in enumerate(index)
            if _added(known[lane], settled, row)
        ]
        beside = [(n, s) for lane, s in fresh for n in (lane - 1, lane + 1) if 0 <= n < count]
        if not beside:
            break
        index = np.array([lane for lane, _ in beside])
        begin = np.array([state for _, state in beside])
    rows = [(lane, *one) for lane, several in enumerate(known) for one in several]
    return Motions(
        np.array([row[0] for row in rows], dtype=np.int64),
        np.array([row[3] for row in rows]).reshape(-1, 2),
        np.array([row[1] for row in rows], dtype=np.int8),
        np.array([row[2] for row in rows], dtype=np.int32),
    )


def _added(known: list[tuple[int, int, Floats, Floats]], settled: Settled, row: int) -> bool:
    """Whether the motion of a row is new to its lane; it is written down then."""
    label, period = int(settled.label[row]), int(settled.period[row])
    places = settled.sections[row][-max(period, 1) :]
    lowest = places[np.lexsort(places.T[::-1])[0]]
    for other, of_other, at, _ in known:
        alike = label == other and period == of_other
        if alike and (label != PERIODIC or float(np.abs(at - lowest).max()) < APART):
            return False
    known.append((label, period, lowest, settled.state[row].copy()))
    return True
