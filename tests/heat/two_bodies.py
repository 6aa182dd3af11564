"""Two bodies in sliding contact whose temperatures agree at every point, by boundary elements.

What Blok's formula and its Peclet correction are held against. Lengths in half widths, Peclet
number Pe = v B/a.
"""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.materials import Material
from thermogear.heat.moving_source import _SHAPES


def kernel_integral(distance: Floats, peclet: float) -> Floats:
    """int_0^x exp(Pe t/2) K_0(Pe |t|/2) dt, closed form (Jaeger)."""
    from scipy.special import k0e, k1e

    z = 0.5 * peclet * np.abs(distance)
    safe = np.where(z > 0.0, z, 1.0)
    ahead = safe * (k0e(safe) + k1e(safe)) - 1.0
    behind = 1.0 + safe * np.exp(-2.0 * safe) * (k0e(safe) - k1e(safe))
    signed = np.where(distance > 0.0, ahead, -behind)
    return np.asarray(np.where(z > 0.0, 2.0 / peclet * signed, 0.0))


def exact_two_body(
    *,
    peclet_1: float,
    peclet_2: float,
    distribution: str = "ellipse",
    conductivity_ratio: float = 1.0,
    elements: int = 400,
) -> tuple[float, float]:
    """Two moving flanks whose temperatures agree at every point: (T_max k_1/Q [-], share of 1).

    Boundary elements of constant heat, graded towards both edges; the heat of each element is
    split so that both half-planes have one surface temperature at its centre.

    ``peclet_1``, ``peclet_2`` > 0, ``conductivity_ratio`` k_2/k_1. With 400 elements the
    maximum is right to 1e-4.
    """
    edges = -np.cos(np.linspace(0.0, np.pi, elements + 1))
    centres = 0.5 * (edges[1:] + edges[:-1])
    width = np.diff(edges)
    heat = _SHAPES[distribution]((1.0 - centres) * (1.0 + centres))
    heat = heat / np.sum(heat * width)

    def influence(peclet: float) -> Floats:
        reach = kernel_integral(centres[:, None] - edges[None, :], peclet)
        return (reach[:, :-1] - reach[:, 1:]) / np.pi

    one, two = influence(peclet_1), influence(peclet_2) / conductivity_ratio
    first = np.linalg.solve(one + two, two @ heat)
    return float(np.max(one @ first)), float(np.sum(first * width))


def exact_flash(
    *,
    friction: float,
    line_load: float,
    speed_1: float,
    speed_2: float,
    half_width: float,
    material_1: Material,
    material_2: Material,
) -> float:
    """Flash temperature [K] of two such bodies.

    A flank at rest is the limit of a very slow one: it takes next to no heat.
    """
    one, two = material_1.thermal_conductivity, material_2.thermal_conductivity
    peclets = [
        max(
            speed * half_width * body.density * body.specific_heat / body.thermal_conductivity, 1e-8
        )
        for speed, body in ((speed_1, material_1), (speed_2, material_2))
    ]
    peak, _ = exact_two_body(peclet_1=peclets[0], peclet_2=peclets[1], conductivity_ratio=two / one)
    return friction * line_load * abs(speed_1 - speed_2) / one * peak
