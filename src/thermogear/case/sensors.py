"""What thermometers would show, and the true temperatures of a pair in its duty."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.case.sensor_schema import (
    InfraredTable,
    RingTable,
    SensorsTable,
    ThermocoupleTable,
)
from thermogear.gears.contact import curvature_radii
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.heat.gearbox import Surroundings
from thermogear.heat.measured_temperature import buried_temperature, infrared_indication
from thermogear.mesh.warm_up import WarmUp

SENSORS = tuple(SensorsTable.model_fields)
"""Names of the sensors, in the order of their table."""


@dataclass(frozen=True, kw_only=True)
class Shown:
    """What one sensor shows and the true temperature it is meant to say, (time,) [K]."""

    name: str
    words: str
    shown: NDArray[np.float64]
    true: NDArray[np.float64]


def flank_area(pair: GearPair, gear: Gear) -> float:
    """Area of all flanks of one side that touch, z b (rho_E^2 - rho_A^2)/(2 r_b) [m^2].

    The arc of an involute between its radii of curvature rho at both ends of the path.
    """
    which = 0 if gear is pair.pinion else 1
    ends = curvature_radii(pair, np.array([pair.path.a, pair.path.e]))[which]
    arc = float(np.ptp(np.asarray(ends) ** 2)) / (2.0 * gear.base_radius)
    return gear.teeth * pair.face_width * arc


def shaft_share(gear: Gear, surroundings: Surroundings, distance: float) -> float:
    """Share of the fall from shaft node to housing that lies before ``distance`` [m], 0..1 [-].

    Conduction along the shaft, (d/(k A))/(l/(k A) + 1/G_bearing): the network's own path.
    """
    if not 0.0 <= distance <= surroundings.shaft_length:
        raise InputError(
            "sensors.ring.distance",
            f"{1e3 * distance:g} mm",
            allowed=f"0..{1e3 * surroundings.shaft_length:g} mm",
            why="it lies between the gear and its bearing",
            fix="move it, or give a longer gearbox.shaft_length",
        )
    along = gear.material.thermal_conductivity * np.pi * gear.bore_radius**2
    whole = surroundings.shaft_length / along + 1.0 / surroundings.bearing_conductance
    return float(distance / along / whole)


def shown_by(
    pair: GearPair, surroundings: Surroundings, table: SensorsTable, course: WarmUp
) -> tuple[Shown, ...]:
    """What every sensor of ``table`` shows over the course."""
    return (
        _thermocouple(pair, table.thermocouple or ThermocoupleTable(), course),
        _ring(pair, surroundings, table.ring or RingTable(), course),
        _infrared(table.infrared or InfraredTable(), course),
    )


def _thermocouple(pair: GearPair, table: ThermocoupleTable, course: WarmUp) -> Shown:
    gear = pair.pinion if table.gear == "pinion" else pair.wheel
    first = np.asarray(course.losses.partition_1)
    share = first if table.gear == "pinion" else 1.0 - first
    flux = share * np.asarray(course.losses.mesh) / flank_area(pair, gear)
    true = course.temperatures[f"{table.gear}_tooth"]
    shown = buried_temperature(true, flux, table.depth, gear.material.thermal_conductivity)
    words = f"thermocouple {1e3 * table.depth:g} mm below the {table.gear}'s flank"
    return Shown(name="thermocouple", words=words, shown=shown, true=true)


def _ring(pair: GearPair, surroundings: Surroundings, table: RingTable, course: WarmUp) -> Shown:
    gear = pair.pinion if table.gear == "pinion" else pair.wheel
    if surroundings.train is None:
        end, fall = "housing", shaft_share(gear, surroundings, table.distance)
    else:
        end, fall = surroundings.train.along(
            table.gear, face_width=gear.face_width, distance=table.distance
        )
    true = course.temperatures[f"{table.gear}_shaft"]
    shown = true - fall * (true - course.temperatures[end])
    words = f"ring on the {table.gear}'s shaft, {1e3 * table.distance:g} mm from the gear"
    return Shown(name="ring", words=words, shown=shown, true=true)


def _infrared(table: InfraredTable, course: WarmUp) -> Shown:
    true = course.temperatures[f"{table.gear}_tooth"]
    around = course.temperatures["housing"] if table.surroundings is None else table.surroundings
    path = course.temperatures["ambient"]
    shown = infrared_indication(
        true,
        emissivity=table.emissivity,
        transmission=table.transmission,
        surroundings=around,
        path=path if table.window_temperature is None else table.window_temperature,
        band=table.band,
        indicated_emissivity=table.instrument_emissivity,
    )
    words = (
        f"infrared camera on the {table.gear}'s flanks, emissivity {table.emissivity:g}, set to "
        f"{table.instrument_emissivity:g}"
    )
    return Shown(name="infrared", words=words, shown=shown, true=true)
