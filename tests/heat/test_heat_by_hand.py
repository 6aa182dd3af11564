"""Printed formulas worked out in their sources' own units, to the last digits, and edges."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.materials import lubricant
from thermogear.gears.geometry import Gear
from thermogear.heat.contact_state import ContactState
from thermogear.heat.friction import XuKahraman
from thermogear.heat.gearbox import Losses, thermal_network
from thermogear.heat.laws import iso_13989_1, iso_13989_2, schlenk
from thermogear.heat.measured_temperature import (
    ThermocoupleReading,
    infrared_indication,
    infrared_signal,
)
from thermogear.heat.scuffing import flash_at_tip_13989_2

MEAN = {  # 400 N/mm, 4 m/s, 8 mm, 20 mPa s, 0.4 um
    "line_load": 400e3,
    "sum_speed": 4.0,
    "reduced_radius": 8e-3,
    "viscosity": 20e-3,
    "roughness": 0.4e-6,
}


def test_mean_friction_laws_in_the_units_of_their_sources() -> None:
    """N/mm, m/s, mm, mPa s, um: a unit that is off by a millionth shows."""
    common = (400.0 / (4.0 * 8.0)) ** 0.2 * 20.0**-0.05
    assert schlenk(**MEAN, factor=1.0) == pytest.approx(0.048 * common * 0.4**0.25, rel=1e-12)
    one = iso_13989_1(**MEAN, factor=1.0)
    assert one == pytest.approx(0.060 * common * 0.4**0.25, rel=1e-12)
    two = 0.045 * common * 2.2 * (0.4 / 8.0) ** 0.25
    assert iso_13989_2(**MEAN) == pytest.approx(two, rel=1e-12)


def test_flash_at_the_tip_in_the_units_of_its_source() -> None:
    """mu X_M X_BE X_alpha w^0.75 sqrt(v)/a^0.25 with 256 N/mm, 9 m/s, 81 mm."""
    rise = flash_at_tip_13989_2(
        0.1,
        256e3,
        9.0,
        81e-3,
        geometry=0.2,
        angle=0.978,
        rotation=0.8,
        tip_relief=1.25,
        thermo_elastic=50.0,
    )
    by_hand = 0.1 * 50.0 * 0.2 * 0.978 * 64.0 * 3.0 / 3.0 / (0.8 * 1.25)
    assert rise == pytest.approx(by_hand, rel=1e-12)


def test_the_floor_of_the_pitch_point_is_invisible_from_one_fifth_of_sliding_on() -> None:
    def law(floor: float | None) -> np.ndarray:
        state = ContactState(
            line_load=2e5,
            speed_1=np.array([1.0, 2.0, 4.0]),
            speed_2=2.5,
            reduced_radius=0.016,
            pressure=0.9e9,
            viscosity=0.02,
            roughness=0.4e-6,
        )
        return (XuKahraman() if floor is None else XuKahraman(pitch_floor=floor))(state)

    assert law(None) == pytest.approx(law(1e-4), rel=1e-12)


def test_half_the_ring_between_root_and_tip_is_tooth() -> None:
    """Capacities of steel, rho c V; teeth fill half of their ring, the shaft sticks out twice."""
    pinion = Gear(teeth=25, module=5e-3, bore_radius=0.025, face_width=0.025)
    wheel = Gear(teeth=75, module=5e-3, bore_radius=0.080, face_width=0.025)
    network = thermal_network(pinion, wheel, 100.0, Losses(mesh=10.0), lubricant("M100"), 350.0)
    for name, gear in (("pinion", pinion), ("wheel", wheel)):
        steel = gear.material.density * gear.material.specific_heat
        teeth = 0.5 * math.pi * 0.025 * (gear.tip_radius**2 - gear.root_radius**2)
        body = math.pi * 0.025 * (gear.root_radius**2 - gear.bore_radius**2)
        assert network.capacities[f"{name}_tooth"] == pytest.approx(steel * teeth, rel=1e-12)
        assert network.capacities[f"{name}_body"] == pytest.approx(steel * body, rel=1e-12)


@pytest.mark.parametrize("true", [150.4, 2999.0])
def test_the_infrared_inversion_reaches_its_ends(true: float) -> None:
    """Surroundings as hot as the surface: the signal is the black one, at any emissivity."""
    assert infrared_indication(
        true, emissivity=0.5, transmission=0.8, surroundings=true, path=true
    ) == pytest.approx(true, abs=1e-6)
    assert float(
        infrared_signal(true, emissivity=0.5, transmission=0.8, surroundings=true, path=true)
    ) == pytest.approx(
        float(
            infrared_signal(true, emissivity=1.0, transmission=1.0, surroundings=300.0, path=300.0)
        ),
        rel=1e-12,
    )
    assert infrared_indication(
        true, emissivity=1.0, transmission=1.0, surroundings=300.0, path=300.0
    ) == pytest.approx(true, abs=1e-6)


@pytest.mark.parametrize("indicated", [0.0, -0.5])
def test_a_thermocouple_below_absolute_zero_is_refused(indicated: float) -> None:
    with pytest.raises(InputError, match=r"^thermocouple\.indicated: got -?0(\.5)? K"):
        ThermocoupleReading(indicated=indicated, flux=0.0, depth=1e-3, conductivity=46.0)
