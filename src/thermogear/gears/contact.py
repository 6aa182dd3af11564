"""Kinematics and dry line contact along the path of contact of a spur gear pair.

``s`` is the distance from the pinion's tangent point N1 along the line of action: the
pinion's curvature radius is s, the wheel's N1N2 - s. Positions beyond the path are answered
too (the line of action goes on); any shapes broadcast.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.gears.pair import GearPair


def path_of_contact(pair: GearPair, count: int = 201) -> Floats:
    """``count`` positions s [m] from A to E, ends included.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> (1e3 * path_of_contact(pair, 3)).round(2)
    array([ 3.56, 13.22, 22.87])
    """
    return np.linspace(pair.path.a, pair.path.e, count)


def pair_positions(pair: GearPair, phase: ArrayLike) -> Floats:
    """Positions s_j [m] of the tooth pairs at mesh phase phi; a pair enters at A at phase 0.

    s_j = s_A + (phi mod 1 + j) p_b, j = 0 .. ceil(contact ratio) - 1.
    phase: in periods, any shape (...). Returns (..., pairs); nan where the pair has left at E.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> (1e3 * pair_positions(pair, [0.0, 0.8])).round(2)
    array([[ 3.56, 15.37],
           [13.01,   nan]])
    """
    phi = np.asarray(phase, dtype=float) % 1.0
    ranks = np.arange(int(np.ceil(pair.contact_ratio - 1e-12)))
    s = pair.path.a + (phi[..., None] + ranks) * pair.base_pitch
    return np.where(s < pair.path.e, s, np.nan)


def mirror_position(pair: GearPair) -> float:
    """K = 2 s_C + p_b/2 + r_b1 psi_1(r_w1) - r_b2 psi_2(r_w2) [m]: s^c = K - s on one tooth.

    Half the difference of the tooth thicknesses on the rolling circles moves it off the
    standard pair's 2 s_C + p_b/2; backlash is shared evenly between both gears.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(20, 4e-3))
    >>> f"{mirror_position(pair) - 2.0 * pair.path.c:.6f} m, {pair.base_pitch / 2:.6f} m"
    '0.005904 m, 0.005904 m'
    """
    (r1, r2), p, w = pair.operating_radii, pair.pinion, pair.wheel
    thicker = p.base_radius * float(p.half_thickness_angle(r1)) - w.base_radius * float(
        w.half_thickness_angle(r2)
    )
    return 2.0 * pair.path.c + 0.5 * pair.base_pitch + thicker


def back_flank_position(pair: GearPair, s: ArrayLike) -> Floats:
    """Where the back flanks touch when the drive flanks touch at ``s`` [m].

    s^c = 2 s_C + p_b/2 + r_b1 psi_1(r_w1) - r_b2 psi_2(r_w2) - s  (mod p_b),
    measured from the pinion's tangent point of the mirrored line of action. A tooth centred
    on the line of centres touches at the same distance on both lines, r_b1 psi_1 past the
    pitch point; equal tooth thickness on the rolling circles leaves 2 s_C + p_b/2 - s.
    Returned in [s_A, s_A + p_b), the shape of ``s``.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(20, 4e-3))
    >>> f"{1e3 * back_flank_position(pair, pair.path.c):.2f} mm"
    '7.78 mm'
    """
    mirrored = mirror_position(pair) - np.asarray(s, dtype=float)
    return np.asarray(pair.path.a + np.mod(mirrored - pair.path.a, pair.base_pitch))


def curvature_radii(pair: GearPair, s: ArrayLike) -> tuple[Floats, Floats]:
    """(rho_1, rho_2) = (s, N1N2 - s) [m]: flank curvature radii at ``s`` [m].

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [f"{1e3 * rho:.2f} mm" for rho in curvature_radii(pair, pair.path.c)]
    ['13.68 mm', '27.36 mm']
    """
    first = np.asarray(s, dtype=float)
    return first, pair.line_of_action - first


def flank_radii(pair: GearPair, s: ArrayLike) -> tuple[Floats, Floats]:
    """(r_1, r_2) [m]: distances of the contact point at ``s`` [m] from the two gear centres.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [f"{1e3 * radius:.1f} mm" for radius in flank_radii(pair, pair.path.c)]
    ['40.0 mm', '80.0 mm']
    """
    rho1, rho2 = curvature_radii(pair, s)
    return np.hypot(pair.pinion.base_radius, rho1), np.hypot(pair.wheel.base_radius, rho2)


def reduced_radius(pair: GearPair, s: ArrayLike) -> Floats:
    """rho* = rho_1 rho_2/(rho_1 + rho_2) [m] at ``s`` [m]; 0 at the tangent points.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e3 * reduced_radius(pair, pair.path.c):.2f} mm"
    '9.12 mm'
    """
    rho1, rho2 = curvature_radii(pair, s)
    return rho1 * rho2 / pair.line_of_action


def rolling_velocities(pair: GearPair, speed: ArrayLike, s: ArrayLike) -> tuple[Floats, Floats]:
    """(v_1, v_2) = (omega_1 rho_1, omega_2 rho_2) [m/s]: flank velocities past the contact.

    speed: pinion speed omega_1 [rad/s]; s: position [m]. Equal at the pitch point.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [f"{v:.2f} m/s" for v in rolling_velocities(pair, 100.0, pair.path.c)]
    ['1.37 m/s', '1.37 m/s']
    """
    rho1, rho2 = curvature_radii(pair, s)
    omega = np.asarray(speed, dtype=float)
    return omega * rho1, omega / pair.ratio * rho2


def sliding_velocity(pair: GearPair, speed: ArrayLike, s: ArrayLike) -> Floats:
    """v_1 - v_2 = (omega_1 + omega_2)(s - s_C) [m/s], signed; exactly 0 at the pitch point.

    speed: pinion speed [rad/s]; s: position [m].

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{sliding_velocity(pair, 100.0, pair.path.c + 5e-3):.2f} m/s"
    '0.75 m/s'
    """
    omega = np.asarray(speed, dtype=float)
    return omega * (1.0 + 1.0 / pair.ratio) * (np.asarray(s, dtype=float) - pair.path.c)


def sum_velocity(pair: GearPair, speed: ArrayLike, s: ArrayLike) -> Floats:
    """v_1 + v_2 [m/s] at ``s`` [m], pinion speed [rad/s].

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{sum_velocity(pair, 100.0, pair.path.c):.2f} m/s"
    '2.74 m/s'
    """
    v1, v2 = rolling_velocities(pair, speed, s)
    return v1 + v2


def entrainment_velocity(pair: GearPair, speed: ArrayLike, s: ArrayLike) -> Floats:
    """(v_1 + v_2)/2 [m/s] at ``s`` [m], pinion speed [rad/s].

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{entrainment_velocity(pair, 100.0, pair.path.c):.2f} m/s"
    '1.37 m/s'
    """
    return 0.5 * sum_velocity(pair, speed, s)


def reduced_modulus(
    modulus1: ArrayLike, poisson1: float, modulus2: ArrayLike, poisson2: float
) -> Floats:
    """E* with 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa] (Johnson, eq. 4.24 ff).

    modulus: Young's moduli [Pa] > 0, any shapes; E/(2 (1 - nu^2)) for equal materials.

    >>> f"{1e-9 * reduced_modulus(210e9, 0.3, 210e9, 0.3):.1f} GPa"
    '115.4 GPa'
    """
    e1, e2 = np.asarray(modulus1, dtype=float), np.asarray(modulus2, dtype=float)
    return 1.0 / ((1.0 - poisson1**2) / e1 + (1.0 - poisson2**2) / e2)


def pair_reduced_modulus(pair: GearPair) -> Floats:
    """E* [Pa] of the pair's two materials at the reference temperature.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e-9 * pair_reduced_modulus(pair):.1f} GPa"
    '113.2 GPa'
    """
    p, w = pair.pinion.material, pair.wheel.material
    return reduced_modulus(p.youngs_modulus, p.poisson_ratio, w.youngs_modulus, w.poisson_ratio)


def hertz_half_width(line_load: ArrayLike, radius: ArrayLike, modulus: ArrayLike) -> Floats:
    """Half width of the Hertzian line contact, B = sqrt(4 w rho*/(pi E*)) [m].

    line_load: w [N/m] >= 0, of this tooth pair; radius: rho* [m]; modulus: E* [Pa] of
    :func:`reduced_modulus`. For equal materials B = sqrt(8 w rho* (1 - nu^2)/(pi E)).
    Zero load or radius gives 0. Source: Johnson, Contact Mechanics, eq. 4.43.

    >>> f"{1e6 * hertz_half_width(200e3, 10e-3, 115e9):.1f} um"
    '148.8 um'
    """
    w, rho = np.asarray(line_load, dtype=float), np.asarray(radius, dtype=float)
    return np.asarray(np.sqrt(4.0 * w * rho / (np.pi * np.asarray(modulus, dtype=float))))


def hertz_pressure(line_load: ArrayLike, radius: ArrayLike, modulus: ArrayLike) -> Floats:
    """Largest pressure of the line contact, p_0 = sqrt(w E*/(pi rho*)) = 2 w/(pi B) [Pa].

    Arguments as :func:`hertz_half_width`. Zero load gives 0; a loaded contact of zero radius
    (a tangent point) gives inf. Source: Johnson, eq. 4.45.

    >>> f"{1e-6 * hertz_pressure(200e3, 10e-3, 115e9):.0f} MPa"
    '856 MPa'
    """
    w, rho, modulus_ = np.broadcast_arrays(
        np.asarray(line_load, dtype=float),
        np.asarray(radius, dtype=float),
        np.asarray(modulus, dtype=float),
    )
    squared = np.full(w.shape, np.inf)
    np.divide(w * modulus_, np.pi * rho, out=squared, where=rho > 0.0)
    return np.sqrt(np.where(w == 0.0, 0.0, squared))
