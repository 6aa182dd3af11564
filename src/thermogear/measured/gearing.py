"""The gearing found from the lines of a record, with the evidence: which line is the mesh's.

Everything here is in cycles per sample and in orders: no rate is needed and none is invented.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.measured.evidence import Evidence, weigh
from thermogear.measured.meshes import Stated
from thermogear.measured.prominence import Prominence, prominence
from thermogear.measured.record import Notice
from thermogear.measured.sidebands import Mesh, Shaft, second_mesh, shafts_of
from thermogear.measured.straight import sharp_peaks
from thermogear.signals.orders import line_angle, resample_by_angle, samples_per_cycle
from thermogear.signals.spectra import amplitude_spectrum

Floats = NDArray[np.float64]

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
    mesh_frequency_error: float
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
    error = 0.5 / table.shape[-1]
    if angle_of is not None:
        cycles, dropped, mesh, error = angle_of
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
        mesh_frequency_error=error,
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
    text = (
        f"the record holds {turns:.3g} turns of the gear of {known[0]} teeth; what a mate that is "
        f"not known, of more than {turns * known[0] / _FEW:.0f} teeth, changes of the mesh line "
        "counts as the line's own: it turned fewer than four times"
    )
    return [Notice("warning" if turns < SLOW else "info", text)]
