"""What a thermometer says against what the surface has: infrared and embedded thermocouple.

The corrected temperature comes with its standard uncertainty, which carries into the T_a and
T_x of the radial field.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.bounds import BODY, CONDUCTIVITY, DEPTH, require_share
from thermogear.base.errors import InputError
from thermogear.base.gauss import gauss

Band = tuple[float, float] | None
_C2 = 6.62607015e-34 * 299792458.0 / 1.380649e-23
"""h c/k [m K]; the three are exact by definition of the SI."""
_LEAST, _GREATEST = 150.0, 3000.0  # K, where the inversion looks


def band_radiance(temperature: ArrayLike, band: Band = None) -> Floats:
    """Black-body radiance a detector collects, up to a constant factor [-].

    ``band`` None: all wavelengths, T^4. (l1, l2) [m]: Planck's law integrated over the band; with
    both ends alike, at one wavelength: 1/[exp(c2/(l T)) - 1].

    ``temperature`` [K] > 0, any shape. Only ratios matter in the correction.

    >>> f"{band_radiance(400.0) / band_radiance(200.0):.1f}"
    '16.0'
    """
    t = np.asarray(temperature, dtype=float)
    if not np.all(np.isfinite(t) & (t > 0.0)):
        raise InputError("temperature", f"{t} K", allowed="> 0 K, finite")
    if band is None:
        return np.asarray((t / 300.0) ** 4)
    low, high = band
    if not 0.0 < low <= high:
        raise InputError("band", f"{low} .. {high} m", allowed="0 < shorter <= longer")
    if low == high:
        return np.asarray(1.0 / np.expm1(_C2 / (low * t)))
    nodes, weights = gauss(32)
    wave = 0.5 * (low + high) + 0.5 * (high - low) * nodes
    spectrum = (low / wave) ** 5 / np.expm1(_C2 / (wave * t[..., None]))
    return np.asarray(0.5 * np.sum(weights * spectrum, axis=-1))


def infrared_signal(
    temperature: ArrayLike,
    *,
    emissivity: ArrayLike,
    transmission: ArrayLike,
    surroundings: ArrayLike,
    path: ArrayLike,
    band: Band = None,
) -> Floats:
    """S = eps tau L(T) + (1 - eps) tau L(T_env) + (1 - tau) L(T_path), L of the band [-].

    ``temperature`` T [K] of the surface, ``emissivity`` eps, ``transmission`` tau of window and
    air, ``surroundings`` T_env [K] that the surface mirrors, ``path`` T_path [K] of the window.
    Any shape. eps = tau = 1 gives L(T).

    >>> signal = infrared_signal(
    ...     400.0, emissivity=1.0, transmission=1.0, surroundings=300.0, path=300.0
    ... )
    >>> f"{signal / band_radiance(400.0):.3f}"
    '1.000'
    """
    eps, tau = np.asarray(emissivity, dtype=float), np.asarray(transmission, dtype=float)
    own = eps * tau * band_radiance(temperature, band)
    mirrored = (1.0 - eps) * tau * band_radiance(surroundings, band)
    return np.asarray(own + mirrored + (1.0 - tau) * band_radiance(path, band))


def _invert(radiance: float, band: Band) -> float:
    if not radiance > band_radiance(_LEAST, band):
        raise InputError(
            "infrared reading",
            radiance,
            why="reflections and the window alone are brighter than the reading",
            fix="check emissivity, transmission and the surroundings' temperature",
        )
    from scipy.optimize import brentq

    return float(
        brentq(lambda t: float(band_radiance(t, band)) - radiance, _LEAST, _GREATEST, xtol=1e-10)
    )


def infrared_indication(
    temperature: ArrayLike,
    *,
    emissivity: float,
    transmission: float,
    surroundings: ArrayLike,
    path: ArrayLike,
    band: Band = None,
    indicated_emissivity: float = 1.0,
) -> Floats:
    """What an infrared instrument says of a surface at ``temperature`` [K].

    T_i with eps_i L(T_i) + (1 - eps_i) L(T_env) = S, S of
    :func:`infrared_signal`, the instrument set to ``indicated_emissivity`` eps_i and no window.

    ``emissivity``, ``transmission`` in (0, 1]; ``surroundings``, ``path`` [K], any shapes that
    broadcast with ``temperature``. Raises where the setting leaves nothing for the surface.

    >>> t = infrared_indication(
    ...     373.15, emissivity=0.9, transmission=1.0, surroundings=293.15, path=293.15
    ... )
    >>> f"{t - 273.15:.2f} C"
    '94.09 C'
    """
    for name, value in (
        ("emissivity", emissivity),
        ("transmission", transmission),
        ("indicated emissivity", indicated_emissivity),
    ):
        require_share(name, value)
    signal = infrared_signal(
        temperature,
        emissivity=emissivity,
        transmission=transmission,
        surroundings=surroundings,
        path=path,
        band=band,
    )
    mirrored = (1.0 - indicated_emissivity) * band_radiance(surroundings, band)
    own = (signal - mirrored) / indicated_emissivity
    return np.asarray([_invert(float(one), band) for one in np.ravel(own)]).reshape(own.shape)


def _corrected(
    indicated: float,
    emissivity: float,
    transmission: float,
    surroundings: float,
    path: float,
    band: Band,
) -> float:
    signal = band_radiance(indicated, band)
    mirrored = (1.0 - emissivity) * transmission * band_radiance(surroundings, band)
    window = (1.0 - transmission) * band_radiance(path, band)
    return _invert(float((signal - mirrored - window) / (emissivity * transmission)), band)


def surface_temperature(
    indicated: ArrayLike, flux: ArrayLike, depth: ArrayLike, conductivity: ArrayLike
) -> Floats:
    """Surface temperature above an embedded thermocouple, T + q d/k [K].

    ``indicated`` T [K] at depth, ``flux`` q [W/m^2] through the surface inwards, ``depth`` d [m]
    below it, ``conductivity`` k [W/(m K)]. Any shape: steady conduction, one dimension.

    >>> f"{surface_temperature(353.15, 1e6, 0.5e-3, 50.0):.2f} K"
    '363.15 K'
    """
    drop = np.asarray(flux, dtype=float) * np.asarray(depth) / np.asarray(conductivity)
    return np.asarray(np.asarray(indicated, dtype=float) + drop)


def buried_temperature(
    surface: ArrayLike, flux: ArrayLike, depth: ArrayLike, conductivity: ArrayLike
) -> Floats:
    """What an embedded thermocouple says, T - q d/k [K]: inverse of :func:`surface_temperature`.

    ``surface`` T [K], ``flux`` q [W/m^2] inwards, ``depth`` d [m], ``conductivity`` k [W/(m K)].

    >>> f"{buried_temperature(363.15, 1e6, 0.5e-3, 50.0):.2f} K"
    '353.15 K'
    """
    drop = np.asarray(flux, dtype=float) * np.asarray(depth) / np.asarray(conductivity)
    return np.asarray(np.asarray(surface, dtype=float) - drop)


def _propagate(
    value: Callable[..., float], best: dict[str, float], spread: dict[str, float]
) -> float:
    """Standard uncertainty [K] by central differences, of independent inputs."""
    parts = [
        500.0
        * (value(**best | {name: best[name] + step}) - value(**best | {name: best[name] - step}))
        for name, step in ((name, 1e-3 * sigma) for name, sigma in spread.items())
    ]
    return math.hypot(*parts)


@dataclass(frozen=True, kw_only=True)
class InfraredReading:
    """One infrared reading with what is known of its circumstances; ``u_...`` are sigmas.

    ``indicated`` [K] by an instrument set to emissivity 1, ``emissivity``, ``transmission`` of
    the window, ``surroundings`` and ``path`` [K], ``band`` (l1, l2) [m] or None for total
    radiation.

    >>> reading = InfraredReading(indicated=373.15, emissivity=1.0, surroundings=293.15)
    >>> f"{reading.temperature():.2f} K"
    '373.15 K'
    """

    indicated: float
    emissivity: float
    surroundings: float
    transmission: float = 1.0
    path: float = 293.15
    band: Band = None
    u_indicated: float = 0.0
    u_emissivity: float = 0.0
    u_transmission: float = 0.0
    u_surroundings: float = 0.0
    u_path: float = 0.0

    def __post_init__(self) -> None:
        for name in ("emissivity", "transmission"):
            require_share(name, getattr(self, name))
        for name in ("indicated", "surroundings", "path"):
            BODY.require(f"infrared.{name}", getattr(self, name))
        self.temperature()

    def _value(self, **changed: float) -> float:
        return _corrected(**changed, band=self.band)

    def _inputs(self) -> dict[str, float]:
        names = ("indicated", "emissivity", "transmission", "surroundings", "path")
        return {name: getattr(self, name) for name in names}

    def temperature(self) -> float:
        """Corrected surface temperature [K]."""
        return self._value(**self._inputs())

    def uncertainty(self) -> float:
        """Its standard uncertainty [K]."""
        spread = {name: getattr(self, f"u_{name}") for name in self._inputs()}
        return _propagate(self._value, self._inputs(), spread)


@dataclass(frozen=True, kw_only=True)
class ThermocoupleReading:
    """One embedded thermocouple: ``indicated`` [K] at ``depth`` [m] under ``flux`` [W/m^2].

    >>> reading = ThermocoupleReading(indicated=353.15, flux=1e6, depth=0.5e-3, conductivity=50.0)
    >>> f"{reading.temperature():.2f} K"
    '363.15 K'
    """

    indicated: float
    flux: float
    depth: float
    conductivity: float
    u_indicated: float = 0.0
    u_flux: float = 0.0
    u_depth: float = 0.0

    def __post_init__(self) -> None:
        BODY.require("thermocouple.indicated", self.indicated)
        DEPTH.require("thermocouple.depth", self.depth)
        CONDUCTIVITY.require("thermocouple.conductivity", self.conductivity)

    def temperature(self) -> float:
        """Surface temperature [K]."""
        return float(surface_temperature(self.indicated, self.flux, self.depth, self.conductivity))

    def uncertainty(self) -> float:
        """Its standard uncertainty [K]."""

        def value(indicated: float, flux: float, depth: float) -> float:
            return indicated + flux * depth / self.conductivity

        best = {"indicated": self.indicated, "flux": self.flux, "depth": self.depth}
        spread = {name: getattr(self, f"u_{name}") for name in best}
        return _propagate(value, best, spread)
