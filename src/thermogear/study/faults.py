"""Motion over a whole turn of gears with faults, beside that of the same gears without them.

What a study of detection asks: the acceleration of the teeth and the force between them over the
angles of both gears, at any speed, torque and temperature and for any part of a series.
Checked by ``tests/study/test_faults.py``: no fault, another tooth, the exact engine.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base import fourier
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import GearCase
from thermogear.case.family import family
from thermogear.case.points import Points
from thermogear.case.thermal_state import HOT, StateLike
from thermogear.case.turn_response import SAMPLES, turn_lanes, turn_tables
from thermogear.dynamics.turns import STEPS, follow_turns, record_turns
from thermogear.mesh.excite import over_turn as spread
from thermogear.signals.spectra import Spectrum, amplitude_spectrum
from thermogear.study.series import series_parts

HIGHEST, MOST_DOUBLINGS = 2.0, 4
"""Lines are kept up to so many natural frequencies at least (chosen): up to 4 and 12 of them add
about 10 and 35 % to the rms of a slow pair's acceleration, as flanks that meet on a corner excite
all. So often is doubled at most: down to a mesh frequency of 1/192 of the natural one (chosen:
seconds for a turn of 22 mesh periods); slower, the natural vibration is left out."""
HARMONICS, POSITIONS = 24, 10
"""Harmonics of a mesh period that its steps resolve, doubled with these; positions of the contact
in a period of the highest, as by default: 20 move the acceleration of a pair at a fourteenth of its
resonance speed by 3 %."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TurnMotion:
    """One settled motion over ``turns`` whole turns of the pair, uniform samples, SI.

    ``speed`` [rad/s] and ``torque`` [N m] of the pinion; ``mesh_periods`` of a turn; ``teeth`` of
    pinion and wheel; ``status`` a word of :data:`~thermogear.base.vocabulary.STATUS`, arrays are
    nan where it moves not. From mesh phase 0 on, ``samples`` a mesh period: ``acceleration``
    [m/s^2] x'' + e'' of the pinion's flanks towards the wheel's along the line of action,
    (F - k f(x) - c x')/m_e; ``mesh_force`` [N] k f(x), < 0 on the back flanks; ``error`` [m] the
    dynamic transmission error x + e. ``repeats``: whether it comes again after these turns.
    ``bearing_force`` (sample, bearing, 2) [N] on the outer rings of a drive train, else None.
    """

    speed: float
    torque: float
    status: str
    mesh_periods: int
    teeth: tuple[int, int]
    samples: int
    turns: int
    repeats: bool
    acceleration: Floats
    mesh_force: Floats
    error: Floats
    bearing_force: Floats | None = None

    @property
    def phase(self) -> Floats:
        """Mesh phase [periods] of each sample: tooth n, from 0, of each gear enters at n."""
        return np.arange(self.acceleration.size) / self.samples

    @property
    def pinion_angle(self) -> Floats:
        """How far the pinion has turned [rad]."""
        return 2.0 * np.pi * self.phase / self.teeth[0]

    @property
    def wheel_angle(self) -> Floats:
        """How far the wheel has turned [rad]."""
        return 2.0 * np.pi * self.phase / self.teeth[1]

    def lines(self, name: str = "acceleration") -> Spectrum:
        """Lines (peak amplitudes) of a curve by its ``name`` over orders of the mesh."""
        return amplitude_spectrum(getattr(self, name), float(self.samples))


@dataclass(frozen=True, eq=False)
class FaultMotion:
    """The motion with the faults of a case and that without them, over the same turn."""

    faulty: TurnMotion
    sound: TurnMotion


def fault_motions(
    case: GearCase,
    speed: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    *,
    part: int | None = None,
    state: StateLike = HOT,
    samples: int | None = None,
) -> tuple[FaultMotion, ...]:
    """Settled motions over the turn at each ``speed`` [rad/s] and ``torque`` [N m] of the pinion.

    Numbers or arrays that broadcast; the case's points if left out. ``part``: of the series of the
    case's class, from 0, else the part of the case; ``state``: "hot", "undeformed" or the gears'
    temperature [K]. ``samples`` of a mesh period, a divisor of 192; by default 96, four in a
    period of the highest harmonic. Harmonics are those of the case, 24 by default; of slow pairs
    48 to 384, on as many more positions and samples, so that they reach :data:`HIGHEST` natural
    frequencies (:func:`resolving`). With faults and without all else is the same, the drawing too;
    a sound pair of a shorter period is followed over the whole turn. Motions start from rest at the
    greatest error; where a second motion is possible that one alone is seen. InputError without
    faults, and for textbook springs, which feel none.

    >>> from thermogear.case.case import load_case
    >>> faults = {"faults": '[{kind = "crack", gear = "pinion", tooth = 3, depth = "2 mm"}]'}
    >>> case = load_case("rig", {"model.bundle": "consistent", **faults})
    >>> (motion,) = fault_motions(case, 100.0, 200.0, state="undeformed")
    >>> motion.faulty.mesh_periods, motion.faulty.acceleration.shape == motion.sound.phase.shape
    (25, True)
    """
    if samples is not None and (samples < 1 or STEPS % samples):
        raise InputError("samples", samples, allowed=f"a divisor of {STEPS}")
    if not case.file.faults or (case.all_faults and not case.faults()):
        raise InputError("faults", "none", fix="state [[faults]] in the case")
    if case.models[0].stiffness != "loaded":
        raise InputError("model.stiffness", case.models[0].stiffness, allowed="loaded")
    at = case.stated
    operating = np.broadcast_arrays(
        at.speed if speed is None else speed, at.torque if torque is None else torque
    )
    rows = np.stack([np.ravel(values).astype(float) for values in operating], axis=1)
    axes = ("pinion_speed", "pinion_torque")
    sound = case.sound()
    alike = family(sound.mean_tooth(), axes, state=state)(rows)
    with np.errstate(invalid="ignore"):
        finer = doublings(alike.rate / alike.mesh_frequency)
    found: dict[int, FaultMotion] = {}
    for power in np.unique(finer).tolist():
        index, both = np.flatnonzero(finer == power), []
        for pair in (case, sound):
            flanks = pair.deviations if part is None else series_parts(pair, part + 1)[part]
            drawn = replace(resolving(pair, power), deviations=flanks)
            both.append(family(drawn, axes, state=state)(rows[index]))
        turn = max(points.mesh_periods for points in both)
        several = (
            turn_motions(case, over_turns(points, turn), rows[index], samples, doubled=power)
            for points in both
        )
        found |= zip(index.tolist(), map(FaultMotion, *several), strict=True)
    return tuple(found[place] for place in range(len(rows)))


def doublings(ratio: Floats) -> NDArray[np.int64]:
    """How often :data:`HARMONICS` are doubled to reach :data:`HIGHEST` natural frequencies.

    ``ratio`` of the natural to the mesh frequency; nan, of a point that does not move, asks none.

    >>> doublings(np.array([np.nan, 12.0, 13.0, 1e3]))
    array([0, 0, 1, 4])
    """
    needed = np.nan_to_num(HIGHEST * ratio / HARMONICS, nan=1.0)
    return np.asarray(np.ceil(np.log2(np.clip(needed, 1.0, 2.0**MOST_DOUBLINGS))).astype(int))


def resolving(case: GearCase, power: int) -> GearCase:
    """The case with :data:`HARMONICS` doubled so often, where it has fewer, and its mesh at
    positions that resolve them; as it is where there is nothing to double."""
    harmonics = max(case.harmonics, HARMONICS * 2**power)
    positions = max(case.mesh_positions, POSITIONS * harmonics)
    return replace(case, harmonics=harmonics, mesh_positions=positions) if power else case


def over_turns(points: Points, mesh_periods: int) -> Points:
    """The same points over a period of ``mesh_periods``, a multiple of their own."""
    times = mesh_periods // points.mesh_periods
    flat = points.flat
    of_turn = replace(
        flat,
        period=flat.period * times,
        stiffness=spread(flat.stiffness, times),
        force=spread(flat.force, times),
        mesh_periods=mesh_periods,
    )
    return replace(points, flat=of_turn, error=spread(points.error, times))


def turn_motions(
    case: GearCase, points: Points, rows: Floats, samples: int | None, *, doubled: int = 0
) -> list[TurnMotion]:
    """The motion at each of ``points``, which have the speeds [rad/s] and torques [N m] of
    ``rows`` (point, 2); ``samples`` of a mesh period, by default :data:`SAMPLES`, ``doubled`` so
    often as their harmonics are. What :func:`fault_motions` is made of."""
    every = STEPS * 2**doubled
    samples = samples or SAMPLES * 2**doubled
    turn, teeth = points.mesh_periods, (case.pair.pinion.teeth, case.pair.wheel.teeth)
    whole = np.full(turn * samples, np.nan)
    recorded = [
        TurnMotion(
            speed=float(speed), torque=float(torque), status=STATUS[status], mesh_periods=turn,
            teeth=teeth, samples=samples, turns=1, repeats=False, acceleration=whole,
            mesh_force=whole, error=whole,
        )
        for (speed, torque), status in zip(rows, points.status, strict=True)
    ]  # fmt: skip
    moving = np.flatnonzero(~points.still)
    for index, tables in turn_tables(points.take(moving)):
        here = moving[index]
        lanes = turn_lanes(points.take(here))
        motions = follow_turns(tables, lanes, np.zeros((here.size, 2)))
        for number, place in enumerate(here):
            lane, point = lanes.take(np.array([number])), points.take(np.array([place]))
            repeats = int(motions.period[number])
            _, x, _ = record_turns(
                tables, lane, motions.state[number], turns=max(repeats, 1), samples=every
            )
            curves = {
                name: curve[:: every // samples]
                for name, curve in _curves(point, x, max(repeats, 1)).items()
            }
            recorded[place] = replace(
                recorded[place], turns=max(repeats, 1), repeats=repeats > 0, **curves
            )
    return recorded


def _curves(point: Points, x: Floats, turns: int) -> dict[str, Floats]:
    """Acceleration, force and error in SI of one motion ``x`` [half backlashes], so many turns."""
    count = x.size // turns
    stiffness, error = (
        np.tile(fourier.sampled(rows, count)[0], turns)
        for rows in (point.flat.stiffness, point.error)
    )
    b, length = point.flat.half_backlash[0], point.length[0]
    elastic = stiffness * (x - np.clip(x, -b, b))
    # of a motion that does not come again the step at the ends is in it: damping alone feels it
    orders = 2j * np.pi * np.fft.rfftfreq(x.size, point.flat.period[0] / count)
    velocity = np.fft.irfft(np.fft.rfft(x) * orders, x.size)
    pushed = point.flat.force[0, 0].real - elastic - point.flat.damping[0] * velocity
    return {
        "acceleration": length * point.rate[0] ** 2 * pushed,
        "mesh_force": point.stiffness[0] * length * elastic,
        "error": length * x + error,
    }
