"""The clamped ring against a Ritz solution, closed forms, published numbers and reciprocity."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.materials import MATERIALS
from thermogear.gears.geometry import Gear
from thermogear.gears.ring import body_matrices, rim_compliance, ring_compliance
from thermogear.gears.stiffness import sainsot_coefficients

PINION = Gear(25, 5e-3, face_width=20e-3, bore_radius=20e-3)
WHEEL = Gear(75, 5e-3, face_width=20e-3, bore_radius=60e-3)


def ritz(n: int, outer: float, inner: float, nu: float, degree: int = 26) -> np.ndarray:
    """Rim displacements under P cos(n phi), Q sin(n phi) by minimum of energy, times E/R.

    Displacements (r - r_x) polynomial in r: knows nothing of the Michell solutions.
    """
    x, w = np.polynomial.legendre.leggauss(60)
    r = 0.5 * (outer + inner) + 0.5 * (outer - inner) * x
    w = w * 0.5 * (outer - inner)
    basis, slope = [], []
    for k in range(degree):
        p = np.polynomial.legendre.Legendre.basis(k, domain=[inner, outer])
        basis.append((r - inner) * p(r))
        slope.append(p(r) + (r - inner) * p.deriv()(r))
    f, df = np.array(basis), np.array(slope)
    at_rim = np.full(degree, outer - inner)
    zero = np.zeros_like(f)
    e_r, e_t = np.vstack([df, zero]), np.vstack([f / r, n * f / r])
    shear = np.vstack([-n * f / r, df - f / r])
    plane, g = 1.0 / (1.0 - nu**2), 0.5 / (1.0 + nu)
    weight = w * r
    stiffness = (
        plane * ((e_r * weight) @ e_r.T + (e_t * weight) @ e_t.T)
        + plane * nu * ((e_r * weight) @ e_t.T + (e_t * weight) @ e_r.T)
        + g * ((shear * weight) @ shear.T)
    )
    load = np.zeros((2 * degree, 2))
    load[:degree, 0] = load[degree:, 1] = at_rim
    return load.T @ np.linalg.solve(stiffness, outer * load) / outer


@pytest.mark.parametrize("ratio", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("nu", [0.0, 0.3, 1.0 / 3.0])
def test_each_order_is_the_minimum_of_energy(ratio: float, nu: float, compared: Compared) -> None:
    orders = np.array([1, 2, 3, 4, 7])
    got = rim_compliance(orders, outer=1.0, inner=ratio, poisson=nu)
    differences = []
    for i, n in enumerate(orders):
        exact = ritz(int(n), 1.0, ratio, nu)
        differences += [
            got[0][i] / exact[0, 0] - 1.0,
            (got[1][i] - exact[0, 1]) / max(abs(exact[0, 1]), exact[0, 0]),
            got[2][i] / exact[1, 1] - 1.0,
        ]
    compared(
        "rim compliance of the ring, orders 1 to 7",
        "minimum of elastic energy over polynomials (Ritz)",
        differences,
        2e-8,
    )


def test_high_orders_see_a_half_plane() -> None:
    """n -> inf: g_rr = 2/n, g_tt = 2/n, g_rt = (1 - nu)/n for an edge in plane stress."""
    n = np.array([800])
    rr, rt, tt = rim_compliance(n, outer=1.0, inner=0.4, poisson=0.3)
    assert float(rr[0]) * 800 == pytest.approx(2.0, rel=3e-3)
    assert float(tt[0]) * 800 == pytest.approx(2.0, rel=3e-3)
    assert float(rt[0]) * 800 == pytest.approx(0.7, rel=4e-3)


@pytest.mark.parametrize(("gear", "stiffness"), [(PINION, 8.36693e8), (WHEEL, 7.58929e8)])
def test_body_stiffness_of_the_reference_gears(
    gear: Gear, stiffness: float, compared: Compared
) -> None:
    t = np.tan(gear.pressure_angle)
    got = 1.0 / float(ring_compliance(gear, t))
    compared(
        "stiffness of the clamped body at the pitch point",
        "computed apart, m 5, 25:75",
        got / stiffness - 1.0,
        1e-3,
    )


@pytest.mark.parametrize(("gear", "windup"), [(PINION, 3.78e-10), (WHEEL, 3.86e-10)])
def test_hub_windup_is_the_torsion_of_the_ring(
    gear: Gear, windup: float, compared: Compared
) -> None:
    t = np.array([0.3, 0.45])
    more = ring_compliance(gear, t) - ring_compliance(gear, t, windup=False)
    material = MATERIALS["steel"]
    shear = material.youngs_modulus / (2.0 * (1.0 + material.poisson_ratio))
    # torque r_b turns the rim by r_b (1/r_x^2 - 1/R^2)/(4 pi G b), a travel of r_b times that
    travel = gear.base_radius**2 * (gear.bore_radius**-2 - gear.root_radius**-2)
    travel /= 4.0 * np.pi * shear * gear.face_width
    compared(
        "wind-up of the body against its bore",
        "torsion of a ring in closed form",
        more / travel - 1.0,
        1e-12,
    )
    assert travel == pytest.approx(windup, rel=2e-3)


def test_deflection_is_reciprocal_and_fades_with_distance() -> None:
    one = ring_compliance(WHEEL, 0.3, other=0.45, pitches=2)
    other = ring_compliance(WHEEL, 0.45, other=0.3, pitches=-2)
    assert float(one) == pytest.approx(float(other), rel=1e-12)
    own = [float(ring_compliance(WHEEL, 0.36, pitches=j, windup=False)) for j in range(5)]
    assert own[0] > 2.0 * own[1] > 0.0
    assert all(a > b for a, b in itertools.pairwise(own))


def test_series_has_converged() -> None:
    few, centre = body_matrices(PINION, harmonics=1500)
    many, _ = body_matrices(PINION, harmonics=6000)
    assert np.allclose(few[centre], many[centre], rtol=5e-5)


def test_energy_is_positive_for_any_load() -> None:
    for gear in (PINION, WHEEL, Gear(75, 5e-3, bore_radius=170e-3)):
        table, centre = body_matrices(gear, windup=False)
        assert np.linalg.eigvalsh(table[centre]).min() > 0.0


def test_sainsot_is_near_the_ring() -> None:
    """Its P* and P* Q* are the ring's radial and shear terms: pinion 0.3 %, wheel 6 %."""
    for gear, tolerance in ((PINION, 5e-3), (WHEEL, 0.07)):
        c = sainsot_coefficients(gear.root_half_angle, ratio=gear.root_radius / gear.bore_radius)
        table, centre = body_matrices(gear)
        assert table[centre][1, 1] == pytest.approx(c["P"], rel=tolerance)
        assert table[centre][0, 0] == pytest.approx(c["P"] * c["Q"], rel=tolerance)


def test_thin_rim_and_moduli() -> None:
    thin = Gear(75, 5e-3, face_width=20e-3, bore_radius=175e-3)
    own = float(ring_compliance(thin, 0.36, windup=False))
    assert np.isfinite(own)
    assert own > 0.0
    assert float(ring_compliance(thin, 0.36, modulus=103e9, face_width=10e-3)) == pytest.approx(
        4.0 * float(ring_compliance(thin, 0.36)), rel=1e-12
    )
