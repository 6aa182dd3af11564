"""Does a pair scuff? ISO/TR 13989 rated: flash temperature (part 1), integral temperature (part 2).

Both put the temperature of the contact against the one at which the oil failed in the FZG test
A/8.3/90. Today they are ISO/TS 6336-20 and -21, which could not be read.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.materials import Lubricant
from thermogear.base.units import ZERO_CELSIUS
from thermogear.gears.contact import (
    curvature_radii,
    path_of_contact,
    reduced_modulus,
    reduced_radius,
)
from thermogear.gears.pair import GearPair
from thermogear.heat.laws import ISO_LUBRICANT_FACTOR, iso_13989_1, iso_13989_2
from thermogear.heat.lubrication import dynamic_viscosity, kinematic_viscosity
from thermogear.heat.scuffing import (
    angle_factor,
    approach_factor,
    body_temperature_13989_1,
    body_temperature_13989_2,
    contact_ratio_factor,
    flash_13989_1,
    flash_at_tip_13989_2,
    geometry_factor,
    integral_safety,
    integral_temperature,
    load_sharing_13989,
    rotation_factor,
    scuffing_integral_temperature,
    scuffing_margin,
    scuffing_safety,
    scuffing_temperature,
    structure_factor,
    thermo_elastic_factor,
)

LUBRICATIONS = {"dip": 1.0, "spray": 1.2, "submerged": 0.2}
"""X_S of the way the oil comes to the mesh."""
_POINTS = 401
_FASTEST = 50.0  # m/s


@dataclass(frozen=True, kw_only=True)
class Scuffing:
    """The oil, how it comes to the mesh, and its stage in the FZG test.

    ``oil_temperature`` [K], a number or one for each point; ``load_stage`` S_FZG of A/8.3/90,
    1..14 or the last one passed;
    ``steel`` out of :data:`~thermogear.heat.scuffing.STRUCTURE_FACTORS`; ``lubrication`` out of
    :data:`LUBRICATIONS`; ``overload``: product of the load factors, K_A K_v and the rest;
    ``missing_relief`` C_eff - C_a2 [m] >= 0 as :func:`~thermogear.heat.scuffing.approach_factor`;
    ``grade`` of the load sharing. The oil is rated with what is known of its kind.
    """

    lubricant: Lubricant
    oil_temperature: ArrayLike
    load_stage: float = 12.0
    steel: str = "case-hardened"
    lubrication: str = "dip"
    overload: float = 1.0
    missing_relief: float = 0.0
    grade: int = 7

    def __post_init__(self) -> None:
        if self.lubrication not in LUBRICATIONS:
            raise InputError(
                "scuffing.lubrication", repr(self.lubrication), allowed=" | ".join(LUBRICATIONS)
            )
        if not 1.0 <= self.load_stage <= 14.0:
            raise InputError("scuffing.load_stage", self.load_stage, allowed="1..14")
        if not self.overload > 0.0:
            raise InputError("scuffing.overload", self.overload, allowed="> 0")
        structure_factor(self.steel)

    @property
    def kind_factor(self) -> float:
        """c of X_L = c eta^-0.05, by the kind of oil; 1 where the source has none."""
        return ISO_LUBRICANT_FACTOR.get(self.lubricant.kind, 1.0)


class FlashRating(NamedTuple):
    """Part 1: body and contact temperature and its limit [K], margin [K], safety S_B [-].

    flash: the greatest of the path [K]. Arrays of the broadcast shape of torque and speed.
    """

    body: Floats
    flash: Floats
    contact: Floats
    limit: float
    margin: Floats
    safety: Floats


class IntegralRating(NamedTuple):
    """Part 2: body and integral temperature and its limit [K], safety S_int [-].

    flash: the mean of the path theta_flaint [K]. Arrays as :class:`FlashRating`.
    """

    body: Floats
    flash: Floats
    integral: Floats
    limit: float
    safety: Floats


def pair_thermo_elastic_factor(pair: GearPair) -> float:
    """X_M of the pair's materials, the mean of both thermal contact coefficients.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{pair_thermo_elastic_factor(pair):.1f}"
    '52.9'
    """
    one, two = pair.pinion.material, pair.wheel.material
    modulus = 2.0 * reduced_modulus(
        one.youngs_modulus, one.poisson_ratio, two.youngs_modulus, two.poisson_ratio
    )
    contact = 0.5 * (one.thermal_contact_coefficient + two.thermal_contact_coefficient)
    return float(thermo_elastic_factor(modulus, contact))


def integral_flash(
    pair: GearPair, friction: ArrayLike, line_load: ArrayLike, pitch_speed: ArrayLike
) -> Floats:
    """theta_flaint [K]: flash temperature at the pinion's tip times X_epsilon.

    ``friction`` [-], ``line_load`` w_Bt = F_t/b [N/m], ``pitch_speed`` v [m/s], any shapes.
    Unmodified flanks. Raises for a contact ratio of 2 and more. Source: ISO/TR 13989-2.
    """
    path = pair.path
    approach = (path.c - path.a) / pair.base_pitch
    recess = (path.e - path.c) / pair.base_pitch
    factor = contact_ratio_factor(recess=recess, approach=approach)
    rho_1, rho_2 = (float(r[0]) for r in curvature_radii(pair, np.array([path.e])))
    tip = flash_at_tip_13989_2(
        friction,
        line_load,
        pitch_speed,
        pair.centre_distance,
        geometry=geometry_factor(curvature_1=rho_1, curvature_2=rho_2, ratio=pair.ratio),
        angle=angle_factor(
            pressure_angle=pair.pinion.pressure_angle,
            operating_angle=pair.operating_pressure_angle,
        ),
        rotation=rotation_factor(approach=approach, recess=recess),
        tip_relief=1.0,
        thermo_elastic=pair_thermo_elastic_factor(pair),
    )
    return np.asarray(tip * factor)


def _load_and_speed(
    pair: GearPair, torque: ArrayLike, speed: ArrayLike, overload: float
) -> tuple[Floats, Floats]:
    """w_Bt [N/m] and v_t [m/s] at the operating pitch circle, one shape."""
    radius = pair.operating_radii[0]
    moment, turning = np.broadcast_arrays(
        np.asarray(torque, dtype=float), np.asarray(speed, dtype=float)
    )
    if not np.all((moment >= 0.0) & (turning > 0.0)):
        raise InputError(
            "scuffing", "a torque < 0 or a speed <= 0", allowed="torque >= 0, speed > 0"
        )
    return moment / radius / pair.face_width * overload, turning * radius


def _mean_roughness(pair: GearPair) -> float:
    return 0.5 * (pair.pinion.roughness + pair.wheel.roughness)


def flash_rating(
    pair: GearPair, torque: ArrayLike, speed: ArrayLike, scuffing: Scuffing
) -> FlashRating:
    """Flash temperature method: Theta_B = theta_M + max Theta_fl against Theta_S.

    theta_M = theta_oil + 0.47 X_S Theta_flm; Theta_fl along the path by eq. 5 with X_Gamma of
    unmodified flanks and the mean friction of eq. 25-28; S_B = (Theta_S - theta_oil)/(Theta_B -
    theta_oil).

    ``torque`` [N m] >= 0 and ``speed`` [rad/s] > 0 of the driving pinion, any shapes. Raises
    outside them. v_t <= 50 m/s. Source: ISO/TR 13989-1.
    """
    load, v = _load_and_speed(pair, torque, speed, scuffing.overload)
    path, s = pair.path, path_of_contact(pair, _POINTS)
    oil = np.asarray(scuffing.oil_temperature, dtype=float)
    friction = iso_13989_1(
        load,
        2.0 * np.minimum(v, _FASTEST) * np.sin(pair.operating_pressure_angle),
        float(reduced_radius(pair, path.c)),
        dynamic_viscosity(scuffing.lubricant, oil),
        _mean_roughness(pair),
        factor=scuffing.kind_factor,
    )
    share = load_sharing_13989(s, a=path.a, b=path.b, d=path.d, e=path.e, grade=scuffing.grade)
    rho_1, rho_2 = curvature_radii(pair, s)
    flash = flash_13989_1(
        friction[..., None],
        share * load[..., None],
        v[..., None] / pair.operating_radii[0],
        curvature_1=rho_1,
        curvature_2=rho_2,
        ratio=pair.ratio,
        thermo_elastic=pair_thermo_elastic_factor(pair),
        approach=approach_factor(s, a=path.a, c=path.c, e=path.e, missing=scuffing.missing_relief),
    )
    body = body_temperature_13989_1(
        oil_temperature=oil,
        mean_flash=flash.mean(axis=-1),
        lubrication=LUBRICATIONS[scuffing.lubrication],
    )
    most = np.asarray(flash.max(axis=-1))
    contact = body + most
    limit = float(
        scuffing_temperature(
            scuffing.load_stage,
            structure=structure_factor(scuffing.steel),
            lubricant_factor=scuffing.kind_factor,
        )
    )
    return FlashRating(
        body,
        most,
        contact,
        limit,
        scuffing_margin(limit=limit, temperature=contact),
        scuffing_safety(limit=limit, temperature=contact, oil_temperature=oil),
    )


def integral_rating(
    pair: GearPair, torque: ArrayLike, speed: ArrayLike, scuffing: Scuffing
) -> IntegralRating:
    """Integral temperature method: theta_int = theta_M + 1.5 theta_flaint against theta_intS.

    theta_M = theta_oil + 0.7 X_S theta_flaint; S_int = theta_intS/theta_int in degrees Celsius.

    Arguments as :func:`flash_rating`. v 1..50 m/s. Raises for a contact ratio of 2 and more.
    Source: ISO/TR 13989-2.
    """
    load, v = _load_and_speed(pair, torque, speed, scuffing.overload)
    oil = np.asarray(scuffing.oil_temperature, dtype=float)
    working = pair.operating_pressure_angle
    friction = iso_13989_2(
        load,
        # 2 v tan(alpha_w) cos(alpha) on the reference circle is 2 v_t sin(alpha_w) on this one
        2.0 * v * np.sin(working),
        float(reduced_radius(pair, pair.path.c)),
        dynamic_viscosity(scuffing.lubricant, oil),
        _mean_roughness(pair),
        factor=scuffing.kind_factor,
    )
    flash = integral_flash(pair, friction, load, v)
    body = body_temperature_13989_2(
        oil_temperature=oil,
        integral_flash=flash,
        lubrication=LUBRICATIONS[scuffing.lubrication],
    )
    total = integral_temperature(body_temperature=body, integral_flash=flash)
    limit = float(
        scuffing_integral_temperature(
            scuffing.load_stage,
            float(kinematic_viscosity(scuffing.lubricant, ZERO_CELSIUS + 40.0)),
            structure=structure_factor(scuffing.steel),
            lubricant_factor=scuffing.kind_factor,
        )
    )
    return IntegralRating(
        body, flash, total, limit, integral_safety(limit=limit, temperature=total)
    )
