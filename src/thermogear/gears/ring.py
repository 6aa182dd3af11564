"""The gear body as a clamped ring: deflection of one tooth's foot under its own load and others'.

Plane stress annulus, held at the bore r_x, loaded on its rim R = r_f by the foot of a tooth
over |phi| <= theta_f. Each Fourier order of rim traction is solved exactly (Michell); the
displacement is the one conjugate to the load in energy, so that the compliance between two
teeth is reciprocal. Because the ring is one body, a tooth also moves under the load of its
neighbours: that coupling is what the textbook sum lacks.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.gears.geometry import Gear

HARMONICS = 1500
_MATES = 6  # farthest coupled teeth, in pitches
_FAR = 1e-20  # of the rim's motion reaches the bore: not a bit of it


def rim_compliance(
    orders: ArrayLike, *, outer: float, inner: float, poisson: float
) -> tuple[Floats, Floats, Floats]:
    """Rim displacement of a clamped annulus under rim tractions of circular order n >= 1.

    Tractions sigma_r = P cos(n phi), tau = Q sin(n phi) give u = (g_rr P + g_rt Q) cos(n phi)
    and v = (g_rt P + g_tt Q) sin(n phi), multiplied by R/E. Per order the field is the sum of
    four Michell solutions (u, v) = (A cos, B sin) r^p, p = n - 1, n + 1, 1 - n, -1 - n; for
    n = 1 the third coincides with the rigid body's and the logarithm takes its place.

    orders: n, integers >= 1, one axis; outer, inner: R > r_x [m]; poisson: nu, plane stress.
    Returns (g_rr, g_rt, g_tt), each of shape (n,).
    Source: Timoshenko & Goodier, Theory of Elasticity, sec. 43; checked against a boundary
    value solver.

    >>> radial, _, _ = rim_compliance([2], outer=35e-3, inner=15e-3, poisson=0.3)
    >>> f"{radial[0]:.3f}"
    '0.635'
    """
    n = np.asarray(orders, dtype=float)
    nu, mu = poisson, 0.5 * (1.0 - poisson)
    half = 0.5 * n * (1.0 + nu)
    one = np.ones_like(n)
    power = np.stack([n - 1.0, n + 1.0, 1.0 - n, -1.0 - n], axis=-1)
    a = np.stack([one, half + nu - 1.0, half + 1.0 - nu, one], axis=-1)
    b = np.stack([-one, -(half + 2.0), half - 2.0, one], axis=-1)
    b[:, 2] = half - 2.0
    ratio = inner / outer
    # falling powers are normed at the bore and rising ones at the rim: no overflow
    at_rim = np.stack([one, one, ratio ** np.abs(n - 1.0), ratio ** (n + 1.0)], axis=-1)
    at_bore = np.stack([ratio ** np.abs(n - 1.0), ratio ** (n + 1.0), one, one], axis=-1)
    # stresses at the rim times R (1 - nu^2)/E
    strain_t = a + n[:, None] * b
    sigma = (power * a + nu * strain_t) * at_rim
    tau = mu * ((power - 1.0) * b - n[:, None] * a) * at_rim
    u_rim, v_rim = a * at_rim, b * at_rim
    u_bore, v_bore = a * at_bore, b * at_bore
    first = np.nonzero(n == 1.0)[0]
    for i in first:
        # u = ln(r/R), v = -ln(r/R) + d
        d = -(1.0 + nu) / (3.0 - nu)
        logarithm = np.log(ratio)
        u_rim[i, 2], v_rim[i, 2] = 0.0, d
        u_bore[i, 2], v_bore[i, 2] = logarithm, -logarithm + d
        sigma[i, 2] = 1.0 + nu * d
        tau[i, 2] = -mu * (1.0 + d)
    deep = np.asarray(ratio ** np.abs(n - 1.0) < _FAR)
    weights = np.zeros((n.size, 4, 2))
    near = ~deep
    system = np.stack([u_bore[near], v_bore[near], sigma[near], tau[near]], axis=1)
    loads = np.zeros((system.shape[0], 4, 2))
    loads[:, 2, 0] = loads[:, 3, 1] = 1.0 - nu**2
    weights[near] = np.linalg.solve(system, loads)
    # of high orders nothing reaches the bore: the two rising solutions of the full disc alone
    s0, s1, t0, t1 = sigma[deep, 0], sigma[deep, 1], tau[deep, 0], tau[deep, 1]
    scale = (1.0 - nu**2) / (s0 * t1 - s1 * t0)
    weights[deep, :2] = (
        np.stack([t1, -s1, -t0, s0], axis=1).reshape(-1, 2, 2) * scale[:, None, None]
    )
    u = np.einsum("nk,nkl->nl", u_rim, weights)
    v = np.einsum("nk,nkl->nl", v_rim, weights)
    return u[:, 0], 0.5 * (u[:, 1] + v[:, 0]), v[:, 1]


@lru_cache(maxsize=64)
def _foot_matrices(
    teeth: int, outer: float, inner: float, theta_f: float, poisson: float, harmonics: int
) -> tuple[Floats, Floats]:
    """Energy of the three foot loads of one tooth on those of another, times E (unit width).

    Loads: uniform pressure p0, uniform shear q, linear pressure p1 phi, each scaled to a unit
    radial force, unit tangential force and unit moment over R. Returns the table
    [mate, load, load] for teeth ``mate - _MATES`` pitches ahead, and the tangential order
    n = 0 (the hub's wind-up) apart.
    """
    n = np.arange(1, harmonics + 1)
    g_rr, g_rt, g_tt = rim_compliance(n, outer=outer, inner=inner, poisson=poisson)
    width = 2.0 * outer * theta_f
    flat = np.sin(n * theta_f) / (np.pi * n) / width
    tilt = (
        -1j
        / np.pi
        * (np.sin(n * theta_f) / n**2 - theta_f * np.cos(n * theta_f) / n)
        / (outer * 2.0 * theta_f**3 / 3.0)
    )
    zero = np.zeros_like(flat)
    radial = np.stack([flat + 0j, zero + 0j, tilt])  # sigma_r of the three loads, exp(i n phi)
    shear = np.stack([zero, flat, zero]) + 0j
    # sin(n phi) = Re(-i exp(i n phi)): the mixed terms turn by a right angle
    u = outer * (g_rr * radial + 1j * g_rt * shear)
    v = outer * (-1j * g_rt * radial + g_tt * shear)
    energy = np.conj(radial)[:, None] * u + np.conj(shear)[:, None] * v
    angle = n * (2.0 * np.pi / teeth) * np.arange(_MATES + 1)[:, None]
    even = np.einsum("mn,ijn->mij", np.cos(angle), energy.real)
    odd = np.einsum("mn,ijn->mij", np.sin(angle), energy.imag)
    table = 4.0 * np.pi * outer * np.concatenate([(even + odd)[:0:-1], even - odd])
    # order 0: radial breathing and torsion of the clamped ring
    mean = theta_f / np.pi / width
    ratio2 = (inner / outer) ** 2
    breathing = outer * (1.0 - poisson**2) * (1.0 - ratio2)
    breathing /= 1.0 + poisson + (1.0 - poisson) * ratio2
    torsion = outer * (1.0 + poisson) * (1.0 / ratio2 - 1.0)
    table[:, 0, 0] += 2.0 * np.pi * outer * mean**2 * breathing
    return table, np.asarray(2.0 * np.pi * outer * mean**2 * torsion)


def foot_load(gear: Gear, t: ArrayLike) -> Floats:
    """Radial force, tangential force and moment/R on the foot by a unit force at ``t``.

    (-sin(beta), r_b/R, -(r_b - R cos(beta))/R), R = r_f: the tangential share
    cos(beta)(1 + u_f/R) = r_b/R alone balances the moment about the gear's axis; the linear
    pressure carries cos(beta) u_f. Shape of ``t`` with a last axis of 3.

    >>> foot_load(Gear(40, 4e-3), math.tan(math.radians(20))).round(3)
    array([-0.305,  1.002, -0.05 ])
    """
    beta = np.asarray(t, dtype=float) - gear.base_half_angle
    lever = gear.base_radius / gear.root_radius
    cosine = np.cos(beta)
    return np.stack([-np.sin(beta), np.full_like(beta, lever), cosine - lever], axis=-1)


def body_matrices(
    gear: Gear, windup: bool = True, harmonics: int = HARMONICS
) -> tuple[Floats, int]:
    """E b times the compliance between foot loads of teeth 0, 1, 2.. pitches apart.

    Returns (table, centre): table[centre + j] couples the displacement of a tooth
    j pitches ahead (in the direction of its tangential load) with the load of tooth 0.
    ``windup`` False leaves out the rotation of the rim against the clamped bore (order 0 of
    the shear), which a lumped model gives to the body's inertia.

    >>> table, centre = body_matrices(Gear(40, 4e-3))
    >>> table.shape, centre
    ((13, 3, 3), 6)
    """
    table, torsion = _foot_matrices(
        gear.teeth,
        gear.root_radius,
        gear.bore_radius,
        gear.root_half_angle,
        gear.material.poisson_ratio,
        harmonics,
    )
    if windup:
        table = table.copy()
        table[:, 1, 1] += torsion
    return table, _MATES


def ring_compliance(
    gear: Gear,
    t: ArrayLike,
    *,
    other: ArrayLike | None = None,
    pitches: int = 0,
    modulus: ArrayLike | None = None,
    face_width: float | Floats | None = None,
    windup: bool = True,
) -> Floats:
    """Deflection [m/N] at a tooth loaded at ``t`` by a unit force on a tooth ``pitches`` behind.

    The clamped ring's energy between the two foot loads. other: tan of the pressure angle of
    the force on that tooth, default ``t``; pitches: how many pitches the deflected tooth is
    ahead of the loaded one, in the direction of the tangential load, |pitches| <= 6; modulus:
    E of the body [Pa], default the material's; face_width: b [m]; windup: see
    :func:`body_matrices`. Symmetric under exchange: C(t1, t2, j) = C(t2, t1, -j).
    Plane stress; the ring holds for r_bore < r_f, thin rims included.

    >>> gear = Gear(40, 4e-3)
    >>> t = math.tan(math.radians(20))
    >>> f"{1e9 * ring_compliance(gear, t):.3f} um/kN"
    '1.050 um/kN'
    """
    table, centre = body_matrices(gear, windup)
    at = foot_load(gear, t)
    by = at if other is None else foot_load(gear, other)
    young = np.asarray(gear.material.youngs_modulus if modulus is None else modulus, dtype=float)
    width = gear.face_width if face_width is None else face_width
    energy = np.einsum("...a,ab,...b->...", at, table[centre + pitches], by)
    return np.asarray(energy / (young * width))
