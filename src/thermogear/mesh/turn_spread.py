"""Flash temperature, pressure and film of the tooth pairs of a turn, one beside another."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.mesh.elastic import BLOCK, ElasticPair, PathShare
from thermogear.mesh.friction_path import FrictionPath

WORST: dict[str, tuple[Callable[[FrictionPath], Floats], float]] = {
    "flash_temperature": (lambda path: path.flash(path.friction), 1.0),
    # Hertz's formula says nothing about a corner
    "hertz_pressure": (lambda path: np.where(path.edge > 0, 0.0, path.pressure), 1.0),
    "film_parameter": (lambda path: path.film_parameter, -1.0),
    "contact_temperature": (lambda path: path.contact(path.flash(path.friction)), 1.0),
}
"""What is worst where, and its sign: the least film, the greatest of all else."""
DECILE = 0.9
"""Part of the tooth pairs that are no worse than the decile."""


def _names(name: str, sign: float) -> tuple[str, ...]:
    worst = "greatest" if sign > 0.0 else "least"
    of_pairs = (f"{name}_{kind}_of_turn" for kind in ("median", "decile", worst))
    return (*of_pairs, f"{name}_pinion_tooth", f"{name}_wheel_tooth")


OF_TURN = {made: name for name, (_, sign) in WORST.items() for made in _names(name, sign)}
"""Every quantity of :func:`spread_of_turn` and what it is of."""

OF_WORST_PAIR = {
    "greatest_flash_temperature": "flash_temperature",
    "greatest_contact_temperature": "contact_temperature",
    "least_film_parameter": "film_parameter",
}
"""Of the tooth pair that is worst, each by its worst place: what is judged, and of what it is."""


def spread_of_turn(elastic: ElasticPair, s: Floats, every: PathShare) -> dict[str, Floats]:
    """Of the tooth pairs of a turn, each by its worst place of ``s`` [m]; (count,) each.

    The median over the tooth pairs, the value that 90 % of them do not pass, and the worst of all
    with the teeth that have it, counted from 1. ``every``: their shares
    (:func:`~thermogear.mesh.elastic.tooth_pair_shares`). All nan at an operating point whose
    loaded contact is not known.
    """
    count, periods, places = every.share.shape
    step, parts = max(BLOCK // (count * places), 1), []
    for first in range(0, periods, step):
        share = every.share[:, first : first + step].reshape(count, -1)
        edge = every.edge[:, first : first + step].reshape(count, -1)
        path = FrictionPath(elastic, np.resize(s, share.shape[1]), PathShare(share, edge))
        along = [sign * np.broadcast_to(of(path), share.shape) for of, sign in WORST.values()]
        parts.append(np.reshape(along, (len(along), count, -1, places)).max(axis=-1))
    spread: dict[str, Floats] = {}
    for (name, (_, sign)), rising in zip(WORST.items(), np.concatenate(parts, -1), strict=True):
        # values that occur: between two infinite films there is none
        of_pairs = sign * np.quantile(rising, [0.5, DECILE, 1.0], axis=1, method="inverted_cdf")
        pair = np.argmax(rising, axis=1)
        teeth = [1.0 + pair % gear.teeth for gear in (elastic.pair.pinion, elastic.pair.wheel)]
        spread |= dict(zip(_names(name, sign), (*of_pairs, *teeth), strict=True))
    settled = np.isfinite(every.share).all(axis=(1, 2))
    return {name: np.where(settled, values, np.nan) for name, values in spread.items()}
