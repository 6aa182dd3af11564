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
from thermogear.gears.corner import ContactPoint, contact_point, flank_ends, off_path
from thermogear.gears.deviations import GEARS, Deviation, FlankShape
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_damage import as_damaged
from thermogear.gears.turn import ToothShapes

_REACH = 0.05
"""Modules: candidates farther from touching than this and the shapes' span keep their corner."""
_ROUNDING = 1e-15
_POINTS = 49
"""Points of a flank at which teeth that differ may touch."""
_STEPS = 256, 2048
"""Steps of a flank in which what is taken off is linear: means over a contact; the shapes."""
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


_KEPT: dict[Hashable, Touch] = {}
_MOST_KEPT = 4
"""Touches of teeth that differ, remembered: one mesh cycle asks for the same several times."""


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
    points = as_damaged(points, deviations)
    contacts, (once, place) = points.contacts, points.fractions
    shapes: list[FlankShape | ToothShapes] = []
    rest: list[Floats] = []
    for n, d in enumerate(deviations):
        if not isinstance(d, FlankShape | ToothShapes):
            rest.append(_checked(n, d, d.gap(contacts)))
            continue
        _checked(n, d, d.gap(once.contacts))
        if d.acts_on(contacts.flank):
            shapes.append(d.shapes[0] if isinstance(d, ToothShapes) and not d.differs else d)
    gap, edge = points.point.gap, _corner_of(contacts.pair, contacts.s)
    if shapes:
        extended = bool(np.any((edge > 0) & np.isfinite(gap)))
        alike = [d for d in shapes if isinstance(d, FlankShape)]
        hashable = all(isinstance(d, Hashable) for d in shapes)
        if len(alike) < len(shapes):
            phases = contacts.phase.tobytes()
            key = (contacts.pair, contacts.flank, phases, tuple(shapes), extended, spread)
            kept = _KEPT if hashable else {}
            touch = kept.get(key) or _of_teeth(points, tuple(shapes), extended, spread)
            kept[key] = gap, edge = touch
            if len(kept) > _MOST_KEPT:
                kept.pop(next(iter(kept)), None)
        else:
            given = (contacts.pair, tuple(alike), once.s.shape, once.s.tobytes(), extended, spread)
            gap, edge = (_shaped if hashable else _shaped.__wrapped__)(*given)
            if points.shared:
                gap, edge = gap[..., place, :], edge[..., place, :]
    gap, edge = _on_breaks(points, shapes, gap, edge)
    whole = np.asarray(sum(rest, start=gap))
    return Touch(whole, np.broadcast_to(edge, whole.shape))


def _on_breaks(
    points: MeshPoints,
    shapes: Sequence[FlankShape | ToothShapes],
    gap: Floats,
    edge: NDArray[np.int8],
) -> Touch:
    """On the edge of a break, what is taken off counts where that edge is."""
    if points.broken is None or not points.broken.any():
        return Touch(gap, edge)
    there = sum((d.gap(points.contacts) for d in shapes), start=points.point.gap)
    return Touch(np.where(points.broken, there, gap), np.where(points.broken, points.broken, edge))


def touch_of_parts(
    points: MeshPoints, parts: Sequence[Sequence[Deviation]], *spreads: float
) -> list[Touch]:
    """:func:`first_touch` of many parts, arrays (part, position, pair), for each of ``spreads``.

    Each part with its own deviations, those of one operating point; what several parts have in
    common, the same object, is looked at once. A part hangs on no other. Damaged teeth are those of
    the first part in all of them.

    >>> from thermogear.gears.candidates import mesh_points
    >>> pair = GearPair(Gear(20, 3e-3), Gear(40, 3e-3))
    >>> (touch,) = touch_of_parts(mesh_points(pair, [0.25, 0.5]), [(), ()], 0.0)
    >>> touch.gap.shape == (2, *mesh_points(pair, [0.25, 0.5]).s.shape)
    True
    """
    points = as_damaged(points, parts[0] if parts else ())
    contacts = points.contacts
    pair, size = contacts.pair, contacts.s.shape
    whole = len(parts), *size
    touches = [Touch(np.zeros(whole), np.zeros(whole, np.int8)) for _ in spreads]
    known: dict[int, Floats] = {}
    drawn, acting = [], []
    for n, part in enumerate(parts):
        shapes = [d for d in part if isinstance(d, FlankShape | ToothShapes)]
        if not any(d.differs for d in shapes if isinstance(d, ToothShapes)):
            for touch, spread in zip(touches, spreads, strict=True):
                touch.gap[n], touch.edge[n] = (
                    values.reshape(size) for values in first_touch(points, part, spread)
                )
            continue
        drawn.append(n)
        acting.append(tuple(d for d in shapes if d.acts_on(contacts.flank)))
        for place, d in enumerate(part):
            if not isinstance(d, FlankShape | ToothShapes):
                if id(d) not in known:
                    known[id(d)] = _checked(place, d, d.gap(contacts)).reshape(size)
                for touch in touches:
                    touch.gap[n] += known[id(d)]
    extended = bool(np.any((_corner_of(pair, contacts.s) > 0) & np.isfinite(points.point.gap)))
    for touch, spread in zip(touches, spreads, strict=True):
        if acting:
            pinion, wheel = _of_all(pair, acting, spread)
            every = _touched(points, pinion, wheel, extended)
            for n, shapes_of_part, gap, edge in zip(drawn, acting, *every, strict=True):
                gap, touch.edge[n] = _on_breaks(points, shapes_of_part, gap, edge)
                touch.gap[n] += gap
    return touches


class ReshapedParts:
    """Many parts whose flanks get the same shapes besides, over and over: for a search.

    What the deviations of the ``parts`` take off, averaged over contacts of a ``spread`` [m] as
    :func:`first_touch` does, is looked at once: means of sums are sums of means.
    """

    def __init__(
        self, points: MeshPoints, parts: Sequence[Sequence[Deviation]], spread: float
    ) -> None:
        self._points, self._spread = points, spread
        contacts = points.contacts
        shapes = [[d for d in part if isinstance(d, FlankShape | ToothShapes)] for part in parts]
        acting = [tuple(d for d in row if d.acts_on(contacts.flank)) for row in shapes]
        self._tables = _of_all(contacts.pair, acting, spread)
        self._rest = np.zeros((len(parts), *contacts.s.shape))
        for rest, part in zip(self._rest, parts, strict=True):
            for place, d in enumerate(part):
                if not isinstance(d, FlankShape | ToothShapes):
                    rest += _checked(place, d, d.gap(contacts)).reshape(rest.shape)
        self._extended = bool(
            np.any((_corner_of(contacts.pair, contacts.s) > 0) & np.isfinite(points.point.gap))
        )

    def touch(self, shapes: Sequence[FlankShape]) -> Touch:
        """First touch with the ``shapes``, (part, position, pair), as :func:`touch_of_parts`."""
        pair, flank = self._points.contacts.pair, self._points.contacts.flank
        acting = tuple(d for d in shapes if d.acts_on(flank))
        (first, second), _ = _tables.__wrapped__(pair, acting, self._spread)
        pinion, wheel = self._tables
        gap, edge = _touched(self._points, pinion + first, wheel + second, self._extended)
        return Touch(gap + self._rest, edge)


def _of_all(
    pair: GearPair, acting: Sequence[tuple[FlankShape | ToothShapes, ...]], spread: float
) -> list[Floats]:
    """:func:`_tables` of all parts together, of every tooth of pinion and wheel."""
    rows = [_tables.__wrapped__(pair, shapes, spread)[0] for shapes in acting]
    return [
        np.concatenate([np.broadcast_to(t, (*t.shape[:2], count)) for t in of_gear])
        for count, of_gear in zip(
            (pair.pinion.teeth, pair.wheel.teeth), zip(*rows, strict=True), strict=True
        )
    ]


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
    (one, first, span_one, off_one), (two, second, span_two, off_two) = (
        _polynomials(pair, gear, [d for d in shapes if d.gear == gear], string, lead, spread)
        for gear, string in zip(GEARS, (nominal.pinion, nominal.wheel), strict=True)
    )
    span = span_one + span_two
    gap = nominal.gap + off_one + off_two
    edge = np.tile(_corner_of(pair, s), (len(gap), 1))
    where = _looked_at(pair, s, nominal, span)
    touch_many(*where, one, first, two, second, gap, edge)
    gained, lost = _at_ends(nominal, where[2])
    gap = (gap + gained - lost * (edge > 0)).reshape(*lead, *size)
    edge = edge.reshape(*lead, *size)
    gap.setflags(write=False)
    edge.setflags(write=False)
    return Touch(gap, edge)


def _looked_at(
    pair: GearPair, s: Floats, nominal: ContactPoint, span: Floats
) -> tuple[Floats, Floats, NDArray[np.bool_], Floats, Floats]:
    """s, middle, near, reach and mesh of ``touch_kernel`` for shapes of a ``span`` [m]."""
    (low, high), length = flank_ends(pair)[0], pair.line_of_action
    middle = np.clip(nominal.pinion, low, high)
    with np.errstate(divide="ignore"):
        # half as far again as where x^2/(2 rho*) outgrows the span of the shapes
        softness = 2.0 * span * np.maximum(length - middle, 0.0) / (length * middle)
    near = (nominal.gap < _REACH * pair.pinion.module + span) & (span > _ROUNDING)
    radii = pair.pinion.base_radius, pair.wheel.base_radius
    mesh = np.array([*radii, length, pair.path.a, pair.path.e])
    return s, middle, near, 1.5 * radii[0] * np.sqrt(softness), mesh


def _at_ends(nominal: ContactPoint, near: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """What the gap of the flanks gains off the path, and loses where an edge touches [m]."""
    # off the path what the wheel would fall back is the pinion's advance times its lever
    gained = np.where(near, nominal.gap, 0.0) * (1.0 - nominal.lever)
    # the flanks end where a rounding begins, which reaches farther by r_e (1 - cos theta)
    return gained, nominal.rounding * (1.0 - np.cos(nominal.angle)) * near


def _of_teeth(
    points: MeshPoints,
    shapes: tuple[FlankShape | ToothShapes, ...],
    extended: bool,
    spread: float,
) -> Touch:
    """Gap and edge of flanks that differ from tooth to tooth.

    The advance of plain involutes at :data:`_POINTS` of the flank once for all teeth, and what each
    tooth takes off there. Where a pair may carry within 4e-5 modules of :func:`_shaped`.
    """
    pair = points.contacts.pair
    solve = _tables if all(isinstance(d, Hashable) for d in shapes) else _tables.__wrapped__
    (first, second), lead = solve(pair, shapes, spread)
    gap, edge = _touched(points, first, second, extended)
    gap.setflags(write=False)
    edge.setflags(write=False)
    return Touch(gap.reshape(*lead, *gap.shape[1:]), edge.reshape(*lead, *gap.shape[1:]))


def _touched(points: MeshPoints, first: Floats, second: Floats, extended: bool) -> Touch:
    """Gap and edge [case, position, pair] of teeth that take off ``first`` and ``second`` [m].

    Each [case, step, tooth]. A case looks at its flanks as far as its own shapes may let them
    touch, in powers of 2 of the base pitch, so that what it finds hangs on no other case.
    """
    from thermogear.gears.touch_kernel import touch_teeth

    contacts, (shared, place) = points.contacts, points.fractions
    step = (first.shape[1] - 1) // min(_STEPS)
    span = sum(
        np.ptp(np.ascontiguousarray(t[:, ::step]), axis=1).max(axis=1) for t in (first, second)
    )
    pitch = contacts.pair.base_pitch  # powers of 2 of it: the same in any unit of length
    halvings = np.ceil(np.log2(np.maximum(span, _ROUNDING) / pitch))
    span = np.where(span > _ROUNDING, pitch * 2.0**halvings, 0.0)
    teeth = (contacts.pinion_tooth % first.shape[2], contacts.wheel_tooth % second.shape[2])
    order = np.argsort(place, kind="stable")
    begin = np.searchsorted(place[order], np.arange(len(shared.s) + 1))
    whole = (len(first), *contacts.s.shape)
    gap, edge = np.empty(whole), np.empty(whole, np.int8)
    for size in np.unique(span):
        cases = np.flatnonzero(span == size)
        nodes, edges, part, gained, lost = _nodes(
            contacts.pair, shared.s.shape, shared.s.tobytes(), extended, float(size),
            first.shape[1] - 1,
        )  # fmt: skip
        here = Touch(gap[cases], edge[cases])
        touch_teeth(
            nodes, edges, part, first[cases], second[cases], order, begin, *teeth, gained, lost,
            here.gap, here.edge,
        )  # fmt: skip
        gap[cases], edge[cases] = here
    return Touch(gap, edge)


@lru_cache(maxsize=12)
def _nodes(
    pair: GearPair, size: tuple[int, ...], places: bytes, extended: bool, span: float, last: int
) -> tuple[Floats, NDArray[np.int8], Floats, Floats, Floats]:
    """Nodes, edges, part, gained and lost of ``touch_teeth`` at the places s of ``size``.

    For shapes of a ``span`` [m], in tables of ``last`` steps.
    """
    from thermogear.gears.touch_kernel import advance_many

    once = np.frombuffer(places).reshape(size)
    nominal = contact_point(pair, once, extended)
    where = _looked_at(
        pair, once.ravel(), ContactPoint(*(x.ravel() for x in nominal)), np.array(span)
    )
    ends = np.array(flank_ends(pair))
    nodes = np.zeros((*once.shape, _POINTS, 7))
    nodes[..., 0], nodes[..., 1], nodes[..., 2] = (
        x[..., None] for x in (nominal.pinion, nominal.wheel, nominal.gap)
    )
    edges = np.repeat(_corner_of(pair, once)[..., None], 2, axis=-1)
    advance_many(*where, ends[0], ends[1], nodes.reshape(-1, _POINTS, 7), edges.reshape(-1, 2))
    step = np.diff(ends).ravel() / last
    nodes[..., :2] = np.clip((nodes[..., :2] - ends[:, 0]) / step, 0.0, last)
    nodes[..., 5:] /= step
    path = pair.path
    part = np.clip((path.e - once) / (path.e - path.a), 0.0, 1.0)
    return nodes, edges, part, *_at_ends(nominal, where[2].reshape(once.shape))


@lru_cache(maxsize=16)
def _tables(
    pair: GearPair, shapes: tuple[FlankShape | ToothShapes, ...], spread: float
) -> tuple[list[Floats], tuple[int, ...]]:
    """What each tooth of pinion and wheel takes off [m], means over a contact, and ``lead``.

    [case, step, tooth] over the flank in even steps of the string; one tooth where all are alike.
    """
    tables: list[Floats] = []
    steps = _STEPS[spread == 0.0] + 1
    for name, ends in zip(GEARS, flank_ends(pair), strict=True):
        inside, weights = _averaged(pair, name, np.linspace(*ends, steps), spread)
        table = np.zeros((steps, 1))
        for shape in shapes:
            if shape.gear == name:
                each = shape.shapes if isinstance(shape, ToothShapes) else (shape,)
                taken = type(each[0]).each(each, pair, inside, weights=weights)
                table = table + np.moveaxis(taken, 0, -1)
        tables.append(table)
    lead = np.broadcast_shapes(*(table.shape[:-2] for table in tables))
    return [
        np.ascontiguousarray(
            np.broadcast_to(table, (*lead, *table.shape[-2:])).reshape(-1, *table.shape[-2:])
        )
        for table in tables
    ], lead


def _averaged(pair: GearPair, name: str, at: Floats, spread: float) -> tuple[Floats, Floats]:
    """Strings [m] in the contacts at ``at`` [m], (n, place), and the weights of their mean."""
    if spread == 0.0:
        return at[:, None], np.ones(1)
    ends = flank_ends(pair)[GEARS.index(name)]
    base = pair.gear(name).base_radius
    return _pressed(at, ends, base, pair.line_of_action, spread), _WEIGHTS


def _polynomials(
    pair: GearPair,
    name: str,
    shapes: Sequence[FlankShape],
    string: Floats,
    lead: tuple[int, ...],
    spread: float,
) -> tuple[Floats, Floats, Floats, Floats]:
    """Borders [m], powers [case, piece, power], span [m] of what is taken off, that at ``string``.

    Between two borders the polynomial meets the shapes, or their means, at six places.
    """
    low, high = flank_ends(pair)[GEARS.index(name)]
    places = np.concatenate([np.empty(0), *(d.borders(pair) for d in shapes)])
    places = places[(places > low) & (places < high)]
    if spread > 0.0:
        places = _averaged(pair, name, places, spread)[0][:, [0, -1]].ravel()
    borders = np.sort([low, *places, high])
    borders = borders[np.diff(borders, prepend=-np.inf) > _APART * (high - low)]
    borders[-1] = high
    nodes = borders[:-1, None] + np.diff(borders)[:, None] * _NODES
    inside, weights = _averaged(pair, name, nodes.ravel(), spread)
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
