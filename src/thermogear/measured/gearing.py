"""The gearing found from the lines of a record, with the evidence: which line is the mesh's.

Everything here is in cycles per sample and in orders: no rate is needed and none is invented.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.measured.prominence import Prominence, prominence
from thermogear.measured.sidebands import Mesh, Shaft, second_mesh, shafts_of
from thermogear.signals.orders import line_angle, resample_by_angle
from thermogear.signals.spectra import amplitude_spectrum

Floats = NDArray[np.float64]

LONGEST = 1 << 19
"""Samples that the search looks at, from the start of the record."""

_HARMONICS = 5
_CANDIDATES = 20  # families looked at for sidebands
_SCREEN = 1 << 16
_LAW_KEPT = 0.7  # what sidebands at a whole number of teeth count for, beside their height
_MOST_FROM_SIDEBANDS = 3.2  # scores of sidebands stay below this
_NARROW = 0.006  # half width of the phase filter over the mesh line


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


def find_gearing(channels: Sequence[Floats], near: float | None = None) -> Gearing:
    """Mesh line, shafts, tooth numbers and further meshes of one record.

    1. Mesh line: the peak with the clearest harmonics 1..5, in the mean of the logarithms of
       amplitude over floor, over all channels (``near`` [cycles/sample] restricts it to +-3 %).
    2. The phase of that line is the angle: the record is resampled in mesh cycles, which makes
       every line of the gear train sharp, whatever the speed does.
    3. A shaft with z teeth puts sidebands at h +- n/z around the mesh harmonics h. z is the
       whole number with the clearest sidebands n = 1..3; a second shaft is sought among the
       z that do not divide it, by n = 1.
    4. A further mesh turns on the second and on a slower shaft: its order is a whole multiple of
       both, with 17 teeth or more (fewer are undercut as standard gears).

    ``channels``: one array each, equal lengths. Raises InputError when no mesh line is found.
    """
    table = np.stack([np.asarray(c, dtype=float)[:LONGEST] for c in channels])
    if not np.all(np.isfinite(table)):
        raise InputError("record", "gaps", allowed="finite samples", fix="cut the gap out")
    table = table[np.std(table, axis=-1) > 0]
    if table.size == 0 or table.shape[-1] < 256:
        raise InputError("record", f"{table.shape[-1]} samples", allowed=">= 256, not constant")
    families = _families(prominence(table, 1.0), near)
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


@dataclass(frozen=True)
class _Family:
    """A line and its harmonics: ``heights`` their log prominences, ``score`` the mean."""

    line: float
    mesh: float
    heights: tuple[float, ...]
    score: float


def _of_family(table: Floats, family: _Family) -> tuple[float, Gearing]:
    """The gearing if this family is the mesh's, and its score.

    A shaft's own harmonics make a family too, often the stronger one; but no sidebands at whole
    parts of it are around them. So the sidebands' score counts like the family's.
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
    sharp = prominence(
        resample_by_angle(kept, cycles, samples_per_turn=per_cycle), float(per_cycle)
    )
    shafts = shafts_of(sharp, top, evidence)
    meshes: tuple[Mesh, ...] = ()
    if not shafts:
        evidence.append(
            "no sidebands at whole parts of it: it may be a shaft's own line and no mesh line"
        )
    if len(shafts) > 1:
        meshes = second_mesh(sharp, shafts, top, evidence)
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


def _families(raw: Prominence, near: float | None) -> list[_Family]:
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
