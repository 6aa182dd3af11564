"""Warm-up: from the ambient to the steady state of the same closed loop, first order in time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.gears.geometry import GearPair
from thermogear.mesh.balance import Gearbox, heat_balance
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating, Temperatures
from thermogear.mesh.warm_up import WarmUp, warm_up

# the quick textbook springs: the heat is the same loop
MODEL = MeshModel.consistent().override(stiffness="textbook-30-degree", sharing="equal")
AMBIENT = 293.15


@pytest.fixture(scope="module")
def point(hot_rig: Operating) -> Operating:
    """2000 rpm, 100 N m."""
    cold = hot_rig.temperatures.cold()
    return replace(hot_rig, speed=np.array([200.0]), torque=np.array([100.0]), temperatures=cold)


def run(rig: GearPair, point: Operating, times: object, **how: object) -> WarmUp:
    return warm_up(rig, point, times, MODEL, **how)  # type: ignore[arg-type]


def test_starts_at_the_ambient_and_ends_at_the_steady_state(
    rig: GearPair, point: Operating
) -> None:
    times = np.array([0.0, 10.0, 100.0, 500.0, 2e3, 8e3, 3e4, 1e5, 3e5, 1e6])
    found = run(rig, point, times)
    steady = heat_balance(rig, 200.0, 100.0, point.lubricant, 125e-6, MODEL)
    assert steady.settled.all()
    for name, course in found.temperatures.items():
        assert course.shape == times.shape
        assert course[0] == AMBIENT
        assert course[-1] == pytest.approx(float(steady.steady[name][0]), abs=0.02)
    assert found.mesh_loss[-1] == pytest.approx(float(np.asarray(steady.losses.mesh)[0]), rel=1e-4)
    tooth = found.temperatures["pinion_tooth"]
    # friction starts at the teeth: they lead, and everything rises while the loss still feeds it
    assert np.all(np.diff(tooth[:5]) > 0.0)
    assert np.all(tooth[1:5] > found.temperatures["housing"][1:5])


def test_the_first_second_heats_the_teeth_by_their_loss_alone(
    rig: GearPair, point: Operating
) -> None:
    """At the start nothing flows: C dT/dt is the heat that enters the node."""
    found = run(rig, point, [0.0, 1e-3])
    steel, gear = rig.pinion.material, rig.pinion
    ring = 0.5 * np.pi * (gear.tip_radius**2 - gear.root_radius**2) * gear.face_width
    both = found.temperatures["pinion_tooth"][1] - AMBIENT
    wheel = found.temperatures["wheel_tooth"][1] - AMBIENT
    ring_2 = 0.5 * np.pi * (rig.wheel.tip_radius**2 - rig.wheel.root_radius**2) * gear.face_width
    stored = steel.density * steel.specific_heat * (both * ring + wheel * ring_2)
    assert stored == pytest.approx(found.mesh_loss[0] * 1e-3, rel=1e-3)


def test_error_is_of_first_order_in_the_intervals(rig: GearPair, point: Operating) -> None:
    ends = [
        run(rig, point, np.linspace(0.0, 2000.0, n)).temperatures["oil"][-1] for n in (5, 9, 17, 33)
    ]
    steps = np.abs(np.diff(ends))
    assert np.all(steps[1:] / steps[:-1] < 0.6)
    assert np.all(steps[1:] / steps[:-1] > 0.4)


def test_a_measured_node_is_held_from_the_start(rig: GearPair, point: Operating) -> None:
    box = Gearbox(measured={"oil": 343.15})
    found = run(rig, point, [0.0, 100.0, 1000.0], gearbox=box)
    assert found.temperatures["oil"].tolist() == [343.15] * 3
    assert np.all(np.diff(found.temperatures["pinion_tooth"]) > 0.0)
    free = run(rig, point, [0.0, 100.0, 1000.0])
    assert found.temperatures["pinion_tooth"][-1] > free.temperatures["pinion_tooth"][-1]


@pytest.mark.parametrize(
    "times", [[0.0], [[0.0, 1.0], [2.0, 3.0]], [1.0, 2.0], [0.0, 2.0, 2.0], [0.0, 2.0, 1.0]]
)
def test_times_that_do_not_rise_from_zero_are_refused(
    rig: GearPair, point: Operating, times: object
) -> None:
    with pytest.raises(InputError, match=r"^times: got \d values; allowed two or more, rising"):
        run(rig, point, times)


def test_more_than_one_point_is_refused(rig: GearPair, point: Operating) -> None:
    two = replace(point, speed=np.array([100.0, 200.0]), torque=np.array([50.0, 50.0]))
    with pytest.raises(InputError, match=r"^operating: got 2 points; allowed one"):
        run(rig, two, [0.0, 1.0])


@pytest.mark.parametrize("place", range(6))
@pytest.mark.parametrize("wrong", [0.0, -5.0, np.nan, np.inf])
def test_impossible_temperatures_name_their_place(place: int, wrong: float) -> None:
    names = (
        "reference",
        "pinion_addendum",
        "pinion_bore",
        "wheel_addendum",
        "wheel_bore",
        "housing",
    )
    values = dict.fromkeys(names, 300.0) | {names[place]: wrong}
    message = rf"^temperatures\.{names[place]}: got .* K.*; allowed -70\.\.600 degC"
    with pytest.raises(InputError, match=message):
        Temperatures(**values)
