"""Centrifugal growth: limits of the ring, its differential equation, and a toothed sector."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from skfem import LinearForm

import finite_growth
from finite_elements.elements import ReferencePatch
from thermogear import Gear
from thermogear.base.arrays import Floats
from thermogear.gears.centrifugal import (
    centrifugal_displacement,
    centrifugal_flank_growth,
    rotating_ring_displacement,
)
from thermogear.heat.expansion import RadialField

RHO, E, NU, OMEGA, R = 7850.0, 206e9, 0.3, 2618.0, 80e-3
UNIT = RHO * OMEGA**2 * R**3 / E
STEEL = {"density": RHO, "modulus": E, "poisson": NU}


def ring(radius: float | Floats, inner: float, bore: str = "free", pull: float = 0.0) -> Floats:
    return rotating_ring_displacement(
        radius, OMEGA, inner_radius=inner, outer_radius=R, bore=bore, rim_pull=pull, **STEEL
    )


def test_a_solid_disc_and_a_thin_ring() -> None:
    solid = 0.25 * (1.0 - NU) * UNIT
    assert float(ring(R, 0.0)) == pytest.approx(solid, rel=1e-14)
    assert float(ring(R, 1e-6 * R)) == pytest.approx(solid, rel=1e-9)
    assert float(ring(R, 0.4 * R, "shaft")) == float(ring(R, 0.0))
    assert float(ring(R, (1.0 - 1e-6) * R)) == pytest.approx(UNIT, rel=1e-5)
    assert float(ring(0.4 * R, 0.4 * R, "rigid")) == 0.0


@pytest.mark.parametrize(("bore", "pull"), [("free", 0.0), ("free", 3e7), ("rigid", 2e7)])
def test_the_ring_is_a_finite_difference_solution_of_plane_stress(
    bore: str, pull: float, compared: Callable[..., None]
) -> None:
    """u'' + u'/r - u/r^2 = -(1 - nu^2) rho w^2 r/E; sigma_r = E (u' + nu u/r)/(1 - nu^2)."""
    inner, count = 0.35 * R, 601
    r, step = np.linspace(inner, R, count, retstep=True)
    matrix, right = np.zeros((count, count)), -(1.0 - NU**2) * RHO * OMEGA**2 * r / E
    for k in range(1, count - 1):
        matrix[k, k - 1 : k + 2] = (
            1.0 / step**2 - 0.5 / (step * r[k]),
            -2.0 / step**2 - 1.0 / r[k] ** 2,
            1.0 / step**2 + 0.5 / (step * r[k]),
        )
    one_sided = np.array([-1.5, 2.0, -0.5]) / step
    matrix[0, :3], matrix[-1, -3:] = one_sided, -one_sided[::-1]
    matrix[0, 0] += NU / inner
    matrix[-1, -1] += NU / R
    right[0], right[-1] = 0.0, pull * (1.0 - NU**2) / E
    if bore == "rigid":
        matrix[0], right[0] = np.eye(count)[0], 0.0
    solved = np.linalg.solve(matrix, right)
    apart = ring(r, inner, bore, pull) / solved.max() - solved / solved.max()
    compared("displacement of a turning ring", "finite differences", apart, 3e-5)


@pytest.mark.parametrize("bore", ["free", "rigid"])
def test_a_toothed_sector_of_finite_elements_grows_alike(
    bore: str, monkeypatch: pytest.MonkeyPatch, compared: Callable[..., None]
) -> None:
    """Body and teeth in one piece under rho w^2 r, pitch point and tip, 20 to 80 teeth."""

    def pulled(patch: ReferencePatch, strain: object) -> Floats:
        form = LinearForm(lambda v, w: w.x[0] * v[0] + w.x[1] * v[1])
        return patch._ours(form.assemble(patch._basis))

    monkeypatch.setattr(finite_growth, "thermal_load", pulled)
    for teeth in (20, 40, 80):
        gear = Gear(teeth, 4e-3)
        field = RadialField.uniform(
            bore_radius=gear.bore_radius, tip_radius=gear.tip_radius, temperature=300.0,
            reference=300.0,
        )  # fmt: skip
        radius = np.array([gear.pitch_radius, gear.tip_radius])
        load = gear.material.density * OMEGA**2 / gear.material.youngs_modulus
        finite = load * finite_growth.finite_flank_growth(gear, field, radius, bore)
        found = centrifugal_flank_growth(gear, radius, OMEGA, bore)
        compared("centrifugal growth of a flank", "finite elements", found / finite - 1.0, 0.08)


def test_growth_goes_with_the_square_of_speed_and_size() -> None:
    small, large = Gear(40, 2e-3), Gear(40, 4e-3)
    one = centrifugal_displacement(small, small.pitch_radius, 100.0)
    assert centrifugal_displacement(small, small.pitch_radius, 300.0) == pytest.approx(9.0 * one)
    assert centrifugal_displacement(large, large.pitch_radius, 100.0) == pytest.approx(8.0 * one)
    # as told of 40 teeth, module 4 mm, 25 000 rpm as a solid disc: 23 um, teeth and all
    disc = centrifugal_displacement(large, large.pitch_radius, OMEGA, "shaft")
    assert float(disc) == pytest.approx(0.25 * (1.0 - NU) * UNIT, rel=0.08)
