"""What a user states of gears and shaft: as evidence, as a place, and what it does not decide."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.base.bounds import SPEED
from thermogear.base.errors import InputError
from thermogear.measured.contradictions import NEAR, of_line, of_mate, of_teeth
from thermogear.measured.gearing import Gearing, find_gearing
from thermogear.measured.meshes import Stated
from thermogear.measured.rate_check import SURE
from thermogear.measured.record import Notice, Record

_MAINS = (50.0, 60.0)  # Hz
_LEAST_TURNS = 1.0


def expected_mesh(record: Record, teeth: int | None, speed: float | None) -> float | None:
    """Where teeth and ``speed`` [rad/s] put the mesh line [cycles/sample]; None: not known."""
    if speed is not None:
        SPEED.require("speed", speed)
        if speed == 0.0:
            raise InputError("speed", "0 rad/s", why="a gear that stands still has no line")
    if record.rate is None or teeth is None or speed is None:
        return None
    return teeth * speed / (2.0 * np.pi) / record.rate


def stated_of(record: Record, teeth: int | None, speed: float | None) -> Stated:
    """Teeth, ``speed`` [rad/s] and the mains' frequencies as evidence."""
    if record.rate is None:
        return Stated(teeth=teeth)
    shaft = None if speed is None else speed / (2.0 * np.pi) / record.rate
    return Stated(teeth=teeth, shaft=shaft, mains=tuple(f / record.rate for f in _MAINS))


def stated_gearing(
    table: NDArray[np.float64], notices: list[Notice], expected: float | None, stated: Stated
) -> Gearing | None:
    """What the lines say, with what is stated as evidence; the expected place only where a line
    is clear there as well."""
    try:
        free: Gearing | None = find_gearing(list(table), stated=stated)
    except InputError as error:
        notices.append(Notice.of("no_mesh_line", reason=str(error)))
        free = None
    if expected is None or (free and (_is_expected(free, expected) or _is_of_mate(free, stated))):
        return free
    if 5.0 / table.shape[-1] < expected < 0.45:
        try:
            near = find_gearing(list(table), expected, stated)
        except InputError:
            return free  # nothing stands where teeth and speed put the mesh line
        heights = [float(np.mean(np.log(g.harmonics))) for g in (near, free) if g is not None]
        if len(heights) == 1 or heights[0] > 0.6 * heights[1]:
            weighed = near.weighed
            if weighed.mesh_weight >= SURE and (
                said := of_line(near.mesh_frequency, found=weighed.mesh, weight=weighed.mesh_weight)
            ):
                notices.append(said)
            return near
    return free


def _is_expected(free: Gearing, expected: float) -> bool:
    """Whether the line found is the one expected: a stated speed is nominal. A sideband of a line
    beyond doubt may stand nearer to it."""
    off = abs(free.mesh_frequency / expected - 1.0)
    sure = free.weighed.mesh_weight >= SURE
    return off < 0.03 or (off <= NEAR and sure)


def _is_of_mate(free: Gearing, stated: Stated) -> bool:
    """Whether the speed stated is that of the mate of the gear stated: of a mate of half or a third
    of the teeth these two put the mesh line at a harmonic, where a line is as well."""
    if stated.teeth is None or stated.shaft is None:
        return False
    shaft = 2.0 * np.pi * free.mesh_frequency / stated.teeth
    speed = 2.0 * np.pi * stated.shaft
    return _of_two_gears(free, teeth=stated.teeth, speed=speed, shaft=shaft) is not None


def settled_teeth(gearing: Gearing | None, teeth: int | None, notices: list[Notice]) -> int | None:
    """The teeth given, else those found; told where these contradict each other."""
    if gearing is None:
        return teeth
    if (said := of_teeth(teeth, [shaft.teeth for shaft in gearing.shafts])) is not None:
        notices.append(said)
    return gearing.teeth if teeth is None else teeth


def speed_undecided(
    gearing: Gearing,
    *,
    teeth: int | None,
    speed: float | None,
    rate: float | None,
    samples: int,
) -> Notice | None:
    """Where the line that is read may be the mesh line of another gear than that of the ``teeth``
    given, so that its shaft may turn otherwise: the shaft's speed is withheld.

    Not where a ``speed`` [rad/s] is given that fits the line. One that fits the mate of the gear
    of the ``teeth`` given says something else than these: which shaft is meant is not decided. A
    comb is no mesh line of theirs where the gear turned less than once in the ``samples``.
    """
    if teeth is None:
        return None
    shaft = gearing.mesh_frequency / teeth
    if speed is not None and rate:
        turns = 2.0 * np.pi * shaft * rate
        if abs(turns / speed - 1.0) <= NEAR:
            return None
        if (crossed := _of_two_gears(gearing, teeth=teeth, speed=speed, shaft=turns)) is not None:
            return crossed
    least = _LEAST_TURNS * teeth / samples
    share = gearing.weighed.share_of(gearing.mesh_frequency, teeth=teeth, least=least)
    if share >= SURE:
        return None
    return Notice.of(
        "shaft_speed_undecided", teeth=teeth, line=gearing.mesh_frequency, weight=share
    )


def _of_two_gears(gearing: Gearing, *, teeth: int, speed: float, shaft: float) -> Notice | None:
    """Where the teeth given are of one gear of the mesh and the ``speed`` [rad/s] of the other."""
    on_line = list(gearing.weighed.teeth)
    if teeth not in on_line:
        return None  # teeth that are not found are told of as such
    return of_mate(teeth, speed=speed, shaft=shaft, found=on_line)
