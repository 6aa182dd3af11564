"""Motion of a drive train over a whole turn of gears with faults, beside that without them.

The equations of :mod:`~thermogear.study.shafts.moving`, whose phase then counts turns of the pair:
stiffness and error of every tooth pair come after one another. Friction of the teeth is left out,
as in the motion of a pair over its turn, and the centres stand as the mean tooth deflects them.
Checked by ``tests/study/test_train_turn.py``: a train on stiff bearings is the pair.
"""

from __future__ import annotations

from dataclasses import replace
from math import lcm

import numpy as np

from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.excitation import Periodic
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import STATUS, moves
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT, StateLike, ThermalState
from thermogear.dynamics.geared import GearedModel
from thermogear.dynamics.ladder import Engine
from thermogear.dynamics.turns import CLOSE, LEAST_TURNS, LONGEST_CYCLE
from thermogear.mesh.excite import over_turn as spread
from thermogear.study.faults import FaultMotion, TurnMotion
from thermogear.study.shafts.moving import LONGEST, MovingTrain, moving
from thermogear.study.shafts.record import SAMPLES, shown
from thermogear.study.shafts.state import (
    Meshing,
    TrainState,
    meshing,
    require_standing,
    settled,
)


def train_fault_motion(
    case: GearCase,
    *,
    place: int = 0,
    state: StateLike = HOT,
    samples: int = SAMPLES,
    progress: Progress = silent,
) -> FaultMotion:
    """The settled motion of a case's train at operating point ``place``, with faults and without.

    ``state`` "hot", "undeformed" or the gears' temperature [K]; ``samples`` of a mesh period. The
    turn is that after which all teeth, and forces that turn with a shaft, meet again. Motions start
    at rest under the mean load and are followed until the end of a turn is that of an earlier one;
    no orbit is proven. Unbalance and eccentricity of shafts whose teeth have no common factor come
    again only after all tooth pairs: minutes; ``progress`` is told of every turn. ``acceleration``
    and ``error`` are those of the gears' approach along the drive flank's line of action.
    InputError without faults, without shafts, and for textbook springs, which feel none.
    """
    if not case.faults():
        raise InputError("faults", "none", fix="state [[faults]] in the case")
    if case.models[0].stiffness != "loaded":
        raise InputError("model.stiffness", case.models[0].stiffness, allowed="loaded")
    require_standing(case, "over a turn with faults")
    thermal = ThermalState.of(state)
    ((rest,),) = settled(case, [place], states=[thermal])
    at = thermal.operating(case, case.models[0])
    both = [case, case.sound()]
    teeth = (case.pair.pinion.teeth, case.pair.wheel.teeth)
    if not moves(rest.status):
        still = _still(rest, teeth, samples, STATUS[rest.status])
        return FaultMotion(still, still)
    point = replace(at, housing=case.housing).point(place)
    meshes = [meshing(each, each.models[0], rest.mesh.pair, point) for each in both]
    train = moving(case, rest)
    turn = lcm(train.model.cycle, *(each.period.mesh_periods for each in both))
    models = (
        over_turn(
            train.model,
            mesh,
            own=each.period.mesh_periods,
            turn=turn,
            wider=mesh.half_backlash - rest.mesh.half_backlash,
        )
        for each, mesh in zip(both, meshes, strict=True)
    )
    return FaultMotion(
        *(_motion(replace(train, model=model), teeth, samples, progress) for model in models)
    )


def over_turn(
    model: GearedModel, mesh: Meshing, *, own: int, turn: int, wider: float = 0.0
) -> GearedModel:
    """``model`` with its phase in turns of so many mesh periods, and ``mesh`` along the turn.

    The functions of ``mesh`` come again after ``own`` mesh periods, a divisor of ``turn``.
    ``wider`` [m]: what its teeth add to the half backlash of ``model``, whose centres open it by
    themselves.
    """
    stiffness, error = (
        tuple(spread(np.append(0.0, rows)[None], turn // own)[0, 1:])
        for rows in (mesh.stiffness_harmonics, mesh.error_harmonics)
    )
    return replace(
        model,
        mesh_stiffness=Periodic(float(mesh.stiffness.mean()), stiffness),
        error=Periodic(0.0, error),
        half_backlash=model.half_backlash + wider,
        mesh_frequency=model.mesh_frequency / turn,
        mesh_periods=turn,
        outer=tuple(replace(force, order=force.order * turn) for force in model.outer),
        wobbles=tuple(replace(wobble, order=wobble.order * turn) for wobble in model.wobbles),
        cycle=1,
    )


def _motion(
    train: MovingTrain, teeth: tuple[int, int], samples: int, progress: Progress
) -> TurnMotion:
    """What ``train`` settles on from rest, recorded over the turns that it repeats after."""
    model, rest = train.model, train.state
    engine, unit = Engine(model), model.return_map().unit
    turn, ends, turns = model.mesh_periods, [train.start], 0
    try:
        while not turns and len(ends) <= max(LEAST_TURNS, LONGEST // turn):
            progress("turns of the train", len(ends), max(LEAST_TURNS, LONGEST // turn))
            ends.append(engine.run(ends[-1]).state)
            back = range(1, min(LONGEST_CYCLE, len(ends) - 1) + 1)
            distances = [float(np.abs((ends[-1] - ends[-1 - n]) / unit).max()) for n in back]
            turns = next((n for n, size in zip(back, distances, strict=True) if size < CLOSE), 0)
        run = engine.run(ends[-1], max(turns, 1), samples=samples * turn)
    except ConvergenceError:
        return _still(rest, teeth, samples, "diverged")
    forces = model.forces(run.sample_phase, states=run.samples)
    return TurnMotion(
        speed=rest.speed, torque=rest.torque, status=STATUS[rest.status], mesh_periods=turn,
        teeth=teeth, samples=samples, turns=max(turns, 1), repeats=turns > 0,
        acceleration=forces["acceleration"] @ model.drive,
        mesh_force=forces["drive"] - forces["back"],
        error=run.samples[:, : model.size] @ model.drive,
        bearing_force=shown(train, run, 0.0).bearing_force,
    )  # fmt: skip


def _still(rest: TrainState, teeth: tuple[int, int], samples: int, status: str) -> TurnMotion:
    """No motion, and why."""
    none = np.zeros(0)
    return TurnMotion(
        speed=rest.speed, torque=rest.torque, status=status, mesh_periods=1, teeth=teeth,
        samples=samples, turns=1, repeats=False, acceleration=none, mesh_force=none, error=none,
    )  # fmt: skip
