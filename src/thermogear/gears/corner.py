"""Where flanks meet off the path of contact: any point of one on the other, tip corners too.

A pair whose involutes would meet off the path of contact cannot touch there; a loaded mesh
lets the tip corner of one tooth touch the other's flank, early on the way in and late on the
way out. The gap of a pair is how far the mesh must advance along the line of action before
it touches. Plane kinematics, exact; the only approximation is that the elastic advance does
not move the point of contact.

Where undercut ends the path before a tip does, its edge on the undercut gear takes the place of
that corner.

Frame: origin at the pinion's centre, first axis to its tangent point N1, second along the
line of action; as complex numbers an involute's string of length l that leaves the base
circle at the angle psi from N1 ends at (r_b + i l) exp(i psi).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.gears.pair import GearPair


class ContactPoint(NamedTuple):
    """Where a tooth pair touches: string lengths rho_1, rho_2 [m] and the gap [m] to touching.

    On the path rho_1 + rho_2 = N1N2 and the gap is 0; inf where the corner misses the flank.
    """

    pinion: Floats
    wheel: Floats
    gap: Floats


def off_path(pair: GearPair, s: Floats) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(s < s_A, s > s_E), rounding aside: where the wheel's, the pinion's tip corner touches.

    Where undercut ends the path there, its edge does.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [flag.tolist() for flag in off_path(pair, np.array([pair.path.c, pair.path.e + 1e-3]))]
    [[False, False], [False, True]]
    """
    slack = 1e-12 * pair.base_pitch
    return s < pair.path.a - slack, s > pair.path.e + slack


def pinion_point(pair: GearPair, s: ArrayLike, *, rho: ArrayLike) -> tuple[Floats, Floats]:
    """Where a point of the pinion's flank meets the wheel's involute, and the advance till then.

    s [m]: where the pair's involutes would meet; rho [m]: string length of the pinion's point,
    whose string has turned by (s - rho)/r_b1. Returns (string length on the wheel, advance along
    the line of action), both [m], any shape that broadcasts; the advance is 0 for rho = s and
    grows with the square of the distance.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> rho, advance = pinion_point(pair, pair.path.c, rho=pair.path.c)
    >>> f"{1e3 * rho:.2f} mm, {1e6 * advance:.2f} um"
    '27.36 mm, 0.00 um'
    """
    r1, r2, length = pair.pinion.base_radius, pair.wheel.base_radius, pair.line_of_action
    s_, rho_ = np.asarray(s, dtype=float), np.asarray(rho, dtype=float)
    point = (r1 + 1j * rho_) * np.exp(1j * (s_ - rho_) / r1)
    # seen from the wheel's centre, with its axes turned to meet its own string
    seen = np.conj((r1 + r2 + 1j * length) - point)
    string = np.sqrt(np.maximum(np.abs(seen) ** 2 - r2**2, 0.0))
    turned = seen / (r2 - 1j * string)
    turn = np.arctan2(turned.imag, turned.real)
    return string, s_ - (length - string + r2 * turn)


def wheel_point(pair: GearPair, s: ArrayLike, *, rho: ArrayLike) -> tuple[Floats, Floats]:
    """:func:`pinion_point` with the gears exchanged: a point of the wheel's flank.

    Returns (string length on the pinion, advance), both [m].

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> s = pair.path.c
    >>> rho, advance = wheel_point(pair, s, rho=pair.line_of_action - s)
    >>> f"{1e3 * rho:.2f} mm, {1e6 * advance:.2f} um"
    '13.68 mm, 0.00 um'
    """
    r1, r2, length = pair.pinion.base_radius, pair.wheel.base_radius, pair.line_of_action
    s_, rho_ = np.asarray(s, dtype=float), np.asarray(rho, dtype=float)
    own = np.conj((r2 - 1j * rho_) * np.exp(1j * (s_ - (length - rho_)) / r2))
    point = (r1 + r2 + 1j * length) - own
    string = np.sqrt(np.maximum(np.abs(point) ** 2 - r1**2, 0.0))
    return string, string + r1 * np.angle(point / (r1 + 1j * string)) - s_


def flank_ends(pair: GearPair) -> tuple[tuple[float, float], tuple[float, float]]:
    """String lengths [m] of form circle and tip, of pinion and wheel.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e3 * flank_ends(pair)[0][1]:.2f} mm"
    '22.87 mm'
    """
    return (
        (pair.pinion.base_radius * pair.pinion.junction[1], pair.tip_ends[1]),
        (pair.wheel.base_radius * pair.wheel.junction[1], pair.line_of_action - pair.tip_ends[0]),
    )


def contact_point(pair: GearPair, s: ArrayLike, extended: bool = True) -> ContactPoint:
    """Contact of a pair whose involutes would meet at ``s`` [m] on the line of action.

    A <= s <= E: the involutes themselves. s > E: the pinion's tip corner, at string length s_E
    turned (s - s_E)/r_b1 further, on the wheel's flank; s < A: the wheel's tip corner on the
    pinion's. The gap grows from 0 at the path's ends. ``extended`` False: inf off the path.
    Any shape.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e6 * contact_point(pair, pair.path.e + 1e-3).gap:.1f} um"
    '18.9 um'
    """
    shape = np.shape(s)
    s_ = np.atleast_1d(np.asarray(s, dtype=float))
    length = pair.line_of_action
    early, late = off_path(pair, s_)
    rho1, rho2, gap = s_.copy(), length - s_, np.where(early | late, np.inf, 0.0)
    first, second = flank_ends(pair)
    # whose edge it may be: a tip's, or that of the other gear's undercut
    edges = (
        (late, pinion_point, rho1, rho2, second, first[1]),
        (early, wheel_point, rho2, rho1, first, second[1]),
        (late, wheel_point, rho2, rho1, first, second[0]),
        (early, pinion_point, rho1, rho2, second, first[0]),
    )
    count = (4 if pair.cut_short else 2) if extended else 0
    for here, corner, own, other, (lowest, highest), edge in edges[:count]:
        string, advance = corner(pair, s_[here], rho=edge)
        advance[(string < lowest) | (string > highest)] = np.inf
        nearer = advance <= gap[here]
        at = tuple(axis[nearer] for axis in np.nonzero(here))
        own[at], other[at], gap[at] = edge, string[nearer], advance[nearer]
    return ContactPoint(rho1.reshape(shape), rho2.reshape(shape), gap.reshape(shape))
