"""The exact maps against a slow set-up, against other sub-steps, and where contact grazes."""

import numpy as np
import pytest

from said import numbers
from thermogear.base.errors import InputError
from thermogear.base.excitation import Periodic
from thermogear.dynamics import exact
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel

RNG = np.random.default_rng(3)


def uniform(low, high, count=128):
    return RNG.uniform(low, high, count)


KINDS = {
    "straight": TorsionalModel(
        damping_ratio=uniform(0.03, 0.1),
        frequency=uniform(0.5, 0.75),
        stiffness_amplitude=0.1,
        mean_force=0.35,
        force_amplitude=0.03,
    ),
    "one loss": TorsionalModel(
        damping_ratio=uniform(0.05, 0.2),
        frequency=uniform(1, 1.5),
        stiffness_amplitude=0.3,
        mean_force=0.1,
        force_amplitude=uniform(0.1, 0.3),
    ),
    "rattling": TorsionalModel(
        damping_ratio=uniform(0.1, 0.2),
        frequency=uniform(1.1, 1.35),
        stiffness_amplitude=uniform(0.1, 0.6),
        mean_force=0.017,
        force_amplitude=uniform(-1.19, -0.8),
    ),
    "back side": TorsionalModel(
        damping_ratio=uniform(0.05, 0.1),
        frequency=uniform(0.5, 0.8),
        stiffness_amplitude=0.2,
        mean_force=0.1,
        force_amplitude=uniform(0.3, 0.8),
    ),
    "slow": TorsionalModel(
        damping_ratio=uniform(0.02, 0.05),
        frequency=uniform(0.12, 0.35),
        stiffness_amplitude=0.3,
        mean_force=0.05,
        force_amplitude=uniform(0.3, 0.5),
    ),
    "tiny gap": TorsionalModel(
        damping_ratio=0.05,
        frequency=uniform(0.6, 1.4),
        stiffness_amplitude=0.3,
        mean_force=0.01,
        force_amplitude=0.4,
        half_backlash=uniform(1e-4, 1e-2),
    ),
    "undamped": TorsionalModel(
        damping_ratio=0.0,
        frequency=uniform(0.6, 1.4),
        stiffness_amplitude=0.2,
        mean_force=0.1,
        force_amplitude=uniform(0.1, 0.5),
    ),
}


def on_grid(lanes, count, order, periods):
    borders = np.arange(count + 1) / count
    maps = exact.prepare_maps(lanes, borders, np.zeros(count, np.uint8), order=order)
    state = exact.State.start(
        x=np.zeros(len(lanes)), y=np.zeros(len(lanes)), backlash=lanes.half_backlash
    )
    exact.advance(maps, state, periods, columns=2)
    return state


@pytest.mark.parametrize("kind", KINDS)
def test_error_after_ten_periods_is_rounding_times_the_orbits_own_sensitivity(kind, compared):
    lanes = KINDS[kind].lanes()
    scores = []
    for index, borders, _ in exact.layouts(lanes):
        mine = lanes.take(index)
        one = on_grid(mine, borders.size - 1, 12, 10)
        two = on_grid(mine, 2 * borders.size + 1, 16, 10)
        sensitivity = np.maximum(1.0, np.abs(one.tangent).sum(axis=0))
        gap = np.maximum(np.abs(one.x - two.x), np.abs(one.y - two.y))
        scores += list(gap / (sensitivity * np.maximum(1.0, np.abs(one.x))))
        assert np.array_equal(one.region, two.region)
        determinant = np.exp(-10 * mine.damping * mine.period)
        found = one.tangent[0] * one.tangent[3] - one.tangent[1] * one.tangent[2]
        assert found == pytest.approx(determinant, abs=1e-12 * float(sensitivity.max()) ** 2)
    finer = "the same motion on twice as many sub-steps"
    compared(
        "error after ten periods over the orbit's sensitivity, nine of ten",
        finer,
        np.percentile(scores, 90),
        1e-13,
    )
    compared(
        "error after ten periods over the orbit's sensitivity, greatest", finer, max(scores), 1e-12
    )


@pytest.mark.parametrize("offset", [-1e-3, -1e-6, -1e-9, 0.0, 1e-9, 1e-6, 1e-3])
def test_grazing_is_followed(offset):
    """Around w = .7733103 the closed orbit just touches the edge."""
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7733103356255804 + offset,
        stiffness_amplitude=0.1,
        mean_force=0.1,
        force_amplitude=0.05,
    )
    options = {"periods": 3, "initial_state": (1.1954104642733394, 0.01479006606425257)}
    exactly = simulate(model, **options)
    reference = simulate(model, method="adaptive", **options)
    assert np.abs(exactly.x - reference.x).max() < 1e-13
    assert np.abs(exactly.v - reference.v).max() < 1e-13


def test_a_start_on_an_edge_goes_where_its_velocity_points():
    for v in (0.3, -0.3):
        model = TorsionalModel(
            damping_ratio=0.05,
            frequency=0.9,
            stiffness_amplitude=0.2,
            mean_force=0.1,
            force_amplitude=0.3,
        )
        options = {"periods": 1, "initial_state": (1.0, v)}
        exactly = simulate(model, **options)
        reference = simulate(model, method="adaptive", **options)
        assert np.abs(exactly.x - reference.x).max() < 1e-11


def test_maps_agree_with_a_slow_set_up_in_extended_precision():
    """Fundamental solutions by plain series of 40 terms in long double."""
    k = Periodic(1.1, (0.3, 0.1 - 0.2j, 0.05j))
    force = Periodic(0.2, (0.5j, -0.1))
    lanes = DeadZoneModel(damping_ratio=0.07, frequency=0.8, stiffness=k, force=force).lanes()
    count, order = 48, 40
    borders = np.arange(count + 1) / count
    prepared = exact.prepare_maps(lanes, borders, np.zeros(count, np.uint8))
    maps = prepared.steps[:, 0, :10, :1]
    long = np.longdouble
    h = long(lanes.period[0]) / (2 * count)
    damping = long(lanes.damping[0])
    turn = long(np.pi) / count
    for n in (0, 17, 47):
        centre = 2 * long(np.pi) * (2 * n + 1) / (2 * count)
        series = []
        for table in (k, force):
            row = np.zeros(order + 1, np.clongdouble)
            row[0] = table.mean
            for rank, amplitude in enumerate(table.harmonics, start=1):
                term = np.clongdouble(amplitude) * np.exp(1j * rank * centre)
                for m in range(order + 1):
                    row[m] += term
                    term = term * (1j * rank * turn) / (m + 1)
            series.append(row.real)
        for contact in (True, False):
            ends = []
            for x0, y0, forced in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
                a = np.zeros(order + 3, long)
                a[0], a[1] = x0, y0
                for m in range(order + 1):
                    pull = np.dot(series[0][: m + 1], a[m::-1]) if contact else long(0)
                    push = forced * series[1][m]
                    a[m + 2] = h * h * (push - pull) - damping * h * (m + 1) * a[m + 1]
                    a[m + 2] /= (m + 2) * (m + 1)
                signs = (-1.0) ** np.arange(a.size)
                ranks = np.arange(a.size)
                ends.append(
                    [
                        (a * signs).sum(),
                        -(a * signs * ranks).sum() / h,
                        a.sum(),
                        (a * ranks).sum() / h,
                    ]
                )
            left = np.array([[e[0] for e in ends[:2]], [e[1] for e in ends[:2]]], float)
            right = np.array([[e[2] for e in ends[:2]], [e[3] for e in ends[:2]]], float)
            phi = right @ np.linalg.inv(left)
            nu = np.array(ends[2][2:], float) - phi @ np.array(ends[2][:2], float)
            mine = maps[n, :, 0]
            if contact:
                assert mine[:4] == pytest.approx(phi.T.ravel(), abs=1e-15)
                assert mine[4:6] == pytest.approx(nu, abs=1e-15)
            else:
                assert mine[6:8] == pytest.approx(phi[:, 1], abs=1e-15)
                assert mine[8:10] == pytest.approx(nu, abs=1e-15)


def test_substeps_grow_with_stiffness_over_frequency_and_with_harmonics():
    slow, fast = exact.substeps(
        TorsionalModel(
            damping_ratio=0.1,
            frequency=[0.05, 1.2],
            stiffness_amplitude=0.3,
            mean_force=0.1,
            force_amplitude=0.1,
        ).lanes()
    )
    assert slow > 4 * fast
    plain, rich = (
        exact.substeps(
            DeadZoneModel(
                damping_ratio=0.1,
                frequency=1.2,
                stiffness=Periodic(1.0, (0.2,) * n),
                force=Periodic(0.1),
            ).lanes()
        )[0]
        for n in (1, 40)
    )
    assert rich > 2 * plain


def test_a_frequency_too_low_for_the_maps_falls_back_to_fixed_steps():
    model = TorsionalModel(
        damping_ratio=0.1,
        frequency=1e-5,
        stiffness_amplitude=0.3,
        mean_force=0.1,
        force_amplitude=0.1,
    )
    with pytest.raises(InputError, match="more than 49152 sub-steps"):
        exact.substeps(model.lanes())
    data = simulate(model, periods=1, discard=0, samples_per_period=0, steps_per_period=64)
    assert data.attrs["method"] == "rk4"
    assert "sub-steps" in data.attrs["method_reason"]


def of_turn(mesh_periods: int, frequency: float = 0.7) -> DeadZoneModel:
    return DeadZoneModel(
        damping_ratio=0.05,
        frequency=frequency / mesh_periods,
        stiffness=Periodic(1.0, (0.02, *[0.0] * (mesh_periods - 2), 0.2)),
        force=Periodic(0.1, (0.05j, *[0.0] * (mesh_periods - 2), 0.3)),
        half_backlash=1.0,
        mesh_periods=mesh_periods,
    )


def test_a_lane_of_a_turn_moves_alone_as_beside_another():
    """Alone it has no table of eight lanes: the numbers are those behind its polynomials."""
    alone = of_turn(40).lanes()
    both = alone.take([0, 0])
    ends = []
    for lanes in (alone, both):
        ((_, borders, marks),) = exact.layouts(lanes)
        maps = exact.prepare_maps(lanes, borders, marks)
        state = exact.State.start(
            x=np.ones(len(lanes)), y=np.zeros(len(lanes)), backlash=maps.backlash
        )
        sections, _, _ = exact.advance(maps, state, 3, columns=2)
        assert maps.steps.size == (0 if lanes is alone else maps.half.shape[0] * 88)
        assert state.counts[0, 0] > 0
        ends.append((sections[:, :, 0], state.tangent[:, 0], state.spent[:, 0]))
    for one, other in zip(*ends, strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_turn_too_long_for_the_maps_names_the_longest_and_the_ways_out():
    lanes = of_turn(50_000).lanes()
    with pytest.raises(InputError) as refused:
        exact.substeps(lanes)
    longest = round(numbers(str(refused.value))[1])
    assert 2000 < longest < 50_000
    assert "--mean-tooth" in str(refused.value)
    assert exact.substeps(of_turn(longest).lanes()) <= exact.MOST_OF_TURN
