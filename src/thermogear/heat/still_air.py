"""What a warm wall gives to still air and to the walls of the room around it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.units import STANDARD_GRAVITY

STEFAN_BOLTZMANN = 5.670374e-8
"""sigma [W/(m^2 K^4)], CODATA."""
EMISSIVITY = 0.9
"""Of a painted or cast housing [-]; paints of any colour are 0.85 to 0.95."""
AIR_HEAT, AIR_GAS, AIR_PRESSURE = 1005.0, 287.05, 101325.0
"""c_p [J/(kg K)], gas constant [J/(kg K)] and pressure [Pa] of air."""


def free_face_convection(
    difference: ArrayLike,
    height: ArrayLike,
    viscosity: ArrayLike,
    conductivity: ArrayLike,
    prandtl: ArrayLike,
    *,
    expansion: ArrayLike,
) -> NDArray[np.float64]:
    """Heat transfer coefficient of a vertical face by free convection, its mean [W/(m^2 K)].

    h = (k/L) {0.825 + 0.387 Ra^(1/6)/[1 + (0.492/Pr)^(9/16)]^(8/27)}^2,
    Ra = g beta |dT| L^3 Pr/nu^2.

    ``difference`` dT [K] of face and fluid (either sign), ``height`` L [m], ``viscosity`` nu
    [m^2/s], ``conductivity`` k [W/(m K)] and ``prandtl`` Pr [-] of the fluid, ``expansion`` beta
    [1/K]. Any shape; 0.681 k/L where nothing drives a flow. Made for Ra 0.1..1e12, all Pr; up to
    a third above the laminar similarity solution near Ra 1e8. Source: Churchill and Chu 1975, as
    Bergman, Lavine, Incropera and DeWitt print it.

    >>> h = free_face_convection(40.0, 80e-3, 50e-6, 0.13, 700.0, expansion=0.7e-3)
    >>> f"{h:.1f} W/(m^2 K)"
    '102.1 W/(m^2 K)'
    """
    drop, tall, nu, k, pr, beta = (
        np.asarray(a, dtype=float)
        for a in (difference, height, viscosity, conductivity, prandtl, expansion)
    )
    rayleigh = STANDARD_GRAVITY * beta * np.abs(drop) * tall**3 * pr / nu**2
    shape = (1.0 + (0.492 / pr) ** (9.0 / 16.0)) ** (8.0 / 27.0)
    return np.asarray(k / tall * (0.825 + 0.387 * rayleigh ** (1.0 / 6.0) / shape) ** 2)


def still_air_coefficient(
    wall: ArrayLike, *, ambient: ArrayLike, height: ArrayLike
) -> NDArray[np.float64]:
    """Heat transfer coefficient of a wall in still air, convection and radiation [W/(m^2 K)].

    h = h_free(|T - T_0|, L) + eps sigma (T^2 + T_0^2)(T + T_0),

    h_free of :func:`free_face_convection` with air at (T + T_0)/2, beta = 1/that; eps 0.9.
    ``wall`` T, ``ambient`` T_0 [K] of air and room alike, ``height`` L [m]; any shapes. Viscosity
    and conductivity of air by the formulas of the U.S. Standard Atmosphere of 1976 (recalled;
    within 1 % of printed tables from 300 to 500 K).

    >>> f"{still_air_coefficient(333.15, ambient=293.15, height=0.3):.1f} W/(m^2 K)"
    '11.5 W/(m^2 K)'
    """
    hot, cold = np.asarray(wall, dtype=float), np.asarray(ambient, dtype=float)
    film = 0.5 * (hot + cold)
    viscosity = 1.458e-6 * film**1.5 / (film + 110.4)
    conductivity = 2.64638e-3 * film**1.5 / (film + 245.4 * 10.0 ** (-12.0 / film))
    free = free_face_convection(
        hot - cold,
        height,
        viscosity * AIR_GAS * film / AIR_PRESSURE,
        conductivity,
        viscosity * AIR_HEAT / conductivity,
        expansion=1.0 / film,
    )
    return np.asarray(free + EMISSIVITY * STEFAN_BOLTZMANN * (hot**2 + cold**2) * (hot + cold))
