"""The drive train of a case at one operating point in one state of heat, at rest under its load.

Slow feedback: the deflected shafts move the centres apart, the mesh at that distance has another
stiffness, which deflects the shafts again; a few rounds close it.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from thermogear.base.arrays import Complexes, Floats
from thermogear.base.errors import GeometryError, InputError, ValidityWarning
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import HEAT_NOT_SETTLED, STATUS, moves, still
from thermogear.case.case import GearCase, gear_case
from thermogear.case.shaft_plan import TrainPlan
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.gears.pair import GearPair, tight_distance
from thermogear.mesh.cycle import mesh_cycle
from thermogear.mesh.excite import EXCITES, excitations
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.shafts.assembly import Assembly, assemble
from thermogear.shafts.linear import LinearTrain
from thermogear.shafts.response import loaded_error
from thermogear.shafts.statics import Equilibrium, equilibrium

STATES = (UNDEFORMED, HOT)
"""What every study of shafts shows side by side."""
MOST_POINTS = 6
"""Operating points of one study, at most."""
MOST_ROUNDS = 8
CLOSED = 1e-9
"""Change of the centre distance [m] that ends the rounds."""
JAMMED, NOT_CONVERGED = STATUS.index("jammed"), STATUS.index("not_converged")


@dataclass(frozen=True, eq=False, kw_only=True)
class Meshing:
    """The mesh at one centre distance: ``stiffness`` (phase,) [N/m] and harmonics of k and e.

    ``half_backlash`` b' [m] of the teeth at that distance. ``status`` as of a mesh cycle.
    """

    pair: GearPair
    stiffness: Floats
    stiffness_harmonics: Complexes
    error_harmonics: Complexes
    half_backlash: float
    status: int


@dataclass(frozen=True, eq=False, kw_only=True)
class TrainState:
    """A drive train at rest under its load.

    ``mesh`` at the actual centre distance, ``half_backlash`` b' [m] at the drawn one; ``growths``
    [m] of that distance by the shafts' deflection, round by round; ``half_plays`` [m] and
    ``temperatures`` [K] (inner ring, elements, outer ring) of every bearing, nan where it has none.
    ``status`` is a place in
    :data:`~thermogear.base.vocabulary.STATUS`; where it is not 0 the ``equilibrium`` may be None.
    """

    state: ThermalState
    place: int
    speed: float
    torque: float
    assembly: Assembly
    mesh: Meshing
    half_backlash: float
    growths: tuple[float, ...]
    half_plays: Floats
    temperatures: Floats
    equilibrium: Equilibrium | None
    status: int

    @property
    def rest(self) -> Equilibrium:
        """The equilibrium; InputError where there is none."""
        if self.equilibrium is None:
            raise still(self.status, self.state.words)
        return self.equilibrium

    @property
    def band(self) -> tuple[float, float, float]:
        """Least, mean and greatest mesh stiffness over the mesh period [N/m]."""
        k = self.mesh.stiffness
        return float(k.min()), float(k.mean()), float(k.max())

    @cached_property
    def linear(self) -> LinearTrain:
        """The train linear about its equilibrium, at mean mesh stiffness."""
        return self.rest.linear()

    @property
    def loaded_error(self) -> Complexes:
        """Harmonics [m] of the error that drives the linear train."""
        return loaded_error(
            self.mesh.stiffness_harmonics,
            self.mesh.error_harmonics,
            mean_stiffness=self.band[1],
            mean_force=self.rest.mesh_force,
        )


def plan_of(case: GearCase) -> TrainPlan:
    """The shafts of a case; InputError where it has none."""
    train = gear_case(case).train
    if train is None:
        raise InputError(
            "shafts",
            "nothing",
            why="the case has a gear pair alone",
            fix="describe [[shafts]] and [[bearings]], or begin with `thermogear new --shafts`",
        )
    return train


def require_standing(case: GearCase, motion: str) -> None:
    """Refuse cages that turn for a ``motion`` that has to come again."""
    if plan_of(case).cage_slip < 1.0:
        raise InputError(
            "train.cages",
            "turning",
            allowed=f"standing for a train {motion}",
            why="its motions come again after whole mesh periods, and cages never do",
            fix='write cages = "standing", or take `run` or `waterfall`',
        )


def places_of(case: GearCase, *, most: int = MOST_POINTS) -> list[int]:
    """The operating points of a study: all, of many an even spread with the hardest."""
    at = case.stated
    spread = np.linspace(0, at.speed.size - 1, min(at.speed.size, most)).round().astype(int)
    hardest = int(np.argmax(at.speed * at.torque))
    if hardest not in spread:
        spread[int(np.argmin(np.abs(spread - hardest)))] = hardest
    return sorted(set(spread.tolist()))


def settled(
    case: GearCase,
    places: Sequence[int],
    *,
    states: Sequence[ThermalState] = STATES,
    model: MeshModel | None = None,
    progress: Progress = silent,
) -> list[list[TrainState]]:
    """The drive train at every one of ``places``, in every one of ``states``: [state][place].

    ``model`` of the mesh, the case's first if left out. Of gears whose teeth differ the mean tooth.
    Raises InputError for a case without shafts and for shafts that nothing holds.
    """
    plan, case = plan_of(case), case.mean_tooth()
    chosen = case.models[0] if model is None else model
    whole = len(states) * len(places)
    found = []
    for number, state in enumerate(states):
        at = replace(state.operating(case, chosen), housing=case.housing)
        balance = None if state == UNDEFORMED else state.balance(case, chosen)
        rings = plan.bearing_temperatures(at, balance)
        row = []
        for count, place in enumerate(places):
            progress("shafts", number * len(places) + count, whole)
            known = state.settled(case, chosen, place)
            row.append(_settled(case, chosen, state, at, place, rings[place], known))
        found.append(row)
    progress("shafts", whole, whole)
    return found


def _settled(
    case: GearCase,
    model: MeshModel,
    state: ThermalState,
    every: Operating,
    place: int,
    temperatures: Floats,
    known: bool,
) -> TrainState:
    plan, at = plan_of(case), every.point(place)
    half_plays = plan.half_plays(temperatures, reference=at.temperatures.reference)
    assembly = assemble(plan.drive_train(pair=case.pair, half_plays=half_plays))
    mesh = meshing(case, model, case.pair, at)
    backlash = mesh.half_backlash
    growths: list[float] = []
    rest = None
    while known and mesh.status != NOT_CONVERGED:
        rest = equilibrium(
            assembly,
            float(at.torque[0]),
            mesh=float(mesh.stiffness.mean()),
            half_backlash=backlash,
            start=None if rest is None else rest.displacement,
        )
        growths.append(rest.centre_distance_growth)
        before = growths[-2] if len(growths) > 1 else 0.0
        if abs(growths[-1] - before) <= CLOSED or len(growths) == MOST_ROUNDS:
            break
        mesh = meshing(case, model, moved_apart(case.pair, growths[-1]), at)
    status = mesh.status if known else HEAT_NOT_SETTLED
    if rest is not None and moves(status) and rest.back_force > 0.0:
        status = JAMMED
    return TrainState(
        state=state,
        place=place,
        speed=float(at.speed[0]),
        torque=float(at.torque[0]),
        assembly=assembly,
        mesh=mesh,
        half_backlash=backlash,
        growths=tuple(growths),
        half_plays=half_plays,
        temperatures=temperatures,
        equilibrium=rest,
        status=status,
    )


def meshing(case: GearCase, model: MeshModel, pair: GearPair, at: Operating) -> Meshing:
    """The mesh of the case's gears at the centre distance of ``pair``, at one operating point."""
    with warnings.catch_warnings(action="ignore", category=ValidityWarning):
        cycle = mesh_cycle(
            pair,
            at,
            model,
            deviations=case.deviations,
            mesh_positions=case.mesh_positions,
            want=EXCITES,
        )
    found = excitations(
        cycle,
        pair,
        damping_ratio=case.damping_ratio,
        inertias=case.inertias,
        transmission_error=case.transmission_error,
        harmonics=case.harmonics,
    )
    return Meshing(
        pair=pair,
        stiffness=np.asarray(cycle["mesh_stiffness"], dtype=float)[0],
        stiffness_harmonics=found.stiffness[0, 1:],
        error_harmonics=found.error[0, 1:],
        half_backlash=float(found.half_backlash[0]),
        status=int(found.status[0]),
    )


def moved_apart(pair: GearPair, growth: float) -> GearPair:
    """The pair with its centres ``growth`` [m] further apart; where it cannot mesh so, as drawn.

    Centres that come closer than the mesh without backlash stay at it.
    """
    tightest = tight_distance(pair.pinion, pair.wheel)
    try:
        return replace(pair, centre_distance=max(pair.centre_distance + growth, tightest))
    except GeometryError:
        return pair
