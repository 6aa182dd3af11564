"""The boundary-value problem behind the law of convection of a rotating face, solved."""

from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp

from thermogear.base.arrays import Floats
from thermogear.heat.convection import rotating_disc_flow

FAR = 24.0
"""Thickness of the layer [sqrt(nu/omega)]: the flow decays as exp(-0.884 z)."""


@cache
def rotating_disc() -> Any:
    def slope(z: Floats, y: Floats) -> Floats:  # F, F', G, G', H
        f, df, g, dg, h = y
        return np.vstack([df, f**2 - g**2 + h * df, dg, 2.0 * f * g + h * dg, -2.0 * f])

    def ends(near: Floats, far: Floats) -> Floats:
        return np.array([near[0], near[2] - 1.0, near[4], far[0], far[2]])

    z = np.linspace(0.0, FAR, 241)
    decay = np.exp(-0.9 * z)
    guess = np.vstack([0.5 * z * decay, 0.5 * decay, decay, -0.6 * decay, -0.88 * (1 - decay)])
    solved = solve_bvp(slope, ends, z, guess, tol=1e-9, max_nodes=50000)
    assert solved.success, solved.message
    return solved.sol


@cache
def rotating_disc_gradient(prandtl: float, *, exponent: float) -> float:
    """-theta'(0) of the energy equation over a rotating disc [-].

    theta'' = Pr (m F theta + H theta'),  theta(0) = 1, theta -> 0; the wall's excess
    temperature goes as r^m. The logarithmic slope p = -theta'/theta obeys
    p' = p^2 + Pr H p - Pr m F and is integrated from the far field, where p = Pr |H|, to the
    wall: stable for every Pr. Then h = k sqrt(omega/nu) p(0).
    """
    flow = rotating_disc()

    def slope(back: float, p: Floats) -> Floats:
        f, _, _, _, h = flow(FAR - back)
        return np.asarray(-(p**2 + prandtl * h * p - prandtl * exponent * f))

    solved = solve_ivp(
        slope,
        (0.0, FAR),
        [prandtl * rotating_disc_flow()[2]],
        method="LSODA",
        rtol=1e-9,
        atol=1e-11,
    )
    found = float(solved.y[0, -1])
    assert solved.success, solved.message
    assert found > 0.0
    return found
