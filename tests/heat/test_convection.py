"""Rotating faces: the similarity solution's published numbers, analogies, drag."""

import numpy as np
import pytest
from numpy.polynomial import Chebyshev
from rotating_disc import FAR, rotating_disc, rotating_disc_gradient
from scipy.integrate import cumulative_simpson, simpson, solve_ivp
from scipy.optimize import brentq

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.heat.convection import (
    _TABLE,
    TRANSITION,
    disc_nusselt,
    disc_torque,
    rotating_disc_flow,
    rotating_face_convection,
    turbulent_nusselt,
    turbulent_share,
)


def test_von_karman_flow_meets_its_known_wall_values(compared: Compared) -> None:
    radial, swirl, inflow = rotating_disc_flow()
    compared(
        "flow over a rotating disc, wall values",
        "known values of von Kármán's flow",
        [radial - 0.51023, swirl + 0.61592],
        5e-6,
    )
    assert inflow == pytest.approx(0.88447, abs=1e-5)


def test_the_stored_wall_values_are_those_of_the_flow() -> None:
    flow = rotating_disc()
    solved = (flow(0.0)[1], flow(0.0)[3], -flow(FAR)[4])
    assert rotating_disc_flow() == pytest.approx(solved, rel=1e-11)


@pytest.mark.parametrize(
    ("prandtl", "uniform", "growing"),
    [
        (0.71, 0.3259, 0.5185),
        (1.0, 0.3962, 0.6159),
        (10.0, 1.1341, 1.6206),
        (300.0, 3.9632, 5.4879),
        (1000.0, 6.0161, 8.2972),
    ],
)
def test_published_gradients_to_four_digits(
    prandtl: float, uniform: float, growing: float, compared: Compared
) -> None:
    found = [
        rotating_disc_gradient(prandtl, exponent=0.0) - uniform,
        rotating_disc_gradient(prandtl, exponent=2.0) - growing,
    ]
    compared("heat transfer of a rotating disc, Pr 0.71 to 1000", "computed apart", found, 6e-5)
    assert disc_nusselt(prandtl) == pytest.approx(growing, abs=6e-5)


def test_reynolds_analogy(compared: Compared) -> None:
    """T ~ r^2 at Pr = 1 obeys the equation of the swirl: -theta'(0) = -G'(0)."""
    heat = rotating_disc_gradient(1.0, exponent=2.0)
    compared(
        "heat transfer at Pr = 1, wall growing with the square",
        "Reynolds analogy with the drag",
        heat / -rotating_disc_flow()[1] - 1.0,
        1e-7,
    )


def test_uniform_disc_against_its_closed_integral() -> None:
    """m = 0: theta' ~ exp(Pr int H), an independent integration of the flow from the wall."""
    radial, swirl, _ = rotating_disc_flow()

    def slope(z: float, y: np.ndarray) -> list[float]:
        f, df, g, dg, h = y
        return [df, f**2 - g**2 + h * df, dg, 2 * f * g + h * dg, -2 * f]

    z = np.linspace(0.0, 4.0, 4001)
    flow = solve_ivp(slope, (0, 4), [0, radial, 1, swirl, 0], t_eval=z, rtol=1e-10, atol=1e-12)
    weight = np.exp(10.0 * cumulative_simpson(flow.y[4], x=z, initial=0.0))
    assert 1.0 / simpson(weight, x=z) == pytest.approx(
        rotating_disc_gradient(10.0, exponent=0.0), rel=1e-5
    )


def test_large_prandtl_grows_as_the_cube_root_and_gear_formula_is_far_off() -> None:
    ratio = rotating_disc_gradient(8e5, exponent=2.0) / rotating_disc_gradient(1e5, exponent=2.0)
    assert ratio == pytest.approx(2.0, rel=5e-3)
    assert rotating_disc_gradient(1000.0, exponent=0.0) == pytest.approx(0.62 * 10.0, rel=0.05)
    assert rotating_disc_gradient(1000.0, exponent=2.0) == pytest.approx(0.85 * 10.0, rel=0.05)
    usual = 0.308 * np.sqrt(4.0) * np.sqrt(np.array([0.71, 300.0, 1000.0]))
    excess = usual / disc_nusselt([0.71, 300.0, 1000.0]) - 1.0
    assert excess == pytest.approx([0.001, 0.94, 1.35], abs=0.01)


def test_interpolation_is_as_good_as_the_solution() -> None:
    probe = np.geomspace(0.11, 9e5, 12)
    exact = [rotating_disc_gradient(float(p), exponent=2.0) for p in probe]
    assert disc_nusselt(probe) == pytest.approx(exact, rel=1e-5)


def test_the_kept_table_is_what_the_equations_give() -> None:
    def logarithm(ln_pr: np.ndarray) -> np.ndarray:
        return np.log([rotating_disc_gradient(float(np.exp(p)), exponent=2.0) for p in ln_pr])

    solved = Chebyshev.interpolate(logarithm, 26, domain=_TABLE.domain)
    assert np.exp(_TABLE.domain) == pytest.approx([0.05, 2e6], rel=1e-14)
    assert _TABLE.coef == pytest.approx(solved.coef, abs=1e-9)


def test_face_coefficient_laminar_turbulent_and_at_rest() -> None:
    nu, k, pr, omega = 2e-5, 0.135, 300.0, 100.0
    laminar = rotating_face_convection(omega, [0.05, 0.1], nu, k, pr)
    expected = 5.4879 * k * np.sqrt(omega / nu)
    assert laminar == pytest.approx(np.full(2, expected), rel=1e-4)
    assert rotating_face_convection(0.0, 0.1, nu, k, pr) == 0.0
    radius = np.sqrt(2.0 * TRANSITION[1] * nu / omega)
    turbulent = rotating_face_convection(omega, radius, nu, k, pr)
    assert turbulent > rotating_face_convection(omega, 0.5 * radius, nu, k, pr)


def test_turbulent_law_is_the_analogy_of_von_karmans_torque() -> None:
    """m = 2, Pr = 1: Nu = 0.0267 Re^0.8, the wall stress of C_M = 0.073 Re^-0.2 per face."""
    nusselt = rotating_face_convection(1.0, 1.0, 1e-6, 1.0, 1.0) / (1e6) ** 0.8
    assert nusselt == pytest.approx(0.073 * 4.6 / (4.0 * np.pi), rel=5e-3)


def test_torque_of_a_wholly_immersed_disc() -> None:
    """C_M = 3.87/sqrt(Re) laminar and 0.146 Re^-0.2 far beyond the transition, both faces."""
    rho, nu, big = 850.0, 4e-5, 0.1
    for omega, coefficient, power in ((50.0, 3.87, -0.5), (4e4, 0.146, -0.2)):
        reynolds = omega * big**2 / nu
        expected = coefficient * reynolds**power * 0.5 * rho * omega**2 * big**5
        assert disc_torque(omega, big, rho, nu) == pytest.approx(expected, rel=5e-3)


def test_heat_and_drag_pass_the_transition_without_a_jump() -> None:
    """Both laws outside are left untouched, and between them nothing turns by a step."""
    low, high = TRANSITION
    assert turbulent_share([0.0, low, 0.5 * (low + high), high, 1e9]).tolist() == [0, 0, 0.5, 1, 1]
    nu, pr = 2e-5, 300.0
    reynolds = np.linspace(0.9 * low, 1.1 * high, 4001)
    omega = reynolds * nu  # at a radius of 1 m
    for values in (
        rotating_face_convection(omega, 1.0, nu, 0.135, pr),
        disc_torque(omega, 1.0, 850.0, nu),
    ):
        steps = np.diff(np.log(values))
        assert np.all(steps > 0.0)
        assert steps.max() < 1.5e-3
        # the slope has no step either
        assert np.abs(np.diff(steps)).max() < 5e-6
    ends = rotating_face_convection([0.999 * low * nu, high * nu], 1.0, nu, 0.135, pr)
    assert ends[0] == pytest.approx(0.135 * float(disc_nusselt(pr)) * np.sqrt(0.999 * low))
    assert ends[1] == pytest.approx(0.135 * float(turbulent_nusselt(high, prandtl=pr)))


def test_a_disc_is_laminar_inside_and_turbulent_outside() -> None:
    """The torque is the local stress of the layers by their share of time, ring by ring."""
    rho, nu, big, omega = 850.0, 2e-5, 0.2, 300.0
    r = np.linspace(0.0, big, 200_001)
    reynolds = omega * r**2 / nu
    share = turbulent_share(reynolds)
    laminar = 0.615922 * rho * np.sqrt(nu * omega**3) * r
    turbulent = 0.0267 * rho * (omega * r) ** 2 * np.maximum(reynolds, 1.0) ** -0.2
    ring = 4.0 * np.pi * r**2 * ((1.0 - share) * laminar + share * turbulent)
    assert disc_torque(omega, big, rho, nu) == pytest.approx(np.trapezoid(ring, r), rel=1e-6)
    # Prandtl's correction: the core misses what a layer turbulent from the axis has more
    far = disc_torque(30.0 * omega, big, rho, nu)
    everywhere = 4.0 * np.pi / 4.6 * 0.0267 * rho * (30.0 * omega) ** 2 * big**5
    everywhere *= (30.0 * omega * big**2 / nu) ** -0.2
    assert 0.998 < far / everywhere < 1.0


def sublayer_of_mixing_length(prandtl: float, edge: float) -> tuple[float, float]:
    """(T+, u+) at ``edge`` [wall units] with kappa y outside and 0.0009 y^3 at the wall."""
    y = np.concatenate([[0.0], np.geomspace(1e-4, edge, 4000)])
    length = 0.4 * y * (1.0 - np.exp(-y / 26.0))
    eddy = 0.5 * (np.sqrt(1.0 + 4.0 * length**2) - 1.0)
    # at the wall it grows as the cube of the distance (Notter and Sleicher)
    eddy = np.where(y < 12.0, np.maximum(eddy, 9e-4 * y**3), eddy)
    return (
        float(np.trapezoid(1.0 / (1.0 / prandtl + eddy), y)),
        float(np.trapezoid(1.0 / (1.0 + eddy), y)),
    )


@pytest.mark.parametrize("reynolds", [3e5, 1e6])
def test_prandtl_dependence_of_the_turbulent_layer_against_a_mixing_length(
    reynolds: float,
) -> None:
    root = np.sqrt(0.0267) * reynolds**-0.1
    edge = brentq(lambda y: sublayer_of_mixing_length(1.0, y)[1] - 1.0 / root, 20.0, 1e5)
    for prandtl in (1.0, 3.0, 10.0, 100.0, 300.0, 1000.0, 3000.0):
        drop, _ = sublayer_of_mixing_length(prandtl, edge)
        apart = reynolds * prandtl * root / drop
        assert turbulent_nusselt(reynolds, prandtl=prandtl) == pytest.approx(apart, rel=0.02)
    # the customary exponent is the slope at Pr = 1 and nowhere else
    slope = np.log(
        turbulent_nusselt(reynolds, prandtl=1.01) / turbulent_nusselt(reynolds, prandtl=1.0)
    )
    assert slope / np.log(1.01) == pytest.approx(0.6, abs=0.06)
    usual = turbulent_nusselt(reynolds, prandtl=1.0) * 300.0**0.6
    assert usual / turbulent_nusselt(reynolds, prandtl=300.0) > 2.4
    # Chilton and Colburn's cube root is the limit
    ratio = turbulent_nusselt(reynolds, prandtl=8e5) / turbulent_nusselt(reynolds, prandtl=1e5)
    assert ratio == pytest.approx(2.0, rel=2e-3)
    # Shaw and Hanratty's measured law of mass transfer at high Schmidt numbers
    drop = reynolds * 300.0 * root / turbulent_nusselt(reynolds, prandtl=300.0)
    assert drop == pytest.approx(300.0**0.704 / 0.0889, rel=0.1)


def test_torque_grows_with_immersion_and_halves_at_the_axis() -> None:
    depths = np.linspace(0.0, 2.0, 21)
    torque = disc_torque(50.0, 0.1, 850.0, 4e-5, depths)
    assert torque[0] == 0.0
    assert np.all(np.diff(torque) > 0.0)
    assert torque[10] == pytest.approx(0.5 * torque[20], rel=1e-6)
    # what is not wetted below is wetted above: the two parts make a whole disc
    assert torque + torque[::-1] == pytest.approx(np.full(21, torque[20]), rel=1e-5)
    assert disc_torque(0.0, 0.1, 850.0, 4e-5, 1.0) == 0.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: disc_nusselt(0.01), "prandtl: got 0.01 .. 0.01; allowed 0.1 .. 1e6"),
        (lambda: disc_nusselt(1e8), "prandtl: got 1e+08 .. 1e+08; allowed 0.1 .. 1e6"),
        (lambda: disc_torque(1.0, 0.1, 850.0, 4e-5, 2.5), "immersion: got 2.5 .. 2.5"),
    ],
)
def test_impossible_input_is_refused(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value).startswith(message)
