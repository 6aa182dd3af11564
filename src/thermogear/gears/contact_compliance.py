"""Approach of two flanks in line contact: Hertzian laws by three sources."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def yang_sun_stiffness(modulus: ArrayLike, face_width: ArrayLike) -> Floats:
    """Linear contact stiffness of a pair, k_h = pi E* b/2 [N/m].

    modulus: E* [Pa] with 1/E* = sum (1 - nu_i^2)/E_i; face_width: b [m]. For equal materials
    pi E b/(4 (1 - nu^2)). Independent of load and position.
    Source: Yang & Sun 1985, J. Mech. Trans. Autom. 107, 529.
    """
    return np.asarray(0.5 * np.pi * np.asarray(modulus) * np.asarray(face_width), dtype=float)
