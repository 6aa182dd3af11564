"""Published formulas of the coefficient of friction, one function each, SI arguments.

The formulas are fits with dimensional constants: their sources' units (N/mm, um, mPa s, GPa)
appear as factors in the code. All return |mu| [-] and stay finite: at rest the value is
``ceiling``, at zero load 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice

CEILING = 0.5
"""Greatest value any law returns: the upper end of dry friction, met only near rest."""

FZG_LUBRICANT_FACTOR: dict[str, float] = {
    "mineral": 0.846,
    "pao": 0.65,
    "ester": 0.65,
    "pag": 0.585,
}
"""X_L fitted to FZG tests of wind-turbine oils (Fernandes, Seabra)."""

ISO_LUBRICANT_FACTOR: dict[str, float] = {
    "mineral": 1.0,
    "pao": 0.8,
    "pag": 0.7,
    "pag, water-soluble": 0.6,
    "phosphate ester": 1.3,
    "traction fluid": 1.5,
}
"""Constant c of X_L = c eta^-0.05 in ISO/TR 13989-1."""


def lubricant_factor(kind: str, table: dict[str, float]) -> float:
    """A base oil's factor out of a table, or an error that says the nearest name.

    >>> lubricant_factor("mineral", FZG_LUBRICANT_FACTOR)
    0.846
    """
    require_choice("lubricant kind", kind, table)
    return table[kind]


def _load_over_roll(line_load: ArrayLike, sum_speed: ArrayLike, radius: ArrayLike) -> Floats:
    """(w/(v_sum R))^0.2 with N/mm, m/s, mm; infinite at rest, 0 without load."""
    w, v, r = (np.asarray(a, dtype=float) for a in (line_load, sum_speed, radius))
    below = np.asarray(v * r * 1e3)
    above = np.asarray(w * 1e-3)
    shape = np.broadcast_shapes(above.shape, below.shape)
    out = np.where(np.broadcast_to(above, shape) > 0.0, np.inf, 0.0)
    return np.asarray(np.divide(above, below, out=out, where=below > 0.0) ** 0.2)


def _capped(value: ArrayLike, ceiling: float) -> Floats:
    return np.asarray(np.minimum(np.asarray(value), ceiling))


def schlenk(
    line_load: ArrayLike,
    sum_speed: ArrayLike,
    reduced_radius: ArrayLike,
    viscosity: ArrayLike,
    roughness: ArrayLike,
    *,
    factor: float = FZG_LUBRICANT_FACTOR["mineral"],
    ceiling: float = CEILING,
) -> Floats:
    """Mean friction of a mesh by Schlenk (ISO/TR 14179-2) [-].

    mu = 0.048 (w/(v_sum R))^0.2 eta^-0.05 Ra^0.25 X_L;  N/mm, m/s, mm, mPa s, um.

    ``line_load`` F_bt/b [N/m], ``sum_speed`` [m/s] and ``reduced_radius`` [m] at the pitch
    point, ``viscosity`` [Pa s] at the oil's temperature, ``roughness`` mean Ra [m] of both
    flanks, ``factor`` X_L. Any shape.

    >>> f"{schlenk(200e3, 5.0, 10e-3, 0.02, 0.4e-6):.4f}"
    '0.0367'
    """
    eta = np.asarray(viscosity, dtype=float) * 1e3
    rough = np.asarray(roughness, dtype=float) * 1e6
    group = _load_over_roll(line_load, sum_speed, reduced_radius)
    return _capped(0.048 * group * eta**-0.05 * rough**0.25 * factor, ceiling)


def iso_13989_1(
    line_load: ArrayLike,
    sum_speed: ArrayLike,
    reduced_radius: ArrayLike,
    viscosity: ArrayLike,
    roughness: ArrayLike,
    *,
    factor: float = ISO_LUBRICANT_FACTOR["mineral"],
    ceiling: float = CEILING,
) -> Floats:
    """Mean friction of the flash temperature method, ISO/TR 13989-1 [-].

    mu = 0.060 (w_Bt/(v_gSumC rho_relC))^0.2 X_L X_R,  X_L = c eta^-0.05,  X_R = Ra^0.25;
    N/mm, m/s, mm, mPa s, um.

    ``line_load`` w_Bt = F_t/b [N/m] at the operating pitch circle, ``sum_speed`` v_gSumC =
    2 min(v_t, 50 m/s) sin(alpha_wt), ``reduced_radius`` [m], ``viscosity`` [Pa s],
    ``roughness`` mean Ra [m], ``factor`` c. Any shape. v_t <= 50 m/s. Source: ISO/TR 13989-1
    eq. 25-28; the exponent 0.25 of X_R keeps it within 3 % of part 2.

    >>> f"{iso_13989_1(200e3, 5.0, 10e-3, 0.02, 0.4e-6, factor=1.0):.4f}"
    '0.0542'
    """
    eta = np.asarray(viscosity, dtype=float) * 1e3
    rough = np.asarray(roughness, dtype=float) * 1e6
    group = _load_over_roll(line_load, sum_speed, reduced_radius)
    return _capped(0.060 * group * factor * eta**-0.05 * rough**0.25, ceiling)


def iso_13989_2(
    line_load: ArrayLike,
    sum_speed: ArrayLike,
    reduced_radius: ArrayLike,
    viscosity: ArrayLike,
    roughness: ArrayLike,
    *,
    factor: float = 1.0,
    ceiling: float = CEILING,
) -> Floats:
    """Mean friction of the integral temperature method (Michaelis) [-].

    mu = 0.045 (max(w_Bt, 150) /(v_sumC rho_redC))^0.2 eta^-0.05 X_R X_L,
    X_R = 2.2 (Ra/rho_redC)^0.25;  N/mm, m/s, mm, mPa s, um.

    Arguments as :func:`schlenk` with w_Bt = F_t/b (times K_Bgamma). Any shape; 0 at zero load
    although the source's floor of 150 N/mm would leave friction without a force. v 1..50 m/s.
    Source: ISO/TR 13989-2 eq. 1-7, ISO/TR 15144-1 eq. 86.

    >>> f"{iso_13989_2(200e3, 5.0, 10e-3, 0.02, 0.4e-6):.4f}"
    '0.0503'
    """
    w = np.asarray(line_load, dtype=float)
    eta = np.asarray(viscosity, dtype=float) * 1e3
    rough = np.asarray(roughness, dtype=float) * 1e6
    floored = np.where(w > 0.0, np.maximum(w, 150e3), 0.0)
    group = _load_over_roll(floored, sum_speed, reduced_radius)
    radius = np.asarray(reduced_radius, dtype=float) * 1e3
    finish = 2.2 * (rough / radius) ** 0.25
    return _capped(0.045 * group * eta**-0.05 * finish * factor, ceiling)


def fernandes(
    line_load: ArrayLike,
    sum_speed: ArrayLike,
    reduced_radius: ArrayLike,
    viscosity: ArrayLike,
    roughness: ArrayLike,
    pressure_viscosity: ArrayLike,
    face_width: ArrayLike,
    *,
    factor: float = FZG_LUBRICANT_FACTOR["mineral"],
    ceiling: float = CEILING,
) -> Floats:
    """Mean friction by Fernandes et al. in dimensionless groups [-].

    mu = 0.014 S_p^-0.25 S_g^0.25 X_L,  S_p = v_sum eta sqrt(alpha)/sqrt(F_bn),
    S_g = Ra/sqrt(b R).

    ``line_load`` F_bn/b [N/m], ``sum_speed`` [m/s], ``reduced_radius`` R [m], ``viscosity`` [Pa
    s], ``roughness`` mean Ra [m], ``pressure_viscosity`` alpha [1/Pa], ``face_width`` b [m],
    ``factor`` X_L. Any coherent units, any shape. Fitted to FZG C40 and H gears.
    Source: Fernandes et al., Tribology International 101 (2016) 204, as in public code.

    >>> f"{fernandes(200e3, 5.0, 10e-3, 0.02, 0.4e-6, 15e-9, 20e-3):.4f}"
    '0.0412'
    """
    b = np.asarray(face_width, dtype=float)
    force = np.asarray(line_load, dtype=float) * b
    rolled = np.asarray(sum_speed) * np.asarray(viscosity) * np.sqrt(pressure_viscosity)
    rolled, force = np.broadcast_arrays(np.asarray(rolled), force)
    out = np.where(force > 0.0, np.inf, 0.0)
    inverse = np.divide(np.sqrt(force), rolled, out=out, where=rolled > 0.0)
    finish = np.asarray(roughness) / np.sqrt(b * np.asarray(reduced_radius))
    return _capped(0.014 * inverse**0.25 * finish**0.25 * factor, ceiling)


_XU = (
    -8.916465,
    1.03303,
    1.036077,
    -0.354068,
    2.812084,
    -0.100601,
    0.752755,
    -0.390958,
    0.620305,
)


def xu_kahraman(
    pressure: ArrayLike,
    *,
    sliding_speed: ArrayLike,
    entrainment: ArrayLike,
    viscosity: ArrayLike,
    reduced_radius: ArrayLike,
    roughness: ArrayLike = 0.0,
    pitch_floor: float = 0.01,
    ceiling: float = CEILING,
) -> Floats:
    """Local elastohydrodynamic friction by Xu and Kahraman, regularised at the pitch point [-].

    mu = e^f P_h^b2 |SR|^b3 v_e^b6 eta^b7 R^b8,
    f = b1 + b4 |SR| P_h log10(eta) + b5 exp(-|SR| P_h log10(eta)) + b9 exp(S);
    P_h GPa, v_e m/s, eta mPa s, R m, S um; SR = v_s/v_e.

    ``pressure`` P_h [Pa] greatest Hertz pressure, ``sliding_speed`` v_s [m/s] of either sign,
    ``entrainment`` v_e [m/s], ``viscosity`` eta [Pa s] of the oil at inlet, ambient pressure,
    ``reduced_radius`` [m], ``roughness`` rms Rq [m], from Ra by
    :func:`~thermogear.heat.film.rms_roughness` (0 for a smooth contact). Times
    tanh(|v_s|/(``pitch_floor`` v_e)), which takes it to 0 at pure rolling. Any shape; 0 at zero
    load. Fitted to one oil (75W90); the roughness term grows as exp(S) and is meant for
    smooth flanks. Source: Xu and Kahraman, J. Mech. Des. 129 (2007) 58-68; coefficients as in
    a thesis and in public code.

    >>> mu = xu_kahraman(
    ...     0.8e9, sliding_speed=1.0, entrainment=5.0, viscosity=0.02, reduced_radius=10e-3
    ... )
    >>> f"{mu:.4f}"
    '0.0167'
    """
    if not (np.isfinite(pitch_floor) and pitch_floor > 0.0):
        raise InputError("pitch_floor", pitch_floor, allowed="> 0")
    b1, b2, b3, b4, b5, b6, b7, b8, b9 = _XU
    p = np.asarray(pressure, dtype=float) * 1e-9
    eta = np.asarray(viscosity, dtype=float) * 1e3
    slide, roll = np.broadcast_arrays(
        np.abs(np.asarray(sliding_speed, dtype=float)), np.asarray(entrainment, dtype=float)
    )
    moving = roll > 0.0
    speed = np.where(moving, roll, 1.0)
    ratio = slide / speed
    thick = ratio * p * np.log10(eta)
    f = b1 + b4 * thick + b5 * np.exp(-thick) + b9 * np.exp(np.asarray(roughness) * 1e6)
    with np.errstate(over="ignore"):  # near the base circle it grows without bound: capped
        mu = np.exp(f) * p**b2 * ratio**b3 * speed**b6 * eta**b7
    mu = mu * np.asarray(reduced_radius, dtype=float) ** b8 * np.tanh(ratio / pitch_floor)
    at_rest = np.where(slide > 0.0, np.where(p > 0.0, ceiling, 0.0), 0.0)
    return np.asarray(np.where(moving, _capped(mu, ceiling), at_rest))


def doleschel_share(film_parameter: ArrayLike) -> Floats:
    """Share of boundary friction by Doleschel, xi = (1 - lambda/2)^2 below lambda = 2 [-].

    ``film_parameter`` lambda [-] >= 0, any shape: the central film over the mean Ra of both
    flanks, :func:`~thermogear.heat.film.mean_roughness_film_parameter`, not the Lambda of the
    regimes. 1 at 0, 0 from 2 on, without a kink there. Source: Doleschel (thesis, Munich 2003)
    in Arana, Larranaga and Ulacia, Proc. IMechE J 233 (2019) 303-316, table 1 ("a second-order
    polynomial"); public FZG code expands the same square, 0.25 lambda^2 - lambda + 1.

    >>> doleschel_share([0.0, 1.0, 2.0])
    array([1.  , 0.25, 0.  ])
    """
    reach = 1.0 - 0.5 * np.minimum(np.asarray(film_parameter, dtype=float), 2.0)
    return np.asarray(reach**2)
