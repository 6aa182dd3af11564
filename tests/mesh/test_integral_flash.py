"""The mean flash temperature of ISO/TR 13989-2, reckoned a second time by hand."""

from __future__ import annotations

import math

import pytest

from thermogear import Gear, GearPair
from thermogear.base.materials import MATERIALS, ZERO_CELSIUS, lubricant
from thermogear.base.units import RPM
from thermogear.heat.lubrication import dynamic_viscosity
from thermogear.mesh.scuffing_rating import integral_flash

OIL = ZERO_CELSIUS + 60.0


def part_2_by_hand(pair: GearPair, rpm: float, torque: float) -> tuple[float, float]:
    """Friction and the mean flash [K], eq. 1-44 in the report's units: mm, N/mm, m/s, mPa s."""
    z1, z2, m = pair.pinion.teeth, pair.wheel.teeth, 1e3 * pair.pinion.module
    alpha, a, u = pair.pinion.pressure_angle, 1e3 * pair.centre_distance, z2 / z1
    rb1, rb2 = (0.5 * m * z * math.cos(alpha) for z in (z1, z2))
    working = math.acos((rb1 + rb2) / a)
    tips = [
        math.acos(rb / (1e3 * gear.tip_radius))
        for rb, gear in zip((rb1, rb2), (pair.pinion, pair.wheel), strict=True)
    ]
    # tip contact ratios: 1 of the pinion (recess, C to E), 2 of the wheel (approach, A to C)
    e1, e2 = (
        z / (2.0 * math.pi) * (math.tan(t) - math.tan(working))
        for z, t in zip((z1, z2), tips, strict=True)
    )
    if e1 >= 1.0:
        mean = 0.18 * e1**2 + 0.70 * e2**2 + 0.82 * e1 - 0.52 * e2 - 0.30 * e1 * e2
    elif e2 >= 1.0:
        mean = 0.70 * e1**2 + 0.18 * e2**2 - 0.52 * e1 + 0.82 * e2 - 0.30 * e1 * e2
    else:
        mean = 0.70 * (e1**2 + e2**2) - 0.22 * (e1 + e2) + 0.52 - 0.60 * e1 * e2
    x_epsilon = mean / (2.0 * (e1 + e2) * e1)
    x_q = min(1.0, max(0.6, 1.40 - 4.0 / 15.0 * e2 / e1)) if e2 / e1 > 1.5 else 1.0
    v = rpm * RPM * 0.5 * m * z1 * 1e-3
    w = torque / (0.5 * m * z1 * 1e-3) / (1e3 * pair.face_width)
    rho1 = rb1 * math.tan(tips[0])
    rho2 = a * math.sin(working) - rho1
    rho_c = rb1 * rb2 * math.tan(working) / (rb1 + rb2)
    x_be = 0.51 * math.sqrt(u + 1) * (math.sqrt(rho1) - math.sqrt(rho2 / u)) / (rho1 * rho2) ** 0.25
    x_alpha = 1.22 * (math.sin(working) * math.cos(alpha)) ** 0.25
    x_alpha /= math.sqrt(math.cos(working) * math.cos(alpha))
    steel = MATERIALS["steel"]
    x_m = 1e3 * (steel.youngs_modulus * 1e-6 / (1.0 - steel.poisson_ratio**2)) ** 0.25
    x_m /= steel.thermal_contact_coefficient / math.sqrt(1e3)
    eta = 1e3 * float(dynamic_viscosity(lubricant("FVA3"), OIL))
    v_sum = 2.0 * v * math.tan(working) * math.cos(alpha)
    x_r = 2.2 * (0.4 / rho_c) ** 0.25
    mu = 0.045 * (max(w, 150.0) / (v_sum * rho_c)) ** 0.2 * eta**-0.05 * x_r
    tip = mu * x_m * x_be * x_alpha * w**0.75 * math.sqrt(v) / a**0.25 / x_q
    return mu, tip * x_epsilon


def gears(teeth: tuple[int, int], shifts: tuple[float, float] = (0.0, 0.0)) -> GearPair:
    """Module 3 mm, face width 20 mm."""
    one, two = (
        Gear(z, 3e-3, profile_shift=x, face_width=20e-3) for z, x in zip(teeth, shifts, strict=True)
    )
    return GearPair(one, two)


PAIRS = {
    "25:75": ((25, 75), (0.0, 0.0)),
    "35:40": ((35, 40), (0.0, 0.57)),
    "37:20": ((37, 20), (0.52, 0.50)),
    "29:69": ((29, 69), (0.70, 0.49)),
    "pinion's tip beyond 1": ((60, 25), (0.9, 0.0)),
    "wheel's tip beyond 1": ((25, 60), (0.0, 0.9)),
}


@pytest.mark.parametrize("name", PAIRS)
def test_part_2_is_the_sum_by_hand(name: str) -> None:
    pair = gears(*PAIRS[name])
    for rpm, torque in ((1000.0, 100.0), (3000.0, 40.0)):
        mu, by_hand = part_2_by_hand(pair, rpm, torque)
        load = torque / pair.pinion.pitch_radius / pair.face_width
        found = integral_flash(pair, mu, load, rpm * RPM * pair.pinion.pitch_radius)
        assert found == pytest.approx(by_hand, rel=1e-9)
