"""Elastohydrodynamic film: pressure-viscosity, thickness formulas, film parameter, regime.

Throughout, with E' twice the Hertz modulus E* and the entrainment speed v_e = (v1+v2)/2,

E' = 2/[(1-nu1^2)/E1 + (1-nu2^2)/E2],
U = eta v_e/(E' R), G = alpha E', W = w/(E' R).

The published formulas spread by about 14 % among themselves and the pressure-viscosity by
about 15 % in thickness: no film is known better than that.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.base.materials import Lubricant
from thermogear.base.units import ZERO_CELSIUS
from thermogear.base.vocabulary import REGIMES
from thermogear.heat.lubrication import dynamic_viscosity, kinematic_viscosity

RMS_OF_MEAN_ROUGHNESS = 1.25
"""Rq over Ra. A Gaussian surface has sqrt(pi/2) = 1.2533, a sine 1.1107."""


def rms_roughness(roughness: ArrayLike) -> NDArray[np.float64]:
    """Rq = 1.25 Ra, the root mean square from the arithmetic mean roughness [m].

    ``roughness`` Ra [m], any shape. Exact to 0.3 % for Gaussian heights, which ground and run
    flanks roughly have. Source: the mean of the absolute value of a normal variable is
    sqrt(2/pi) of its standard deviation.

    >>> f"{1e6 * rms_roughness(0.4e-6):.2f} um"
    '0.50 um'
    """
    return np.asarray(RMS_OF_MEAN_ROUGHNESS * np.asarray(roughness, dtype=float))


FILM_UNCERTAINTY = 0.15
"""Relative uncertainty of a film thickness from its pressure-viscosity coefficient."""

_GOLD = {  # s, t of alpha = s nu^t 1e-9, nu in mm^2/s
    "mineral": (9.904, 0.1390),
    "pao": (7.382, 0.1335),
    "pag": (5.489, 0.1485),
    "ester": (6.605, 0.1360),
}
_ISO = {  # c, e of alpha_38 = c eta_38^e, eta in Pa s
    "mineral": (2.657e-8, 0.1348),
    "pao": (1.466e-8, 0.0507),
    "pag": (1.392e-8, 0.1572),
}


def _of_kind(kind: str, table: dict[str, tuple[float, float]], law: str) -> tuple[float, float]:
    require_choice("lubricant.kind", kind, table, f"{law} has no constants for it")
    return table[kind]


def pressure_viscosity_gold(viscosity: ArrayLike, kind: str = "mineral") -> Floats:
    """Pressure-viscosity coefficient by Gold, alpha = s nu^t 1e-9 [1/Pa], nu in mm^2/s.

    ``viscosity`` nu [m^2/s] at the temperature wanted, any shape; ``kind`` of base oil. Raises
    for an unknown kind. 25 % low on the mean against 38 measured mineral values.
    Source: Gold's constants as printed in public gear codes, assigned by magnitude.

    >>> f"{1e9 * pressure_viscosity_gold(100e-6):.1f} 1/GPa"
    '18.8 1/GPa'
    """
    s, t = _of_kind(kind, _GOLD, "Gold's formula")
    nu = np.asarray(viscosity, dtype=float) * 1e6
    return np.asarray(s * nu**t * 1e-9)


def pressure_viscosity_iso(
    viscosity_38: ArrayLike, temperature: ArrayLike, kind: str = "mineral"
) -> Floats:
    """Pressure-viscosity coefficient [1/Pa] by ISO/TR 15144-1.

    alpha = alpha_38 [1 + 516 (1/T - 1/311)],  alpha_38 = c eta_38^e, eta in Pa s, T in K.

    ``viscosity_38`` eta [Pa s] at 38 C, ``temperature`` [K], ``kind`` mineral, pao or pag.
    Any shape. Source: ISO/TR 15144-1 eq. 8-11. 24 % low on the mean against 38 measured
    mineral values: the film is uncertain by about 15 %. 0 above 781 K, where the bracket
    would turn negative, far outside any oil's life.

    >>> f"{1e9 * pressure_viscosity_iso(0.1, 311.0):.1f} 1/GPa"
    '19.5 1/GPa'
    """
    c, e = _of_kind(kind, _ISO, "ISO/TR 15144-1")
    alpha_38 = c * np.asarray(viscosity_38, dtype=float) ** e
    bracket = 1.0 + 516.0 * (1.0 / np.asarray(temperature, dtype=float) - 1.0 / 311.0)
    return np.asarray(alpha_38 * np.maximum(bracket, 0.0))


def pressure_viscosity(lubricant: Lubricant, temperature: ArrayLike) -> Floats:
    """alpha [1/Pa] of an oil at ``temperature`` [K]: ISO/TR 15144-1, for esters Gold.

    >>> oil = lubricant("FVA3")
    >>> f"{1e9 * pressure_viscosity(oil, 353.15):.1f} 1/GPa"
    '15.6 1/GPa'
    """
    if lubricant.kind in _ISO:
        eta_38 = dynamic_viscosity(lubricant, ZERO_CELSIUS + 38.0)
        return pressure_viscosity_iso(eta_38, temperature, lubricant.kind)
    return pressure_viscosity_gold(kinematic_viscosity(lubricant, temperature), lubricant.kind)


def _groups(
    line_load: ArrayLike,
    entrainment: ArrayLike,
    viscosity: ArrayLike,
    coefficient: ArrayLike,
    reduced_radius: ArrayLike,
    modulus: ArrayLike,
) -> tuple[Floats, Floats, Floats, Floats]:
    w, ve, eta, alpha, radius, e = (
        np.asarray(a, dtype=float)
        for a in (line_load, entrainment, viscosity, coefficient, reduced_radius, modulus)
    )
    return (
        np.asarray(eta * ve / (e * radius)),
        np.asarray(alpha * e),
        np.asarray(w / (e * radius)),
        radius,
    )


def _power_law(
    radius: Floats, speed: Floats, rest: Floats, load: Floats, u: float, w: float
) -> Floats:
    """radius * rest * U^u * W^-w: 0 at rest, unbounded without load."""
    loaded = np.where(load > 0.0, load, 1.0)
    thickness = radius * rest * speed**u * loaded**-w
    return np.asarray(np.where((load > 0.0) | (speed == 0.0), thickness, np.inf))


def dowson_higginson_minimum(
    line_load: ArrayLike,
    entrainment: ArrayLike,
    viscosity: ArrayLike,
    coefficient: ArrayLike,
    reduced_radius: ArrayLike,
    modulus: ArrayLike,
) -> Floats:
    """Least film of a line contact by Dowson and Higginson [m].

    h_min = 2.65 R U^0.70 G^0.54 W^-0.13.

    ``line_load`` w [N/m], ``entrainment`` v_e [m/s], ``viscosity`` eta [Pa s] at the flank's
    temperature, ``coefficient`` alpha [1/Pa], ``reduced_radius`` R [m], ``modulus`` E' [Pa]. Any
    shape; 0 at rest, infinite without load. Isothermal and fully flooded, elastic and
    piezoviscous. Source: Dowson and Higginson, line contact.

    >>> h = dowson_higginson_minimum(200e3, 5.0, 0.02, 15e-9, 10e-3, 230e9)
    >>> f"{1e6 * h:.3f} um"
    '0.406 um'
    """
    u, g, w, radius = _groups(
        line_load, entrainment, viscosity, coefficient, reduced_radius, modulus
    )
    return _power_law(radius, u, np.asarray(2.65 * g**0.54), w, 0.70, 0.13)


def grubin_central(
    line_load: ArrayLike,
    entrainment: ArrayLike,
    viscosity: ArrayLike,
    coefficient: ArrayLike,
    reduced_radius: ArrayLike,
    modulus: ArrayLike,
) -> Floats:
    """Central film of a line contact by Grubin, h_c = 1.95 R (U G)^(8/11) W^(-1/11) [m].

    Arguments and awkward points as :func:`dowson_higginson_minimum`. Source: Grubin 1949.

    >>> f"{1e6 * grubin_central(200e3, 5.0, 0.02, 15e-9, 10e-3, 230e9):.3f} um"
    '0.497 um'
    """
    u, g, w, radius = _groups(
        line_load, entrainment, viscosity, coefficient, reduced_radius, modulus
    )
    return _power_law(radius, u, np.asarray(1.95 * g ** (8 / 11)), w, 8 / 11, 1 / 11)


def iso_15144_film(
    line_load: ArrayLike,
    entrainment: ArrayLike,
    viscosity: ArrayLike,
    coefficient: ArrayLike,
    reduced_radius: ArrayLike,
    modulus: ArrayLike,
    sliding_parameter: ArrayLike = 1.0,
) -> Floats:
    """Local film of ISO/TR 15144-1, h = 1.6 R G^0.6 U^0.7 W^-0.13 S^0.22 [m].

    Arguments as :func:`dowson_higginson_minimum`, viscosity and alpha at the gear's bulk
    temperature; ``sliding_parameter`` S [-] = alpha eta at the contact temperature over alpha
    eta at the bulk temperature (1 without sliding). Source: ISO/TR 15144-1 eq. 4 (1600 with R in
    mm and h in um; its W = 2 pi p^2/E'^2 is the same group).

    >>> f"{1e6 * iso_15144_film(200e3, 5.0, 0.02, 15e-9, 10e-3, 230e9):.3f} um"
    '0.399 um'
    """
    u, g, w, radius = _groups(
        line_load, entrainment, viscosity, coefficient, reduced_radius, modulus
    )
    rest = 1.6 * g**0.6 * np.asarray(sliding_parameter, dtype=float) ** 0.22
    return _power_law(radius, u, np.asarray(rest), w, 0.70, 0.13)


FilmLaw = Callable[[ArrayLike, ArrayLike, ArrayLike, ArrayLike, ArrayLike, ArrayLike], Floats]
FILM_LAWS: dict[str, FilmLaw] = {
    "dowson-higginson": dowson_higginson_minimum,
    "grubin": grubin_central,
    "iso-15144": iso_15144_film,
}


def film_thickness(
    line_load: ArrayLike,
    entrainment: ArrayLike,
    viscosity: ArrayLike,
    coefficient: ArrayLike,
    reduced_radius: ArrayLike,
    modulus: ArrayLike,
    law: str = "dowson-higginson",
    thermal_factor: ArrayLike = 1.0,
) -> Floats:
    """Film thickness by a named law, times its thermal factor [m].

    ``law`` out of :data:`FILM_LAWS`, ``thermal_factor`` of :func:`thermal_reduction`, the rest as
    :func:`dowson_higginson_minimum`. Raises for an unknown law with the nearest name. Expect
    15 % from the pressure-viscosity and 14 % between the laws.

    >>> h = film_thickness(200e3, 5.0, 0.02, 15e-9, 10e-3, 230e9, law="grubin", thermal_factor=0.9)
    >>> f"{1e6 * h:.3f} um"
    '0.447 um'
    """
    require_choice("film law", law, FILM_LAWS)
    film = FILM_LAWS[law](line_load, entrainment, viscosity, coefficient, reduced_radius, modulus)
    return np.asarray(film * np.asarray(thermal_factor))


def thermal_reduction(
    entrainment: ArrayLike,
    slide_roll_ratio: ArrayLike,
    viscosity: ArrayLike,
    walther_slope: ArrayLike,
    conductivity: ArrayLike,
) -> Floats:
    """Factor by which shear heating of the inlet thins the film [-], 0 < phi <= 1.

    phi = 1/{1 + 0.1 [1 + 14.8 S^0.83] L^0.64},  L = beta eta (v1+v2)^2/k_oil.

    ``entrainment`` v_e [m/s] (the sum v1+v2 = 2 v_e enters L), ``slide_roll_ratio`` S [-],
    ``viscosity`` eta [Pa s], ``walther_slope`` beta [1/K], ``conductivity`` of the oil
    [W/(m K)]. Any shape; 1 at rest. With the mean speed the factor is 0.1 * 4^0.64 = 0.243: the
    two printed forms are one. Source: inlet-shear factor of public gear and contact codes.

    >>> f"{thermal_reduction(10.0, 0.5, 0.02, 0.03, 0.13):.3f}"
    '0.420'
    """
    total = 2.0 * np.asarray(entrainment, dtype=float)
    heating = np.asarray(walther_slope) * np.asarray(viscosity) * total**2
    heating = heating / np.asarray(conductivity)
    sliding = 1.0 + 14.8 * np.asarray(slide_roll_ratio, dtype=float) ** 0.83
    return np.asarray(1.0 / (1.0 + 0.1 * sliding * heating**0.64))


def film_parameter(
    thickness: ArrayLike, *, roughness_1: ArrayLike, roughness_2: ArrayLike
) -> Floats:
    """Lambda = h_min/sqrt(Rq1^2 + Rq2^2) [-].

    ``thickness`` [m], ``roughness_1``, ``roughness_2`` rms Rq [m] (from Ra by
    :func:`~thermogear.heat.film.rms_roughness`). Any shape. Raises when both flanks are
    given as perfectly smooth.

    >>> f"{film_parameter(1e-6, roughness_1=0.3e-6, roughness_2=0.4e-6):.2f}"
    '2.00'
    """
    both = np.hypot(np.asarray(roughness_1, dtype=float), np.asarray(roughness_2, dtype=float))
    if not np.all(both > 0.0):
        raise InputError("roughness", both.min(), allowed="> 0 m on one flank at least")
    return np.asarray(np.asarray(thickness) / both)


def mean_roughness_film_parameter(
    thickness: ArrayLike, *, roughness_1: ArrayLike, roughness_2: ArrayLike
) -> Floats:
    """lambda = h_c/[(Ra1 + Ra2)/2], the film parameter of Doleschel's share [-].

    ``thickness`` [m] central and thinned by shear heating of the inlet, ``roughness_1``,
    ``roughness_2`` mean roughness Ra [m]. Any shape. Raises when both flanks are given as
    perfectly smooth. 1.7 to 2.3 times :func:`film_parameter` of the same contact on gears from
    0.5 to 50 m/s: 1.25 sqrt(2) from the roughness of equal flanks, the rest from Grubin's central
    against Dowson and Higginson's least film. Source: Arana, Larranaga and Ulacia, Proc. IMechE
    J 233 (2019) 303-316, table 1; public FZG code forms it alike.

    >>> f"{mean_roughness_film_parameter(1e-6, roughness_1=0.3e-6, roughness_2=0.5e-6):.2f}"
    '2.50'
    """
    mean = 0.5 * (np.asarray(roughness_1, dtype=float) + np.asarray(roughness_2, dtype=float))
    if not np.all(mean > 0.0):
        raise InputError("roughness", mean.min(), allowed="> 0 m on one flank at least")
    return np.asarray(np.asarray(thickness) / mean)


def regime(film_parameter: ArrayLike) -> NDArray[np.int64]:
    """Lubrication regime as an index into :data:`REGIMES` (0 to 3).

    ``film_parameter`` Lambda [-], any shape; boundary below 1, full elastohydrodynamic film from 3
    on, mixed between: the customary limits. Infinite Lambda is a pair that carries nothing:
    unloaded.

    >>> [REGIMES[place] for place in regime([0.5, 2.0, 4.0])]
    ['boundary', 'mixed', 'elastohydrodynamic']
    """
    thickness = np.asarray(film_parameter, dtype=float)
    if np.any(np.isnan(thickness)):
        raise InputError("film parameter", "nan", allowed="a number, or inf without load")
    index = np.digitize(thickness, [1.0, 3.0, np.inf])
    return np.asarray(index, dtype=np.int64)


def regime_shares(film_parameter: ArrayLike) -> Floats:
    """Share of the path (the last axis) spent in each of :data:`REGIMES` [-].

    ``film_parameter`` Lambda (..., position), positions evenly spaced. Returns (..., 4), each
    row adding up to 1.

    >>> regime_shares([0.5, 2.0, 2.5, 4.0])
    array([0.25, 0.5 , 0.25, 0.  ])
    """
    index = regime(film_parameter)
    return np.stack([np.mean(index == k, axis=-1) for k in range(len(REGIMES))], axis=-1)
