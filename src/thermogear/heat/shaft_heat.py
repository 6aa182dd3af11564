"""Shafts and bearings in the thermal network: conduction along the shafts, through rings and seats.

A bearing has two nodes, its inner ring with the shaft inside it and its outer ring. Along a shaft
the nodes follow one another as they sit: heat goes from the gear to the nearest bearing of each
side and on to the next. SI; positions along a shaft from its left end.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.materials import MATERIALS, Lubricant, Material
from thermogear.heat.lubrication import kinematic_viscosity
from thermogear.heat.network import Link
from thermogear.shafts.bearings.geometry import RollingBearing
from thermogear.shafts.train import SHAFTS, Shaft

RACE = 0.7
"""A ring's edge lies at d_m -+ this share of D_w, as far as its mass goes (ours)."""
RINGS = MATERIALS["steel"]
"""What rings and rolling elements are made of."""
SLOWEST = 1.0
"""Speed [rad/s] below which rings conduct as at this speed."""


class Friction(Protocol):
    """What turns hard in a bearing."""

    def moment(self, *, force: ArrayLike, speed: ArrayLike, viscosity: ArrayLike) -> Floats:
        """Friction moment [N m] of a radial force [N], a speed [rad/s], an oil's nu [m^2/s]."""


def ring_conductance(
    speed: ArrayLike, *, elements: int, element_diameter: float, bore: float
) -> Floats:
    """From inner to outer ring through the rolling elements [W/K].

    G = 590 Z D_w^2 sqrt(7 + ln(w (d + D_w)/(2000 D_w))),   590 in W/(m^2 K), w in rad/s, m.

    ``speed`` w of shaft against housing [rad/s], any shape and sign; ``elements`` Z;
    ``element_diameter`` D_w, ``bore`` d [m]. Below 1 rad/s, where the logarithm loses its sense, G
    stays as there. Raises where that is not positive, d < 0.83 D_w. Made for ball bearings that
    turn; the load is not in it. Source: Schroeder's library thermca, which quotes a work of 1993
    that could not be read.

    >>> G = ring_conductance(314.16, elements=9, element_diameter=7.938e-3, bore=25e-3)
    >>> f"{G:.2f} W/K"
    '0.86 W/K'
    """
    omega = np.maximum(np.abs(np.asarray(speed, dtype=float)), SLOWEST)
    inside = 7.0 + np.log(omega * (bore + element_diameter) / (2000.0 * element_diameter))
    if not np.all(inside > 0.0):
        raise InputError(
            "bearing.bore",
            f"{1e3 * bore:g} mm with elements of {1e3 * element_diameter:g} mm",
            allowed="bore > 0.83 element diameters",
            why="the law of heat through the elements is made for such bearings",
        )
    return np.asarray(590.0 * elements * element_diameter**2 * np.sqrt(inside))


def inner_share(
    contact_angle: float = 0.0, *, element_diameter: float, pitch_diameter: float
) -> float:
    """Share of a bearing's friction that is heat of its inner ring, at most 1 [-].

    0.5 + 1.08 (D_w/d_m)(1 - sin a)^0.37,   ``contact_angle`` a [rad], diameters D_w, d_m [m].

    Made for d_m > 3 D_w. Source: the library thermca, after a work of 2010 that could not be read.

    >>> f"{inner_share(element_diameter=7.938e-3, pitch_diameter=38.5e-3):.2f}"
    '0.72'
    """
    lean = (1.0 - np.sin(contact_angle)) ** 0.37
    return float(min(0.5 + 1.08 * lean * element_diameter / pitch_diameter, 1.0))


def lever_shares(positions: ArrayLike, *, gear_position: float) -> Floats:
    """Force on each of two bearings over the force on the gear, by the levers; its size, (2,) [-].

    R_1 = |x_2 - x_g|/|x_2 - x_1|, R_2 = |x_g - x_1|/|x_2 - x_1|. ``positions`` x_1, x_2 and
    ``gear_position`` x_g [m] from one end. One is above 1 where the gear overhangs. Raises for
    another number of bearings, where statics alone does not decide, and for two in one place.

    >>> [f"{share:.2f}" for share in lever_shares([0.0, 0.2], gear_position=0.05)]
    ['0.75', '0.25']
    """
    places = np.asarray(positions, dtype=float)
    if places.shape != (2,) or places[0] == places[1]:
        raise InputError(
            "bearings",
            f"{places.size} at {', '.join(f'{1e3 * x:g}' for x in places.ravel())} mm",
            allowed="two on a shaft, apart",
            why="only then the levers alone say what each carries",
            fix="give the shares",
        )
    return np.asarray(np.abs(places[::-1] - gear_position) / np.abs(places[1] - places[0]))


@dataclass(frozen=True, kw_only=True)
class HeatedBearing:
    """A rolling bearing as a source and a path of heat.

    ``shaft`` "pinion" or "wheel"; ``position`` [m] of its middle from the shaft's left end;
    ``friction``; ``seat`` [W/K] from the outer ring into the housing; ``size``, None where it is
    not known: then the bearing is one node, the inner ring's, on its seat. ``share`` of the pair's
    normal force that it carries [-], None where the levers of two bearings say it.
    """

    shaft: str
    position: float
    friction: Friction
    seat: float
    size: RollingBearing | None = None
    share: float | None = None

    def __post_init__(self) -> None:
        if self.shaft not in SHAFTS:
            raise InputError("bearing.shaft", repr(self.shaft), allowed=" | ".join(SHAFTS))
        if self.share is not None and not (np.isfinite(self.share) and self.share >= 0.0):
            raise InputError("bearing.share", self.share, allowed=">= 0, finite")
        if not (np.isfinite(self.seat) and self.seat > 0.0):
            raise InputError("bearing.seat", f"{self.seat} W/K", allowed="> 0 W/K, finite")
        size = self.size
        if size is None:
            return
        room = 0.5 * (size.outside_diameter - size.bore)
        if not 0.0 < size.element_diameter < room or size.elements < 1 or not size.width > 0.0:
            raise InputError(
                "bearing",
                f"{size.elements} elements of {1e3 * size.element_diameter:g} mm between bore "
                f"{1e3 * size.bore:g} and outside {1e3 * size.outside_diameter:g} mm",
                allowed="one or more elements that fit between both rings",
            )

    def loss(self, force: ArrayLike, speed: ArrayLike, viscosity: ArrayLike) -> Floats:
        """Friction moment times speed [W] at the bearing's own ``force`` [N]."""
        omega = np.abs(np.asarray(speed, dtype=float))
        moment = self.friction.moment(force=force, speed=omega, viscosity=viscosity)
        return np.asarray(moment * omega)


def ring_capacities(size: RollingBearing, steel: Material) -> tuple[float, float]:
    """Heat [J/K] that inner and outer ring hold, each with half of the elements.

    Rings end at d_m -+ 0.7 D_w, elements are balls: catalogue masses to about a tenth.

    >>> from thermogear.shafts.bearings.catalogue import catalogue_bearing
    >>> inner, outer = ring_capacities(catalogue_bearing("6205"), MATERIALS["steel"])
    >>> f"{inner:.0f} J/K, {outer:.0f} J/K"
    '24 J/K, 38 J/K'
    """
    away = RACE * size.element_diameter
    balls = 0.5 * size.elements * np.pi / 6.0 * size.element_diameter**3
    inner = _area(size.pitch_diameter - away, size.bore) * size.width
    outer = _area(size.outside_diameter, size.pitch_diameter + away) * size.width
    held = steel.density * steel.specific_heat
    return held * (inner + balls), held * (outer + balls)


@dataclass(frozen=True, kw_only=True)
class CoefficientFriction:
    """M = mu F d/2 of a bearing of which no more is known: ``coefficient`` mu, ``diameter`` d [m].

    >>> law = CoefficientFriction(coefficient=0.0015, diameter=40e-3)
    >>> f"{1e3 * law.moment(force=2000.0, speed=300.0, viscosity=20e-6):.0f} N mm"
    '60 N mm'
    """

    coefficient: float
    diameter: float

    def moment(self, *, force: ArrayLike, speed: ArrayLike, viscosity: ArrayLike) -> Floats:
        """M [N m] at ``force`` [N], whatever speed and viscosity; shape of the force."""
        return np.asarray(0.5 * self.coefficient * self.diameter * np.asarray(force, dtype=float))


@dataclass(frozen=True, eq=False, kw_only=True)
class BearingLoss:
    """What a bearing does in a thermal state: numbers or arrays over operating points.

    ``loss`` [W]; ``temperature`` [K], the mean of both rings, and ``viscosity`` [m^2/s] of the oil
    at it, nan where a loss is given and nothing else is known.
    """

    loss: ArrayLike
    temperature: ArrayLike = np.nan
    viscosity: ArrayLike = np.nan

    def changed(self, change: Callable[[ArrayLike], Floats]) -> BearingLoss:
        """The same with every number changed."""
        return BearingLoss(**{one.name: change(getattr(self, one.name)) for one in fields(self)})


@dataclass(frozen=True, kw_only=True)
class ShaftHeat:
    """Both shafts with their bearings as heat sees them.

    ``shafts`` of pinion and wheel, each with the place of its gear; ``bearings``. A
    bearing is called by its shaft and its place from the left end: "pinion_bearing_1".
    """

    shafts: tuple[Shaft, Shaft]
    bearings: tuple[HeatedBearing, ...]

    def __post_init__(self) -> None:
        for name, shaft in zip(SHAFTS, self.shafts, strict=True):
            for one in shaft.sections:
                if not (one.length > 0.0 and 0.0 <= one.inner_diameter < one.outer_diameter):
                    raise InputError(
                        f"{name} shaft",
                        f"a section of {1e3 * one.length:g} mm, {1e3 * one.inner_diameter:g} to "
                        f"{1e3 * one.outer_diameter:g} mm",
                        allowed="length > 0, 0 <= inner < outer diameter",
                    )
            places = [b.position for b in self.bearings if b.shaft == name]
            if not places:
                raise InputError(f"{name} shaft", "no bearing", allowed="one or more")
            for place in (*places, shaft.gear_position):
                if not 0.0 <= place <= shaft.length * (1.0 + 1e-12):
                    raise InputError(
                        f"{name} shaft",
                        f"a bearing or gear at {1e3 * place:g} mm",
                        allowed=f"0..{1e3 * shaft.length:g} mm",
                    )
            if len(set(places)) < len(places):
                raise InputError(f"{name} shaft", "two bearings in one place", allowed="apart")
        _ = self.shares

    @property
    def named(self) -> dict[str, HeatedBearing]:
        """The bearings by name, from the left end of the pinion's shaft on."""
        return {
            f"{shaft}_bearing_{place}": one
            for shaft in SHAFTS
            for place, one in enumerate(
                sorted((b for b in self.bearings if b.shaft == shaft), key=lambda b: b.position), 1
            )
        }

    @property
    def shares(self) -> dict[str, float]:
        """Force of each bearing over the pair's normal force [-], by its name."""
        found = {}
        for shaft, drawn in zip(SHAFTS, self.shafts, strict=True):
            mine = {name: one for name, one in self.named.items() if one.shaft == shaft}
            levers = np.empty(0)
            if any(one.share is None for one in mine.values()):
                places = [one.position for one in mine.values()]
                levers = lever_shares(places, gear_position=drawn.gear_position)
            for place, (name, one) in enumerate(mine.items()):
                found[name] = float(levers[place]) if one.share is None else one.share
        return found

    @property
    def nodes(self) -> tuple[str, ...]:
        """The nodes of the rings: "pinion_bearing_1_inner", "pinion_bearing_1_outer", ..."""
        return tuple(f"{name}_{ring}" for name, one in self.named.items() for ring in _rings(one))

    def losses(
        self,
        temperatures: Mapping[str, ArrayLike],
        lubricant: Lubricant,
        force: ArrayLike,
        speeds: tuple[ArrayLike, ArrayLike],
    ) -> dict[str, BearingLoss]:
        """Losses at ``temperatures`` [K] of the nodes, by name of the bearing.

        ``force`` [N] of the pair, ``speeds`` [rad/s] of pinion and wheel; arrays of one shape.
        """
        found, shares = {}, self.shares
        for name, one in self.named.items():
            rings = [np.asarray(temperatures[f"{name}_{r}"], float) for r in _rings(one)]
            mean = np.asarray(0.5 * (rings[0] + rings[-1]))
            viscosity = kinematic_viscosity(lubricant, mean)
            load = shares[name] * np.asarray(force, dtype=float)
            loss = one.loss(load, speeds[SHAFTS.index(one.shaft)], viscosity)
            found[name] = BearingLoss(loss=loss, temperature=mean, viscosity=viscosity)
        return found

    def sources(self, losses: Mapping[str, BearingLoss]) -> dict[str, Floats]:
        """Heat into the rings [W]; raises where ``losses`` are not those of the bearings."""
        named = self.named
        if set(losses) != set(named):
            raise InputError(
                "losses.bearings", ", ".join(losses) or "none", allowed=", ".join(named)
            )
        found = {}
        for name, one in named.items():
            watts, size = np.asarray(losses[name].loss, dtype=float), one.size
            if size is None:
                found[f"{name}_inner"] = watts
                continue
            share = inner_share(
                size.contact_angle,
                element_diameter=size.element_diameter,
                pitch_diameter=size.pitch_diameter,
            )
            found[f"{name}_inner"] = share * watts
            found[f"{name}_outer"] = watts - found[f"{name}_inner"]
        return found

    def paths(
        self, shaft: str, face_width: float, speed: ArrayLike
    ) -> tuple[list[Link], dict[str, float]]:
        """Links from a gear's shaft node to the housing, and the heat [J/K] their nodes hold.

        Between two bearings, or from the gear's face to a bearing's middle, the sections conduct in
        series, 1/G = sum l/(k A). Their mass goes half to either end, what overhangs to the last
        node. ``face_width`` [m] of the gear, ``speed`` [rad/s]. Raises where a bearing sits within
        the gear's face.
        """
        drawn = self.shafts[SHAFTS.index(shaft)]
        middle, half = drawn.gear_position, 0.5 * face_width
        hub = f"{shaft}_shaft"
        links: list[Link] = []
        held = {hub: _between(drawn, middle - half, middle + half).capacity}
        mine = {name: one for name, one in self.named.items() if one.shaft == shaft}
        for one in mine.values():
            if abs(one.position - middle) <= half:
                raise InputError(
                    f"{shaft} shaft",
                    f"a bearing at {1e3 * one.position:g} mm",
                    allowed=f"beyond the gear's face, {1e3 * (middle - half):g} to "
                    f"{1e3 * (middle + half):g} mm",
                )
        for side in (-1.0, 1.0):
            node, at = hub, middle + side * half
            beyond = {n: b for n, b in mine.items() if side * (b.position - middle) > 0.0}
            for name, one in sorted(beyond.items(), key=lambda item: side * item[1].position):
                piece = _between(drawn, at, one.position)
                links.append(Link(node, f"{name}_inner", 1.0 / piece.resistance))
                held[node] += 0.5 * piece.capacity
                node, at = f"{name}_inner", one.position
                held[node] = 0.5 * piece.capacity
            held[node] += _between(drawn, at, drawn.length if side > 0.0 else 0.0).capacity
        for name, one in mine.items():
            size, rings = one.size, _rings(one)
            if size is not None:
                ring = ring_conductance(
                    speed,
                    elements=size.elements,
                    element_diameter=size.element_diameter,
                    bore=size.bore,
                )
                links.append(Link(f"{name}_inner", f"{name}_outer", ring))
                inner, held[f"{name}_outer"] = ring_capacities(size, RINGS)
                held[f"{name}_inner"] += inner
            links.append(Link(f"{name}_{rings[-1]}", "housing", one.seat))
        return links, held

    def along(self, shaft: str, *, face_width: float, distance: float) -> tuple[str, float]:
        """Where heat leaves a gear along its shaft: the next node and how far towards it.

        The inner ring of the next bearing to the left of the gear, to its right where none is on
        the left, and the share of the fall from the gear's shaft node to it that lies before
        ``distance`` [m] from the face, 0..1 [-]. Raises beyond the bearing.
        """
        drawn = self.shafts[SHAFTS.index(shaft)]
        middle = drawn.gear_position
        mine = {n: b.position for n, b in self.named.items() if b.shaft == shaft}
        left = {n: x for n, x in mine.items() if x < middle}
        name = max(left, key=mine.__getitem__) if left else min(mine, key=mine.__getitem__)
        side = -1.0 if left else 1.0
        face = middle + side * 0.5 * face_width
        free = side * (mine[name] - face)
        if not 0.0 <= distance <= free:
            raise InputError(
                "sensors.ring.distance",
                f"{1e3 * distance:g} mm",
                allowed=f"0..{1e3 * free:g} mm",
                why=f"it lies between the gear and {name.replace('_', ' ')}",
            )
        whole = _between(drawn, face, mine[name]).resistance
        return f"{name}_inner", _between(drawn, face, face + side * distance).resistance / whole


def _rings(bearing: HeatedBearing) -> tuple[str, ...]:
    """The nodes of a bearing."""
    return ("inner",) if bearing.size is None else ("inner", "outer")


class _Piece(NamedTuple):
    """Of a piece of a shaft: resistance [K/W] along it, heat it holds [J/K]."""

    resistance: float
    capacity: float


def _between(shaft: Shaft, first: float, second: float) -> _Piece:
    """The piece of ``shaft`` between two places [m]."""
    low, high = min(first, second), max(first, second)
    resistance, capacity, at = 0.0, 0.0, 0.0
    for one in shaft.sections:
        length = max(0.0, min(high, at + one.length) - max(low, at))
        area = _area(one.outer_diameter, one.inner_diameter)
        resistance += length / (one.material.thermal_conductivity * area)
        capacity += length * area * one.material.density * one.material.specific_heat
        at += one.length
    return _Piece(resistance, capacity)


def _area(outer: float, inner: float) -> float:
    return 0.25 * np.pi * (outer**2 - inner**2)
