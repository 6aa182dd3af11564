"""The true outline of a tooth: root land, fillet, flanks as they deviate, edges, tip land.

Tooth frame in polar form: the gear's centre is the origin, angles count from the tooth's axis
towards its drive flank. One outline is one pitch of the gear, from the middle of the space behind
the tooth to the middle of the space before it; the gear is ``z`` of them side by side.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.gears.deviations import Deviation, FlankShape
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair

FLANK, FILLET, LAND, EDGE = 20, 10, 2, 4
"""Steps of one side's flank and fillet, of half a land, and of the edge between flank and land."""
_DENSE = 400


class Outline(NamedTuple):
    """One pitch of a gear, arrays of one shape (point,), back side first.

    ``radius`` [m] and ``angle`` [rad] from the tooth's axis; ``string`` rho [m] of the points of an
    involute, along a tip's edge that of the flank's end, nan elsewhere.
    """

    radius: Floats
    angle: Floats
    string: Floats

    @property
    def points(self) -> NDArray[np.complex128]:
        """The points in the plane [m], the tooth's axis along the first axis."""
        return np.asarray(self.radius * np.exp(1j * self.angle))


class _Side(NamedTuple):
    """Half a tooth from its axis to the middle of a space; ``kept``: how much of a deviation."""

    radius: Floats
    angle: Floats
    string: Floats
    kept: Floats


def outline(
    gear: Gear,
    *,
    set_back: float = 0.0,
    pair: GearPair | None = None,
    deviations: Sequence[Deviation] = (),
    fineness: int = 1,
) -> Outline:
    """The outline of ``gear`` at the drawing's temperature.

    psi(r) - (set_back + e(rho))/r_b on both sides: what is taken off along the line of action
    turns a point about the gear's centre. ``set_back`` [m] along the normal of both flanks, < 0
    thickens the tooth, moves fillet and flank as a wider or narrower rack tooth does.
    ``deviations``: the shapes of flanks among them that are the gear's in ``pair`` move its flanks;
    along the fillet they fade to nothing at the root circle, because nobody says what they are
    there. ``fineness`` times as many points; all of them lie on the true curves.

    >>> shape = outline(Gear(20, 4e-3))
    >>> f"{1e3 * shape.radius.max():.2f} mm"
    '44.00 mm'
    """
    half = _half(gear, fineness)
    limit = math.pi / gear.teeth
    sides = []
    for flank in ("back", "drive"):
        off = np.full(half.radius.size, set_back)
        if pair is not None:
            off = off + half.kept * _taken_off(gear, pair, deviations, flank, half.string)
        turned = half.angle - off / gear.base_radius
        sides.append(_with_lands(gear, half, turned, limit, fineness))
    (r, before, rho), (_, after, _) = sides
    return Outline(
        np.concatenate([r[::-1], r[1:]]),
        np.concatenate([-before[::-1], after[1:]]),
        np.concatenate([rho[::-1], rho[1:]]),
    )


def _half(gear: Gear, fineness: int) -> _Side:
    """The tip's edge, the flank from there down, then the fillet to the root circle."""
    junction, lowest = gear.junction
    tip = float(np.tan(gear.pressure_angle_at(gear.tip_form_radius)))
    edge = _edge(gear, fineness)
    t = np.linspace(tip, lowest, FLANK * fineness + 1)
    flank = gear.base_radius * np.hypot(1.0, t)
    gamma = np.linspace(junction, 0.5 * math.pi, _DENSE)
    x, y = gear.fillet.point(gamma)
    run = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    # places as far apart as each other along the fillet, on the curve itself
    wanted = np.linspace(0.0, run[-1], FILLET * fineness + 1)[1:]
    x, y = gear.fillet.point(np.interp(wanted, run, gamma))
    return _Side(
        np.concatenate([np.abs(edge), flank, np.hypot(x, y)]),
        np.concatenate([np.angle(edge), gear.half_thickness_angle(flank), np.arctan2(x, y)]),
        np.concatenate(
            [np.full(edge.size, gear.base_radius * tip), gear.base_radius * t, x * np.nan]
        ),
        np.concatenate([np.ones(edge.size + t.size), 1.0 - wanted / run[-1]]),
    )


def _edge(gear: Gear, fineness: int) -> NDArray[np.complex128]:
    """The edge from the tip circle down to the flank, which it does not hold [m]; none if sharp."""
    steps = EDGE * fineness if gear.tip_form_radius < gear.tip_radius else 0
    part = np.linspace(0.0, 1.0, steps + 1)[:-1]
    land = np.exp(0.5j * gear.tip_land / gear.tip_radius)
    end = gear.tip_form_radius * np.exp(1j * gear.half_thickness_angle(gear.tip_form_radius))
    if gear.tip_chamfer > 0.0:
        return np.asarray(gear.tip_radius * land + part * (end - gear.tip_radius * land))
    centre = (gear.tip_radius - gear.tip_rounding) * land
    turned = np.exp(1j * part * np.angle((end - centre) / land))
    return np.asarray(centre + gear.tip_rounding * land * turned)


def _with_lands(
    gear: Gear, half: _Side, angle: Floats, limit: float, fineness: int
) -> tuple[Floats, Floats, Floats]:
    """(radius, angle, string) of one side from the tooth's axis to the middle of the space."""
    angle = np.clip(angle, 0.0, limit)
    steps = LAND * fineness
    over = np.linspace(0.0, angle[0], steps + 1)[:-1]
    under = np.linspace(angle[-1], limit, steps + 1)[1:]
    unknown = np.full(steps, np.nan)
    return (
        np.concatenate(
            [np.full(steps, gear.tip_radius), half.radius, np.full(steps, half.radius[-1])]
        ),
        np.concatenate([over, angle, under]),
        np.concatenate([unknown, half.string, unknown]),
    )


def _taken_off(
    gear: Gear, pair: GearPair, deviations: Sequence[Deviation], flank: str, string: Floats
) -> Floats:
    """What the shapes of this gear's flank take off [m], below the form circle as at it."""
    name = "pinion" if gear is pair.pinion else "wheel"
    rho = np.where(np.isnan(string), gear.base_radius * gear.junction[1], string)
    own = [
        one
        for one in deviations
        if isinstance(one, FlankShape) and one.gear == name and one.acts_on(flank)
    ]
    return np.asarray(sum((one.taken_off(pair, rho) for one in own), np.zeros(rho.shape)))


def whole(points: NDArray[np.complex128], teeth: int) -> NDArray[np.complex128]:
    """All ``teeth`` of a gear as one closed line, from one pitch of it [m].

    The point that two neighbours share is there once, and the first closes the line.

    >>> pitch = np.exp(1j * np.linspace(-0.5, 0.5, 5) * np.pi / 2)
    >>> whole(pitch, 4).size
    17
    """
    turns = np.exp(2j * math.pi * np.arange(teeth) / teeth)
    line = (turns[:, None] * points[None, :-1]).ravel()
    return np.concatenate([line, line[:1]])


class Span(NamedTuple):
    """What a caliper shows: ``length`` W_k [m] over ``teeth`` k, touching at ``radius`` [m]."""

    length: float
    teeth: int
    radius: float


def span_over_teeth(gear: Gear, set_back: float = 0.0, teeth: int | None = None) -> Span:
    """Base tangent length W_k = (k - 1) p_b + 2 (r_b theta_b - set_back) [m].

    ``set_back`` [m] of each flank; ``teeth`` k, left out the one that touches nearest to the middle
    of the involute flank. The jaws touch at sqrt(r_b^2 + (W_k/2)^2). Source: ISO 21771-1.

    >>> span = span_over_teeth(Gear(20, 4e-3))
    >>> f"{1e3 * span.length:.3f} mm over {span.teeth} teeth"
    '30.642 mm over 3 teeth'
    """
    thick = 2.0 * (gear.base_radius * gear.base_half_angle - set_back)
    if teeth is None:
        low, high = gear.form_radius, gear.tip_form_radius
        middle = 2.0 * float(gear.curvature_radius(0.5 * (low + high)))
        teeth = max(1, round(1.0 + (middle - thick) / gear.base_pitch))
    length = (teeth - 1) * gear.base_pitch + thick
    return Span(length, teeth, math.hypot(gear.base_radius, 0.5 * length))
