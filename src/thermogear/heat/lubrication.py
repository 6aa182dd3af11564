"""Viscosity and density of an oil over temperature.

The functions take a :class:`~thermogear.base.materials.Lubricant` and temperatures [K] of any
shape. The Walther line is empirical: its constants are in mm^2/s and K, and the factor 1e-6 to
SI is in the formula.
"""

from __future__ import annotations

import warnings
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.materials import LUBRICANTS, PUBLIC_MINERAL, Lubricant
from thermogear.base.units import ZERO_CELSIUS

THINNEST = 2e-6
"""Kinematic viscosity [m^2/s] below which ASTM D341 adds correction terms to the shift 0.7."""


def _checked(lubricant: Lubricant, temperature: ArrayLike) -> Floats:
    values = np.asarray(temperature, dtype=float)
    if not np.all(np.isfinite(values) & (values > 0.0)):
        raise InputError("oil temperature", f"{values} K", allowed="> 0 K, finite")
    low, high = lubricant.temperature_range
    if np.any((values < low) | (values > high)):
        warnings.warn(
            f"oil temperature: {values.min() - ZERO_CELSIUS:.0f} .. "
            f"{values.max() - ZERO_CELSIUS:.0f} C leaves the range {low - ZERO_CELSIUS:.0f} .. "
            f"{high - ZERO_CELSIUS:.0f} C of {lubricant.name}'s viscosity line",
            ValidityWarning,
            stacklevel=3,
        )
    return values


def _walther(lubricant: Lubricant, temperature: Floats) -> Floats:
    """nu + 0.7 in mm^2/s."""
    exponent = lubricant.walther_a - lubricant.walther_b * np.log10(temperature)
    return np.asarray(10.0 ** (10.0**exponent))


def kinematic_viscosity(lubricant: Lubricant, temperature: ArrayLike) -> Floats:
    """Kinematic viscosity nu(T) [m^2/s] on the Walther line.

    log10 log10(nu + 0.7) = A - B log10 T,   nu in mm^2/s, T in K.

    ``temperature`` T [K] > 0. Shape of ``temperature``. Raises for T <= 0 K. Warns outside
    ``lubricant.temperature_range`` and below 2 mm^2/s, where the standard corrects the shift.
    Source: ASTM D341.

    >>> oil = Lubricant.from_two_points("oil", (313.15, 100e-6), (373.15, 11e-6))
    >>> f"{1e6 * kinematic_viscosity(oil, 373.15):.2f} mm^2/s"
    '11.00 mm^2/s'
    """
    nu = _walther(lubricant, _checked(lubricant, temperature)) - 0.7
    if np.any(nu < THINNEST * 1e6):
        warnings.warn(
            f"viscosity: {nu.min():.3g} mm^2/s of {lubricant.name} lies below {THINNEST * 1e6:g} "
            "mm^2/s, where the Walther line with 0.7 no longer holds",
            ValidityWarning,
            stacklevel=2,
        )
    return np.asarray(nu * 1e-6)


def density(lubricant: Lubricant, temperature: ArrayLike) -> Floats:
    """Density rho(T) = rho_15 - slope (T - 288.15 K) [kg/m^3].

    ``temperature`` [K] > 0, any shape. Raises for T <= 0 K, warns outside the oil's range.
    Source: form of ISO/TR 15144-1 eq. 20.

    >>> oil = lubricant("FVA3")
    >>> f"{density(oil, 288.15):.0f} kg/m^3"
    '892 kg/m^3'
    """
    values = _checked(lubricant, temperature)
    return np.asarray(
        lubricant.density_15 - lubricant.density_slope * (values - (ZERO_CELSIUS + 15.0))
    )


def dynamic_viscosity(lubricant: Lubricant, temperature: ArrayLike) -> Floats:
    """Dynamic viscosity eta(T) = nu(T) rho(T) [Pa s] at ambient pressure.

    ``temperature`` [K] > 0, any shape. Raises and warns as :func:`kinematic_viscosity`.

    >>> oil = lubricant("FVA3")
    >>> f"{1e3 * dynamic_viscosity(oil, 353.15):.1f} mPa s"
    '16.3 mPa s'
    """
    values = np.asarray(temperature, dtype=float)
    nu = kinematic_viscosity(lubricant, values)
    # the range was reported once with the viscosity
    rho = lubricant.density_15 - lubricant.density_slope * (values - (ZERO_CELSIUS + 15.0))
    return np.asarray(nu * rho)


def walther_slope(lubricant: Lubricant, temperature: ArrayLike) -> Floats:
    """Temperature-viscosity coefficient beta = -d ln nu / dT [1/K] of the Walther line.

    beta = B (nu + 0.7) ln(nu + 0.7) / (nu T),   nu in mm^2/s, T in K.

    ``temperature`` [K] > 0, any shape; > 0. Derived by differentiating the line.

    >>> oil = lubricant("FVA3")
    >>> f"{walther_slope(oil, 353.15):.4f} 1/K"
    '0.0315 1/K'
    """
    values = _checked(lubricant, temperature)
    shifted = _walther(lubricant, values)
    return np.asarray(lubricant.walther_b * shifted * np.log(shifted) / ((shifted - 0.7) * values))


def grade(viscosity_40: float) -> Lubricant:
    """A mineral oil with the kinematic viscosity ``viscosity_40`` [m^2/s] at 40 °C.

    Its viscosity at 100 °C follows the package's own mineral oils: nu_100 = c nu_40^p, fitted to
    them.

    >>> oil = grade(220e-6)
    >>> f"{1e6 * kinematic_viscosity(oil, 313.15):.1f} mm^2/s"
    '220.0 mm^2/s'
    """
    warm, hot = ZERO_CELSIUS + 40.0, ZERO_CELSIUS + 100.0
    slope, level = _mineral_line()
    at_100 = float(np.exp(level + slope * np.log(viscosity_40)))
    name = f"mineral oil of {viscosity_40 * 1e6:.4g} mm2/s"
    return Lubricant.from_two_points(name, (warm, viscosity_40), (hot, at_100))


@lru_cache(maxsize=1)
def _mineral_line() -> tuple[float, float]:
    """Slope and level of ln nu_100 over ln nu_40 of the package's own mineral oils."""
    known = [LUBRICANTS[name] for name in sorted(PUBLIC_MINERAL)]
    warm, hot = ZERO_CELSIUS + 40.0, ZERO_CELSIUS + 100.0
    low = np.log([float(kinematic_viscosity(one, warm)) for one in known])
    high = np.log([float(kinematic_viscosity(one, hot)) for one in known])
    slope, level = np.polyfit(low, high, 1)
    return float(slope), float(level)
