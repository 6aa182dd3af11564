"""Limits of a rolling bearing under load: rating life and its factor, static safety, least load."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
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
