"""Where flanks meet off the path of contact: any point of one on the other, tip edges too.

A pair whose involutes would meet off the path of contact cannot touch there; a loaded mesh
lets the tip's edge of one tooth touch the other's flank, early on the way in and late on the
way out. The gap of a pair is how far the pinion must turn, along its base circle, before it
touches. Plane kinematics, exact; the only approximation is that the advance moves neither the
point of contact nor its normal.

Where undercut ends the path before a tip does, its edge on the undercut gear takes the place of
that edge.

Frame: origin at the centre of the gear whose edge it is, first axis to its tangent point, second
along the line of action; as complex numbers an involute's string of length l that leaves the base
circle at the angle psi from there ends at (r_b + i l) exp(i psi).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.gears.pair import GearPair

TILTED, FREE = 0.65, 0.6
"""Widths [-] of a contact by an edge, measured here against plane finite elements: parts of a
tilted punch's length and of the involutes' half width, both within 25 %."""


class ContactPoint(NamedTuple):
    """Where a tooth pair touches: string lengths rho_1, rho_2 [m] and the gap [m] to touching.

    On the path rho_1 + rho_2 = N1N2 and the gap is 0; inf where the edge misses the flank.
    gap: advance of the pinion along its base circle, the wheel at rest; off the path that is what
    is open along the mate's normal over the lever. lever: arm of the pair's force about the
    pinion's axis over r_b1, 1 on the path and where the wheel's edge touches; angle [rad] >= 0:
    from the normal of the flank that the edge ends to the mate's, along which the force acts,
    towards that flank's root, 0 on the path; rounding [m]: reduced radius r* of the edge that
    touches or is nearest and its mate's flank, 1/r* = 1/r_e + 1/rho; distance [m]: along the flank
    to that edge, 0 off the path.
    """

    pinion: Floats
    wheel: Floats
    gap: Floats
    lever: Floats
    angle: Floats
    rounding: Floats
    distance: Floats


class Meeting(NamedTuple):
    """Where a point or an edge meets the mate's involute.

    string [m] of the mate's point; gap [m] until then; angle theta [rad] from the normal of the
    flank to the mate's; lever: arm of a force along the mate's normal about the gear's own axis
    over its base radius.
    """

    string: Floats
    gap: Floats
    angle: Floats
    lever: Floats


def off_path(pair: GearPair, s: Floats) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(s < s_A, s > s_E), rounding aside: where the wheel's, the pinion's tip corner touches.

    Where undercut ends the path there, its edge does.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [flag.tolist() for flag in off_path(pair, np.array([pair.path.c, pair.path.e + 1e-3]))]
    [[False, False], [False, True]]
    """
    slack = 1e-12 * pair.base_pitch
    return s < pair.path.a - slack, s > pair.path.e + slack


def pinion_point(
    pair: GearPair, s: ArrayLike, *, rho: ArrayLike, rounding: ArrayLike = 0.0
) -> Meeting:
    """Where a point of the pinion's flank meets the wheel's involute, and the gap till then.

    s [m]: where the pair's involutes would meet; rho [m]: string length of the pinion's point,
    whose string has turned by (s - rho)/r_b1. ``rounding`` r_e [m]: radius of a circle that touches
    the flank there from inside, its centre c at the string rho - r_e. Seen from the wheel c lies at
    R = |c|, on the string q = sqrt(R^2 - r_b2^2) that has turned by psi; the wheel's involute ends
    at q_i on the same string, which is its normal:

        gap = q - q_i - r_e,   theta = (s - rho)/r_b1 + psi,
        lever = cos(theta) - (rho - r_e)/r_b1 sin(theta)

    (the arm of the wheel's normal through c about the pinion's centre). The gap is 0 for rho = s
    and grows with the square of the distance; as the mesh moves on by ds it opens by
    (1 - lever) ds. Any shapes that broadcast; r_e = 0: the point itself. Derived here.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> met = pinion_point(pair, pair.path.c, rho=pair.path.c)
    >>> f"{1e3 * met.string:.2f} mm, {1e6 * met.gap:.2f} um"
    '27.36 mm, 0.00 um'
    """
    radii = pair.pinion.base_radius, pair.wheel.base_radius
    return _meeting(radii, pair.line_of_action, np.asarray(s, dtype=float), rho, rounding)


def wheel_point(
    pair: GearPair, s: ArrayLike, *, rho: ArrayLike, rounding: ArrayLike = 0.0
) -> Meeting:
    """:func:`pinion_point` with the gears exchanged: a point of the wheel's flank.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> s = pair.path.c
    >>> met = wheel_point(pair, s, rho=pair.line_of_action - s)
    >>> f"{1e3 * met.string:.2f} mm, {1e6 * met.gap:.2f} um"
    '13.68 mm, 0.00 um'
    """
    radii, length = (pair.wheel.base_radius, pair.pinion.base_radius), pair.line_of_action
    return _meeting(radii, length, length - np.asarray(s, dtype=float), rho, rounding)


def _meeting(
    radii: tuple[float, float], length: float, s: Floats, rho: ArrayLike, rounding: ArrayLike
) -> Meeting:
    """Base radii [m] of the gear with the edge and of its mate; s from the gear's tangent point."""
    own, mate = radii
    rho, rounding = np.asarray(rho, dtype=float), np.asarray(rounding, dtype=float)
    string, turned = rho - rounding, (s - rho) / own
    # seen from the mate's centre, with its axes turned to meet its own string
    seen = np.conj((own + mate + 1j * length) - (own + 1j * string) * np.exp(1j * turned))
    met = np.sqrt(np.maximum(np.abs(seen) ** 2 - mate**2, 0.0))
    psi = np.angle(seen / (mate - 1j * met))
    angle = turned + psi
    return Meeting(
        met - rounding,
        s - (length - met + mate * psi) - rounding,
        angle,
        np.cos(angle) - string / own * np.sin(angle),
    )


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

    A <= s <= E: the involutes themselves. s > E: the pinion's tip edge, whose flank ends at the
    string length s_E turned (s - s_E)/r_b1 further, on the wheel's flank; s < A: the wheel's tip
    edge on the pinion's. The gap grows from 0 at the path's ends. ``extended`` False: inf off the
    path. Any shape.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e6 * contact_point(pair, pair.path.e + 1e-3).gap:.1f} um"
    '19.7 um'
    """
    shape, gears = np.shape(s), (pair.pinion, pair.wheel)
    s_ = np.atleast_1d(np.asarray(s, dtype=float))
    early, late = off_path(pair, s_)
    strings, ends = [s_.copy(), pair.line_of_action - s_], flank_ends(pair)
    gap = np.where(early | late, np.inf, 0.0)
    lever, angle, rounding = np.ones_like(gap), np.zeros_like(gap), np.zeros_like(gap)
    distance = np.where(early | late, 0.0, np.inf)
    # whose edge it may be: a tip's, or that of the other gear's undercut
    edges = [(late, 0, 1, pair.pinion.tip_rounding), (early, 1, 1, pair.wheel.tip_rounding)]
    edges += [(late, 1, 0, 0.0), (early, 0, 0, 0.0)] if pair.cut_short else []
    for here, gear, end, radius in edges:
        edge, mate = ends[gear][end], 1 - gear
        if end == 1 or gears[gear].undercut:
            along = abs(edge**2 - strings[gear] ** 2) / (2.0 * gears[gear].base_radius)
            nearer = along < distance
            distance[nearer] = along[nearer]
            rounding[nearer] = _reduced(radius, strings[mate][nearer])
        if not extended:
            continue
        met = (pinion_point, wheel_point)[gear](pair, s_[here], rho=edge, rounding=radius)
        lowest, highest = ends[mate]
        nearer = (met.string >= lowest) & (met.string <= highest) & (met.gap <= gap[here])
        nearer &= met.lever > 0.0  # else it would turn the gear the other way
        at = tuple(axis[nearer] for axis in np.nonzero(here))
        strings[gear][at], strings[mate][at] = edge, met.string[nearer]
        rounding[at] = _reduced(radius, met.string[nearer])
        # along the pinion's own normal a force has the arm r_b1
        lever[at] = met.lever[nearer] if gear == 0 else 1.0
        gap[at], angle[at] = met.gap[nearer] / lever[at], abs(met.angle[nearer])
    fields = (*strings, gap, lever, angle, rounding, distance)
    return ContactPoint(*(values.reshape(shape) for values in fields))


def _reduced(rounding: float, string: Floats) -> Floats:
    return rounding * string / np.maximum(rounding + string, np.finfo(float).tiny)
