"""Shared fixtures: the rig of the thesis, where more than one floor needs it."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear import Gear, GearPair, Operating, Temperatures
from thermogear.base.materials import ZERO_CELSIUS, lubricant


@pytest.fixture(scope="session")
def rig() -> GearPair:
    """Module 5 mm, 25:75, face width 25 mm, bore radii 25/80 mm."""
    return GearPair(
        Gear(25, 5e-3, face_width=25e-3, bore_radius=25e-3),
        Gear(75, 5e-3, face_width=25e-3, bore_radius=80e-3),
    )


def celsius(value: float) -> float:
    """Kelvin."""
    return value + ZERO_CELSIUS


@pytest.fixture(scope="session")
def hot_rig() -> Operating:
    """1000, 2000, 3000 rpm at 100 N m; addenda 140 C, bores 120 C, housing 100 C, T0 20 C."""
    return Operating(
        speed=np.array([1000.0, 2000.0, 3000.0]) * np.pi / 30.0,
        torque=np.array(100.0),
        lubricant=lubricant("M100"),
        oil_temperature=celsius(100.0),
        temperatures=Temperatures(
            celsius(20), celsius(140), celsius(120), celsius(140), celsius(120), celsius(100)
        ),
        half_backlash=125e-6,
    )
