"""The gearing found from the lines of a record, with the evidence: which line is the mesh's.

Everything here is in cycles per sample and in orders: no rate is needed and none is invented.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.measured.evidence import Evidence, weigh
from thermogear.measured.meshes import Stated
from thermogear.measured.prominence import Prominence, prominence
from thermogear.measured.record import Notice
from thermogear.measured.straight import sharp_peaks
from thermogear.signals.orders import line_angle, resample_by_angle, samples_per_cycle
from thermogear.signals.spectra import amplitude_spectrum

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


LONGEST = 1 << 19
"""Samples that the search looks at, from the start of the record."""

_HARMONICS = 5
_SAME = 1e-3  # a mesh line's position from two ways of reading it
_STANDS = float(np.log(3.0))  # over the floor
_BINS = 1.5  # between a line and its harmonic's place over its rank
_LIKELY = 0.5  # weight from which a mesh line is taken for the one to read lines at
_NARROW = 0.006  # half width of the phase filter over the mesh line
_FEW = 4.0  # turns over the record, below which nothing tells a gear from what is slower
_SLOWEST = 32.0  # turns of a gear over the record: four of a mate eight times as large

SLOW = 12.0
"""Turns of a gear over the record: four of a mate three times as large."""


@dataclass(frozen=True, kw_only=True)
class Gearing:
    """What a record's lines tell: mesh line [cycles/sample], the shafts of gears whose teeth are
    decided (the fastest first), further meshes, the hypotheses and the evidence in words."""

    mesh_frequency: float
    harmonics: tuple[float, ...]
    shafts: tuple[Shaft, ...]
    meshes: tuple[Mesh, ...]
    evidence: tuple[str, ...]
    weighed: Evidence

    @property
    def teeth(self) -> int | None:
        """Teeth on the first shaft, None when no shaft shows."""
        return self.shafts[0].teeth if self.shafts else None


def find_gearing(
    channels: Sequence[Floats],
    near: float | None = None,
    stated: Stated | None = None,
    *,
    told_as: float = 1.0,
    followed: float = 0.0,
) -> Gearing:
    """Mesh line, shafts, tooth numbers and further meshes of one record.

    1. Hypotheses on teeth, on impacts without teeth and on nothing at all are weighed
       (:func:`~thermogear.measured.evidence.weigh`). Teeth are named where nearly all the weight
       has them; else the record leaves them undecided and the alternatives are told.
    2. Mesh line: that of the hypotheses; where they agree on none, or on one that is not seen while
       teeth are undecided or is a harmonic of a line as high, the peak with the clearest harmonics
       1..5 (``near`` [cycles/sample] restricts it to +-3 %).
    3. The phase of that line is the angle: the record is resampled in mesh cycles, where the
       decided shafts' sidebands measure mesh line over shaft line.
    4. A further mesh turns on the second and on a slower shaft: its order is a whole multiple of
       both, with 17 teeth or more (fewer are undercut as standard gears).

    ``channels``: one array each, equal lengths; ``stated``: teeth and shaft's turns per sample as a
    user says, evidence like the lines; ``followed``: where the record is in the angle of the line
    ``near``, the half width of the filter that followed it, over its frequency: what is nearer to
    the line and its harmonics says nothing of teeth; ``told_as``: of places in words and weights,
    where these arrays are resampled: samples of theirs in one of the record. Raises InputError when
    no line is clear.
    """
    table = np.stack([np.asarray(c, dtype=float)[:LONGEST] for c in channels])
    if not np.all(np.isfinite(table)):
        raise InputError("record", "gaps", allowed="finite samples", fix="cut the gap out")
    table = table[np.std(table, axis=-1) > 0]
    if table.size == 0 or table.shape[-1] < 256:
        raise InputError("record", f"{table.shape[-1]} samples", allowed=">= 256, not constant")
    raw = prominence(table, 1.0)
    family = _clearest_family(raw, near)
    peaks = sharp_peaks(table)
    if near is not None and followed > 0.0:
        peaks = peaks.without_skirts(near, followed)
    weighed = weigh(peaks, stated)
    rank = near / weighed.mesh if near is not None and weighed.mesh else 1.0
    # a line that was followed may be a harmonic
    ranks = range(1, _HARMONICS + 1) if followed > 0.0 else (1,)
    if weighed.mesh_weight >= _LIKELY and any(abs(rank - one) < 0.03 for one in ranks):
        likely = replace(_family(raw, weighed.mesh), mesh=weighed.mesh)
        # harmonics alone make no mesh line while teeth are undecided: it must be seen itself
        seen = likely.heights[0] > _STANDS and not _is_rank_of(raw, family, likely)
        if weighed.teeth or seen:
            family = likely
    return _of_family(table, family, weighed, told_as)


@dataclass(frozen=True)
class _Family:
    """A line and its harmonics: ``heights`` their log prominences, ``score`` the mean."""

    line: float
    mesh: float
    heights: tuple[float, ...]
    score: float


def _is_rank_of(raw: Prominence, family: _Family, likely: _Family) -> bool:
    """Whether a line is the second or third harmonic of a family that is as high at least. That
    is no shaft's: a gear has more than three teeth."""
    rank = round(likely.line / family.line)
    heights = [float(raw.amplitude[round(one.line * raw.per_unit)]) for one in (family, likely)]
    same = abs(likely.line - rank * family.line) * raw.per_unit < rank * _BINS
    return rank in (2, 3) and same and heights[0] >= heights[1]


def _of_family(table: Floats, family: _Family, weighed: Evidence, told_as: float) -> Gearing:
    """The gearing with this family as the mesh line's, and the teeth decided for it."""
    mesh = family.mesh
    text = ", ".join(f"{np.exp(h):.1f}" for h in family.heights)
    heights = tuple(float(np.exp(h)) for h in family.heights)
    evidence = [
        f"mesh line near {family.line * told_as:.6f} cycles/sample: harmonics 1..{len(heights)} "
        f"stand {text} times over the floor (mean of channels)",
    ]
    same = weighed.teeth and abs(mesh / weighed.mesh - 1.0) < _SAME
    teeth = dict(zip(weighed.teeth, weighed.weights, strict=True)) if same else {}
    angle_of = _angle(table, mesh)
    shafts: tuple[Shaft, ...] = ()
    meshes: tuple[Mesh, ...] = ()
    if angle_of is not None:
        cycles, dropped, mesh = angle_of
        kept = table[:, dropped : dropped + cycles.size]
        top = max(1, min(_HARMONICS, int(0.45 / mesh)))
        per_cycle = samples_per_cycle(mesh)
        sharp = prominence(
            resample_by_angle(kept, cycles, samples_per_turn=per_cycle), float(per_cycle)
        )
        shafts = shafts_of(sharp, top, teeth)
        evidence += [
            f"sidebands at mesh/{shaft.ratio:.3f} (+-{shaft.ratio_error:.3f}), {shaft.lines} of "
            f"them over 3 times the floor: a gear of {shaft.teeth} teeth, shaft order "
            f"{shaft.order:.4f}"
            for shaft in shafts
            if shaft.lines
        ]
        if len(shafts) > 1:
            meshes = second_mesh(sharp, shafts, top, evidence)
    if not shafts:
        any_fits = "" if weighed.gears else ", any fits"
        evidence.append(
            f"no tooth number is decided{any_fits}: it may be a shaft's own line and no mesh line "
            "('mesh x n' is its n-th harmonic all the same)"
        )
    return Gearing(
        mesh_frequency=mesh,
        harmonics=heights,
        shafts=shafts,
        meshes=meshes,
        evidence=tuple(evidence),
        weighed=weighed.scaled(told_as),
    )


def _clearest_family(raw: Prominence, near: float | None) -> _Family:
    """The clearest family of harmonics; of a mesh line near ``near`` if given."""
    level, per = raw.level, raw.per_unit
    low, high = (5.0 / per, 0.45) if near is None else (0.97 * near, 1.03 * near)
    first, last = max(2, int(low * per)), min(level.size - 2, int(np.ceil(high * per)))
    inside = np.arange(first, last + 1)
    if inside.size == 0:
        raise InputError("mesh line", near, allowed="inside 0..0.45 cycles/sample")
    peaks = inside[
        (level[inside] >= level[inside - 1])
        & (level[inside] > level[inside + 1])
        & (level[inside] > max(4.0 * raw.spread, _STANDS))
    ]
    if peaks.size == 0:
        raise InputError("mesh line", "none", why="no line stands out of the floor")
    found = [_family(raw, peak / per) for peak in peaks[np.argsort(-level[peaks])][:400]]
    return max(found, key=lambda family: family.score)


def _family(raw: Prominence, near: float) -> _Family:
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
    return _Family(
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


def known_teeth(gearing: Gearing, teeth: int | None) -> list[int]:
    """Teeth of the shafts that are decided, and those given."""
    given = [teeth] if teeth else []
    return list(dict.fromkeys([*(shaft.teeth for shaft in gearing.shafts), *given]))


def sides_of(gearing: Gearing, *, teeth: int | None, rank: int, mesh: float) -> tuple[float, ...]:
    """Where the shafts' sidebands of a mesh harmonic stand, ``mesh`` in any unit."""
    return tuple(
        mesh * (rank + sign * n / z)
        for z in known_teeth(gearing, teeth)
        for n in (1, 2, 3)
        for sign in (-1, 1)
    )


def told_of_mate(gearing: Gearing, *, teeth: int | None, samples: int) -> list[Notice]:
    """What a slower mate that is not known would change: it may turn fewer than four times."""
    known = known_teeth(gearing, teeth)
    turns = gearing.mesh_frequency * samples / known[0] if known else np.inf
    if len(known) != 1 or turns >= _SLOWEST:
        return []
    return [
        Notice.of(
            "mate_turned_little" if turns < SLOW else "mate_may_have_turned_little",
            turns=turns,
            teeth=known[0],
            mate=round(turns * known[0] / _FEW),
            least=_FEW,
        )
    ]
