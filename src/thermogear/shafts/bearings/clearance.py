"""Clearance of a bearing: as delivered, as mounted on its shaft and in its housing, and hot.

Trap: catalogues give the play G_r, the whole way from side to side; the laws take half
of it, c_r = G_r/2. Radial internal clearance, after ISO 5753-1, is the whole play G_r.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError, require_choice
from thermogear.base.materials import Material
from thermogear.shafts.bearings.geometry import RollingBearing

CLASSES = ("C2", "CN", "C3", "C4")
_BORES = {
    "ball": (10, 18, 24, 30, 40, 50, 65, 80, 100),
    "roller": (0, 30, 40, 50, 65, 80, 100),
}
_PLAY = {
    "ball": (
        ((0, 9), (3, 18), (11, 25), (18, 33)),
        ((0, 10), (5, 20), (13, 28), (20, 36)),
        ((1, 11), (5, 20), (13, 28), (23, 41)),
        ((1, 11), (6, 20), (15, 33), (28, 46)),
        ((1, 11), (6, 23), (18, 36), (30, 51)),
        ((1, 15), (8, 28), (23, 43), (38, 61)),
        ((1, 15), (10, 30), (25, 51), (46, 71)),
        ((1, 18), (12, 36), (30, 58), (53, 84)),
    ),
    "roller": (
        ((0, 25), (20, 45), (35, 60), (50, 75)),
        ((5, 30), (25, 50), (45, 70), (60, 85)),
        ((5, 35), (30, 60), (50, 80), (70, 100)),
        ((10, 40), (40, 70), (60, 90), (80, 110)),
        ((10, 45), (40, 75), (65, 100), (90, 125)),
        ((15, 50), (50, 85), (75, 110), (105, 140)),
    ),
}


def class_clearance(kind: str, bore: float, name: str) -> tuple[float, float]:
    """Least and greatest play G_r [m] of a clearance class, as delivered.

    ``kind`` "ball" (deep groove) or "roller" (cylindrical), ``bore`` [m] over 10 mm and up to
    100 mm, ``name`` C2, CN, C3 or C4. Source: ISO 5753-1 by makers' tables.

    >>> [round(1e6 * g) for g in class_clearance("ball", 25e-3, "CN")]
    [5, 20]
    """
    require_choice("clearance_class", name, CLASSES)
    borders = _BORES[kind]
    row = int(np.searchsorted(borders, 1e3 * bore - 1e-9)) - 1
    if not (0 <= row < len(_PLAY[kind]) and (kind == "roller" or bore >= 10e-3)):
        raise InputError(
            "clearance_class",
            f"a bore of {1e3 * bore:.6g} mm",
            allowed=f"{borders[0]}..{borders[-1]} mm",
            fix='give the play itself: clearance = "12 um"',
        )
    low, high = _PLAY[kind][row][CLASSES.index(name)]
    return 1e-6 * low, 1e-6 * high


@dataclass(frozen=True, kw_only=True)
class Fit:
    """The fits of a bearing's rings (SI): interference > 0, play < 0, both on the diameter.

    ``shaft_bore`` of a hollow shaft (0: solid), ``housing_outside`` diameter of the housing around
    the ring (None: thick). ``materials`` of ring, shaft and housing.
    """

    ring: Material
    shaft: Material
    housing: Material
    shaft_interference: float = 0.0
    housing_interference: float = 0.0
    shaft_bore: float = 0.0
    housing_outside: float | None = None


def ring_growth(
    *,
    inner: float,
    fit: float,
    outer: float,
    within: Material,
    around: Material,
    seen: str,
) -> float:
    """Change of a ring's free diameter per interference on the diameter [-].

    Two rings by Lame: the inner part from ``inner`` to ``fit``, the outer from ``fit`` to
    ``outer`` [m], of materials ``within`` and ``around``. ``seen`` "outer": growth of the outer
    part's outer diameter, as an inner ring on its shaft; "inner": shrinkage of the inner part's
    inner diameter, as an outer ring in its housing. With one material k (1 - k0^2)/(1 - k^2 k0^2)
    and h (1 - h0^2)/(1 - h^2 h0^2).
    """
    if not 0.0 <= inner < fit < outer:
        raise InputError(
            "fit",
            " / ".join(f"{1e3 * one:.6g}" for one in (inner, fit, outer)) + " mm",
            allowed="bore < seat < outside",
            why="one ring lies within the other",
        )
    hole, wall = inner / fit, fit / outer
    # radial compliance of each part at the fit, u = p fit/2 times these
    inside = ((1.0 + hole**2) / (1.0 - hole**2) - within.poisson_ratio) / within.youngs_modulus
    outside = ((1.0 + wall**2) / (1.0 - wall**2) + around.poisson_ratio) / around.youngs_modulus
    pressure = 1.0 / (inside + outside)
    if seen == "outer":
        return float(pressure * 2.0 * wall / ((1.0 - wall**2) * around.youngs_modulus))
    return float(pressure * 2.0 * hole / ((1.0 - hole**2) * within.youngs_modulus))


def mounted_clearance(
    bearing: RollingBearing,
    play: float,
    fit: Fit,
    temperatures: ArrayLike,
    *,
    shaft_temperature: ArrayLike,
    housing_temperature: ArrayLike,
    reference: float,
) -> NDArray[np.float64]:
    """Half c_r [m] of the play of a mounted bearing, cold or hot, (...).

    ``play`` G_r [m] as delivered; ``temperatures`` (..., 3) [K] of inner ring, elements and outer
    ring, ``shaft_temperature`` and ``housing_temperature`` [K] at the seats; ``reference`` [K].
    Raceways and elements grow as circles; each fit loses or gains what shaft or housing grow
    otherwise than their ring; an interference moves the raceway by :func:`ring_growth`, a loose
    ring does not.
    """
    inner, element, outer = np.moveaxis(np.asarray(temperatures, dtype=float) - reference, -1, 0)
    own = fit.ring.thermal_expansion
    free = thermal_clearance(
        inner_raceway=bearing.inner_raceway,
        outer_raceway=bearing.inner_raceway + 2.0 * bearing.element_diameter + play,
        element_diameter=bearing.element_diameter,
        expansions=(own, own, own),
        temperatures=np.stack([inner, element, outer], axis=-1),
    )
    shaft = np.asarray(shaft_temperature, dtype=float) - reference
    housing = np.asarray(housing_temperature, dtype=float) - reference
    on = fit.shaft_interference + bearing.bore * (fit.shaft.thermal_expansion * shaft - own * inner)
    held = fit.housing_interference + bearing.outside_diameter * (
        own * outer - fit.housing.thermal_expansion * housing
    )
    widened = ring_growth(
        inner=fit.shaft_bore,
        fit=bearing.bore,
        outer=bearing.inner_raceway,
        within=fit.shaft,
        around=fit.ring,
        seen="outer",
    )
    shrunk = ring_growth(
        inner=bearing.outer_raceway,
        fit=bearing.outside_diameter,
        outer=np.inf if fit.housing_outside is None else fit.housing_outside,
        within=fit.ring,
        around=fit.housing,
        seen="inner",
    )
    lost = widened * np.maximum(on, 0.0) + shrunk * np.maximum(held, 0.0)
    return np.asarray(free - 0.5 * lost)


def thermal_clearance(
    *,
    inner_raceway: float,
    outer_raceway: float,
    element_diameter: float,
    expansions: tuple[float, float, float],
    temperatures: ArrayLike,
) -> NDArray[np.float64]:
    """c = (F_o (1 + a_o dT_o) - F_i (1 + a_i dT_i) - 2 D_w (1 + a_b dT_b))/2 [m], (...).

    Diameters [m] at the reference; ``expansions`` [1/K] and ``temperatures`` (..., 3), rises over
    the reference [K], of inner ring, elements and outer ring. Radial contact (no contact angle).
    A uniform rise of one material scales c by 1 + a dT.

    >>> c = thermal_clearance(
    ...     inner_raceway=46.5e-3, outer_raceway=65.52e-3, element_diameter=9.5e-3,
    ...     expansions=(12.5e-6,) * 3, temperatures=(70.0, 62.0, 50.0),
    ... )
    >>> f"{1e6 * c:.3f} um"
    '2.769 um'
    """
    inner, element, outer = np.moveaxis(np.asarray(temperatures, dtype=float), -1, 0)
    a_i, a_b, a_o = expansions
    return np.asarray(
        0.5
        * (
            outer_raceway * (1.0 + a_o * outer)
            - inner_raceway * (1.0 + a_i * inner)
            - 2.0 * element_diameter * (1.0 + a_b * element)
        )
    )
