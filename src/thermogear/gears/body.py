"""Compliance of the gear body under its teeth: Sainsot's polynomial for a single tooth."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import ValidityWarning
from thermogear.gears.geometry import Gear

# Columns A..F of X* = A/th^2 + B h^2 + C h/th + D/th + E h + F
SAINSOT = {
    "L": (-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045),
    "M": (60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086),
    "P": (-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236),
    "Q": (-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904),
}
_RATIO_RANGE = (1.4, 7.0)
_ANGLE_RANGE = (0.01, 0.12)
# the reference gear of the literature lies at 0.1205, so the edge is not sharp
_ANGLE_MARGIN = 1.05


def sainsot_coefficients(theta_f: float, *, ratio: float) -> dict[str, float]:
    """L*, M*, P*, Q* for the foot half angle ``theta_f`` [rad] and h = r_f/r_bore.

    >>> f"{sainsot_coefficients(0.1, ratio=3.0)['L']:.3f}"
    '6.903'
    """
    return {
        name: a / theta_f**2 + b * ratio**2 + c * ratio / theta_f + d / theta_f + e * ratio + f
        for name, (a, b, c, d, e, f) in SAINSOT.items()
    }


def sainsot_compliance(
    gear: Gear,
    t: ArrayLike,
    modulus: ArrayLike | None = None,
    face_width: float | None = None,
) -> NDArray[np.float64]:
    """Deflection of the tooth's foundation per unit normal force, 1/k_f [m/N].

    1/k_f = cos^2(beta)/(b E) {L* (u_f/S_f)^2 + M* (u_f/S_f) + P* (1 + Q* tan^2 beta)},
    u_f = r_b/cos(beta) - r_f, S_f = 2 r_f theta_f, beta = t - theta_b.

    t: tan of the pressure angle at the loaded point, any shape; modulus: E [Pa], default the
    material's; face_width: b [m], default the gear's. Warns (ValidityWarning) outside
    1.4 <= h <= 7 or 0.01 <= theta_f <= 0.12, the ranges commonly quoted, by more than 5 % of
    the angle. Neighbouring teeth are not coupled.
    Source: Sainsot, Velex & Duverger 2004, J. Mech. Des. 126, 748.

    >>> gear = Gear(40, 4e-3, bore_radius=20e-3)
    >>> f"{1e9 * sainsot_compliance(gear, math.tan(math.radians(20))):.3f} um/kN"
    '1.490 um/kN'
    """
    theta_f, ratio = gear.root_half_angle, gear.root_radius / gear.bore_radius
    if not (
        _RATIO_RANGE[0] <= ratio <= _RATIO_RANGE[1]
        and _ANGLE_RANGE[0] <= theta_f <= _ANGLE_RANGE[1] * _ANGLE_MARGIN
    ):
        warnings.warn(
            f"foundation of the gear with {gear.teeth} teeth: r_f/r_bore = {ratio:.3f}, "
            f"theta_f = {theta_f:.4f} rad; range of the source 1.4 .. 7, 0.01 .. 0.12 rad",
            ValidityWarning,
            stacklevel=2,
        )
    c = sainsot_coefficients(theta_f, ratio=ratio)
    beta = np.asarray(t, dtype=float) - gear.base_half_angle
    cosine = np.cos(beta)
    lever = (gear.base_radius / cosine - gear.root_radius) / (2.0 * gear.root_radius * theta_f)
    young = np.asarray(gear.material.youngs_modulus if modulus is None else modulus, dtype=float)
    width = gear.face_width if face_width is None else face_width
    shape = c["L"] * lever**2 + c["M"] * lever + c["P"] * (1.0 + c["Q"] * np.tan(beta) ** 2)
    return np.asarray(cosine**2 * shape / (young * width))
