"""The load distribution of a rolling bearing in closed form, as textbooks print it."""

from __future__ import annotations

import numpy as np

from thermogear.base.gauss import gauss


def load_zone_integral(zone: float, *, exponent: float) -> float:
    """Sjovall's J_r = (1/2 pi) int (1 - (1 - cos psi)/(2 eps))^n cos psi d psi [-].

    ``zone`` eps = (1 - c_r/x)/2, 0.5 without clearance; ``exponent`` n. Over the loaded elements.
    F = Z K (x - c_r)^n J_r.
    """
    half = np.arccos(np.clip(1.0 - 2.0 * zone, -1.0, 1.0))
    nodes, weights = gauss(200)
    psi = half * nodes
    deep = np.maximum(1.0 - (1.0 - np.cos(psi)) / (2.0 * zone), 0.0)
    return float(half * np.sum(weights * deep**exponent * np.cos(psi)) / (2.0 * np.pi))
