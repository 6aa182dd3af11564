"""The body temperatures of the ISO reports, reckoned a second time by hand, and as published."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from thermogear import Gear, GearPair, Operating, Temperatures
from thermogear.base.materials import MATERIALS, ZERO_CELSIUS, lubricant
from thermogear.base.units import RPM
from thermogear.heat.lubrication import dynamic_viscosity
from thermogear.mesh.body_estimates import body_estimates

OIL = ZERO_CELSIUS + 60.0


def operating(rpm: float, torque: float) -> Operating:
    """FVA 3 at 60 C, a mineral oil of VG 100."""
    return Operating(
        speed=np.array([rpm * RPM]),
        torque=np.array([torque]),
        lubricant=lubricant("FVA3"),
        oil_temperature=OIL,
        temperatures=Temperatures.uniform(OIL, reference=ZERO_CELSIUS + 20.0),
        half_backlash=1e-4,
    )


def part_2_by_hand(pair: GearPair, rpm: float, torque: float) -> float:
    """Rise of the body over the oil [K], eq. 1-44 in the report's units: mm, N/mm, m/s, mPa s."""
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
    return 0.7 * tip * x_epsilon


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
        found = body_estimates(pair, operating(rpm, torque), np.array([20.0]))[1, 0] - OIL
        assert found == pytest.approx(part_2_by_hand(pair, rpm, torque), rel=1e-9)


def test_all_three_are_those_published_of_fzg_c() -> None:
    """78.6, 78.1 and 77.7 C with a mean flash of 39.6 K: 200 N m, 1500 1/min, Ra 0.355 um.

    The steel is the report's: 50 W/(m K) and 3.8 N/(mm^2 K).
    """
    steel = replace(
        MATERIALS["steel"], thermal_conductivity=50.0, specific_heat=3.8e6 / 7850.0, density=7850.0
    )
    pinion, wheel = (
        Gear(z, 4.5e-3, profile_shift=x, face_width=14e-3, roughness=0.355e-6, material=steel)
        for z, x in ((16, 0.1817), (24, 0.1715))
    )
    pair = GearPair(pinion, wheel, centre_distance=91.5003e-3)
    found = body_estimates(pair, operating(1500.0, 200.0), np.array([39.6]))[:, 0] - ZERO_CELSIUS
    assert found == pytest.approx([78.6, 78.1, 77.7], abs=0.5)
