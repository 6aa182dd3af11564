"""The closed loop of friction and heat: balances, limits, batch equals one by one."""

from __future__ import annotations

import numpy as np
import pytest

from conftest import Compared
from thermogear import GearPair, InputError, MeshModel, mesh_cycle
from thermogear.base.errors import ValidityWarning
from thermogear.base.materials import lubricant
from thermogear.heat.gearbox import Surroundings
from thermogear.mesh.balance import Gearbox, HeatBalance, heat_balance

OIL = lubricant("M100")


def settle(
    rig: GearPair,
    rpm: list[float],
    torque: float | list[float] = 100.0,
    model: MeshModel | None = None,
    gearbox: Gearbox | None = None,
) -> HeatBalance:
    speed = np.array(rpm) * np.pi / 30.0
    return heat_balance(rig, speed, torque, OIL, 125e-6, model, gearbox=gearbox)


def test_every_loss_leaves_into_the_ambient(rig: GearPair, compared: Compared) -> None:
    found = settle(rig, [1000.0, 2000.0], 100.0)
    assert found.settled.all()
    assert np.all(found.residual <= 1e-6)
    lost = sum(
        np.asarray(getattr(found.losses, name))
        for name in ("mesh", "churning", "bearing_1", "bearing_2")
    )
    compared(
        "heat into the ambient, closed loop",
        "the losses of the pair",
        found.steady.heat_out["ambient"] / lost - 1.0,
        1e-10,
    )


def test_the_loop_is_closed(rig: GearPair) -> None:
    # a cycle at the computed temperatures makes the very losses they were computed from
    found = settle(rig, [1500.0], 150.0)
    cycle = mesh_cycle(rig, found.operating, path_positions=101)
    np.testing.assert_allclose(
        cycle["frictional_power"].values, np.asarray(found.losses.mesh), rtol=1e-6
    )
    # teeth are the hottest, the housing the coolest of the settled nodes
    t = found.steady
    assert float(t["pinion_tooth"][0]) > float(t["oil"][0]) > float(t["housing"][0])


def test_a_pair_at_rest_takes_the_temperature_of_the_ambient(rig: GearPair) -> None:
    found = settle(rig, [0.0], 100.0)
    np.testing.assert_allclose(found.operating.oil_temperature, 293.15, atol=1e-5)
    # the drawing holds at 20 C where nothing else is said
    assert found.operating.temperatures.reference == 293.15


def test_measured_nodes_stay_as_measured(rig: GearPair) -> None:
    box = Gearbox(measured={"oil": 353.15, "pinion_tooth": 380.0})
    found = settle(rig, [1000.0, 2000.0], gearbox=box)
    np.testing.assert_allclose(found.operating.oil_temperature, 353.15)
    np.testing.assert_allclose(found.operating.temperatures.pinion_addendum, 380.0)
    free = settle(rig, [1000.0, 2000.0], gearbox=Gearbox(measured={"oil": 353.15}))
    assert np.all(np.asarray(free.operating.temperatures.pinion_addendum) > 353.15)


@pytest.mark.parametrize(
    ("friction", "inlet"),
    [("benedict-kelley", "oil"), ("lambda-blend", "body"), ("schlenk", "oil")],
)
def test_every_law_settles_alone_and_in_a_batch_alike(
    rig: GearPair, friction: str, inlet: str
) -> None:
    model = MeshModel.consistent().override(friction=friction, inlet=inlet)
    speeds, torques = [500.0, 1000.0, 2500.0], [50.0, 150.0, 100.0]
    whole = settle(rig, speeds, torques, model)
    assert whole.settled.all()
    assert whole.iterations.max() < 40
    for point, (rpm, torque) in enumerate(zip(speeds, torques, strict=True)):
        alone = settle(rig, [rpm], torque, model)
        np.testing.assert_allclose(
            alone.steady["pinion_tooth"], whole.steady["pinion_tooth"][point], atol=3e-6
        )


def test_more_load_and_more_speed_make_hotter_teeth(rig: GearPair) -> None:
    load = settle(rig, [1000.0] * 3, [50.0, 100.0, 200.0]).steady["pinion_tooth"]
    speed = settle(rig, [500.0, 1000.0, 2000.0]).steady["pinion_tooth"]
    assert np.all(np.diff(load) > 0.0)
    assert np.all(np.diff(speed) > 0.0)


def test_better_cooling_cools(rig: GearPair) -> None:
    poor = Gearbox(surroundings=Surroundings(housing_coefficient=10.0))
    good = Gearbox(surroundings=Surroundings(housing_coefficient=25.0))
    hot, cool = (settle(rig, [2000.0], gearbox=box).steady["oil"][0] for box in (poor, good))
    assert cool < hot


def test_a_runaway_point_is_a_status_and_leaves_the_others_alone(rig: GearPair) -> None:
    # 6000 rpm at 5000 N m on a housing that hardly cools: no steady state worth a name
    box = Gearbox(surroundings=Surroundings(housing_coefficient=1.0, housing_area=0.1))
    with pytest.warns(ValidityWarning) as told:
        both = settle(rig, [300.0, 6000.0], [20.0, 5000.0], gearbox=box)
    # every range that was left is named once
    texts = [str(one.message) for one in told]
    assert any("viscosity line" in text for text in texts)
    assert len(texts) == len(set(texts))
    assert list(both.settled) == [True, False]
    alone = settle(rig, [300.0], 20.0, gearbox=box)
    np.testing.assert_allclose(alone.steady["oil"], both.steady["oil"][:1], atol=3e-6)


def test_too_few_iterations_are_told_by_the_residual(rig: GearPair) -> None:
    found = heat_balance(rig, 200.0, 100.0, OIL, 125e-6, most_iterations=1)
    assert not found.settled.any()
    assert found.residual[0] > 1e-6
    assert found.iterations[0] == 1


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(InputError, match=r"gearbox.immersion: got 1.5; allowed 0 .. 1"):
        Gearbox(immersion=1.5)
