"""Mesh stiffness by ISO 6336-1 and root stress by ISO 6336-3, method B: figures to compare with.

They know neither bore nor rim shape nor the course over the mesh; expect the stiffness within about
20 % of the loaded contact, the stress -5 to +20 % off finite elements.
"""

from __future__ import annotations

import math
import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth import CRITICAL_SLOPE, flank_point, section_angle

MEASURED_TO_THEORY = 0.8  # C_M
_STEEL = 206e9
_LOW_LOAD = 100e3  # N/m
_COEFFICIENTS = (
    0.04723,
    0.15551,
    0.25791,
    -0.00635,
    -0.11654,
    -0.00193,
    -0.24188,
    0.00529,
    0.00182,
)


class IsoStiffness(NamedTuple):
    """Stiffnesses per metre of face width [N/m^2]; 1e9 of them are 1 N/(mm um).

    theoretical: c'_th of one solid-disc tooth pair; single: c', the greatest of one pair;
    mesh: c_gamma_alpha, the mean over the mesh.
    """

    theoretical: Floats
    single: Floats
    mesh: Floats


def theoretical_single_stiffness(
    *, teeth1: ArrayLike, teeth2: ArrayLike, shift1: ArrayLike, shift2: ArrayLike
) -> Floats:
    """c'_th = 1/q' [N/m^2] of one tooth pair of steel solid discs.

    q' = C1 + C2/z1 + C3/z2 + C4 x1 + C5 x1/z1 + C6 x2 + C7 x2/z2 + C8 x1^2 + C9 x2^2 in
    mm um/N, z the (virtual) numbers of teeth, x the profile shifts. Any shapes.
    Range: x1 >= x2, -0.5 <= x1 + x2 <= 2.0. Source: ISO 6336-1:2006, eq. 82.

    >>> c = theoretical_single_stiffness(teeth1=20, teeth2=40, shift1=0.0, shift2=0.0)
    >>> f"{1e-9 * c:.2f} N/(mm um)"
    '16.27 N/(mm um)'
    """
    z1, z2 = np.asarray(teeth1, dtype=float), np.asarray(teeth2, dtype=float)
    x1, x2 = np.asarray(shift1, dtype=float), np.asarray(shift2, dtype=float)
    c = _COEFFICIENTS
    flexibility = c[0] + c[1] / z1 + c[2] / z2 + c[3] * x1 + c[4] * x1 / z1
    flexibility = flexibility + c[5] * x2 + c[6] * x2 / z2 + c[7] * x1**2 + c[8] * x2**2
    return np.asarray(1e9 / flexibility)


def single_stiffness(
    theoretical: ArrayLike,
    *,
    dedendum: float,
    pressure_angle: float,
    helix_angle: float = 0.0,
    blank_factor: float = 1.0,
) -> Floats:
    """c' = c'_th C_M C_R C_B cos(beta) [N/m^2] for at least 100 N/mm.

    C_M = 0.8, C_B = [1 + 0.5 (1.2 - h_fP/m)][1 - 0.02 (20 deg - alpha)].

    dedendum: h_fP in modules (the mean of both gears'); pressure_angle, helix_angle [rad];
    blank_factor: C_R, 1 for solid discs. Source: ISO 6336-1:2006, eq. 81, 85, 88.

    >>> c = single_stiffness(18e9, dedendum=1.25, pressure_angle=math.radians(20))
    >>> f"{1e-9 * c:.2f} N/(mm um)"
    '14.04 N/(mm um)'
    """
    rack = 1.0 + 0.5 * (1.2 - dedendum)
    rack *= 1.0 - 0.02 * (20.0 - np.degrees(pressure_angle))
    factor = MEASURED_TO_THEORY * blank_factor * rack * np.cos(helix_angle)
    return np.asarray(np.asarray(theoretical, dtype=float) * factor)


def pinion_first(pair: GearPair) -> tuple[Gear, Gear]:
    """The source's gear 1 and 2: fewer teeth first, of equally many the larger shift.

    >>> pair = GearPair(Gear(40, 4e-3), Gear(20, 4e-3))
    >>> [gear.teeth for gear in pinion_first(pair)]
    [20, 40]
    """
    first, second = sorted(
        (pair.pinion, pair.wheel), key=lambda gear: (gear.teeth, -gear.profile_shift)
    )
    return first, second


def iso6336_stiffness(
    pair: GearPair, line_load: ArrayLike = 200e3, *, blank: float = 1.0
) -> IsoStiffness:
    """c'_th, c' and c_gamma_alpha = c' (0.75 eps_alpha + 0.25) of a spur pair [N/m^2].

    line_load: F_t K_A/b [N/m], any shape; below 100 N/mm c' falls with its fourth root, and
    0 gives 0. blank: C_R, the mean of both gears', 1 for solid discs. Moduli scale by
    2 E1 E2/(E1 + E2) over that of steel. The source's first gear is the pinion: the one with
    fewer teeth, whichever drives. Of two with equally many teeth it is the one with the larger
    shift, the only order inside the source's range. So c is continuous in both shifts, and
    exchanging the gears changes nothing. Warns outside the source's shifts, x1 >= x2 and
    -0.5 <= x1 + x2 <= 2. Source: ISO 6336-1:2006, method B, clause 9.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e-9 * iso6336_stiffness(pair, 250e3).mesh:.1f} N/(mm um)"
    '18.7 N/(mm um)'
    """
    first, second = pinion_first(pair)
    _warn_of_shifts(first, second)
    theory = theoretical_single_stiffness(
        teeth1=first.teeth,
        teeth2=second.teeth,
        shift1=first.profile_shift,
        shift2=second.profile_shift,
    )
    e1, e2 = first.material.youngs_modulus, second.material.youngs_modulus
    single = single_stiffness(
        theory * (2.0 * e1 * e2 / (e1 + e2) / _STEEL),
        dedendum=0.5 * (first.rack.dedendum + second.rack.dedendum),
        pressure_angle=first.pressure_angle,
        blank_factor=blank,
    )
    load = np.asarray(line_load, dtype=float)
    single = single * np.minimum(load / _LOW_LOAD, 1.0) ** 0.25
    return IsoStiffness(theory, single, single * (0.75 * pair.contact_ratio + 0.25))


def _warn_of_shifts(first: Gear, second: Gear) -> None:
    """One warning for each range of the source that the shifts leave."""
    one, two = first.profile_shift, second.profile_shift
    given = f"x1 = {one:g} ({first.teeth} teeth), x2 = {two:g} ({second.teeth} teeth)"
    for holds, found, valid in (
        (one >= two, "x1 < x2", "x1 >= x2"),
        (-0.5 <= one + two <= 2.0, f"x1 + x2 = {one + two:g}", "-0.5 <= x1 + x2 <= 2"),
    ):
        if not holds:
            warnings.warn(
                f"profile_shift: {given}: {found}; range of ISO 6336-1 {valid}",
                ValidityWarning,
                stacklevel=3,
            )


def root_factors(gear: Gear, t: float) -> tuple[float, float]:
    """Form factor Y_F and stress correction factor Y_S of a spur gear loaded at t = tan(alpha_k).

    sigma_F0 = F_t/(b m) Y_F Y_S, F_t = F_n cos(alpha) at the reference circle,
    Y_F = 6 (h_F/m) cos(alpha_F)/((s_F/m)^2 cos(alpha)),
    Y_S = (1.2 + 0.13 L) q^(1/(1.21 + 2.3/L)), L = s_F/h_F, q = s_F/(2 rho_F),

    s_F the chord at the fillet's 30-degree tangents, h_F the height above it at which the force
    meets the tooth's axis, alpha_F its angle to that axis' normal, rho_F the fillet's radius there.
    Method B loads the outer point of single contact, :func:`single_contact`. Rim thickness and deep
    teeth (Y_B, Y_DT) are left out. Raises InputError outside the source's 1 <= q < 8.
    Source: ISO 6336-3:2006, clauses 6 and 7.

    >>> pair = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))
    >>> form, notch = root_factors(pair.pinion, single_contact(pair)[0])
    >>> f"{form:.3f} {notch:.3f}"
    '1.386 1.922'
    """
    fillet, at = gear.fillet, flank_point(gear, t)
    gamma, depth = section_angle(gear, CRITICAL_SLOPE), fillet.centre_depth
    x, y = (float(length) for length in fillet.point(gamma))
    chord, lever = 2.0 * x, float(at.y - at.x * np.tan(at.beta)) - y
    curved = math.sin(gamma) * (gear.pitch_radius * math.sin(gamma) ** 2 + depth)
    notch, slim = 0.5 * chord / (fillet.radius + depth**2 / curved), chord / lever
    if not 1.0 <= notch < 8.0:
        raise InputError(
            "rack.fillet_radius",
            f"{gear.rack.fillet_radius:g} modules, q_s = {notch:.3g}",
            allowed="1 <= q_s < 8 in ISO 6336-3",
        )
    return (
        6.0 * lever * gear.module * math.cos(at.beta) / (chord**2 * math.cos(gear.pressure_angle)),
        (1.2 + 0.13 * slim) * notch ** (1.0 / (1.21 + 2.3 / slim)),
    )


def single_contact(pair: GearPair) -> tuple[float, float]:
    """t = tan(alpha_k) of the outer point of single contact on pinion and wheel.

    A base pitch from where the contact begins at the gear's root: D of the path for the pinion, B
    for the wheel. Above a contact ratio of 2 the pair is not alone there.

    >>> pinion, wheel = single_contact(GearPair(Gear(25, 5e-3), Gear(75, 5e-3)))
    >>> f"{pinion:.3f} {wheel:.3f}"
    '0.387 0.380'
    """
    path, length = pair.path, pair.line_of_action
    return path.d / pair.pinion.base_radius, (length - path.b) / pair.wheel.base_radius
