"""Heat transfer from a rotating face: the von Karman flow, its energy equation, and drag.

The usual gear formula 0.308 sqrt(m+2) sqrt(Pr) holds for a gas with T ~ r^2; for oils it is 60
to 135 % high. Here the similarity equations are solved, once per Prandtl number.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_bvp, solve_ivp

from thermogear.base.errors import ConvergenceError, InputError

Floats = NDArray[np.float64]

__all__ = [
    "disc_nusselt",
    "disc_torque",
    "rotating_disc_flow",
    "rotating_disc_gradient",
    "rotating_face_convection",
]

TRANSITION = 2.5e5
"""Reynolds number omega r^2/nu at which the flow over a rotating face is taken turbulent."""

_FAR = 24.0  # thickness of the layer in sqrt(nu/omega): the flow decays as exp(-0.884 z)
_PRANDTL = (0.05, 2e6)


@cache
def rotating_disc_flow() -> tuple[float, float, float]:
    """(F'(0), G'(0), -H(inf)) of the flow over an infinite rotating disc [-].

    F'' = F^2 - G^2 + H F',  G'' = 2 F G + H G',  H' = -2 F; F(0) = H(0) = 0, G(0) = 1,
    F, G -> 0. Known values 0.51023, -0.61592, 0.88447. Source: von Karman 1921.
    """
    _, wall, inflow = _flow()
    return wall[0], wall[1], inflow


@cache
def _flow() -> tuple[object, tuple[float, float], float]:
    def slope(z: Floats, y: Floats) -> Floats:  # F, F', G, G', H
        f, df, g, dg, h = y
        return np.vstack([df, f**2 - g**2 + h * df, dg, 2.0 * f * g + h * dg, -2.0 * f])

    def ends(near: Floats, far: Floats) -> Floats:
        return np.array([near[0], near[2] - 1.0, near[4], far[0], far[2]])

    z = np.linspace(0.0, _FAR, 241)
    decay = np.exp(-0.9 * z)
    guess = np.vstack([0.5 * z * decay, 0.5 * decay, decay, -0.6 * decay, -0.88 * (1 - decay)])
    solved = solve_bvp(slope, ends, z, guess, tol=1e-9, max_nodes=50000)
    if not solved.success:
        raise ConvergenceError(f"flow over a rotating disc: {solved.message}")
    wall = float(solved.sol(0.0)[1]), float(solved.sol(0.0)[3])
    return solved.sol, wall, float(-solved.sol(_FAR)[4])


@cache
def rotating_disc_gradient(prandtl: float, *, exponent: float) -> float:
    """-theta'(0) of the energy equation over a rotating disc [-].

    theta'' = Pr (m F theta + H theta'),  theta(0) = 1, theta -> 0; the wall's excess
    temperature goes as r^m. The logarithmic slope p = -theta'/theta obeys
    p' = p^2 + Pr H p - Pr m F and is integrated from the far field, where p = Pr |H|, to the
    wall: stable for every Pr. Then h = k sqrt(omega/nu) p(0).

    ``prandtl`` 0.05..2e6, ``exponent`` m >= 0. Raises outside.
    """
    if not _PRANDTL[0] <= prandtl <= _PRANDTL[1]:
        raise InputError("prandtl", prandtl, allowed=f"{_PRANDTL[0]} .. {_PRANDTL[1]:g}")
    if not exponent >= 0.0:
        raise InputError("exponent", exponent, allowed=">= 0")
    flow, _, inflow = _flow()

    def slope(back: float, p: Floats) -> Floats:
        f, _, _, _, h = flow(_FAR - back)  # type: ignore[operator]
        return np.asarray(-(p**2 + prandtl * h * p - prandtl * exponent * f))

    solved = solve_ivp(
        slope, (0.0, _FAR), [prandtl * inflow], method="LSODA", rtol=1e-9, atol=1e-11
    )
    found = float(solved.y[0, -1])
    if not (solved.success and found > 0.0):
        raise ConvergenceError(f"rotating disc, Pr = {prandtl:g}: {found:g}, {solved.message}")
    return found


@cache
def _gradient_table(exponent: float) -> Chebyshev:
    """ln(-theta'(0)) over ln Pr: smooth, so that a low degree gives six digits."""

    def logarithm(ln_pr: Floats) -> Floats:
        values = [
            np.log(rotating_disc_gradient(float(np.exp(p)), exponent=exponent)) for p in ln_pr
        ]
        return np.asarray(values)

    ends = [np.log(_PRANDTL[0]), np.log(_PRANDTL[1])]
    return Chebyshev.interpolate(logarithm, 26, domain=ends)


def disc_nusselt(prandtl: ArrayLike, *, exponent: float = 2.0) -> Floats:
    """Nu/sqrt(Re) of a laminar rotating face [-], for arrays of Prandtl numbers.

    ``prandtl`` Pr [-] 0.1..1e6 of any shape, ``exponent`` m of the wall's excess temperature
    ~ r^m (0 uniform, 2 growing towards the rim). Interpolates
    :func:`rotating_disc_gradient` to better than 1e-5. Grows as Pr^(1/3)
    for large Pr; m = 2, Pr = 1 is the Reynolds analogy, -G'(0) = 0.61592.
    """
    pr = np.asarray(prandtl, dtype=float)
    if not np.all((pr >= 0.1) & (pr <= 1e6)):
        raise InputError("prandtl", f"{pr.min():.3g} .. {pr.max():.3g}", allowed="0.1 .. 1e6")
    return np.asarray(np.exp(_gradient_table(float(exponent))(np.log(pr))))


def rotating_face_convection(
    speed: ArrayLike,
    radius: ArrayLike,
    viscosity: ArrayLike,
    conductivity: ArrayLike,
    prandtl: ArrayLike,
    *,
    exponent: float = 2.0,
) -> Floats:
    """Heat transfer coefficient of a rotating face at ``radius`` [W/(m^2 K)].

    Laminar, Re = omega r^2/nu < 2.5e5, the similarity solution, and turbulent beyond:

    h = Nu_0(Pr, m) k sqrt(omega/nu),
    h = 0.0197 (m + 2.6)^0.2 Re^0.8 Pr^0.6 k/r.

    ``speed`` omega [rad/s], ``radius`` r [m], ``viscosity`` nu [m^2/s], ``conductivity`` k
    [W/(m K)], ``prandtl`` Pr [-], ``exponent`` m. Any shape; 0 at rest. The fluid is what
    covers the face: pure oil for a dipped gear, less for a mist. The turbulent law is
    confirmed at m = 2, Pr = 1, where heat and angular momentum obey one equation: von Karman's
    torque 0.073 Re^-0.2 gives 0.0267 Re^0.8, as it does; its Pr^0.6 is the usual exponent.
    """
    omega, r, nu, k, pr = (
        np.asarray(a, dtype=float) for a in (speed, radius, viscosity, conductivity, prandtl)
    )
    reynolds = omega * r**2 / nu
    laminar = disc_nusselt(pr, exponent=exponent) * np.sqrt(reynolds)
    turbulent = 0.0197 * (exponent + 2.6) ** 0.2 * reynolds**0.8 * pr**0.6
    return np.asarray(k / r * np.where(reynolds < TRANSITION, laminar, turbulent))


def disc_torque(
    speed: ArrayLike,
    radius: ArrayLike,
    density: ArrayLike,
    viscosity: ArrayLike,
    immersion: ArrayLike = 2.0,
) -> Floats:
    """Drag torque on both faces of a disc dipped into a liquid [N m].

    dM = 2 tau(r) r (wetted arc) dr over both faces, tau = 0.61592 rho sqrt(nu omega^3) r
    (laminar, von Karman's flow), for Re = omega R^2/nu > 2.5e5
    tau = 0.0267 rho (omega r)^2 Re_r^-0.2 (his turbulent law, C_M = 0.146 Re^-0.2 for both
    faces).

    ``speed`` omega [rad/s], ``radius`` R [m] outer, ``density`` rho [kg/m^3], ``viscosity`` nu
    [m^2/s], ``immersion`` depth over R: 0 dry, 2 fully under. Any shape. Raises outside 0..2. A
    simple churning loss: no teeth, no splash, no walls near by.
    """
    omega, big, rho, nu, depth = (
        np.asarray(a, dtype=float) for a in (speed, radius, density, viscosity, immersion)
    )
    if not np.all((depth >= 0.0) & (depth <= 2.0)):
        raise InputError("immersion", f"{depth.min():g} .. {depth.max():g}", allowed="0 .. 2 radii")
    reynolds = omega * big**2 / nu
    swirl = -rotating_disc_flow()[1]
    laminar = 2.0 * swirl * rho * np.sqrt(nu * omega**3) * big**4 * _wetted(depth, 3.0)
    safe = np.where(reynolds > 0.0, reynolds, 1.0)
    turbulent = 2.0 * 0.0267 * rho * omega**2 * big**5 * safe**-0.2 * _wetted(depth, 3.6)
    return np.asarray(np.where(reynolds < TRANSITION, laminar, turbulent))


@cache
def _gauss(count: int) -> tuple[Floats, Floats]:
    """Nodes and weights of Gauss and Legendre on -1..1, which cost more than the rest."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return nodes, weights


def _wetted(depth: Floats, power: float) -> Floats:
    """int_0^1 (wetted angle at x) x^power dx for a unit disc dipped by ``depth``."""
    nodes, weights = _gauss(96)
    # x = 1 - (1 - a)(1 - s^2): the wetted angle starts with a root at x = a
    start = np.abs(1.0 - depth)[..., None]
    s = 0.5 * (nodes + 1.0)
    x = start + (1.0 - start) * s**2
    jacobian = (1.0 - start) * 2.0 * s * 0.5 * weights
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = np.where(x > 0.0, (1.0 - depth)[..., None] / x, 0.0)
    angle = 2.0 * np.arccos(np.clip(cosine, -1.0, 1.0))
    outer = np.sum(angle * x**power * jacobian, axis=-1)
    inner = np.where(depth > 1.0, 2.0 * np.pi * start[..., 0] ** (power + 1.0) / (power + 1.0), 0.0)
    return np.asarray(outer + inner)
