"""How much memory a case needs, before it is run."""

from __future__ import annotations

from thermogear.base.errors import InputError
from thermogear.base.memory import SHARE, free_bytes
from thermogear.base.vocabulary import STATES
from thermogear.case.base import Case
from thermogear.case.case import DimensionlessCase, GearCase

_NUMBER = 8  # bytes of a float
_PATH_CURVES = 30  # curves over the path of contact, working copies included
_MESH_CURVES = 16  # curves over the mesh period, working copies included


def estimated_bytes(case: Case) -> int:
    """Memory [bytes] that curves and motions of ``case`` take, whole Python integers."""
    sim = case.simulation
    motion = 2 * sim.samples * (sim.periods + sim.sample_periods) + 10 * sim.periods
    if isinstance(case, GearCase):
        over_mesh = case.mesh_positions * case.period.mesh_periods
        curves = _PATH_CURVES * case.path_positions + _MESH_CURVES * over_mesh
        states = len(case.models) * (len(STATES) + len(case.gear_temperatures))
        return _NUMBER * states * len(case.speeds) * len(case.torques) * (curves + motion)
    points = len(case.points) if isinstance(case, DimensionlessCase) else 1
    return _NUMBER * points * motion


_POINT = 40_000  # bytes of one operating point of a thermal map, working copies included


def require_points(count: int, *, forced: bool = False, free: int | None = None) -> int:
    """Memory [bytes] of a thermal map of ``count`` points; refused above 70 % of the free."""
    needed, free = _POINT * count, free_bytes() if free is None else free
    if needed > SHARE * free and not forced:
        raise InputError(
            "map",
            f"about {needed / 2**30:.3g} GiB for {count} operating points",
            allowed=f"0..{SHARE * free / 2**30:.3g} GiB (70 % of the free memory)",
            why="the grid of speeds and torques is large",
            fix="thin it out, or pass --force",
        )
    return needed


def require_room(case: Case, *, forced: bool = False, free: int | None = None) -> int:
    """The estimate [bytes]; refused above 70 % of the free memory unless ``forced``."""
    needed, free = estimated_bytes(case), free_bytes() if free is None else free
    if needed > SHARE * free and not forced:
        raise InputError(
            "case",
            f"about {needed / 2**30:.3g} GiB of curves and motions",
            allowed=f"0..{SHARE * free / 2**30:.3g} GiB (70 % of the free memory)",
            why="the grid of speeds, torques and temperatures is large",
            fix="thin it out, keep fewer periods or samples, or pass --force",
        )
    return needed
