"""Closed orbits against independent values, and the identities every orbit keeps."""

import json
from functools import reduce
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from thermogear.analysis.labels import label
from thermogear.analysis.orbits import multipliers, periodic_orbit
from thermogear.analysis.section import lanes_of
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.models import TorsionalModel

TRUTH = json.loads((Path(__file__).parents[1] / "dynamics" / "truth.json").read_text())
ORBITS = [case for case in TRUTH["cases"] if "poincare_points" in case]


def contact_multipliers(model):
    """Multipliers of one period in lasting drive contact: Hill's x'' + c x' + k(t) x = 0."""
    section = lanes_of(model).return_map()
    steps = [
        np.array([[one[0], one[2]], [one[1], one[3]]]) for one in section.maps.steps[:, 0, :4, 0]
    ]
    product = reduce(lambda before, step: step @ before, steps, np.eye(2))
    return multipliers(product, section.determinant(1))


def model_of(params):
    return TorsionalModel(
        damping_ratio=params["zeta"],
        frequency=params["omega_h"],
        stiffness_amplitude=params["epsilon"],
        mean_force=params["F_m"],
        force_amplitude=params["F_h"],
        half_backlash=params["b_prime"],
        thermal_stiffness=params["epsilon_T"],
    )


def as_complex(pairs):
    return np.sort_complex(np.array([complex(*pair) for pair in pairs]))


def near(case, offset=1e-3):
    return np.array(case["poincare_points"][0]) + offset


@pytest.fixture(scope="module")
def orbits():
    return {
        case["id"]: periodic_orbit(model_of(case["params"]), case["period_multiple"], near(case))
        for case in ORBITS
    }


@pytest.mark.parametrize("case", ORBITS, ids=lambda case: case["id"])
def test_orbit_is_the_independent_one(case, orbits, compared):
    orbit = orbits[case["id"]]
    known = "computed apart to 1e-9 or better"
    compared("states of periodic orbits", known, orbit.points - case["poincare_points"], 1e-9)
    gaps = np.sort_complex(orbit.multipliers) - as_complex(case["floquet_multipliers"])
    compared("Floquet multipliers", known, gaps, 1e-7)
    assert orbit.contact_losses == case["contact_losses_per_orbit"]
    assert orbit.back_impacts == case["backside_impacts_per_orbit"]
    assert orbit.minimal_period == case["period_multiple"]
    assert orbit.time_share["drive"] == pytest.approx(case["time_fraction_drive"], abs=1e-9)
    assert orbit.time_share["free"] == pytest.approx(case["time_fraction_free"], abs=1e-9)
    assert orbit.time_share["back"] == pytest.approx(case["time_fraction_back"], abs=1e-9)
    low, high = orbit.extremes(1024)
    assert low == pytest.approx(case["x_min"], abs=1e-8)
    assert high == pytest.approx(case["x_max"], abs=1e-8)
    assert orbit.stable == (case["kind"] == "periodic")


@pytest.mark.parametrize("case", ORBITS, ids=lambda case: case["id"])
def test_m1_determinant(case, orbits, compared):
    orbit = orbits[case["id"]]
    zeta, w = case["params"]["zeta"], case["params"]["omega_h"]
    exact = np.exp(-4 * np.pi * zeta * orbit.period / w)
    compared(
        "determinant of the return map",
        "exp(-4π ζ n/ω)",
        np.linalg.det(orbit.jacobian) / exact - 1.0,
        1e-12,
    )
    assert orbit.determinant == pytest.approx(exact, rel=1e-14)


@pytest.mark.parametrize(
    "case", [c for c in ORBITS if c["initial_condition"]], ids=lambda case: case["id"]
)
def test_the_start_leads_to_its_orbit(case):
    found = label(model_of(case["params"]), initial_state=case["initial_condition"])
    assert str(found) == f"period-{case['period_multiple']}"
    gaps = np.abs(found.orbit.points[:, None] - case["poincare_points"]).max(axis=2)
    assert gaps.min(axis=1).max() < 1e-9


def test_m2_backlash_has_no_effect_without_back_impacts(orbits):
    one = orbits["S2"]
    for backlash in (0.75, 1.6):
        shifted = np.add(one.state, [backlash - 1.0, 0.0])
        other = periodic_orbit(one.model.replace(half_backlash=backlash), 2, shifted)
        assert other.state == pytest.approx(shifted, abs=1e-11)
        assert other.multipliers == pytest.approx(one.multipliers, abs=1e-11)


@pytest.mark.parametrize("factor", [0.3, 2.7])
def test_m3_and_m4_scaling(orbits, factor):
    one = orbits["S1"]
    forces = {"mean_force": 0.017 * factor, "force_amplitude": -1.16 * factor}
    whole = periodic_orbit(one.model.replace(half_backlash=factor, **forces), 1, factor * one.state)
    assert whole.state == pytest.approx(factor * one.state, abs=1e-11)
    assert whole.multipliers == pytest.approx(one.multipliers, abs=1e-11)
    if factor < 1:
        shifted = [1.0 + factor * (one.state[0] - 1.0), factor * one.state[1]]
        sided = periodic_orbit(one.model.replace(**forces), 1, shifted)
        assert sided.state == pytest.approx(shifted, abs=1e-11)
        assert sided.multipliers == pytest.approx(one.multipliers, abs=1e-11)


def test_m5_thermal_stiffness_is_a_change_of_scale(orbits):
    one = orbits["T100"]
    heat = one.model.thermal_stiffness
    s = np.sqrt(1 + heat)
    cold = TorsionalModel(
        damping_ratio=0.1535 / s,
        frequency=1.300551 / s,
        stiffness_amplitude=0.335 / s**2,
        mean_force=0.0136 / s**2,
        force_amplitude=-0.928 / s**2,
        half_backlash=0.8857142857142857,
    )
    other = periodic_orbit(cold, 1, one.state / [1.0, s])
    assert other.state == pytest.approx(one.state / [1.0, s], abs=1e-11)
    assert other.multipliers == pytest.approx(one.multipliers, abs=1e-11)


def test_m6_mirror_to_the_last_bit(orbits):
    one = orbits["F6"]
    other = periodic_orbit(
        one.model.replace(mean_force=-0.1, force_amplitude=0.05), 6, -near(ORBITS[7])
    )
    assert np.array_equal(other.points, -one.points)


def test_m7_half_period_shift(orbits):
    one = orbits["E1"]
    half = one.samples(64)
    other = periodic_orbit(
        one.model.replace(stiffness_amplitude=-0.2, force_amplitude=-0.2),
        2,
        [half[1][32], half[2][32]],
    )
    assert other.multipliers == pytest.approx(one.multipliers, abs=1e-11)
    assert other.state == pytest.approx([half[1][32], half[2][32]], abs=1e-11)


@pytest.mark.parametrize("case", TRUTH["linear_thresholds"], ids=lambda case: case["id"])
def test_threshold_of_the_contact_only_system(case, compared):
    sign = 1.0 if case["omega_h"] == 1.0 else -1.0

    def distance(eps):
        model = TorsionalModel(
            damping_ratio=case["zeta"],
            frequency=case["omega_h"],
            stiffness_amplitude=eps,
            mean_force=0.0,
            force_amplitude=0.0,
        )
        return abs(contact_multipliers(model)[0]) - 1.0

    value = case["epsilon_critical"]
    found = brentq(distance, 0.9 * value, 1.1 * value, xtol=1e-13)
    compared(
        "stability threshold in lasting contact (Hill)",
        "computed apart",
        found - value,
        1e-9,
    )
    model = TorsionalModel(
        damping_ratio=case["zeta"],
        frequency=case["omega_h"],
        stiffness_amplitude=value,
        mean_force=0.0,
        force_amplitude=0.0,
    )
    assert contact_multipliers(model)[0] == pytest.approx(sign, abs=1e-8)


def test_dynamic_load_factor_of_a_slow_constant_mesh_is_one():
    orbit = periodic_orbit(
        TorsionalModel(
            damping_ratio=0.05,
            frequency=0.01,
            stiffness_amplitude=0.0,
            mean_force=0.3,
            force_amplitude=0.0,
        ),
        1,
        (1.3, 0.0),
    )
    assert orbit.dynamic_load_factor() == pytest.approx(1.0, abs=1e-12)
    assert periodic_orbit(
        TorsionalModel(
            damping_ratio=0.05,
            frequency=0.7,
            stiffness_amplitude=0.0,
            mean_force=0.3,
            force_amplitude=0.05,
        ),
        1,
        (1.3, 0.0),
    ).dynamic_load_factor() == pytest.approx(1.0 + 0.097 / 0.3, abs=2e-3)


def test_orbit_samples_are_the_simulated_motion(orbits):
    orbit = orbits["B1"]
    phase, x, v = orbit.samples(64)
    data = simulate(orbit.model, periods=1, initial_state=orbit.state)
    assert phase == pytest.approx(np.arange(64) / 64)
    assert np.array_equal(x, data.x.values[0])
    assert np.array_equal(v, data.v.values[0])


def test_requests_that_lead_nowhere_are_refused():
    model = TorsionalModel(
        damping_ratio=0.1,
        frequency=1.0,
        stiffness_amplitude=0.1,
        mean_force=0.1,
        force_amplitude=0.1,
    )
    with pytest.raises(InputError, match="period: got 0; allowed a whole number >= 1"):
        periodic_orbit(model, 0)
    with pytest.raises(InputError, match="guess"):
        periodic_orbit(model, 1, (0.0, np.nan))
    with pytest.raises(ConvergenceError, match="Newton did not settle"):
        periodic_orbit(
            TorsionalModel(
                damping_ratio=0.0,
                frequency=2.0,
                stiffness_amplitude=0.9,
                mean_force=0.1,
                force_amplitude=0.1,
            ),
            1,
            (1e5, 0.0),
        )


def test_an_orbit_in_lasting_contact_is_the_forced_oscillation_in_closed_form():
    """x = b + F_m + Re X e^{i w t}, X = F_h/(1 - w^2 + 2 i zeta w): constant stiffness."""
    zeta, w, mean, force = 0.05, 0.7, 1.0, 0.2
    orbit = periodic_orbit(
        TorsionalModel(
            damping_ratio=zeta,
            frequency=w,
            stiffness_amplitude=0.0,
            mean_force=mean,
            force_amplitude=force,
        ),
        1,
        (2.0, 0.0),
    )
    response = force / (1.0 - w**2 + 2j * zeta * w)
    phase, x, v = orbit.samples(64)
    turn = np.exp(2j * np.pi * phase)
    assert x == pytest.approx(2.0 + (response * turn).real, abs=1e-12)
    assert v == pytest.approx((1j * w * response * turn).real, abs=1e-12)
    low, high = orbit.extremes(256)
    assert (low, high) == pytest.approx((2.0 - abs(response), 2.0 + abs(response)), abs=1e-9)
    assert orbit.dynamic_load_factor() == pytest.approx(1.0 + abs(response), abs=1e-5)
    assert (orbit.contact_losses, orbit.back_impacts) == (0, 0)
    assert orbit.shares.tolist() == pytest.approx([0.0, 0.0, 1.0])
    mu = np.exp(2.0 * np.pi / w * (-zeta + 1j * np.sqrt(1.0 - zeta**2)))
    assert np.sort_complex(orbit.multipliers) == pytest.approx(
        np.sort_complex(np.array([mu, mu.conjugate()])), abs=1e-11
    )
    assert np.sort_complex(contact_multipliers(orbit.model)) == pytest.approx(
        np.sort_complex(orbit.multipliers), abs=1e-11
    )
    # twice round it is still the orbit of one period; where the map is affine Newton steps once
    twice = periodic_orbit(orbit.model, 2, (2.0, 0.0))
    assert (twice.period, twice.minimal_period) == (2, 1)
    assert twice.points == pytest.approx(np.tile(orbit.state, (2, 1)), abs=1e-11)
    assert orbit.iterations <= 4
