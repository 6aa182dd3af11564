"""Tooth as a cantilever of the true profile: bending, shear and axial compliance.

Tooth frame: origin at the gear centre, y along the tooth axis. The force acts at the
involute point of parameter t = tan(alpha_k), under the angle beta = t - theta_b to the
normal of the tooth axis.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.gears.geometry import Gear

STARTS = {
    "root-circle": "from the bottom of the fillet, as most published curves",
    "30-degree": "from the section whose fillet tangent makes 30 deg with the tooth axis",
}
SHEAR_FACTOR = 1.2  # rectangle
CRITICAL_SLOPE = float(np.radians(30.0))
"""Tangent of the fillet to the tooth's axis [rad] at the section of ISO 6336-3."""
_FILLET_NODES = np.polynomial.legendre.leggauss(40)
_FLANK_NODES = np.polynomial.legendre.leggauss(24)
_NEAREST = 1e-9
"""Least distance, in t, of a force from the tooth's point: rounding of a tip radius."""
_DEGREE = 48


class ToothCompliances(NamedTuple):
    """1/k_b, 1/k_s, 1/k_a [m/N] of one tooth."""

    bending: Floats
    shear: Floats
    axial: Floats

    @property
    def total(self) -> Floats:
        """Sum of the three parts [m/N]."""
        return self.bending + self.shear + self.axial


class FlankPoint(NamedTuple):
    """A point of the involute in the tooth frame and the direction of its normal force."""

    x: Floats
    y: Floats
    beta: Floats


def flank_point(gear: Gear, t: ArrayLike) -> FlankPoint:
    """Half thickness x_p, height y_p [m] and force angle beta [rad] at t = tan(alpha_k).

    r_k = r_b sqrt(1 + t^2), psi = theta_b - (t - arctan t), x = r_k sin psi, y = r_k cos psi,
    beta = t - theta_b.

    Any shape.

    >>> gear = Gear(20, 4e-3)
    >>> f"{1e3 * flank_point(gear, math.tan(math.radians(20))).x:.3f} mm"
    '3.138 mm'
    """
    return _below_point(gear, gear.pointed_tangent - np.asarray(t, dtype=float))


def _below_point(gear: Gear, short: Floats) -> FlankPoint:
    """The flank's point at t = t_0 - ``short``, t_0 that of the pointed tooth.

    psi = int_t^t_0 u^2/(1 + u^2) du = short - arctan(short/(1 + t t_0)): a tooth of any thinness
    keeps its digits.
    """
    t = gear.pointed_tangent - short
    psi = short - np.arctan(short / (1.0 + t * gear.pointed_tangent))
    r = gear.base_radius * np.sqrt(1.0 + t * t)
    return FlankPoint(r * np.sin(psi), r * np.cos(psi), t - gear.base_half_angle)


def start_angle(gear: Gear, start: str) -> float:
    """Rack normal angle gamma [rad] of the section where the beam begins; see ``STARTS``.

    >>> f"{math.degrees(start_angle(Gear(20, 4e-3), '30-degree')):.1f} deg"
    '43.8 deg'
    """
    require_choice("start", start, STARTS)
    return 0.5 * np.pi if start == "root-circle" else section_angle(gear, CRITICAL_SLOPE)


def section_angle(gear: Gear, slope: float) -> float:
    """Rack normal angle gamma [rad] where the fillet's tangent makes ``slope`` [rad] with the axis.

    Where the involute begins on a tooth whose tangent is past that slope there already: a deeply
    undercut one, or one of large profile shift.

    >>> f"{math.degrees(section_angle(Gear(20, 4e-3), math.radians(10))):.1f} deg"
    '28.0 deg'
    """
    gamma = gear.junction[0]
    if gamma - float(gear.fillet.roll(gamma)) >= slope:
        return gamma
    return gear.fillet.section_at_slope(slope)


def _moments(x: Floats, y: Floats, dy: Floats, point: FlankPoint) -> tuple[Floats, Floats, Floats]:
    """The three integrals over given sections, without modulus and width.

    x, y, dy: half thickness, height and weight of the sections, last axis; the point's
    arrays carry a length-1 axis there.
    """
    cosine, sine = np.cos(point.beta), np.sin(point.beta)
    moment = cosine * (point.y - y) - sine * point.x
    bending = np.sum(1.5 * moment * moment / x**3 * dy, axis=-1)
    section = np.sum(np.broadcast_to(0.5 / x * dy, moment.shape), axis=-1)
    return bending, section * cosine[..., 0] ** 2, section * sine[..., 0] ** 2


@lru_cache(maxsize=256)
def _fillet_sections(gear: Gear, start: str) -> tuple[Floats, Floats, Floats]:
    low, high = start_angle(gear, start), gear.junction[0]
    nodes, weights = _FILLET_NODES
    gamma = 0.5 * (low + high) + 0.5 * (high - low) * nodes
    x, y = gear.fillet.point(gamma)
    return x, y, gear.fillet.height_rate(gamma) * 0.5 * (high - low) * weights


def tooth_compliances(
    gear: Gear,
    t: ArrayLike,
    start: str = "30-degree",
    modulus: ArrayLike | None = None,
    face_width: float | Floats | None = None,
) -> ToothCompliances:
    """Beam compliances of one tooth under a unit normal force on its flank [m/N].

    1/k_b = int [cos(beta)(y_p - y) - x_p sin(beta)]^2/(E I) dy,
    1/k_s = int 1.2 cos^2(beta)/(G A) dy,   1/k_a = int sin^2(beta)/(E A) dy,
    I = b (2x)^3/12,   A = 2 x b

    over fillet trochoid and involute up to the force.

    t: tan of the pressure angle at the loaded point, at or above the form circle, any shape;
    start: see :data:`STARTS`; modulus: E [Pa], default the material's, broadcasts with t;
    face_width: b [m], default the gear's. Returns the broadcast shape, nan where t is nan.
    Raises InputError for an unknown start and for a t beyond the point in which the flanks meet.

    Towards that point bending and shear grow as the logarithm of the thickness that is left, as
    the line-loaded wedge of elasticity does: finite on every tooth with a tip land, and taken
    1e-9 (in t) short of the point itself. With body and contact it is within 3 % of finite
    elements, as near to a tip of 1e-3 modules as a contact fits.
    Slender-beam theory on a stub: the sum with body and contact is meant.
    Source: Weber 1949; Weber & Banaschek 1953; Yang & Sun 1985.

    >>> parts = tooth_compliances(Gear(20, 4e-3), math.tan(math.radians(20)))
    >>> f"{1e9 * parts.bending:.2f} um/kN"
    '0.10 um/kN'
    """
    short = gear.pointed_tangent - np.asarray(t, dtype=float)[..., None]
    if np.any(short < -_NEAREST):
        raise InputError(
            "t",
            f"{gear.pointed_tangent - float(np.nanmin(short)):g}",
            allowed=f"<= {gear.pointed_tangent:g}",
            why="the tooth ends in a point there",
        )
    short = np.maximum(short, _NEAREST)
    point = _below_point(gear, short)
    bending, shear, axial = _moments(*_fillet_sections(gear, start), point)

    # flank sections from the force to the form circle, their distances from the tooth's point
    # equally split in logarithm: 1/x there is steepest
    nodes, weights = _FLANK_NODES
    half = 0.5 * np.log((gear.pointed_tangent - gear.junction[1]) / short)
    away = short * np.exp(half * (1.0 + nodes))
    section = _below_point(gear, away)
    # dy/dt = r_b t cos(t - theta_b)
    rate = gear.base_radius * (gear.pointed_tangent - away) * np.cos(section.beta)
    more = _moments(section.x, section.y, rate * away * half * weights, point)

    young = np.asarray(gear.material.youngs_modulus if modulus is None else modulus, dtype=float)
    stiff = young * (gear.face_width if face_width is None else face_width)
    shear_ratio = SHEAR_FACTOR * 2.0 * (1.0 + gear.material.poisson_ratio)
    return ToothCompliances(
        (bending + more[0]) / stiff,
        shear_ratio * (shear + more[1]) / stiff,
        (axial + more[2]) / stiff,
    )


def unit_compliance(gear: Gear, t: ArrayLike, start: str = "30-degree") -> Floats:
    """Total of :func:`tooth_compliances` for unit modulus and width, from a stored series.

    A Chebyshev series of degree 48 in the logarithm of the distance from the tooth's point,
    where the compliance is smooth however thin the tip: within 1e-9 of the integrals down to
    tips of 1e-4 modules. ``t`` is clipped to the flank, form circle to tip. Shape of ``t``.

    >>> gear = Gear(20, 4e-3)
    >>> f"{unit_compliance(gear, math.tan(math.radians(20))):.2f}"
    '2.24'
    """
    series, (low, high) = _unit_series(gear, start)
    away = gear.pointed_tangent - np.asarray(t, dtype=float)
    x = (2.0 * np.log(np.clip(away, np.exp(low), np.exp(high))) - low - high) / (high - low)
    return np.asarray(chebyshev.chebval(x, series))


@lru_cache(maxsize=256)
def _unit_series(gear: Gear, start: str) -> tuple[Floats, tuple[float, float]]:
    """Coefficients and the range of ln(t_0 - t) from tip to form circle."""
    lowest, tip = gear.junction[1], float(np.tan(gear.pressure_angle_at(gear.tip_radius)))
    low, high = np.log([max(gear.pointed_tangent - tip, _NEAREST), gear.pointed_tangent - lowest])
    nodes = chebyshev.chebpts1(_DEGREE + 1)
    t = gear.pointed_tangent - np.exp(0.5 * (low + high) + 0.5 * (high - low) * nodes)
    values = tooth_compliances(gear, t, start, modulus=1.0, face_width=1.0).total
    series = np.asarray(chebyshev.chebfit(nodes, values, _DEGREE), dtype=float)
    return series, (float(low), float(high))
