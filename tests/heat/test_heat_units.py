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
from thermogear.heat import expansion, gearbox, moving_source, temperature, thesis_profile
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


# one value and unit for every argument name of the formulas on plain numbers
ARGUMENTS: dict[str, tuple[object, str]] = {
    "addendum_temperature": (370.0, "K"),
    "angle": (0.97, ""),
    "approach": (0.6, ""),
    "axis_opening": (5e-6, "m"),
    "bore_diameter": (0.03, "m"),
    "bore_radius": (0.025, "m"),
    "bore_temperature": (350.0, "K"),
    "bulk_1": (370.0, "K"),
    "bulk_2": (350.0, "K"),
    "centre_distance": (0.25, "m"),
    "coefficient": (1.8e-8, "1/Pa"),
    "conductivity": (46.0, "W/m/K"),
    "conductivity_ratio": (1.3, ""),
    "contact_angle": (0.3, ""),
    "contact_coefficient": (13e3, "J/m**2/K/s**0.5"),
    "contact_coefficient_1": (13e3, "J/m**2/K/s**0.5"),
    "contact_coefficient_2": (12e3, "J/m**2/K/s**0.5"),
    "curvature_1": (0.030, "m"),
    "curvature_2": (0.045, "m"),
    "deformation_1": (1e-5, "m"),
    "deformation_2": (2e-5, "m"),
    "density": (850.0, "kg/m**3"),
    "depth": (1e-3, "m"),
    "element_diameter": (8e-3, "m"),
    "emissivity": (0.9, ""),
    "entrainment": (2.5, "m/s"),
    "expansion": (11.5e-6, "1/K"),
    "face_width": (0.025, "m"),
    "film_parameter": (0.8, ""),
    "flash": (20.0, "K"),
    "flow": (1e-5, "m**3/s"),
    "flux": (7e4, "W/m**2"),
    "force": (2e3, "N"),
    "friction": (0.06, ""),
    "gear_position": (0.05, "m"),
    "growth_1": (1e-5, "m"),
    "growth_2": (2e-5, "m"),
    "half_backlash": (1e-4, "m"),
    "half_width": (190e-6, "m"),
    "heat": (7e3, "W/m"),
    "immersion": (0.7, ""),
    "indicated": (380.0, "K"),
    "integral_flash": (30.0, "K"),
    "jet_speed": (3.0, "m/s"),
    "limit": (450.0, "K"),
    "line_load": (2e5, "N/m"),
    "loss": (300.0, "W"),
    "loss_factor": (0.2, ""),
    "mean_flash": (30.0, "K"),
    "modulus": (226e9, "Pa"),
    "oil_temperature": (330.0, "K"),
    "partition_1": (0.4, ""),
    "path": (300.0, "K"),
    "peak_ratio": (8.0, ""),
    "peclet": (7.0, ""),
    "peclet_1": (20.0, ""),
    "peclet_2": (10.0, ""),
    "pitch_diameter": (0.04, "m"),
    "pitch_radius": (0.0625, "m"),
    "position": (0.3, ""),
    "positions": (np.array([0.0, 0.2]), "m"),
    "power": (2e4, "W"),
    "prandtl": (300.0, ""),
    "pressure": (2e8, "Pa"),
    "pressure_viscosity": (1.8e-8, "1/Pa"),
    "radius": (0.05, "m"),
    "ratio": (3.0, ""),
    "recess": (0.7, ""),
    "reduced_radius": (0.016, "m"),
    "reference": (293.0, "K"),
    "roughness": (0.4e-6, "m"),
    "roughness_1": (0.4e-6, "m"),
    "roughness_2": (0.5e-6, "m"),
    "slide_roll_ratio": (0.4, ""),
    "sliding_parameter": (0.8, ""),
    "speed": (120.0, "1/s"),
    "speed_1": (3.0, "m/s"),
    "speed_2": (2.0, "m/s"),
    "sum_speed": (5.0, "m/s"),
    "surface": (380.0, "K"),
    "surroundings": (300.0, "K"),
    "teeth_1": (25.0, ""),
    "temperature": (360.0, "K"),
    "thermal_factor": (0.9, ""),
    "thickness": (0.3e-6, "m"),
    "tip_radius": (0.0675, "m"),
    "transmission": (0.95, ""),
    "viscosity": (0.03, "Pa*s"),
    "walther_slope": (0.04, "1/K"),
}
# where one name means two things
OTHERWISE: dict[str, dict[str, tuple[object, str]]] = {
    "bearing_loss": {"coefficient": (0.0015, "")},
    "body_temperature_13989_1": {"lubrication": (1.2, ""), "meshes": (1.0, "")},
    "body_temperature_13989_2": {"lubrication": (1.2, ""), "meshes": (1.0, "")},
    "churning_loss": {"viscosity": (4e-5, "m**2/s")},
    "disc_torque": {"viscosity": (4e-5, "m**2/s")},
    "integral_temperature": {"body_temperature": (350.0, "K")},
    "load_sharing_13989": {
        "position": (0.012, "m"),
        "a": (0.008, "m"),
        "b": (0.018, "m"),
        "d": (0.023, "m"),
        "e": (0.033, "m"),
    },
    "rotating_face_convection": {"viscosity": (4e-5, "m**2/s")},
}
RESULTS: dict[str, str] = {
    "bearing_loss": "W",
    "blok_flash": "K",
    "body_temperature_13989_1": "K",
    "body_temperature_13989_2": "K",
    "buried_temperature": "K",
    "centre_distance_growth": "m",
    "churning_loss": "W",
    "conduction_power": "W",
    "contact_temperature": "K",
    "flank_exchange": "W/m/K",
    "disc_torque": "N*m",
    "dowson_higginson_minimum": "m",
    "efficiency": "",
    "fernandes": "",
    "film_parameter": "",
    "mean_roughness_film_parameter": "",
    "rms_roughness": "m",
    "film_thickness": "m",
    "frictional_heat": "W/m",
    "geometry_factor": "",
    "grubin_central": "m",
    "heat_partition": "",
    "hot_half_backlash": "m",
    "infrared_indication": "K",
    "inner_share": "",
    "integral_temperature": "K",
    "iso_15144_film": "m",
    "lever_shares": "",
    "load_sharing_13989": "",
    "mesh_loss": "W",
    "radial_temperature": "K",
    "rotating_face_convection": "W/m**2/K",
    "scuffing_margin": "K",
    "scuffing_safety": "",
    "surface_temperature": "K",
    "thermal_reduction": "",
    "thesis_half_backlash": "m",
}

# constants with units: the source's units are checked by hand where the formula is tested
DECLARED = {
    "kinematic_viscosity": "mm^2/s, K",
    "density": "kg/m^3, K",
    "dynamic_viscosity": "mm^2/s, kg/m^3, K",
    "walther_slope": "mm^2/s, K",
    "benedict_kelley": "N/mm, mPa s, m/s, um",
    "xu_kahraman": "GPa, m/s, mPa s, m, um",
    "schlenk": "N/mm, m/s, mm, mPa s, um",
    "iso_13989_1": "N/mm, m/s, mm, mPa s, um",
    "iso_13989_2": "N/mm, m/s, mm, mPa s, um",
    "pressure_viscosity": "mm^2/s, Pa s, K",
    "pressure_viscosity_gold": "mm^2/s",
    "pressure_viscosity_iso": "Pa s, K",
    "ring_conductance": "m, rad/s, W/(m^2 K)",
    "thermo_elastic_factor": "N/mm^2, N/(mm^0.5 m^0.5 s^0.5 K)",
    "flash_13989_1": "N/mm, 1/min, mm",
    "flash_at_tip_13989_2": "N/mm, m/s, mm",
    "body_temperature_15144": "kW, mm",
    "fzg_torque": "N m",
    "approach_factor": "um",
    "integral_safety": "C",
    "scuffing_temperature": "C",
    "scuffing_integral_temperature": "C, mm^2/s",
    "band_radiance": "up to a constant factor",
    "infrared_signal": "up to a constant factor",
    "face_conductance": "the oil's own line",
    "free_face_convection": "the earth's gravity, m/s^2",
    "still_air_coefficient": "the earth's gravity, m/s^2; properties of air",
    "oil_expansion": "the oil's own line",
    "oil_prandtl": "the oil's own line",
    "fluid_from": "the oil's own line",
    "with_free_convection": "the oil's own line",
    "thermal_network": "the oil's own line; its parts are checked one by one",
}
# pure numbers in, a pure number out
NUMBERS = {
    "angle_factor",
    "constant_dry",
    "contact_ratio_factor",
    "disc_nusselt",
    "doleschel_share",
    "gear_loss_factor",
    "lubricant_factor",
    "moving_source_rise",
    "peclet_factor",
    "regime",
    "regime_shares",
    "rotating_disc_flow",
    "rotation_factor",
    "turbulent_nusselt",
    "turbulent_share",
}
IMPOSSIBLE = {"blok_as_printed", "benedict_kelley_as_printed", "flank_growth_as_printed"}
NOT_FORMULAS = {
    "grade",
    "friction_words",
    "law_words",
    "parameters",
    "ranges",
    "require_known",
    "with_parameters",
    "beyond",
    "flash_factor",
    "follow",
    "friction_law",
    "joined",
    "laws_together",
    "outside_range",
    "structure_factor",
    "transition_pieces",
}


def public() -> dict[str, object]:
    """Every public function of the floor by its name."""
    found = {}
    for entry in pkgutil.iter_modules(thermogear.heat.__path__):
        module = importlib.import_module(f"thermogear.heat.{entry.name}")
        for name, member in inspect.getmembers(module, inspect.isroutine):
            if member.__module__ == module.__name__ and not name.startswith("_"):
                found[name] = member
    return found


FUNCTIONS = public()


def arguments(name: str) -> dict[str, tuple[object, str]]:
    """(value, unit) of each argument that has one; the rest keep their defaults."""
    own = OTHERWISE.get(name, {})
    known = {**ARGUMENTS, **own}
    signature = inspect.signature(FUNCTIONS[name])  # type: ignore[arg-type]
    return {key: known[key] for key in signature.parameters if key in known}


@pytest.mark.parametrize("name", RESULTS)
def test_formula_is_the_same_in_any_coherent_units(name: str) -> None:
    given, function = arguments(name), FUNCTIONS[name]
    plain = function(**{key: value for key, (value, _) in given.items()})  # type: ignore[operator]
    odd = function(**{key: value * factor(u) for key, (value, u) in given.items()})  # type: ignore[operator]
    assert odd == pytest.approx(plain * factor(RESULTS[name]), rel=1e-9)
    assert np.all(np.asarray(plain) != 0.0)


def test_printed_flash_carries_kelvin_metres() -> None:
    table = arguments("blok_as_printed")
    given = {key: value for key, (value, _) in table.items()}
    odd = {key: value * factor(u) for key, (value, u) in table.items()}  # type: ignore[operator]
    ratio = float(temperature.blok_as_printed(**odd) / temperature.blok_as_printed(**given))
    assert ratio == pytest.approx(factor("K*m"), rel=1e-12)
    assert ratio != pytest.approx(factor("K"), rel=1e-3)


def steel(odd: bool) -> Material:
    units = ("Pa", "kg/m**3", "W/m/K", "J/kg/K", "1/K")
    e, rho, k, c, lam = (factor(u) if odd else 1.0 for u in units)
    return Material(
        name="steel",
        youngs_modulus=206e9 * e,
        poisson_ratio=0.3,
        density=7850.0 * rho,
        thermal_conductivity=46.0 * k,
        specific_heat=470.0 * c,
        thermal_expansion=11.5e-6 * lam,
    )


@pytest.mark.parametrize("method", ["blok", "peclet"])
def test_flash_of_materials_is_the_same_in_any_coherent_units(method: str) -> None:
    values = []
    for odd in (False, True):
        names = ("friction", "line_load", "speed_1", "speed_2", "half_width")
        given = {n: ARGUMENTS[n][0] * (factor(ARGUMENTS[n][1]) if odd else 1.0) for n in names}  # type: ignore[operator]
        bodies = {"material_1": steel(odd), "material_2": steel(odd)}
        flash = moving_source.flash_temperature(**given, **bodies, method=method)
        heat = temperature.frictional_heat(**{n: given[n] for n in names[:4]})
        rolling = {n: given[n] for n in names[2:]}
        other = moving_source.peclet_flash(heat, **rolling, **bodies)
        values.append((float(flash), float(other)))
    assert values[1][0] == pytest.approx(values[0][0] * factor("K"), rel=1e-9)
    assert values[1][1] == pytest.approx(values[0][1] * factor("K"), rel=1e-9)


def test_conductances_of_a_body_are_watts_per_kelvin() -> None:
    pairs = []
    for odd in (False, True):
        long = factor("m") if odd else 1.0
        gear = Gear(25, 5e-3 * long, bore_radius=0.025 * long, material=steel(odd))
        pairs.append(np.array(gearbox.body_conductances(gear)))
    assert pairs[1] == pytest.approx(pairs[0] * factor("W/K"), rel=1e-12)


def rig(odd: bool) -> tuple[Gear, RadialField, np.ndarray]:
    """Pinion, field and radii in SI or in the odd units."""
    long, hot = (factor("m"), factor("K")) if odd else (1.0, 1.0)
    gear = Gear(teeth=25, module=5e-3 * long, bore_radius=0.025 * long, material=steel(odd))
    field = RadialField(
        bore_radius=gear.bore_radius,
        tip_radius=gear.tip_radius,
        bore_temperature=353.0 * hot,
        addendum_temperature=373.0 * hot,
        reference=293.0 * hot,
    )
    return gear, field, np.array([0.0595, 0.064]) * long


GROWTHS = {
    "flank_growth": lambda g, f, r: expansion.flank_growth(g, f, r),
    "flank_normal_growth": lambda g, f, r: expansion.flank_growth(g, f, r, "rigid", "strain"),
    "base_circle_growth": lambda g, f, r: expansion.base_circle_growth(g, f, "shaft"),
    "radial_displacement": lambda g, f, r: expansion.radial_displacement(
        f, r, root_radius=g.root_radius, expansion=g.material.thermal_expansion, poisson=0.3
    ),
    "thesis_flank_growth": lambda g, f, r: thesis_profile.thesis_flank_growth(g, f, r),
    "deformed_profile": lambda g, f, r: thesis_profile.deformed_profile(g, f, r)[0],
    "deformed_points": lambda g, f, r: thesis_profile.deformed_points(g, f, r, 0.01)[0],
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
    covered = set(RESULTS) | set(DECLARED) | IMPOSSIBLE | NOT_FORMULAS | NUMBERS | set(GROWTHS)
    covered |= {"flash_temperature", "peclet_flash", "body_conductances"}
    covered |= {"body_places", "body_radius", "ring_capacities", "tooth_radius"}
    assert set(FUNCTIONS) ^ covered == set()
    assert math.isclose(factor("m"), 1.0 / 0.37)
