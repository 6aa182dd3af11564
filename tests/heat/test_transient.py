"""Networks in time: closed forms, heat that adds up, events, and where a course ends."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from thermogear.base.errors import ConvergenceError, InputError
from thermogear.heat.network import Link, ThermalNetwork
from thermogear.heat.transient import HOTTEST, Course, State, Stretch, follow

C, G, Q, T0 = 1000.0, 2.0, 100.0, 293.15
RATE = G / C


def one_node(source: float = Q, ambient: float = T0, slope: float = 0.0) -> object:
    """One node of capacity C; its source grows by ``slope`` W for every kelvin over T0."""

    def network(state: State) -> ThermalNetwork:
        heat = source + slope * (state["body"] - T0)
        return ThermalNetwork(
            (Link("body", "ambient", G),), {"body": heat}, {"ambient": ambient}, {"body": C}
        )

    return network


def run(stretches: list[tuple[float, object]], **how: object) -> Course:
    laws = [Stretch(end=end, network=law) for end, law in stretches]  # type: ignore[arg-type]
    return follow(laws, {"body": T0}, **how)  # type: ignore[arg-type]


def test_one_node_is_the_exponential() -> None:
    found = run([(2000.0, one_node())], tolerance=1e-5)
    exact = Q / G * -np.expm1(-RATE * found.time)
    assert np.abs(found.temperatures["body"] - T0 - exact).max() < 1e-3
    # heat in is Q t, and what is not kept has left
    np.testing.assert_allclose(found.heat_in, Q * found.time, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(found.heat_out, Q * found.time - C * exact, atol=1e-3 * C)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_the_error_follows_the_tolerance(tolerance: float) -> None:
    found = run([(2000.0, one_node())], tolerance=tolerance)
    exact = T0 + Q / G * -np.expm1(-RATE * found.time)
    worst = np.abs(found.temperatures["body"] - exact).max()
    assert 1e-3 * tolerance < worst < 20.0 * tolerance


def test_a_source_that_grows_with_the_temperature_slows_the_exponential_down() -> None:
    found = run([(3000.0, one_node(slope=1.0))], tolerance=1e-5)
    exact = Q / (G - 1.0) * -np.expm1(-(G - 1.0) / C * found.time)
    assert np.abs(found.temperatures["body"] - T0 - exact).max() < 1e-3


def test_a_source_that_grows_as_the_loss_heats_evenly() -> None:
    """No steady state, and nothing that leads to one: T - T0 = Q t/C."""
    found = run([(3000.0, one_node(slope=G))])
    np.testing.assert_allclose(found.temperatures["body"] - T0, Q / C * found.time, atol=1e-6)


def test_a_law_that_jumps_by_less_than_the_tolerance_is_followed_to_its_end() -> None:
    """The source falls by G times .8 mK where the node passes 50 K less .4 mK: it stays there."""

    def network(state: State) -> ThermalNetwork:
        heat = Q - np.where(state["body"] - T0 > Q / G - 4e-4, 8e-4 * G, 0.0)
        return ThermalNetwork(
            (Link("body", "ambient", G),), {"body": heat}, {"ambient": T0}, {"body": C}
        )

    found = run([(20000.0, network)])
    exact = Q / G * -np.expm1(-RATE * found.time)
    worst = np.abs(found.temperatures["body"] - T0 - exact).max()
    assert worst <= found.error + 4e-4
    assert found.error <= 1e-3


def test_jumps_of_source_and_ambient_are_begun_anew() -> None:
    pieces = [(500.0, one_node()), (900.0, one_node(0.0)), (1500.0, one_node(50.0, T0 - 20.0))]
    found = run(pieces, tolerance=1e-5)
    level, begin = T0, 0.0
    for place, (end, rest) in enumerate(
        [(500.0, T0 + 50.0), (900.0, T0), (1500.0, T0 - 20.0 + 25.0)]
    ):
        here = found.stretch == place
        t = found.time[here]
        assert (t[0], t[-1]) == (begin, end)
        exact = rest + (level - rest) * np.exp(-RATE * (t - begin))
        np.testing.assert_allclose(found.temperatures["body"][here], exact, atol=2e-3)
        level, begin = rest + (level - rest) * np.exp(-RATE * (end - begin)), end
    assert found.imbalance.max() < 1e-9


def tangle(state: State) -> ThermalNetwork:
    """Four nodes, two given ones, conductances and sources that depend on the temperatures."""
    a, b = state["a"], state["b"]
    links = (
        Link("a", "b", 0.5 * np.abs(a - b) ** 0.25 + 0.1),
        Link("b", "c", 3.0 + 0.01 * (b - T0)),
        Link("c", "d", 40.0),
        Link("d", "ambient", 5.0),
        Link("b", "cooler", 0.4),
    )
    return ThermalNetwork(
        links,
        {"a": 80.0 * np.exp(-0.01 * (a - T0)), "d": 3.0},
        {"ambient": T0, "cooler": T0 - 15.0},
        {"a": 50.0, "b": 800.0, "c": 3.0, "d": 9000.0},
    )


def test_a_linear_network_is_its_matrix_exponential() -> None:
    """Random networks of time constants from seconds to hours, within the tolerance asked for."""
    rng = np.random.default_rng(51)
    for tolerance in (1e-1, 1e-2, 1e-3) * 3:
        names = [f"n{k}" for k in range(7)]
        capacity = 10.0 ** rng.uniform(1.0, 5.0, 7)
        pairs = [(i, j) for i in range(7) for j in range(i) if rng.random() < 0.6 or i - j == 1]
        links = [Link(names[i], names[j], 10.0 ** rng.uniform(-1.0, 1.5)) for i, j in pairs]
        network = ThermalNetwork(
            (*links, Link("n0", "ambient", 5.0)),
            dict(zip(names, rng.uniform(0.0, 60.0, 7), strict=True)),
            {"ambient": T0},
            dict(zip(names, capacity, strict=True)),
        )
        start = dict(zip(names, T0 + rng.uniform(-20.0, 60.0, 7), strict=True))

        def constant(state: State, network: ThermalNetwork = network) -> ThermalNetwork:
            return network

        found = follow([Stretch(end=2e4, network=constant)], start, tolerance=tolerance)
        steady = network.steady()
        inner = network.laplacian()[np.ix_(*[[network.nodes.index(n) for n in names]] * 2)]
        away = np.array([start[n] - steady[n] for n in names])
        exact = expm(-found.time[:, None, None] * inner / capacity[:, None]) @ away
        worst = max(
            np.abs(found.temperatures[n] - steady[n] - exact[:, k]).max()
            for k, n in enumerate(names)
        )
        assert worst <= found.error <= tolerance
        assert found.evaluations < 40


def test_a_law_that_bends_is_what_another_method_finds() -> None:
    start = {"a": T0, "b": T0 + 30.0, "c": T0, "d": T0 - 10.0}
    found = follow([Stretch(end=4e4, network=tangle)], start, tolerance=1e-2)
    nodes = tuple(found.temperatures)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        network = tangle(dict(zip(nodes, y, strict=True)))
        kept = network.flows(dict(zip(nodes, y, strict=True)))[0]
        return np.asarray(kept / np.array([network.capacities[name] for name in nodes]))

    first = [start[name] for name in nodes]
    other = solve_ivp(rates, (0.0, 4e4), first, "Radau", found.time, rtol=1e-8, atol=1e-7)
    worst = max(np.abs(found.temperatures[n] - other.y[k]).max() for k, n in enumerate(nodes))
    assert worst <= found.error <= 1e-2


def test_heat_adds_up_at_every_moment() -> None:
    start = {"a": T0, "b": T0 + 30.0, "c": T0, "d": T0 - 10.0}
    found = follow([Stretch(end=4e4, network=tangle)], start, times=[1.0, 17.0, 39_999.0])
    assert found.imbalance.max() < 1e-7
    assert {1.0, 17.0, 39_999.0} <= set(found.time.tolist())
    # not only by construction: heat in and out again by quadrature of what flows
    t = np.linspace(0.0, 4e4, 40_001)
    state = found.at(t)
    kept, source, out = tangle(state).flows(state)
    np.testing.assert_allclose(kept.sum(axis=-1), source - out, atol=1e-9)
    assert np.trapezoid(source, t) == pytest.approx(found.heat_in[-1], rel=2e-4)
    assert np.trapezoid(out, t) == pytest.approx(found.heat_out[-1], rel=2e-4)


def test_states_between_the_moments_are_those_of_the_steps() -> None:
    pieces = [(500.0, one_node()), (900.0, one_node(0.0))]
    found = run(pieces, tolerance=1e-5)
    np.testing.assert_allclose(found.at(found.time)["body"], found.temperatures["body"], atol=1e-9)
    assert found.at(250.0)["body"] == pytest.approx(T0 + 50.0 * -np.expm1(-0.5), abs=1e-3)
    with pytest.raises(InputError, match=r"^times: got .* s; allowed 0\.\.900 s"):
        found.at([901.0])


def test_a_falling_quantity_is_located() -> None:
    def left(state: State, place: int) -> np.ndarray:
        return T0 + 30.0 - state["body"] - 50.0 * place

    found = run([(2000.0, one_node()), (4000.0, one_node(0.0))])
    assert found.falls(left).tolist() == pytest.approx([-np.log(0.4) / RATE], abs=0.3)


def test_a_stretch_without_an_end_comes_to_rest() -> None:
    found = run([(np.inf, one_node())], settled_within=0.05)
    assert found.settled
    assert T0 + 50.0 - found.temperatures["body"][-1] == pytest.approx(0.05, rel=0.05)
    still = run([(np.inf, one_node(0.0))])
    assert still.settled
    assert still.time[-1] == pytest.approx(1.0 / RATE)
    np.testing.assert_allclose(still.temperatures["body"], T0, atol=1e-9)


def test_what_runs_away_ends_where_no_gear_lives() -> None:
    found = run([(1e5, one_node(slope=3.0)), (2e5, one_node())])
    assert found.too_hot
    assert found.temperatures["body"][-1] == pytest.approx(HOTTEST, abs=1e-2)
    assert found.stretch.max() == 0
    # T - T0 = Q/(3 - G) (exp((3 - G) t/C) - 1)
    assert found.time[-1] == pytest.approx(C * np.log1p((HOTTEST - T0) / Q), rel=1e-3)


def test_what_is_impossible_is_refused() -> None:
    for ends in ([], [0.0], [5.0, 5.0], [5.0, 2.0], [np.nan], [np.inf, 3.0]):
        with pytest.raises(InputError, match=r"^stretches: got ends .*; allowed one or more"):
            run([(end, one_node()) for end in ends])
    with pytest.raises(InputError, match=r"^tolerance: got 0.0 K; allowed > 0 K$"):
        run([(1.0, one_node())], tolerance=0.0)

    def bare(state: State) -> ThermalNetwork:
        return ThermalNetwork((Link("body", "ambient", G),), {}, {"ambient": T0})

    with pytest.raises(InputError, match=r"^capacity of: got body; the course in time needs it"):
        run([(1.0, bare)])


def test_a_law_that_gives_no_numbers_is_no_course() -> None:
    def lost(state: State) -> ThermalNetwork:
        if float(np.max(state["body"])) > T0 + 10.0:
            raise ConvergenceError("lost")
        return one_node()(state)  # type: ignore[operator]

    with pytest.raises(ConvergenceError, match=r"^lost$"):
        run([(2000.0, lost)])


def test_progress_rises_to_the_end() -> None:
    told: list[tuple[str, int, int]] = []
    run([(2000.0, one_node())], progress=lambda *said: told.append(said))
    stages, done, total = zip(*told, strict=True)
    assert len(set(stages)) == 1
    assert set(total) == {1000}
    assert max(done) == 1000


def lagging(end: float, rate: float, *, exactly: bool = False, asked: list[int]) -> Stretch:
    """A node whose source falls with its temperature as exp(-(T - T0)/60 K): costly, or lagging."""

    def heat(state: State) -> np.ndarray:
        asked.append(state["body"].size)
        return np.exp(-(state["body"] - T0) / 60.0)[:, None]

    def network(state: State) -> ThermalNetwork:
        source = rate * (heat(state) if exactly else state["lagging"])[:, 0]
        return ThermalNetwork(
            (Link("body", "ambient", G),), {"body": source}, {"ambient": T0}, {"body": C}
        )

    return Stretch(end=end, network=network, lagging=None if exactly else heat)


def test_what_lags_is_asked_for_at_few_states_and_the_course_is_the_same() -> None:
    for rate in (50.0, 200.0, 600.0):
        few: list[int] = []
        every: list[int] = []
        course = follow([lagging(3000.0, rate, asked=few)], {"body": T0}, tolerance=1e-2)
        exact = follow(
            [lagging(3000.0, rate, exactly=True, asked=every)], {"body": T0}, tolerance=1e-5
        )
        apart = np.abs(course.at(exact.time)["body"] - exact.temperatures["body"]).max()
        assert apart <= course.error <= 1e-2
        assert sum(few) < 0.2 * sum(every)
    # two counts of one course: what lags is asked for less often than the network
    again: list[int] = []
    follow([lagging(3000.0, rate, exactly=True, asked=again)], {"body": T0}, tolerance=1e-2)
    assert sum(few) < sum(again)
