"""Extended contact: where tooth pairs meet before A and beyond E, on a tip corner.

A pair whose involutes would meet off the path of contact cannot touch there; a loaded mesh
lets the tip corner of one tooth touch the other's flank, early on the way in and late on the
way out. The gap of a pair is how far the mesh must advance along the line of action before
it touches. Plane kinematics, exact; the only approximation is that the elastic advance does
not move the point of contact.

Frame: origin at the pinion's centre, first axis to its tangent point N1, second along the
line of action; as complex numbers an involute's string of length l that leaves the base
circle at the angle psi from N1 ends at (r_b + i l) exp(i psi).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.gears.geometry import GearPair

Floats = NDArray[np.float64]


class ContactPoint(NamedTuple):
    """Where a tooth pair touches: string lengths rho_1, rho_2 [m] and the gap [m] to touching.

    On the path rho_1 + rho_2 = N1N2 and the gap is 0; inf where the corner misses the flank.
    """

    pinion: Floats
    wheel: Floats
    gap: Floats


def contact_point(pair: GearPair, s: ArrayLike, extended: bool = True) -> ContactPoint:
    """Contact of a pair whose involutes would meet at ``s`` [m] on the line of action.

    A <= s <= E: the involutes themselves. s > E: the pinion's tip corner, at string length s_E
    turned (s - s_E)/r_b1 further, on the wheel's flank; s < A: the wheel's tip corner on the
    pinion's. The gap grows from 0 at the path's ends. ``extended`` False: inf off the path.
    Any shape.
    """
    shape = np.shape(s)
    s_ = np.atleast_1d(np.asarray(s, dtype=float))
    path, length = pair.path, pair.line_of_action
    r1, r2 = pair.pinion.base_radius, pair.wheel.base_radius
    slack = 1e-12 * pair.base_pitch
    late, early = s_ > path.e + slack, s_ < path.a - slack
    rho1, rho2, gap = s_.copy(), length - s_, np.zeros_like(s_)
    if not extended:
        gap[late | early] = np.inf
        return ContactPoint(rho1.reshape(shape), rho2.reshape(shape), gap.reshape(shape))

    past = s_[late]
    corner = (r1 + 1j * path.e) * np.exp(1j * (past - path.e) / r1)
    # seen from the wheel's centre, with its axes turned to meet its own string
    seen = np.conj((r1 + r2 + 1j * length) - corner)
    string = np.sqrt(np.maximum(np.abs(seen) ** 2 - r2**2, 0.0))
    turn = np.angle(seen / (r2 - 1j * string))
    rho1[late], rho2[late] = path.e, string
    gap[late] = past - (length - string + r2 * turn)
    lowest, highest = r2 * pair.wheel.junction[1], length - path.a
    gap[late] = np.where((string < lowest) | (string > highest), np.inf, gap[late])

    before = s_[early]
    tip = length - path.a
    wheel_tip = np.conj((r2 - 1j * tip) * np.exp(1j * (before - path.a) / r2))
    corner = (r1 + r2 + 1j * length) - wheel_tip
    string = np.sqrt(np.maximum(np.abs(corner) ** 2 - r1**2, 0.0))
    turn = np.angle(corner / (r1 + 1j * string))
    rho1[early], rho2[early] = string, tip
    gap[early] = string + r1 * turn - before
    lowest, highest = r1 * pair.pinion.junction[1], path.e
    gap[early] = np.where((string < lowest) | (string > highest), np.inf, gap[early])
    return ContactPoint(rho1.reshape(shape), rho2.reshape(shape), gap.reshape(shape))
