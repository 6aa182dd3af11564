"""Smooth models of any dimension against closed forms: orbits, multipliers, determinants."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from thermogear.analysis.any_motion import settle
from thermogear.analysis.orbits import periodic_orbit
from thermogear.analysis.walk import Search
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics.return_map import ReturnMap, return_map
from thermogear.dynamics.smooth_map import SmoothModel


def linear(matrix, force, omega):
    """y' = A y + Re(F exp(i omega t)), which every state of any dimension has a closed form of."""
    return SmoothModel(
        derivative=lambda t, y: matrix @ y + (force * np.exp(1j * omega * t)).real,
        jacobian=lambda t, y: matrix,
        period=2.0 * np.pi / omega,
        unit=np.ones(len(matrix)),
        divergence=float(np.trace(matrix)),
    )


def chain(masses):
    """Masses in a row on springs to their neighbours and the ground, damped; forced at one end."""
    stiffness = 2.3 * np.eye(masses) - np.eye(masses, k=1) - np.eye(masses, k=-1)
    damping = 0.1 * stiffness + 0.05 * np.eye(masses)
    none, one = np.zeros((masses, masses)), np.eye(masses)
    matrix = np.block([[none, one], [-stiffness, -damping]])
    force = np.zeros(2 * masses, complex)
    force[masses] = 0.7 + 0.2j
    return matrix, force


@pytest.mark.parametrize("masses", [1, 2, 3])
@pytest.mark.parametrize("period", [1, 2])
def test_a_linear_model_of_any_dimension_has_its_closed_orbit(masses, period):
    matrix, force = chain(masses)
    omega = 1.3
    model = linear(matrix, force, omega)
    orbit = periodic_orbit(model, period, np.zeros(2 * masses))
    exact = np.linalg.solve(1j * omega * np.eye(2 * masses) - matrix, force).real
    np.testing.assert_allclose(orbit.state, exact, atol=1e-11)
    flow = expm(matrix * model.period * period)
    np.testing.assert_allclose(orbit.jacobian, flow, atol=1e-10)
    known = np.linalg.eigvals(flow)
    for one in orbit.multipliers:
        assert np.min(np.abs(known - one)) < 1e-10
    assert np.all(np.diff(np.abs(orbit.multipliers)) <= 1e-12)
    assert orbit.determinant == pytest.approx(np.linalg.det(orbit.jacobian), rel=1e-8)
    assert orbit.stable
    assert orbit.minimal_period == 1


def test_the_determinant_is_the_exponential_of_the_trace_along_a_nonlinear_path():
    """Liouville: det D P = exp(integral of tr df/dy), of a trace that changes with the state."""
    mu, omega = 0.6, 1.1

    def rates(t, y):
        x, v, _ = y
        return np.array([v, mu * (1 - x**2) * v - x + np.cos(omega * t), mu * (1 - x**2)])

    def matrix(t, y):
        x, v, _ = y
        return np.array(
            [[0, 1, 0], [-2 * mu * x * v - 1, mu * (1 - x**2), 0], [-2 * mu * x, 0, 0.0]]
        )

    model = SmoothModel(
        derivative=rates, jacobian=matrix, period=2 * np.pi / omega, unit=np.ones(3)
    )
    visit = return_map(model).visit(np.array([0.4, -0.3, 0.0]), 2)
    # the third component is the integral of the trace itself, and has no share in it
    inner = visit.jacobian[:2, :2]
    assert np.linalg.det(inner) == pytest.approx(np.exp(visit.points[-1, 2]), rel=1e-10)
    assert np.isnan(return_map(model).determinant(2))


def duffing(force=0.3):
    """x'' + 0.3 x' - x + x^3 = F cos(1.2 t): chaotic at 0.5, one period at 0.2."""
    return SmoothModel(
        derivative=lambda t, y: np.array(
            [y[1], -0.3 * y[1] + y[0] - y[0] ** 3 + force * np.cos(1.2 * t)]
        ),
        jacobian=lambda t, y: np.array([[0.0, 1.0], [1.0 - 3.0 * y[0] ** 2, -0.3]]),
        period=2.0 * np.pi / 1.2,
        unit=np.ones(2),
        divergence=-0.3,
        tolerance=1e-9,
    )


def test_the_jacobian_of_a_visit_is_its_derivative_by_the_start():
    section = return_map(duffing())
    start = np.array([0.3, -0.2])
    visit = section.visit(start, 2)
    small = 1e-5
    for k, way in enumerate(np.eye(2)):
        ahead, behind = (section.visit(start + s * small * way, 2).points[-1] for s in (1, -1))
        np.testing.assert_allclose(
            visit.jacobian[:, k], (ahead - behind) / (2 * small), rtol=1e-5, atol=1e-5
        )
    assert np.linalg.det(visit.jacobian) == pytest.approx(section.determinant(2), rel=1e-6)


def test_carry_stretch_and_visit_are_one_motion():
    section = return_map(duffing())
    assert isinstance(section, ReturnMap)
    start = np.array([0.3, -0.2])
    visit = section.visit(start, 3)
    np.testing.assert_allclose(section.carry(start, 3), visit.points[1:], atol=1e-6)
    path = section.stretch(start, direction=np.array([1.0, 0.0]), periods=3)
    assert path.growth.sum() == pytest.approx(
        np.log(np.linalg.norm(visit.jacobian[:, 0])), abs=1e-5
    )


def test_a_forced_duffing_oscillator_settles_where_it_is_known_to():
    """Chaos at F = 0.5, period 1 at 0.2 (the standard case of this equation)."""
    search = Search(first=32, cap=128, starts=1)
    calm = settle(return_map(duffing(0.2)), np.array([1.0, 0.0]), search)
    assert calm.name == "period-1"
    wild = settle(return_map(duffing(0.5)), np.array([1.0, 0.0]), search)
    assert wild.name == "chaotic"


def test_what_a_smooth_model_cannot_be_is_refused():
    good = {"derivative": lambda t, y: -y, "jacobian": lambda t, y: -np.eye(1)}
    for wrong in (
        {"period": 0.0, "unit": [1.0]},
        {"period": 1.0, "unit": [0.0]},
        {"period": 1.0, "unit": []},
        {"period": 1.0, "unit": [1.0], "tolerance": 0.0},
    ):
        with pytest.raises(InputError):
            SmoothModel(**good, **wrong)


def test_a_motion_that_leaves_every_bound_says_so():
    model = SmoothModel(
        derivative=lambda t, y: y**2,
        jacobian=lambda t, y: np.diag(2.0 * y),
        period=2.0,
        unit=[1.0],
    )
    with np.errstate(over="ignore", invalid="ignore"), pytest.raises(ConvergenceError):
        return_map(model).visit(np.ones(1))
