"""Largest Lyapunov exponents against independent values and against multipliers."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from thermogear.analysis.lyapunov import lyapunov_exponent, lyapunov_exponents
from thermogear.base.errors import InputError
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import return_map

TRUTH = json.loads((Path(__file__).parents[1] / "dynamics" / "truth.json").read_text())
CHAOTIC = [case for case in TRUTH["cases"] if case["kind"] == "chaotic"]


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


@pytest.mark.parametrize("case", CHAOTIC, ids=lambda case: case["id"])
def test_exponent_of_chaos(case, compared):
    found = lyapunov_exponent(model_of(case["params"]), initial_state=case["initial_condition"])
    both = np.hypot(found.error, case["lyapunov_max_se"])
    off = (found.value - case["lyapunov_max"]) / (3 * both + 1e-3)
    compared(
        "Lyapunov exponent of chaos, over 3 standard errors + 0.001",
        "computed apart",
        off,
        1.0,
    )
    assert found.sum == pytest.approx(case["lyapunov_sum_exact"], rel=1e-14)
    assert found.kaplan_yorke == pytest.approx(case["kaplan_yorke_dim"], abs=0.02)
    assert 0 < found.error < 1e-3


@pytest.mark.parametrize("name", ["S1", "S2", "T100"])
def test_exponent_of_a_closed_orbit_is_its_multiplier(name, compared):
    case = next(c for c in TRUTH["cases"] if c["id"] == name)
    found = lyapunov_exponent(model_of(case["params"]), discard=20_000, batches=4)
    compared(
        "Lyapunov exponent of closed orbits",
        "logarithm of the multiplier",
        found.value - case["lyapunov"][0],
        1e-8,
    )
    assert found.second == pytest.approx(case["lyapunov"][1], abs=1e-8)


def test_several_lanes_are_the_same_as_one_by_one():
    model = TorsionalModel(
        damping_ratio=[0.1, 0.18],
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    many = lyapunov_exponents(model, discard=100, batches=3, batch_periods=50)
    for lane, zeta in enumerate((0.1, 0.18)):
        alone = lyapunov_exponent(
            model.replace(damping_ratio=zeta), discard=100, batches=3, batch_periods=50
        )
        assert alone.value == many[lane].value


def test_requests_out_of_range_are_refused():
    model = TorsionalModel(
        damping_ratio=0.1, frequency=1, stiffness_amplitude=0.1, mean_force=0.1, force_amplitude=0.1
    )
    for name, wrong, least in (("batches", 1, 2), ("discard", -1, 0), ("batch_periods", 0, 1)):
        with pytest.raises(
            InputError, match=f"{name}: got {wrong}; allowed a whole number >= {least}"
        ):
            lyapunov_exponent(model, **{name: wrong})
    least = lyapunov_exponent(model, discard=0, batches=2, batch_periods=1)
    assert least.batches.shape == (2,)
    with pytest.raises(InputError, match="one lane; use the plural form"):
        lyapunov_exponent(model.replace(frequency=[1.0, 1.1]))


def test_batches_are_the_growth_of_a_tangent_period_by_period():
    """Jacobians of single periods multiplied by hand; the tangent turns for a while first."""
    model = TorsionalModel(
        damping_ratio=0.1,
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    found = lyapunov_exponent(
        model, initial_state=(0.2, -0.1), discard=30, batches=3, batch_periods=20
    )
    section = return_map(model.lanes())
    state = section.visit(np.array([0.2, -0.1]), 30).points[-1]
    tangent, grown = np.array([1.0, 1.245]), []
    for _ in range(20 + 60):  # as long as a batch, at most 50
        visit = section.visit(state, 1)
        state, tangent = visit.points[-1], visit.jacobian @ tangent
        grown.append(np.log(np.linalg.norm(tangent)))
        tangent /= np.linalg.norm(tangent)
    means = np.array(grown[20:]).reshape(3, 20).mean(axis=1) * 1.245 / (2.0 * np.pi)
    assert found.batches == pytest.approx(means, abs=1e-8)
    assert found.value == pytest.approx(means.mean(), abs=1e-8)
    assert found.error == pytest.approx(means.std(ddof=1) / np.sqrt(3.0), abs=1e-8)
    assert found.state == pytest.approx(state, abs=1e-8)
    assert found.sum == pytest.approx(-0.2, abs=1e-15)
    assert found.value + found.second == found.sum
    assert found.kaplan_yorke == pytest.approx(1.0 + found.value / (found.value + 0.2), rel=1e-12)
    assert replace(found, value=-0.01).kaplan_yorke == 0.0


def test_progress_ends_at_all_periods_of_all_lanes():
    told = []
    lyapunov_exponents(
        TorsionalModel(
            damping_ratio=[0.1, 0.12],
            frequency=1.0,
            stiffness_amplitude=0.1,
            mean_force=0.1,
            force_amplitude=0.05,
        ),
        discard=30,
        batches=4,
        batch_periods=7,
        progress=lambda done, total: told.append((done, total)),
    )
    whole = 2 * (30 + 4 * 7)
    assert told[-1] == (whole, whole)
    assert {total for _, total in told} == {whole}
