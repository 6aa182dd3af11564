"""Numbers from Python in the wrong unit are refused in one line that says what was meant."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from thermogear import Gear, GearPair, Lubricant, Material, Operating, Relief, Temperatures
from thermogear.base import bounds
from thermogear.base.bounds import Bounds
from thermogear.base.errors import InputError
from thermogear.base.materials import lubricant
from thermogear.case.fields import Count, Measure, Number, Several
from thermogear.case.refusals import reader_at
from thermogear.case.schema import GearFile
from thermogear.case.units import read_quantity
from thermogear.gears.deviations import FlankTable, PitchError, PressureAngleError
from thermogear.gears.stiffness import Moduli
from thermogear.heat.gearbox import Surroundings
from thermogear.heat.measured_temperature import InfraredReading, ThermocoupleReading
from thermogear.mesh.balance import Gearbox

WARM = {"pinion_addendum": 373.15, "pinion_bore": 353.15, "wheel_addendum": 373.15}
WARM |= {"wheel_bore": 353.15, "housing": 333.15, "reference": 293.15}


def steel(**changes: float) -> Material:
    numbers = {
        "youngs_modulus": 206e9,
        "poisson_ratio": 0.3,
        "density": 7850.0,
        "thermal_conductivity": 46.0,
        "specific_heat": 470.0,
        "thermal_expansion": 11.5e-6,
    }
    return Material(name="steel", **numbers | changes)


def operating(**changes: object) -> Operating:
    numbers = {
        "speed": np.array([100.0]),
        "torque": np.array([100.0]),
        "lubricant": lubricant("M100"),
        "oil_temperature": 343.15,
        "temperatures": Temperatures(**WARM),
        "half_backlash": 125e-6,
    }
    return Operating(**numbers | changes)


def oil(*points: tuple[float, float]) -> Lubricant:
    return Lubricant.from_two_points("mine", *points)


KELVIN = "allowed -70..600 degC"

SLIPS: list[tuple[Callable[[], object], str]] = [
    (
        lambda: Gear(20, 3),
        "module: got 3 m (3000 mm); allowed 0.05..100 mm; did you mean 0.003 (3 mm)?",
    ),
    (
        lambda: Gear(20, 3e-3, pressure_angle=20),
        "pressure_angle: got 20 rad (1145.92 deg); allowed 10..35 deg; "
        "did you mean 0.349066 (20 deg)?",
    ),
    (
        lambda: Gear(20, 3e-3, face_width=25),
        "face_width: got 25 m (25000 mm); allowed 0.01..10000 mm; did you mean 0.025 (25 mm)?",
    ),
    (
        lambda: Gear(20, 3e-3, bore_radius=12.5),
        "bore_radius: got 12.5 m (12500 mm); allowed 0.01..10000 mm; "
        "did you mean 0.0125 (12.5 mm)?",
    ),
    (
        lambda: Gear(20, 3e-3, tip_radius=33.0),
        "tip_radius: got 33 m (33000 mm); allowed 0.05..10000 mm; did you mean 0.033 (33 mm)?",
    ),
    (
        lambda: Gear(20, 3e-3, roughness=0.4),
        "roughness: got 0.4 m (400000 um); allowed 0.001..100 um; did you mean 4e-07 (0.4 um)?",
    ),
    (
        lambda: Gear(20, 3e-3, profile_shift=3.0),
        "profile_shift: got 3 modules; allowed -2..2 modules",
    ),
    (
        lambda: GearPair(Gear(20, 3e-3), Gear(40, 3e-3), centre_distance=90),
        "centre_distance: got 90 m (90000 mm); allowed 0.1..20000 mm; did you mean 0.09 (90 mm)?",
    ),
    (
        lambda: Relief("wheel", amount=20, length=3e-3),
        "relief.amount: got 20 m (2e+07 um); allowed 0..1000 um; did you mean 2e-05 (20 um)?",
    ),
    (
        lambda: Relief("wheel", amount=0.02, length=3e-3),
        "relief.amount: got 0.02 m (20000 um); allowed 0..1000 um; "
        "did you mean 2e-08 (0.02 um) or 2e-05 (0.02 mm)?",
    ),
    (
        lambda: Relief("wheel", amount=20e-6, length=3),
        "relief.length: got 3 m (3000 mm); allowed 0.01..1000 mm; did you mean 0.003 (3 mm)?",
    ),
    (
        lambda: PitchError("wheel", (3.0, -2.0)),
        "pitch_error.errors: got 3 m (3e+06 um); allowed -1000..1000 um; "
        "did you mean 3e-06 (3 um)?",
    ),
    (
        lambda: PressureAngleError("wheel", 0.02 + 0.5),
        "pressure_angle_error.error: got 0.52 rad (29.7938 deg); allowed -1.1..1.1 deg; "
        "did you mean 0.00907571 (0.52 deg)?",
    ),
    (
        lambda: FlankTable("wheel", radius=[60.0, 62.0], added=[0.0, 1e-6]),
        "flank_table.radius: got 60 m (60000 mm); allowed 0.1..10000 mm; "
        "did you mean 0.06 (60 mm)?",
    ),
    (
        lambda: FlankTable("wheel", radius=[0.06, 0.062], added=[0.0, 3.0]),
        "flank_table.added: got 3 m (3e+06 um); allowed -2000..2000 um; did you mean 3e-06 (3 um)?",
    ),
    (
        lambda: Temperatures(**WARM | {"housing": 60.0}),
        f"temperatures.housing: got 60 K (-213.15 degC); {KELVIN}; did you mean 333.15 (60 degC)?",
    ),
    (
        lambda: Temperatures.uniform([353.15, 80.0], reference=293.15),
        f"temperatures.pinion_addendum: got 80 K (-193.15 degC); {KELVIN}; "
        "did you mean 353.15 (80 degC)?",
    ),
    (
        lambda: operating(oil_temperature=60),
        f"operating.oil_temperature: got 60 K (-213.15 degC); {KELVIN}; "
        "did you mean 333.15 (60 degC)?",
    ),
    (
        lambda: operating(half_backlash=0.125),
        "operating.half_backlash: got 0.125 m (125 mm); allowed 5e-6..50 mm; "
        "did you mean 0.000125 (0.125 mm)?",
    ),
    (
        lambda: operating(speed=np.array([-1.0])),
        "operating.speed: got -1 rad/s (-9.5493 rpm); allowed 0..500000 rpm",
    ),
    (
        lambda: operating(torque=np.array([1e8])),
        "operating.torque: got 1e+08 N m; allowed 0..1e7 N m",
    ),
    (
        lambda: steel(youngs_modulus=206),
        "material.youngs_modulus: got 206 Pa (2.06e-07 GPa); allowed 0.01..2000 GPa; "
        "did you mean 2.06e+11 (206 GPa) or 2.06e+08 (206 N/mm^2)?",
    ),
    (
        lambda: steel(youngs_modulus=206000),
        "material.youngs_modulus: got 206000 Pa (0.000206 GPa); allowed 0.01..2000 GPa; "
        "did you mean 2.06e+11 (206000 N/mm^2)?",
    ),
    (
        lambda: steel(density=7.85),
        "material.density: got 7.85 kg/m^3; allowed 100..30000 kg/m^3; "
        "did you mean 7850 (7.85 g/cm^3)?",
    ),
    (
        lambda: steel(specific_heat=0.47),
        "material.specific_heat: got 0.47 J/(kg K); allowed 10..10000 J/(kg K); "
        "did you mean 470 (0.47 kJ/(kg K))?",
    ),
    (
        lambda: steel(thermal_expansion=11.5),
        "material.thermal_expansion: got 11.5 1/K; allowed 1e-9..0.0005 1/K; "
        "did you mean 1.15e-05 (11.5 um/(m K))?",
    ),
    (
        lambda: steel(tempering_temperature=180.0),
        "material.tempering_temperature: got 180 K (-93.15 degC); allowed -70..3000 degC; "
        "did you mean 453.15 (180 degC)?",
    ),
    (
        lambda: Moduli(tooth=206.0, body=206e9),
        "modulus.tooth: got 206 Pa (2.06e-07 GPa); allowed 0.01..2000 GPa; "
        "did you mean 2.06e+11 (206 GPa) or 2.06e+08 (206 N/mm^2)?",
    ),
    (
        lambda: oil((40.0, 100e-6), (100.0, 11e-6)),
        f"lubricant.temperatures: got 40 K (-233.15 degC); {KELVIN}; "
        "did you mean 313.15 (40 degC)?",
    ),
    (
        lambda: oil((313.15, 100.0), (373.15, 11.0)),
        "lubricant.viscosities: got 100 m^2/s (1e+08 mm^2/s); allowed 0.3..1e6 mm^2/s; "
        "did you mean 0.0001 (100 mm^2/s)?",
    ),
    (
        lambda: Surroundings(ambient=20.0),
        f"surroundings.ambient: got 20 K (-253.15 degC); {KELVIN}; did you mean 293.15 (20 degC)?",
    ),
    (
        lambda: Gearbox(measured={"oil": 60.0}),
        f"gearbox.measured.oil: got 60 K (-213.15 degC); {KELVIN}; did you mean 333.15 (60 degC)?",
    ),
    (
        lambda: InfraredReading(indicated=80.0, emissivity=0.9, surroundings=293.15),
        f"infrared.indicated: got 80 K (-193.15 degC); {KELVIN}; did you mean 353.15 (80 degC)?",
    ),
    (
        lambda: ThermocoupleReading(indicated=353.15, flux=1e4, depth=1.0, conductivity=46.0),
        "thermocouple.depth: got 1 m (1000 mm); allowed 0..50 mm; did you mean 0.001 (1 mm)?",
    ),
]


@pytest.mark.parametrize(("make", "message"), SLIPS, ids=[text.split(":")[0] for _, text in SLIPS])
def test_a_number_in_the_wrong_unit_is_refused_with_what_was_meant(
    make: Callable[[], object], message: str
) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value) == message


def test_what_is_meant_is_allowed() -> None:
    for name, allowed in vars(bounds).items():
        if isinstance(allowed, Bounds):
            allowed.require(name, [allowed.least, 0.5 * (allowed.least + allowed.most)])
            allowed.require(name, allowed.most)
            for wrong in (math.nan, math.inf, -math.inf):
                with pytest.raises(InputError, match=f"^{name}: got -?(nan|inf)\\b"):
                    allowed.require(name, [allowed.most, wrong])


PLACES = {
    "gears.module": bounds.MODULE,
    "gears.pressure_angle": bounds.PRESSURE_ANGLE,
    "gears.centre_distance": bounds.CENTRE_DISTANCE,
    "gears.pinion.face_width": bounds.LENGTH,
    "gears.pinion.bore_radius": bounds.LENGTH,
    "gears.pinion.roughness": bounds.ROUGHNESS,
    "gears.pinion.profile_shift": bounds.PROFILE_SHIFT,
    "gears.rack.addendum": bounds.RACK,
    "gears.pinion.tip_relief.amount": bounds.RELIEF_AMOUNT,
    "gears.pinion.tip_relief.length": bounds.RELIEF_LENGTH,
    "gears.pinion.pressure_angle_error": bounds.ANGLE_ERROR,
    "gears.pinion.profile.radius": bounds.PROFILE_RADIUS,
    "gears.pinion.profile.added": bounds.ADDED,
    "materials.mine.youngs_modulus": bounds.YOUNGS_MODULUS,
    "materials.mine.density": bounds.DENSITY,
    "materials.mine.thermal_conductivity": bounds.CONDUCTIVITY,
    "materials.mine.specific_heat": bounds.SPECIFIC_HEAT,
    "materials.mine.thermal_expansion": bounds.EXPANSION,
    "materials.mine.modulus_slope": bounds.MODULUS_SLOPE,
    "materials.mine.tempering_temperature": bounds.TEMPERING,
    "oil.density_15": bounds.OIL_DENSITY,
    "oil.temperature": bounds.BODY,
    "temperatures.reference": bounds.BODY,
    "temperatures.housing": bounds.BODY,
    "gearbox.ambient": bounds.BODY,
    "gearbox.readings.oil.indicated": bounds.BODY,
    "gearbox.readings.oil.depth": bounds.DEPTH,
    "operating.torque": bounds.TORQUE,
}


@pytest.mark.parametrize("place", PLACES)
def test_case_files_and_python_hold_the_same_bounds(place: str) -> None:
    reader = reader_at(GearFile, tuple(place.split(".")))
    reader = reader.one if isinstance(reader, Several) else reader
    if isinstance(reader, Number | Count):
        ends = [reader.low, reader.high]
    else:
        assert isinstance(reader, Measure)
        assert reader.low is not None
        assert reader.high is not None
        ends = [read_quantity(end, reader.kind) for end in (reader.low, reader.high)]
    assert ends == pytest.approx([PLACES[place].least, PLACES[place].most], rel=1e-12, abs=1e-18)
