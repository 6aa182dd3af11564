"""Loaded contact of a series: many parts of one drawing at one operating point, side by side.

What depends on the mesh phase alone, compliances and the advances of plain involutes, is the same
in every mesh period and for every part; teeth and parts differ in their gaps.
Checked by ``tests/mesh/test_series.py``: each part as if it were the only one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import Deviation
from thermogear.gears.loaded import LEAST_LINE_LOAD
from thermogear.gears.mesh_system import MeshSystem, pressed_spread
from thermogear.gears.pair import GearPair
from thermogear.gears.stiffness import Moduli
from thermogear.gears.touch import touch_of_parts
from thermogear.gears.turn import numbered_from, turn_period
from thermogear.mesh.elastic import BLOCK, TURN_POSITIONS, elastic_pair, turn_phases
from thermogear.mesh.thermal import HotPair, ThermalDeviation

AHEAD = 34
"""Mesh periods ahead of those of a longer turn: at a natural over a mesh frequency of .7 and a
damping ratio of .07, a vibration falls to 1e-4 of itself in 30 of them."""


@dataclass(frozen=True, eq=False)
class SeriesMesh:
    """The mesh of every part over ``mesh_periods`` mesh periods, (part, phase), one after another.

    ``transmission_error`` [m] static, under load, as the mesh cycle's; ``half_backlash`` [m];
    ``spring_error`` [m] and ``stiffness`` [N/m] as :class:`~thermogear.mesh.elastic.MeshCurves`
    has them, with ``ahead`` mesh periods more before the others. ``whole``: whether it is the whole
    turn of the pair, with none ahead; else so many consecutive periods of it. nan where a contact
    does not settle.
    """

    pair: GearPair
    transmission_error: Floats
    spring_error: Floats
    stiffness: Floats
    half_backlash: Floats
    mesh_periods: int
    whole: bool
    ahead: int = 0


def series_mesh(
    hot: HotPair,
    parts: Sequence[Sequence[Deviation]],
    periods: int,
    positions: int = TURN_POSITIONS,
    start: Sequence[int] | None = None,
) -> SeriesMesh:
    """Loaded contact of every part, its deviations in ``parts``, at the one point of ``hot``.

    ``periods`` mesh periods are followed, each of so many ``positions``: from mesh period ``start``
    of each part on, 0 by default. Where they are not the whole turn the springs have
    :data:`AHEAD` more before them, from which a motion can settle. Parts hang on each other in no
    digit. Textbook springs do not feel deviations; their errors are those without load.
    """
    pair, phase = hot.pair, np.arange(positions) / positions
    turn = max((turn_period(pair, part).mesh_periods for part in parts), default=1)
    whole = periods % turn == 0
    ahead = 0 if whole else AHEAD
    numbered = [
        tuple(_from(pair, deviation, first - ahead) for deviation in part)
        for part, first in zip(parts, start or [0] * len(parts), strict=True)
    ]
    every = turn_phases(periods + ahead, phase)
    step = max(BLOCK // every.size, 1)
    blocks = [
        _curves(hot, numbered[first : first + step], every) for first in range(0, len(parts), step)
    ]
    curves = [np.concatenate(several) for several in zip(*blocks, strict=True)]
    transmission, error, stiffness, backlash = curves
    seen = slice(ahead * positions, None)
    return SeriesMesh(
        pair, transmission[:, seen], error, stiffness, backlash[:, seen], periods, whole, ahead
    )


def _from(pair: GearPair, deviation: Deviation, first: int) -> Deviation:
    """The ``deviation`` with the teeth that enter in mesh period ``first`` as the first ones."""
    pinion, wheel = first % pair.pinion.teeth, first % pair.wheel.teeth
    return numbered_from(pair, deviation, pinion=pinion, wheel=wheel) if first else deviation


def _curves(
    hot: HotPair, parts: Sequence[Sequence[Deviation]], phase: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Transmission and spring error, stiffness and half backlash of some parts, (part, phase)."""
    pair, thermal = hot.pair, ThermalDeviation(hot)
    warm = [(*part, thermal) for part in parts]
    elastic = elastic_pair(hot)
    force, wider = float(elastic.force[0]), float(np.ravel(hot.widened)[0])
    load = force / wider
    drive, back = (mesh_points(pair, phase, flank) for flank in ("drive", "back"))
    spread = float(np.sqrt(pressed_spread(pair, load))) ** 2
    pressed, free = touch_of_parts(drive, warm, spread, 0.0)
    (behind,) = touch_of_parts(back, warm, 0.0)
    # pair by pair, which is faster than along an axis so short
    unloaded, back_gap = (reduce(np.minimum, np.moveaxis(t.gap, -1, 0)) for t in (free, behind))
    backlash = hot.half_backlash[0] + 0.5 * (unloaded + back_gap)
    system = MeshSystem.of(
        pair,
        shape=(len(parts),),
        phase=phase,
        moduli=(_flat(elastic.moduli[0]), _flat(elastic.moduli[1])),
        deviations=(),
        model=hot.model.loaded,
        flank="drive",
        touch=pressed,
    )
    carried = load or LEAST_LINE_LOAD * pair.face_width
    _, delta, tangent, _ = system.solve(np.full(len(parts), carried), by_load=True)
    deflection = delta if load else unloaded
    if hot.model.spring == "secant":
        stiffness, error = carried * wider / (delta - unloaded), unloaded
    else:
        stiffness = tangent * wider
        error = deflection - force / stiffness
    return (
        deflection - unloaded.mean(axis=-1, keepdims=True),
        error - error.mean(axis=-1, keepdims=True),
        stiffness,
        backlash,
    )


def _flat(moduli: Moduli) -> Moduli:
    return Moduli(tooth=np.ravel(moduli.tooth), body=np.ravel(moduli.body))
