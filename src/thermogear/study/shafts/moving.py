"""A drive train in motion: the equations of one operating point in one state of heat."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import lcm

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.excitation import FrictionSplit, Periodic
from thermogear.case.case import GearCase
from thermogear.case.shaft_plan import TrainPlan
from thermogear.dynamics.geared import GearedModel, LocalBearing, OuterForce, Wobble
from thermogear.mesh.tooth_friction import friction_split
from thermogear.shafts.assembly import Assembly
from thermogear.shafts.bearings.laws import ElementLaw, RingLaw
from thermogear.shafts.reduction import Reduction, reduced, usual
from thermogear.shafts.response import run_out_errors, unbalance_pull
from thermogear.shafts.train import SHAFTS
from thermogear.study.shafts.state import TrainState, plan_of

LONGEST = 4000
"""Mesh periods that a motion is followed for at most where shafts turn forces with them."""
HELD_MODES = 16
"""Modes kept with the interface held, where the number of coordinates is left out."""
FRICTION = 1e-3
"""Accuracy of the friction functions, over their greatest value; the coefficient is known less."""
LEAST_HELD = 0.02
"""Of the mesh stiffness: what the linear system behind holds an idle bearing with."""


@dataclass(frozen=True, eq=False, kw_only=True)
class MovingTrain:
    """A drive train in motion at one operating point, in one state of heat.

    ``model`` of its equations in the coordinates of ``reduction``; ``start``: the state at rest
    with the mesh at its mean stiffness; ``friction`` of the teeth, None where it is left out.
    """

    state: TrainState
    model: GearedModel
    reduction: Reduction
    start: Floats
    friction: FrictionSplit | None

    @property
    def turning(self) -> bool:
        """Whether cages turn."""
        return any(one.order != 0.0 for one in self.model.bearings)

    @property
    def forced(self) -> bool:
        """Whether cages, or shafts, do not come back in place while a motion is followed."""
        return self.model.cage_cycle == 0 or self.model.cycle > LONGEST

    def at_speed(self, case: GearCase, speed: float) -> MovingTrain:
        """The same mesh and bearings at another ``speed`` [rad/s] of the pinion."""
        there = replace(self.state, speed=speed)
        return moving(case, there, reduction=self.reduction, friction=self.friction)


def rubbing(case: GearCase, state: TrainState) -> FrictionSplit | None:
    """Friction of the case's teeth at the operating point and in the heat of ``state``."""
    model = case.models[0]
    at = state.state.operating(case, model).point(state.place)
    (found,) = friction_split(
        state.mesh.pair, at, model, deviations=case.deviations, accuracy=FRICTION
    )
    return found


def moving(
    case: GearCase,
    state: TrainState,
    *,
    coordinates: int | None = None,
    reduction: Reduction | None = None,
    friction: FrictionSplit | None = None,
) -> MovingTrain:
    """The equations of motion of ``state``, in so many ``coordinates`` or those of ``reduction``.

    Left out: the interface and 16 modes. Stiffness, error and clearances are those at the deflected
    centre distance and in that state of heat; the centres' motion opens the flanks by itself.
    Raises InputError where the point has no equilibrium or does not turn.
    """
    if not state.speed > 0.0:
        raise InputError(
            "operating.speed",
            "0 rpm",
            allowed="> 0 rpm for motion",
            why="nothing excites a train that does not turn",
        )
    assembly, rest = state.assembly, state.rest
    kept = reduction
    if kept is None:
        most = usual(assembly, HELD_MODES)
        kept = reduced(assembly, most if coordinates is None else coordinates)
    linear = rest.linear()
    omega = assembly.frame.sense * state.speed
    plan, teeth = plan_of(case), (case.pair.pinion.teeth, case.pair.wheel.teeth)
    stiffness, bearings = _bearings(state, kept, plan.cage_orders(teeth))
    damping = linear.damping + omega * assembly.gyroscopic
    fall, lag = assembly.slip
    slip = None
    if fall > 0.0:
        turn = assembly.unit("motor.tz")
        if lag > 0.0:
            slip = (kept.vector(turn), fall, lag)
        else:
            damping = damping + fall * np.outer(turn, turn)
    columns = None
    if friction is not None:
        six = np.concatenate([assembly.at_gear(s)[:, [0, 1, 4]] for s in SHAFTS], axis=-1)
        columns = np.stack([kept.vector(six @ one) for one in assembly.frame.friction_columns])
    outer, wobbles, cycle = shaft_orders(plan, assembly, kept)
    mesh = state.mesh
    model = GearedModel(
        mass=kept.matrix(assembly.mass),
        damping=kept.matrix(damping),
        stiffness=kept.matrix(stiffness),
        force=kept.vector(assembly.end_torques(state.torque) + assembly.weight),
        drive=kept.vector(assembly.drive),
        back=kept.vector(assembly.back),
        mesh_stiffness=Periodic(state.band[1], tuple(mesh.stiffness_harmonics)),
        error=Periodic(0.0, tuple(mesh.error_harmonics)),
        half_backlash=state.half_backlash,
        mesh_damping=linear.mesh_damping,
        mesh_frequency=case.pair.pinion.teeth * state.speed / (2.0 * np.pi),
        bearings=bearings,
        friction=columns,
        friction_at_pitch=None if friction is None else friction.at_pitch,
        friction_per_metre=None if friction is None else friction.per_metre,
        outer=outer,
        wobbles=wobbles,
        slip=slip,
        cycle=cycle,
    )
    model = replace(model, cycle=lcm(cycle, model.cage_cycle or 1))
    start = np.zeros(model.dimension)
    start[: model.size] = kept.coordinates(rest.displacement)
    return MovingTrain(state=state, model=model, reduction=kept, start=start, friction=friction)


def _bearings(
    state: TrainState, kept: Reduction, cages: list[float]
) -> tuple[Floats, tuple[LocalBearing, ...]]:
    """Stiffness (n, n) of the train with its linear bearings; the others as contacts.

    ``cages``: turns of every bearing's cage in a mesh period.
    """
    stiffness = state.assembly.stiffness.copy()
    found = []
    for place, tangent, order in zip(
        state.assembly.bearings, state.rest.bearing_stiffness, cages, strict=True
    ):
        law = place.bearing.law
        if law.linear:
            stiffness += place.directions @ law.stiffness(np.zeros(2)) @ place.directions.T
            continue
        assert isinstance(law, RingLaw | ElementLaw)
        rolling = law if isinstance(law, ElementLaw) else None
        held, axes = np.linalg.eigh(0.5 * (tangent + tangent.T))
        held = np.maximum(held, LEAST_HELD * state.rest.mesh_stiffness)
        found.append(
            LocalBearing(
                directions=kept.vector(place.directions),
                coefficient=law.coefficient,
                exponent=law.exponent,
                clearance=law.clearance,
                elements=0 if rolling is None else rolling.elements,
                angle=0.0 if rolling is None else rolling.cage_angle,
                order=order,
                base=axes @ np.diag(held) @ axes.T,
            )
        )
    return stiffness, tuple(found)


def shaft_orders(
    plan: TrainPlan, assembly: Assembly, kept: Reduction
) -> tuple[tuple[OuterForce, ...], tuple[Wobble, ...], int]:
    """What turns with a shaft, and the mesh periods after which all of it comes again."""
    outer: list[OuterForce] = []
    wobbles: list[Wobble] = []
    cycle = 1
    for shaft, teeth in zip(SHAFTS, assembly.frame.teeth, strict=True):
        pull = unbalance_pull(assembly, shaft, plan.unbalances)
        for part, shift in ((pull.real, 0.0), (pull.imag, 0.5 * np.pi)):
            if np.any(part != 0.0):
                vector = kept.vector(part)
                outer.append(
                    OuterForce(vector=vector, order=1.0 / teeth, shift=shift, rotating=True)
                )
        errors = [run_out_errors(assembly, one) for one in plan.run_outs if one.shaft == shaft]
        if errors:
            drive, back = (sum(one) for one in zip(*errors, strict=True))
            wobbles.append(Wobble(order=1.0 / teeth, drive=complex(drive), back=complex(back)))
        if np.any(pull != 0.0) or errors:
            cycle = lcm(cycle, teeth)
    return tuple(outer), tuple(wobbles), cycle
