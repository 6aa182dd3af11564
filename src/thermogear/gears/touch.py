"""First touch of tooth pairs: the one gap function of flanks that deviate.

The gap e of a pair is how far the mesh must advance along the line of action before the pair
touches. Flanks with a shape of their own do not touch at the nominal point of contact: a flank
that falls away next to it touches where it is nearest. Force, clearance, jam and pictures take
their gaps from here.

The shapes of both flanks are taken as polynomials of fifth degree between their borders, to
1e-11 m; between two borders the least advance is at one of them or where its derivative, known in
closed form, is zero (``touch_kernel``). Where the advance turns more than once between two borders
a valley may be missed.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.gears.candidates import MeshPoints
from thermogear.gears.corner import contact_point, flank_ends, off_path
from thermogear.gears.deviations import GEARS, Deviation, FlankShape
from thermogear.gears.pair import GearPair

_REACH = 0.05
"""Modules: candidates farther from touching than this and the shapes' span keep their corner."""
_ROUNDING = 1e-15
_NODES = 0.5 - 0.5 * np.cos(np.pi * np.arange(6) / 5.0)
_TO_POWERS = np.linalg.inv(np.vander(_NODES, increasing=True))
_APART = 1e-9
"""Borders closer than this part of the flank are one."""
_PLACES = np.cos(np.pi * np.arange(1, 24) / 24.0)
_WEIGHTS = np.sin(np.pi * np.arange(1, 24) / 24.0) ** 2 / 12.0
"""Gauss's rule of an elliptic weight over -1..1: the mean of a corner to 1e-3 of its slope."""


class Touch(NamedTuple):
    """First touch of every candidate, arrays (..., position, pair).

    gap: e [m], inf where it never touches; edge: 1 where the wheel's tip corner touches, 2 where
    the pinion's, 0 where two flanks do (a place in
    :data:`~thermogear.base.vocabulary.EDGE_CONTACT`).
    """

    gap: Floats
    edge: NDArray[np.int8]


def first_touch(
    points: MeshPoints, deviations: Sequence[Deviation] = (), spread: float = 0.0
) -> Touch:
    """The gap of every tooth pair at ``points`` with all ``deviations``.

    e = min over the flank of [a + e_1(rho_1) + e_2(rho_2)] + sum of the others, a the exact
    advance until the pinion's point rho_1 meets the wheel's involute at rho_2
    (:func:`~thermogear.gears.corner.pinion_point`), e_1 and e_2 the material taken off at these
    points, which turns them about their gear. Close to the nominal point a = x^2/(2 rho*),
    x = (rho_1 - s) tan(alpha_k) along the flank. At A the wheel is at its phase while the
    pinion advances, at E the pinion while the wheel falls back, between them both in proportion:
    on the path exchanging the gears changes nothing. Beyond E the pinion's advance is that of the
    wheel over the lever of :class:`~thermogear.gears.corner.ContactPoint`. Deviations that are no
    shape of a flank (pitch errors, heat) count at the nominal point.

    ``spread`` 4 F/(pi b E*) [m] >= 0: a load presses the flanks over Hertz's half width
    sqrt(spread rho*); e_1 and e_2 are then their means over its ellipse, weight (1 - x^2)^(1/2)
    along the flank, narrower where the flank would end within. A straight line is its own mean,
    a corner of the slope k lies 2/(3 pi) k half widths deep. 0: first touch itself.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> from thermogear.gears.candidates import mesh_points
    >>> f"{first_touch(mesh_points(pair, [0.1])).gap.min():.3f} m"
    '0.000 m'
    """
    contacts = points.contacts
    shapes = [d for d in deviations if isinstance(d, FlankShape) and d.acts_on(contacts.flank)]
    rest = [
        checked
        for place, d in enumerate(deviations)
        for checked in [_checked(place, d, d.gap(contacts))]
        if not isinstance(d, FlankShape)
    ]
    gap, edge = points.point.gap, _corner_of(contacts.pair, contacts.s)
    if shapes:
        solve = _shaped if all(isinstance(d, Hashable) for d in shapes) else _shaped.__wrapped__
        extended = bool(np.any((edge > 0) & np.isfinite(gap)))
        once, place = points.fractions
        gap, edge = solve(
            contacts.pair, tuple(shapes), once.s.shape, once.s.tobytes(), extended, spread
        )
        if points.shared:
            gap, edge = gap[..., place, :], edge[..., place, :]
    if points.broken is not None:
        # on the edge of the break, what is taken off counts where that edge is
        there = sum((d.gap(contacts) for d in shapes), start=points.point.gap)
        gap = np.where(points.broken, there, gap)
        edge = np.where(points.broken, points.broken, edge)
    whole = np.asarray(sum(rest, start=gap))
    return Touch(whole, np.broadcast_to(edge, whole.shape))


def _corner_of(pair: GearPair, s: Floats) -> NDArray[np.int8]:
    """Whose tip corner touches where plain involutes would meet at ``s`` [m]."""
    early, late = off_path(pair, s)
    return np.asarray(1 * early + 2 * late, dtype=np.int8)


def _checked(place: int, deviation: Deviation, gap: Floats) -> Floats:
    """The gap of one deviation; InputError where it is no number."""
    bad = np.isnan(gap) | (gap == -np.inf)
    if np.any(bad):
        raise InputError(
            f"deviations[{place}].gap",
            gap[bad].flat[0],
            allowed="a number of metres, or inf for a pair that never touches",
            why=f"{type(deviation).__name__} gives it",
        )
    return gap


@lru_cache(maxsize=48)
def _shaped(
    pair: GearPair,
    shapes: tuple[FlankShape, ...],
    size: tuple[int, ...],
    places: bytes,
    extended: bool,
    spread: float,
) -> Touch:
    """Gap and edge of flanks with ``shapes`` at the places s of ``size``; load plays no part.

    Remembered, because one mesh cycle asks for the same places several times and a row of
    temperatures asks again.
    """
    from thermogear.gears.touch_kernel import touch_many

    s = np.frombuffer(places)
    nominal = contact_point(pair, s, extended)
    lead = np.broadcast_shapes(*(d.taken_off(pair, np.ones(1)).shape[:-1] for d in shapes))
    ends = flank_ends(pair)
    (low, high), length = ends[0], pair.line_of_action
    (one, first, span_one, off_one), (two, second, span_two, off_two) = (
        _polynomials(pair, [d for d in shapes if d.gear == gear], own, string, lead, spread)
        for gear, own, string in zip(GEARS, ends, (nominal.pinion, nominal.wheel), strict=True)
    )
    span = span_one + span_two
    gap = nominal.gap + off_one + off_two
    edge = np.tile(_corner_of(pair, s), (len(gap), 1))
    middle = np.clip(nominal.pinion, low, high)
    with np.errstate(divide="ignore"):
        # half as far again as where x^2/(2 rho*) outgrows the span of the shapes
        softness = 2.0 * span * np.maximum(length - middle, 0.0) / (length * middle)
    near = (nominal.gap < _REACH * pair.pinion.module + span) & (span > _ROUNDING)
    touch_many(
        s,
        middle,
        near,
        1.5 * pair.pinion.base_radius * np.sqrt(softness),
        np.array(
            [pair.pinion.base_radius, pair.wheel.base_radius, length, pair.path.a, pair.path.e]
        ),
        one,
        first,
        two,
        second,
        gap,
        edge,
    )
    # off the path what the wheel would fall back is the pinion's advance times its lever
    gap += np.where(near, nominal.gap, 0.0) * (1.0 - nominal.lever)
    # the flanks end where a rounding begins, which reaches farther by r_e (1 - cos theta)
    gap -= nominal.rounding * (1.0 - np.cos(nominal.angle)) * (near & (edge > 0))
    gap, edge = gap.reshape(*lead, *size), edge.reshape(*lead, *size)
    gap.setflags(write=False)
    edge.setflags(write=False)
    return Touch(gap, edge)


def _polynomials(
    pair: GearPair,
    shapes: Sequence[FlankShape],
    ends: tuple[float, float],
    string: Floats,
    lead: tuple[int, ...],
    spread: float,
) -> tuple[Floats, Floats, Floats, Floats]:
    """Borders [m], powers [case, piece, power], span [m] of what is taken off, that at ``string``.

    Between two borders the polynomial meets the shapes, or their means, at six places.
    """
    low, high = ends
    gear = pair.pinion if shapes and shapes[0].gear == GEARS[0] else pair.wheel
    flank = (ends, gear.base_radius, pair.line_of_action, spread)
    places = np.concatenate([np.empty(0), *(d.borders(pair) for d in shapes)])
    places = places[(places > low) & (places < high)]
    if spread > 0.0:
        places = _pressed(places, *flank)[:, [0, -1]].ravel()
    borders = np.sort([low, *places, high])
    borders = borders[np.diff(borders, prepend=-np.inf) > _APART * (high - low)]
    borders[-1] = high
    nodes = borders[:-1, None] + np.diff(borders)[:, None] * _NODES
    inside = _pressed(nodes.ravel(), *flank) if spread > 0.0 else nodes.reshape(-1, 1)
    weights = _WEIGHTS if spread > 0.0 else np.ones(1)
    values, there = np.zeros((*lead, nodes.size)), np.zeros((*lead, string.size))
    for shape in shapes:
        values += shape.taken_off(pair, inside) @ weights
        there += shape.taken_off(pair, string)
    values = values.reshape(-1, *nodes.shape)
    powers = np.ascontiguousarray(values @ _TO_POWERS.T)
    span = np.ptp(values, axis=(1, 2))[:, None]
    return borders, powers, span, there.reshape(-1, string.size)


def _pressed(
    rho: Floats, ends: tuple[float, float], base: float, length: float, spread: float
) -> Floats:
    """String lengths [m] of :data:`_PLACES` in the contacts at ``rho``, shape (n, place).

    The flank's arc is rho^2/(2 r_b), r_b = ``base``: the half width sqrt(spread rho*) adds
    2 r_b times itself to the square of the string, or what is left to the nearer end.
    """
    half = 2.0 * base * np.sqrt(np.maximum(spread * rho * (length - rho) / length, 0.0))
    left = np.minimum(rho**2 - ends[0] ** 2, ends[1] ** 2 - rho**2)
    half = np.minimum(half, np.maximum(left, 0.0))
    return np.asarray(np.sqrt(np.maximum(rho[:, None] ** 2 + half[:, None] * _PLACES, 0.0)))
