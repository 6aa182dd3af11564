"""Beam integrals against cantilevers in closed form, an independent quadrature and numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from conftest import Compared
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.gears.geometry import Gear, Rack, Trochoid
from thermogear.gears.tooth import FlankPoint, _moments, flank_point, start_angle, tooth_compliances

NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def cantilever(root: float, tip: float, length: float) -> tuple[float, float, float]:
    """The three integrals of a straight-sided cantilever under an end force, by _moments."""
    y = 0.5 * length * (1.0 + NODES)
    x = root + (tip - root) * y / length
    one = np.zeros(1)
    force = FlankPoint(one, np.full(1, length), one)
    bending, shear, axial = _moments(x, y, 0.5 * length * WEIGHTS, force)
    return float(bending), float(shear), float(axial)


def test_rectangular_cantilever() -> None:
    half, length = 2e-3, 11e-3
    bending, shear, axial = cantilever(half, half, length)
    inertia = (2 * half) ** 3 / 12
    assert bending == pytest.approx(length**3 / (3 * inertia), rel=1e-12)
    assert shear == pytest.approx(length / (2 * half), rel=1e-12)
    assert axial == pytest.approx(0.0, abs=1e-12)


def test_tapered_cantilever(compared: Compared) -> None:
    """Linear taper h(y) = h0 + c y: int (l - y)^2 12/h^3 dy in closed form."""
    root, tip, length = 3e-3, 1.2e-3, 9e-3
    h0, h1 = 2 * root, 2 * tip
    c = (h1 - h0) / length
    # with u = h(y): l - y = (h1 - u)/c
    exact = (
        12
        / c**3
        * (math.log(h1 / h0) + 2 * h1 * (1 / h1 - 1 / h0) - 0.5 * h1**2 * (1 / h1**2 - 1 / h0**2))
    )
    bending, shear, _ = cantilever(root, tip, length)
    compared("bending of a tapered cantilever", "closed form", bending / exact - 1.0, 1e-8)
    assert shear == pytest.approx(math.log(h1 / h0) / c, rel=1e-8)


def test_inclined_force_adds_its_axial_part_and_its_moment() -> None:
    half, length, beta = 2e-3, 8e-3, 0.4
    y = 0.5 * length * (1.0 + NODES)
    force = FlankPoint(np.array([half]), np.array([length]), np.array([beta]))
    bending, shear, axial = _moments(np.full_like(y, half), y, 0.5 * length * WEIGHTS, force)
    arm = half * math.tan(beta)  # the force meets the axis this far below its point
    low = (length - arm) ** 3 + arm**3
    assert float(bending) == pytest.approx(
        math.cos(beta) ** 2 * low / 3 * 12 / (2 * half) ** 3, rel=1e-12
    )
    assert float(shear) == pytest.approx(math.cos(beta) ** 2 * length / (2 * half), rel=1e-12)
    assert float(axial) == pytest.approx(math.sin(beta) ** 2 * length / (2 * half), rel=1e-12)


@pytest.mark.parametrize("start", ["root-circle", "30-degree"])
@pytest.mark.parametrize(
    "gear",
    [
        Gear(25, 5e-3),
        Gear(17, 3e-3, profile_shift=0.35),
        Gear(90, 2e-3, profile_shift=-0.3),
        Gear(10, 4e-3, allow_undercut=True),
        Gear(
            40,
            4e-3,
            pressure_angle=math.radians(25),
            rack=Rack(addendum=0.9, dedendum=1.1, fillet_radius=0.2),
        ),
    ],
    ids=["rig", "shifted", "large", "undercut", "25 deg"],
)
def test_against_adaptive_quadrature(gear: Gear, start: str, compared: Compared) -> None:
    t = float(np.tan(gear.pressure_angle_at(0.3 * gear.form_radius + 0.7 * gear.tip_radius)))
    p = flank_point(gear, t)
    xp, yp, beta = float(p.x), float(p.y), float(p.beta)
    low = gear.junction[1]

    def flank(u: float) -> tuple[float, float]:
        q = flank_point(gear, u)
        return float(q.x), float(q.y)

    def fillet(g: float) -> tuple[float, float]:
        x, y = gear.fillet.point(g)
        return float(x), float(y)

    def slope(curve: object, u: float) -> float:
        h = 1e-5
        f = lambda v: curve(v)[1]  # type: ignore[operator] # noqa: E731
        return (8 * (f(u + h) - f(u - h)) - (f(u + 2 * h) - f(u - 2 * h))) / (12 * h)

    def bend(curve: object, u: float) -> float:
        x, y = curve(u)  # type: ignore[operator]
        return 1.5 * (math.cos(beta) * (yp - y) - math.sin(beta) * xp) ** 2 / x**3 * slope(curve, u)

    total = quad(lambda u: bend(flank, u), low, t, epsrel=1e-9)[0]
    total += quad(
        lambda g: bend(fillet, g), start_angle(gear, start), gear.junction[0], epsrel=1e-9
    )[0]
    got = tooth_compliances(gear, t, start, modulus=1.0, face_width=1.0)
    compared(
        "bending of the true tooth profile",
        "adaptive quadrature",
        float(got.bending) / total - 1.0,
        1e-6,
    )


def test_flank_point_is_on_the_involute_and_its_normal_touches_the_base_circle() -> None:
    gear = Gear(25, 5e-3)
    r = np.linspace(gear.form_radius, gear.tip_radius, 11)
    p = flank_point(gear, np.tan(gear.pressure_angle_at(r)))
    assert np.allclose(np.hypot(p.x, p.y), r, rtol=1e-14)
    assert np.allclose(np.arctan2(p.x, p.y), gear.half_thickness_angle(r), rtol=0, atol=1e-14)
    # distance of the force's line from the gear centre
    assert np.allclose(p.y * np.cos(p.beta) - p.x * np.sin(p.beta), gear.base_radius, rtol=1e-14)


def test_start_section_slope_and_unknown_name() -> None:
    gear = Gear(25, 5e-3)
    gamma = start_angle(gear, "30-degree")
    h = 1e-6
    x, y = (
        np.subtract(*c)
        for c in zip(gear.fillet.point(gamma + h), gear.fillet.point(gamma - h), strict=True)
    )
    assert math.degrees(math.atan2(abs(float(x)), abs(float(y)))) == pytest.approx(30.0, abs=1e-4)
    with pytest.raises(InputError) as caught:
        tooth_compliances(gear, 0.4, start="root circle")
    assert str(caught.value) == (
        "start: got 'root circle'; allowed root-circle | 30-degree; did you mean 'root-circle'?"
    )


@pytest.mark.parametrize("shift", [-0.3, 0.0, 0.8, 0.9, 1.2])
def test_the_30_degree_section_has_that_tangent_at_every_profile_shift(shift: float) -> None:
    gear = Gear(80, 3e-3, profile_shift=shift)
    gamma, h = start_angle(gear, "30-degree"), 1e-6
    x, y = gear.fillet.point(np.array([gamma - h, gamma + h]))
    assert gear.junction[0] < gamma < 0.5 * math.pi
    assert abs((x[1] - x[0]) / (y[1] - y[0])) == pytest.approx(math.tan(math.pi / 6), rel=1e-7)


@pytest.mark.parametrize("depth", [2.0, 0.3, 0.0, -0.3])
def test_a_section_lies_where_the_tangent_has_the_slope_or_nowhere(depth: float) -> None:
    """gamma - phi(gamma) = slope on both sides of the rolling line; at it, slope + b1/r."""
    fillet = Trochoid(pitch_radius=20.0, centre_depth=depth, centre_offset=-3.0, radius=0.5)
    for slope in np.radians([40.0, 60.0, 80.0]):
        gamma = fillet.section_at_slope(slope)
        assert abs(gamma - float(fillet.roll(gamma)) - slope) < 4e-16
        if depth == 0.0:
            assert gamma == pytest.approx(slope - 3.0 / 20.0, rel=1e-15)
    high = Trochoid(pitch_radius=1.0, centre_depth=-0.5, centre_offset=-3.0, radius=0.5)
    with pytest.raises(ConvergenceError, match=r"^fillet: no section at 30 degrees$"):
        high.section_at_slope(math.pi / 6)


def test_compliance_scales_with_modulus_and_width() -> None:
    gear = Gear(25, 5e-3)
    t = np.linspace(0.25, 0.5, 5)
    one = tooth_compliances(gear, t)
    two = tooth_compliances(gear, t, modulus=0.5 * 206e9, face_width=0.5 * gear.face_width)
    for a, b in zip(one, two, strict=True):
        assert np.allclose(4.0 * a, b, rtol=1e-14)
