"""What a user states of gears and shaft: where it puts the mesh line, what stays undecided."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.base.bounds import SPEED
from thermogear.base.errors import InputError
from thermogear.measured.contradictions import NEAR, of_line
from thermogear.measured.gearing import Gearing, find_gearing
from thermogear.measured.record import Notice, Record

_EXACT = 0.03  # of the place of a line: a motor slips by less
_AS_CLEAR = 0.6  # of the mean log prominence of the clearest line


def expected_mesh(record: Record, teeth: int | None, speed: float | None) -> float | None:
    """Where teeth and ``speed`` [rad/s] put the mesh line [cycles/sample]; None: not known."""
    if speed is not None:
        SPEED.require("speed", speed)
        if speed == 0.0:
            raise InputError("speed", "0 rad/s", why="a gear that stands still has no line")
    if record.rate is None or teeth is None or speed is None:
        return None
    return teeth * speed / (2.0 * np.pi) / record.rate


def stated_gearing(
    table: NDArray[np.float64],
    notices: list[Notice],
    *,
    expected: float | None,
    teeth: int | None,
) -> Gearing | None:
    """The line at the ``expected`` place [cycles/sample], where one is clear there; else what the
    lines say, with the ``teeth`` given."""
    try:
        free: Gearing | None = find_gearing(list(table), teeth=teeth)
    except InputError as error:
        notices.append(Notice.of("no_mesh_line", reason=str(error)))
        free = None
    if expected is None or (free is not None and _is_expected(free, expected)):
        return free
    if not 5.0 / table.shape[-1] < expected < 0.45:
        return free
    try:
        near = find_gearing(list(table), expected, teeth=teeth)
    except InputError:
        return free  # no line is where teeth and speed put that of the mesh
    if free is not None:
        heights = [float(np.mean(np.log(line.harmonics))) for line in (near, free)]
        if heights[0] <= _AS_CLEAR * heights[1]:
            return free
        notices += of_line(near, free)
    return near


def _is_expected(free: Gearing, expected: float) -> bool:
    """Whether the line found is the one expected: a stated speed is nominal. A sideband of the mesh
    line of the teeth given may stand nearer to it."""
    off = abs(free.mesh_frequency / expected - 1.0)
    return off < _EXACT or (off <= NEAR and free.is_theirs)


def speed_undecided(
    gearing: Gearing, *, teeth: int | None, speed: float | None, rate: float | None
) -> Notice | None:
    """Where the line that is read may be the mesh line of another gear than that of the ``teeth``
    given, so that its shaft may turn otherwise: the shaft's speed is withheld.

    Not where a ``speed`` [rad/s] is given that fits the line, nor where the line has the sidebands
    of these teeth or no other line may be theirs.
    """
    if teeth is None or gearing.is_theirs:
        return None
    shaft = gearing.mesh_frequency / teeth
    if speed is not None and rate and abs(2.0 * np.pi * shaft * rate / speed - 1.0) <= NEAR:
        return None
    return Notice.of("shaft_speed_undecided", teeth=teeth, line=gearing.mesh_frequency)
