"""Centrifugal growth: how far a turning gear's ring and teeth are pulled outward."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.gears.geometry import Gear

POINTS = 65
"""Radii over a tooth's height at which its pull is summed up."""


def rotating_ring_displacement(
    radius: ArrayLike,
    speed: ArrayLike,
    *,
    inner_radius: float,
    outer_radius: float,
    density: float,
    modulus: float,
    poisson: float,
    rim_pull: ArrayLike = 0.0,
    bore: str = "free",
) -> Floats:
    """Radial displacement u(r) of a turning ring in plane stress [m].

    u = rho w^2 r/(8 E) [(3+nu)(1-nu)(R^2 + a^2) + (3+nu)(1+nu) a^2 R^2/r^2 - (1-nu^2) r^2]
    + p R^2/(E (R^2 - a^2)) [(1-nu) r + (1+nu) a^2/r].

    ``radius`` r and ``speed`` w [rad/s] broadcast; ``inner_radius`` a (0: a solid disc) and
    ``outer_radius`` R [m]; ``density`` rho [kg/m^3], ``modulus`` E [Pa], ``poisson`` nu;
    ``rim_pull`` p [Pa] outward on the rim. ``bore`` "free", "rigid" (u(a) = 0, the rim's stress
    unchanged) or "shaft": filled by a shaft of the same steel that turns with it, as a solid disc.

    Solid disc: u(R) = rho w^2 R^3 (1-nu)/(4 E); thin ring, a -> R: rho w^2 R^3/E. Source: plane
    elasticity of d(r sigma_r)/dr - sigma_t + rho w^2 r^2 = 0; a finite-difference solution agrees.

    >>> u = rotating_ring_displacement(
    ...     80e-3, 2618.0, inner_radius=0.0, outer_radius=80e-3, density=7850.0, modulus=206e9,
    ...     poisson=0.3,
    ... )
    >>> f"{1e6 * u:.1f} um"
    '23.4 um'
    """
    r, omega = np.asarray(radius, dtype=float), np.asarray(speed, dtype=float)
    nu, big = poisson, outer_radius
    a = 0.0 if bore == "shaft" else inner_radius

    def free(at: Floats | float) -> Floats:
        body = (3.0 + nu) * (1.0 - nu) * (big**2 + a**2) - (1.0 - nu**2) * at**2
        body = body + (3.0 + nu) * (1.0 + nu) * (a * big / at) ** 2
        rim = big**2 / (big**2 - a**2) * ((1.0 - nu) * at + (1.0 + nu) * a**2 / at)
        pulled = np.asarray(rim_pull, dtype=float) * rim
        return np.asarray((0.125 * density * omega**2 * at * body + pulled) / modulus)

    if bore != "rigid" or a == 0.0:
        return free(r)

    def held(at: Floats | float) -> Floats | float:
        return (1.0 - nu) * at + (1.0 + nu) * big**2 / at

    return np.asarray(free(r) - free(a) * held(r) / held(a))


@lru_cache(maxsize=64)
def _stretched(gear: Gear, bore: str) -> tuple[Floats, Floats]:
    """Radii [m] from root to tip circle and u/w^2 [m s^2] there."""
    r = np.linspace(gear.root_radius, gear.tip_radius, POINTS)
    # below the base circle the tooth is as wide, in angle, as there
    width = 2.0 * r * gear.half_thickness_angle(np.maximum(r, gear.base_radius))
    steel = gear.material

    def summed(values: Floats) -> Floats:
        steps = 0.5 * (values[1:] + values[:-1]) * np.diff(r)
        return np.concatenate([[0.0], np.cumsum(steps)])

    mass = summed(steel.density * width * r)
    pull = mass[-1] - mass
    root = rotating_ring_displacement(
        gear.root_radius,
        1.0,
        inner_radius=gear.bore_radius,
        outer_radius=gear.root_radius,
        density=steel.density,
        modulus=steel.youngs_modulus,
        poisson=steel.poisson_ratio,
        rim_pull=gear.teeth * pull[0] / (2.0 * np.pi * gear.root_radius),
        bore=bore,
    )
    return r, root + summed(pull / (width * steel.youngs_modulus))


def centrifugal_displacement(
    gear: Gear, radius: ArrayLike, speed: ArrayLike, bore: str = "free"
) -> Floats:
    """Radial displacement of a tooth of ``gear`` at ``radius`` [m], root to tip circle [m].

    The ring up to the root circle is :func:`rotating_ring_displacement` under the pull of its
    teeth, p = z N(r_f)/(2 pi r_f), N(r) = rho w^2 int_r^{r_a} s r dr; above it a tooth of width
    s = 2 r psi(r) carries no hoop stress and stretches by int_{r_f}^r N/(E s) dr.

    ``speed`` w [rad/s] of the gear, ``bore`` of :func:`rotating_ring_displacement`; E at 20 C.
    Shape of radius and speed.

    >>> f"{1e6 * centrifugal_displacement(Gear(40, 4e-3), 80e-3, 2618.0, 'shaft'):.1f} um"
    '25.0 um'
    """
    r, omega = np.asarray(radius, dtype=float), np.asarray(speed, dtype=float)
    return np.asarray(np.interp(r, *_stretched(gear, bore)) * omega**2)


def centrifugal_flank_growth(
    gear: Gear, radius: ArrayLike, speed: ArrayLike, bore: str = "free"
) -> Floats:
    """Normal growth of one flank about its tooth centre line by the centrifugal pull [m].

    delta_n = u_r (sin(alpha_k) - psi cos(alpha_k)): the tooth moves outward as it is, at
    ``radius`` r >= r_b [m]. Arguments as :func:`centrifugal_displacement`; what the pull thins a
    tooth by, nu times its stretch, is left out.

    >>> f"{1e6 * centrifugal_flank_growth(Gear(40, 4e-3), 80e-3, 2618.0, 'shaft'):.2f} um"
    '7.62 um'
    """
    r = np.asarray(radius, dtype=float)
    cosine = np.minimum(gear.base_radius / r, 1.0)
    tilt = gear.curvature_radius(r) / r - gear.half_thickness_angle(r) * cosine
    return np.asarray(centrifugal_displacement(gear, r, speed, bore) * tilt)
