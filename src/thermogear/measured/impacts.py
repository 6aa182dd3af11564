"""Combs of lines that repeat at one step: impacts of a bearing, a rub, a shaft's own harmonics.

They need no teeth: their heights follow the resonances of the metal, neighbour by neighbour.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from thermogear.base.arrays import Flags, Floats
from thermogear.measured.groups import (
    HIGHEST,
    ONE_MORE,
    Seen,
    comb,
    comb_of,
    mean_exp,
    narrow,
    seen,
    some_of,
    taken_by,
)
from thermogear.measured.peaks import Peaks

TIMES = 6
"""Multiples of the mains that are looked for: those of poles, rectifiers, inverters."""

_STRONG = 14
_STEPS = 10
_KEPT = 6
_SIDE_SPREAD = 1.0
_BESIDE = 4
_WHOLE = 12
_RATIOS = len({Fraction(p, q) for p in range(1, _WHOLE + 1) for q in range(1, _WHOLE + 1)})
_OUTSTANDING = 3
_MAINS = 2e-3  # how far the mains are off at most
_HIGHEST_RATIO = 250.0  # of a step to the distance of its sidebands
_SAME = 1e-4  # two steps are one
_NEAR = 0.1  # bins: a step that teeth foretell


@dataclass(frozen=True, kw_only=True)
class Comb:
    """Lines every ``step`` +- ``error`` [cycles/sample], and their log evidence alone."""

    step: float
    error: float
    evidence: float


def combs_of(peaks: Peaks, steps: tuple[float, ...] = ()) -> list[Comb]:
    """Combs with evidence for them, best first; ``steps`` are tried beside those of the lines.

    Steps tried: low lines themselves, and for each strong line the distances between strong lines
    that divide its own place.
    """
    if peaks.size < 3:
        return []
    strong = np.sort(np.argsort(-peaks.level)[:_STRONG])
    place, sure = peaks.place[strong], peaks.error[strong]
    apart = np.abs(place[:, None] - place)
    apart = apart[(apart > 4.0 * peaks.bin_width) & (apart < 0.1)]
    low = np.flatnonzero(peaks.place < 0.1)
    low = low[np.argsort(-peaks.level[low])[:40]]
    tried = [(step, _NEAR * peaks.bin_width) for step in steps]
    tried += zip(peaks.place[low], peaks.error[low], strict=True)
    for top, error in zip(place, sure, strict=True):
        for distance in _often(apart / peaks.bin_width) * peaks.bin_width:
            middle = int(np.rint(top / distance))
            ranks = (rank for rank in (middle - 1, middle, middle + 1) if rank >= 1)
            tried += [(top / rank, error / rank) for rank in ranks]
    found: list[Comb] = []
    seen_steps: list[float] = []
    none = np.zeros(peaks.size, dtype=bool)
    for start, sure_to in tried:
        if start < 4.0 * peaks.bin_width:
            continue
        step, error = comb_of(peaks, step=float(start), error=float(sure_to))
        if any(abs(step / other - 1.0) < 1e-5 for other in seen_steps):
            continue
        seen_steps.append(step)
        evidence = comb(peaks, none, step=step, error=error)[0]
        if evidence > 0.0:
            found.append(Comb(step=step, error=error, evidence=evidence))
    found.sort(key=lambda one: -one.evidence)
    kept: list[Comb] = []
    for one in found:
        if all(abs(one.step / other.step - 1.0) > _SAME for other in kept):
            kept.append(one)
    return kept[:_KEPT]


def _often(apart: Floats) -> Floats:
    """The distances [bins] that most pairs have, each once, the most frequent first."""
    ordered = np.sort(apart)
    parts = np.split(ordered, np.flatnonzero(np.diff(ordered) > 0.5) + 1)
    parts.sort(key=lambda part: -part.size)
    return np.array([float(np.mean(part)) for part in parts[:_STEPS] if part.size])


def standing_out(peaks: Peaks, step: float, *, fewest: int, most: int) -> list[int]:
    """The numbers of steps whose first six multiples stand highest over their eight neighbours."""
    count = int(HIGHEST / step)
    if count < fewest + _BESIDE:
        return []
    index, off = peaks.nearest(np.asarray(np.arange(1, count + 1) * step, float))
    level = np.where(np.abs(off) < 1.0, peaks.level[index] - peaks.least, 0.0)
    around = np.ones(2 * _BESIDE + 1) / (2.0 * _BESIDE)
    around[_BESIDE] = 0.0
    over = level - np.convolve(level, around, mode="same")
    number = np.arange(fewest, min(most, count) + 1)
    total = np.zeros(number.size)
    for rank in range(1, 7):
        there = rank * number <= count
        total[there] += over[rank * number[there] - 1]
    return [int(number[place]) for place in np.argsort(-total)[:_OUTSTANDING]]


class Background:
    """Combs behind a record's lines, and their evidence on what a gear leaves of the lines.

    ``combs``: those looked for; ``mains`` [cycles/sample]: lines of which a motor or its inverter
    makes multiples. What a comb and its sidebands hold of the same lines left is looked for once.
    """

    def __init__(self, peaks: Peaks, combs: list[Comb], *, mains: tuple[float, ...] = ()) -> None:
        self._peaks = peaks
        self._held: dict[tuple[bytes, float], tuple[float, Flags, Seen]] = {}
        self._beside: dict[tuple[bytes, float], tuple[float, Flags]] = {}
        self._mains: tuple[float, ...] = ()
        self._orders = self._orders_of(combs)
        self._mains = mains

    def on(self, used: Flags, fixed: tuple[float, ...] = ()) -> tuple[float, tuple[Comb, ...]]:
        """Log evidence of the combs on the lines not used, each with its sidebands, and those seen,
        in the order of combs that explains most.

        The step of a shaft in ``fixed`` [cycles/sample] is no free number. One that is p/q of a
        step seen before, p and q up to 12, is one of so many ratios: shafts of one train turn so.
        One that is a multiple of the mains is free within what the mains deviate by.
        """
        found = [self._in_order(used, order, fixed) for order in self._orders]
        return max(found, key=lambda one: one[0])

    def _orders_of(self, combs: list[Comb]) -> list[list[Comb]]:
        """The combs in the order of their evidence alone, and with that one first which leaves most
        to the others: a comb at a part of a step holds lines that belong to another's sidebands."""
        none = np.zeros(self._peaks.size, dtype=bool)
        orders = [[one, *(other for other in combs if other is not one)] for one in combs]
        if len(orders) < 2:
            return [combs]
        best = max(orders, key=lambda order: self._in_order(none, order, ())[0])
        return [orders[0]] if best is orders[0] else [orders[0], best]

    def _in_order(
        self, used: Flags, combs: list[Comb], fixed: tuple[float, ...]
    ) -> tuple[float, tuple[Comb, ...]]:
        total, told = 0.0, []
        known = list(fixed)
        for one in combs:
            key = used.tobytes(), one.step
            if key not in self._held:
                self._held[key] = comb(self._peaks, used, step=one.step, error=one.error)
            evidence, after, found = self._held[key]
            if any(abs(one.step / step - 1.0) < _SAME for step in fixed):
                evidence -= narrow(one.error, width=0.1)
            elif any(_in_ratio(one, step) for step in known):
                evidence += max(0.0, -float(np.log(_RATIOS)) - narrow(one.error, width=0.1))
            else:
                evidence += _of_mains(one, self._mains)
            evidence += ONE_MORE
            if evidence <= 0.0:
                continue
            if key not in self._beside:
                self._beside[key] = _sidebands(self._peaks, after, one, found)
            sides, used = self._beside[key]
            total += evidence + sides
            known.append(one.step)
            told.append(one)
        return total, tuple(told)


def _of_mains(one: Comb, mains: tuple[float, ...]) -> float:
    """What the prior of a step gains where it is a multiple of the mains, logarithm."""
    for line in mains:
        ratio = one.step / line
        times = int(np.rint(ratio))
        if 1 <= times <= TIMES and abs(ratio / times - 1.0) < _MAINS:
            known = narrow(one.error, width=2.0 * _MAINS * one.step)
            choice = -float(np.log(TIMES * len(mains)))
            return max(0.0, known + choice - narrow(one.error, width=0.1))
    return 0.0


def _in_ratio(one: Comb, step: float) -> bool:
    """Whether two steps are as whole numbers up to 12 are."""
    ratio = one.step / step
    near = Fraction(ratio).limit_denominator(_WHOLE)
    return 0 < near.numerator <= _WHOLE and abs(ratio - float(near)) < max(
        3.0 * one.error / step, 0.1 * _SAME
    )


def _sidebands(peaks: Peaks, used: Flags, one: Comb, found: Seen) -> tuple[float, Flags]:
    """Log evidence of sidebands at one free distance around the comb's lines."""
    lines = found.lines[found.evidence > 0.0].ravel()
    lines = lines[lines >= 0]
    rest = peaks.place[~used]
    if lines.size < 2 or rest.size < 2:
        return 0.0, used
    centre = peaks.place[lines]
    away = np.abs(rest[:, None] - centre[None, :]).min(axis=1)
    away = np.sort(away[(away > 4.0 * peaks.bin_width) & (away < one.step)])
    if away.size < 4:
        return 0.0, used
    bins = away / peaks.bin_width
    count = np.searchsorted(bins, bins + 0.5) - np.searchsorted(bins, bins - 0.5)
    best, after = 0.0, used
    for distance in away[np.argsort(-count)[:3]]:
        middle, error = _distance(peaks, used, centre, float(distance))
        position = np.stack([centre - middle, centre + middle], axis=1)
        sides = seen(peaks, used, position, error=error, spread=_SIDE_SPREAD)
        # any distance alike, or any ratio to the step alike, as of a gear's teeth
        ratio = one.step / middle
        anywhere = narrow(error, width=one.step)
        as_teeth = narrow(error * ratio / middle, width=_HIGHEST_RATIO)
        prior = mean_exp((anywhere, as_teeth))
        evidence = float(some_of(sides.evidence)) + prior + ONE_MORE
        if evidence > best:
            best, after = evidence, used.copy()
            after[taken_by(sides)] = True
    return best, after


def _distance(peaks: Peaks, used: Flags, centre: Floats, start: float) -> tuple[float, float]:
    """The distance of the lines that stand so beside the centres, a weighted mean, and its
    error."""
    values, weights = [], []
    for side in (-1.0, 1.0):
        index, off = peaks.nearest(centre + side * start)
        near = (np.abs(off) < 0.6) & ~used[index]
        values.append(side * (peaks.place[index[near]] - centre[near]))
        own, _ = peaks.nearest(centre[near])
        weights.append(1.0 / (peaks.error[index[near]] ** 2 + peaks.error[own] ** 2))
    value, weight = np.concatenate(values), np.concatenate(weights)
    middle = float(np.average(value, weights=weight))
    misfit = float(np.sum(weight * (value - middle) ** 2)) / max(1, value.size - 1)
    return middle, float(np.sqrt(max(1.0, misfit) / np.sum(weight)))
