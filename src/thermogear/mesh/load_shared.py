"""From the loaded contact to one spring for each tooth pair, drive and back flanks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.pair_springs import PairSprings
from thermogear.gears.candidates import mesh_points
from thermogear.gears.contact import mirror_position
from thermogear.gears.deviations import Deviation
from thermogear.gears.loaded import LoadedMesh, solve_mesh
from thermogear.gears.stiffness import Moduli
from thermogear.gears.touch import first_touch
from thermogear.gears.turn import mean_tooth
from thermogear.mesh.elastic import LoadedPair
from thermogear.mesh.thermal import HotPair, ThermalDeviation

RELATIVE_STEP = 0.01
"""Loads around the mean load between which a pair's stiffness is read."""
LADDER = 1.25 ** np.arange(1, 13)
"""Loads over the mean load at which pairs beyond the loaded ones are sought, up to 15 times."""
OUT_OF_REACH = -1e-3
"""Added material [m] of a pair that never touches: a millimetre missing."""
FLANKS = ("drive", "back")


def pair_springs(
    hot: HotPair,
    operating: int = 0,
    deviations: Sequence[Deviation] = (),
    *,
    flank: str = "drive",
    positions: int = 240,
) -> PairSprings:
    """The springs of every tooth pair at one operating point, from the loaded contact.

    k_j = dF_j/d delta at the mean load, S_j = F_j/k_j - delta: at the mean load every pair
    carries its exact share with its exact slope, and their sum is the mesh's tangent
    stiffness. A pair that the mean load leaves free takes touch and slope from the first
    greater load that reaches it. Heat and ``deviations`` are in S_j with their mean, so that
    the backlash used with them is the cold one. Where teeth differ or a gear is eccentric the
    springs are those of the mean tooth (:func:`~thermogear.gears.turn.mean_tooth`): of one mesh
    period, whose spread over the turn they do not know. The force begins where the tightest pair
    touches (:func:`~thermogear.gears.touch.first_touch`), halfway to the mean load's deflection the
    springs take over: free play and jam are those of :func:`~thermogear.mesh.clearance.Clearance`.

    ``operating`` the place of the operating point in ``hot``, ``flank`` "drive" or "back",
    ``positions`` samples of the mesh phase. Raises InputError for a torque of 0, where no load
    says how stiff a contact is, and ConvergenceError where the contact does not settle.
    """
    if flank not in FLANKS:
        raise InputError("flank", repr(flank), allowed=" | ".join(FLANKS))
    pair = hot.pair
    mean = float(LoadedPair(hot).force[operating])
    if not mean > 0.0:
        raise InputError(
            "operating.torque", "0 N m", allowed="> 0 N m", why="a contact without load is soft"
        )
    local = np.arange(positions) / positions
    # back flanks run against the path: their own phase is the mirror's less the mesh phase, its
    # whole samples alone, so that samples of both flanks fall on the same mesh phases
    offset = (mirror_position(pair) - 2.0 * pair.path.a) / pair.base_pitch
    offset = math.floor(offset * positions) / positions
    phase = local if flank == "drive" else offset - local
    # away from whole phases, where rounding decides which pair enters
    phase = phase + (1e-12 if flank == "drive" else -1e-12)
    deviations = mean_tooth(pair, deviations)
    small = np.array([1.0 - RELATIVE_STEP, 1.0, 1.0 + RELATIVE_STEP])
    loads = mean * np.concatenate([small, LADDER])
    solved = contact_at(hot, operating, loads, phase, deviations, flank=flank)
    stiffness, added = _springs(solved.checked())
    springs = (
        PairSprings.from_samples(stiffness.T, added.T)
        if flank == "drive"
        else PairSprings.from_samples(stiffness.T, added.T, offset=offset, direction=-1)
    )
    heat = ThermalDeviation(replace(hot, operating=hot.operating.point(operating)))
    touch = first_touch(mesh_points(pair, local, flank), (*deviations, heat)).gap[0].min(axis=-1)
    knee = 0.5 * (np.maximum(touch, springs.touch(local)) + springs.deflection(mean, local))
    return replace(springs, foot=np.stack([touch, knee]))


def contact_at(
    hot: HotPair,
    operating: int,
    loads: Floats,
    phase: Floats,
    deviations: Sequence[Deviation] = (),
    *,
    flank: str = "drive",
) -> LoadedMesh:
    """The loaded contact of one operating point's moduli and heat under any ``loads`` [N].

    Shapes of the flanks are averaged over the half width of the point's own load at all of them.
    Whole mesh periods of ``phase`` choose the teeth.
    """
    one = replace(hot, operating=hot.operating.point(operating))
    moduli = [
        Moduli(tooth=np.ravel(m.tooth)[0], body=np.ravel(m.body)[0]) for m in LoadedPair(one).moduli
    ]
    return solve_mesh(
        hot.pair,
        loads,
        phase,
        pinion=moduli[0],
        wheel=moduli[1],
        deviations=(*deviations, ThermalDeviation(one)),
        model=hot.model.loaded,
        flank=flank,
        mean_load=LoadedPair(one).force[0],
    )


def _springs(solved: LoadedMesh) -> tuple[Floats, Floats]:
    """k_j and S_j, (position, pair), from loads below, at, above the mean and up the ladder."""
    force, delta = solved.force, solved.deflection
    slope = (force[2] - force[0]) / (delta[2] - delta[0])[:, None]
    carries = np.all(force[:3] > 0.0, axis=0) & (slope > 0.0)
    stiffness = np.where(carries, slope, 0.0)
    added = np.full_like(stiffness, OUT_OF_REACH)
    middle = delta[1][:, None]
    added[carries] = (force[1] / np.where(carries, slope, 1.0) - middle)[carries]
    # free at the mean load: the first two greater loads that this pair feels
    waiting = ~carries
    for step in range(2, force.shape[0] - 1):
        rise = (delta[step + 1] - delta[step])[:, None]
        climb = (force[step + 1] - force[step]) / rise
        reached = waiting & (force[step] > 0.0) & (climb > 0.0)
        stiffness[reached] = climb[reached]
        touch = force[step] / np.where(reached, climb, 1.0) - delta[step][:, None]
        added[reached] = touch[reached]
        waiting &= ~reached
    return stiffness, np.maximum(added, OUT_OF_REACH)
