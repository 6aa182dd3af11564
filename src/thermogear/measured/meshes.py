"""A mesh line, its harmonics, and the sidebands and own lines of its gears' shafts: what they
foretell, and the evidence for them over chance (:mod:`thermogear.measured.groups`)."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import special

from thermogear.base.arrays import Flags, Floats
from thermogear.measured.groups import (
    HIGHEST,
    ONE_MORE,
    Seen,
    falling,
    log_sum,
    mean_exp,
    narrow,
    refined,
    some_of,
    taken_by,
)
from thermogear.measured.peaks import Peaks

TEETH = (12, 250)
"""Tooth numbers looked for: fewer are not made as power gears."""
HARMONICS = 6
"""Of a mesh line, at most."""

_MESH_SPREAD = 1.5  # nepers, of mesh harmonics about a fall with their rank
_SIDE_SPREAD = 1.2  # of sidebands, and of a shaft's own lines, about a fall with their order
_FALL = 0.7  # nepers for each order
_SIDES = np.array([-1, 1, -2, 2, -3, 3])
_OWN = np.arange(1, 5)
_TOLD_APART = 6.0  # bins between a line and its sidebands where teeth can be named
_OFF = np.linspace(-0.6, 0.6, 601)  # bins, of a distance of sidebands beside a gear's
_FREE = 0.1  # prior of such a distance, of a gear's
_GIVEN = 0.9  # how far a stated tooth number or speed is trusted
_SPEED_SPREAD = 0.05  # a stated speed is nominal


@dataclass(frozen=True, kw_only=True)
class Stated:
    """What a user says, teeth of a gear and its shaft's turns per sample; and the frequencies that
    ``mains`` may have [cycles/sample]."""

    teeth: int | None = None
    shaft: float | None = None
    mains: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Gears:
    """A mesh line [cycles/sample] and the teeth of those of its gears whose shafts show, with the
    log evidence ``sides`` of each one's first sidebands alone; ``level`` of its highest harmonic
    [nepers over the floor]; ``free``: distances of sidebands that are no gear's
    [cycles/sample]."""

    mesh: float
    level: float
    teeth: tuple[int, ...] = ()
    sides: tuple[float, ...] = ()
    free: tuple[float, ...] = ()

    @property
    def words(self) -> str:
        """In words."""
        teeth = f"{' and '.join(map(str, self.teeth))} teeth" if self.teeth else "teeth not seen"
        beside = "".join(f", sidebands every {one:.6f}" for one in self.free)
        return f"mesh line {self.mesh:.6f} cycles/sample, {teeth}{beside}"

    def without(self, teeth: int, distance: float) -> Gears:
        """The same, where these teeth are a distance of sidebands."""
        kept = [(z, e) for z, e in zip(self.teeth, self.sides, strict=True) if z != teeth]
        return replace(
            self,
            teeth=tuple(z for z, _ in kept),
            sides=tuple(e for _, e in kept),
            free=(*self.free, distance),
        )

    def scaled(self, factor: float) -> Gears:
        """The same with every place times ``factor``."""
        free = tuple(one * factor for one in self.free)
        return replace(self, mesh=self.mesh * factor, free=free)


@dataclass(frozen=True)
class Draft:
    """``gears`` with their log evidence and the lines that are theirs (``used``); ``bare`` and
    ``mesh_lines``: of the mesh lines and their harmonics alone."""

    gears: tuple[Gears, ...]
    evidence: float
    used: Flags
    bare: float
    mesh_lines: Flags

    @property
    def steps(self) -> tuple[float, ...]:
        """Turns per sample of the shafts."""
        return tuple(gears.mesh / z for gears in self.gears for z in gears.teeth)


@dataclass(frozen=True, eq=False)
class _Carriers:
    """Harmonics of a mesh line +- ``error`` [cycles/sample]: log evidence, the lines that are
    theirs, the ranks seen and their levels."""

    mesh: float
    error: float
    evidence: float
    lines: NDArray[np.int64]
    rank: Floats
    tops: Floats

    def beside(
        self, peaks: Peaks, used: Flags, ratio: Floats
    ) -> tuple[tuple[Seen, ...], tuple[Seen, ...]]:
        """Sidebands of a shaft that turns once in ``ratio`` (case,) of the mesh's cycles, and that
        shaft's own lines, each up to the first, second, ... order."""
        ratio = ratio[:, None, None]
        sides = falling(
            peaks,
            used,
            position=(self.rank[:, None] + _SIDES / ratio) * self.mesh,
            order=np.abs(_SIDES),
            error=self.rank[:, None] * self.error,
            spread=_SIDE_SPREAD,
            trend=-_FALL * (np.abs(_SIDES) - 1.0),
            top=self.tops,
        )
        own = falling(
            peaks,
            used,
            position=_OWN * self.mesh / ratio,
            order=_OWN,
            error=_OWN * self.error / ratio,
            spread=_SIDE_SPREAD,
            trend=np.asarray(-_FALL * (_OWN - 1.0), float),
            top=np.inf,
        )
        return sides, own


@functools.lru_cache(maxsize=128)
def _carriers(peaks: Peaks, mesh: float, taken: bytes) -> _Carriers:
    """Harmonics of a mesh line on lines that are not ``taken`` (flags as bytes): most of many
    tooth numbers share theirs."""
    used = np.frombuffer(taken, dtype=bool)
    ranks = np.arange(1, min(HARMONICS, int(HIGHEST / mesh)) + 1)
    mesh, error = refined(peaks, mesh, ranks)
    rank = ranks.astype(float)
    found = falling(
        peaks,
        used,
        position=(rank * mesh)[None, :],
        order=ranks,
        error=(rank * error)[None, :],
        spread=_MESH_SPREAD,
        trend=-np.log(rank),
        top=np.inf,
    )
    each = _each(found)
    evidence = _open(each) + narrow(error, width=HIGHEST) + ONE_MORE
    lines = _best(found, each).lines[0]
    seen = lines >= 0
    lines, rank = lines[seen], rank[seen]
    return _Carriers(mesh, error, float(evidence), lines, rank, peaks.level[lines])


@functools.lru_cache(maxsize=512)
def _gear(
    peaks: Peaks, carriers: _Carriers, taken: bytes, teeth: int
) -> tuple[float, tuple[float, float], NDArray[np.int64]]:
    """A gear of so many teeth on lines that are not ``taken``: log evidence of its first sidebands
    alone, of all sidebands and its shaft's own lines, and the lines that are its. Pairs of gears
    share most."""
    used = np.frombuffer(taken, dtype=bool)
    sides, own = carriers.beside(peaks, used, np.array([float(teeth)]))
    first = float(some_of(sides[0].evidence)[0])
    each = _each(sides), _each(own)
    lines = [taken_by(_best(part, one)) for part, one in zip((sides, own), each, strict=True)]
    return first, (float(_open(each[0])[0]), float(_open(each[1])[0])), np.concatenate(lines)


def mesh_of(
    peaks: Peaks, mesh: float, teeth: tuple[int, ...], stated: Stated, first: Draft | None = None
) -> Draft:
    """Log evidence of a mesh line with these gears, without what is left of the lines; of a second
    mesh on the lines that the ``first`` leaves."""
    used = np.zeros(peaks.size, dtype=bool) if first is None else first.used.copy()
    carriers = _carriers(peaks, mesh, used.tobytes())
    mesh, total = carriers.mesh, carriers.evidence
    used[carriers.lines] = True
    bare, mesh_lines = total, np.zeros(peaks.size, dtype=bool)
    mesh_lines[carriers.lines] = True
    around: list[float] = []
    for z in teeth:
        first_sides, (sides, own), lines = _gear(peaks, carriers, used.tobytes(), z)
        prior = prior_of(mesh, teeth=z, stated=stated)
        bare += prior
        # beside a line, as close as its own lobe, others are not placed well enough to count teeth
        near = mesh / z < _TOLD_APART * peaks.bin_width
        around.append(0.0 if near else first_sides)
        total = total + prior + sides + own
        used[lines] = True
    level = float(np.max(carriers.tops, initial=-np.inf))
    gears = Gears(mesh=mesh, level=level, teeth=teeth, sides=tuple(around))
    if first is None:
        return Draft((gears,), total, used, bare, mesh_lines)
    return Draft(
        (*first.gears, gears),
        first.evidence + total,
        used,
        first.bare + bare,
        first.mesh_lines | mesh_lines,
    )


def whole(
    peaks: Peaks, gears: tuple[Gears, ...], teeth: int, stated: Stated
) -> tuple[float, float]:
    """Probability that the ``teeth`` on the first mesh of ``gears`` are a gear's, and the distance
    [cycles/sample] that its sidebands have if not.

    Sidebands of a torsional oscillation, or of a shaft that no gear joins to this mesh, have any
    distance; by chance it comes near a whole part of the mesh line. Every ratio of mesh line to
    distance is as likely as another, and all together a tenth as likely as a gear's whole number
    (a choice, checked on drawn records). With lines that tell the ratio r to +-s the odds of the
    gear are 10/(s sqrt(2 pi)) exp(-(r - teeth)^2/(2 s^2)).
    """
    first, *further = gears
    others = tuple(z for z in first.teeth if z != teeth)
    draft = mesh_of(peaks, first.mesh, others, Stated())
    for one in further:
        draft = mesh_of(peaks, one.mesh, one.teeth, Stated(), draft)
    carriers = _carriers(peaks, first.mesh, bytes(peaks.size))
    mesh = carriers.mesh
    distance = mesh / teeth + peaks.bin_width * _OFF
    ratio = mesh / distance
    near = (np.abs(ratio - teeth) < 0.5) & (distance > 0.0)
    ratio, distance = ratio[near], distance[near]
    sides, own = carriers.beside(peaks, draft.used, np.append(ratio, float(teeth)))
    evidence = _open(_each(sides)) + _open(_each(own))
    share = np.log(ratio**2 / mesh * peaks.bin_width * (_OFF[1] - _OFF[0]))
    free = mean_exp(evidence[:-1] + share) + float(np.log(ratio.size * _FREE))
    # what is stated may be of the other gear: it speaks for these teeth or says nothing
    said = prior_of(mesh, teeth=teeth, stated=stated) - prior_of(mesh, teeth=teeth, stated=Stated())
    gear = evidence[-1] + max(0.0, said)
    return float(special.expit(gear - free)), float(distance[np.argmax(evidence[:-1])])


def _each(parts: tuple[Seen, ...]) -> Floats:
    """Log evidence of groups (..., group) up to each order: (order, ...)."""
    return some_of(np.stack([part.evidence for part in parts]))


def _open(each: Floats) -> Floats:
    """Log evidence of groups up to an order that is open, all alike: of ``each`` (order, ...)."""
    return log_sum(each) - float(np.log(len(each)))


def _best(parts: tuple[Seen, ...], each: Floats) -> Seen:
    """Those up to the order with the greatest evidence, of one case."""
    best = int(np.argmax(np.sum(each.reshape(len(parts), -1), axis=-1)))
    lines = parts[best].lines.reshape(-1, parts[best].lines.shape[-1])
    return Seen(evidence=parts[best].evidence.ravel(), lines=lines)


def prior_of(mesh: float, *, teeth: int, stated: Stated) -> float:
    """Log prior of a gear: any tooth number alike, or as stated; a stated speed is nominal."""
    total = -float(np.log(TEETH[1] - TEETH[0] + 1))
    if stated.teeth is not None:
        own = _GIVEN if teeth == stated.teeth else 0.0
        total = float(np.log(own + (1.0 - _GIVEN) * np.exp(total)))
    if stated.shaft is not None:
        away = np.log(mesh / teeth / stated.shaft) / _SPEED_SPREAD
        # against a shaft anywhere within a factor of 30 to both sides
        near = np.exp(-0.5 * away**2) / (_SPEED_SPREAD * np.sqrt(2 * np.pi)) * 2 * np.log(30.0)
        total += float(np.log(_GIVEN * near + 1.0 - _GIVEN))
    return total
