"""The closed loop with shafts and bearings: balance, limits, warm-up, order."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
import pytest

from conftest import Compared
from own_shafts import SMOOTH, Rubbing, Size, random_pair, random_train, train
from thermogear import GearPair, MeshModel
from thermogear.base.errors import ValidityWarning
from thermogear.base.materials import lubricant
from thermogear.heat.gearbox import Surroundings
from thermogear.heat.lubrication import kinematic_viscosity
from thermogear.heat.shaft_heat import Friction, ShaftHeat
from thermogear.mesh.balance import Gearbox, HeatBalance, heat_balance
from thermogear.mesh.balance_table import balance_dataset
from thermogear.mesh.warm_up import Duty, warm_up
from thermogear.shafts.bearings.catalogue import catalogue_bearing
from thermogear.shafts.bearings.friction import PalmgrenFriction, SkfFriction

OIL = lubricant("M100")
QUICK = MeshModel.consistent().override(
    friction="benedict-kelley", inlet="oil", stiffness="textbook-30-degree", sharing="equal"
)
"""Springs of the textbook: the heat is the same loop."""


@pytest.fixture(scope="module")
def chain() -> ShaftHeat:
    return train(diameters=(30e-3, 40e-3), face=40e-3)


def settle(
    pair: GearPair, chain: ShaftHeat | None, speed: list[float], torque: list[float] | float,
    **around: float,
) -> HeatBalance:  # fmt: skip
    box = Gearbox(surroundings=Surroundings(train=chain, **around))  # type: ignore[arg-type]
    return heat_balance(pair, speed, torque, OIL, 125e-6, QUICK, gearbox=box)


def test_every_loss_leaves_and_each_bearing_has_its_viscosity(
    rig: GearPair, chain: ShaftHeat, compared: Compared
) -> None:
    found = settle(rig, chain, [50.0, 150.0, 300.0], 120.0)
    assert found.settled.all()
    losses = found.losses
    each = sum(np.asarray(one.loss) for one in losses.bearings.values())
    np.testing.assert_allclose(losses.bearing_1 + np.asarray(losses.bearing_2), each, rtol=1e-14)
    made = np.asarray(losses.mesh) + losses.churning + each
    compared(
        "heat into the ambient with bearings, closed loop",
        "the losses of pair and bearings",
        found.steady.heat_out["ambient"] / made - 1.0,
        1e-10,
    )
    for name, one in losses.bearings.items():
        inner, outer = (found.steady[f"{name}_{ring}"] for ring in ("inner", "outer"))
        # friction warms the rings, the housing cools the outer
        assert np.all(inner > outer)
        assert np.all(outer > found.steady["housing"])
        np.testing.assert_allclose(one.temperature, 0.5 * (inner + outer), atol=1e-5)
        np.testing.assert_allclose(
            one.viscosity, kinematic_viscosity(OIL, 0.5 * (inner + outer)), rtol=1e-6
        )


def test_20_random_gearboxes_settle_and_close(compared: Compared) -> None:
    random, residuals, gaps = np.random.default_rng(4), [], []
    for _ in range(20):
        pair = random_pair(random)
        chain = random_train(random, pair)
        size = pair.pinion.pitch_radius**2 * pair.face_width
        around = Surroundings(train=chain, oil_flow=float(random.choice([0.0, 5e-5])))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)
            found = heat_balance(
                pair,
                random.uniform(20.0, 300.0, 3),
                size * random.uniform(2e5, 1e6, 3),
                OIL,
                1e-4,
                QUICK,
                gearbox=Gearbox(surroundings=around),
            )
        assert found.settled.all()
        assert not found.several.any()
        losses = found.losses
        made = sum(
            np.asarray(getattr(losses, name))
            for name in ("mesh", "churning", "bearing_1", "bearing_2")
        )
        out = sum(np.asarray(q) for q in found.steady.heat_out.values())
        gaps.append(out / made - 1.0)
        residuals.append(found.residual)
    compared("residual of 20 random gearboxes with bearings", "0", np.array(residuals), 1e-6, "K")
    compared("heat out of them", "their losses", np.array(gaps), 1e-9)


@pytest.mark.parametrize("law", [SkfFriction, PalmgrenFriction])
@pytest.mark.parametrize("lubrication", ["bath", "grease"])
def test_laws_of_catalogues_settle_everywhere_and_warm_the_rings_as_usual(
    rig: GearPair, law: Callable[..., Friction], lubrication: str
) -> None:
    """From 5 rpm on; 5 to 20 K across the rings is what makers expect of fast bearings."""
    size = catalogue_bearing("6308")
    chain = train(
        diameters=(40e-3, 40e-3),
        face=rig.face_width,
        size=size,
        friction=law(bearing=size, lubrication=lubrication),
    )
    rpm, torque = np.meshgrid([5.0, 40.0, 200.0, 1000.0, 3000.0], [0.0, 50.0, 200.0])
    speed = rpm.ravel() * np.pi / 30.0
    found = settle(rig, chain, list(speed), list(torque.ravel()))
    assert found.settled.all()
    made = sum(
        np.asarray(getattr(found.losses, n)) for n in ("mesh", "churning", "bearing_1", "bearing_2")
    )
    np.testing.assert_allclose(found.steady.heat_out["ambient"], made, rtol=1e-9, atol=1e-9)
    across = (
        found.steady["pinion_bearing_1_inner"] - found.steady["pinion_bearing_1_outer"]
    ).reshape(rpm.shape)
    assert np.all(np.diff(across, axis=1) > 0.0)
    assert np.all(across[:, -1] < 20.0)
    assert across[1, -1] > 1.0


def test_hotter_with_speed_and_with_load(rig: GearPair, chain: ShaftHeat) -> None:
    speed = settle(rig, chain, [25.0, 75.0, 150.0, 300.0], 100.0)
    load = settle(rig, chain, [150.0] * 4, [10.0, 50.0, 100.0, 200.0])
    for found in (speed, load):
        for node in chain.nodes:
            assert np.all(np.diff(found.steady[node]) > 0.0)
    for name, one in speed.losses.bearings.items():
        assert np.all(np.diff(np.asarray(one.loss)) > 0.0)
        # more load warms the oil, and thinner oil turns more easily; at one temperature it does not
        held = {node: np.full(4, 330.0) for node in chain.nodes}
        force = np.array([100.0, 500.0, 1000.0, 2000.0])
        found_loss = chain.losses(held, OIL, force, (150.0, 75.0))[name].loss
        assert np.all(np.diff(np.asarray(found_loss)) > 0.0)


def test_bearings_that_are_not_there_leave_the_loop_as_it_was(
    rig: GearPair, compared: Compared
) -> None:
    """No friction, rings that are one: today's conductance of shaft and bearing."""
    speeds, bore = [50.0, 200.0], 2.0 * rig.pinion.bore_radius
    bare = train(
        diameters=(bore, 2.0 * rig.wheel.bore_radius),
        face=rig.face_width,
        size=Size(elements=10**9),
        friction=SMOOTH,
    )
    box = Gearbox(bearing_coefficient=0.0)
    known = heat_balance(rig, speeds, 100.0, OIL, 125e-6, QUICK, gearbox=box)
    found = settle(rig, bare, speeds, 100.0)
    apart = [found.steady[n] - known.steady[n] for n in known.steady.temperatures]
    compared(
        "loop with bearings that are not there", "the loop without", np.array(apart), 2e-5, "K"
    )


def test_a_long_warm_up_ends_in_the_balance(
    rig: GearPair, chain: ShaftHeat, compared: Compared
) -> None:
    box = Gearbox(surroundings=Surroundings(train=chain))
    steady = heat_balance(rig, 150.0, 100.0, OIL, 125e-6, QUICK, gearbox=box)
    duty = Duty(time=[0.0, 1e6, 1.001e6], speed=[150.0, 0.0], torque=[100.0, 0.0],
                ambient=[293.15, 293.15])  # fmt: skip
    course = warm_up(rig, duty, OIL, 125e-6, QUICK, gearbox=box)
    last = int(np.flatnonzero(course.piece == 0)[-1])
    assert set(course.temperatures) == {*box.nodes, "ambient"}
    apart = [float(course.temperatures[n][last] - steady.steady[n][0]) for n in box.nodes]
    compared("end of a warm-up with bearings", "the balance from cold", np.array(apart), 0.01, "K")
    assert course.course.imbalance.max() < 1e-6
    for name, one in course.losses.bearings.items():
        values = np.asarray(one.loss)
        assert values.shape == course.time.shape
        assert values[last] == pytest.approx(
            float(np.asarray(steady.losses.bearings[name].loss)[0]), rel=1e-4
        )
        # cold oil is thick: a bearing turns hardest at the start, and not at all at rest
        assert values[0] > 1.2 * values[last]
        assert np.all(values[course.piece == 1] == 0.0)


def test_thicker_friction_makes_hotter_bearings_and_a_better_seat_cools(rig: GearPair) -> None:
    def hottest(**how: object) -> float:
        found = settle(rig, train(face=rig.face_width, **how), [150.0], 100.0)  # type: ignore[arg-type]
        return float(max(found.steady[f"pinion_bearing_{i}_inner"][0] for i in (1, 2)))

    plain = hottest()
    assert hottest(friction=Rubbing(thick=1.0)) > plain + 0.1
    assert hottest(seat=40.0) < plain - 0.1


def test_a_lost_point_is_nan_in_its_bearings_and_one_by_one_is_the_batch(
    rig: GearPair, chain: ShaftHeat
) -> None:
    cold = {"ambient": 233.15}
    found = settle(rig, chain, [1.0, 100.0], [10.0, 100.0], **cold)
    alone = settle(rig, chain, [100.0], [100.0], **cold)
    assert list(found.lost) == [0]
    for name, one in found.losses.bearings.items():
        assert np.isnan(np.asarray(one.loss)).tolist() == [True, False]
        assert np.isnan(np.asarray(one.viscosity)).tolist() == [True, False]
        assert np.asarray(one.loss)[1] == np.asarray(alone.losses.bearings[name].loss)[0]
    np.testing.assert_array_equal(
        found.steady["wheel_bearing_2_inner"][1:], alone.steady["wheel_bearing_2_inner"]
    )


def test_tables_have_each_bearing_and_none_without_a_train(rig: GearPair, chain: ShaftHeat) -> None:
    found = settle(rig, chain, [50.0, 150.0], 100.0)
    data = balance_dataset(found)
    assert data["bearing"].values.tolist() == list(chain.named)
    assert data["bearing_loss"].dims == ("operating", "bearing")
    units = {"bearing_loss": "W", "bearing_temperature": "K", "bearing_viscosity": "m^2/s"}
    for name, unit in units.items():
        assert data[name].attrs["units"] == unit
    shafts = data["loss"].sel(loss_kind=["bearing_1", "bearing_2"]).sum("loss_kind")
    np.testing.assert_allclose(data["bearing_loss"].sum("bearing"), shafts, rtol=1e-12)
    assert "wheel_bearing_2_outer" in data["node"].values
    bare = balance_dataset(settle(rig, None, [50.0], 100.0))
    assert not [name for name in (*bare.variables, *bare.dims) if str(name).startswith("bearing")]
