"""The load-sharing kernel against enumeration of all contact sets, and its energy."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.optimize import minimize

from thermogear.gears.sharing_kernel import _share_one, _solve_spd


def random_mesh(seed: int, count: int = 4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(count, count))
    compliance = root @ root.T / count + np.eye(count)
    return compliance, rng.uniform(0.0, 2.0, count), rng.uniform(0.1, 1.0, count)


def by_enumeration(
    load: float, gap: np.ndarray, matrix: np.ndarray
) -> tuple[np.ndarray, float, float]:
    """The one set of pairs whose forces push and whose other gaps stay open."""
    count = gap.size
    for size in range(1, count + 1):
        for loaded in itertools.combinations(range(count), size):
            index = list(loaded)
            soft = np.linalg.inv(matrix[np.ix_(index, index)])
            delta = (load + soft.sum(axis=0) @ gap[index]) / soft.sum()
            force = np.zeros(count)
            force[index] = soft @ (delta - gap[index])
            if force[index].min() > 0.0 and np.all(matrix @ force + gap >= delta - 1e-12):
                return force, delta, float(soft.sum())
    raise AssertionError("no contact set fits")


@pytest.mark.parametrize("run", [_share_one, _share_one.py_func], ids=["compiled", "python"])
def test_linear_contact_is_the_only_contact_set_that_fits(run) -> None:  # type: ignore[no-untyped-def]
    for seed in range(40):
        compliance, gap, linear = random_mesh(seed)
        for load in (0.05, 1.0, 30.0):
            force = np.empty(4)
            delta, stiffness, settled = run(load, True, gap, compliance, linear, 0.0, 0.0, force)
            exact, at, slope = by_enumeration(load, gap, compliance + np.diag(linear))
            assert settled
            assert force == pytest.approx(exact, rel=1e-9, abs=1e-11 * load)
            assert delta == pytest.approx(at, rel=1e-10)
            assert stiffness == pytest.approx(slope, rel=1e-9)


def test_nonlinear_contact_has_the_least_energy() -> None:
    """Energy with delta_H = F (A - C ln F) + K F^0.9, minimised by another method."""
    logarithm, power = 0.05, 0.02
    for seed in range(6):
        compliance, gap, linear = random_mesh(seed)

        def energy(f: np.ndarray, c=compliance, g=gap, a=linear) -> float:
            f = np.maximum(f, 1e-300)
            contact = 0.5 * a * f**2 - logarithm * f**2 * (0.5 * np.log(f) - 0.25)
            return float(0.5 * f @ c @ f + g @ f + np.sum(contact + power * f**1.9 / 1.9))

        force = np.empty(4)
        _, _, settled = _share_one(3.0, True, gap, compliance, linear, logarithm, power, force)
        assert settled
        found = minimize(
            energy,
            np.full(4, 0.75),
            method="SLSQP",
            bounds=[(0.0, None)] * 4,
            constraints={"type": "eq", "fun": lambda f: f.sum() - 3.0},
            options={"ftol": 1e-15, "maxiter": 500},
        )
        assert energy(force) <= found.fun + 1e-9
        assert force == pytest.approx(found.x, abs=2e-4)


def test_a_given_deflection_gives_back_its_load() -> None:
    for seed in range(20):
        compliance, gap, linear = random_mesh(seed)
        one, two = np.empty(4), np.empty(4)
        delta, stiffness, _ = _share_one(2.0, True, gap, compliance, linear, 0.05, 0.02, one)
        same, slope, settled = _share_one(delta, False, gap, compliance, linear, 0.05, 0.02, two)
        assert settled
        assert two == pytest.approx(one, rel=1e-9, abs=1e-10)
        assert (same, slope) == pytest.approx((delta, stiffness), rel=1e-9)
    force = np.empty(4)
    assert _share_one(gap.min(), False, gap, compliance, linear, 0.0, 0.0, force) == (
        gap.min(),
        0.0,
        True,
    )
    assert np.array_equal(force, np.zeros(4))


def test_pairs_that_cannot_touch_are_left_out() -> None:
    compliance, gap, linear = random_mesh(3)
    gap[1] = np.inf
    force = np.empty(4)
    _, _, settled = _share_one(50.0, True, gap, compliance, linear, 0.0, 0.0, force)
    assert settled
    assert force[1] == 0.0


@pytest.mark.parametrize("run", [_solve_spd, _solve_spd.py_func], ids=["compiled", "python"])
def test_small_solver(run) -> None:  # type: ignore[no-untyped-def]
    compliance, gap, linear = random_mesh(7)
    right = np.stack([gap, linear], axis=1)
    exact = np.linalg.solve(compliance[:3, :3], right[:3])
    run(compliance.copy(), 3, right)
    assert right[:3] == pytest.approx(exact, rel=1e-12)
