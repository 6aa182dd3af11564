"""Largest Lyapunov exponents against independent values and against multipliers."""

import json
from pathlib import Path

import numpy as np
import pytest

from thermogear.analysis.lyapunov import lyapunov_exponent, lyapunov_exponents
from thermogear.base.errors import InputError
from thermogear.dynamics.models import TorsionalModel

TRUTH = json.loads((Path(__file__).parents[1] / "dynamics" / "truth.json").read_text())
CHAOTIC = [case for case in TRUTH["cases"] if case["kind"] == "chaotic"]


def model_of(params):
    return TorsionalModel(
        params["zeta"],
        params["omega_h"],
        params["epsilon"],
        params["F_m"],
        params["F_h"],
        params["b_prime"],
        params["epsilon_T"],
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
    model = TorsionalModel([0.1, 0.18], 1.245, 0.335, 0.017, -1.16)
    many = lyapunov_exponents(model, discard=100, batches=3, batch_periods=50)
    for lane, zeta in enumerate((0.1, 0.18)):
        alone = lyapunov_exponent(
            model.replace(damping_ratio=zeta), discard=100, batches=3, batch_periods=50
        )
        assert alone.value == many[lane].value


def test_requests_out_of_range_are_refused():
    with pytest.raises(InputError, match="batches: got 1; allowed a whole number >= 2"):
        lyapunov_exponent(TorsionalModel(0.1, 1, 0.1, 0.1, 0.1), batches=1)
