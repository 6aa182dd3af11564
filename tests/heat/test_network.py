"""Thermal networks: closed forms, energy balance, refusals."""

from dataclasses import replace

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.heat.network import Link, ThermalNetwork
from thermogear.heat.transient import Stretch, follow


def two_nodes(power: object = 50.0) -> ThermalNetwork:
    """body - oil - ambient with 4 and 10 W/K."""
    return ThermalNetwork(
        (Link("body", "oil", 4.0), Link("oil", "ambient", 10.0)),
        {"body": power, "oil": 20.0},  # type: ignore[dict-item]
        {"ambient": 293.15},
        {"body": 900.0, "oil": 5000.0},
    )


def test_two_nodes_against_their_closed_form(compared: Compared) -> None:
    state = two_nodes().steady()
    oil = 293.15 + 70.0 / 10.0
    found = [float(state["oil"]) / oil - 1.0, float(state["body"]) / (oil + 50.0 / 4.0) - 1.0]
    compared("steady temperatures of two nodes", "closed form", found, 1e-14)
    assert state.heat_out["ambient"] == pytest.approx(70.0, rel=1e-12)


def random_network(rng: np.random.Generator, shape: tuple[int, ...]) -> ThermalNetwork:
    names = [f"n{i}" for i in range(9)]
    links = [
        Link(names[i], names[i + 1], rng.uniform(0.1, 50.0, shape)) for i in range(len(names) - 1)
    ]
    links += [Link(names[0], names[5], rng.uniform(0.1, 50.0, shape))]
    links += [Link(names[3], "ambient", 8.0), Link(names[7], "oil", rng.uniform(1.0, 9.0, shape))]
    return ThermalNetwork(
        tuple(links),
        {name: rng.uniform(0.0, 500.0, shape) for name in names[::2]},
        {"ambient": 290.0, "oil": 360.0},
        {name: rng.uniform(200.0, 5000.0) for name in names},
    )


def test_energy_balance(compared: Compared) -> None:
    """What the sources give leaves through the given nodes, to 1e-10."""
    network = random_network(np.random.default_rng(7), (40,))
    state = network.steady()
    given = sum(np.asarray(v) for v in network.sources.values())
    left = sum(state.heat_out.values())
    compared(
        "heat that leaves a network of random links",
        "heat of its sources",
        (left - given) / given,
        1e-10,
    )
    assert np.max(state.residual / given) < 1e-10


def test_maximum_principle_without_sources() -> None:
    network = random_network(np.random.default_rng(3), (5,))
    quiet = ThermalNetwork(network.links, {}, network.fixed).steady()
    for value in quiet.temperatures.values():
        assert np.all((value >= 290.0 - 1e-9) & (value <= 360.0 + 1e-9))


def test_superposition_of_sources() -> None:
    base = two_nodes(0.0).steady()["body"]
    rises = [float(two_nodes(p).steady()["body"] - base) for p in (10.0, 25.0)]
    assert rises[1] / rises[0] == pytest.approx(2.5, rel=1e-12)


def test_batch_is_one_by_one() -> None:
    powers = np.array([[0.0, 10.0], [100.0, 1000.0]])
    batch = two_nodes(powers).steady()
    assert batch["body"].shape == (2, 2)
    for at in np.ndindex(2, 2):
        single = two_nodes(float(powers[at])).steady()
        assert batch["body"][at] == pytest.approx(float(single["body"]), rel=1e-14)


def test_single_node_warms_up_exponentially(compared: Compared) -> None:
    network = ThermalNetwork(
        (Link("body", "ambient", 5.0),), {"body": 100.0}, {"ambient": 300.0}, {"body": 1000.0}
    )
    times = np.array([0.0, 50.0, 200.0, 1e4])
    stretch = Stretch(end=1e4, network=lambda state: network)
    curve = follow([stretch], {"body": 300.0}, tolerance=1e-6).at(times)["body"]
    exact = 300.0 + 20.0 * -np.expm1(-times / 200.0)
    compared("warm-up of one node", "exponential in closed form", curve / exact - 1.0, 1e-8)


def held_at(network: ThermalNetwork, **temperatures: float) -> ThermalNetwork:
    """The same network with further nodes held at measured temperatures [K]."""
    return replace(network, fixed={**network.fixed, **temperatures})


def test_a_measured_node_overrides_its_balance() -> None:
    held = held_at(two_nodes(), oil=340.0).steady()
    assert held["oil"] == 340.0
    assert held["body"] == pytest.approx(340.0 + 12.5, rel=1e-14)
    # the ambient takes more than the sources give: the held node supplies the rest
    assert held.heat_out["ambient"] == pytest.approx(468.5, abs=1e-9)
    assert held.heat_out["oil"] == pytest.approx(-398.5, abs=1e-9)
    total = held.heat_out["oil"] + held.heat_out["ambient"]
    assert total == pytest.approx(70.0, rel=1e-10)


def test_all_nodes_given_needs_no_solution() -> None:
    held = held_at(two_nodes(), oil=340.0, body=350.0).steady()
    assert held["body"] == 350.0
    assert held.residual == 0.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Link("a", "a", 1.0), "link: got a to itself"),
        (lambda: Link("a", "b", -1.0), "conductance a-b: got -1.0; allowed >= 0 W/K"),
        (
            lambda: ThermalNetwork((Link("body", "oil", 1.0),), {}, {}),
            "thermal network: got body, oil; no conductance leads",
        ),
        (
            lambda: ThermalNetwork((Link("body", "oil", 1.0),), {"oli": 1.0}, {"oil": 300.0}),
            "thermal node: got 'oli'; did you mean 'oil'?",
        ),
        (
            lambda: held_at(two_nodes(), oil=-3.0),
            "temperature of oil: got -3.0 K; allowed > 0 K",
        ),
    ],
)
def test_impossible_networks_are_refused(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value).startswith(message)
