"""Shafts of gears whose teeth are decided, as their sidebands measure them, and a further mesh.

Everything here is in orders of the mesh line. The one physical law used: a mesh line is at a
whole number of every shaft it belongs to.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.prominence import Prominence

_FEWEST = 17  # teeth of a further mesh: below, a standard gear of 20 degrees is undercut
_SIGNIFICANT = 6.0  # standard deviations of a mean over noise lines


@dataclass(frozen=True, kw_only=True)
class Shaft:
    """A shaft seen by its sidebands: ``teeth`` = mesh line over shaft line, whole by law.

    ``ratio`` +- ``ratio_error`` is the measured one, ``order`` that of the first shaft,
    ``score`` the mean log prominence of its sidebands, ``lines`` how many of them are clear,
    ``weight`` that of all hypotheses with this gear (:mod:`thermogear.measured.evidence`).
    """

    teeth: int
    ratio: float
    ratio_error: float
    order: float
    score: float
    lines: int
    weight: float


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


def shafts_of(sharp: Prominence, top: int, weights: dict[int, float]) -> tuple[Shaft, ...]:
    """The shafts of gears whose teeth are decided (teeth -> weight), the faster one first, with
    the ratio that their sidebands around the harmonics up to ``top`` measure."""
    harmonics = np.arange(1, top + 1)
    teeth = sorted(weights)
    found = []
    for z in teeth:
        ratio, error, lines, score = _measured(sharp, harmonics, z)
        found.append(
            Shaft(
                teeth=z,
                ratio=ratio,
                ratio_error=error,
                order=teeth[0] / z,
                score=score,
                lines=lines,
                weight=weights[z],
            )
        )
    return tuple(found)


def _sides(harmonics: NDArray[np.int64], teeth: int, ranks: tuple[int, ...]) -> NDArray[np.float64]:
    return np.array(
        [h + s * n / teeth for h in harmonics for n in ranks for s in (-1, 1)], dtype=float
    )


def _measured(
    sharp: Prominence, harmonics: NDArray[np.int64], teeth: int
) -> tuple[float, float, int, float]:
    """Mesh line over shaft line as the sidebands' own peaks measure it, its standard error, how
    many of them are clear, and the mean log prominence of sidebands 1 to 3.

    One bin at the shaft line is the error where fewer than three are clear.
    """
    score = float(np.mean(sharp.at(_sides(harmonics, teeth, (1, 2, 3)))))
    unclear = float(teeth), teeth**2 / sharp.per_unit, 0, score
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
    if np.count_nonzero(good) < 3 or abs(spacing * teeth - 1.0) > 0.01:
        return unclear
    spread = float(np.std(d[good] - spacing * n[good])) / float(np.sqrt(np.dot(n[good], n[good])))
    ratio = 1.0 / spacing
    return ratio, max(spread, 1e-6 / teeth) * ratio**2, int(np.count_nonzero(good)), score


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
