"""First touch of tooth pairs: the one gap function of flanks that deviate.

The gap e of a pair is how far the mesh must advance along the line of action before the pair
touches. Flanks with a shape of their own do not touch at the nominal point of contact: a flank
that falls away next to it touches where it is nearest. Force, clearance, jam and pictures take
their gaps from here.

The least advance over the flank is found by samples of a window that must hold it and golden
sections of its lowest valleys: deviations have corners, so that no derivative is relied on, and a
table may have several valleys. It costs some 33 to 513 samples and 34 sections a position. A valley
that lies between two samples may be missed.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.gears.candidates import MeshPoints
from thermogear.gears.corner import contact_point, flank_ends, off_path, pinion_point, wheel_point
from thermogear.gears.deviations import Deviation, FlankShape
from thermogear.gears.pair import GearPair

Floats = NDArray[np.float64]
Shape = Callable[[Floats], Floats]

_REACH = 0.05
"""Modules: candidates farther from touching than this and the shapes' span keep their corner."""
_NODES, _MOST_NODES = {1: 33, 8: 257}, 513
"""Samples of the window at least, by the valleys that are searched (one beside reliefs, several
between the humps of tables), and at most; in between four for each finest feature."""
_ROUNDING = 1e-15
_SAME = 1e-11
"""Gaps [m] no further apart are one and the same."""
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_ROUGH, _KEPT = 12, 2
"""Golden sections of every valley, after which the lowest of them go on alone."""
_SECTIONS = 34
"""Golden sections: 1e-7 of two nodes' distance, which leaves the gap below 1e-12 m."""


class Touch(NamedTuple):
    """First touch of every candidate, arrays (..., position, pair).

    gap: e [m], inf where it never touches; edge: 1 where the wheel's tip corner touches, 2 where
    the pinion's, 0 where two flanks do (a place in
    :data:`~thermogear.base.vocabulary.EDGE_CONTACT`).
    """

    gap: Floats
    edge: NDArray[np.int8]


def first_touch(points: MeshPoints, deviations: Sequence[Deviation] = ()) -> Touch:
    """The gap of every tooth pair at ``points`` with all ``deviations``.

    e = min over the flank of [a + e_1(rho_1) + e_2(rho_2)] + sum of the others, a the exact
    advance until the pinion's point rho_1 meets the wheel's involute at rho_2
    (:func:`~thermogear.gears.corner.pinion_point`), e_1 and e_2 the material taken off at these
    points, which turns them about their gear. Close to the nominal point a = x^2/(2 rho*),
    x = (rho_1 - s) tan(alpha_k) along the flank. At A the wheel is at its phase while the
    pinion advances, at E the pinion while the wheel falls back, between them both in proportion:
    exchanging the gears changes nothing. Deviations that are no shape of a flank (pitch errors,
    heat) count at the nominal point.

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
        extended = bool(np.any((edge > 0) & np.isfinite(gap)))
        s = np.ascontiguousarray(contacts.s)
        known = all(isinstance(d, Hashable) for d in shapes)
        solve = _shaped if known else _shaped.__wrapped__
        gap, edge = solve(contacts.pair, tuple(shapes), s.shape, s.tobytes(), extended)
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
) -> Touch:
    """Gap and edge of flanks with ``shapes`` at the places s of ``size``; load plays no part.

    Remembered, because one mesh cycle asks for the same places several times and a row of
    temperatures asks again.
    """
    s = np.frombuffer(places).reshape(size)
    nominal = contact_point(pair, s, extended)
    lead = np.broadcast_shapes(*(d.taken_off(pair, np.ones(1)).shape[:-1] for d in shapes))
    gap = np.empty((*lead, *size))
    edge = np.empty(gap.shape, dtype=np.int8)
    finest = min(d.finest(pair) for d in shapes)
    valleys = max(_NODES) if any(d.humped for d in shapes) else min(_NODES)
    for case in np.ndindex(*lead):
        one, two = (_taken_off(pair, shapes, name, lead, case) for name in ("pinion", "wheel"))
        first, second = (np.linspace(*ends, 129) for ends in flank_ends(pair))
        span = float(np.ptp(one(first)) + np.ptp(two(second)))
        gap[case] = nominal.gap + one(nominal.pinion) + two(nominal.wheel)
        edge[case] = _corner_of(pair, s)
        near = nominal.gap < _REACH * pair.pinion.module + span
        if span > _ROUNDING:
            gap[case][near], edge[case][near] = _least_advance(
                pair, s[near], nominal.pinion[near], one, two, span, finest, valleys
            )
    gap.setflags(write=False)
    edge.setflags(write=False)
    return Touch(gap, edge)


def _taken_off(
    pair: GearPair,
    shapes: Sequence[FlankShape],
    gear: str,
    lead: tuple[int, ...],
    case: tuple[int, ...],
) -> Shape:
    """What all ``shapes`` take off one gear, a function of rho, in one ``case`` of ``lead``."""
    own = [d for d in shapes if d.gear == gear]

    def taken_off(rho: Floats) -> Floats:
        total = np.zeros_like(rho)
        for one in own:
            found = one.taken_off(pair, rho)
            whole = (*lead, *rho.shape)
            total = total + (found if found.shape == whole else np.broadcast_to(found, whole))[case]
        return total

    return taken_off


def _least_advance(
    pair: GearPair,
    s: Floats,
    middle: Floats,
    one: Shape,
    two: Shape,
    span: float,
    finest: float,
    valleys: int,
) -> tuple[Floats, NDArray[np.int8]]:
    """Least advance over the flank and whose tip corner makes it, arrays of the shape of s.

    ``middle`` rho_1 [m] where the plain involutes touch; ``one``, ``two`` what is taken off;
    ``span`` [m] of both shapes, ``finest`` [m] length of string over which one of them may turn,
    ``valleys`` how many humps may hide the least value from the samples.

    A window that must hold the least value is sampled, then narrowed by golden sections; both
    tip corners are tried too, because the least value at a border is reached there alone.
    """
    (low, high), (lowest, highest) = flank_ends(pair)
    # the part of the advance that the pinion makes
    part = np.clip((pair.path.e - s) / (pair.path.e - pair.path.a), 0.0, 1.0)

    at, share = s[..., None], part[..., None]

    def within(string: Floats, total: Floats) -> Floats:
        return np.where((string < lowest) | (string > highest), np.inf, total)

    def advance(rho: Floats) -> Floats:
        off = one(rho)

        def from_here(ahead: Floats | float) -> tuple[Floats, Floats]:
            string, advanced = pinion_point(pair, at + share * ahead - off, rho=rho)
            return string, advanced + off + two(string)

        return within(*_closed(from_here))

    middle = np.clip(middle, low, high)
    nominal = advance(middle[..., None])
    nominal = np.where(np.isfinite(nominal), nominal, 0.0)

    def roughly(rho: Floats) -> Floats:
        off = one(rho)
        string, advanced = pinion_point(pair, at + share * nominal - off, rho=rho)
        return within(string, advanced + off + two(string))

    length = pair.line_of_action
    with np.errstate(divide="ignore"):
        # twice as far as where x^2/(2 rho*) outgrows the span of the shapes
        softness = 2.0 * span * np.maximum(length - middle, 0.0) / (length * middle)
    reach = 2.0 * pair.pinion.base_radius * np.sqrt(softness)
    begin, end = np.maximum(middle - reach, low), np.minimum(middle + reach, high)
    wanted = 4.0 * float(np.max(end - begin)) / finest
    count = int(np.clip(wanted, _NODES[valleys], _MOST_NODES))
    nodes = begin[..., None] + (end - begin)[..., None] * np.linspace(0.0, 1.0, count)
    places = _valleys(roughly(nodes), valleys)
    left, right = (
        np.take_along_axis(nodes, np.clip(places + step, 0, count - 1), axis=-1) for step in (-1, 1)
    )
    if valleys > _KEPT:
        left, right, lowest_yet = _narrow(advance, left, right, _ROUGH)
        kept = np.argpartition(lowest_yet, _KEPT - 1, axis=-1)[..., :_KEPT]
        left, right = (np.take_along_axis(end, kept, axis=-1) for end in (left, right))
    least = _narrow(advance, left, right, _SECTIONS)[2].min(axis=-1)
    off = two(np.array(highest))

    def from_there(ahead: Floats | float) -> tuple[Floats, Floats]:
        string, advanced = wheel_point(pair, s - (1.0 - part) * ahead + off, rho=highest)
        return string, advanced + off + one(string)

    string, total = _closed(from_there)
    wheel_tip = np.where((string < low) | (string > high), np.inf, total)
    pinion_tip = advance(np.full_like(at, high))[..., 0]
    corners = np.minimum(wheel_tip, pinion_tip)
    # so close to the corner's value the golden section has run into the corner
    edge = np.where(corners > least + _SAME, 0, np.where(wheel_tip < pinion_tip, 1, 2))
    return np.minimum(least, corners), np.asarray(edge, dtype=np.int8)


def _narrow(
    function: Shape, left: Floats, right: Floats, sections: int
) -> tuple[Floats, Floats, Floats]:
    """Golden sections of [left, right] towards the least value: both ends and that value."""
    a, b = right - _GOLDEN * (right - left), left + _GOLDEN * (right - left)
    at_a, at_b = function(a), function(b)
    for _ in range(sections):
        lower = at_a <= at_b
        left, right = np.where(lower, left, a), np.where(lower, b, right)
        fresh = np.where(lower, right - _GOLDEN * (right - left), left + _GOLDEN * (right - left))
        at_fresh = function(fresh)
        a, b = np.where(lower, fresh, b), np.where(lower, a, fresh)
        at_a, at_b = np.where(lower, at_fresh, at_b), np.where(lower, at_a, at_fresh)
    return left, right, np.minimum(at_a, at_b)


def _valleys(values: Floats, most: int) -> NDArray[np.int64]:
    """Places of the ``most`` lowest valleys of samples along the last axis, lowest first."""
    if most == 1:
        return np.asarray(np.argmin(values, axis=-1)[..., None], dtype=np.int64)
    beyond = np.full((*values.shape[:-1], 1), np.inf)
    before = np.concatenate([beyond, values[..., :-1]], axis=-1)
    after = np.concatenate([values[..., 1:], beyond], axis=-1)
    low = np.where((values <= before) & (values <= after), values, np.inf)
    return np.asarray(np.argsort(low, axis=-1)[..., :most], dtype=np.int64)


def _closed(
    advance: Callable[[Floats | float], tuple[Floats, Floats]],
) -> tuple[Floats, Floats]:
    """The advance [m] that closes the gap from where it leads itself to, with its string [m].

    Each turn of g = advance(g) gains about two digits, the secant through two of them two more.
    """
    _, first = advance(0.0)
    _, second = advance(first)
    large = np.abs(first) > 1e-12
    slope = np.divide(second - first, first, out=np.zeros_like(first), where=large)
    return advance(np.where(large, first / (1.0 - slope), second))
