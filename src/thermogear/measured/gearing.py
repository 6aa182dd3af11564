"""Mesh line, shafts and tooth numbers found from the lines of a record, with the evidence.

Everything here is in cycles per sample and in orders: no rate is needed and none is invented.
The one physical law used: a mesh line stands at a whole number of every shaft it belongs to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.signals.lines import hann_offset
from thermogear.signals.orders import line_angle, resample_by_angle
from thermogear.signals.spectra import amplitude_spectrum

Floats = NDArray[np.float64]

LONGEST = 1 << 19
"""Samples that the search looks at, from the start of the record."""

_HARMONICS = 5
_TEETH = (12, 250)  # fewer are not made as power gears
_FEWEST = 17  # teeth of a further mesh: below, a standard gear of 20 degrees is undercut
_SIGNIFICANT = 6.0  # standard deviations of a mean over noise lines
_TRIES = 8
_CANDIDATES = 20  # families looked at for sidebands
_WHOLE = 0.02  # how far a measured tooth number may be from a whole one, up to 50 teeth
_SCREEN = 1 << 16
_LAW_KEPT = 0.7  # what sidebands at a whole number of teeth count for, beside their height
_MOST_FROM_SIDEBANDS = 3.2  # scores of sidebands stay below this
_NARROW = 0.006  # half width of the phase filter over the mesh line


@dataclass(frozen=True, kw_only=True)
class Shaft:
    """A shaft seen by its sidebands: ``teeth`` = mesh line over shaft line, whole by law.

    ``ratio`` +- ``ratio_error`` is the measured one, ``order`` that of the first shaft,
    ``score`` the mean log prominence of its sidebands, ``lines`` how many of them stand out.
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


@dataclass(frozen=True, kw_only=True)
class Gearing:
    """What a record's lines tell: mesh line [cycles/sample], shafts (first = tooth number of the
    first shaft), further meshes, and the evidence in words."""

    mesh_frequency: float
    mesh_frequency_error: float
    harmonics: tuple[float, ...]
    shafts: tuple[Shaft, ...]
    meshes: tuple[Mesh, ...]
    evidence: tuple[str, ...]

    @property
    def teeth(self) -> int | None:
        """Teeth on the first shaft, None when no shaft shows."""
        return self.shafts[0].teeth if self.shafts else None

    @property
    def shaft_frequency(self) -> float | None:
        """First shaft [turns/sample], None when no shaft shows."""
        return self.mesh_frequency / self.shafts[0].teeth if self.shafts else None


@dataclass(frozen=True)
class _Prominence:
    """Mean over channels of log(amplitude/floor), its median taken away, per bin."""

    level: Floats
    amplitude: Floats  # geometric mean over channels, for the interpolation of peaks
    per_unit: float  # bins per unit of frequency (or order)
    spread: float

    def at(self, place: Floats | float) -> Floats:
        """The higher of the two bins beside each place (0 outside)."""
        bins = np.asarray(place, dtype=float) * self.per_unit
        low = np.floor(bins).astype(int)
        inside = (low >= 1) & (low + 1 < self.level.size)
        low = np.where(inside, low, 1)
        return np.where(inside, np.maximum(self.level[low], self.level[low + 1]), 0.0)

    def peak(self, place: float, reach: int = 2) -> tuple[float, float]:
        """Interpolated position of the highest bin within ``reach`` bins, and its level."""
        centre = int(np.rint(place * self.per_unit))
        low, high = max(1, centre - reach), min(self.level.size - 1, centre + reach + 1)
        if low >= high:
            return place, 0.0
        top = low + int(np.argmax(self.level[low:high]))
        if top + 1 >= self.level.size:
            return place, 0.0
        shift = hann_offset(self.amplitude[top - 1 : top + 2])
        return (top + shift) / self.per_unit, float(self.level[top])


def _prominence(channels: Floats, rate: float) -> _Prominence:
    spectrum = amplitude_spectrum(channels - channels.mean(axis=-1, keepdims=True), rate, "hann")
    amplitudes = np.maximum(spectrum.amplitudes, 1e-300)
    logs = np.log(amplitudes)
    level = np.mean(logs - _running_median(logs), axis=0)
    level = level - np.median(level)
    pairs = np.maximum(level[:-1], level[1:])
    spread = float(np.diff(np.percentile(pairs, [15.87, 50.0]))[0])
    level = level - float(np.median(pairs))
    return _Prominence(
        level, np.exp(logs.mean(axis=0)), 1.0 / spectrum.bin_width, max(spread, 1e-12)
    )


def _running_median(logs: Floats, width: int = 301) -> Floats:
    """Median over about ``width`` bins, on a grid of half widths, straight between."""
    count = logs.shape[-1]
    width = min(width, max(9, count // 8))
    starts = np.arange(0, max(1, count - width + 1), max(1, width // 2))
    middles = starts + 0.5 * (width - 1)
    medians = np.stack([np.median(logs[:, s : s + width], axis=-1) for s in starts], axis=-1)
    grid = np.arange(count)
    return np.stack([np.interp(grid, middles, row) for row in medians])


def find_gearing(channels: Sequence[Floats], near: float | None = None) -> Gearing:
    """Mesh line, shafts, tooth numbers and further meshes of one record.

    1. Mesh line: the peak whose harmonics 1..5 stand out most, in the mean of the logarithms of
       amplitude over floor, over all channels (``near`` [cycles/sample] restricts it to +-3 %).
    2. The phase of that line is the angle: the record is resampled in mesh cycles, which makes
       every line of the gear train sharp, whatever the speed does.
    3. A shaft with z teeth puts sidebands at h +- n/z around the mesh harmonics h. z is the
       whole number whose sidebands n = 1..3 stand out most; a second shaft is sought among the
       z that do not divide it, by n = 1.
    4. A further mesh turns on the second and on a slower shaft: its order is a whole multiple of
       both, with 17 teeth or more (fewer are undercut as standard gears).

    ``channels``: one array each, equal lengths. Raises InputError when no mesh line stands out.
    """
    table = np.stack([np.asarray(c, dtype=float)[:LONGEST] for c in channels])
    if not np.all(np.isfinite(table)):
        raise InputError("record", "gaps", allowed="finite samples", fix="cut the gap out")
    table = table[np.std(table, axis=-1) > 0]
    if table.size == 0 or table.shape[-1] < 256:
        raise InputError("record", f"{table.shape[-1]} samples", allowed=">= 256, not constant")
    families = _families(_prominence(table, 1.0), near)
    if len(families) > 1:
        # which family is the mesh's is decided on a part: two channels, fewer samples
        loudest = np.argsort(-np.max(np.abs(table), axis=-1))[:2]
        part = table[loudest, :_SCREEN]
        best, chosen = -np.inf, families[0]
        for family in families:
            if family.score + _MOST_FROM_SIDEBANDS < best:
                break
            score = _of_family(part, family)[0]
            if score > best:
                best, chosen = score, family
        families = [chosen]
    return _of_family(table, families[0])[1]


def mesh_angle(channels: Sequence[Floats], mesh: float) -> tuple[Floats, int, float] | None:
    """Mesh cycles at each sample from the line's phase, samples dropped at each end, and how far
    [cycles, standard deviation] the phase wanders from a steady speed. None: it cannot be told.
    """
    found = _angle(np.stack([np.asarray(c, dtype=float) for c in channels]), mesh)
    if found is None:
        return None
    cycles, dropped = found[:2]
    place = np.arange(cycles.size)
    steady = np.polyval(np.polyfit(place, cycles, 1), place)
    return cycles, dropped, float(np.std(cycles - steady))


@dataclass(frozen=True)
class _Family:
    """A line and its harmonics: ``heights`` their log prominences, ``score`` the mean."""

    line: float
    mesh: float
    heights: tuple[float, ...]
    score: float


def _of_family(table: Floats, family: _Family) -> tuple[float, Gearing]:
    """The gearing if this family is the mesh's, and how much stands for it.

    A shaft's own harmonics make a family too, often the stronger one; but no sidebands at whole
    parts of it stand around them. So the sidebands' score counts like the family's.
    """
    mesh = family.mesh
    text = ", ".join(f"{np.exp(h):.1f}" for h in family.heights)
    heights = tuple(float(np.exp(h)) for h in family.heights)
    evidence = [
        f"mesh line near {family.line:.6f} cycles/sample: harmonics 1..{len(heights)} stand "
        f"{text} times over the floor (mean of channels)"
    ]
    angle_of = _angle(table, mesh)
    if angle_of is None:
        error = 0.5 / table.shape[-1]
        return family.score, Gearing(
            mesh_frequency=mesh,
            mesh_frequency_error=error,
            harmonics=heights,
            shafts=(),
            meshes=(),
            evidence=tuple(evidence),
        )
    cycles, dropped, mesh, error = angle_of
    kept = table[:, dropped : dropped + cycles.size]
    top = max(1, min(_HARMONICS, int(0.45 / mesh)))
    per_cycle = int(2 ** np.ceil(np.log2(1.0 / mesh)))
    sharp = _prominence(
        resample_by_angle(kept, cycles, samples_per_turn=per_cycle), float(per_cycle)
    )
    shafts = _shafts(sharp, top, evidence)
    meshes: tuple[Mesh, ...] = ()
    if not shafts:
        evidence.append(
            "no sidebands at whole parts of it: it may be a shaft's own line and no mesh line"
        )
    if len(shafts) > 1:
        meshes = _second_mesh(sharp, shafts, top, evidence)
    score = family.score
    if shafts:  # sidebands of one harmonic alone prove less
        score += (shafts[0].score + _LAW_KEPT) * min(1.0, top / 3.0)
    return score, Gearing(
        mesh_frequency=mesh,
        mesh_frequency_error=error,
        harmonics=heights,
        shafts=shafts,
        meshes=meshes,
        evidence=tuple(evidence),
    )


def _families(raw: _Prominence, near: float | None) -> list[_Family]:
    """The strongest families of harmonics, best first; a mesh line near ``near`` if given."""
    level, per = raw.level, raw.per_unit
    low, high = (5.0 / per, 0.45) if near is None else (0.97 * near, 1.03 * near)
    first, last = max(2, int(low * per)), min(level.size - 2, int(np.ceil(high * per)))
    inside = np.arange(first, last + 1)
    if inside.size == 0:
        raise InputError("mesh line", near, allowed="inside 0..0.45 cycles/sample")
    peaks = inside[
        (level[inside] >= level[inside - 1])
        & (level[inside] > level[inside + 1])
        & (level[inside] > max(4.0 * raw.spread, np.log(3.0)))
    ]
    if peaks.size == 0:
        raise InputError("mesh line", "none", why="no line stands out of the floor")
    found = [_family(raw, peak / per) for peak in peaks[np.argsort(-level[peaks])][:400]]
    found.sort(key=lambda family: -family.score)
    kept: list[_Family] = []
    for family in found:
        if all(abs(family.line / other.line - 1.0) > 0.003 for other in kept):
            kept.append(family)
        if len(kept) == _CANDIDATES:
            break
    return kept


def _family(raw: _Prominence, near: float) -> _Family:
    start, _ = raw.peak(near, 0)
    found: list[tuple[float, float]] = []
    fundamental = start
    for rank in range(1, _HARMONICS + 1):
        if rank * start > 0.49:
            break
        # speed wander spreads a harmonic in proportion to its rank
        place, height = raw.peak(rank * fundamental, 1 + rank)
        found.append((place / rank, min(height, 5.0)))
        if height > 1.5 and rank > 1:
            fundamental = float(np.mean([f for f, _ in found]))
    strong = [(f, (rank + 1) * h) for rank, (f, h) in enumerate(found) if h > 1.0]
    mesh = float(np.average([f for f, _ in strong], weights=[w for _, w in strong]))
    heights = tuple(h for _, h in found)
    # a shaft's harmonics stand high where the floor is low, but the mesh moves the metal: the
    # family's share of the record's energy counts beside its height over the floor
    bins = np.rint(np.array([f * (rank + 1) for rank, (f, _) in enumerate(found)]) * raw.per_unit)
    inside = raw.amplitude[np.minimum(bins.astype(int), raw.amplitude.size - 1)]
    share = float(np.sum(inside**2) / np.sum(raw.amplitude**2))
    # few harmonics below half the rate: measured against at least three
    return _Family(
        start,
        mesh if abs(mesh / start - 1.0) < 1e-3 else start,
        heights,
        sum(heights) / max(3, len(heights)) + 0.5 * float(np.log(max(share, 1e-12))),
    )


def _angle(table: Floats, mesh: float) -> tuple[Floats, int, float, float] | None:
    """Cycles of the mesh line at each sample, samples dropped, mean mesh line and its error."""
    half = max(_NARROW * mesh, 12.0 / table.shape[-1])
    if half > 0.2 * mesh:
        return None
    heights = [
        float(amplitude_spectrum(c - c.mean(), 1.0, "hann").amplitudes[_near(c.size, mesh)].max())
        / float(np.std(c))
        for c in table
    ]
    best = table[int(np.argmax(heights))]
    cycles, dropped = line_angle(best, frequency=mesh, half_width=half)
    place = np.arange(cycles.size)
    slope, offset = np.polyfit(place, cycles, 1)
    wander = float(np.std(cycles - slope * place - offset))
    if np.any(np.diff(cycles) <= 0):
        return None
    return cycles, dropped, float(slope), max(wander, 0.01) / cycles.size * float(np.sqrt(12.0))


def _near(count: int, frequency: float) -> slice:
    centre = int(np.rint(frequency * count))
    return slice(max(1, centre - 2), centre + 3)


def _shafts(sharp: _Prominence, top: int, evidence: list[str]) -> tuple[Shaft, ...]:
    """The two gears whose sidebands stand out most, the faster shaft (fewer teeth) first."""
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
    sharp: _Prominence, harmonics: NDArray[np.int64], teeth: int, score: float, highest: int
) -> int:
    """The multiple of ``teeth`` whose sidebands between stand nearly as high, else ``teeth``.

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


def _inner(sharp: _Prominence, harmonics: NDArray[np.int64], teeth: int) -> Shaft | None:
    """A faster shaft whose tooth number divides ``teeth``: with a whole ratio k its sidebands are
    every k-th of the slow shaft's, and stand far over those between."""
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
    sharp: _Prominence, harmonics: NDArray[np.int64], teeth: int, score: float
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
                place, height = sharp.peak(h + rank * spacing, 1)
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


def _second_mesh(
    sharp: _Prominence, shafts: tuple[Shaft, ...], top: int, evidence: list[str]
) -> tuple[Mesh, ...]:
    first, second = shafts[0].teeth, shafts[1].teeth
    # a slower shaft: the line that stands out most below the second shaft's
    low, high = int(np.ceil(6)), int(0.97 / second * sharp.per_unit)
    if high - low < 8:
        return ()
    top_bin = low + int(np.argmax(sharp.level[low:high]))
    place, height = sharp.peak(top_bin / sharp.per_unit, 1)
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
