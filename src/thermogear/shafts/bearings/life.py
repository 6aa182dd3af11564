"""Limits of a rolling bearing under load: rating life and its factor, static safety, least load."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.shafts.bearings.geometry import RollingBearing


def rating_life(bearing: RollingBearing, load: ArrayLike) -> Floats:
    """L10 = (C/P)^p in turns, p = 3 balls, 10/3 rollers; P the radial ``load`` [N].

    Nan where the rating C is unknown, infinite without load. Source: ISO 281.

    >>> from thermogear.shafts.bearings.catalogue import catalogue_bearing
    >>> f"{float(rating_life(catalogue_bearing('6205'), 1480.0)):.3g} turns"
    '1e+09 turns'
    """
    power = 3.0 if bearing.kind == "ball" else 10.0 / 3.0
    rating = np.nan if bearing.dynamic_rating is None else bearing.dynamic_rating
    with np.errstate(divide="ignore"):
        return np.asarray(1e6 * (rating / np.abs(np.asarray(load, dtype=float))) ** power)


def static_safety(bearing: RollingBearing, load: ArrayLike) -> Floats:
    """s0 = C0/P0 [-], P0 the radial ``load`` [N]; 1 to 2 is usual. Nan where C0 is unknown."""
    rating = np.nan if bearing.static_rating is None else bearing.static_rating
    with np.errstate(divide="ignore"):
        return np.asarray(rating / np.abs(np.asarray(load, dtype=float)))


def least_load(bearing: RollingBearing) -> float:
    """Load [N] below which elements may slide: 0.01 C of balls, 0.02 C of rollers (SKF's rule)."""
    if bearing.dynamic_rating is None:
        return float("nan")
    return (0.01 if bearing.kind == "ball" else 0.02) * bearing.dynamic_rating


def viscosity_ratio(bearing: RollingBearing, *, viscosity: ArrayLike, speed: ArrayLike) -> Floats:
    """kappa = nu/nu1 [-], nu1 = 45000 n^-0.83 d_m^-0.5, from 1000 rpm 4500 (n d_m)^-0.5 [mm^2/s].

    ``viscosity`` nu [m^2/s] of the oil in the bearing, ``speed`` [rad/s]; n in rpm, d_m in mm;
    shapes broadcast; 0 at rest. The two branches of nu1 differ by 2.3 % at 1000 rpm. Source: ISO
    281.

    >>> from thermogear.shafts.bearings.catalogue import catalogue_bearing
    >>> one = catalogue_bearing("6205")
    >>> f"{float(viscosity_ratio(one, viscosity=20e-6, speed=3000 * np.pi / 30)):.2f}"
    '1.51'
    """
    turns = np.abs(np.asarray(speed, dtype=float)) * 30.0 / np.pi
    size = 1e3 * bearing.pitch_diameter
    # 1/nu1, which stays finite at rest
    wanted = np.where(
        turns < 1000.0, turns**0.83 * size**0.5 / 45000.0, (turns * size) ** 0.5 / 4500.0
    )
    return np.asarray(1e6 * np.asarray(viscosity, dtype=float) * wanted)


_LOSS = {
    "ball": ((2.2649, 0.054381), (1.9987, 0.19087), (1.9987, 0.071739)),
    "roller": ((1.3993, 0.054381), (1.2348, 0.19087), (1.2348, 0.071739)),
}
"""A and B of A/kappa^B in ISO 281's a_ISO, for kappa below 0.4, below 1 and up to 4."""


def life_factor(kind: str, *, viscosity_ratio: ArrayLike, fatigue_ratio: ArrayLike) -> Floats:
    """a_ISO of L_nm = a_ISO L10 [-], 0.1 to 50.

    Balls 0.1 (1 - (2.5671 - A/kappa^B)^0.83 r^(1/3))^-9.3, rollers 0.1 (1 - (1.5859 - A/kappa^B)
    r^0.4)^-9.185, r the ``fatigue_ratio`` e_C C_u/P: contamination e_C 0..1, fatigue load limit C_u
    of the maker, load P. kappa above 4 counts as 4; nan below 0.1, where ISO 281 does not reach.
    Source: ISO 281 by public codes; checked for steps at 0.4 and 1.

    >>> f"{float(life_factor('ball', viscosity_ratio=1.0, fatigue_ratio=0.1)):.2f}"
    '2.43'
    """
    if kind not in _LOSS:
        raise InputError("kind", repr(kind), allowed=" | ".join(_LOSS))
    kappa = np.asarray(viscosity_ratio, dtype=float)
    ratio = np.maximum(np.asarray(fatigue_ratio, dtype=float), 0.0)
    held = np.clip(kappa, 0.1, 4.0)
    branch = np.searchsorted([0.4, 1.0], held, side="right")
    factor, power = np.moveaxis(np.asarray(_LOSS[kind])[branch], -1, 0)
    if kind == "ball":
        film = np.maximum(2.5671 - factor / held**power, 0.0) ** 0.83 * np.cbrt(ratio)
        slope = -9.3
    else:
        film = np.maximum(1.5859 - factor / held**power, 0.0) * ratio**0.4
        slope = -9.185
    # 50 is reached well before the bracket is zero
    found = np.minimum(0.1 * np.maximum(1.0 - film, 1e-3) ** slope, 50.0)
    return np.asarray(np.where(kappa >= 0.1, found, np.nan))
