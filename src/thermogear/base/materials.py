"""Materials and lubricants: named sets, one source each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError, nearest

Floats = NDArray[np.float64]
ZERO_CELSIUS = 273.15


@dataclass(frozen=True)
class Material:
    """An isotropic gear material (SI, at 20 C).

    E(T) = E20 [1 - ``modulus_slope`` (T - 293.15 K)]; the slope's source for carbon steel is
    the fit to Roark's table (202.0 .. 182.7 GPa at 21 .. 316 C), valid 21..204 C.
    """

    name: str
    youngs_modulus: float
    poisson_ratio: float
    density: float
    thermal_conductivity: float
    specific_heat: float
    thermal_expansion: float
    modulus_slope: float = 0.0
    tempering_temperature: float = 1e9
    source: str = "given by the user"

    def __post_init__(self) -> None:
        for field in (
            "youngs_modulus",
            "density",
            "thermal_conductivity",
            "specific_heat",
            "thermal_expansion",
        ):
            value = getattr(self, field)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"material.{field}", value, allowed="> 0, finite")
        if not 0.0 <= self.poisson_ratio < 0.5:
            raise InputError("material.poisson_ratio", self.poisson_ratio, allowed="0 <= nu < 0.5")

    def youngs_modulus_at(self, temperature: ArrayLike) -> Floats:
        """E(T) [Pa] at ``temperature`` [K], any shape."""
        rise = np.asarray(temperature, dtype=float) - (ZERO_CELSIUS + 20.0)
        return np.asarray(self.youngs_modulus * (1.0 - self.modulus_slope * rise))

    @property
    def thermal_contact_coefficient(self) -> float:
        """sqrt(k rho c) [J/(m^2 K s^0.5)]."""
        return float(np.sqrt(self.thermal_conductivity * self.density * self.specific_heat))


@dataclass(frozen=True)
class Lubricant:
    """An oil by its Walther line (ASTM D341): log10 log10(nu + 0.7) = A - B log10 T.

    nu in mm^2/s, T in K. Density rho(T) = ``density_15`` - 0.7 (T - 288.15) kg/m^3
    (ISO/TR 15144-1 eq. 20; the standard rounds 288.15 to 289 - 273 + ...).
    """

    name: str
    kind: str
    walther_a: float
    walther_b: float
    density_15: float
    source: str = "given by the user"


MATERIALS: dict[str, Material] = {
    "steel": Material(
        name="steel",
        youngs_modulus=206e9,
        poisson_ratio=0.3,
        density=7850.0,
        thermal_conductivity=46.0,
        specific_heat=470.0,
        thermal_expansion=11.5e-6,
        modulus_slope=3.3e-4,
        tempering_temperature=ZERO_CELSIUS + 180.0,
        source="case-hardening gear steel, handbook values; E(T) slope fitted to Roark's table",
    ),
}


def material(name: str) -> Material:
    """The named set, or an error that says the nearest name."""
    if name not in MATERIALS:
        raise InputError("material", repr(name), fix=nearest(name, MATERIALS))
    return MATERIALS[name]
