"""Teeth that run to a point: the beam's integral, its stored series, and the loaded mesh."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from conftest import Compared
from thermogear.base.errors import GeometryError, InputError
from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.loaded import LoadedModel, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.stiffness import CONTACT_LAWS
from thermogear.gears.tooth import (
    SHEAR_FACTOR,
    flank_point,
    start_angle,
    tooth_compliances,
    unit_compliance,
)

LANDS = [0.2, 0.02, 1e-3, 1e-4]
"""Tip thicknesses in modules."""


def with_land(gear: Gear, land: float) -> Gear:
    """The gear turned to the tip radius at which its tip is ``land`` modules thick."""

    def excess(radius: float) -> float:
        return 2.0 * radius * float(gear.half_thickness_angle(radius)) / gear.module - land

    radius = brentq(excess, gear.pitch_radius, gear.pointed_radius, xtol=1e-16, rtol=1e-14)
    return replace(gear, tip_radius=radius)


def tip(gear: Gear) -> float:
    """t at the tip circle."""
    return float(np.tan(gear.pressure_angle_at(gear.tip_radius)))


def random_gears(count: int, seed: int) -> list[Gear]:
    """Gears of every kind, undercut ones among them, with lands of 1e-4 to 0.5 modules."""
    rng = np.random.default_rng(seed)
    found: list[Gear] = []
    while len(found) < count:
        land = 10.0 ** rng.uniform(-4.0, math.log10(0.5))
        try:
            gear = Gear(
                int(rng.integers(7, 120)),
                1e-3 * rng.uniform(0.5, 10.0),
                pressure_angle=math.radians(rng.uniform(14.5, 28.0)),
                profile_shift=rng.uniform(-0.4, 1.1),
                rack=Rack(
                    addendum=1.0,
                    dedendum=rng.uniform(1.0, 1.4),
                    fillet_radius=rng.uniform(0.1, 0.35),
                ),
                allow_undercut=True,
            )
            found.append(with_land(gear, land))
        except (GeometryError, ValueError):
            continue
    return found


@pytest.mark.parametrize("land", LANDS)
@pytest.mark.parametrize("teeth", [10, 30], ids=["undercut", "plain"])
def test_beam_to_the_tip_against_adaptive_quadrature(
    teeth: int, land: float, compared: Compared
) -> None:
    gear = with_land(Gear(teeth, 4e-3, allow_undercut=True), land)
    t, low, radius = tip(gear), gear.junction[1], gear.base_radius
    at = flank_point(gear, t)
    beta = float(at.beta)
    assert float(at.x) == pytest.approx(0.5 * land * gear.module, rel=1e-2)

    def sections(x: float, y: float, dy: float) -> float:
        moment = math.cos(beta) * (float(at.y) - y) - float(at.x) * math.sin(beta)
        shear = 0.5 * SHEAR_FACTOR * 2.6 * math.cos(beta) ** 2 / x
        return (1.5 * moment**2 / x**3 + shear + 0.5 * math.sin(beta) ** 2 / x) * dy

    def flank(u: float) -> float:
        psi = gear.base_half_angle - (u - math.atan(u))
        r = radius * math.hypot(1.0, u)
        rate = radius * u * math.cos(u - gear.base_half_angle)
        return sections(r * math.sin(psi), r * math.cos(psi), rate)

    def fillet(gamma: float) -> float:
        x, y = gear.fillet.point(gamma)
        return sections(float(x), float(y), float(gear.fillet.height_rate(gamma)))

    begin = start_angle(gear, "30-degree")
    total = quad(flank, low, t, epsrel=1e-10, limit=400)[0]
    total += quad(fillet, begin, gear.junction[0], epsrel=1e-10)[0] if begin else 0.0
    got = tooth_compliances(gear, t, modulus=1.0, face_width=1.0)
    compared(
        "beam of a tooth loaded on its thin tip",
        "adaptive quadrature",
        float(got.total) / total - 1.0,
        1e-7,
    )


def test_series_is_the_integral_on_every_flank(compared: Compared) -> None:
    worst = 0.0
    for gear in random_gears(150, seed=3):
        t = np.linspace(gear.junction[1], tip(gear), 61)
        exact = tooth_compliances(gear, t, modulus=1.0, face_width=1.0).total
        worst = max(worst, float(np.abs(unit_compliance(gear, t) / exact - 1.0).max()))
    compared("stored series of the tooth's compliance", "its integrals", worst, 1e-9)


def test_towards_its_point_a_tooth_is_a_wedge() -> None:
    """A force near a wedge's point: each e-fold of nearness adds the same compliance.

    x = u tan(k) at the distance u from the point, k = beta the angle of the flank there:
    df/d ln u = -[1.5 cos^2/tan^3 + 0.6 * 2 (1 + nu) cos^2/tan + 0.5 sin^2/tan].
    """
    gear = with_land(Gear(20, 4e-3, profile_shift=0.3), 1e-6)
    beta = gear.pointed_tangent - gear.base_half_angle
    slope, cosine = math.tan(beta), math.cos(beta)
    wedge = 1.5 * cosine**2 / slope**3
    wedge += (0.5 * SHEAR_FACTOR * 2.6 * cosine**2 + 0.5 * math.sin(beta) ** 2) / slope
    t = gear.pointed_tangent - np.array([1e-5, 1e-6, 1e-7])
    found = np.diff(tooth_compliances(gear, t, modulus=1.0, face_width=1.0).total)
    assert found == pytest.approx(wedge * math.log(10.0), rel=3e-4)


def test_a_tip_as_sharp_as_numbers_allow_is_finite() -> None:
    plain = Gear(20, 4e-3, profile_shift=0.3)
    sharp = replace(plain, tip_radius=plain.pointed_radius * (1.0 - 1e-14))
    got = unit_compliance(sharp, [tip(sharp), 1.0, 2.0])
    assert np.all(np.isfinite(got) & (got > 0.0))
    assert np.all(got == got[0])


def test_beyond_the_point_there_is_no_flank() -> None:
    gear = Gear(20, 4e-3, profile_shift=0.3)
    with pytest.raises(InputError) as caught:
        tooth_compliances(gear, [0.4, 1.2])
    assert str(caught.value) == (
        f"t: got 1.2; allowed <= {gear.pointed_tangent:g}; the tooth ends in a point there"
    )
    assert math.hypot(1.0, gear.pointed_tangent) * gear.base_radius == gear.pointed_radius
    assert float(flank_point(gear, gear.pointed_tangent).x) == 0.0


@pytest.mark.parametrize("law", CONTACT_LAWS)
@pytest.mark.parametrize("land", [0.02, 5e-3, 1e-4])
def test_loaded_mesh_of_pointed_teeth(land: float, law: str) -> None:
    """Shares add up, the mesh is a spring that pushes, and swapping the gears changes nothing."""
    pair = GearPair(
        with_land(Gear(12, 3e-3, profile_shift=0.7), land), Gear(40, 3e-3, profile_shift=0.1)
    )
    phase, model = np.linspace(0.003, 0.993, 45), LoadedModel(contact=law)
    loads = np.array([[20e3], [200e3], [2e6]]) * pair.face_width
    mesh = solve_mesh(pair, loads, phase, model=model)
    assert np.all(mesh.settled)
    assert np.all(mesh.force >= 0.0)
    assert np.allclose(mesh.force.sum(axis=-1), loads[..., None], rtol=1e-10)
    assert np.all(mesh.tangent > 0.0)
    assert np.all(mesh.secant > 0.0)
    back = solve_mesh(pair.swapped(), loads, pair.contact_ratio - phase, model=model)
    # on an edge the torque of the pinion is given, of the wheel after the exchange
    flanks = ~(mesh.edge > 0).any(axis=-1) & ~(back.edge > 0).any(axis=-1)
    assert np.allclose(back.tangent[flanks], mesh.tangent[flanks], rtol=1e-8)
