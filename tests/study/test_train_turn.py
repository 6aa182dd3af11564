"""A train over the turn of faulty gears: one rigid coordinate is the pair; stiff shafts come near.

The pair's own engine takes fixed steps in units of its half backlash; the train's takes exact modes
in SI. Both meet in the motion over the turn.
"""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.excitation import Periodic
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.family import family
from thermogear.dynamics.geared import GearedModel, OuterForce
from thermogear.dynamics.ladder import Engine
from thermogear.study.faults import FaultMotion, fault_motions
from thermogear.study.shafts.state import meshing
from thermogear.study.shafts.turning import over_turn, train_fault_motion

INERTIA = (0.004, 0.04)
LENGTH, DIAMETER = 0.03, 0.06
"""Of both shafts [m]."""
OF_SHAFT = np.pi / 32.0 * 7850.0 * DIAMETER**4 * LENGTH
"""Polar inertia [kg m^2] of a solid steel shaft."""


def pair(inertia: tuple[float, float], more: str = "") -> GearCase:
    text = f"""
[gears]
module = "6 mm"
face_width = "10 mm"
[gears.pinion]
teeth = 14
profile_shift = 0.3
[gears.wheel]
teeth = 28
[inertia]
model = "given"
pinion = "{inertia[0]!r} kg m^2"
wheel = "{inertia[1]!r} kg m^2"
[oil]
temperature = "60 degC"
[operating]
speed = "1500 rpm"
torque = "150 N m"
[temperatures]
pinion_addendum = "70 degC"
wheel_addendum = "60 degC"
pinion_bore_below_addendum = "0 K"
wheel_bore_below_addendum = "0 K"
housing_below_addendum = "0 K"
[dynamics]
damping_ratio = 0.08
[[faults]]
kind = "crack"
gear = "wheel"
tooth = 5
share = 0.4
"""
    return gear_case(load_case(text + more))


SHAFTS = "".join(
    f"""
[[shafts]]
gear = "{gear}"
gear_position = "15 mm"
sections = [{{ length = "{1e3 * LENGTH} mm", diameter = "{1e3 * DIAMETER} mm" }}]
"""
    for gear in ("pinion", "wheel")
) + "".join(
    f"""
[[bearings]]
shaft = "{gear}"
position = "{position} mm"
stiffness = "1e7 N/um"
damping = "1e4 N s/m"
"""
    for gear in ("pinion", "wheel")
    for position in (8, 22)
)
"""Bearings at both sides of the gear's face: bending of the shafts is all that yields."""


@pytest.fixture(scope="module")
def motions() -> tuple[FaultMotion, FaultMotion]:
    """Of the pair with the shafts' inertia, and of the train on nearly rigid shafts."""
    case = pair((INERTIA[0] + OF_SHAFT, INERTIA[1] + OF_SHAFT))
    (of_pair,) = fault_motions(case, samples=64)
    return of_pair, train_fault_motion(pair(INERTIA, SHAFTS))


def test_one_rigid_coordinate_is_the_pair(motions: tuple[FaultMotion, FaultMotion]) -> None:
    """m_e q'' + c q' + k f = F + c e' with q = x + e: the pair's equation, by the other engine."""
    case = pair((INERTIA[0] + OF_SHAFT, INERTIA[1] + OF_SHAFT))
    points = family(case, ("pinion_speed",))(case.stated.speed[:1, None])
    rate, stiffness = float(points.rate[0]), float(points.stiffness[0])
    mass = stiffness / rate**2
    damping = float(points.flat.damping[0]) * mass * rate
    at = case.operating_of(case.models[0]).point(0)
    mesh = meshing(case, case.models[0], case.pair, at)
    model = GearedModel(
        mass=np.array([[mass]]), damping=np.array([[damping]]), stiffness=np.zeros((1, 1)),
        force=np.array([points.force[0]]), drive=np.array([1.0]), back=np.array([-1.0]),
        mesh_stiffness=Periodic(stiffness, ()), error=Periodic(0.0, ()),
        half_backlash=mesh.half_backlash, mesh_damping=damping,
        mesh_frequency=14 * float(case.stated.speed[0]) / (2.0 * np.pi),
        outer=(OuterForce(vector=np.zeros(1), order=1.0 / 14.0),),
    )  # fmt: skip
    turning = over_turn(model, mesh, own=28, turn=28)
    assert turning.outer[0].order == pytest.approx(2.0, rel=1e-15)
    state = np.zeros(2)
    engine = Engine(turning)
    for _ in range(3):
        state = engine.run(state).state
    run = engine.run(state, samples=64 * 28)
    forces = turning.forces(run.sample_phase, states=run.samples)
    sound = motions[0].faulty
    assert sound.repeats
    for curve, expected in (
        (run.samples[:, 0], sound.error),
        (forces["drive"] - forces["back"], sound.mesh_force),
        (forces["acceleration"][:, 0], sound.acceleration),
    ):
        size = np.ptp(expected)
        # series of 24 harmonics on both sides; the pair's steps are of 1e-5 of its natural cycle
        assert np.abs(curve - expected).max() < 2e-4 * size


def test_a_train_on_stiff_shafts_comes_near_the_pair(
    motions: tuple[FaultMotion, FaultMotion],
) -> None:
    """What the shafts yield in 12 mm between the bearings moves the error by two parts in 100.

    The crack of wheel tooth 5 is where it is in the pair.
    """
    of_pair, of_train = motions
    for name in ("faulty", "sound"):
        expected, train = getattr(of_pair, name), getattr(of_train, name)
        assert (train.status, train.repeats, train.turns) == ("ok", True, 1)
        assert (train.mesh_periods, train.teeth) == (28, (14, 28))
        swing = [motion.error - motion.error.mean() for motion in (train, expected)]
        assert np.abs(swing[0] - swing[1]).max() < 0.025 * np.ptp(expected.error)
        assert train.mesh_force.mean() == pytest.approx(expected.mesh_force.mean(), rel=1e-4)
    change = [motion.faulty.error - motion.sound.error for motion in (of_train, of_pair)]
    assert np.abs(change[0] - change[1]).max() < 0.06 * np.ptp(change[1])
    worst = [int(np.argmax(np.abs(curve))) / 64 for curve in change]
    assert worst == pytest.approx([4.5, 4.5], abs=1.5)


def test_what_has_no_faults_no_shafts_or_no_teeth_is_refused() -> None:
    sound = pair(INERTIA, SHAFTS).sound()
    with pytest.raises(InputError, match="state \\[\\[faults\\]\\]"):
        train_fault_motion(sound)
    with pytest.raises(InputError, match="shafts: got nothing"):
        train_fault_motion(pair(INERTIA))


@pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
def test_a_jammed_train_moves_not() -> None:
    hot = gear_case(load_case(pair(INERTIA, SHAFTS).text, [
        "temperatures.pinion_addendum=390 degC", "temperatures.wheel_addendum=390 degC",
        'backlash={value = "0.005 mm", direction = "normal", extent = "total"}',
    ]))  # fmt: skip
    motion = train_fault_motion(hot)
    assert motion.faulty.status == motion.sound.status == "jammed"
    assert motion.faulty.error.size == 0


def test_bearings_of_a_turning_train_carry_the_mesh_force(
    motions: tuple[FaultMotion, FaultMotion],
) -> None:
    """The mean force on the rings of the pinion's shaft is the teeth's, but for its weight."""
    train = motions[1].faulty
    assert train.bearing_force is not None
    carried = train.bearing_force[:, :2].sum(axis=1).mean(axis=0)
    solid = 0.25 * np.pi * 7850.0 * (DIAMETER**2 * LENGTH + 0.1**2 * 0.01)
    apart = abs(np.linalg.norm(carried) - train.mesh_force.mean())
    assert apart < 9.81 * solid
