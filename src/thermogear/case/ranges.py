"""Where a case leaves the range of its material, load and oil data, or of a case file."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.materials import Material
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.units import shown
from thermogear.gears.contact import hertz_pressure, pair_reduced_modulus, reduced_radius
from thermogear.gears.pair import GearPair
from thermogear.mesh.operating import Operating

COLDEST = ZERO_CELSIUS - 60.0
"""Below it [K] the material data are an extrapolation."""


CRUSHING = 4e9
"""Hertzian pressure [Pa] of a line contact that dents the hardest bearing steel for good: the
4000 MPa of a roller bearing's static rating (ISO 76:2006, a dent of 1e-4 roller diameters)."""


def warn_of_temperatures(pair: GearPair, states: dict[str, Operating]) -> None:
    """Warn of every body and oil temperature of ``states`` (field -> points) outside its data."""
    for where, state in states.items():
        bodies = state.temperatures
        for body, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
            for place in ("addendum", "bore"):
                value = float(np.max(getattr(bodies, f"{body}_{place}")))
                _warn(f"{where}.{body}_{place}", value, gear.material)
        _warn(f"{where}.housing", float(np.max(bodies.housing)), state.housing)
        low, high = state.lubricant.temperature_range
        for oil in np.unique(np.asarray(state.oil_temperature, dtype=float)):
            if not low <= oil <= high:
                field = "oil.temperature" if where == "temperatures" else f"{where}, oil"
                why = f"outside the viscosity fit of {state.lubricant.name}"
                _say(field, float(oil), low, high, why)


def warn_of_torque(pair: GearPair, torques: ArrayLike) -> None:
    """Warn of a greatest pinion torque [N m] that would crush the flanks of any steel.

    p_0 at the pitch point, cold, the whole load on one tooth pair; p_0 grows as sqrt(torque).
    """
    torque = float(np.max(np.asarray(torques, dtype=float)))
    most = crushing_torque(pair)
    if torque > most:
        pressure = CRUSHING * float(np.sqrt(torque / most))
        warnings.warn(
            f"pinion torque: got {torque:g} N m; valid 0..{most:.4g} N m; "
            f"{1e-9 * pressure:.3g} GPa between the flanks at the pitch point, and above "
            f"{1e-9 * CRUSHING:g} GPa no steel stays elastic",
            ValidityWarning,
            stacklevel=3,
        )


def crushing_torque(pair: GearPair) -> float:
    """The pinion torque [N m] that presses the flanks with 4 GPa; see :func:`warn_of_torque`."""
    unit = 1.0 / pair.pinion.base_radius / pair.face_width
    radius = reduced_radius(pair, pair.path.c)
    pressure = float(hertz_pressure(unit, radius, pair_reduced_modulus(pair)))
    return (CRUSHING / pressure) ** 2


def _warn(where: str, value: float, material: Material) -> None:
    high = material.tempering_temperature
    if value > high:
        _say(where, value, COLDEST, high, f"above the tempering temperature of {material.name}")
    elif value < COLDEST:
        _say(where, value, COLDEST, high, f"below the data of {material.name}")


def _say(where: str, value: float, low: float, high: float, why: str) -> None:
    upper = f"{high - ZERO_CELSIUS:g}" if high < 1e6 else "any"
    warnings.warn(
        f"{where}: got {value - ZERO_CELSIUS:g} degC; valid {low - ZERO_CELSIUS:g}..{upper} degC; "
        f"{why}",
        ValidityWarning,
        stacklevel=5,
    )


def in_proportion(hot: Operating, gear_temperature: ArrayLike) -> Operating:
    """``hot`` with the gears at ``gear_temperature`` [K]; refused where no case file can say it."""
    try:
        return hot.with_gears_at(gear_temperature)
    except InputError as error:
        why = f"in the hot state {error.why}"
        if error.field != "gear temperature":
            name = error.field.rpartition(".")[2]
            why = f"{name} in proportion to it would be at {error.got}; allowed {error.allowed}"
        raise InputError(
            "gear temperature",
            shown(float(np.ravel(gear_temperature)[0]), "temperature"),
            why=why,
            fix='give the addenda other temperatures, or write temperatures.follow = "fixed"',
        ) from error
