"""Flank deformation as the thesis has it: the repaired reading, and what is printed.

``thesis_...`` functions take the smallest repair that closes the units; ``..._as_printed``
evaluates the print literally in SI, for the errata and one picture, and feeds nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.gears.geometry import Gear
from thermogear.heat.expansion import RadialField, base_circle_growth
from thermogear.heat.expansion import radial_displacement as _radial_displacement


def _stretch(gear: Gear, field: RadialField, radius: Floats) -> Floats:
    """lambda int_{r_b}^{r} tau dr [m]: free radial stretch from the base circle."""
    rx, rb = field.bore_radius, gear.base_radius

    def primitive(at: ArrayLike) -> Floats:
        r = np.asarray(at, dtype=float)
        return np.asarray(field.bore_rise * r + field.gradient * (r * np.log(r / rx) - r))

    return np.asarray(gear.material.thermal_expansion * (primitive(radius) - primitive(rb)))


def thesis_flank_growth(gear: Gear, field: RadialField, radius: ArrayLike) -> Floats:
    """The thesis's Delta f of one flank with its first term read as a length [m].

    Delta f = lambda tau (cos(alpha_k)/2) [s r_k/r - 2 r_k (inv alpha_k - inv alpha)]
              + lambda int_{r_b}^{r_k} tau dr / cos(alpha_k).

    The bracket is the tooth thickness 2 r_k psi(r_k) at r_k; the second term is the stretch
    along the flank as printed; u_b does not appear. ``radius`` r_k [m] >= r_b. Shape of field
    and radius. Too small by a factor 2 to 4 against :func:`expansion.flank_growth`.

    >>> from thermogear.heat.expansion import RadialField
    >>> field = RadialField.uniform(
    ...     bore_radius=16e-3, tip_radius=44e-3, temperature=393.15, reference=293.15
    ... )
    >>> f"{1e6 * thesis_flank_growth(Gear(20, 4e-3), field, 40e-3):.2f} um"
    '6.35 um'
    """
    r = np.asarray(radius, dtype=float)
    cosine = np.minimum(gear.base_radius / r, 1.0)
    thickness = r * gear.half_thickness_angle(r) * cosine
    own = gear.material.thermal_expansion * field.rise(r) * thickness
    return np.asarray(own + _stretch(gear, field, r) / cosine)


def thesis_half_backlash(
    half_backlash: ArrayLike, *, deformation_1: ArrayLike, deformation_2: ArrayLike
) -> Floats:
    """b' = (2 b - Delta f1 - Delta f2)/2 [m], as printed.

    ``half_backlash`` b [m], ``deformation_1``, ``_2`` [m]. No housing, and the flanks' growth
    is halved: right only if Delta f meant both flanks of a tooth together.

    >>> b = thesis_half_backlash(60e-6, deformation_1=20e-6, deformation_2=10e-6)
    >>> f"{1e6 * b:.1f} um"
    '45.0 um'
    """
    lost = np.asarray(deformation_1, dtype=float) + np.asarray(deformation_2)
    return np.asarray(0.5 * (2.0 * np.asarray(half_backlash) - lost))


def flank_growth_as_printed(
    gear: Gear, field: RadialField, radius: ArrayLike, *, thickness_at: ArrayLike | None = None
) -> Floats:
    """Delta f exactly as printed, in SI: a pure number plus a length; feeds nothing.

    lambda tau/(r_k cos alpha_k) [s_k - 2 r_k (inv alpha_k - inv alpha)]
    + lambda int_{r_b}^{r_k} tau dr/cos(alpha_k).

    ``radius`` r_k [m]. s_k is read as the thickness on the pitch circle, the only reading
    under which the bracket is not counted twice; ``thickness_at`` another radius [m], as r_k
    itself, which is what the symbol says.
    """
    r = np.asarray(radius, dtype=float)
    cosine = np.minimum(gear.base_radius / r, 1.0)
    at = gear.pitch_radius if thickness_at is None else np.asarray(thickness_at, dtype=float)
    bracket = 2.0 * at * gear.half_thickness_angle(at) - 2.0 * r * _involute_difference(gear, r)
    number = gear.material.thermal_expansion * field.rise(r) / (r * cosine) * bracket
    return np.asarray(number + _stretch(gear, field, r) / cosine)


def _involute_difference(gear: Gear, radius: Floats) -> Floats:
    """inv(alpha_k) - inv(alpha) = psi(r) - psi(r_k) [rad], r the pitch circle."""
    at_pitch = gear.half_thickness_angle(gear.pitch_radius)
    return np.asarray(at_pitch - gear.half_thickness_angle(radius))


def profile_as_printed(
    gear: Gear, field: RadialField, radius: ArrayLike, bore: str = "free"
) -> tuple[Floats, Floats]:
    """The deformed profile exactly as printed: (r'_k [m], theta'_k [rad]).

    r' = r_k + lambda int_{r_b}^{r_k} tau dr + u_b,
    theta' = theta_k - lambda [inv alpha_k - inv alpha] [r_k - r]/(r_k cos alpha_k).

    theta_k = psi(r_k) from the tooth centre line, u_b = u_r(r_b), r the pitch circle. The second
    term of theta' lacks the temperature (its unit is 1/K); it is drawn, never fed on.
    """
    r = np.asarray(radius, dtype=float)
    cosine = np.minimum(gear.base_radius / r, 1.0)
    moved = r + _stretch(gear, field, r) + base_circle_growth(gear, field, bore)
    turn = _involute_difference(gear, r) * (r - gear.pitch_radius) / (r * cosine)
    angle = gear.half_thickness_angle(r) - gear.material.thermal_expansion * turn
    return np.asarray(moved), np.broadcast_to(angle, moved.shape).copy()


def deformed_profile(
    gear: Gear, field: RadialField, radius: ArrayLike, bore: str = "free"
) -> tuple[Floats, Floats]:
    """The deformed profile, repaired: (r' [m], theta' [rad] from the tooth centre line).

    r' = r + u_r(r),   theta' = psi + psi (lambda tau - u_r/r).

    ``radius`` r [m] >= r_b. A uniform field scales the profile: theta' = psi, r' = r (1 +
    lambda tau). Shape of field and radius.

    >>> from thermogear.heat.expansion import RadialField
    >>> field = RadialField.uniform(
    ...     bore_radius=16e-3, tip_radius=44e-3, temperature=393.15, reference=293.15
    ... )
    >>> radius, angle = deformed_profile(Gear(20, 4e-3), field, 40e-3)
    >>> f"{1e3 * radius:.3f} mm, {angle:.5f} rad"
    '40.046 mm, 0.07854 rad'
    """
    r = np.asarray(radius, dtype=float)
    return deformed_points(gear, field, r, gear.half_thickness_angle(r), bore)


def deformed_points(
    gear: Gear,
    field: RadialField,
    radius: ArrayLike,
    angle: ArrayLike,
    bore: str = "free",
) -> tuple[Floats, Floats]:
    """Where points of a tooth go: (r' [m], theta' [rad] from the tooth centre line).

    r' = r + u_r(r),   theta' = theta + theta (lambda tau - u_r/r).

    ``radius`` r [m] from the root circle up, ``angle`` theta [rad] from the tooth centre line: the
    growth of :func:`deformed_profile` at any place of the tooth. Shape of field and radius.

    >>> from thermogear.heat.expansion import RadialField
    >>> field = RadialField.uniform(
    ...     bore_radius=16e-3, tip_radius=44e-3, temperature=393.15, reference=293.15
    ... )
    >>> radius, angle = deformed_points(Gear(20, 4e-3), field, 40e-3, 0.05)
    >>> f"{1e3 * radius:.3f} mm, {angle:.3f} rad"
    '40.046 mm, 0.050 rad'
    """
    r, theta = np.asarray(radius, dtype=float), np.asarray(angle, dtype=float)
    body = gear.material
    moved = _radial_displacement(
        field,
        r,
        root_radius=gear.root_radius,
        expansion=body.thermal_expansion,
        poisson=body.poisson_ratio,
        bore=bore,
    )
    turned = theta + theta * (body.thermal_expansion * field.rise(r) - moved / r)
    return np.asarray(r + moved), np.asarray(turned)
