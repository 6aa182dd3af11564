"""Combs of lines that repeat at one step: impacts of a bearing, a rub, a shaft's own harmonics.

They need no teeth: their heights follow the resonances of the metal, neighbour by neighbour.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.groups import Flags, Seen, comb, comb_of, narrow, seen, some_of, take
from thermogear.measured.peaks import Peaks

Floats = NDArray[np.float64]

_STRONG = 14
_STEPS = 10
_KEPT = 6
_SIDE_SPREAD = 1.0


@dataclass(frozen=True)
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
    place = peaks.place[strong]
    apart = np.abs(place[:, None] - place)
    apart = apart[(apart > 4.0 * peaks.bin_width) & (apart < 0.1)]
    low = peaks.place[peaks.place < 0.1]
    heights = peaks.level[peaks.place < 0.1]
    tried = [*steps, *low[np.argsort(-heights)[:40]]]
    for top in place:
        for distance in np.sort(apart)[:: max(1, apart.size // _STEPS)]:
            middle = int(np.rint(top / distance))
            tried += [top / rank for rank in (middle - 1, middle, middle + 1) if rank >= 1]
    found: list[Comb] = []
    seen_steps: list[float] = []
    none = np.zeros(peaks.size, dtype=bool)
    for start in tried:
        if start < 4.0 * peaks.bin_width:
            continue
        step, error = comb_of(peaks, float(start))
        if any(abs(step / other - 1.0) < 1e-5 for other in seen_steps):
            continue
        seen_steps.append(step)
        evidence = comb(peaks, none, step, error)[0]
        if evidence > 0.0:
            found.append(Comb(step, error, evidence))
    found.sort(key=lambda one: -one.evidence)
    kept: list[Comb] = []
    for one in found:
        if all(abs(one.step / other.step - 1.0) > 1e-4 for other in kept):
            kept.append(one)
    return kept[:_KEPT]


def background(peaks: Peaks, used: Flags, combs: list[Comb]) -> tuple[float, tuple[Comb, ...]]:
    """Log evidence of the combs on the lines not used, each with its sidebands, and those seen."""
    total, told = 0.0, []
    used = used.copy()
    for one in combs:
        evidence, after, found = comb(peaks, used, one.step, one.error)
        if evidence <= 0.0:
            continue
        sides, after = _sidebands(peaks, after, one, found)
        total += evidence + sides
        used = after
        told.append(one)
    return total, tuple(told)


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
        near = away[np.abs(away - distance) < 0.6 * peaks.bin_width]
        middle = float(np.mean(near))
        error = 0.15 * peaks.bin_width / np.sqrt(near.size)
        position = np.stack([centre - middle, centre + middle], axis=1)
        sides = seen(peaks, used, position, error=error, spread=_SIDE_SPREAD)
        evidence = some_of(sides.evidence) + narrow(error, one.step)
        if evidence > best:
            best, after = evidence, used.copy()
            take(after, sides)
    return best, after
