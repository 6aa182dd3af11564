"""Folds, flips and grazing against independent values; the cascades of table 4.2."""

import json
from pathlib import Path

import numpy as np
import pytest

from said import numbers
from thermogear.analysis.bifurcations import (
    BIRTH,
    FLIP,
    FOLD,
    GRAZING,
    LONGEST_STEP,
    PITCHFORK,
    SUBCRITICAL,
    SUPERCRITICAL,
    VERTICAL,
)
from thermogear.analysis.continuation import (
    FLOATS,
    LEFT,
    REACHED,
    SHRUNK,
    cascade,
    continuation,
    family_of,
    switch_branch,
)
from thermogear.analysis.curve import Curve
from thermogear.analysis.labels import label
from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.errors import InputError
from thermogear.dynamics.models import TorsionalModel

TRUTH = json.loads((Path(__file__).parents[1] / "dynamics" / "truth.json").read_text())
BIFURCATIONS = {case["id"]: case for case in TRUTH["bifurcations"]}
BASE = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.245,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)
ROWS = {
    "damping_ratio": (0.18, 0.10, "SEED_z"),
    "frequency": (1.3, 1.1, "SEED_w"),
    "stiffness_amplitude": (0.1, 0.9, "SEED_eps"),
}
# 1->2, 2->4, 4->8, 8->16; the second and fourth stand only here
FLIPS = {
    "damping_ratio": (0.170043027, 0.115498003, 0.109948814, 0.108382524),
    "frequency": (1.291353857, 1.139990476, 1.116251550, 1.105775851),
    "stiffness_amplitude": (0.258236471, 0.523447310, 0.562794274, 0.579050411),
}


def agrees(found, case):
    assert found.value == pytest.approx(case["value"], abs=1e-6)
    assert found.state == pytest.approx(case["orbit_state"], abs=1e-6)
    expected = np.sort_complex([complex(*pair) for pair in case["multipliers"]])
    assert np.sort_complex(found.multipliers) == pytest.approx(expected, abs=1e-5)


def feigenbaum(found):
    """The last (p_k - p_k-1)/(p_k+1 - p_k) of a cascade; they tend to 4.669."""
    gaps = np.diff([flip.value for flip in found.flips])
    return gaps[-2] / gaps[-1]


@pytest.mark.parametrize("parameter", ROWS)
def test_cascade_of_table_4_2(parameter, compared):
    first, last, name = ROWS[parameter]
    orbit = periodic_orbit(BASE.replace(**{parameter: first}), 1, (1.08, -0.25))
    found = cascade(orbit, parameter, last)
    assert [flip.period for flip in found.flips] == [1, 2, 4, 8]
    values = np.array([flip.value for flip in found.flips])
    compared(
        "four flips of each cascade of table 4.2",
        "computed apart to nine digits",
        values - FLIPS[parameter],
        6e-10,
    )
    for flip, suffix in ((found.flips[0], "_1"), (found.flips[2], "_4")):
        case = BIFURCATIONS[name + suffix]
        assert flip.value == pytest.approx(case["value"], abs=1e-9)
        assert np.sort(flip.multipliers.real) == pytest.approx(
            np.sort([pair[0] for pair in case["multipliers"]]), abs=1e-7
        )
        # another point of the same orbit may be the first one
        assert np.abs(flip.orbit.points - case["orbit_state"]).max(axis=1).min() < 1e-7
    assert feigenbaum(found) > 2.0


def test_grazing_and_fold_of_the_lower_branch():
    orbit = periodic_orbit(
        TorsionalModel(
            damping_ratio=0.05,
            frequency=0.7,
            stiffness_amplitude=0.1,
            mean_force=0.1,
            force_amplitude=0.05,
        ),
        1,
        (1.1776, 0.0074),
    )
    branch = continuation(orbit, "frequency", 0.9)
    assert [b.kind for b in branch.bifurcations] == [GRAZING, FOLD]
    grazing, fold = branch.bifurcations
    assert numbers(grazing.note) == [0.0, 1.0]
    agrees(grazing, BIFURCATIONS["BP1"])
    agrees(fold, BIFURCATIONS["BP2"])
    assert branch.ended == LEFT
    assert branch.stable[0]
    assert not branch.stable[-1]


def test_flip_of_the_small_family_with_falling_frequency():
    orbit = periodic_orbit(
        TorsionalModel(
            damping_ratio=0.05,
            frequency=1.4,
            stiffness_amplitude=0.2,
            mean_force=0.1,
            force_amplitude=0.2,
        ),
        1,
        (0.9, 0.03),
    )
    branch = continuation(orbit, "frequency", 1.1)
    (flip,) = branch.bifurcations
    assert flip.kind == FLIP
    agrees(flip, BIFURCATIONS["BP4_1"])
    assert branch.values[-1] == pytest.approx(1.1, abs=1e-14)
    # beyond the flip the branch goes on as the saddle known at the end
    case = next(c for c in TRUTH["cases"] if c["id"] == "D3")
    assert branch.states[-1] == pytest.approx(case["poincare_points"][0], abs=1e-9)
    assert not branch.orbit(-1).stable


def test_a_doubled_branch_walked_back_shrinks_into_its_mother():
    orbit = periodic_orbit(BASE, 2, (1.1335, -0.2792))
    branch = continuation(orbit, "damping_ratio", 0.2)
    last = branch.bifurcations[-1]
    assert last.kind == BIRTH
    assert last.value == pytest.approx(BIFURCATIONS["SEED_z_1"]["value"], abs=1e-6)
    assert branch.ended == SHRUNK[BIRTH]


def test_the_doubled_orbit_beside_a_flip_has_twice_the_period():
    orbit = periodic_orbit(BASE.replace(damping_ratio=0.18), 1, (1.08, -0.25))
    (flip,) = continuation(orbit, "damping_ratio", 0.16).of_kind(FLIP)
    doubled = switch_branch(flip)
    assert doubled.orbit.period == 2
    assert doubled.orbit.minimal_period == 2
    assert doubled.orbit.stable
    assert doubled.value < flip.value


def test_a_family_may_be_any_function_of_a_number():
    """Heat of section 4.1 as temperature: the flip stands at 120 C."""

    def heated(celsius):
        rise = (celsius - 20.0) / 140.0
        return TorsionalModel(
            damping_ratio=0.1535,
            frequency=1.300551,
            stiffness_amplitude=0.335,
            mean_force=0.0136,
            force_amplitude=-0.928,
            half_backlash=1 - 0.2 * rise,
            thermal_stiffness=0.02 * rise,
        )

    orbit = periodic_orbit(heated(20.0), 1, (1.08, -0.2))
    branch = continuation(orbit, "temperature", 160.0, family=heated, start=20.0)
    (flip,) = branch.of_kind(FLIP)
    assert flip.value == pytest.approx(120.0, abs=0.02)


def test_backlash_moves_no_flip_while_the_back_side_is_not_hit():
    values = []
    for backlash in (1.0, 0.75):
        model = BASE.replace(damping_ratio=0.18, half_backlash=backlash)
        orbit = periodic_orbit(model, 1, (0.08 + backlash, -0.28))
        values.append(continuation(orbit, "damping_ratio", 0.16).of_kind(FLIP)[0].value)
    assert values[0] == pytest.approx(values[1], abs=1e-10)


def test_what_cannot_be_walked_is_refused():
    orbit = periodic_orbit(BASE, 2, (1.1335, -0.2792))
    with pytest.raises(InputError, match="did you mean 'damping_ratio'"):
        continuation(orbit, "damping_ration", 0.2)
    with pytest.raises(InputError, match=r"allowed a finite number other than 0\.1535"):
        continuation(orbit, "damping_ratio", 0.1535)


def test_the_next_flip_and_the_universal_ratio():
    orbit = periodic_orbit(BASE.replace(stiffness_amplitude=0.1), 1, (1.08, -0.25))
    found = cascade(orbit, "stiffness_amplitude", 0.9, flips=5)
    assert found.flips[-1].period == 16
    assert feigenbaum(found) == pytest.approx(4.669, abs=0.15)


@pytest.mark.parametrize("parameter", ["damping_ratio", "stiffness_amplitude"])
def test_the_same_cascade_hot_is_the_cold_one_rescaled(parameter):
    """Heat of section 4.1 at 160 C: eps_T = .02, b' = .8, without back-side impacts."""
    first, last, _ = ROWS[parameter]
    hot = BASE.replace(half_backlash=0.8, thermal_stiffness=0.02)
    s = np.sqrt(1.02)
    cold = BASE.replace(
        damping_ratio=0.1535 / s,
        frequency=1.245 / s,
        stiffness_amplitude=0.335 / s**2,
    )
    scale = {"damping_ratio": s, "stiffness_amplitude": s**2}[parameter]
    one = cascade(
        periodic_orbit(hot.replace(**{parameter: first}), 1, (0.88, -0.25)),
        parameter,
        last,
        flips=2,
    )
    two = cascade(
        periodic_orbit(cold.replace(**{parameter: first / scale}), 1, (1.08, -0.25)),
        parameter,
        last / scale,
        flips=2,
    )
    assert len(one.flips) == len(two.flips) == 2
    for hot_flip, cold_flip in zip(one.flips, two.flips, strict=True):
        assert hot_flip.value == pytest.approx(scale * cold_flip.value, abs=1e-9)


def test_folds_beside_a_grazing_are_found():
    """Back-side impacts set in along the hot frequency row: two folds 4e-5 apart."""
    model = BASE.replace(frequency=1.35, half_backlash=0.8, thermal_stiffness=0.02)
    found = cascade(periodic_orbit(model, 1, (0.88, -0.2)), "frequency", 1.1)
    assert len(found.flips) == 1
    kinds = [b.kind for b in found.branches[1].bifurcations]
    assert kinds == [GRAZING, FOLD, GRAZING, FOLD, BIRTH]
    assert all(fold.note == "" for fold in found.branches[1].of_kind(FOLD))
    assert found.flips[0].note == SUPERCRITICAL
    # walked back, the branch passes the same places in reverse, to its other birth
    there = found.branches[1]
    back = continuation(there.orbit(-1), "frequency", 1.35)
    assert [b.kind for b in back.bifurcations] == [FOLD, GRAZING, FOLD, GRAZING, BIRTH]
    assert [b.value for b in back.bifurcations[:4]] == pytest.approx(
        [b.value for b in there.bifurcations[3::-1]], abs=1e-12
    )
    assert back.bifurcations[-1].value == pytest.approx(found.flips[0].value, abs=1e-11)
    assert numbers(back.bifurcations[1].note) == [2.0, 1.0]
    assert numbers(there.bifurcations[2].note) == [1.0, 2.0]


def test_ctrl_c_keeps_what_is_done_when_asked():
    orbit = periodic_orbit(
        TorsionalModel(
            damping_ratio=0.05,
            frequency=0.7,
            stiffness_amplitude=0.1,
            mean_force=0.1,
            force_amplitude=0.05,
        ),
        1,
        (1.1776, 0.0074),
    )

    def stop(points, _value):
        if points == 4:
            raise KeyboardInterrupt

    branch = continuation(orbit, "frequency", 0.9, progress=stop, keep_on_interrupt=True)
    assert branch.ended == "interrupted"
    assert branch.values.size == 4
    with pytest.raises(KeyboardInterrupt):
        continuation(orbit, "frequency", 0.9, progress=stop)


def test_the_branch_as_a_dataset():
    orbit = periodic_orbit(
        TorsionalModel(
            damping_ratio=0.05,
            frequency=0.7,
            stiffness_amplitude=0.1,
            mean_force=0.1,
            force_amplitude=0.05,
        ),
        1,
        (1.1776, 0.0074),
    )
    data = continuation(orbit, "frequency", 0.9).dataset()
    assert data.event_kind.values.tolist() == [GRAZING, FOLD]
    assert data.attrs["parameter"] == "frequency"
    assert data.sizes["point"] == data.value.size


@pytest.mark.parametrize(("parameter", "to"), [("mean_force", 0.5), ("force_amplitude", 0.0)])
def test_a_straight_branch_is_walked_in_longest_steps_and_stays_straight(parameter, to):
    """Constant stiffness in lasting contact: the orbit is affine in the force."""
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness_amplitude=0.0,
        mean_force=1.0,
        force_amplitude=0.2,
    )
    branch = continuation(periodic_orbit(model, 1, (2.0, 0.0)), parameter, to)
    assert (branch.bifurcations, branch.ended) == ((), REACHED)
    start, end = branch.values[0], branch.values[-1]
    assert end == pytest.approx(to, abs=1e-14)
    part = (branch.values - start)[:, None] / (end - start)
    straight = branch.states[0] + part * (branch.states[-1] - branch.states[0])
    assert branch.states == pytest.approx(straight, abs=1e-12)
    # at rest without a periodic force, else moved by the mean force alone
    rest = np.array([2.0, 0.0]) if to == 0.0 else branch.states[0] - [0.5, 0.0]
    assert branch.states[-1] == pytest.approx(rest, abs=1e-10)
    mu = np.exp(2.0 * np.pi / 0.7 * (-0.05 + 1j * np.sqrt(1.0 - 0.05**2)))
    assert np.allclose(branch.multipliers, [complex(mu.real, abs(mu.imag)), mu.conjugate()]) or (
        np.allclose(branch.multipliers, [mu, mu.conjugate()])
    )
    assert branch.stable.all()
    # scaled by half backlash, its rate and the range: a hundredth first, then half as much more
    scaled = np.column_stack([branch.states / [1.0, 0.7], branch.values / abs(to - start)])
    steps = np.linalg.norm(np.diff(scaled, axis=0), axis=1)
    grown = np.minimum(0.01 * 1.5 ** np.arange(steps.size - 1), LONGEST_STEP)
    assert steps[:-1] == pytest.approx(grown, rel=1e-6)
    assert steps[-1] <= LONGEST_STEP * (1.0 + 1e-9)


def test_the_last_step_lands_on_the_end_from_either_side():
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness_amplitude=0.1,
        mean_force=1.0,
        force_amplitude=0.2,
    )
    orbit = periodic_orbit(model, 1, (2.0, 0.0))
    for to in (0.6, 0.8):
        branch = continuation(orbit, "frequency", to)
        assert branch.values[-1] == pytest.approx(to, abs=1e-14)
        there = periodic_orbit(model.replace(frequency=to), 1, branch.states[-1])
        assert branch.states[-1] == pytest.approx(there.state, abs=1e-11)
        assert np.all(np.diff(branch.values) * (to - 0.7) > 0.0)
        # and a branch may be cut short
        some = continuation(orbit, "frequency", to, most_points=3)
        assert some.ended == "3 points"
        assert np.array_equal(some.values, branch.values[:4])


def test_the_stored_branch_is_its_orbits():
    """Of x'' + 2 zeta x' + x - 1 = F_m + F_h cos(w t), always in contact, in closed form:
    x = 1 + F_m + Re X and v = -w Im X at t = 0, with X = F_h/(1 - w^2 + 2i zeta w)."""
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.4,
        stiffness_amplitude=0.0,
        mean_force=0.5,
        force_amplitude=0.1,
    )
    branch = continuation(periodic_orbit(model, 1, (1.5, 0.0)), "frequency", 0.6)
    data = branch.dataset()
    w = data.value.values
    swing = 0.1 / (1.0 - w**2 + 0.1j * w)
    assert w[[0, -1]] == pytest.approx([0.4, 0.6], abs=1e-12)
    np.testing.assert_allclose(data.section_x, 1.5 + swing.real, rtol=0, atol=1e-11)
    np.testing.assert_allclose(data.section_v, -w * swing.imag, rtol=0, atol=1e-11)
    # mu = exp((-zeta +- i sqrt(1 - zeta^2)) 2 pi/w)
    size = np.hypot(data.multiplier_real, data.multiplier_imag)
    np.testing.assert_allclose(size[:, 0], np.exp(-0.05 * 2 * np.pi / w), rtol=1e-10)
    assert np.all(data.stable)
    assert not data.contact_losses.any()


def test_a_branch_runs_through_a_grazing_that_a_difference_would_straddle():
    """No event but a grazing at w = .3842: the contact of a central difference changed there."""
    model = TorsionalModel(
        damping_ratio=0.0513048,
        frequency=0.39,
        stiffness_amplitude=0.367185,
        mean_force=0.292073,
        force_amplitude=0.823992,
    )
    first = continuation(label(model.replace(frequency=0.35)).orbit, "frequency", 0.395)
    assert first.ended == REACHED
    assert [b.kind for b in first.bifurcations] == [FOLD, FOLD, FLIP, GRAZING]
    assert first.bifurcations[-1].value == pytest.approx(0.38417183, abs=1e-8)
    # the range of the parameter is in no result
    whole = continuation(first.orbit(-1), "frequency", 0.5)
    assert [b.kind for b in whole.bifurcations] == [FLIP]


@pytest.mark.parametrize(
    "parameter",
    ["frequency", "damping_ratio", "stiffness_amplitude", "mean_force", "half_backlash"],
)
def test_the_derivative_in_the_parameter_is_that_of_the_map(parameter):
    """Against central differences of the map, at an orbit with contact on both sides."""
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness_amplitude=0.3,
        mean_force=0.1,
        force_amplitude=0.6,
        half_backlash=0.9,
    )
    family, value = family_of(model, parameter)
    curve = Curve(family, parameter, 2, start=value, span=1.0)
    here = np.array([1.1, 0.3, value])
    _, _, section = curve.residual(here)
    assert section.visit(here[:2] * curve.unit[:2], 2).back_impacts > 0
    moved, _ = curve.in_parameter(here, section)
    step = np.array([0.0, 0.0, 1e-5])
    ends = [curve.residual(here + sign * step)[0] for sign in (1.0, -1.0)]
    assert moved == pytest.approx((ends[0] - ends[1]) / 2e-5, rel=3e-8, abs=1e-8)


def test_a_parameter_at_the_end_of_what_it_may_be_is_reached():
    """Below zeta = 0 there is no model: the derivative there is one-sided."""
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness_amplitude=0.0,
        mean_force=1.0,
        force_amplitude=0.2,
    )
    branch = continuation(periodic_orbit(model, 1, (1.9, 0.0)), "damping_ratio", 0.0)
    assert (branch.values[-1], branch.ended) == (0.0, REACHED)
    # x = b + F_m + F_h/(1 - w^2) cos(w t) without damping
    assert branch.states[-1] == pytest.approx([2.0 + 0.2 / 0.51, 0.0], abs=1e-11)


def test_pitchforks_of_symmetric_orbits_are_passed_and_none_is_a_fold():
    model = TorsionalModel(
        damping_ratio=0.08653681,
        frequency=0.85,
        stiffness_amplitude=0.0,
        mean_force=0.0,
        force_amplitude=0.68923095,
    )
    orbit = label(model, initial_state=(3.0, 0.0)).orbit
    branch = continuation(orbit, "frequency", 0.36)
    assert branch.ended == REACHED
    assert [b.kind for b in branch.bifurcations] == [PITCHFORK]
    (fork,) = branch.bifurcations
    assert fork.note == SUPERCRITICAL
    assert fork.multipliers[0] == pytest.approx(1.0, abs=1e-7)
    # all along x(t + T/2) = -x(t); the parameter never turns
    assert np.all(np.diff(branch.values) < 0.0)
    assert branch.orbit(-1).samples(16)[1] == pytest.approx(
        -np.roll(branch.orbit(-1).samples(16)[1], 8), abs=1e-9
    )
    # the two orbits that leave it mirror each other, and lead back to it
    beside = switch_branch(fork, branch.family)
    away = 0.36 if beside.value < fork.value else 0.85
    arm = continuation(
        beside.orbit,
        "frequency",
        fork.value + 0.02 * (away - fork.value),
        family=branch.family,
        start=beside.value,
        direction=beside.direction,
    )
    back = continuation(arm.orbit(-1), "frequency", 0.85 if away == 0.36 else 0.36)
    assert back.bifurcations[-1].kind == PITCHFORK
    assert back.bifurcations[-1].value == pytest.approx(fork.value, abs=1e-8)
    assert back.ended == SHRUNK[PITCHFORK]


def test_orbits_that_float_in_the_gap_are_no_branch():
    """Without a mean force any shift of x is an orbit too."""
    model = TorsionalModel(
        damping_ratio=0.1,
        frequency=1.6,
        stiffness_amplitude=0.0,
        mean_force=0.0,
        force_amplitude=1.0,
    )
    free = 1.0 / (1.6 * (1.6 - 0.2j))  # x = -Re(free exp(i w t)) + shift
    floating = periodic_orbit(model, 1, (-free.real + 0.2, 1.6 * free.imag))
    branch = continuation(floating, "frequency", 1.2)
    assert branch.ended == FLOATS
    assert branch.bifurcations == ()


def test_a_subcritical_doubling_is_followed_back_through_its_fold():
    model = TorsionalModel(
        damping_ratio=0.10208669,
        frequency=1.98,
        stiffness_amplitude=0.56183829,
        mean_force=0.19730742,
        force_amplitude=0.98997492,
    )
    start = label(model.replace(frequency=1.90894553)).orbit
    mother = continuation(start, "frequency", 1.98).orbit(-1)
    found = cascade(mother, "frequency", 2.2)
    (flip,) = found.flips
    assert flip.note == SUBCRITICAL
    doubled = found.branches[1]
    folds = doubled.of_kind(FOLD)
    assert len(folds) == 1
    assert folds[0].value < flip.value < doubled.values.max()
    assert doubled.ended != LEFT
    # unstable from its birth to the fold, stable behind it
    turn = int(np.argmin(doubled.values))
    assert not doubled.stable[: turn - 1].any()
    assert doubled.stable[turn + 1]


def test_a_doubling_in_lasting_contact_is_vertical():
    """Hill's equation there: all doubled orbits live at its border, until contact is lost."""
    model = TorsionalModel(
        damping_ratio=0.04439774,
        frequency=1.9,
        stiffness_amplitude=0.17862974,
        mean_force=0.23223388,
        force_amplitude=0.0,
    )
    branch = continuation(periodic_orbit(model, 1, (1.2, 0.0)), "frequency", 2.0)
    assert branch.of_kind(FLIP)
    assert branch.of_kind(FLIP)[0].note == VERTICAL
