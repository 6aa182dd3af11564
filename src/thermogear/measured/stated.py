"""What a user states of gears and shaft: where it puts the mesh line, what stays undecided."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.base.bounds import SPEED
from thermogear.base.errors import InputError
from thermogear.measured.contradictions import of_line
from thermogear.measured.gearing import Gearing, find_gearing
from thermogear.measured.record import Notice, Record


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
    rate: float | None,
    shaft: float | None = None,
) -> Gearing | None:
    """The line at the ``expected`` place [cycles/sample], where one is there; else what the lines
    say, with the ``teeth`` given or the ``shaft`` of known speed [turns/sample]; ``rate`` [1/s]."""
    within = expected is not None and 5.0 / table.shape[-1] < expected < 0.45
    try:
        gearing = find_gearing(list(table), expected if within else None, teeth=teeth, shaft=shaft)
    except InputError as error:
        notices.append(Notice.of("no_mesh_line", reason=str(error)))
        return None
    notices += of_line(gearing)
    if gearing.off != 1.0:
        fitting = None if rate is None else rate / gearing.off
        notices.append(Notice.of("shaft_by_lines", ratio=gearing.off, rate=rate, fitting=fitting))
    return gearing


def speed_undecided(gearing: Gearing, teeth: int | None, *, speed: float | None) -> Notice | None:
    """Where the line that is read may be the mesh line of another gear than that of the ``teeth``
    given, or none: the shaft's speed is withheld, though one is given [rad/s]."""
    if teeth is None or gearing.teeth is not None:
        return None
    line = gearing.mesh_frequency
    if gearing.rival is not None:
        return Notice.of("teeth_contradicted", teeth=teeth, named=gearing.rival, line=line)
    by = "--speed" if speed is None else None
    return Notice.of("shaft_speed_undecided", teeth=teeth, line=line, by=by)
