"""How tooth pairs share the load when the gear bodies are rigid or uncoupled springs."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.gears.pair import GearPair
from thermogear.gears.stiffness import Moduli, pair_stiffness


def _mates(pair: GearPair, s: ArrayLike) -> tuple[Floats, NDArray[np.bool_]]:
    """Positions of all pairs that may touch while one touches at s, and which of them do.

    First axis: the pairs, -ceil(eps) .. ceil(eps) base pitches away. On the half-open path
    [A, E) so that a pair entering replaces the one leaving.
    """
    s_ = np.asarray(s, dtype=float)
    reach = int(np.ceil(pair.contact_ratio))
    steps = np.arange(-reach, reach + 1).reshape((-1,) + (1,) * s_.ndim)
    mates = s_ + steps * pair.base_pitch
    slack = 1e-12 * pair.base_pitch
    with np.errstate(invalid="ignore"):
        inside = (mates >= pair.path.a - slack) & (mates < pair.path.e - slack)
        # the pair asked for counts at both ends of the path
        inside[reach] = (s_ >= pair.path.a - slack) & (s_ <= pair.path.e + slack)
    return mates, inside


def equal_share(pair: GearPair, s: ArrayLike) -> Floats:
    """Share of the load of a pair at ``s`` [m] when all pairs in contact carry the same.

    1 in single, 1/2 in double contact, 0 off the path; any shape. Shares of the pairs in
    contact sum to 1, except at the very end E, where the leaving pair still counts itself.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> equal_share(pair, [pair.path.a, pair.path.c])
    array([0.5, 1. ])
    """
    mates, inside = _mates(pair, s)
    reach = mates.shape[0] // 2
    return np.asarray(np.where(inside[reach], 1.0 / np.maximum(inside.sum(axis=0), 1), 0.0))


def stiffness_share(
    pair: GearPair,
    s: ArrayLike,
    start: str = "root-circle",
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
) -> Floats:
    """Share of a pair at ``s`` [m] in proportion to its textbook stiffness: k/sum k_j.

    Perfect flanks, uncoupled pairs. Arguments as :func:`pair_stiffness`; 0 off the path.

    >>> pair = GearPair(Gear(30, 4e-3), Gear(45, 4e-3))
    >>> share = stiffness_share(pair, pair.path.a + np.array([0.0, pair.base_pitch]))
    >>> f"{share.sum():.3f}"
    '1.000'
    """
    mates, inside = _mates(pair, s)
    reach = mates.shape[0] // 2
    # mate by mate, so that the moduli's axes meet those of s
    stiffness = [
        np.where(here, pair_stiffness(pair, mate, start, pinion, wheel), 0.0)
        for mate, here in zip(mates, inside, strict=True)
    ]
    total = np.asarray(sum(stiffness))
    return np.asarray(
        np.divide(stiffness[reach], total, out=np.zeros_like(total), where=total > 0.0)
    )
