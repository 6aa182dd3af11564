"""Unit check of every public formula of this floor.

A formula whose constants are pure numbers must say the same in every coherent system of units:
its arguments are converted by pint into a system with odd units of length, mass, time and
temperature, and its result must be the converted result. Formulas with dimensional constants
(empirical ones) fail that by nature; each is listed with the units its source declares and
checked against them in its own test.
"""

import importlib
import inspect
import math
import pkgutil

import numpy as np
import pint
import pytest

import thermogear.heat
from thermogear.base.materials import Material
from thermogear.gears.geometry import Gear
from thermogear.heat import expansion, temperature, thesis_profile
from thermogear.heat.expansion import RadialField

UNITS = pint.UnitRegistry()
ODD = {"[length]": 0.37, "[mass]": 2.3, "[time]": 1.7, "[temperature]": 0.61}


def factor(unit: str) -> float:
    """Number of odd coherent units in one SI ``unit``."""
    whole = UNITS.Quantity(1.0, unit).to_base_units()
    value = float(whole.magnitude)
    for dimension, power in whole.dimensionality.items():
        value /= ODD.get(str(dimension), 1.0) ** float(power)
    return value


FLASH = {
    "friction": (0.06, ""),
    "line_load": (2e5, "N/m"),
    "speed_1": (3.0, "m/s"),
    "speed_2": (2.0, "m/s"),
    "half_width": (190e-6, "m"),
    "contact_coefficient_1": (13e3, "J/m**2/K/s**0.5"),
    "contact_coefficient_2": (12e3, "J/m**2/K/s**0.5"),
}
ANNULUS = {
    "bore_radius": (0.025, "m"),
    "tip_radius": (0.0675, "m"),
    "bore_temperature": (350.0, "K"),
    "addendum_temperature": (370.0, "K"),
}

# function -> (arguments with SI value and unit, unit of the result)
PLAIN = {
    temperature.frictional_heat: (
        {k: FLASH[k] for k in ("friction", "line_load", "speed_1", "speed_2")},
        "W/m",
    ),
    temperature.heat_partition: (
        {
            k: FLASH[k]
            for k in ("speed_1", "speed_2", "contact_coefficient_1", "contact_coefficient_2")
        },
        "",
    ),
    temperature.flank_flash: (
        {
            "heat": (7e3, "W/m"),
            "speed": (2.0, "m/s"),
            "half_width": (190e-6, "m"),
            "contact_coefficient": (13e3, "J/m**2/K/s**0.5"),
        },
        "K",
    ),
    temperature.blok_flash: (FLASH, "K"),
    temperature.contact_temperature: (
        {
            "flash": (20.0, "K"),
            "partition_1": (0.4, ""),
            "bulk_1": (370.0, "K"),
            "bulk_2": (350.0, "K"),
        },
        "K",
    ),
    temperature.radial_temperature: ({"radius": (0.05, "m"), **ANNULUS}, "K"),
    temperature.conduction_power: (
        {**ANNULUS, "conductivity": (46.0, "W/m/K"), "face_width": (0.025, "m")},
        "W",
    ),
    expansion.centre_distance_growth: (
        {
            "centre_distance": (0.25, "m"),
            "expansion": (11.5e-6, "1/K"),
            "temperature": (350.0, "K"),
            "reference": (293.0, "K"),
        },
        "m",
    ),
    expansion.hot_half_backlash: (
        {
            "half_backlash": (1e-4, "m"),
            "growth_1": (1e-5, "m"),
            "growth_2": (2e-5, "m"),
            "axis_opening": (5e-6, "m"),
        },
        "m",
    ),
    thesis_profile.thesis_half_backlash: (
        {
            "half_backlash": (1e-4, "m"),
            "deformation_1": (1e-5, "m"),
            "deformation_2": (2e-5, "m"),
        },
        "m",
    ),
}

# constants with units: the source's units are checked where the formula is tested
DECLARED = {
    "kinematic_viscosity": "mm^2/s, K",
    "density": "kg/m^3, K",
    "dynamic_viscosity": "mm^2/s, kg/m^3, K",
    "walther_slope": "mm^2/s, K",
    "benedict_kelley": "N/mm, mPa s, m/s, um",
}
IMPOSSIBLE = {"blok_as_printed", "benedict_kelley_as_printed", "flank_growth_as_printed"}
NOT_FORMULAS = {"flash_factor", "friction_law", "constant_dry", "jam_temperature"}


@pytest.mark.parametrize("function", PLAIN, ids=lambda f: f.__name__)
def test_formula_is_the_same_in_any_coherent_units(function) -> None:  # type: ignore[no-untyped-def]
    arguments, unit = PLAIN[function]
    plain = function(**{name: value for name, (value, _) in arguments.items()})
    odd = function(**{name: value * factor(u) for name, (value, u) in arguments.items()})
    assert odd == pytest.approx(plain * factor(unit), rel=1e-12)


def test_printed_flash_carries_kelvin_metres() -> None:
    given = {name: value for name, (value, _) in FLASH.items()}
    odd = {name: value * factor(u) for name, (value, u) in FLASH.items()}
    ratio = float(temperature.blok_as_printed(**odd) / temperature.blok_as_printed(**given))
    assert ratio == pytest.approx(factor("K*m"), rel=1e-12)
    assert ratio != pytest.approx(factor("K"), rel=1e-3)


def rig(odd: bool) -> tuple[Gear, RadialField, np.ndarray]:
    """Pinion, field and radii in SI or in the odd units."""
    long, hot = (factor("m"), factor("K")) if odd else (1.0, 1.0)
    steel = Material("steel", 206e9, 0.3, 7850.0, 46.0, 470.0, 11.5e-6 / hot)
    gear = Gear(teeth=25, module=5e-3 * long, bore_radius=0.025 * long, material=steel)
    field = RadialField(gear.bore_radius, gear.tip_radius, 353.0 * hot, 373.0 * hot, 293.0 * hot)
    return gear, field, np.array([0.0595, 0.064]) * long


GROWTHS = {
    "flank_growth": lambda g, f, r: expansion.flank_growth(g, f, r),
    "flank_normal_growth": lambda g, f, r: expansion.flank_growth(g, f, r, "rigid", "strain"),
    "base_circle_growth": lambda g, f, r: expansion.base_circle_growth(g, f, "shaft"),
    "radial_displacement": lambda g, f, r: expansion.radial_displacement(
        f, r, g.root_radius, g.material.thermal_expansion, 0.3
    ),
    "annulus_displacement": lambda g, f, r: expansion.annulus_displacement(
        f, 0.8 * g.root_radius, g.root_radius, g.material.thermal_expansion, 0.3, "rigid"
    ),
    "thesis_flank_growth": lambda g, f, r: thesis_profile.thesis_flank_growth(g, f, r),
    "deformed_profile": lambda g, f, r: thesis_profile.deformed_profile(g, f, r)[0],
    "profile_as_printed": lambda g, f, r: thesis_profile.profile_as_printed(g, f, r)[0],
}


@pytest.mark.parametrize("name", GROWTHS)
def test_growth_is_a_length_in_any_coherent_units(name: str) -> None:
    assert GROWTHS[name](*rig(True)) == pytest.approx(
        GROWTHS[name](*rig(False)) * factor("m"), rel=1e-11
    )


def test_printed_deformation_is_no_length() -> None:
    ratio = thesis_profile.flank_growth_as_printed(
        *rig(True)
    ) / thesis_profile.flank_growth_as_printed(*rig(False))
    assert np.min(np.abs(ratio / factor("m") - 1.0)) > 0.05


def test_no_public_formula_is_left_out() -> None:
    covered = {f.__name__ for f in PLAIN} | set(DECLARED) | IMPOSSIBLE | NOT_FORMULAS
    covered |= set(GROWTHS)
    public = set()
    for entry in pkgutil.iter_modules(thermogear.heat.__path__):
        module = importlib.import_module(f"thermogear.heat.{entry.name}")
        for name in getattr(module, "__all__", ()):
            if inspect.isfunction(getattr(module, name)):
                public.add(name)
    assert public - covered == set()
    assert math.isclose(factor("m"), 1.0 / 0.37)
