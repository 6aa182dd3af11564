"""Loaded contact of a series: many parts of one drawing at one operating point, side by side.

What depends on the mesh phase alone, compliances and the advances of plain involutes, is the same
in every mesh period and for every part; teeth and parts differ in their gaps.
Checked by ``tests/mesh/test_series_mesh.py``: each part as if it were the only one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from itertools import groupby

import numpy as np

from thermogear.base.arrays import Floats, Whole
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import Deviation
from thermogear.gears.loaded import LEAST_LINE_LOAD
from thermogear.gears.mesh_system import MeshSystem, pressed_spread
from thermogear.gears.pair import GearPair
from thermogear.gears.stiffness import Moduli
from thermogear.gears.tooth_damage import damages_of
from thermogear.gears.touch import Touch, touch_of_parts
from thermogear.gears.turn import numbered_from, turn_period
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.elastic import TURN_POSITIONS, elastic_pair, turn_phases
from thermogear.mesh.thermal import HotPair, ThermalDeviation

WHOLE_TURN, STRETCH = 200, 140
"""Mesh periods up to which a turn is followed as a whole; of a longer one so many in a row: the
dynamic factor of a part is 0 to 12 % lower then, 5 % in the mean of twelve hunting pairs of class
8."""
BLOCK = 200_000
"""Positions of all parts that are solved at once: about 100 MB."""
SELDOM = 4
"""Every so many-th position has its backlash: how far a flank stands off changes slowly, and a
motion meets it as a mean."""
AHEAD = 24
"""Mesh periods ahead of those of a longer turn: at a mesh over a natural frequency of 1.1 and a
damping ratio of .07 a vibration falls to 1e-4 of itself in 23 of them."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SeriesMesh:
    """The mesh of every part over ``mesh_periods`` mesh periods, (part, phase), one after another.

    ``transmission_error`` [m] static, under load, about its mean; ``half_backlash`` [m] at every
    :data:`SELDOM`-th phase; ``spring_error`` [m] and ``stiffness`` [N/m] as
    :class:`~thermogear.mesh.elastic.MeshCurves` has them, with ``ahead`` mesh periods more before
    the others. ``whole``: whether it is the whole turn of the pair, with none ahead; else so many
    consecutive periods of it. nan where a contact does not settle.
    """

    pair: GearPair
    transmission_error: Floats
    spring_error: Floats
    stiffness: Floats
    half_backlash: Floats
    mesh_periods: int
    whole: bool
    ahead: int = 0

    def of(self, which: slice) -> SeriesMesh:
        """Some of the parts."""
        names = ("transmission_error", "spring_error", "stiffness", "half_backlash")
        return replace(self, **{name: getattr(self, name)[which] for name in names})

    @cached_property
    def peak_to_peak(self) -> Floats:
        """Transmission error peak to peak over the whole turn [m], (part,).

        Of a stretch of it: each mesh period as the sum of what the pinion's and the wheel's tooth
        that enter in it do, by least squares over the periods followed, in all periods of the turn;
        or what those followed show, where that is more. nan where not every tooth of both gears
        meets enough others in them.
        """
        swing = np.asarray(np.ptp(self.transmission_error, axis=1))
        if self.whole:
            return swing
        teeth, number = (
            (self.pair.pinion.teeth, self.pair.wheel.teeth),
            np.arange(self.mesh_periods),
        )
        design = np.concatenate([np.eye(z)[number % z] for z in teeth], axis=1)
        common = math.gcd(*teeth)
        inverse = np.linalg.pinv(design)
        if round(np.trace(inverse @ design)) < sum(teeth) - common:
            return np.full_like(swing, np.nan)
        error = self.transmission_error.reshape(len(swing), self.mesh_periods, -1)
        pinion, wheel = np.split(np.einsum("ij,pjk->ipk", inverse, error), teeth[:1])
        tops, bottoms = (
            # tooth i of the pinion meets those of the wheel that differ from it by the divisor
            sign * np.max([
                np.max(sign * pinion[k::common], axis=0) + np.max(sign * wheel[k::common], axis=0)
                for k in range(common)
            ], axis=(0, 2))
            for sign in (1.0, -1.0)
        )  # fmt: skip
        return np.asarray(np.maximum(swing, tops - bottoms))


def followed_periods(pair: GearPair) -> int:
    """Mesh periods to follow of a ``pair`` whose teeth differ: its turn, or a stretch of it.

    A turn of :data:`WHOLE_TURN` or less; of a longer one a stretch of :data:`STRETCH`, or of as
    many as both gears have teeth together, so that each tooth meets enough others.

    >>> followed_periods(GearPair(Gear(27, 3e-3), Gear(35, 3e-3)))
    140
    """
    turn = math.lcm(pair.pinion.teeth, pair.wheel.teeth)
    stretch = max(STRETCH, pair.pinion.teeth + pair.wheel.teeth)
    return turn if turn <= max(WHOLE_TURN, stretch + AHEAD) else stretch


def series_mesh(
    hot: HotPair,
    parts: Sequence[Sequence[Deviation]],
    periods: int,
    *,
    positions: int = TURN_POSITIONS,
    start: Sequence[int] | None = None,
) -> SeriesMesh:
    """Loaded contact of every part, its deviations in ``parts``, at the one point of ``hot``.

    ``periods`` mesh periods are followed, each of so many ``positions``, a multiple of
    :data:`SELDOM`: from mesh period ``start``
    of each part on, 0 by default. Where they are not the whole turn the springs have
    :data:`AHEAD` more before them, from which a motion can settle. Parts hang on each other in no
    digit; those in a row whose damaged teeth have the same numbers are solved together. Textbook
    springs do not feel deviations; their errors are those without load.
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
    if hot.model.stiffness == "loaded":
        step = max(BLOCK // every.size, 1)
        # parts side by side share their damaged teeth, numbers and all
        blocks = [
            _curves(hot, several[first : first + step], every)
            for _, group in groupby(numbered, damages_of)
            for several in [list(group)]
            for first in range(0, len(several), step)
        ]
    else:
        blocks = [_alone(hot, part, phase, periods + ahead) for part in numbered]
    curves = [np.concatenate(several) for several in zip(*blocks, strict=True)]
    transmission, error, stiffness, backlash = curves
    seen, seldom = (slice(ahead * positions // step, None) for step in (1, SELDOM))
    return SeriesMesh(
        pair=pair, transmission_error=transmission[:, seen], spring_error=error,
        stiffness=stiffness, half_backlash=backlash[:, seldom], mesh_periods=periods, whole=whole,
        ahead=ahead,
    )  # fmt: skip


def changed_mesh(
    mesh: SeriesMesh, hot: HotPair, parts: Sequence[Sequence[Deviation]], periods: Whole
) -> SeriesMesh:
    """``mesh``, of whole turns at ``hot``, with what its parts do in some ``periods`` solved again.

    ``parts``: the deviations of each with what acts in these mesh periods alone, as a fault of one
    tooth, whose number is the same in all of them. Before them one period is solved that stays as
    it is: errors are told about a mean, and it says how far the means are apart.
    """
    rest = np.setdiff1d(np.arange(mesh.mesh_periods), periods)
    if not rest.size:
        return series_mesh(
            hot, parts, mesh.mesh_periods, positions=mesh.stiffness.shape[1] // mesh.mesh_periods
        )
    solved = np.append(rest[0], periods)
    size = mesh.stiffness.shape[1] // mesh.mesh_periods
    phase = (solved[:, None] + np.arange(size) / size).ravel()
    step = max(BLOCK // phase.size, 1)
    blocks = [
        _curves(hot, parts[first : first + step], phase) for first in range(0, len(parts), step)
    ]
    names = ("transmission_error", "spring_error", "stiffness", "half_backlash")
    changed = {}
    for name, several in zip(names, zip(*blocks, strict=True), strict=True):
        whole = getattr(mesh, name).reshape(len(parts), mesh.mesh_periods, -1).copy()
        new = np.concatenate(several).reshape(len(parts), solved.size, -1)
        new += (whole[:, rest[0]] - new[:, 0]).mean(axis=-1)[:, None, None]
        whole[:, periods] = new[:, 1:]
        changed[name] = whole.reshape(len(parts), -1)
    return replace(mesh, **changed)


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
    drive, *seldom = (
        mesh_points(pair, at, flank)
        for at, flank in ((phase, "drive"), (phase[::SELDOM], "drive"), (phase[::SELDOM], "back"))
    )
    spread = float(np.sqrt(pressed_spread(pair, load))) ** 2
    (pressed,) = touch_of_parts(drive, warm, spread)
    free, behind = (_nearest(touch_of_parts(points, warm, 0.0)[0]) for points in seldom)
    backlash = hot.half_backlash[0] + 0.5 * (free + behind)
    system = MeshSystem.of(
        pair,
        shape=(len(parts),),
        phase=phase,
        moduli=(_flat(elastic.moduli[0]), _flat(elastic.moduli[1])),
        deviations=damages_of(parts[0]),
        model=hot.model.loaded,
        flank="drive",
        touch=pressed,
    )
    carried = load or LEAST_LINE_LOAD * pair.face_width
    _, delta, tangent, _ = system.solve(np.full(len(parts), carried))
    unloaded, stiffness = delta, tangent * wider
    if hot.model.spring == "secant" or not load:
        unloaded = _nearest(touch_of_parts(drive, warm, 0.0)[0])
    deflection = delta if load else unloaded
    error = deflection - force / stiffness
    if hot.model.spring == "secant":
        stiffness, error = carried * wider / (delta - unloaded), unloaded
    return _about_mean(deflection), _about_mean(error), stiffness, backlash


def _nearest(touch: Touch) -> Floats:
    """The least gap [m] of the tooth pairs, (part, position)."""
    # pair by pair, which is faster than along an axis so short
    return reduce(np.minimum, np.moveaxis(touch.gap, -1, 0))


def _about_mean(curves: Floats) -> Floats:
    return np.asarray(curves - curves.mean(axis=-1, keepdims=True))


def _alone(
    hot: HotPair, part: Sequence[Deviation], phase: Floats, periods: int
) -> tuple[Floats, Floats, Floats, Floats]:
    """The curves of :func:`_curves` of one part with textbook springs, whose error is heat's."""
    curves, gap = elastic_pair(hot, part).over(phase), Clearance(hot, phase, part)
    every = (curves.transmission_error, gap.error, curves.stiffness, gap.half_backlash)
    transmission, error, stiffness, backlash = (
        np.resize(curve[0], (1, periods * phase.size)) for curve in every
    )
    return _about_mean(transmission), error, stiffness, backlash[:, ::SELDOM]


def _flat(moduli: Moduli) -> Moduli:
    return Moduli(tooth=np.ravel(moduli.tooth), body=np.ravel(moduli.body))
