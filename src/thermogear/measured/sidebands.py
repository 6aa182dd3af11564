"""Shafts and tooth numbers from the sidebands of a mesh line, and a further mesh.

Everything here is in orders of the mesh line. The one physical law used: a mesh line is at a
whole number of every shaft it belongs to.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.prominence import Prominence

Floats = NDArray[np.float64]

_TEETH = (12, 250)  # fewer are not made as power gears
_FEWEST = 17  # teeth of a further mesh: below, a standard gear of 20 degrees is undercut
_SIGNIFICANT = 6.0  # standard deviations of a mean over noise lines
_TRIES = 8
_WHOLE = 0.02  # how far a measured tooth number may be from a whole one, up to 50 teeth


@dataclass(frozen=True, kw_only=True)
class Shaft:
    """A shaft seen by its sidebands: ``teeth`` = mesh line over shaft line, whole by law.

    ``ratio`` +- ``ratio_error`` is the measured one, ``order`` that of the first shaft,
    ``score`` the mean log prominence of its sidebands, ``lines`` how many of them are clear.
    """

    teeth: int
    ratio: float
    ratio_error: float
    order: float
    score: float
    lines: int


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """A further mesh: ``order`` of the first shaft, teeth on its two shafts, how sure.

    ``margin``: score over the next candidate's; below ``WEAK`` the next one is nearly as good.
    """

    order: float
    teeth: tuple[int, int]
    score: float
    margin: float
    next_order: float

    @property
    def weak(self) -> bool:
        """Whether the next candidate is nearly as good."""
        return self.margin < WEAK


WEAK = 0.2
"""Margin (of mean log prominence) below which a further mesh is called weak."""


def shafts_of(sharp: Prominence, top: int, evidence: list[str]) -> tuple[Shaft, ...]:
    """The two gears with the clearest sidebands, the faster shaft (fewer teeth) first."""
    harmonics = np.arange(1, top + 1)
    highest = min(_TEETH[1], int(sharp.per_unit / 6))
    teeth = np.arange(_TEETH[0], highest + 1)
    if teeth.size < 2:
        return ()
    first = np.array([np.mean(sharp.at(_sides(harmonics, int(z), (1,)))) for z in teeth])
    three = np.array([np.mean(sharp.at(_sides(harmonics, int(z), (1, 2, 3)))) for z in teeth])
    count = 2 * top
    needed = _SIGNIFICANT * sharp.spread
    possible = (three >= needed / np.sqrt(3 * count)) & (first >= needed / np.sqrt(count))
    # two shafts together fill the lattice of their common multiple, so sidebands 2 and 3 alone
    # would favour it; the first ones alone would favour a shaft's own strong fourth or fifth
    score = np.where(possible, first + three, -np.inf)
    found: list[Shaft] = []
    for _ in range(_TRIES):
        if len(found) == 2:
            break
        place = int(np.argmax(score))
        if not np.isfinite(score[place]):
            break
        z = _outer(sharp, harmonics, int(teeth[place]), float(three[place]), highest)
        shaft = _refined(sharp, harmonics, z, float(three[place]))
        if shaft is None or any(shaft.teeth == other.teeth for other in found):
            score[place] = -np.inf
            continue
        found.append(shaft)
        # what divides it is explained by it, and so are its neighbours within the resolution
        same = np.abs(1.0 / teeth - 1.0 / shaft.teeth) * sharp.per_unit < 1.5
        score[(shaft.teeth % teeth == 0) | same] = -np.inf
    if len(found) == 1:
        inner = _inner(sharp, harmonics, found[0].teeth)
        if inner is not None:
            found.append(inner)
    found.sort(key=lambda shaft: shaft.teeth)
    found = [replace(shaft, order=found[0].teeth / shaft.teeth) for shaft in found]
    for shaft in found:
        evidence.append(
            f"sidebands at mesh/{shaft.ratio:.3f} (+-{shaft.ratio_error:.3f}), {shaft.lines} of "
            f"them over 3 times the floor: a gear of {shaft.teeth} teeth, shaft order "
            f"{shaft.order:.4f}"
        )
    return tuple(found)


def _outer(
    sharp: Prominence, harmonics: NDArray[np.int64], teeth: int, score: float, highest: int
) -> int:
    """The multiple of ``teeth`` whose sidebands between are nearly as high, else ``teeth``.

    Where the even sidebands of a shaft happen to be the strongest, half its tooth number would
    win: the odd ones between them tell.
    """
    for k in (2, 3):
        if k * teeth > highest:
            continue
        between = tuple(n for n in range(1, 2 * k + 2) if n % k)
        nearest = np.mean(sharp.at(_sides(harmonics, k * teeth, (1,))))
        own = np.mean(sharp.at(_sides(harmonics, teeth, (1,))))
        level = np.mean(sharp.at(_sides(harmonics, k * teeth, between)))
        # a lattice that two shafts fill together has weak first sidebands
        if level > 0.75 * score and nearest > 0.7 * own:
            return _outer(sharp, harmonics, k * teeth, score, highest)
    return teeth


def _inner(sharp: Prominence, harmonics: NDArray[np.int64], teeth: int) -> Shaft | None:
    """A faster shaft whose tooth number divides ``teeth``: with a whole ratio k its sidebands are
    every k-th of the slow shaft's, and far higher than those between."""
    best: tuple[float, int] = (1.0, 0)  # at least a factor e over those between
    for k in range(2, teeth // _TEETH[0] + 1):
        if teeth % k:
            continue
        on = np.mean(sharp.at(_sides(harmonics, teeth, (k, 2 * k))))
        # the slow shaft's own first sideband may be strong; its further ones fall off
        between = tuple(n for n in range(2, 2 * k) if n != k)
        off = np.mean(sharp.at(_sides(harmonics, teeth, between)))
        best = max(best, (float(on - off), teeth // k))
    return _refined(sharp, harmonics, best[1], best[0]) if best[1] else None


def _sides(harmonics: NDArray[np.int64], teeth: int, ranks: tuple[int, ...]) -> Floats:
    return np.array(
        [h + s * n / teeth for h in harmonics for n in ranks for s in (-1, 1)], dtype=float
    )


def _refined(
    sharp: Prominence, harmonics: NDArray[np.int64], teeth: int, score: float
) -> Shaft | None:
    """The spacing measured from the sidebands' own peaks; None when it is no whole number."""
    spacing = 1.0 / teeth
    good = np.zeros(0, dtype=bool)
    n = d = np.zeros(0)
    # the nearest sidebands place the next ones: a guess half a bin off would miss the sixth
    for reach in (1, 2, 3, 4, 6):
        ranks, offsets = [], []
        for h in harmonics:
            for rank in (*range(-reach, 0), *range(1, reach + 1)):
                place, height = sharp.peak(h + rank * spacing, reach=1)
                if height > np.log(3.0):
                    ranks.append(rank)
                    offsets.append(place - h)
        if len(ranks) < 3:
            continue
        n, d = np.asarray(ranks, dtype=float), np.asarray(offsets, dtype=float)
        residual = d - n * float(np.median(d / n))
        middle = max(1.4826 * float(np.median(np.abs(residual))), 0.02 / sharp.per_unit)
        good = np.abs(residual) <= 3.0 * middle
        if np.count_nonzero(good) < 3:
            continue
        spacing = float(np.dot(n[good], d[good]) / np.dot(n[good], n[good]))
    if np.count_nonzero(good) < 3:
        return None
    spread = float(np.std(d[good] - spacing * n[good])) / float(np.sqrt(np.dot(n[good], n[good])))
    ratio = 1.0 / spacing
    error = max(spread, 1e-6 / teeth) * ratio**2
    whole = int(np.rint(ratio))
    # a gear's ratio is whole; what only comes near a whole number is another lattice of lines
    if abs(ratio - whole) > _WHOLE * max(1.0, whole / 50.0) or whole < _TEETH[0]:
        return None
    return Shaft(
        teeth=whole,
        ratio=ratio,
        ratio_error=error,
        order=1.0,
        score=score,
        lines=int(np.count_nonzero(good)),
    )


def second_mesh(
    sharp: Prominence, shafts: tuple[Shaft, ...], top: int, evidence: list[str]
) -> tuple[Mesh, ...]:
    """The mesh of the second with a slower shaft, by its harmonics among 1..4, where one shows."""
    first, second = shafts[0].teeth, shafts[1].teeth
    # a slower shaft: the line that stands out most below the second shaft's
    low, high = int(np.ceil(6)), int(0.97 / second * sharp.per_unit)
    if high - low < 8:
        return ()
    top_bin = low + int(np.argmax(sharp.level[low:high]))
    place, height = sharp.peak(top_bin / sharp.per_unit, reach=1)
    if height < max(_SIGNIFICANT * sharp.spread / 2.0, np.log(3.0)):
        return ()
    ratio = place * second  # slow shaft over second shaft
    step = Fraction(ratio).limit_denominator(12)
    if abs(float(step) - ratio) > 1.5 * second / sharp.per_unit or not 0 < step < 1:
        return ()
    evidence.append(
        f"a slower shaft at order {place * first:.4f}: {step} of the second shaft "
        f"({np.exp(height):.1f} times over the floor)"
    )
    scored: list[tuple[float, int]] = []
    for m in range(1, 200):
        driving, driven = step.numerator * m, step.denominator * m
        if driving < _FEWEST or driven > 160:
            continue
        order = driving / second  # of the mesh
        ranks = [
            h
            for h in range(1, 5)
            if h * order < top + 0.5 and not _explained(h * order, first, second)
        ]
        if len(ranks) >= 2 and 1 in ranks:
            score = float(np.mean(sharp.at(np.asarray(ranks) * order)))
            scored.append((score, m))
    scored.sort(reverse=True)
    if len(scored) < 2 or scored[0][0] < 0.5 * np.log(3.0):
        return ()
    (score, m), (other, n) = scored[0], scored[1]
    order = step.numerator * m * first / second
    mesh = Mesh(
        order=order,
        teeth=(step.numerator * m, step.denominator * m),
        score=score,
        margin=score - other,
        next_order=step.numerator * n * first / second,
    )
    sure = "weak: " if mesh.weak else ""
    evidence.append(
        f"{sure}second mesh at order {order:.3f} ({mesh.teeth[0]}/{mesh.teeth[1]} teeth): its "
        f"harmonics stand {np.exp(score):.2f} times over the floor, those of the next candidate "
        f"({mesh.next_order:.3f}) {np.exp(other):.2f} times"
    )
    return (mesh,)


def _explained(order: float, first: int, second: int) -> bool:
    """Whether a line (in mesh orders) is one of the first shaft's or a near sideband."""
    turns = order * first
    if abs(turns - round(turns)) < 1e-6:
        return True
    away = (order - round(order)) * second
    return abs(away) < 3.5 and abs(away - round(away)) < 1e-6
