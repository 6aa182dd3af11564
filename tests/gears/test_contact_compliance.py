"""Hertzian approach laws: a numerical half-space, limits and familiar figures."""

from __future__ import annotations

import numpy as np
import pytest

from conftest import Compared
from thermogear.gears.contact import hertz_half_width, reduced_modulus
from thermogear.gears.stiffness import (
    palmgren_approach,
    weber_approach,
    yang_sun_stiffness,
)

E, NU, B = 206e9, 0.3, 20e-3
E_STAR = float(reduced_modulus(E, NU, E, NU))


def pressed(force: float, rho: float, h: float) -> float:
    """Strain under the centre of the load, integrated down to the depth ``h``.

    On the axis below a semi-elliptic pressure (Johnson eq. 4.46), plane strain.
    """
    a = float(hertz_half_width(force / B, rho, E_STAR))
    p0 = 2.0 * force / (B * np.pi * a)
    x, w = np.polynomial.legendre.leggauss(400)
    # z = a sinh(u): the strains fall as 1/z
    top = np.arcsinh(h / a)
    u = 0.5 * top * (1.0 + x)
    z = a * np.sinh(u)
    root = np.sqrt(a * a + z * z)
    sigma_x = -p0 * ((a * a + 2 * z * z) / (a * root) - 2 * z / a)
    sigma_z = -p0 * a / root
    strain = ((1 - NU**2) * sigma_z - NU * (1 + NU) * sigma_x) / E
    return float(-np.sum(strain * a * np.cosh(u) * 0.5 * top * w))


@pytest.mark.parametrize("depth", [5e-3, 2e-4, 5e-5, 1e-6])
def test_weber_is_the_half_plane_under_the_hertz_ellipse(depth: float, compared: Compared) -> None:
    """At every depth, that of a thin tip below the contact's half width (0.1 mm) as well."""
    force, rho = 4000.0, 0.016
    a = float(hertz_half_width(force / B, rho, E_STAR))
    compared(
        "approach of two flanks by Weber",
        "strain of the half plane under Hertz, integrated",
        float(weber_approach(force, depth=depth, half_width=a, modulus=E, poisson=NU, face_width=B))
        / pressed(force, rho, depth)
        - 1.0,
        1e-9,
    )


def test_weber_far_below_the_contact_is_the_printed_logarithm() -> None:
    a, h = 1e-4, np.array([1e-3, 4e-3])
    printed = np.log(2.0 * h / a) - NU / (2.0 * (1.0 - NU))
    scale = 2.0 * (1.0 - NU**2) / (np.pi * E * B)
    got = weber_approach(1.0, depth=h, half_width=a, modulus=E, poisson=NU, face_width=B) / scale
    assert np.all(np.abs(got / printed - 1.0) < (a / h) ** 2)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
def test_an_approach_never_draws_and_rises_with_the_force(poisson: float) -> None:
    force = np.geomspace(1e-3, 1e9, 200)
    half = hertz_half_width(force / B, 0.016, E_STAR)
    for depth in (4e-3, 1e-4, 1e-6, 1e-9):
        approach = weber_approach(
            force, depth=depth, half_width=half, modulus=E, poisson=poisson, face_width=B
        )
        assert np.all(approach > 0.0)
        assert np.all(np.diff(approach) > 0.0)
    assert np.array_equal(
        weber_approach(force, depth=0.0, half_width=half, modulus=E, poisson=poisson, face_width=B),
        np.zeros(200),
    )


def test_weber_at_zero_load_and_over_shapes() -> None:
    force = np.array([[0.0], [1e3], [4e3]])
    depth = np.array([4e-3, 6e-3])
    half = hertz_half_width(force / B, 0.016, E_STAR)
    got = weber_approach(force, depth=depth, half_width=half, modulus=E, poisson=NU, face_width=B)
    assert got.shape == (3, 2)
    assert np.array_equal(got[0], [0.0, 0.0])
    assert np.all(np.diff(got, axis=0) > 0)
    assert np.isnan(
        weber_approach(np.nan, depth=4e-3, half_width=1e-4, modulus=E, poisson=NU, face_width=B)
    )


def test_palmgren_for_steel_in_its_own_units() -> None:
    force, length = np.array([0.0, 1e3, 2e4]), 20.0
    millimetres = 3.84e-5 * force**0.9 / length**0.8
    assert 1e3 * palmgren_approach(force, E_STAR, 1e-3 * length) == pytest.approx(
        millimetres, rel=5e-3
    )


def test_yang_sun_is_linear_in_width() -> None:
    assert np.allclose(
        yang_sun_stiffness(E_STAR, [0.01, 0.02]), 0.5 * np.pi * E_STAR * np.array([0.01, 0.02])
    )
