"""Shafts and bearings in the thermal network: closed forms, limits, balances, refusals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from conftest import Compared
from own_shafts import SMOOTH, STEEL, Rubbing, Size, random_pair, random_train, train
from thermogear.base.errors import InputError
from thermogear.base.materials import lubricant
from thermogear.gears.geometry import Gear
from thermogear.heat.gearbox import Losses, Surroundings, thermal_network
from thermogear.heat.losses import bearing_loss
from thermogear.heat.lubrication import kinematic_viscosity
from thermogear.heat.network import ThermalNetwork
from thermogear.heat.shaft_heat import (
    BearingLoss,
    CoefficientFriction,
    HeatedBearing,
    ShaftHeat,
    inner_share,
    lever_shares,
    ring_capacities,
    ring_conductance,
)
from thermogear.shafts.train import Section, Shaft

OIL = lubricant("M100")
WARM = 340.0
PINION = Gear(teeth=25, module=3e-3, bore_radius=0.0125, face_width=0.02)
WHEEL = Gear(teeth=50, module=3e-3, bore_radius=0.0125, face_width=0.02)
HUGE = Size(elements=10**9)
"""A bearing that conducts as if its rings were one."""


def watts(chain: ShaftHeat, value: float) -> dict[str, BearingLoss]:
    return {name: BearingLoss(loss=value) for name in chain.named}


def network(chain: ShaftHeat | None, value: float = 0.0, **around: float) -> ThermalNetwork:
    bearings = {} if chain is None else watts(chain, value)
    losses = Losses(mesh=300.0, partition_1=0.6, churning=20.0, contact=9.0, bearings=bearings)
    surroundings = Surroundings(train=chain, **around)  # type: ignore[arg-type]
    return thermal_network(PINION, WHEEL, 200.0, losses, OIL, WARM, surroundings)


@pytest.mark.parametrize(
    ("bearing", "expected"),
    [((9, 7.938e-3, 25e-3), 0.858), ((8, 15.081e-3, 40e-3), 2.725)],
    ids=["6205", "6308"],
)
def test_rings_conduct_what_the_source_says(
    bearing: tuple[int, float, float], expected: float
) -> None:
    elements, diameter, bore = bearing
    speed = 3000.0 * np.pi / 30.0
    found = ring_conductance(speed, elements=elements, element_diameter=diameter, bore=bore)
    assert float(found) == pytest.approx(expected, rel=1e-3)
    # by hand, with lengths as the source has them
    inside = np.log(speed * (2.0 * (0.5 * bore) + diameter) / 2000.0) - np.log(diameter) + 7.0
    assert float(found) == pytest.approx(elements * 590.0 * diameter**2 * np.sqrt(inside))
    speeds = np.array([-50.0, 0.0, 0.5, 1.0, 50.0, 500.0])
    over = ring_conductance(speeds, elements=elements, element_diameter=diameter, bore=bore)
    assert np.all(np.diff(over[1:]) >= 0.0)
    assert over[0] == over[4]
    assert over[1] == over[2] == over[3] > 0.0


def test_the_inner_ring_takes_more_of_the_heat_the_larger_the_balls() -> None:
    assert inner_share(element_diameter=1e-9, pitch_diameter=1.0) == pytest.approx(0.5)
    assert inner_share(element_diameter=11.5e-3, pitch_diameter=43.5e-3) == pytest.approx(
        0.7855, abs=1e-4
    )
    whole, leaning = (
        inner_share(angle, element_diameter=9.5e-3, pitch_diameter=46e-3) for angle in (0.0, 0.7)
    )
    assert 0.5 < leaning < whole
    chain = train()
    found = chain.sources(watts(chain, 10.0))
    assert sum(map(float, found.values())) == pytest.approx(40.0, rel=1e-15)
    assert float(found["wheel_bearing_2_inner"]) > float(found["wheel_bearing_2_outer"]) > 0.0


@pytest.mark.parametrize("place", [0.03, 0.1, 0.17, 0.26, -0.05])
def test_lever_shares_balance_force_and_moment(place: float) -> None:
    first, second = lever_shares([0.0, 0.2], gear_position=place)
    # with their signs: the nearer support of an overhung gear carries more than the force
    signs = (1.0 if place < 0.2 else -1.0, 1.0 if place > 0.0 else -1.0)
    assert signs[0] * first + signs[1] * second == pytest.approx(1.0)
    assert signs[1] * second * 0.2 == pytest.approx(place)


def test_each_bearing_carries_what_the_levers_say_or_what_is_given() -> None:
    chain = train()
    assert chain.shares == dict.fromkeys(chain.named, 0.5)
    shaft = replace(chain.shafts[0], gear_position=0.035)
    bent = replace(chain, shafts=(shaft, chain.shafts[1]))
    assert bent.shares["pinion_bearing_1"] == pytest.approx(0.75)
    assert bent.shares["pinion_bearing_2"] == pytest.approx(0.25)
    third = replace(chain.bearings[0], position=0.1)
    given = [replace(one, share=0.4) for one in (*chain.bearings[:2], third)]
    three = replace(chain, bearings=(*given, *chain.bearings[2:]))
    assert three.shares["pinion_bearing_3"] == 0.4
    with pytest.raises(InputError, match=r"^bearings: got 3 at 0, 100, 140 mm; allowed two on a"):
        replace(chain, bearings=(*chain.bearings, third))


def test_without_friction_and_with_huge_conductances_it_is_the_network_without_bearings(
    compared: Compared,
) -> None:
    """Same shafts, same seats, at any mix of them."""
    for length, seat in ((0.06, 10.0), (0.02, 100.0), (0.15, 1e3)):
        chain = train(length=length, size=HUGE, friction=SMOOTH, seat=seat)
        known = network(None, shaft_length=length, bearing_conductance=seat).steady()
        found = network(chain).steady()
        apart = [float(found[n] - known[n]) for n in known.temperatures]
        compared("rings that are one", "one conductance a bearing", np.array(apart), 1e-6, "K")
        # nor does any mass go: the rings' is on top
        chain = train(length=length)
        held = network(chain).capacities
        rings = 2.0 * sum(ring_capacities(Size(), STEEL))
        mine = sum(
            c for name, c in held.items() if name.startswith(("pinion_bearing", "pinion_shaft"))
        )
        whole = network(None, shaft_length=length).capacities["pinion_shaft"]
        assert mine - rings == pytest.approx(whole, rel=1e-12)


def test_sections_conduct_in_series_and_the_far_bearing_through_the_near_one() -> None:
    """An overhung gear: one chain from gear to the first and on to the second bearing."""
    sections = (
        Section(length=0.05, outer_diameter=0.03, material=STEEL),
        Section(length=0.04, outer_diameter=0.04, inner_diameter=0.01, material=STEEL),
        Section(length=0.06, outer_diameter=0.03, material=STEEL),
    )
    shaft = Shaft(sections=sections, gear_position=0.12)
    overhung = [
        HeatedBearing(shaft="pinion", position=x, size=Size(), friction=SMOOTH, share=1.0, seat=8.0)
        for x in (0.07, 0.01)
    ]
    chain = ShaftHeat(
        shafts=(shaft, train().shafts[1]), bearings=(*overhung, *train().bearings[2:])
    )
    links, held = chain.paths("pinion", 0.02, 200.0)
    found = {(x.first, x.second): float(np.asarray(x.conductance)) for x in links}
    k = STEEL.thermal_conductivity
    thin, thick = (0.25 * np.pi * a for a in (0.03**2, 0.04**2 - 0.01**2))
    near, far = "pinion_bearing_2", "pinion_bearing_1"
    assert found["pinion_shaft", f"{near}_inner"] == pytest.approx(
        1.0 / (0.02 / (k * thin) + 0.02 / (k * thick))
    )
    assert found[f"{near}_inner", f"{far}_inner"] == pytest.approx(
        1.0 / (0.02 / (k * thick) + 0.04 / (k * thin))
    )
    assert found[f"{far}_outer", "housing"] == 8.0
    assert found[f"{far}_inner", f"{far}_outer"] == pytest.approx(
        float(ring_conductance(200.0, elements=9, element_diameter=7.938e-3, bore=25e-3))
    )
    # no mass is lost or counted twice
    mass = STEEL.density * STEEL.specific_heat * (0.11 * thin + 0.04 * thick)
    rings = 2.0 * sum(ring_capacities(Size(), STEEL))
    assert sum(held.values()) == pytest.approx(mass + rings, rel=1e-12)


def test_rings_weigh_about_what_catalogues_say() -> None:
    for size, kilograms in (
        (Size(), 0.128),
        (
            Size(
                bore=40e-3, outside_diameter=90e-3, width=23e-3, pitch_diameter=65e-3,
                element_diameter=15.081e-3, elements=8,
            ),
            0.63,
        ),
    ):  # fmt: skip
        assert sum(ring_capacities(size, STEEL)) / STEEL.specific_heat == pytest.approx(
            kilograms, rel=0.1
        )


def test_rings_over_the_shaft_they_sit_on() -> None:
    """One bearing in steady state by hand: dT = q_inner/(G_ring) with no heat from the gear."""
    chain = train(seat=1e12)
    found = network(chain, value=6.0).steady()
    cold = {"pinion_shaft": 300.0, "housing": 300.0}
    free = network(chain, value=6.0)
    held = replace(free, fixed={**free.fixed, **cold}).steady()
    ring = float(ring_conductance(200.0, elements=9, element_diameter=7.938e-3, bore=25e-3))
    along = STEEL.thermal_conductivity * 0.25 * np.pi * 0.025**2 / 0.06
    share = inner_share(element_diameter=7.938e-3, pitch_diameter=38.5e-3)
    hotter = float(held["pinion_bearing_1_inner"]) - 300.0
    assert hotter * (ring + along) == pytest.approx(6.0 * share, rel=1e-9)
    # both ends alike: so are their bearings
    assert float(found["pinion_bearing_1_inner"]) == pytest.approx(
        float(found["pinion_bearing_2_inner"]), abs=1e-9
    )


def test_loss_is_moment_times_speed_at_the_viscosity_of_the_bearing() -> None:
    chain = train(friction=Rubbing(thick=0.4, arm=3e-6))
    at = {node: np.array([330.0, 350.0]) for node in chain.nodes}
    at["wheel_bearing_1_outer"] = np.array([310.0, 310.0])
    speed = np.array([100.0, 0.0])
    found = chain.losses(at, OIL, np.array([2000.0, 500.0]), (speed, 0.5 * speed))
    one = found["wheel_bearing_1"]
    np.testing.assert_allclose(one.temperature, [320.0, 330.0])
    np.testing.assert_allclose(one.viscosity, kinematic_viscosity(OIL, np.array([320.0, 330.0])))
    nu = float(np.asarray(one.viscosity)[0])
    expected = (0.4 * (nu * 50.0) ** (2.0 / 3.0) + 3e-6 * 1000.0) * 50.0
    np.testing.assert_allclose(one.loss, [expected, 0.0], rtol=1e-12)


def test_random_gearboxes_close_their_balance(compared: Compared) -> None:
    random, gaps = np.random.default_rng(11), []
    for _ in range(20):
        pair = random_pair(random)
        chain = random_train(random, pair)
        bearings = {name: BearingLoss(loss=random.uniform(0.0, 60.0, 5)) for name in chain.named}
        losses = Losses(mesh=random.uniform(0.0, 900.0, 5), churning=30.0, bearings=bearings)
        around = Surroundings(train=chain, oil_flow=float(random.uniform(0.0, 1e-4)))
        steady = thermal_network(
            pair.pinion, pair.wheel, random.uniform(1.0, 500.0, 5), losses, OIL, WARM, around
        ).steady()
        made = sum(np.asarray(x) for x in (losses.mesh, 30.0, losses.bearing_1, losses.bearing_2))
        gaps.append(sum(steady.heat_out.values()) / made - 1.0)
    compared("heat out of 20 gearboxes with bearings", "their losses", np.array(gaps), 1e-10)


def test_the_sums_of_both_shafts_follow_from_the_bearings() -> None:
    chain = train()
    found = Losses(
        mesh=1.0, bearings=watts(chain, 3.0) | {"wheel_bearing_2": BearingLoss(loss=5.0)}
    )
    assert (float(found.bearing_1), float(found.bearing_2)) == (6.0, 8.0)  # type: ignore[arg-type]
    lost = found.unknown_where(np.array([False, True]))
    np.testing.assert_array_equal(lost.bearings["wheel_bearing_2"].loss, [5.0, np.nan])
    with pytest.raises(InputError, match=r"^losses.bearing_1: got beside the bearings one by one"):
        Losses(mesh=1.0, bearing_1=2.0, bearings=watts(chain, 1.0))
    with pytest.raises(InputError, match=r"losses.bearings: got none; allowed pinion_bearing_1, "):
        thermal_network(PINION, WHEEL, 10.0, Losses(mesh=1.0), OIL, WARM, Surroundings(train=chain))
    with pytest.raises(InputError, match=r"losses.wheel_bearing_1: got -1.0 W; allowed >= 0"):
        Losses(mesh=1.0, bearings={"wheel_bearing_1": BearingLoss(loss=-1.0)})


def test_what_cannot_be_is_refused_in_one_line() -> None:
    one = train().bearings[0]
    for change, message in (
        ({"shaft": "third"}, r"bearing.shaft: got 'third'; allowed pinion | wheel"),
        ({"share": -0.1}, r"bearing.share: got -0.1; allowed >= 0"),
        ({"seat": 0.0}, r"bearing.seat: got 0.0 W/K; allowed > 0 W/K"),
        ({"size": Size(element_diameter=0.02)}, r"bearing: got 9 elements of 20 mm between"),
    ):
        with pytest.raises(InputError, match="^" + message.replace("|", r"\|")):
            replace(one, **change)  # type: ignore[arg-type]
    chain = train()
    with pytest.raises(InputError, match=r"pinion shaft: got no bearing; allowed one or more"):
        replace(chain, bearings=chain.bearings[2:])
    with pytest.raises(InputError, match=r"a bearing or gear at 500 mm; allowed 0..140 mm"):
        replace(chain, bearings=(*chain.bearings, replace(one, position=0.5)))
    with pytest.raises(InputError, match=r"two bearings in one place; allowed apart"):
        replace(chain, bearings=(*chain.bearings, one))
    with pytest.raises(InputError, match=r"a bearing at 70 mm; allowed beyond the gear's face"):
        replace(chain, bearings=(*chain.bearings[1:], replace(one, position=0.07))).paths(
            "pinion", 0.02, 1.0
        )
    with pytest.raises(InputError, match=r"^bearings: got 3 at 0, 10, 20 mm; allowed two on a"):
        lever_shares([0.0, 0.01, 0.02], gear_position=0.005)
    with pytest.raises(InputError, match=r"bore > 0.83 element diameters"):
        ring_conductance(1.0, elements=9, element_diameter=0.02, bore=0.01)


def test_the_temperature_along_a_shaft_is_conductions_own() -> None:
    """A thermometer half way of a plain shaft shows the mean of both ends; on a thin part more."""
    assert train().along("wheel", face_width=0.02, distance=0.03) == (
        "wheel_bearing_1_inner",
        pytest.approx(0.5),
    )
    sections = (
        Section(length=0.06, outer_diameter=0.03, material=STEEL),
        Section(length=0.06, outer_diameter=0.06, material=STEEL),
    )
    overhung = Shaft(sections=sections, gear_position=0.01)
    chain = train()
    bearings = tuple(
        replace(one, position=place)
        for one, place in zip(chain.bearings[:2], (0.1, 0.05), strict=True)
    )
    bent = ShaftHeat(shafts=(overhung, chain.shafts[1]), bearings=bearings + chain.bearings[2:])
    node, share = bent.along("pinion", face_width=0.02, distance=0.015)
    assert (node, share) == ("pinion_bearing_1_inner", pytest.approx(0.5))
    with pytest.raises(InputError, match=r"^sensors.ring.distance: got 40 mm; allowed 0..30 mm"):
        bent.along("pinion", face_width=0.02, distance=0.04)


def test_a_bearing_of_which_no_more_is_known_is_one_node_with_a_coefficient() -> None:
    """Its friction and its conductance as without a train, only where it sits."""
    rubbing = CoefficientFriction(coefficient=0.0015, diameter=0.025)
    chain = train(friction=rubbing, size=None)
    assert chain.nodes == tuple(f"{name}_inner" for name in chain.named)
    known = thermal_network(
        PINION,
        WHEEL,
        200.0,
        Losses(mesh=300.0, churning=20.0),
        OIL,
        WARM,
        Surroundings(),
    ).steady()
    found = thermal_network(
        PINION,
        WHEEL,
        200.0,
        Losses(mesh=300.0, churning=20.0, bearings=watts(chain, 0.0)),
        OIL,
        WARM,
        Surroundings(train=chain),
    ).steady()
    for node in known.temperatures:
        assert float(found[node]) == pytest.approx(float(known[node]), abs=1e-9)
    at = dict.fromkeys(chain.nodes, np.array(WARM))
    losses = chain.losses(at, OIL, 4000.0, (200.0, 100.0))
    expected = bearing_loss(2000.0, 0.025, 100.0)
    assert float(np.asarray(losses["wheel_bearing_1"].loss)) == pytest.approx(float(expected))
    assert chain.sources(losses).keys() == set(chain.nodes)
