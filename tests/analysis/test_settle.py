"""Batched labels: the proofs of single lanes, whoever runs beside them."""

import numpy as np
import pytest

from thermogear.analysis.labels import labels
from thermogear.analysis.orbits import periodic_orbit
from thermogear.analysis.outcome import outcome_arrays, settle_with_status, start_of
from thermogear.analysis.settle import (
    CHAOTIC,
    DIVERGED,
    JAMMED,
    LABELS,
    PERIODIC,
    UNDECIDED,
    Rule,
    multipliers_of,
    polish,
    settle,
)
from thermogear.base.errors import InputError
from thermogear.base.vocabulary import STATUS
from thermogear.dynamics.bundle import bundles
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import return_map

# (zeta, w, eps, F_m, F_h), start, period, multiplier of the largest modulus: published to 1e-9
ORBITS = [
    ((0.05, 0.7, 0.1, 0.1, 0.05), (1.1, 0.0), 1, -0.5701884813724035 + 0.28711069280484924j),
    ((0.05, 0.7, 0.2, 0.1, 0.2), (2.0, 1.0), 1, 0.5557475263545375 + 0.3141530537229598j),
    ((0.05, 1.1, 0.2, 0.1, 0.2), (0.0, 0.0), 2, -0.3025984587018502 + 0.4769563938372283j),
    ((0.03, 1.3, 0.3, 0.1, -0.05), (2.0, 1.0), 6, -0.053125481502113506 + 0.4155782464072844j),
    ((0.1535, 1.245, 0.335, 0.017, -1.16), (0.0, 0.0), 2, 0.5119189317744564 + 0.0j),
]


def torsional(zeta, frequency, eps, mean, amplitude):
    return TorsionalModel(
        damping_ratio=zeta,
        frequency=frequency,
        stiffness_amplitude=eps,
        mean_force=mean,
        force_amplitude=amplitude,
    )


@pytest.mark.parametrize(("numbers", "start", "period", "multiplier"), ORBITS)
def test_known_orbits_with_their_multipliers(numbers, start, period, multiplier):
    found = settle(torsional(*numbers).lanes(), np.array([start]), Rule())
    assert found.label[0] == PERIODIC
    assert found.period[0] == period
    assert abs(found.multiplier[0, 0] - multiplier) < 1e-9
    zeta, frequency = numbers[:2]
    product = found.multiplier[0].prod()
    assert product == pytest.approx(np.exp(-4 * np.pi * zeta * period / frequency), rel=1e-12)
    # time in back, free and drive contact, counts: those of the single orbit
    orbit = periodic_orbit(torsional(*numbers), period, found.point[0])
    assert found.shares[0] == pytest.approx(orbit.shares, abs=1e-9)
    assert found.shares[0].sum() == pytest.approx(1.0, abs=1e-12)
    assert (found.losses[0], found.impacts[0]) == (orbit.contact_losses, orbit.back_impacts)


def test_exponent_of_a_periodic_orbit_is_the_log_of_its_multiplier():
    found = settle(
        TorsionalModel(
            damping_ratio=0.18,
            frequency=1.245,
            stiffness_amplitude=0.335,
            mean_force=0.017,
            force_amplitude=-1.16,
        ).lanes(),
        np.zeros((1, 2)),
        Rule(),
    )
    assert found.lyapunov[0] == pytest.approx(-0.011806229408744076, abs=1e-9)
    assert found.lyapunov_error[0] == 0.0


def test_chaos_has_a_positive_exponent():
    found = settle(
        TorsionalModel(
            damping_ratio=0.1,
            frequency=1.245,
            stiffness_amplitude=0.335,
            mean_force=0.017,
            force_amplitude=-1.16,
        ).lanes(),
        np.zeros((1, 2)),
        Rule(),
    )
    assert found.label[0] == CHAOTIC
    assert found.lyapunov[0] == pytest.approx(0.0488, abs=3 * found.lyapunov_error[0] + 1.5e-3)


def test_settled_census_of_a_row_with_long_transients():
    """Near the cascade short transients imitate other motions; the census is of settled ones."""
    model = TorsionalModel(
        damping_ratio=np.linspace(0.02, 0.14, 121),
        frequency=1.268,
        stiffness_amplitude=0.6,
        mean_force=0.056,
        force_amplitude=0.314,
        half_backlash=1.0,
        thermal_stiffness=0.03,
    )
    found = settle(model.lanes(), np.zeros((121, 2)), Rule(cap=16384, chaos_periods=4000))
    single = labels(model, max_period=32, starts=4)
    names = [
        f"period-{n}" if code == PERIODIC else LABELS[code]
        for code, n in zip(found.label, found.period, strict=True)
    ]
    # some starts of a long chaos end: the one start of the faster rule has no word for it
    apart = [(name, one) for name, one in zip(names, single, strict=True) if name != one.name]
    assert len(apart) <= 1
    assert all("period-18" in one.reason for _, one in apart)


def test_company_changes_no_bit():
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=np.linspace(0.5, 2.0, 40),
        stiffness_amplitude=0.5,
        mean_force=0.1,
        force_amplitude=0.3,
        half_backlash=1.0,
        thermal_stiffness=0.02,
    )
    lanes, rule = model.lanes(), Rule(cap=2048)
    whole = settle(lanes, np.zeros((40, 2)), rule, keep=4)
    for lane in (0, 7, 21, 39):
        alone = settle(lanes.take(lane), np.zeros((1, 2)), rule, keep=4)
        for name in ("label", "period", "point", "multiplier", "lyapunov", "state", "sections"):
            one, many = getattr(alone, name)[0], getattr(whole, name)[lane]
            assert np.array_equal(one, many, equal_nan=True), name


def test_unbounded_motion_is_diverged():
    # parametric resonance far above its threshold with hardly any damping, never out of contact
    model = TorsionalModel(
        damping_ratio=0.001,
        frequency=2.0,
        stiffness_amplitude=0.9,
        mean_force=500.0,
        force_amplitude=0.0,
    )
    found = settle(model.lanes(), np.array([[501.0, 0.1]]), Rule(cap=4096))
    assert LABELS[found.label[0]] in ("diverged", "chaotic", "periodic", "undecided")
    assert np.isfinite(found.state[0]).all() == (LABELS[found.label[0]] != "diverged")


def test_rules_that_make_no_sense_are_refused():
    with pytest.raises(InputError, match=r"rule\.cap: got 32; allowed >= first = 64"):
        Rule(cap=32)
    with pytest.raises(InputError, match=r"rule\.near_border: got 2\.0; allowed 0 < value <= 1"):
        Rule(near_border=2.0)


def test_rounds_double_up_to_the_cap():
    for first, cap in ((64, 4096), (8, 100), (50, 50), (64, 65)):
        lengths = Rule(first=first, cap=cap).rounds()
        ends = np.cumsum(lengths)
        assert ends[-1] == cap
        assert lengths[0] == first
        assert all(end == first * 2**n for n, end in enumerate(ends[:-1].tolist()))
        assert Rule(first=first, cap=cap).full().rounds() == [cap]


@pytest.mark.parametrize(
    ("name", "least"),
    [("max_period", 1), ("first", 8), ("cap", 8), ("chaos_periods", 40), ("batches", 4)],
)
def test_a_rule_takes_its_least_value_and_none_below(name, least):
    others = {"first": 8} if name == "cap" else {}
    assert getattr(Rule(**{name: least}, **others), name) == least
    for wrong in (least - 1, least + 0.5):
        with pytest.raises(InputError, match=rf"rule\.{name}: got {wrong}; allowed a whole number"):
            Rule(**{name: wrong})
    for name in ("near_border", "close", "settled"):
        assert getattr(Rule(**{name: 1.0}), name) == 1.0
        with pytest.raises(InputError, match=rf"rule\.{name}: got 0"):
            Rule(**{name: 0.0})


def test_an_orbit_longer_than_the_longest_sought_is_not_called_periodic():
    numbers, start, period, _ = ORBITS[3]
    lanes, start = torsional(*numbers).lanes(), np.array([start])
    assert period == 6
    found = settle(lanes, start, Rule(max_period=6, cap=1024))
    assert (found.label[0], found.period[0]) == (PERIODIC, 6)
    short = settle(lanes, start, Rule(max_period=5, cap=1024), keep=20)
    assert (short.label[0], short.period[0]) == (UNDECIDED, 0)
    assert short.used[0] == 1024
    for values in (short.point, short.multiplier, short.shares, short.losses, short.impacts):
        assert np.isnan(values).all()
    # its sections are those of the run
    path = return_map(lanes).visit(start[0], 1024).points
    assert short.sections[0] == pytest.approx(path[-20:], abs=1e-9)
    assert short.state[0] == pytest.approx(path[-1], abs=1e-9)
    # those of the settled one are on the orbit, in step with the run
    kept = settle(lanes, start, Rule(max_period=6, cap=1024), keep=20)
    there = return_map(lanes).visit(start[0], int(kept.used[0])).points[-20:]
    assert kept.sections[0] == pytest.approx(there, abs=1e-3)
    assert np.array_equal(kept.sections[0, :-6], kept.sections[0, 6:])
    assert np.array_equal(kept.sections[0, -1], kept.point[0])


def test_an_orbit_within_the_border_is_not_decided_and_one_below_it_is():
    """zeta = 0.1701 lies just before the flip: its multiplier is -0.9995."""
    model = TorsionalModel(
        damping_ratio=0.1701,
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    orbit = periodic_orbit(model, 1, (1.08, -0.25))
    size = abs(orbit.multipliers[0])
    start = (orbit.state + np.array([1e-5, 0.0]))[None]
    for border, label in ((size - 1e-6, UNDECIDED), (size + 1e-6, PERIODIC)):
        found = settle(model.lanes(), start, Rule(near_border=border, cap=8192))
        assert (found.label[0], found.period[0]) == (label, 1)
        assert found.point[0] == pytest.approx(orbit.state, abs=1e-9)
        assert found.lyapunov[0] == pytest.approx(np.log(size) * 1.245 / (2.0 * np.pi), abs=1e-9)


def test_exponent_of_chaos_is_the_growth_of_a_tangent_period_by_period():
    """Jacobians of single periods multiplied by hand; batch means and their standard error."""
    model = TorsionalModel(
        damping_ratio=0.1,
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    rule = Rule(first=64, cap=64 + 64, chaos_periods=40, batches=4, early=False)
    found = settle(model.lanes(), np.zeros((1, 2)), rule)
    section = return_map(model.lanes())
    measured = 42 + 50  # a third of the run, the tangent turning for 50 periods first
    state, tangent = np.zeros(2), np.array([1.0, 1.245])
    grown = []
    for period in range(128):
        visit = section.visit(state, 1)
        state = visit.points[-1]
        if period >= 128 - measured:
            tangent = visit.jacobian @ tangent
            grown.append(np.log(np.linalg.norm(tangent)))
            tangent /= np.linalg.norm(tangent)
    batches = np.array(grown[-40:]).reshape(4, 10).mean(axis=1) * 1.245 / (2.0 * np.pi)
    assert found.used[0] == 128
    assert found.lyapunov[0] == pytest.approx(batches.mean(), abs=1e-7)
    assert found.lyapunov_error[0] == pytest.approx(batches.std(ddof=1) / 2.0, abs=1e-7)
    assert (found.label[0] == CHAOTIC) == (batches.mean() > 2.0 * batches.std(ddof=1))


def test_multipliers_are_the_eigenvalues_the_larger_first():
    rng = np.random.default_rng(1)
    jacobian = rng.normal(size=(200, 2, 2))
    determinant = np.linalg.det(jacobian)
    found = multipliers_of(jacobian, determinant=determinant)
    for one, both in zip(jacobian, found, strict=True):
        expected = np.linalg.eigvals(one)
        expected = expected[np.lexsort((-expected.imag, -np.abs(expected).round(12)))]
        assert both == pytest.approx(expected, abs=1e-10)
        assert abs(both[0]) >= abs(both[1]) * (1.0 - 1e-12)
        assert both[0].imag >= 0.0


def test_newton_lane_by_lane_ends_on_the_orbits_and_tells_who_did_not_get_there():
    model = TorsionalModel(
        damping_ratio=[0.05, 0.1535, 0.05],
        frequency=[0.7, 1.245, 0.7],
        stiffness_amplitude=[0.1, 0.335, 0.1],
        mean_force=[0.1, 0.017, 0.1],
        force_amplitude=[0.05, -1.16, 0.05],
    )
    lanes = model.lanes()
    ((_, prepared),) = bundles(lanes)
    maps = prepared()
    guess = np.array([[1.15, 0.0], [1.1, -0.3], [0.9, 0.4]])
    point, residual = polish(maps, guess, 2, lanes.unit, most=20)
    assert np.all(residual[:2] < 1e-12)
    for lane in range(3):
        alone = return_map(lanes.take(lane))
        visit = alone.visit(point[lane], 2)
        gap = np.max(np.abs(visit.points[-1] - point[lane]) / lanes.unit[lane])
        assert residual[lane] == pytest.approx(gap, abs=1e-13)
    # no step is longer than a half backlash
    one, far = polish(maps, guess - 40.0, 2, lanes.unit, most=2)
    assert np.all(np.abs(one - (guess - 40.0)) / lanes.unit <= 1.0 + 1e-12)
    assert np.all(far > 1e-3)


def test_points_without_motion_keep_their_start_and_their_status():
    model = TorsionalModel(
        damping_ratio=0.18,
        frequency=[1.245, 1.25, 1.26],
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    start = np.array([[0.3, 0.1], [0.0, 0.0], [0.2, 0.0]])
    jammed = STATUS.index("jammed")
    status = np.array([0, jammed, 0], np.int8)
    found = settle_with_status(model.lanes(), status, start, Rule())
    assert found.label.tolist() == [PERIODIC, JAMMED, PERIODIC]
    assert np.array_equal(found.state[1], start[1])
    alone = settle(model.lanes().take(2), start[2:], Rule())
    assert np.array_equal(alone.multiplier[0], found.multiplier[2])
    found.label[0], found.label[2] = UNDECIDED, DIVERGED
    stored = outcome_arrays(found, status)
    assert [STATUS[n] for n in stored["status"]] == ["not_converged", "jammed", "diverged"]
    assert np.isnan(stored["used_periods"]).tolist() == [False, True, False]
    assert np.array_equal(stored["drive_share"], found.shares[:, 2], equal_nan=True)
    assert np.array_equal(stored["point_v"], found.point[:, 1], equal_nan=True)


@pytest.mark.parametrize("state", [(), (1.0,), (1.0, 0.0, 0.0), ((1.0, 0.0),), (np.nan, 0.0)])
def test_one_start_is_two_finite_numbers(state):
    assert start_of((1, -2)) == (1.0, -2.0)
    with pytest.raises(InputError, match=r"^initial_state: got .*; allowed two finite numbers"):
        start_of(state)
