"""The angle that orders count, with the gearing found in it: which shaft turns, and how often."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.measured.contradictions import of_pulses, of_speed, of_tacho_speed
from thermogear.measured.gearing import Gearing, find_gearing
from thermogear.measured.record import Notice
from thermogear.measured.shaft import VARIES, Shaft
from thermogear.signals.orders import resample_by_angle
from thermogear.signals.tracking import samples_per_turn

MESHES = 16.0
"""Mesh cycles that stand for a turn where no shaft is known."""

_NEAR, _MOST = 0.04, 10  # of pulses told by a stated speed


@dataclass(frozen=True, kw_only=True)
class OrderAngle:
    """The angle that orders count: ``turns`` of the first shaft, or of 16 mesh cycles."""

    turns: Floats
    first: int
    noise: float
    mesh: float | None
    of_mesh: bool
    gearing: Gearing | None
    teeth: int | None


def order_angle(
    shaft: Shaft,
    table: Floats,
    *,
    teeth: int | None,
    speed: float | None,
    rate: float | None,
    notices: list[Notice],
) -> OrderAngle:
    """Mesh line, teeth and pulses per turn in the shaft's angle.

    ``speed`` [rad/s] as stated, ``rate`` [1/s]. Pulses per turn that are not stated are those that
    the mesh line of known teeth tells, else those of a steady stated speed, else one; what
    contradicts goes to ``notices``.
    """
    turns = shaft.turns
    mean = float((turns[-1] - turns[0]) / (turns.size - 1))
    steady = shaft.span < VARIES and rate is not None
    own = 2.0 * np.pi * mean * rate if rate is not None else mean
    inside = table[:, shaft.first : shaft.first + turns.size]
    loudest = inside[np.argsort(-np.std(inside, axis=-1))[:2]]
    per_turn = samples_per_turn(turns)
    straight = [resample_by_angle(c, turns, samples_per_turn=per_turn) for c in loudest]
    near = 1.0 if shaft.line else float(teeth) if teeth and shaft.sure else None
    told_as = per_turn * mean
    gearing: Gearing | None = None
    with suppress(InputError):
        gearing = find_gearing(
            straight,
            None if near is None else near / per_turn,
            teeth=teeth,
            shaft=1.0 / per_turn if shaft.sure and not shaft.line else None,
            told_as=told_as,
        )
    mesh = None if gearing is None else gearing.mesh_frequency * per_turn
    if mesh is None and teeth and not shaft.line:
        mesh = float(teeth)
    z = _teeth_of(shaft, gearing, mesh, teeth, (speed, rate), notices)
    if steady:
        orders = [1.0, *([mesh / teeth] if mesh and teeth else [])]
        notices += of_tacho_speed(pulses=shaft.pulses, given=speed, own=own, orders=orders)
    notices += [] if mesh is None else of_pulses(shaft.pulses, mesh=mesh, teeth=teeth)
    factor = 1.0
    if shaft.line:
        factor = (mesh or 1.0) / (z or MESHES)
    elif mesh is not None and not shaft.sure and z:
        pulses = z / mesh
        if abs(pulses - round(pulses)) < 0.02 * pulses and pulses > 0.5:
            factor = 1.0 / round(pulses)
            notices.append(Notice.of("pulses_by_mesh_line", pulses=round(pulses), teeth=z))
        else:
            notices.append(Notice.of("pulses_not_stated", pulses=pulses))
            z = None
    elif not shaft.sure and steady and speed and (by := _pulses_of(own, speed)):
        factor = 1.0 / by
        notices.append(Notice.of("pulses_by_speed", pulses=by, speed=own / by))
    elif not shaft.sure:
        notices.append(Notice.of("pulses_not_stated", pulses=None))
    elif mesh is not None and teeth and z and abs(mesh / teeth - 1.0) > 0.02:
        factor = mesh / teeth
        notices.append(Notice.of("teeth_on_other_shaft", order=mesh, teeth=teeth, ratio=factor))
    return OrderAngle(
        turns=turns * factor,
        first=shaft.first,
        noise=shaft.noise * factor,
        mesh=None if mesh is None else mesh / factor if not shaft.line else z or MESHES,
        of_mesh=shaft.line and not z,
        gearing=None if gearing is None else replace(gearing, teeth=z),
        teeth=z,
    )


def _teeth_of(
    shaft: Shaft,
    gearing: Gearing | None,
    mesh: float | None,
    teeth: int | None,
    stated: tuple[float | None, float | None],
    notices: list[Notice],
) -> int | None:
    """The teeth given, or those that the lines name beside pulses that are known. None where a
    run's line that was followed may be the mesh line of another gear than theirs, whose speed is
    not the ``stated`` one [rad/s], with the rate."""
    if gearing is not None and shaft.sure and not shaft.line:
        return gearing.teeth
    if teeth is None or gearing is None or not shaft.line:
        return teeth
    speed, rate = stated
    per_sample = 2.0 * np.pi * (mesh or 1.0) / teeth * (rate or 1.0)
    low, high = (per_sample * turning for turning in shaft.speeds)
    fits = speed is not None and not of_speed(speed, lowest=low, highest=high)
    if fits or gearing.confirmed:
        return teeth
    notices.append(Notice.of("followed_line_undecided", teeth=teeth))
    return None


def _pulses_of(own: float, speed: float) -> int:
    """Pulses in a turn at this ``speed``, where ``own`` counts one as a turn; 0: no number fits."""
    ratio = own / speed
    pulses = round(ratio)
    # a stated speed is nominal: of more pulses than ten it could be one more or less
    return pulses if 0 < pulses <= _MOST and abs(ratio / pulses - 1.0) <= _NEAR else 0
