"""The clearance of the mesh: deviations, speed and heat on both flanks, and where none is left.

Both forms of the mesh force, the jam and the pictures take it from here, and here it comes
from the one gap function of :mod:`thermogear.gears.touch`: at every mesh phase the tightest
pair of the drive flanks and the tightest of the back flanks bound the free play.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial, reduce

import numpy as np
from numpy.typing import NDArray

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.gears.candidates import MeshPoints, mesh_points
from thermogear.gears.deviations import Deviation
from thermogear.gears.touch import first_touch
from thermogear.gears.turn import turn_period
from thermogear.mesh.elastic import over_turn, turn_phases
from thermogear.mesh.thermal import HotPair, ThermalDeviation

Gaps = tuple[Floats, ...]
"""Gaps [m] of one side's flanks by deviations, by the centrifugal pull and by heat, each
(count, mesh period, phase, pair) by broadcast."""
PARTS = ("deviations", "speed", "heat")
"""What takes or gives backlash, in that order."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """Half backlash and kinematic error over the mesh phase, and where the pair jams.

    b'(phi) = b + (min_j e_j + min_j e_j^c)/2 and e(phi) = (min_j e_j - min_j e_j^c)/2.

    e_j is the gap of pair j of the drive flanks by ``deviations``, tip corners, the centrifugal
    pull and heat, e_j^c that of the back flanks; between the two touches the gears move freely by
    2 b'. Growth is linear in the temperatures, so both jams are exact. The thesis's flank has no
    error of heat, and knows no pull.

    ``phase`` is that of one mesh period. Where teeth differ, results go over all mesh periods of
    the turn, one after the other, and the least is that of the tightest tooth pairs of the turn:
    what heat does is the same in each of them, so that for each pair j of the drive flanks and
    k of the back flanks the period with the least e_j + e_k^c decides, whatever the temperatures.
    """

    hot: HotPair
    phase: Floats
    deviations: Sequence[Deviation] = ()

    @cached_property
    def mesh_periods(self) -> int:
        """L, after which the gaps come again."""
        return turn_period(self.hot.pair, self.deviations).mesh_periods

    @cached_property
    def _gaps(self) -> tuple[Gaps, Gaps]:
        """Of drive and back flanks."""
        every = turn_phases(self.mesh_periods, self.phase)

        def touch(flank: str, phase: Floats) -> list[Floats]:
            gap = first_touch(mesh_points(self.hot.pair, phase, flank), self.deviations).gap
            return [gap.reshape(-1, *gap.shape[-2:])]

        drive, back = (
            (
                *(
                    _by_period(gap, self.mesh_periods)
                    for gap in over_turn(partial(touch, flank), every, self.mesh_periods)
                ),
                *(_by_period(gap, 1) for gap in ThermalDeviation(self.hot).gaps(points.contacts)),
            )
            for flank, points in zip(("drive", "back"), self._points, strict=True)
        )
        return drive, back

    @property
    def _points(self) -> tuple[MeshPoints, MeshPoints]:
        """Of the first mesh period."""
        drive, back = (mesh_points(self.hot.pair, self.phase, flank) for flank in ("drive", "back"))
        return drive, back

    @property
    def gaps(self) -> tuple[Floats, Floats]:
        """(e_j, e_j^c) [m] of every candidate pair, (count, phases, pair), heat among them.

        Where the drive flanks of the tightest pair touch, e_j - min_j e_j is left between those of
        pair j and 2 b + e_k^c + min_j e_j between the back flanks of pair k.
        """
        drive, back = (
            np.reshape(sum(parts), (self.hot.count, -1, parts[0].shape[-1])) for parts in self._gaps
        )
        return drive, back

    @cached_property
    def half_backlash(self) -> Floats:
        """b' [m], (count, phases); b' <= 0 is jammed."""
        return self._left(len(PARTS))

    @cached_property
    def least(self) -> Floats:
        """The least b' [m] over the phase, (count,)."""
        return self._least(len(PARTS))

    def _tightest(self, gaps: Gaps) -> Floats:
        """min_j of the sum of ``gaps``, (count, phases)."""
        pairs = range(gaps[0].shape[-1])
        found = reduce(np.minimum, (sum(gap[..., j] for gap in gaps) for j in pairs))
        whole = (self.hot.count, self.mesh_periods, self.phase.size)
        return np.reshape(np.broadcast_to(found, whole), (self.hot.count, -1))

    def _left(self, parts: int) -> Floats:
        """b' [m] with the first ``parts`` of :data:`PARTS` alone, (count, phases)."""
        drive, back = (self._tightest(gaps[:parts]) for gaps in self._gaps)
        return np.asarray(self.hot.half_backlash[:, None] + 0.5 * (drive + back))

    def _least(self, parts: int) -> Floats:
        """The least of :meth:`_left`, (count,), from the closest mesh period of every two pairs."""
        if self.mesh_periods == 1:
            return np.asarray(self._left(parts).min(axis=1))
        least = np.full(self.hot.count, np.inf)
        for (j, k), closest in self._closest.items():
            more = sum(
                gap[:, 0, :, place]
                for gaps, place in zip(self._gaps, (j, k), strict=True)
                for gap in gaps[1:parts]
            )
            least = np.minimum(least, np.min(closest + more, axis=-1))
        return np.asarray(self.hot.half_backlash + 0.5 * least)

    @cached_property
    def _closest(self) -> dict[tuple[int, int], Floats]:
        """min over the mesh periods of e_j + e_k^c [m] by deviations, (count or 1, phase)."""
        (drive, *_), (back, *_) = self._gaps
        return {
            (j, k): (drive[..., j] + back[..., k]).min(axis=1)
            for j, k in np.ndindex(drive.shape[-1], back.shape[-1])
        }

    @cached_property
    def parts(self) -> dict[str, Floats]:
        """What each of :data:`PARTS` adds to the least b' over the phase [m], each (count,).

        With those before it there already, so that the cold half backlash and all of them add up
        to the least one; below 0 it takes.
        """
        levels = [self.hot.half_backlash]
        levels += [self._least(k + 1) for k in range(len(PARTS))]
        return dict(zip(PARTS, np.diff(levels, axis=0), strict=True))

    @cached_property
    def error(self) -> Floats:
        """e [m], (count, phases)."""
        felt = 0.0 if self.hot.model.flank == "thesis" else 1.0
        drive, back = (
            self._tightest((plain, pull, felt * heat)) for plain, pull, heat in self._gaps
        )
        return np.asarray(0.5 * (drive - back))

    @cached_property
    def _jams(self) -> tuple[Floats, Floats]:
        hot = self.hot
        # growth is linear: what a kelvin takes is the same from the drawing on
        kelvin = ThermalDeviation(hot.drawn().warmed(1.0))
        slope, slope_c = (-kelvin.gap(points.contacts) for points in self._points)
        (plain, heat), (plain_c, heat_c) = (
            (own + pull if self.mesh_periods == 1 else pull, heat[:, 0])
            for own, pull, heat in self._gaps
        )
        base = hot.temperatures.reference
        addendum = np.broadcast_to(
            np.asarray(hot.temperatures.pinion_addendum, dtype=float), (hot.count,)
        )
        rise, grow, shrink = np.full((3, hot.count), np.inf)
        drawn = np.full(hot.count, np.inf)
        for j in range(plain.shape[-1]):
            for k in range(plain_c.shape[-1]):
                # b' of this pair of flanks is straight in the rise and in the factor on excesses
                gap = plain[:, 0, :, j] + plain_c[:, 0, :, k]
                if self.mesh_periods > 1:
                    gap = gap + self._closest[j, k]
                bare = hot.half_backlash[:, None] + 0.5 * gap
                lost = -0.5 * (heat[..., j] + heat_c[..., k])
                per_kelvin = 0.5 * (slope[..., j] + slope_c[..., k])
                drawn = np.minimum(drawn, bare.min(axis=-1))
                rise = np.minimum(rise, _first_zero(bare - lost, per_kelvin))
                grow = np.minimum(grow, _first_zero(bare, lost))
                shrink = np.minimum(shrink, _first_zero(bare, -lost))
        jammed_cold = drawn <= 0.0
        excess = addendum - base
        with np.errstate(invalid="ignore"):
            warm, cold = base + np.abs(excess) * np.where(
                excess > 0.0, (grow, -shrink), (shrink, -grow)
            )
        # colder than any body of a case is no answer
        cold = np.where(cold >= bounds.BODY.least, cold, np.nan)
        together = np.where(np.isfinite(warm), warm, cold)
        jammed = self.least <= 0.0
        return (
            _physical(addendum + rise, jammed & jammed_cold),
            _physical(together, jammed_cold | (excess == 0.0)),
        )

    @property
    def jam_temperature(self) -> Floats:
        """Pinion's addendum [K] at which the least b' is 0, (count,): both gears rising (or, jammed
        already, falling) alike, the housing as it is; nan where no temperature does it, and where
        the pair is jammed without heat.
        """
        return self._jams[0]

    @property
    def proportional_jam_temperature(self) -> Floats:
        """The same [K] where every excess over the reference, housing's and shafts' too, keeps its
        proportion; the warm side's, the cold side's where a pair jams in the cold alone, unless
        below what a case's bodies may have.
        """
        return self._jams[1]


def _by_period(gap: Floats, periods: int) -> Floats:
    """A gap (..., phases, pair) as (count or 1, mesh period, phase, pair)."""
    return np.reshape(gap, (-1, periods, gap.shape[-2] // periods, gap.shape[-1]))


def _physical(kelvin: Floats, none: NDArray[np.bool_]) -> Floats:
    """Temperatures above absolute zero; nan elsewhere and where there are ``none``."""
    return np.where(np.isfinite(kelvin) & (kelvin > 0.0) & ~none, kelvin, np.nan)


def _first_zero(left: Floats, slope: Floats) -> Floats:
    """Least x over the phase at which left - slope x falls to 0, (count,); inf if it never does."""
    falling = (slope > 0.0) & np.isfinite(left)
    x = np.divide(left, slope, out=np.full(np.broadcast(left, slope).shape, np.inf), where=falling)
    return np.asarray(x.min(axis=-1))
