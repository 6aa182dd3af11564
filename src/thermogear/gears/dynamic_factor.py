"""Dynamic factor K_v by ISO 6336-1: what a standard says a mesh's vibration adds to its load.

Method B puts the pair's first resonance against the speed, with an accuracy grade's deviations
and the running-in they lose. It is for one stage between rigid shafts: a pair that loses contact,
and a jump, it does not know.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.gears.accuracy import flank_tolerances
from thermogear.gears.geometry import Gear
from thermogear.gears.iso6336 import iso6336_stiffness, pinion_first
from thermogear.gears.pair import GearPair

SURFACES = ("case-hardened", "through-hardened")
_LOW_LOAD = 100e3  # N/m
_MAIN_END, _OVER = 1.15, 1.5  # ends of the main resonance and of the range between
BRANCHES = ("subcritical", "main resonance", "intermediate", "supercritical")


class DynamicFactor(NamedTuple):
    """K_v and what it rests on, arrays of the broadcast shape of torque and speed.

    factor: K_v [-], at least 1; ratio: N = n/n_E1 [-]; resonance: speed of the gear with fewer
    teeth at N = 1 [rad/s]; branch: place in :data:`BRANCHES`; line_load: F_t K_A/b [N/m];
    pitch, form, relief: B_p, B_f, B_k [-].
    """

    factor: Floats
    ratio: Floats
    resonance: Floats
    branch: NDArray[np.int64]
    line_load: Floats
    pitch: Floats
    form: Floats
    relief: Floats


def reduced_mass(pair: GearPair) -> float:
    """m_red [kg/m] of a pair per metre of face width, on the line of action.

    m_red = (pi/8)(d_m1/d_b1)^2 d_m1^2/[1/((1 - q1^4) rho1) + 1/((1 - q2^4) rho2 u^2)],
    d_m = (d_a + d_f)/2, q = bore/d_m. The gear with fewer teeth is 1. Source: ISO 6336-1:2006,
    eq. 30 (discs; the wheel as the pinion's size by u).

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{reduced_mass(pair):.2f} kg/m"
    '16.54 kg/m'
    """
    first, second = pinion_first(pair)
    mean = [gear.tip_radius + gear.root_radius for gear in (first, second)]
    solid = [
        (1.0 - (2.0 * gear.bore_radius / size) ** 4) * gear.material.density
        for gear, size in zip((first, second), mean, strict=True)
    ]
    ratio = second.teeth / first.teeth
    size = np.pi / 8.0 * (mean[0] / (2.0 * first.base_radius)) ** 2 * mean[0] ** 2
    return float(size / (1.0 / solid[0] + 1.0 / (solid[1] * ratio**2)))


def resonance_speed(stiffness: ArrayLike, mass: ArrayLike, *, teeth: int) -> Floats:
    """omega_E1 = sqrt(c_gamma/m_red)/z1 [rad/s]; ISO prints n_E1 = 30000/(pi z1) sqrt(...).

    ``stiffness`` c_gamma_alpha [N/m^2], ``mass`` m_red [kg/m], ``teeth`` z1. Any shape.
    Source: ISO 6336-1:2006, eq. 6.

    >>> f"{resonance_speed(20e9, 8.0, teeth=20):.0f} rad/s"
    '2500 rad/s'
    """
    return np.asarray(np.sqrt(np.asarray(stiffness, dtype=float) / np.asarray(mass)) / teeth)


def resonance_edge(line_load: ArrayLike) -> Floats:
    """N_S where the main resonance begins: 0.85, below 100 N/mm 0.5 + 0.35 sqrt(w/100).

    ``line_load`` w = F_t K_A/b [N/m], any shape. Source: ISO 6336-1:2006, eq. 11, 12.

    >>> [f"{edge:.3f}" for edge in resonance_edge([25e3, 200e3])]
    ['0.675', '0.850']
    """
    low = np.minimum(np.asarray(line_load, dtype=float) / _LOW_LOAD, 1.0)
    return np.asarray(0.5 + 0.35 * np.sqrt(low))


def branch_factors(contact_ratio: float) -> tuple[float, ...]:
    """C_v1 .. C_v7 of a total contact ratio eps_gamma >= 1 (eps_alpha of spur gears) [-].

    To 2: 0.32, 0.34, 0.23, 0.90, 0.47, 0.47; above: 0.32, 0.57/(e - 0.3), 0.096/(e - 1.56),
    (0.57 - 0.05 e)/(e - 1.44), 0.47, 0.12/(e - 1.74). C_v7: 0.75 to 1.5, 0.125 sin(pi(e - 2)) +
    0.875 to 2.5, 1 beyond. At 2 the source steps, by 9 % at most. Raises below 1.
    Source: ISO 6336-1:2006, table 8.

    >>> branch_factors(1.5)
    (0.32, 0.34, 0.23, 0.9, 0.47, 0.47, 0.75)
    """
    e = contact_ratio
    if not e >= 1.0:
        raise InputError("contact ratio", f"{e:.4g}", allowed=">= 1")
    if e <= 2.0:
        first = (0.32, 0.34, 0.23, 0.90, 0.47, 0.47)
    else:
        fourth = (0.57 - 0.05 * e) / (e - 1.44)
        first = (0.32, 0.57 / (e - 0.3), 0.096 / (e - 1.56), fourth, 0.47, 0.12 / (e - 1.74))
    if e <= 1.5:
        return (*first, 0.75)
    return (*first, 0.125 * float(np.sin(np.pi * (e - 2.0))) + 0.875 if e <= 2.5 else 1.0)


def running_in_relief(endurance: float) -> float:
    """C_ay = (s_Hlim/97 - 18.45)^2/18 + 1.5 um [m]: tip relief that running in makes.

    ``endurance`` s_Hlim [Pa] (N/mm^2 in the formula). Source: ISO 6336-1:2006, eq. 17.

    >>> f"{1e6 * running_in_relief(1500e6):.2f} um"
    '2.00 um'
    """
    return ((endurance * 1e-6 / 97.0 - 18.45) ** 2 / 18.0 + 1.5) * 1e-6


def running_in(
    deviation: float, *, endurance: float, pitch_speed: ArrayLike, surface: str
) -> Floats:
    """y [m]: by how much running in lessens a pitch or form deviation.

    case-hardened: 0.075 f, 3 um at most; through-hardened: 160 f/s_Hlim, at most 12800/s_Hlim um
    above 5 m/s and 6400/s_Hlim um above 10 m/s (the two caps usual, unconfirmed; they are those
    of 80 and 40 um).

    ``deviation`` f [m], ``endurance`` s_Hlim [Pa] of the softer gear (N/mm^2 in the formula),
    ``pitch_speed`` v [m/s], any shape, ``surface`` out of :data:`SURFACES`. Never more than f.
    Source: ISO 6336-1:2006, clause 8.

    >>> less = running_in(10e-6, endurance=1500e6, pitch_speed=5.0, surface="case-hardened")
    >>> f"{1e6 * less:.2f} um"
    '0.75 um'
    """
    require_choice("surface", surface, SURFACES)
    v = np.asarray(pitch_speed, dtype=float)
    if surface == "case-hardened":
        return np.full(v.shape, min(0.075 * deviation, 3e-6))
    cap = np.where(v <= 5.0, np.inf, np.where(v <= 10.0, 80e-6, 40e-6))
    return np.asarray(np.minimum(160.0 / (endurance * 1e-6), 1.0) * np.minimum(deviation, cap))


def factor_of_resonance(
    ratio: ArrayLike,
    *,
    pitch: ArrayLike,
    form: ArrayLike,
    relief: ArrayLike,
    contact_ratio: float,
    edge: ArrayLike = 0.85,
) -> tuple[Floats, NDArray[np.int64]]:
    """K_v, at least 1, and the branch (place in :data:`BRANCHES`) at a resonance ratio N.

    N <= N_S: 1 + N (C_v1 B_p + C_v2 B_f + C_v3 B_k); to 1.15: 1 + C_v1 B_p + C_v2 B_f + C_v4 B_k;
    from 1.5 on: C_v5 B_p + C_v6 B_f + C_v7; between 1.15 and 1.5 linear.

    ``ratio`` N >= 0, ``pitch``, ``form``, ``relief``: B_p, B_f, B_k, ``edge`` N_S, any shapes;
    ``contact_ratio`` eps_gamma. Source: ISO 6336-1:2006, eq. 13-22.

    >>> factor, branch = factor_of_resonance(
    ...     0.5, pitch=0.2, form=0.2, relief=1.0, contact_ratio=1.6
    ... )
    >>> f"{factor:.3f}, {BRANCHES[branch]}"
    '1.181, subcritical'
    """
    n, b_p, b_f, b_k = (np.asarray(a, dtype=float) for a in (ratio, pitch, form, relief))
    c1, c2, c3, c4, c5, c6, c7 = branch_factors(contact_ratio)
    below = 1.0 + n * (c1 * b_p + c2 * b_f + c3 * b_k)
    main = 1.0 + c1 * b_p + c2 * b_f + c4 * b_k
    above = c5 * b_p + c6 * b_f + c7
    weight = (_OVER - n) / (_OVER - _MAIN_END)
    between = weight * main + (1.0 - weight) * above
    branch = np.where(n <= np.asarray(edge), 0, np.where(n <= _MAIN_END, 1, 2 + (n >= _OVER)))
    found = np.choose(branch, np.broadcast_arrays(below, main, between, above))
    return np.asarray(np.maximum(found, 1.0)), np.asarray(branch, dtype=np.int64)


def dynamic_factor(
    pair: GearPair,
    torque: ArrayLike,
    speed: ArrayLike,
    *,
    grade: int,
    edition: str = "2013",
    application: float = 1.0,
    tip_relief: float | None = None,
    surface: str = "case-hardened",
    endurance: float = 1500e6,
    blank: float = 1.0,
) -> DynamicFactor:
    """K_v of a spur pair by method B.

    B_p = c' (f_pb - y_p)/w, B_f = c' (f_fa - y_f)/w, B_k = |1 - c' C_a/w|, 1 from grade 6 on;
    f_pb = f_pT cos(alpha) and f_fa the greater of both gears', unrounded; N = n/n_E1, the branches
    as :func:`factor_of_resonance`. The source's pinion is the gear with fewer teeth.

    ``torque`` [N m] > 0 and ``speed`` [rad/s] >= 0 of ``pair.pinion``, any shapes; ``grade`` and
    ``edition`` of ISO 1328-1; ``application`` K_A; ``tip_relief`` C_a [m], left out: what running
    in makes, :func:`running_in_relief`; ``surface``, ``endurance`` s_Hlim [Pa] (1500 N/mm^2 for
    case-hardened steel is usual, unconfirmed) as :func:`running_in`; ``blank`` C_R as
    :func:`~thermogear.gears.iso6336.iso6336_stiffness`, which warns outside its shifts. Raises
    without load or for a grade that does not exist. Below a contact ratio of 1.2 c' is up to 10 %
    too high. Source: ISO 6336-1:2006, method B, clause 6.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{dynamic_factor(pair, 200.0, 100.0, grade=7).factor:.3f}"
    '1.039'
    """
    moment, turning = np.asarray(torque, dtype=float), np.asarray(speed, dtype=float)
    if not np.all(np.isfinite(moment) & (moment > 0.0)):
        raise InputError("torque", f"{moment} N m", allowed="> 0, finite")
    if not np.all(np.isfinite(turning) & (turning >= 0.0)):
        raise InputError("speed", f"{turning} rad/s", allowed=">= 0, finite")
    load = moment * application / (pair.pinion.pitch_radius * pair.face_width)
    load, turning = np.broadcast_arrays(load, turning)
    stiffness = iso6336_stiffness(pair, load, blank=blank)
    first, _ = pinion_first(pair)
    resonance = resonance_speed(stiffness.mesh, reduced_mass(pair), teeth=first.teeth)
    pace = turning * pair.pinion.teeth / first.teeth
    pitch, form = _deviations(pair, grade, edition)
    v = turning * pair.pinion.pitch_radius

    def acting(f: float) -> Floats:
        left = f - running_in(f, endurance=endurance, pitch_speed=v, surface=surface)
        return np.asarray(stiffness.single * left / load)

    eased = running_in_relief(endurance) if tip_relief is None else tip_relief
    b_k = np.abs(1.0 - stiffness.single * eased / load) if grade < 6 else np.ones(load.shape)
    b_p, b_f, ratio = acting(pitch), acting(form), np.asarray(pace / resonance)
    factor, branch = factor_of_resonance(
        ratio,
        pitch=b_p,
        form=b_f,
        relief=b_k,
        contact_ratio=pair.contact_ratio,
        edge=resonance_edge(load),
    )
    return DynamicFactor(factor, ratio, resonance, branch, load, b_p, b_f, np.asarray(b_k))


def _deviations(pair: GearPair, grade: int, edition: str) -> tuple[float, float]:
    """f_pb and f_fa [m], the greater of both gears'."""
    gears: tuple[Gear, ...] = (pair.pinion, pair.wheel)
    limits = [flank_tolerances(g.teeth, g.module, grade=grade, edition=edition) for g in gears]
    pitch = max(one.single_pitch for one in limits) * float(np.cos(pair.pinion.pressure_angle))
    return pitch, max(one.profile_form for one in limits)
