"""A pair through its duty: closed forms, finite volumes, energy, jams, the worst moment."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from thermogear import Gear, GearPair, Surroundings, thermal_network
from thermogear.base.errors import InputError
from thermogear.base.materials import lubricant
from thermogear.heat.gearbox import Losses
from thermogear.heat.transient import State, Stretch, follow
from thermogear.mesh.balance import Gearbox, heat_balance, node_temperatures
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.model import MeshModel
from thermogear.mesh.thermal import HotPair
from thermogear.mesh.warm_up import PHASES, Duty, WarmUp, warm_up

sys.path.insert(0, str(Path(__file__).parent))
import finite_volumes

# the quick textbook springs: the heat is the same loop
MODEL = MeshModel.consistent().override(
    friction="benedict-kelley", stiffness="textbook-30-degree", sharing="equal"
)
AMBIENT = 293.15
OIL = lubricant("M100")
POINT = Duty.steady(200.0, 100.0, ambient=AMBIENT)


def duty(*rows: tuple[float, float, float], ambient: float = AMBIENT) -> Duty:
    """Rows of (minutes, rad/s, N m); the last says the end."""
    time, speed, torque = np.array(rows).T
    return Duty(
        time=60.0 * time,
        speed=speed[:-1],
        torque=torque[:-1],
        ambient=np.full(speed.size - 1, ambient),
    )


def run(pair: GearPair, what: Duty = POINT, **how: object) -> WarmUp:
    return warm_up(pair, what, OIL, 125e-6, MODEL, **how)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def other() -> GearPair:
    """19:47, 3 mm, 25 degrees, profile shifts: nobody's pair."""
    angle = np.deg2rad(25.0)
    return GearPair(
        Gear(19, 3e-3, pressure_angle=angle, profile_shift=0.3, face_width=22e-3,
             bore_radius=12e-3, roughness=0.6e-6),
        Gear(47, 3e-3, pressure_angle=angle, profile_shift=0.1, face_width=20e-3,
             bore_radius=20e-3, roughness=0.5e-6),
    )  # fmt: skip


@pytest.fixture(scope="module")
def steadily(rig: GearPair) -> WarmUp:
    return run(rig)


def test_a_leap_of_the_speed_jams_at_once() -> None:
    """Centrifugal growth belongs to the piece: the jam is told where the faster one begins."""
    pair = GearPair(Gear(40, 4e-3), Gear(80, 4e-3))
    work = duty((0.0, 100.0, 1.0), (1.0, 2600.0, 1.0), (1.02, 0.0, 0.0))
    course = warm_up(pair, work, OIL, 25e-6, MODEL, tolerance=0.1)
    assert course.jams.tolist() == [60.0]
    assert course.worst.piece == 1
    assert course.half_backlash[course.piece == 0].min() > 24e-6


def test_starts_at_the_ambient_and_ends_at_the_steady_state(
    rig: GearPair, steadily: WarmUp
) -> None:
    steady = heat_balance(rig, 200.0, 100.0, OIL, 125e-6, MODEL)
    assert steady.settled.all()
    assert steadily.course.settled
    # many moments are asked for at once
    assert steadily.course.evaluations < 40
    for name, values in steadily.temperatures.items():
        assert values.shape == steadily.time.shape
        assert values[0] == pytest.approx(AMBIENT, abs=1e-9)
        assert values[-1] == pytest.approx(float(np.ravel(steady.steady[name])[0]), abs=0.02)
    last = float(np.asarray(steadily.losses.mesh)[-1])
    assert last == pytest.approx(float(np.asarray(steady.losses.mesh)[0]), rel=1e-3)
    tooth, housing = (steadily.temperatures[n] for n in ("pinion_tooth", "housing"))
    # friction starts at the teeth: they lead
    assert np.all(tooth[1:] > housing[1:])


def test_heat_adds_up_and_the_losses_are_those_of_the_chain(steadily: WarmUp) -> None:
    course = steadily.course
    assert course.imbalance.max() < 1e-6
    # the heat counted in is the losses of the stored moments, by quadrature
    whole = sum(
        np.asarray(getattr(steadily.losses, n))
        for n in ("mesh", "churning", "bearing_1", "bearing_2")
    )
    assert np.trapezoid(whole, steadily.time) == pytest.approx(course.heat_in[-1], rel=2e-3)


def test_the_first_second_heats_the_teeth_by_their_loss_alone(rig: GearPair) -> None:
    """At the start nothing flows: C dT/dt is the heat that enters the node."""
    found = run(rig, duty((0.0, 200.0, 100.0), (1e-3 / 60.0, 0.0, 0.0)))
    steel, stored = rig.pinion.material, 0.0
    for name, gear in (("pinion", rig.pinion), ("wheel", rig.wheel)):
        rim = 0.5 * np.pi * (gear.tip_radius**2 - gear.root_radius**2) * gear.face_width
        rise = found.temperatures[f"{name}_tooth"][-1] - AMBIENT
        stored += steel.density * steel.specific_heat * rise * rim
    assert stored == pytest.approx(float(np.asarray(found.losses.mesh)[0]) * 1e-3, rel=2e-3)


def test_finer_steps_change_nothing_that_is_told(rig: GearPair, steadily: WarmUp) -> None:
    fine = run(rig, duty((0.0, 200.0, 100.0), (20.0, 0.0, 0.0)), tolerance=1e-5)
    for name, t in fine.course.temperatures.items():
        assert np.abs(t - steadily.course.at(fine.time)[name]).max() < 0.02


def test_a_pair_at_rest_cools_through_oil_and_shafts(rig: GearPair) -> None:
    found = run(rig, duty((0.0, 0.0, 0.0), (600.0, 0.0, 0.0)), start=AMBIENT + 60.0)
    for name in ("pinion_tooth", "wheel_body", "oil", "housing"):
        course = found.temperatures[name]
        # no warmer again by more than what the course errs
        assert np.all(np.diff(course) < found.course.error)
    assert 0.0 < found.course.error <= 1e-3
    assert found.course.heat_in[-1] == 0.0
    assert found.course.imbalance.max() < 1e-6
    # everything goes to the air in the end
    assert -found.course.kept[-1] == pytest.approx(found.course.heat_out[-1], rel=1e-6)
    assert found.temperatures["housing"][-1] == pytest.approx(AMBIENT, abs=1.0)


def test_load_steps_and_a_stop_are_followed(rig: GearPair) -> None:
    rows = ((0.0, 300.0, 150.0), (10.0, 300.0, 0.0), (15.0, 0.0, 0.0), (20.0, 150.0, 80.0),
            (30.0, 0.0, 0.0))  # fmt: skip
    found = run(rig, duty(*rows))
    losses, piece = np.asarray(found.losses.mesh), found.piece
    assert np.all(losses[piece == 0] > 0.0)
    assert np.all(losses[(piece == 1) | (piece == 2)] == 0.0)
    assert np.all(np.asarray(found.losses.churning)[piece == 1] > 0.0)
    assert np.all(np.asarray(found.losses.churning)[piece == 2] == 0.0)
    assert found.course.imbalance.max() < 1e-6
    # the least backlash is just where the load goes, and is found there
    assert found.worst.time == pytest.approx(600.0, abs=1.0)
    assert found.worst.half_backlash == pytest.approx(found.half_backlash.min(), abs=1e-12)
    # a jump is there twice: the same temperatures, other losses
    at = np.flatnonzero(np.diff(found.time) == 0.0)
    assert found.time[at].tolist() == [600.0, 900.0, 1200.0]
    for values in found.course.temperatures.values():
        np.testing.assert_allclose(values[at], values[at + 1], atol=1e-9)


def test_a_heavy_housing_makes_the_worst_moment_one_on_the_way(rig: GearPair) -> None:
    """The gears warm first; then the housing opens the axes again."""
    box = Gearbox(surroundings=Surroundings(housing_mass=400.0))
    found = run(rig, Duty.steady(314.159, 100.0, ambient=AMBIENT), gearbox=box)
    steady = heat_balance(rig, 314.159, 100.0, OIL, 125e-6, MODEL, gearbox=box)
    left = Clearance(HotPair(rig, steady.operating, MODEL), np.arange(PHASES) / PHASES)
    for_good = float(left.half_backlash.min())
    assert 5.0 < found.worst.time / 60.0 < 120.0
    assert found.worst.half_backlash < for_good - 1e-8
    assert found.half_backlash[-1] == pytest.approx(for_good, abs=3e-8)
    # located between the stored moments: no moment around it is lower
    around = found.worst.time * np.linspace(0.8, 1.2, 41)
    gaps = _gap(found, rig, found.course.at(around))
    assert found.worst.half_backlash <= gaps.min() + 1e-12


def _gap(found: WarmUp, pair: GearPair, state: dict[str, np.ndarray]) -> np.ndarray:
    bodies = node_temperatures(state, AMBIENT)
    count = state["oil"].size
    at = replace(
        found.operating,
        speed=np.full(count, 314.159),
        torque=np.full(count, 100.0),
        oil_temperature=state["oil"],
        temperatures=bodies,
    )
    return Clearance(HotPair(pair, at, MODEL), np.arange(PHASES) / PHASES).half_backlash.min(axis=1)


def test_a_jam_is_located_and_the_margin_ends_there(rig: GearPair) -> None:
    box = Gearbox(measured={"housing": AMBIENT})
    found = warm_up(rig, duty((0.0, 314.0, 250.0), (60.0, 0.0, 0.0)), OIL, 8e-6, MODEL, gearbox=box)
    assert found.jams.size == 1
    state = {n: np.atleast_1d(t) for n, t in found.course.at(found.jams[0]).items()}
    state["housing"] = np.array([AMBIENT])
    after = found.time > found.jams[0]
    assert np.all(found.half_backlash[after] < 0.0)
    assert np.all(found.half_backlash[~after] > 0.0)
    margin = np.interp(found.jams[0], found.time, found.margin)
    assert margin == pytest.approx(0.0, abs=0.05)
    assert found.worst.half_backlash < 0.0
    assert found.temperatures["housing"].tolist() == [AMBIENT] * found.time.size


def test_a_measured_node_is_held_from_the_start(rig: GearPair) -> None:
    work = duty((0.0, 200.0, 100.0), (10.0, 0.0, 0.0))
    found = run(rig, work, gearbox=Gearbox(measured={"oil": 343.15}))
    assert set(found.temperatures["oil"].tolist()) == {343.15}
    assert found.held == {"oil": 343.15}
    # located between the moments, with a node that is no part of the course's state
    assert found.worst.half_backlash <= found.half_backlash.min()
    assert not found.jams.size
    assert found.course.imbalance.max() < 1e-6
    # the hot bath gives heat: what comes in through it leaves with a minus
    assert found.course.heat_out[-1] < 0.0
    assert found.temperatures["wheel_body"][-1] > AMBIENT + 5.0


def test_a_start_may_be_given_for_all_nodes_or_by_name(rig: GearPair) -> None:
    short = duty((0.0, 200.0, 100.0), (0.1, 0.0, 0.0))
    whole = run(rig, short, start=330.0)
    assert all(
        t[0] == pytest.approx(330.0) for n, t in whole.temperatures.items() if n != "ambient"
    )
    named = run(rig, short, start={"oil": 340.0})
    assert named.temperatures["oil"][0] == pytest.approx(340.0)
    assert named.temperatures["housing"][0] == pytest.approx(AMBIENT)
    with pytest.raises(InputError, match=r"^start: got 'oill'; allowed .*oil"):
        run(rig, short, start={"oill": 340.0})
    with pytest.raises(InputError, match=r"^start: got 60 K .*; allowed -70\.\.600 degC; did you"):
        run(rig, short, start=60.0)


def test_impossible_duties_are_one_line(rig: GearPair) -> None:
    for time in ([0.0], [1.0, 2.0], [0.0, 0.0], [0.0, np.nan]):
        with pytest.raises(InputError, match=r"^duty\.time: got \d times; allowed two or more"):
            Duty(time=np.array(time), speed=np.ones(1), torque=np.ones(1), ambient=np.ones(1))
    with pytest.raises(InputError, match=r"^duty\.speed: got 2 values; allowed one a piece, 1$"):
        Duty(time=np.array([0.0, 1.0]), speed=np.ones(2), torque=np.ones(1), ambient=np.ones(1))
    with pytest.raises(InputError, match=r"^duty\.ambient: got 20 K .*; did you mean 293\.15"):
        Duty.steady(100.0, 50.0, ambient=20.0)


def test_another_pair_has_its_own_worst_moment(other: GearPair) -> None:
    rows = ((0.0, 500.0, 60.0), (30.0, 500.0, 10.0), (60.0, 0.0, 0.0))
    found = warm_up(other, duty(*rows), lubricant("M220"), 75e-6, MODEL)
    assert found.course.imbalance.max() < 1e-6
    assert 0.0 < found.worst.half_backlash < 75e-6
    assert 0.0 < found.worst.time <= 1800.0
    assert found.worst.margin > 0.0
    assert found.jams.size == 0


# --- against finite volumes ------------------------------------------------------------------

TIMES = np.array([30.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 2400.0, 5e3, 1e4, 3e4])


@pytest.mark.parametrize("which", ["rig", "other"])
def test_gears_and_housing_against_finite_volumes(
    which: str, rig: GearPair, other: GearPair
) -> None:
    """Within 3 % of each node's excess in the end, from the first half minute on.

    Constant losses, the same film coefficients at the same oil temperature. See
    ``finite_volumes.py`` for the mesh.
    """
    pair, speed, heat = (rig, 314.0, 600.0) if which == "rig" else (other, 600.0, 150.0)
    around = Surroundings()
    losses = Losses(mesh=heat, partition_1=0.55, churning=100.0, bearing_1=10.0, bearing_2=10.0)
    exact = finite_volumes.run(pair, speed, losses, OIL, around, TIMES)

    def network(state: State):  # type: ignore[no-untyped-def]
        return thermal_network(pair.pinion, pair.wheel, speed, losses, OIL, state["oil"], around)

    nodes = network({"oil": np.array([AMBIENT])}).free
    course = follow([Stretch(end=3e4, network=network)], dict.fromkeys(nodes, AMBIENT))
    for name, values in course.at(TIMES).items():
        excess = exact[name][-1] - AMBIENT
        assert np.abs(values - exact[name]).max() < 0.03 * excess, name
        # and of what it has at the time, once the rings of the body have warmed through
        late = TIMES >= 5000.0
        now = exact[name][late] - AMBIENT
        assert np.all(np.abs(values - exact[name])[late] < 0.03 * now), name
