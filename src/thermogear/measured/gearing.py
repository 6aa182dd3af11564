"""The mesh line found among the lines of a record, and the lines at equal distances beside it.

Everything here is in cycles per sample and in orders: no rate is needed and none is invented. Lines
alone name no teeth: those that a user gives are confirmed by their sidebands, or stay undecided.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import ceil

import numpy as np
from scipy import special

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.measured.prominence import Prominence, prominence
from thermogear.signals.following import follow_line
from thermogear.signals.lines import line_spectrum
from thermogear.signals.orders import resample_by_angle, samples_per_cycle

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
_AROUND = 3  # harmonics about which sidebands are looked for
_ANYWHERE, _TRIED = (
    (1.0 / 250.0, 1.0 / 12.0),
    200,
)  # distances [mesh lines] of sidebands of any gear
_CHANCE = 1e-3  # of lines at any distance to be where sidebands are looked for
_FAMILIES, _RANKS = 4, 6  # distances that are told, and ranks of a line in one of them
_APART = 3.0  # bins between a harmonic and a line beside it
_AT = 0.6  # bins between a line and its place
NEAR = 0.1
"""A stated speed is nominal: motors slip by less."""
_CLOSE = 0.03  # of a line's place: most motors slip by less
_THERE = float(np.log(4.0))  # over the floor: of 300 bins of noise one is as high in 200 records
_EXACT = 0.25  # bins
_OVER, _FEWER_OVER = (
    0.3,
    0.7,
)  # ln: of three mesh harmonics, of fewer, over the lines beside; chosen
_TRIED_LINES = 8
_WRONG = (2.0, 0.5, 1.25, 0.8, 10.0, 0.1, 2.56, 1.0 / 2.56)  # times a rate that is stated wrong
_WHOLE = 0.02  # of a turn
_STEADY = 0.02  # cycles: a thirtieth of its height beside the third harmonic


@dataclass(frozen=True, kw_only=True)
class Family:
    """Lines at one ``distance`` [cycles/sample] to both sides of the mesh line or of a harmonic;
    ``lines``: how many of them stand out, about the first three harmonics."""

    distance: float
    lines: int


@dataclass(frozen=True, kw_only=True)
class Gearing:
    """What a record's lines tell: the mesh line, or the clearest one, [cycles/sample], how many
    times its ``harmonics`` stand over the floor, ``families`` beside it, the ``evidence`` in words.

    ``teeth`` of the gear on the first shaft whose mesh line it is, None where that is undecided: it
    has their sidebands (``confirmed``, of those given), or teeth and speed given, or a tacho, put
    the mesh line there, or no other number fits a known speed. ``turning``: the line of
    a shaft of known speed [turns/sample], where there is one, ``turning_half_width`` a bin
    [turns/sample] where the mesh line is none of its multiples, else 0. ``rank_of``: 2 or 3 where
    the line is that harmonic of another as clear, which no shaft's is (a gear has more than three
    teeth), else 0; ``off``: how many times the speed given would fit, else 1; ``rival``: the teeth
    that a known speed names alone, where others are given.
    """

    mesh_frequency: float
    harmonics: tuple[float, ...]
    evidence: tuple[str, ...] = ()
    families: tuple[Family, ...] = ()
    teeth: int | None = None
    confirmed: bool = False
    turning: float | None = None
    rank_of: int = 0
    off: float = 1.0
    rival: int | None = None
    turning_half_width: float = 0.0

    @property
    def shaft(self) -> float | None:
        """The first shaft's [turns/sample]; None: not known."""
        return self.turning if self.teeth is None else self.mesh_frequency / self.teeth

    def at(self, mesh: float) -> Gearing:
        """The same with the mesh line, known better, at ``mesh`` [cycles/sample]: a shaft of which
        it is a multiple turns with it."""
        turning = self.turning
        if turning is not None and not self.turning_half_width:
            turning *= mesh / self.mesh_frequency
        return replace(self, mesh_frequency=mesh, turning=turning)

    def kind(self, rank: int) -> tuple[str, str]:
        """Kind and name of the line's harmonic ``rank``: "mesh", "shaft" or "line".

        >>> found = Gearing(mesh_frequency=0.02, harmonics=(9.0,), turning=0.01)
        >>> found.kind(1), replace(found, teeth=25).kind(1)
        (('shaft', 'shaft x 2'), ('mesh', 'mesh x 1'))
        """
        if self.teeth is not None:
            return "mesh", f"mesh x {rank}"
        order = (
            0 if self.turning_half_width else shaft_order(self.mesh_frequency, shaft=self.turning)
        )
        return ("shaft", f"shaft x {rank * order}") if order else ("line", f"line x {rank}")


def shaft_order(place: float, *, shaft: float | None, width: float = 0.0) -> int:
    """The multiple of a ``shaft`` [turns/sample] that a line at ``place`` [cycles/sample] is,
    within 2 % of a turn or, where that is less, ``width`` of the place; 0: none.

    >>> shaft_order(0.0305, shaft=0.01), shaft_order(0.03, shaft=0.01)
    (0, 3)
    """
    order = 0.0 if shaft is None else place / shaft
    within = min(_WHOLE, width / shaft if shaft and width else _WHOLE)
    return round(order) if abs(order - round(order)) < within else 0


def find_gearing(
    channels: Sequence[Floats],
    near: float | None = None,
    *,
    teeth: int | None = None,
    shaft: float | None = None,
    told_as: float = 1.0,
) -> Gearing:
    """Mesh line of one record, and the lines at equal distances beside it.

    1. Where ``near`` [cycles/sample] is given: of the lines within 10 % that which has the
       sidebands of the ``teeth`` given, else the clearest within 3 %.
    2. Else, or where none is there, the line with the clearest harmonics 1..5; of lines nearly as
       clear the first that has the sidebands of the ``teeth`` given, or the only one that is a
       whole multiple of a ``shaft`` of known speed [turns/sample, within 3 %] with its sidebands.
    3. The phase of that line is the angle: the record is resampled in mesh cycles, in which lines
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
    search = _Search(table, prominence(table, 1.0), teeth)
    gearing = search.near(near) if near is not None else None
    if gearing is None:
        gearing = search.free(shaft)
    return replace(gearing, evidence=_words(gearing, told_as))


def _words(gearing: Gearing, told_as: float) -> tuple[str, ...]:
    """The evidence, places times ``told_as``."""
    heights = ", ".join(f"{height:.1f}" for height in gearing.harmonics)
    kind = "line" if gearing.teeth is None else "mesh line"
    words = [
        f"{kind} near {gearing.mesh_frequency * told_as:.6f} cycles/sample: harmonics "
        f"1..{len(gearing.harmonics)} stand {heights} times over the floor (mean of channels)"
    ]
    words += [
        f"{family.lines} lines stand {family.distance * told_as:.6f} cycles/sample to both sides "
        "of it and of its harmonics"
        for family in gearing.families
    ]
    if gearing.teeth is None:
        words.append("no tooth number is decided: it may be a shaft's own line and no mesh line")
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


@dataclass(frozen=True)
class _Search:
    """Lines of a ``table`` (channel, sample) by how far they stand over the floor (``raw``)."""

    table: Floats
    raw: Prominence
    teeth: int | None
    _known: dict[float, tuple[Gearing, Prominence, list[int]]] = field(default_factory=dict)

    @cached_property
    def lines(self) -> list[_Line]:
        """Lines that stand out with their harmonics, the clearest first."""
        peaks = _peaks(self.raw, low=5.0 / self.raw.per_unit, high=0.45)
        lines = [_line(self.raw, peak / self.raw.per_unit) for peak in peaks]
        return sorted(lines, key=lambda line: -line.score)

    @cached_property
    def heights(self) -> Floats:
        """Amplitudes over the standard deviation (channel, bin)."""
        return np.stack([line_spectrum(c, 1.0).hann / float(np.std(c)) for c in self.table])

    def near(self, place: float) -> Gearing | None:
        """The line that facts put at ``place`` [cycles/sample]; None: no line is there."""
        peaks = _peaks(self.raw, low=(1.0 - NEAR) * place, high=(1.0 + NEAR) * place)
        lines = [_line(self.raw, peak / self.raw.per_unit) for peak in peaks]
        lines.sort(key=lambda line: -line.score)
        close = [line for line in lines if abs(line.line / place - 1.0) <= _CLOSE]
        close = [line for line in close if line.heights[0] > _THERE][:1]
        tried = lines[:_RIVALS] if self.teeth else []
        found = next((line for line in tried if self.of(line)[0].confirmed), None)
        found = found or next(iter(close), None)
        if found is None:
            return None
        gearing, *_ = self.of(found)
        gearing = replace(gearing, rank_of=self._rank(gearing))
        return gearing if self.teeth is None else self._held(gearing, found, place / self.teeth)

    def _held(self, gearing: Gearing, line: _Line, shaft: float) -> Gearing:
        """The ``line`` that teeth and speed given put there, held against all other lines.

        It is undecided where the speed alone names other teeth, where it is a harmonic, and where
        it is no clearest line without the sidebands of the teeth, or lower than those about it.
        """
        named = self.named(shaft)
        own = [one for one in named if one.teeth == self.teeth]
        if own or not (named or gearing.rank_of or not self._is_middle(line, shaft)):
            return replace((own or [gearing])[0], teeth=self.teeth)
        gearing = replace((named or [gearing])[0], teeth=None, confirmed=False)
        if named:
            return replace(gearing, rival=named[0].teeth)
        off, other = self.misread(shaft)
        return (
            gearing
            if other is None or other.teeth != self.teeth
            else replace(other, teeth=None, confirmed=False, off=off)
        )

    def _is_middle(self, line: _Line, shaft: float) -> bool:
        """Whether a line has the sidebands of the teeth given and is higher than these; or else is
        the clearest, or has none, and no other number of teeth is nearer at the speed given."""
        gearing, sharp, ranks = self.of(line)
        if not gearing.confirmed or self.teeth is None:
            clear = line == self.lines[0] or not gearing.families
            return clear and round(gearing.mesh_frequency / shaft) == self.teeth
        over = [
            sharp.at(rank) - max(height for _, height in _beside(sharp, rank, self.teeth))
            for rank in ranks
        ]
        return float(np.mean(over)) > 0.0

    def misread(self, shaft: float) -> tuple[float, Gearing | None]:
        """How many times as fast a ``shaft`` must be that its gear is named, as where a rate is
        wrong, and the gearing; 1 and None where none is, or several are."""
        for off in _WRONG:
            named = self.named(off * shaft)
            if len(named) == 1:
                return off, named[0]
        return 1.0, None

    def _rank(self, gearing: Gearing) -> int:
        """2 or 3 where the line is that harmonic of the clearest one, which is as high, else 0."""
        ratio = gearing.mesh_frequency / self.lines[0].mesh
        whole = 2 <= round(ratio) <= _LOW_RANK and abs(ratio / round(ratio) - 1.0) < 1e-3
        high = np.exp(self.lines[0].heights[0]) >= gearing.harmonics[0]
        return round(ratio) if whole and high else 0

    def free(self, shaft: float | None) -> Gearing:
        """The clearest line, or another where facts decide."""
        if not self.lines:
            raise InputError("mesh line", "none", why="no line stands out of the floor")
        clearest = self.lines[0]
        gearing, *_ = self.of(clearest)
        if self.teeth is not None and not gearing.confirmed:
            for line in self.rivals(clearest):
                other, sharp, ranks = self.of(line)
                # of several lines that are tried one may have some by chance
                if other.confirmed and all(_clear(sharp, ranks, 1.0 / self.teeth)):
                    return other
            return gearing
        if shaft is None or self.teeth is not None:
            return gearing
        named = self.named(shaft)
        if len(named) == 1:
            return named[0]
        off = 1.0 if named else self.misread(shaft)[0]
        turns, height = self.raw.peak(shaft, reach=int(_CLOSE * shaft * self.raw.per_unit))
        if off != 1.0 or height <= _THERE:
            return replace(gearing, off=off)
        # the order of a line is whole where the shaft's own line, known to a quarter of a bin, says
        width = _EXACT / self.raw.per_unit
        order = shaft_order(
            gearing.mesh_frequency, shaft=turns, width=width * gearing.mesh_frequency / turns
        )
        turning = gearing.mesh_frequency / order if order else turns
        return replace(gearing, turning=turning, turning_half_width=0.0 if order else 4.0 * width)

    def named(self, shaft: float) -> list[Gearing]:
        """The gearings with each line that is the mesh line of a whole number of teeth on a
        ``shaft`` [turns/sample, within 3 %]."""
        named: list[Gearing] = []
        tried: list[_Line] = []
        for line in self.lines[:_TRIED_LINES]:
            low, high = (line.mesh / shaft / (1.0 + sign * _CLOSE) for sign in (1, -1))
            if high < FEWEST or any(self._is_harmonic(line, other.mesh) for other in tried):
                continue
            gearing, sharp, ranks = self.of(line)
            cycles = self.table.shape[-1] * line.mesh
            numbers = range(max(FEWEST, ceil(low)), int(high) + 1)
            fitting = [z for z in numbers if _is_alone(sharp, ranks, z, cycles=cycles)]
            named += [replace(gearing, teeth=z) for z in fitting]
            tried.append(line)
        return named

    def rivals(self, clearest: _Line) -> list[_Line]:
        """Other lines with harmonics nearly as clear, none of its harmonics or another's."""
        rivals: list[_Line] = []
        for line in self.lines:
            clear = len(line.heights) > 1 and min(line.heights[:2]) > _STANDS
            if not clear or line.mean < _AS_CLEAR * clearest.mean:
                continue
            if not any(self._is_harmonic(line, other.mesh) for other in (clearest, *rivals)):
                rivals.append(line)
        return rivals[:_RIVALS]

    def _is_harmonic(self, line: _Line, mesh: float) -> bool:
        """Whether a line is another or its multiple; of one that wanders every peak is."""
        rank = round(line.mesh / mesh)
        off = abs(line.mesh - rank * mesh)
        return rank >= 1 and off < rank * max(_BINS / self.raw.per_unit, _NARROW * mesh)

    def of(self, line: _Line) -> tuple[Gearing, Prominence, list[int]]:
        """The gearing with this line as the mesh line, what shows in its angle, and which of
        its first harmonics do."""
        if line.mesh not in self._known:
            self._known[line.mesh] = self._of(line)
        return self._known[line.mesh]

    def _of(self, line: _Line) -> tuple[Gearing, Prominence, list[int]]:
        mesh = line.mesh
        sharp = replace(self.raw, per_unit=self.raw.per_unit * mesh)
        angle = _angle(self.table, self.heights, mesh)
        if angle is not None:
            cycles, mesh = angle
            sharp = replace(sharp, per_unit=self.raw.per_unit * mesh)
        if angle is not None and _wanders(cycles, mesh):
            per_cycle = samples_per_cycle(mesh)
            straight = resample_by_angle(self.table, cycles, samples_per_turn=per_cycle)
            sharp = prominence(straight, float(per_cycle))
        top = max(1, min(_AROUND, int(0.45 / mesh)))
        ranks = [rank for rank in range(1, top + 1) if sharp.at(rank) > _STANDS]
        confirmed = self.teeth is not None and _is_confirmed(sharp, ranks, 1.0 / self.teeth)
        gearing = Gearing(
            mesh_frequency=mesh,
            harmonics=tuple(float(np.exp(height)) for height in line.heights),
            families=tuple(
                Family(distance=distance * mesh, lines=lines)
                for distance, lines in _families(sharp, ranks)
            ),
            teeth=self.teeth if confirmed else None,
            confirmed=confirmed,
        )
        return gearing, sharp, ranks


def _is_alone(sharp: Prominence, ranks: Sequence[int], teeth: int, *, cycles: float) -> bool:
    """Whether a mesh line, 1 in its own angle of so many ``cycles``, has the sidebands of these
    ``teeth``, exactly there, and is the middle of them.

    A line of another origin is as near to a whole multiple of the shaft by a chance of 2 x 0.25
    bins; that is a tenth or less from 5 ``teeth`` turns on. Sidebands at half of the distance would
    be those of twice the teeth. Of the comb of a shaft every line has such neighbours: a mesh line
    is the highest of the seven about each of its harmonics, by a chance of 1/343 about three.
    """
    if cycles < 5.0 * teeth**2:
        return False
    if not _is_confirmed(sharp, ranks, 1.0 / teeth) or _is_confirmed(sharp, ranks, 0.5 / teeth):
        return False
    away, over = [], []
    for rank in ranks:
        beside = _beside(sharp, rank, teeth)
        below, above = beside[2], beside[3]
        if min(below[1], above[1]) > _STANDS:
            away.append(0.5 * (above[0] - below[0]))
        over.append(float(sharp.at(rank)) - max(height for _, height in beside))
    off = abs(float(np.mean(away)) - 1.0 / teeth) * sharp.per_unit if away else np.inf
    least = _OVER if len(ranks) == _AROUND else _FEWER_OVER
    return bool(off < _EXACT and min(over) > 0.0 and np.mean(over) > least)


def _beside(sharp: Prominence, rank: int, teeth: int) -> list[tuple[float, float]]:
    """Place and height of the three lines to each side of a mesh harmonic, in its own angle."""
    return [sharp.peak(rank + n / teeth, reach=1) for n in (-3, -2, -1, 1, 2, 3)]


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
        special.bdtrc(sum(sides) - 1, len(sides), max(float(share), 1.0 / _TRIED))
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


def _angle(table: Floats, heights: Floats, mesh: float) -> tuple[Floats, float] | None:
    """Cycles of the mesh line at each sample, and the mean mesh line, by the channel in which it is
    highest."""
    half = max(_NARROW * mesh, 12.0 / table.shape[-1])
    if half > 0.2 * mesh:
        return None
    centre = int(np.rint(mesh * table.shape[-1]))
    near = heights[:, max(1, centre - 2) : centre + 3]
    best = table[int(np.argmax(near.max(axis=-1)))]
    cycles = follow_line(best, 1.0, frequency=mesh, half_width=half, cut=False).cycles
    if np.any(np.diff(cycles) <= 0):
        return None
    grid = np.arange(cycles.size) - 0.5 * (cycles.size - 1)
    return cycles, float(grid @ cycles / (grid @ grid))


def _wanders(cycles: Floats, mesh: float) -> bool:
    """Whether a line's cycles leave an even turning by what three times as many would show."""
    off = cycles - mesh * np.arange(cycles.size)
    return bool(np.ptp(off) > _STEADY)


def sides_of(*, teeth: int | None, rank: int, mesh: float) -> tuple[float, ...]:
    """Where the sidebands of the ``teeth`` given stand about a mesh harmonic, ``mesh`` in any
    unit."""
    return tuple(mesh * (rank + sign * n / teeth) for n in (1, 2, 3) for sign in (-1, 1) if teeth)
