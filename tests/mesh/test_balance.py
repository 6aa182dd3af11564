"""The closed loop of friction and heat: balances, limits, batch equals one by one."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from conftest import Compared
from thermogear import Gear, GearPair, InputError, MeshModel, mesh_cycle
from thermogear.base.errors import ValidityWarning
from thermogear.base.materials import lubricant
from thermogear.heat.gearbox import Surroundings
from thermogear.mesh import elastic
from thermogear.mesh.balance import (
    NODES,
    Gearbox,
    HeatBalance,
    Response,
    follow,
    heat_balance,
)
from thermogear.mesh.warm_up import Duty, warm_up

OIL = lubricant("M100")
AMBIENT = Surroundings().ambient
QUICK = MeshModel.consistent().override(
    friction="benedict-kelley", inlet="oil", stiffness="textbook-30-degree", sharing="equal"
)
"""Springs of the textbook: the heat is the same loop."""


STAYS = Gearbox(surroundings=Surroundings(housing_coefficient_at=None))
"""A housing whose coefficient does not grow with its heat: two steady states are common."""


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
    assert any("viscosity" in text for text in texts)
    assert len(texts) == len(set(texts))
    assert list(both.settled) == [True, False]
    alone = settle(rig, [300.0], 20.0, gearbox=box)
    np.testing.assert_allclose(alone.steady["oil"], both.steady["oil"][:1], atol=3e-6)


def test_too_few_iterations_are_told_by_the_residual(rig: GearPair) -> None:
    found = heat_balance(rig, 200.0, 100.0, OIL, 125e-6, most_iterations=1)
    assert not found.settled.any()
    assert found.residual[0] > 1e-6
    assert found.iterations[0] == 1


def rough_speeds_and_torques() -> tuple[np.ndarray, np.ndarray]:
    """A coarse part of the grid of ``trials/heat.py``, and the corner where states meet."""
    speed, torque = np.meshgrid(
        np.linspace(500.0, 6000.0, 9), np.linspace(50.0, 500.0, 7), indexing="ij"
    )
    near, low = np.meshgrid(np.arange(3900.0, 4101.0, 20.0), [20.0, 50.0], indexing="ij")
    return np.concatenate([speed.ravel(), near.ravel()]), np.concatenate(
        [torque.ravel(), low.ravel()]
    )


def hotter(found: HeatBalance) -> np.ndarray:
    """How much hotter [K] the hottest node is in the state reached from hot."""
    each = [hot - found.steady.temperatures[name] for name, hot in found.hot.items()]
    return np.asarray(np.max(each, axis=0))


def from_both_ends(found: HeatBalance) -> None:
    """The same state to 0.01 K, or both are told; never anything between."""
    for name in NODES:
        apart = np.abs(found.hot[name] - found.steady[name])
        assert np.all(apart[found.settled & ~found.several] <= 0.01)
    told = found.settled & found.several
    assert np.all(np.isnan(found.hot["oil"][told]) | (hotter(found)[told] > 0.01))


@pytest.mark.parametrize("friction", ["benedict-kelley", "schlenk"])
def test_a_state_from_cold_and_from_hot_is_the_same_or_both_are_told(
    rig: GearPair, friction: str
) -> None:
    rpm, torque = rough_speeds_and_torques()
    model = MeshModel.consistent().override(friction=friction, inlet="oil")
    with pytest.warns(ValidityWarning):
        found = settle(rig, list(rpm), list(torque), model, STAYS)
    from_both_ends(found)
    assert found.settled.mean() > 0.95
    # the oil of a pair that turns transitional keeps two temperatures here
    assert 0 < found.several.sum() < 12
    assert np.all(hotter(found)[found.several] > 1.0)
    calm = heat_balance(rig, 100.0, 100.0, OIL, 125e-6, model)
    assert not calm.several.any()
    blind = heat_balance(rig, 100.0, 100.0, OIL, 125e-6, model, from_hot=False)
    assert np.isnan(blind.hot["oil"]).all()
    assert not blind.several.any()


def test_random_pairs_from_both_ends() -> None:
    random, settled = np.random.default_rng(15), 0
    for _ in range(6):
        teeth = int(random.integers(17, 40)), int(random.integers(40, 90))
        module = float(random.uniform(2e-3, 6e-3))
        pinion, wheel = (
            Gear(z, module, face_width=10.0 * module, bore_radius=0.3 * z * 0.5 * module)
            for z in teeth
        )
        pair = GearPair(pinion, wheel)
        size = pair.pinion.pitch_radius**2 * pair.face_width
        speed = random.uniform(50.0, 600.0, 12)
        torque = size * random.uniform(3e5, 2e6, 12)
        oil = lubricant(str(random.choice(["M68", "M100", "M220", "P150"])))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)
            found = heat_balance(pair, speed, torque, oil, 1e-4, QUICK)
        from_both_ends(found)
        settled += int(found.settled.sum())
    assert settled > 45


def test_warm_up_ends_where_the_balance_from_cold_stands(rig: GearPair) -> None:
    """Where two states are steady too: a cold start cannot pass the lower one."""
    gaps, told = [], 0
    for rpm, torque in ((4080.0, 20.0), (3914.0, 50.0), (2700.0, 300.0), (1200.0, 80.0)):
        found = settle(rig, [rpm], torque, QUICK, STAYS)
        told += int(found.several[0])
        duty = Duty(time=[0.0, 2e6], speed=[rpm * np.pi / 30.0], torque=[torque], ambient=[AMBIENT])
        course = warm_up(rig, duty, OIL, 125e-6, QUICK, gearbox=STAYS)
        gaps += [abs(course.temperatures[n][-1] - float(found.steady[n][0])) for n in NODES]
    assert max(gaps) < 0.01
    assert told > 0


def test_a_point_beyond_a_law_is_a_status_and_the_others_are_the_same_to_the_last_bit(
    rig: GearPair,
) -> None:
    """At -40 C a pair that hardly turns has an oil of Pr = 3e6, thicker than any law."""
    box = Gearbox(surroundings=Surroundings(ambient=233.15))
    rpm, torque = [10.0, 1000.0, 2000.0, 10.0], [10.0, 100.0, 200.0, 20.0]
    found = settle(rig, rpm, torque, gearbox=box)
    without = settle(rig, rpm[1:3], torque[1:3], gearbox=box)
    assert list(found.lost) == [0, 3]
    assert found.lost[0].startswith("prandtl: got ")
    assert list(found.settled) == [False, True, True, False]
    assert without.lost == {}
    lost = [True, False, False, True]
    for name, values in found.steady.temperatures.items():
        assert np.isnan(values).tolist() == lost
        np.testing.assert_array_equal(values[1:3], without.steady[name])
    for name in ("mesh", "partition_1", "churning", "bearing_1", "bearing_2", "contact"):
        values = getattr(found.losses, name)
        assert np.isnan(values).tolist() == lost
        np.testing.assert_array_equal(values[1:3], getattr(without.losses, name))
    np.testing.assert_array_equal(found.residual[1:3], without.residual)
    assert not found.several.any()
    # what never works is no point's fault
    with pytest.raises(InputError, match=r"^prandtl: got"):
        settle(rig, [10.0], 10.0, gearbox=Gearbox(measured={"oil": 223.15}))


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(InputError, match=r"gearbox.immersion: got 1.5; allowed 0 .. 1"):
        Gearbox(immersion=1.5)


def test_near_the_end_of_a_linear_network_the_steps_are_newtons() -> None:
    """T = A T + b with A of rank 2: (I - A)^-1 b within 1e-9 K after few of Broyden's steps."""
    random = np.random.default_rng(8)
    first, second = random.uniform(0.05, 0.2, (2, 6, 3)), random.uniform(-0.5, 0.1, (2, 6, 3))
    falls = np.einsum("cin,cjn->cij", first[:, :, :2], second[:, :, :2])
    steady = 330.0 + random.uniform(0.0, 5.0, (2, 6))

    def respond(nodes: np.ndarray, index: np.ndarray, share: np.ndarray | None) -> Response:
        reached = steady[index] + np.einsum("cij,cj->ci", falls[index], nodes - steady[index])
        return Response(reached, np.ones(index.size, np.bool_), np.zeros((index.size, 1)))

    start, held = np.full((2, 6), 329.9), np.zeros((2, 6), np.bool_)
    found = follow(respond, start, held, tolerance=1e-10, most_iterations=60)
    assert found.settled(1e-10).all()
    np.testing.assert_allclose(found.nodes, steady, atol=1e-9)
    # Broyden's update ends after 2 n + 2 steps on a derivative of rank n; source: Gay 1979
    assert found.iterations.max() < 3 + 2 * 2 + 2 + 6


@pytest.mark.parametrize(("start", "end"), [(293.0, 320.0), (700.0, 420.0)])
def test_of_three_steady_states_the_nearest_on_the_way_is_taken(start: float, end: float) -> None:
    """N(T) - T = -(T - 320)(T - 340)(T - 420)/5000: stable at 320 K and 420 K."""
    anew: list[bool] = []

    def respond(nodes: np.ndarray, index: np.ndarray, share: np.ndarray | None) -> Response:
        anew.append(share is None)
        rise = -(nodes - 320.0) * (nodes - 340.0) * (nodes - 420.0) / 5e3
        # a load that is shared as before is off by 2 % of the way
        rise = rise if share is None else rise + 0.02 * (nodes - start)
        return Response(nodes + rise, np.ones(index.size, np.bool_), np.zeros((index.size, 1)))

    held = np.zeros((1, 1), np.bool_)
    found = follow(respond, np.array([[start]]), held, tolerance=1e-9, most_iterations=200)
    assert found.settled(1e-9).all()
    assert found.nodes.item() == pytest.approx(end, abs=1e-8)
    assert 3 <= anew.count(True) < len(anew)


def test_the_load_is_shared_anew_at_the_start_and_near_the_end_alone(
    rig: GearPair, monkeypatch: pytest.MonkeyPatch
) -> None:
    solves: list[int] = []
    solve = elastic.solve_mesh

    def counted(*of: object, **how: object) -> object:
        solves.append(1)
        return solve(*of, **how)  # type: ignore[arg-type]

    monkeypatch.setattr(elastic, "solve_mesh", counted)
    speed = 1500.0 * np.pi / 30.0
    found = heat_balance(rig, speed, 300.0, OIL, 125e-6, from_hot=False)
    assert found.settled.all()
    assert 3 <= len(solves) < 0.7 * found.iterations[0]
    # what is told was made with the load of the very state
    cycle = mesh_cycle(rig, found.operating, path_positions=5)
    np.testing.assert_allclose(found.losses.mesh, cycle["frictional_power"].values, rtol=1e-12)
