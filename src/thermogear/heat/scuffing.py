"""Body temperature estimates and scuffing margins of ISO/TR 13989 and 15144-1.

Arguments in SI, temperatures in kelvin; the standards' units (N/mm, mm, kW, C) appear as
factors. Margins are given in kelvin as well as ratios: 50 K is the customary advice.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.base.units import ZERO_CELSIUS

STRUCTURE_FACTORS: dict[str, float] = {
    "nitrided": 1.5,
    "copper-plated": 1.5,
    "phosphated": 1.25,
    "case-hardened, austenite below 10 %": 1.15,
    "case-hardened": 1.0,
    "case-hardened, austenite above 20 %": 0.85,
    "through-hardened": 1.0,
    "stainless": 0.45,
}
"""X_W of a gear's steel, ISO/TR 13989: nitrided from public code, the others usual, unconfirmed."""


def thermo_elastic_factor(reduced_modulus: ArrayLike, contact_coefficient: ArrayLike) -> Floats:
    """X_M = 1000 E_r^0.25/B_M [K N^-0.75 s^0.5 m^-0.5 mm].

    ``reduced_modulus`` E_r = 2/sum((1 - nu^2)/E) [Pa] (N/mm^2 in the formula),
    ``contact_coefficient`` sqrt(k rho c) [J/(m^2 K s^0.5)] (1/sqrt(1000) of it in the
    standard's N/(mm^0.5 m^0.5 s^0.5 K); 435 there is 13 756). 50.0 for steel. Source:
    ISO/TR 13989-1 and -2.

    >>> f"{thermo_elastic_factor(226e9, 13756.0):.1f}"
    '50.1'
    """
    modulus = np.asarray(reduced_modulus, dtype=float) * 1e-6
    coefficient = np.asarray(contact_coefficient, dtype=float) / np.sqrt(1000.0)
    return np.asarray(1000.0 * modulus**0.25 / coefficient)


def angle_factor(*, pressure_angle: ArrayLike, operating_angle: ArrayLike) -> Floats:
    """X_alpha = 1.22 (sin a_w cos a)^0.25 / sqrt(cos a_w cos a) of spur gears [-].

    ``pressure_angle`` a, ``operating_angle`` a_w [rad], any shape. Source: ISO/TR 13989-2 eq. 13.

    >>> angle = math.radians(20)
    >>> f"{angle_factor(pressure_angle=angle, operating_angle=angle):.3f}"
    '0.978'
    """
    a, aw = np.asarray(pressure_angle, dtype=float), np.asarray(operating_angle, dtype=float)
    return np.asarray(1.22 * (np.sin(aw) * np.cos(a)) ** 0.25 / np.sqrt(np.cos(aw) * np.cos(a)))


def load_sharing_13989(
    position: ArrayLike, *, a: float, b: float, d: float, e: float, grade: int = 7
) -> Floats:
    """X_Gamma of unmodified spur gears along the path [-].

    (Q - 2)/15 at A and E, rising linearly to 1 at B and D where single contact
    begins; 1 between. ``position`` s [m], ``a``, ``b``, ``d``, ``e`` [m] of the path, ``grade`` Q
    (7 for accuracy grade 7 and better: 1/3). 0 outside A..E. Source: ISO/TR 13989-1 eq.
    57-60.

    >>> load_sharing_13989([4e-3, 13e-3], a=4e-3, b=11e-3, d=15e-3, e=23e-3).round(3)
    array([0.333, 1.   ])
    """
    s = np.asarray(position, dtype=float)
    start = (max(grade, 7) - 2.0) / 15.0
    rising = start + (1.0 - start) * (s - a) / (b - a)
    falling = start + (1.0 - start) * (e - s) / (e - d)
    share = np.minimum(1.0, np.minimum(rising, falling))
    return np.asarray(np.where((s >= a) & (s <= e), share, 0.0))


def flash_13989_1(
    friction: ArrayLike,
    line_load: ArrayLike,
    pinion_speed: ArrayLike,
    *,
    curvature_1: ArrayLike,
    curvature_2: ArrayLike,
    ratio: ArrayLike,
    thermo_elastic: ArrayLike = 50.0,
    approach: ArrayLike = 1.0,
) -> Floats:
    """Flash temperature along the path by ISO/TR 13989-1 eq. 5 [K].

    2.52 mu (X_M/50) X_J (X_Gamma w_Bt)^0.75 sqrt(n1/60) |sqrt(rho1) - sqrt(rho2/u)|/rho_rel^0.25;
    N/mm, 1/min, mm.

    ``line_load`` X_Gamma w_Bt [N/m], ``pinion_speed`` omega_1 [rad/s], ``curvature_1``, ``_2``
    rho [m], ``ratio`` u, ``thermo_elastic`` X_M, ``approach`` X_J. Any shape; 0 at the pitch point
    (rho2 = u rho1). The general Blok value lies 2 % below to 4 % above it, by the meaning of w.

    >>> rise = flash_13989_1(
    ...     0.05, 200e3, 300.0, curvature_1=20e-3, curvature_2=20e-3, ratio=2.0
    ... )
    >>> f"{rise:.1f} K"
    '34.1 K'
    """
    w = np.asarray(line_load, dtype=float) * 1e-3
    turns = np.asarray(pinion_speed, dtype=float) / (2.0 * np.pi)
    one = np.asarray(curvature_1, dtype=float) * 1e3
    two = np.asarray(curvature_2, dtype=float) * 1e3
    relative = one * two / (one + two)
    slip = np.abs(np.sqrt(one) - np.sqrt(two / np.asarray(ratio)))
    factor = 2.52 * np.abs(friction) * np.asarray(thermo_elastic) / 50.0 * np.asarray(approach)
    return np.asarray(factor * w**0.75 * np.sqrt(turns) * slip / relative**0.25)


def geometry_factor(*, curvature_1: ArrayLike, curvature_2: ArrayLike, ratio: ArrayLike) -> Floats:
    """X_BE at the pinion's tip [-].

    0.51 sqrt(u + 1) (sqrt(rho1) - sqrt(rho2/u))/(rho1 rho2)^0.25 at E.

    ``curvature_1``, ``curvature_2`` [m] at E, ``ratio`` u. Source: ISO/TR 13989-2.

    >>> f"{geometry_factor(curvature_1=20e-3, curvature_2=20e-3, ratio=2.0):.3f}"
    '0.259'
    """
    one, two = np.asarray(curvature_1, dtype=float), np.asarray(curvature_2, dtype=float)
    u = np.asarray(ratio, dtype=float)
    slip = np.sqrt(one) - np.sqrt(two / u)
    return np.asarray(0.51 * np.sqrt(u + 1.0) * slip / (one * two) ** 0.25)


def contact_ratio_factor(*, recess: float, approach: float) -> float:
    """X_epsilon: mean flash temperature of the path over that at E [-].

    ``recess`` eps_1 (pinion), ``approach`` eps_2 (wheel) [-], eps_alpha = eps_1 + eps_2 < 2. The
    case eps_2 >= 1 is that of eps_1 >= 1 with the gears exchanged in the bracket. Raises for
    eps_alpha outside 1..2. Source: ISO/TR 13989-2 eq. 39-44.

    >>> f"{contact_ratio_factor(recess=0.8, approach=0.8):.3f}"
    '0.266'
    """
    one, two, total = recess, approach, recess + approach
    if not (1.0 <= total < 2.0 and one > 0.0 and two >= 0.0):
        raise InputError("contact ratio", f"{total:.4g}", allowed="1 <= eps_alpha < 2")
    if one >= 1.0:
        bracket = 0.18 * one**2 + 0.70 * two**2 + 0.82 * one - 0.52 * two - 0.30 * one * two
    elif two >= 1.0:
        bracket = 0.18 * two**2 + 0.70 * one**2 + 0.82 * two - 0.52 * one - 0.30 * one * two
    else:
        bracket = 0.70 * (one**2 + two**2) - 0.22 * total + 0.52 - 0.60 * one * two
    return bracket / (2.0 * total * one)


def rotation_factor(*, approach: float, recess: float) -> float:
    """X_Q of the driving direction [-].

    1 for eps_f/eps_a <= 1.5, 1.40 - (4/15) eps_f/eps_a to 3, 0.6 beyond; ``approach`` eps_f is
    the tip contact ratio of the driven gear, ``recess`` eps_a that of the driver. Source:
    ISO/TR 13989-2.

    >>> f"{rotation_factor(approach=0.8, recess=0.4):.3f}"
    '0.867'
    """
    ratio = approach / recess
    return 1.0 if ratio <= 1.5 else max(0.6, 1.40 - 4.0 / 15.0 * ratio)


def flash_at_tip_13989_2(
    friction: ArrayLike,
    line_load: ArrayLike,
    pitch_speed: ArrayLike,
    centre_distance: ArrayLike,
    *,
    geometry: ArrayLike,
    angle: ArrayLike,
    rotation: ArrayLike = 1.0,
    tip_relief: ArrayLike = 1.0,
    thermo_elastic: ArrayLike = 50.0,
) -> Floats:
    """Flash temperature at the pinion's tip of the integral method [K].

    mu X_M X_BE X_alpha w_Bt^0.75 sqrt(v)/a^0.25 / (X_Q X_Ca);  N/mm, m/s, mm.

    ``line_load`` w_Bt = F_t/b [N/m], ``pitch_speed`` v [m/s], ``centre_distance`` a [m],
    ``geometry`` X_BE, ``angle`` X_alpha, ``rotation`` X_Q, ``tip_relief`` X_Ca, ``thermo_elastic``
    X_M. Any shape. Source: ISO/TR 13989-2 eq. 17 ff.

    >>> f"{flash_at_tip_13989_2(0.05, 200e3, 10.0, 0.1, geometry=0.2, angle=0.98):.1f} K"
    '26.1 K'
    """
    w = np.asarray(line_load, dtype=float) * 1e-3
    a = np.asarray(centre_distance, dtype=float) * 1e3
    factors = np.asarray(thermo_elastic) * np.asarray(geometry) * np.asarray(angle)
    factors = factors * np.abs(friction) / (np.asarray(rotation) * np.asarray(tip_relief))
    return np.asarray(factors * w**0.75 * np.sqrt(np.asarray(pitch_speed, dtype=float)) / a**0.25)


def body_temperature_13989_1(
    *,
    oil_temperature: ArrayLike,
    mean_flash: ArrayLike,
    lubrication: ArrayLike = 1.0,
    meshes: ArrayLike = 1.0,
) -> Floats:
    """theta_M = theta_oil + 0.47 X_S X_mp theta_flm [K].

    ``oil_temperature`` [K], ``mean_flash`` [K] along the path, ``lubrication`` X_S 1.2 spray, 1.0
    dip, 0.2 submerged, ``meshes`` X_mp. Source: ISO/TR 13989-1 eq. 22.

    >>> f"{body_temperature_13989_1(oil_temperature=353.15, mean_flash=20.0):.2f} K"
    '362.55 K'
    """
    rise = 0.47 * np.asarray(lubrication) * np.asarray(meshes) * np.asarray(mean_flash)
    return np.asarray(np.asarray(oil_temperature, dtype=float) + rise)


def body_temperature_13989_2(
    *,
    oil_temperature: ArrayLike,
    integral_flash: ArrayLike,
    lubrication: ArrayLike = 1.0,
    meshes: ArrayLike = 1.0,
) -> Floats:
    """theta_M = theta_oil + 0.7 X_mp X_S theta_flaint [K].

    ``integral_flash`` theta_flaint [K] = flash at the tip times X_epsilon; the rest as
    :func:`body_temperature_13989_1`. Source: ISO/TR 13989-2 eq. 17-20.

    >>> f"{body_temperature_13989_2(oil_temperature=353.15, integral_flash=20.0):.2f} K"
    '367.15 K'
    """
    rise = 0.7 * np.asarray(lubrication) * np.asarray(meshes) * np.asarray(integral_flash)
    return np.asarray(np.asarray(oil_temperature, dtype=float) + rise)


def body_temperature_15144(
    oil_temperature: ArrayLike,
    loss: ArrayLike,
    *,
    centre_distance: ArrayLike,
    face_width: ArrayLike,
    lubrication: ArrayLike = 1.0,
    tip_relief: ArrayLike = 1.0,
) -> Floats:
    """theta_M = theta_oil + 7400 (P mu H_V/(a b))^0.72 X_S/(1.2 X_Ca) [K]; kW, mm.

    ``loss`` P mu H_V [W], ``centre_distance`` a, ``face_width`` b [m], ``lubrication`` X_S,
    ``tip_relief`` X_Ca. Any shape. Source: ISO/TR 15144-1 eq. 84.

    >>> f"{body_temperature_15144(353.15, 300.0, centre_distance=0.12, face_width=0.02):.1f} K"
    '362.7 K'
    """
    area = np.asarray(centre_distance, dtype=float) * np.asarray(face_width) * 1e6
    group = np.asarray(loss, dtype=float) * 1e-3 / area
    rise = 7400.0 * group**0.72 * np.asarray(lubrication) / (1.2 * np.asarray(tip_relief))
    return np.asarray(np.asarray(oil_temperature, dtype=float) + rise)


def integral_temperature(*, body_temperature: ArrayLike, integral_flash: ArrayLike) -> Floats:
    """theta_int = theta_M + 1.5 theta_flaint [K]. Source: ISO/TR 13989-2 eq. 17.

    >>> f"{integral_temperature(body_temperature=363.15, integral_flash=20.0):.2f} K"
    '393.15 K'
    """
    return np.asarray(np.asarray(body_temperature, dtype=float) + 1.5 * np.asarray(integral_flash))


def approach_factor(position: ArrayLike, *, a: float, c: float, e: float, missing: float) -> Floats:
    """X_J of tip corners that meet too early, pinion driving [-].

    1 + (C_eff - C_a2)/50 um (-Gamma/(Gamma_E - Gamma_A))^3 before the pitch point, at least 1; 1
    beyond.

    ``position`` s [m] on the path, any shape, ``a``, ``c``, ``e`` [m] of the path (Gamma = s/c -
    1), ``missing`` C_eff - C_a2 [m]: what the wheel's tip relief lacks. Source: ISO/TR 13989-1.

    >>> f"{approach_factor(4e-3, a=4e-3, c=14e-3, e=24e-3, missing=40e-6):.3f}"
    '1.100'
    """
    ahead = np.maximum(c - np.asarray(position, dtype=float), 0.0) / (e - a)
    return np.asarray(np.maximum(1.0 + missing / 50e-6 * ahead**3, 1.0))


def structure_factor(steel: str) -> float:
    """X_W out of :data:`STRUCTURE_FACTORS`, or an error that says the nearest name.

    >>> structure_factor("case-hardened")
    1.0
    """
    require_choice("scuffing.steel", steel, STRUCTURE_FACTORS)
    return STRUCTURE_FACTORS[steel]


def fzg_torque(load_stage: ArrayLike) -> Floats:
    """Pinion torque of an FZG load stage, 3.726 S^2 [N m]; within 5 % of the test's table.

    >>> f"{fzg_torque(10):.1f} N m"
    '372.6 N m'
    """
    return np.asarray(3.726 * np.asarray(load_stage, dtype=float) ** 2)


def scuffing_temperature(
    load_stage: ArrayLike, *, structure: ArrayLike = 1.0, lubricant_factor: ArrayLike = 1.0
) -> Floats:
    """Contact temperature at which the oil scuffs, flash method [K].

    Theta_S = 80 C + (0.85 + 1.4 X_W) X_L S_FZG^2.

    ``load_stage`` S_FZG of the test A/8.3/90, ``structure`` X_W of the gear's steel,
    ``lubricant_factor`` X_L of the test oil. Source: ISO/TR 13989-1 eq. 99.

    >>> f"{scuffing_temperature(10) - 273.15:.0f} C"
    '305 C'
    """
    stage = np.asarray(load_stage, dtype=float)
    rise = (0.85 + 1.4 * np.asarray(structure)) * np.asarray(lubricant_factor) * stage**2
    return np.asarray(ZERO_CELSIUS + 80.0 + rise)


def scuffing_integral_temperature(
    load_stage: ArrayLike,
    viscosity_40: ArrayLike,
    *,
    structure: ArrayLike = 1.0,
    lubricant_factor: ArrayLike = 1.0,
) -> Floats:
    """Integral temperature at which the oil scuffs [K].

    theta_intS = theta_MT + 1.5 X_WrelT theta_flaintT,  theta_MT = 80 C + 0.23 T1T X_L,
    theta_flaintT = 0.2 T1T (100/nu40)^0.02 X_L,  T1T = 3.726 S_FZG^2.

    ``load_stage`` S_FZG [-], ``viscosity_40`` nu [m^2/s] at 40 C, ``structure`` X_WrelT,
    ``lubricant_factor`` X_L. Source: ISO/TR 13989-2 eq. 94-97.

    >>> f"{scuffing_integral_temperature(10, 100e-6) - 273.15:.1f} C"
    '277.5 C'
    """
    torque = fzg_torque(load_stage) * np.asarray(lubricant_factor)
    nu = np.asarray(viscosity_40, dtype=float) * 1e6
    flash = 0.2 * torque * (100.0 / nu) ** 0.02
    return np.asarray(ZERO_CELSIUS + 80.0 + 0.23 * torque + 1.5 * np.asarray(structure) * flash)


def scuffing_safety(
    *, limit: ArrayLike, temperature: ArrayLike, oil_temperature: ArrayLike
) -> Floats:
    """S_B = (Theta_S - theta_oil)/(Theta_Bmax - theta_oil) [-]; infinite without a rise.

    ``limit``, greatest contact ``temperature`` and ``oil_temperature`` [K]. Source:
    ISO/TR 13989-1. Differences, so kelvin and C say the same.

    >>> f"{scuffing_safety(limit=573.15, temperature=453.15, oil_temperature=353.15):.2f}"
    '2.20'
    """
    oil = np.asarray(oil_temperature, dtype=float)
    above, below = np.broadcast_arrays(np.asarray(limit) - oil, np.asarray(temperature) - oil)
    return np.asarray(np.divide(above, below, out=np.full(above.shape, np.inf), where=below > 0.0))


def integral_safety(*, limit: ArrayLike, temperature: ArrayLike) -> Floats:
    """S_int = theta_intS/theta_int in degrees Celsius [-]: < 1 high risk, 1..2 critical, > 2 low.

    ``limit``, ``temperature`` [K], the latter above 0 C. Source: ISO/TR 13989-2.

    >>> f"{integral_safety(limit=573.15, temperature=423.15):.2f}"
    '2.00'
    """
    above = np.asarray(limit, dtype=float) - ZERO_CELSIUS
    return np.asarray(above / (np.asarray(temperature, dtype=float) - ZERO_CELSIUS))


def scuffing_margin(*, limit: ArrayLike, temperature: ArrayLike) -> Floats:
    """Theta_S - Theta_Bmax [K]: what is left; 50 K and more is advised, < 0 scuffs.

    >>> f"{scuffing_margin(limit=573.15, temperature=453.15):.0f} K"
    '120 K'
    """
    return np.asarray(np.asarray(limit, dtype=float) - np.asarray(temperature))
