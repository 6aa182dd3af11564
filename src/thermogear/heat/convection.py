"""Heat transfer from a rotating face: the von Karman flow, its energy equation, and drag.

The usual gear formula 0.308 sqrt(m+2) sqrt(Pr) holds for a gas with T ~ r^2; for oils it is 60
to 135 % high. Here the solution of the similarity equations is kept over the Prandtl number.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.gauss import gauss

TRANSITION = (1.8e5, 3.0e5)
"""Local Reynolds numbers omega r^2/nu between which the layer on a rotating face turns turbulent.

Gregory, Stuart and Walker (1955) saw the stationary vortices of the instability appear at
1.8e5 to 2.1e5 and the layer turbulent from 2.7e5 to 3.0e5; Cobb and Saunders (1956) found the
heat transfer of a disc to rise from about 2.4e5; the absolute instability of Lingwood (1995)
lies at 507^2 = 2.6e5. All three between these ends, which are recalled, not read.
"""

SUBLAYER = 12.7
"""Temperature drop of the viscous sublayer over Pr^(2/3) - 1, in wall units (Petukhov)."""

SHEAR = 0.0267
"""Tangential wall stress of the turbulent layer over rho (omega r)^2 Re_r^-0.2 (von Karman)."""

_PRANDTL = (0.05, 2e6)
MOST_PRANDTL = 1e6
"""Greatest Prandtl number [-] that the laws below take: half of what was solved (ours)."""

_GROWING = (
    1.4687027045781436, 3.408347537616242, -0.3252285068358618, 0.1774278492101273,
    -0.08114557284919209, 0.028763239294375832, -0.004601204007153733, -0.003809739496141031,
    0.004707727876888812, -0.0029872722958170445, 0.0011141805651302076, 3.366542813057997e-05,
    -0.000435556124145134, 0.0003885895381356645, -0.0001927808156505506, 2.7526820338718704e-05,
    5.0308991999705565e-05, -5.7311733024988664e-05, 3.25295002611291e-05, -6.6398249234954095e-06,
    -7.218993328384761e-06, 9.351991788975056e-06, -5.5488811546587786e-06, 1.1159223806410945e-06,
    1.423740159183311e-06, -1.9123491558040676e-06, 1.181804204333061e-06,
)  # fmt: skip
"""Chebyshev coefficients of ln(-theta'(0)) over ln Pr, of :func:`disc_nusselt`. Solving for them
anew costs each start a fifth of a second. A test solves it."""

_TABLE = Chebyshev(_GROWING, domain=[np.log(_PRANDTL[0]), np.log(_PRANDTL[1])])

_WALL = (0.5102326187888296, -0.6159220143475946, 0.8844740855215494)
"""What :func:`rotating_disc_flow` has at the wall and far off: kept as the numbers above are."""


def rotating_disc_flow() -> tuple[float, float, float]:
    """(F'(0), G'(0), -H(inf)) of the flow over an infinite rotating disc [-].

    F'' = F^2 - G^2 + H F',  G'' = 2 F G + H G',  H' = -2 F; F(0) = H(0) = 0, G(0) = 1,
    F, G -> 0. Known values 0.51023, -0.61592, 0.88447. Source: von Karman 1921.

    >>> [round(value, 4) for value in rotating_disc_flow()]
    [0.5102, -0.6159, 0.8845]
    """
    return _WALL


def disc_nusselt(prandtl: ArrayLike) -> Floats:
    """Nu/sqrt(Re) = -theta'(0) of a laminar rotating face [-], excess temperature ~ r^2.

    theta'' = Pr (2 F theta + H theta'),  theta(0) = 1, theta -> 0, in the flow F, H of
    :func:`rotating_disc_flow`; interpolated to better than 1e-5.

    ``prandtl`` Pr [-] 0.1..1e6 of any shape. Grows as Pr^(1/3) for large Pr; Pr = 1 is the
    Reynolds analogy, -G'(0) = 0.61592.

    >>> f"{disc_nusselt(1.0):.4f}"
    '0.6159'
    """
    pr = np.asarray(prandtl, dtype=float)
    if not np.all((pr >= 0.1) & (pr <= MOST_PRANDTL)):
        raise InputError("prandtl", f"{pr.min():.3g} .. {pr.max():.3g}", allowed="0.1 .. 1e6")
    return np.asarray(np.exp(_TABLE(np.log(pr))))


def turbulent_share(reynolds: ArrayLike) -> Floats:
    """Share of the time in which the layer at ``reynolds`` is turbulent [-].

    gamma = x^2 (3 - 2 x),   x = (Re - Re_1)/(Re_2 - Re_1) held to 0..1,   Re_1, Re_2 of
    :data:`TRANSITION`.

    ``reynolds`` Re = omega r^2/nu >= 0 [-] of any shape. 0 up to Re_1 and 1 from Re_2 on,
    exactly, with a continuous slope. Between, stress and heat are the means of both layers by
    their share of time, as in boundary layers in transition (Dhawan and Narasimha 1958); the
    smooth step itself is ours, only its ends are measured.

    >>> turbulent_share([1e4, 1e7])
    array([0., 1.])
    """
    low, high = TRANSITION
    x = np.clip((np.asarray(reynolds, dtype=float) - low) / (high - low), 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))


def turbulent_nusselt(reynolds: ArrayLike, *, prandtl: ArrayLike) -> Floats:
    """Local Nusselt number h r/k of a turbulent layer on a rotating face [-].

    1/St = 1/St_1 + 12.7 (Pr^(2/3) - 1)/sqrt(c),   Nu = Re Pr St,
    St_1 = 0.0197 (2 + 2.6)^0.2 Re^-0.2,   c = 0.0267 Re^-0.2.

    ``reynolds`` Re = omega r^2/nu > 0, ``prandtl`` Pr [-] 0.5 .. 1e6, any shapes that
    broadcast. The wall's excess temperature grows as r^2. Resistances in series: the layer at
    Pr = 1, where heat obeys the equation of the swirl (Nu = 0.0267 Re^0.8, von Karman's torque),
    and what the viscous sublayer adds or saves, which knows nothing of the layer's outside. For
    large Pr it grows as Pr^(1/3).

    The customary Pr^0.6 is the slope of this at Pr = 1 alone: at Re = 3e5 it is 2.7 times too
    high at Pr = 300 and 3.7 times at Pr = 1000. The sublayer's term is Petukhov's for pipes and
    Gnielinski's for plates, 0.037 Re^0.8 Pr/[1 + 2.443 Re^-0.1 (Pr^(2/3) - 1)] (VDI Heat Atlas,
    2.443 = 12.7 sqrt(0.037)), meant for Pr 0.6 .. 2000. A mixing-length layer with an eddy
    viscosity growing as the cube of the distance (Notter and Sleicher 1971), integrated in the
    tests, agrees within 2 % for Pr 1 .. 3000; measured mass transfer into turbulent pipe flow,
    K+ = 0.0889 Sc^-0.704 (Shaw and Hanratty 1977, recalled), within 20 % for Sc 10 .. 3000.

    >>> f"{turbulent_nusselt(1e6, prandtl=1.0):.0f}"
    '1687'
    """
    re, pr = np.asarray(reynolds, dtype=float), np.asarray(prandtl, dtype=float)
    root = np.sqrt(SHEAR) * re**-0.1
    plain = 1.0 / (0.0197 * (2.0 + 2.6) ** 0.2 * re**-0.2)
    return np.asarray(re * pr / (plain + SUBLAYER * (np.cbrt(pr) ** 2 - 1.0) / root))


def rotating_face_convection(
    speed: ArrayLike,
    radius: ArrayLike,
    viscosity: ArrayLike,
    conductivity: ArrayLike,
    prandtl: ArrayLike,
) -> Floats:
    """Heat transfer coefficient of a rotating face at ``radius`` [W/(m^2 K)].

    h = k/r [ (1 - gamma) Nu_0(Pr) sqrt(Re) + gamma Nu_t(Re, Pr) ],   Re = omega r^2/nu,

    the laminar similarity solution (:func:`disc_nusselt`), the turbulent layer
    (:func:`turbulent_nusselt`), and gamma of :func:`turbulent_share` between them.

    ``speed`` omega [rad/s], ``radius`` r [m], ``viscosity`` nu [m^2/s], ``conductivity`` k
    [W/(m K)], ``prandtl`` Pr [-]. Any shape; 0 at rest. Continuous with its
    slope in every argument. A disc is laminar inside and turbulent outside: integrate over r.
    The turbulent layer is taken as if it began at the axis, as in the drag. The fluid is what
    covers the face: pure oil for a dipped gear, less for a mist.

    >>> f"{rotating_face_convection(100.0, 40e-3, 100e-6, 0.13, 1000.0):.0f} W/(m^2 K)"
    '1079 W/(m^2 K)'
    """
    omega, r, nu, k, pr = (
        np.asarray(a, dtype=float) for a in (speed, radius, viscosity, conductivity, prandtl)
    )
    reynolds = omega * r**2 / nu
    laminar = disc_nusselt(pr) * np.sqrt(reynolds)
    turbulent = turbulent_nusselt(np.maximum(reynolds, TRANSITION[0]), prandtl=pr)
    share = turbulent_share(reynolds)
    return np.asarray(k / r * ((1.0 - share) * laminar + share * turbulent))


def transition_pieces(
    speed: ArrayLike, viscosity: ArrayLike, *, inner: ArrayLike, outer: ArrayLike, nodes: int = 24
) -> tuple[Floats, Floats]:
    """Radii and weights [m] of a quadrature from ``inner`` to ``outer`` split at the transition.

    ``speed`` [rad/s], ``viscosity`` [m^2/s], ``inner`` <= ``outer`` [m], any shapes (...) that
    broadcast. Returns two arrays (..., 3 ``nodes``): Gauss's rule inside, within and outside the
    radii of :data:`TRANSITION`, clustered at the inner end of each piece, where what is
    integrated may begin with a root.

    >>> _, weight = transition_pieces(100.0, 100e-6, inner=16e-3, outer=44e-3)
    >>> f"{1e3 * weight.sum():.3f} mm"
    '28.000 mm'
    """
    omega, nu, low, high = np.broadcast_arrays(
        *(np.asarray(a, dtype=float) for a in (speed, viscosity, inner, outer))
    )
    turning = np.maximum(omega, 1e-30)  # a disc at rest is laminar all over
    turns = [np.clip(np.sqrt(re * nu / turning), low, high) for re in TRANSITION]
    ends = np.stack([low, *turns, high], axis=-1)
    u, w = gauss(nodes)
    s = 0.5 * (u + 1.0)
    length = np.diff(ends)[..., None]
    radii = ends[..., :-1, None] + length * s**2
    weights = length * (s * w)
    shape = (*low.shape, -1)
    return radii.reshape(shape), weights.reshape(shape)


def disc_torque(
    speed: ArrayLike,
    radius: ArrayLike,
    density: ArrayLike,
    viscosity: ArrayLike,
    immersion: ArrayLike = 2.0,
) -> Floats:
    """Drag torque on both faces of a disc dipped into a liquid [N m].

    dM = 2 tau(r) r (wetted arc) dr over both faces,
    tau = (1 - gamma) 0.61592 rho sqrt(nu omega^3) r + gamma 0.0267 rho (omega r)^2 Re_r^-0.2:

    von Karman's laminar flow and his turbulent law (C_M = 0.146 Re^-0.2 for both faces), gamma
    of :func:`turbulent_share` at Re_r = omega r^2/nu. So a disc is laminar inside and turbulent
    outside; far beyond the transition the all-turbulent law is approached from below, as by
    Prandtl's correction for a plate.

    ``speed`` omega [rad/s], ``radius`` R [m] outer, ``density`` rho [kg/m^3], ``viscosity`` nu
    [m^2/s], ``immersion`` depth over R: 0 dry, 2 fully under. Any shape. Raises outside 0..2. A
    simple churning loss: no teeth, no splash, no walls near by.

    >>> f"{disc_torque(100.0, 40e-3, 870.0, 100e-6):.3f} N m"
    '0.043 N m'
    """
    omega, big, rho, nu, depth = np.broadcast_arrays(
        *(np.asarray(a, dtype=float) for a in (speed, radius, density, viscosity, immersion))
    )
    if not np.all((depth >= 0.0) & (depth <= 2.0)):
        raise InputError("immersion", f"{depth.min():g} .. {depth.max():g}", allowed="0 .. 2 radii")
    # the wetted arc begins where the surface cuts the disc; a disc more than half under is wet
    # all round up to there
    start = np.abs(1.0 - depth) * big
    total = np.zeros(omega.shape)
    for low, high in ((np.zeros(start.shape), start), (start, big)):
        r, weight = transition_pieces(omega, nu, inner=low, outer=high)
        cosine = np.divide(
            ((1.0 - depth) * big)[..., None], r, out=np.full(r.shape, -1.0), where=r > 0.0
        )
        wetted = 2.0 * np.arccos(np.clip(cosine, -1.0, 1.0))
        total += np.sum(2.0 * r**3 * wetted * weight * _stress_over_r(omega, r, rho, nu), axis=-1)
    return total


def _stress_over_r(omega: Floats, r: Floats, rho: Floats, nu: Floats) -> Floats:
    """tau/r [N/m^3] of the layer in transition at radii ``r`` with one more axis."""
    omega, rho, nu = omega[..., None], rho[..., None], nu[..., None]
    reynolds = omega * r**2 / nu
    share = turbulent_share(reynolds)
    laminar = -rotating_disc_flow()[1] * rho * np.sqrt(nu * omega**3)
    turbulent = SHEAR * rho * omega**2 * r * np.maximum(reynolds, TRANSITION[0]) ** -0.2
    return np.asarray((1.0 - share) * laminar + share * turbulent)
