"""Loaded contact of a series: many parts of one drawing at one operating point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.gears.deviations import Deviation
from thermogear.gears.pair import GearPair
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.elastic import TURN_POSITIONS, elastic_pair
from thermogear.mesh.thermal import HotPair


@dataclass(frozen=True, eq=False)
class SeriesMesh:
    """The mesh of every part over ``mesh_periods`` mesh periods, (part, phase), one after another.

    ``transmission_error`` [m] static, under load, as the mesh cycle's; ``spring_error`` [m] and
    ``stiffness`` [N/m]: :class:`~thermogear.mesh.elastic.MeshCurves`; ``half_backlash`` [m].
    ``whole``: whether that is the whole turn of the pair; else as many consecutive periods of it.
    """

    pair: GearPair
    transmission_error: Floats
    spring_error: Floats
    stiffness: Floats
    half_backlash: Floats
    mesh_periods: int
    whole: bool


def series_mesh(
    hot: HotPair,
    parts: Sequence[Sequence[Deviation]],
    periods: int,
    positions: int = TURN_POSITIONS,
    start: Sequence[int] | None = None,
) -> SeriesMesh:
    """Loaded contact of every part, its deviations in ``parts``, at the one point of ``hot``.

    ``periods`` mesh periods are followed, each of so many ``positions``: from mesh period ``start``
    of each part on, 0 by default.
    """
    phase = np.arange(positions) / positions
    rows = []
    first = [0] * len(parts) if start is None else start
    for part, begin in zip(parts, first, strict=True):
        elastic, gap = elastic_pair(hot, part), Clearance(hot, phase, part)
        curves = elastic.over(phase)
        error = gap.error if curves.spring_error is None else curves.spring_error
        every = (curves.transmission_error, error, curves.stiffness, gap.half_backlash)
        place = (begin * positions + np.arange(periods * positions)) % (
            elastic.mesh_periods * positions
        )
        rows.append([curve[0, place] for curve in every])
    turn = elastic_pair(hot, parts[0]).mesh_periods
    transmission, error, stiffness, backlash = np.swapaxes(rows, 0, 1)
    whole = periods % turn == 0
    return SeriesMesh(hot.pair, transmission, error, stiffness, backlash, periods, whole)
