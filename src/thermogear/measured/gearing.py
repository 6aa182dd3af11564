"""The mesh line found among the lines of a record, and the lines at equal distances beside it.

Everything here is in cycles per sample and in orders: no rate is needed and none is invented. Lines
alone name no teeth: those that a user gives are confirmed by their sidebands, or stay undecided.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.measured.prominence import Prominence, prominence
from thermogear.signals.orders import line_angle, resample_by_angle, samples_per_cycle
from thermogear.signals.spectra import amplitude_spectrum

LONGEST = 1 << 19
"""Samples that the search looks at, from the start of the record."""

FEWEST = 12
"""Teeth: fewer are not made as power gears."""

_HARMONICS = 5
_STANDS = float(np.log(3.0))  # over the floor
_BINS = 1.5  # between a line and its harmonic's place over its rank
_NARROW = 0.006  # half width of the phase filter over the mesh line
_RIVALS = 3  # other lines with harmonics that are looked at
_AS_CLEAR = 0.6  # of the mean log prominence of the clearest line's harmonics
_LOW_RANK = 3  # a gear has more teeth: a line at a half or a third of another is no shaft's
_LOW_ORDER = 4  # of a shaft: unbalance, and what is off its axis
_AROUND = 3  # harmonics about which sidebands are looked for
_ANYWHERE, _TRIED = (
    (1.0 / 250.0, 1.0 / 12.0),
    200,
)  # distances [mesh lines] of sidebands of any gear
_CHANCE = 1e-3  # of lines at any distance to be where sidebands are looked for
_FAMILIES, _RANKS = 4, 6  # distances that are told, and ranks of a line in one of them
_APART = 3.0  # bins between a harmonic and a line beside it
_AT = 0.6  # bins between a line and its place


@dataclass(frozen=True, kw_only=True)
class Family:
    """Lines at one ``distance`` [cycles/sample] to both sides of the mesh line or of a harmonic;
    ``lines``: how many of them stand out, about the first three harmonics."""

    distance: float
    lines: int


@dataclass(frozen=True, kw_only=True)
class Gearing:
    """What a record's lines tell: mesh line [cycles/sample], how many times its ``harmonics`` stand
    over the floor, ``families`` beside it, the ``evidence`` in words; ``confirmed``: whether it has
    the sidebands of the teeth given; ``alone``: whether no other line has harmonics as clear."""

    mesh_frequency: float
    harmonics: tuple[float, ...]
    evidence: tuple[str, ...] = ()
    families: tuple[Family, ...] = ()
    confirmed: bool = False
    alone: bool = True

    @property
    def is_theirs(self) -> bool:
        """Whether the line is the mesh line of the teeth given: by their sidebands, or because no
        other may be."""
        return self.confirmed or self.alone


def find_gearing(
    channels: Sequence[Floats],
    near: float | None = None,
    *,
    teeth: int | None = None,
    told_as: float = 1.0,
) -> Gearing:
    """Mesh line of one record, and the lines at equal distances beside it.

    1. Mesh line: the peak with the clearest harmonics 1..5 (``near`` [cycles/sample] restricts it
       to +-3 %). Without ``near``, of lines nearly as clear the first that has the sidebands of the
       ``teeth`` given.
    2. The phase of that line is the angle: the record is resampled in mesh cycles, in which lines
       to both sides of a harmonic are told to a part of a bin.

    ``channels``: one array each, equal lengths; ``told_as``: of places in words, where these arrays
    are resampled: samples of theirs in one of the record. Raises InputError when no line is clear.
    """
    table = np.stack([np.asarray(c, dtype=float)[:LONGEST] for c in channels])
    if not np.all(np.isfinite(table)):
        raise InputError("record", "gaps", allowed="finite samples", fix="cut the gap out")
    table = table[np.std(table, axis=-1) > 0]
    if table.size == 0 or table.shape[-1] < 256:
        raise InputError("record", f"{table.shape[-1]} samples", allowed=">= 256, not constant")
    raw = prominence(table, 1.0)
    lines = _lines(raw, near)
    if not lines:
        raise InputError("mesh line", "none", why="no line stands out of the floor")
    clearest = max(lines, key=lambda line: line.score)
    rivals = _rivals(raw, clearest, lines if near is None else _lines(raw, None), teeth)
    gearing = _of_line(table, raw, clearest, teeth)
    if teeth is not None and near is None and not gearing.confirmed:
        others = (_of_line(table, raw, line, teeth) for line in rivals)
        gearing = next((other for other in others if other.confirmed), gearing)
    return replace(gearing, alone=not rivals, evidence=_words(gearing, told_as))


def is_rank_of(higher: Gearing, lower: Gearing) -> int:
    """2 or 3 where a line is that harmonic of another as clear, else 0. That is no shaft's: a gear
    has more than three teeth.

    >>> half, line = (Gearing(mesh_frequency=f, harmonics=(9.0,)) for f in (0.05, 0.1))
    >>> is_rank_of(line, half), is_rank_of(half, line)
    (2, 0)
    """
    ratio = higher.mesh_frequency / lower.mesh_frequency
    rank = round(ratio)
    whole = 2 <= rank <= _LOW_RANK and abs(ratio / rank - 1.0) < 1e-3
    return rank if whole and lower.harmonics[0] >= higher.harmonics[0] else 0


def _words(gearing: Gearing, told_as: float) -> tuple[str, ...]:
    """The evidence, places times ``told_as``."""
    heights = ", ".join(f"{height:.1f}" for height in gearing.harmonics)
    words = [
        f"mesh line near {gearing.mesh_frequency * told_as:.6f} cycles/sample: harmonics "
        f"1..{len(gearing.harmonics)} stand {heights} times over the floor (mean of channels)"
    ]
    words += [
        f"{family.lines} lines stand {family.distance * told_as:.6f} cycles/sample to both sides "
        "of it and of its harmonics"
        for family in gearing.families
    ]
    if not gearing.confirmed:
        words.append(
            "no tooth number is decided: it may be a shaft's own line and no mesh line ('mesh x n' "
            "is its n-th harmonic all the same)"
        )
    return tuple(words)


@dataclass(frozen=True)
class _Line:
    """A line and its harmonics: ``heights`` their log prominences, ``score`` how clear it is."""

    line: float
    mesh: float
    heights: tuple[float, ...]
    score: float

    @property
    def mean(self) -> float:
        """Mean log prominence, against three harmonics at least."""
        return sum(self.heights) / max(3, len(self.heights))


def _of_line(table: Floats, raw: Prominence, line: _Line, teeth: int | None) -> Gearing:
    """The gearing with this line as the mesh line."""
    mesh = line.mesh
    sharp = replace(raw, per_unit=raw.per_unit * mesh)
    angle = _angle(table, mesh)
    if angle is not None:
        cycles, dropped, mesh = angle
        per_cycle = samples_per_cycle(mesh)
        kept = table[:, dropped : dropped + cycles.size]
        straight = resample_by_angle(kept, cycles, samples_per_turn=per_cycle)
        sharp = prominence(straight, float(per_cycle))
    top = max(1, min(_AROUND, int(0.45 / mesh)))
    ranks = [rank for rank in range(1, top + 1) if sharp.at(rank) > _STANDS]
    return Gearing(
        mesh_frequency=mesh,
        harmonics=tuple(float(np.exp(height)) for height in line.heights),
        families=tuple(
            Family(distance=distance * mesh, lines=lines)
            for distance, lines in _families(sharp, ranks)
        ),
        confirmed=teeth is not None and _is_confirmed(sharp, ranks, 1.0 / teeth),
    )


def _clear(sharp: Prominence, ranks: Sequence[int], distance: float) -> list[bool]:
    """Whether lines stand out at the ``distance`` [mesh lines] below and above each harmonic."""
    if distance * sharp.per_unit < _APART:
        return []
    places = [rank + sign * distance for rank in ranks for sign in (-1, 1)]
    peaks = [sharp.peak(place, reach=1) for place in places]
    return [
        height > _STANDS and abs(at - place) * sharp.per_unit < _AT
        for place, (at, height) in zip(places, peaks, strict=True)
    ]


def _is_confirmed(sharp: Prominence, ranks: Sequence[int], distance: float) -> bool:
    """Whether first sidebands at the ``distance`` [mesh lines] show where lines at any distance
    would hardly show by chance: about the harmonic that is clearest, or about all."""
    top = max(ranks, key=sharp.at, default=1)
    anywhere = np.linspace(*_ANYWHERE, _TRIED)
    share = np.mean([clear for away in anywhere for clear in _clear(sharp, [top], away)] or [True])
    chances = [
        stats.binom.sf(sum(sides) - 1, len(sides), max(float(share), 1.0 / _TRIED))
        for about in ([top], ranks)
        if (sides := _clear(sharp, about, distance))
    ]
    return bool(min(chances, default=1.0) < _CHANCE)


def _families(sharp: Prominence, ranks: Sequence[int]) -> list[tuple[float, int]]:
    """Distances [mesh lines] at which lines stand to both sides of a harmonic, the highest first,
    and how many of them stand there."""
    families: list[tuple[float, int]] = []
    for peak in _peaks(sharp, low=0.5, high=max(ranks, default=0) + 0.5):
        at, _ = sharp.peak(peak / sharp.per_unit, reach=0)
        distance = abs(at - round(at))
        parts = [max(1, round(distance / other)) for other, _ in families]
        if any(
            abs(distance - part * other) * sharp.per_unit < _BINS and part <= _RANKS
            for part, (other, _) in zip(parts, families, strict=True)
        ):
            continue
        clear = _clear(sharp, ranks, distance)
        if any(below and above for below, above in zip(clear[::2], clear[1::2], strict=True)):
            families.append((distance, sum(clear)))
        if len(families) == _FAMILIES:
            break
    return families


def _peaks(shown: Prominence, *, low: float, high: float) -> list[int]:
    """Bins of lines that stand out between two places, the highest first, 400 at most."""
    level, per = shown.level, shown.per_unit
    first, last = max(2, int(low * per)), min(level.size - 2, int(np.ceil(high * per)))
    inside = np.arange(first, last + 1)
    peaks = inside[
        (level[inside] >= level[inside - 1])
        & (level[inside] > level[inside + 1])
        & (level[inside] > max(4.0 * shown.spread, _STANDS))
    ]
    return [int(peak) for peak in peaks[np.argsort(-level[peaks])][:400]]


def _rivals(
    raw: Prominence, clearest: _Line, lines: Sequence[_Line], teeth: int | None
) -> list[_Line]:
    """Other lines with harmonics nearly as clear, the clearest first: none of its harmonics, and no
    low order of a shaft that its teeth make, of the ``teeth`` given or of any that a gear has."""
    rivals: list[_Line] = []
    shafts = [clearest.mesh / teeth] if teeth else []
    least = _AS_CLEAR * clearest.mean

    def of(line: _Line, step: float, most: float = np.inf) -> bool:
        rank = round(line.line / step)
        return 1 <= rank <= most and abs(line.line - rank * step) * raw.per_unit < rank * _BINS

    for line in sorted(lines, key=lambda other: -other.score):
        if len(line.heights) < 2 or min(line.heights[:2]) < _STANDS or line.mean < least:
            continue
        if any(of(line, other.mesh) for other in (clearest, *rivals)):
            continue
        part = round(clearest.mesh / line.line)
        whole = abs(clearest.mesh - part * line.line) * raw.per_unit < part * _BINS
        if whole and part >= FEWEST:
            shafts.append(line.line)
        if not any(of(line, step, _LOW_ORDER) for step in shafts):
            rivals.append(line)
        if len(rivals) == _RIVALS:
            break
    return rivals


def _lines(raw: Prominence, near: float | None) -> list[_Line]:
    """Lines that stand out of the floor with their harmonics; near ``near`` if given."""
    low, high = (5.0 / raw.per_unit, 0.45) if near is None else (0.97 * near, 1.03 * near)
    return [_line(raw, peak / raw.per_unit) for peak in _peaks(raw, low=low, high=high)]


def _line(raw: Prominence, near: float) -> _Line:
    start, _ = raw.peak(near, reach=0)
    found: list[tuple[float, float]] = []
    fundamental = start
    for rank in range(1, _HARMONICS + 1):
        if rank * start > 0.49:
            break
        # speed wander spreads a harmonic in proportion to its rank
        place, height = raw.peak(rank * fundamental, reach=1 + rank)
        found.append((place / rank, min(height, 5.0)))
        if height > 1.5 and rank > 1:
            fundamental = float(np.mean([f for f, _ in found]))
    strong = [(f, (rank + 1) * h) for rank, (f, h) in enumerate(found) if h > 1.0]
    mesh = start  # where noise hides it and all its harmonics
    if strong:
        mesh = float(np.average([f for f, _ in strong], weights=[w for _, w in strong]))
    heights = tuple(h for _, h in found)
    # a shaft's harmonics stand high where the floor is low, but the mesh moves the metal: the
    # family's share of the record's energy counts beside its height over the floor
    bins = np.rint(np.array([f * (rank + 1) for rank, (f, _) in enumerate(found)]) * raw.per_unit)
    inside = raw.amplitude[np.minimum(bins.astype(int), raw.amplitude.size - 1)]
    share = float(np.sum(inside**2) / np.sum(raw.amplitude**2))
    # few harmonics below half the rate: measured against at least three
    return _Line(
        start,
        mesh if abs(mesh / start - 1.0) < 1e-3 else start,
        heights,
        sum(heights) / max(3, len(heights)) + 0.5 * float(np.log(max(share, 1e-12))),
    )


def _angle(table: Floats, mesh: float) -> tuple[Floats, int, float] | None:
    """Cycles of the mesh line at each sample, samples dropped and the mean mesh line."""
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
    if np.any(np.diff(cycles) <= 0):
        return None
    return cycles, dropped, float(np.polyfit(np.arange(cycles.size), cycles, 1)[0])


def _near(count: int, frequency: float) -> slice:
    centre = int(np.rint(frequency * count))
    return slice(max(1, centre - 2), centre + 3)


def sides_of(*, teeth: int | None, rank: int, mesh: float) -> tuple[float, ...]:
    """Where the sidebands of the ``teeth`` given stand about a mesh harmonic, ``mesh`` in any
    unit."""
    return tuple(mesh * (rank + sign * n / teeth) for n in (1, 2, 3) for sign in (-1, 1) if teeth)
