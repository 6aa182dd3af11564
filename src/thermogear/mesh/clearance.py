"""The clearance of the mesh: deviations and heat on both flanks, and where none is left.

Both forms of the mesh force, the jam and the pictures take it from here, and here it comes
from the one gap function of :mod:`thermogear.gears.touch`: at every mesh phase the tightest
pair of the drive flanks and the tightest of the back flanks bound the free play.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base import bounds
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import Deviation
from thermogear.gears.touch import first_touch
from thermogear.mesh.thermal import HotPair, ThermalDeviation

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Clearance:
    """Half backlash and kinematic error over the mesh phase, and where the pair jams.

    ``half_backlash`` b' and ``error`` e [m], (count, phases); b' <= 0 is jammed.
    ``jam_temperature`` [K], (count,): the pinion's addendum at which the least b' is 0, both
    gears rising (or, jammed already, falling) alike, the housing as it is.
    ``proportional_jam_temperature`` [K], (count,): the same where every excess over the reference
    temperature, housing's and shafts' too, keeps its proportion; the warm side's, the cold side's
    where a pair jams in the cold alone, unless below what a case's bodies may have. Both nan where
    no temperature does it, and where the pair is jammed without heat.
    """

    half_backlash: Floats
    error: Floats
    jam_temperature: Floats
    proportional_jam_temperature: Floats


def clearance(hot: HotPair, phase: Floats, deviations: Sequence[Deviation] = ()) -> Clearance:
    """b'(phi) = b + (min_j e_j + min_j e_j^c)/2 and e(phi) = (min_j e_j - min_j e_j^c)/2.

    e_j is the gap of pair j of the drive flanks by ``deviations``, tip corners and heat, e_j^c
    that of the back flanks; between the two touches the gears move freely by 2 b'. Growth is
    linear in the temperatures, so both jams are exact. The thesis's flank has no error of heat.
    """
    gaps = [_flank_gaps(hot, phase, deviations, flank) for flank in ("drive", "back")]
    one, two = (np.min(plain + heat, axis=-1) for plain, heat, _ in gaps)
    left = hot.operating.half_backlash + 0.5 * (one + two)
    if hot.model.flank == "thesis":
        one, two = (np.min(plain + 0.0 * heat, axis=-1) for plain, heat, _ in gaps)
    base = hot.temperatures.reference
    addendum = np.broadcast_to(
        np.asarray(hot.temperatures.pinion_addendum, dtype=float), (hot.count,)
    )
    rise, grow, shrink = np.full((3, hot.count), np.inf)
    drawn = np.full(hot.count, np.inf)
    (plain, heat, slope), (plain_c, heat_c, slope_c) = gaps
    for j in range(plain.shape[-1]):
        for k in range(plain_c.shape[-1]):
            # b' of this pair of flanks is straight in the rise and in the factor on the excesses
            bare = hot.operating.half_backlash + 0.5 * (plain[..., j] + plain_c[..., k])
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
    return Clearance(
        half_backlash=left,
        error=0.5 * (one - two),
        jam_temperature=_physical(addendum + rise, (left.min(axis=1) <= 0.0) & jammed_cold),
        proportional_jam_temperature=_physical(together, jammed_cold | (excess == 0.0)),
    )


def _physical(kelvin: Floats, none: NDArray[np.bool_]) -> Floats:
    """Temperatures above absolute zero; nan elsewhere and where there are ``none``."""
    return np.where(np.isfinite(kelvin) & (kelvin > 0.0) & ~none, kelvin, np.nan)


def _flank_gaps(
    hot: HotPair, phase: Floats, deviations: Sequence[Deviation], flank: str
) -> tuple[Floats, Floats, Floats]:
    """Gaps [m] by deviations and by heat, and the loss of gap for 1 K more of both gears [m/K].

    Arrays that broadcast to (count, phases, pair); inf where a pair never touches.
    """
    points = mesh_points(hot.pair, phase, flank)
    heat = ThermalDeviation(hot).gap(points.contacts)
    # growth is linear: what a kelvin takes is the same from the drawing on
    kelvin = ThermalDeviation(hot.drawn().warmed(1.0)).gap(points.contacts)
    return first_touch(points, deviations).gap, heat, -kelvin


def _first_zero(left: Floats, slope: Floats) -> Floats:
    """Least x over the phase at which left - slope x falls to 0, (count,); inf if it never does."""
    falling = (slope > 0.0) & np.isfinite(left)
    x = np.divide(left, slope, out=np.full(np.broadcast(left, slope).shape, np.inf), where=falling)
    return np.asarray(x.min(axis=-1))
