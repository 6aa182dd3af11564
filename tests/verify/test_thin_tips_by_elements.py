"""A tooth that runs to a point, loaded near its tip, by finite elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from conftest import Compared
from gear_compliance import gear_compliance
from thermogear.gears.geometry import Gear
from thermogear.gears.ring import ring_compliance
from thermogear.gears.stiffness import weber_approach
from thermogear.gears.tooth import flank_point, tooth_compliances
from thermogear.gears.tooth_mesh import Profile

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("half_width", [20e-6, 100e-6])
def test_beam_ring_and_contact_near_a_tip_without_land(
    half_width: float, compared: Compared
) -> None:
    """A land of 1e-3 modules; the load as near to the tip as its contact fits, and farther.

    The depth to the tooth's axis is 0.8 to 6 half widths of the contact.
    """
    plain = Gear(20, 4e-3, profile_shift=0.45, face_width=20e-3)
    radius = brentq(
        lambda r: 2.0 * r * float(plain.half_thickness_angle(r)) / plain.module - 1e-3,
        plain.pitch_radius,
        plain.pointed_radius,
    )
    gear = replace(plain, tip_radius=radius)
    profile, tip = Profile(gear), float(np.tan(gear.pressure_angle_at(gear.tip_radius)))
    young, width, nu = gear.material.youngs_modulus, gear.face_width, 0.3
    t = np.array(
        [
            brentq(
                lambda u, n=near: profile.arc(u) - profile.ends[1] + n * half_width,
                gear.junction[1] + 1e-6,
                tip,
            )
            for near in (1.05, 3.0, 8.0)
        ]
    )
    at = flank_point(gear, t)
    model = tooth_compliances(gear, t).total + ring_compliance(gear, t)
    model = model + weber_approach(
        1.0,
        depth=at.x / np.cos(at.beta),
        half_width=half_width,
        modulus=young,
        poisson=nu,
        face_width=width,
    )
    # from the mean over the contact to the approach, half of <x^2>/(2 rho*) for each gear
    finite = gear_compliance(gear, t, half_width) + (1.0 - nu**2) / (2.0 * np.pi * young * width)
    compared(
        "compliance of a pointed tooth loaded near its tip",
        "own finite elements",
        model / finite - 1.0,
        0.03,
    )
