"""Approach of two flanks in line contact: Hertzian laws by three sources.

The load-sharing solver has each of them in compiled form; the functions say the formulas.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

CONTACT_LAWS = {
    "weber-banaschek": "logarithmic, depth to each tooth's axis",
    "yang-sun": "linear, independent of load",
    "palmgren": "roller on plane, F^0.9",
}
PALMGREN_EXPONENT = 0.9


def yang_sun_stiffness(modulus: ArrayLike, face_width: ArrayLike) -> Floats:
    """Linear contact stiffness of a pair, k_h = pi E* b/2 [N/m].

    modulus: E* [Pa] with 1/E* = sum (1 - nu_i^2)/E_i; face_width: b [m]. For equal materials
    pi E b/(4 (1 - nu^2)). Independent of load and position.
    Source: Yang & Sun 1985, J. Mech. Trans. Autom. 107, 529.

    >>> f"{1e-9 * yang_sun_stiffness(115e9, 20e-3):.2f} GN/m"
    '3.61 GN/m'
    """
    return np.asarray(0.5 * np.pi * np.asarray(modulus) * np.asarray(face_width), dtype=float)


def weber_approach(
    force: ArrayLike,
    *,
    depth: ArrayLike,
    half_width: ArrayLike,
    modulus: ArrayLike,
    poisson: float,
    face_width: float | Floats,
) -> Floats:
    """Approach [m] of one flank to its tooth's axis under a Hertzian line load.

    delta_i = F 2 (1 - nu^2)/(pi E b) [ arsinh(eta) - nu/(1 - nu) eta (sqrt(1 + eta^2) - eta) ],
    eta = h_i/a: the strain of the half plane under Hertz's pressure down to the depth h_i.

    For a << h_i it is Weber and Banaschek's ln(2 h_i/a) - nu/(2 (1 - nu)), from which it departs
    by (a/h_i)^2/4. That form turns negative near a thin tip, where h_i < 0.6 a; the whole
    integral is >= 0 and rises with the force, 0 where the tooth has no depth left.

    force: F [N] >= 0 of the tooth pair; depth: h_i = x_p/cos(beta) >= 0 [m], from the contact
    along the force to the tooth axis; half_width: a [m] of the contact; modulus, poisson: of
    this gear; face_width: b [m]. The pair's approach is the sum over its two teeth. Any shapes;
    zero load gives 0 (F ln a -> 0). Plane strain near the contact.
    Source: Weber & Banaschek 1953; the stresses under the line contact Johnson, eq. 4.46.

    >>> approach = weber_approach(
    ...     4e3, depth=4e-3, half_width=0.15e-3, modulus=210e9, poisson=0.3, face_width=20e-3
    ... )
    >>> f"{1e6 * approach:.2f} um"
    '2.08 um'
    """
    f, a = np.asarray(force, dtype=float), np.asarray(half_width, dtype=float)
    loaded = f > 0.0
    eta = np.asarray(depth, dtype=float) / np.where(loaded, a, 1.0)
    # sqrt(1 + eta^2) - eta without the difference
    narrow = 1.0 / (np.hypot(1.0, eta) + eta)
    bracket = np.arcsinh(eta) - poisson / (1.0 - poisson) * eta * narrow
    scale = 2.0 * (1.0 - poisson**2) / (np.pi * np.asarray(modulus, dtype=float) * face_width)
    return np.asarray(np.where(f == 0.0, 0.0, f * scale * bracket))


def palmgren_approach(force: ArrayLike, modulus: ArrayLike, face_width: ArrayLike) -> Floats:
    """Approach [m] of a roller pair, delta = 3.81 (1/(pi E*))^0.9 F^0.9/b^0.8.

    force: F [N] >= 0; modulus: E* [Pa]; face_width: b [m]. For steel on steel the familiar
    3.84e-5 F^0.9/b^0.8 (N, mm). Zero load gives 0. Empirical, for bearing rollers.
    Source: Palmgren 1959, Ball and Roller Bearing Engineering.

    >>> f"{1e6 * palmgren_approach(4e3, 115e9, 20e-3):.2f} um"
    '6.02 um'
    """
    f = np.asarray(force, dtype=float)
    scale = (1.0 / (np.pi * np.asarray(modulus, dtype=float))) ** PALMGREN_EXPONENT
    return np.asarray(3.81 * scale * f**PALMGREN_EXPONENT / np.asarray(face_width) ** 0.8)
