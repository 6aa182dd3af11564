"""The drive train of a case, drawn once and made ready for every state of heat."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.materials import MATERIALS
from thermogear.base.notice import Notice
from thermogear.gears.pair import GearPair
from thermogear.heat.shaft_heat import CoefficientFriction, Friction, HeatedBearing, ShaftHeat
from thermogear.mesh.balance import HeatBalance
from thermogear.mesh.operating import Operating
from thermogear.shafts.bearings.clearance import Fit, mounted_clearance
from thermogear.shafts.bearings.friction import PalmgrenFriction, SkfFriction
from thermogear.shafts.bearings.geometry import RollingBearing
from thermogear.shafts.bearings.laws import BearingLaw, ElementLaw, LinearLaw, RingLaw
from thermogear.shafts.bearings.life import least_load, rating_life, static_safety
from thermogear.shafts.mesh_lines import MeshFrame
from thermogear.shafts.train import (
    SHAFTS,
    Bearing,
    DriveTrain,
    Seat,
    Section,
    Shaft,
    TrainParts,
)

_Made = TypeVar("_Made")
GRAVITY = 9.80665
LOSS_TIME = 3e-6
"""Damping over stiffness of a bearing [s]: 2 to 5e-6 are measured of small ball bearings."""
MISFIT = 0.05
"""A bore this share off the shaft's diameter is told."""
RINGS = MATERIALS["steel"]
"""Rings and elements: bearing steel."""


@dataclass(frozen=True, kw_only=True)
class BearingPlan:
    """A bearing of the drawing: rolling with its play and fits, or a ``law`` of its own.

    ``position`` [m] from the shaft's left end; ``play`` G_r [m] as delivered; ``seat`` in the
    housing; ``given`` temperatures [K] of inner and outer ring, None where computed; ``field`` of
    the file it came from.
    """

    name: str
    shaft: str
    position: float
    field: str
    rolling: RollingBearing | None = None
    play: float = 0.0
    fit: Fit | None = None
    law: BearingLaw | None = None
    damping: float | None = None
    seat: Seat | None = None
    seat_conductance: float = 10.0
    lubrication: str = "bath"
    friction: str = "palmgren"
    given: tuple[float | None, float | None] = (None, None)

    def clearance(self, temperatures: Floats, reference: float) -> float:
        """Half of the play [m] mounted, at (inner, elements, outer ring, housing) [K]."""
        if self.rolling is None or self.fit is None:
            return self.law.clearance if isinstance(self.law, RingLaw) else math.nan
        return float(
            mounted_clearance(
                self.rolling,
                self.play,
                self.fit,
                temperatures[:3],
                shaft_temperature=temperatures[0],
                housing_temperature=temperatures[3],
                reference=reference,
            )
        )

    def placed(self, clearance: float, load: float) -> Bearing:
        """The bearing with a half play ``clearance`` [m]; ``load`` [N] for a damping left out."""
        law = self.law if self.rolling is None else self.rolling.law(clearance)
        assert law is not None
        damping = LOSS_TIME * loaded_stiffness(law, load) if self.damping is None else self.damping
        return Bearing(
            name=self.name,
            shaft=self.shaft,
            position=self.position,
            law=law,
            damping=damping,
            seat=self.seat,
        )


@dataclass(frozen=True, kw_only=True)
class TrainPlan(TrainParts):
    """Shafts, bearings and what hangs on them, as the tables of a case draw them (SI).

    ``nominal_force`` [N] of the mesh at the greatest torque: damping that is left out follows it.
    ``cage_slip``: by how much of their kinematic speed cages turn slower in motion; 1: they stand.
    """

    bearings: tuple[BearingPlan, ...]
    centre_line: float
    sense: int
    nominal_force: float
    reference: float
    cage_slip: float = 1.0

    def cage_orders(self, teeth: tuple[int, int]) -> list[float]:
        """Turns of every cage about +z in a mesh period of gears with so many ``teeth``.

        (1 - s) (1 - g)/2 of its shaft's; the wheel turns the other way. 0 where it is held, and of
        bearings without rolling elements.
        """
        shafts = {SHAFTS[0]: self.sense / teeth[0], SHAFTS[1]: -self.sense / teeth[1]}
        return [
            (1.0 - self.cage_slip) * one.rolling.cage_order * shafts[one.shaft]
            if one.rolling is not None
            else 0.0
            for one in self.bearings
        ]

    def ball_pass_orders(self, teeth: tuple[int, int]) -> Floats:
        """Elements that pass a point of the outer ring in a mesh period (bearing,); nan: none."""
        return np.array(
            [
                one.rolling.elements * abs(order) if order and one.rolling is not None else math.nan
                for one, order in zip(self.bearings, self.cage_orders(teeth), strict=True)
            ]
        )

    @property
    def bearing_names(self) -> tuple[str, ...]:
        """Names of the bearings, in the order of every array over them."""
        return tuple(one.name for one in self.bearings)

    @property
    def passing_orders(self) -> list[tuple[str, str, float]]:
        """(name, shaft, elements passing the load per turn of that shaft) of rolling bearings."""
        return [
            (one.name, one.shaft, one.rolling.outer_order)
            for one in self.bearings
            if one.rolling is not None
        ]

    def drive_train(self, *, pair: GearPair, half_plays: Floats | None = None) -> DriveTrain:
        """The train with ``half_plays`` (bearing,) [m]; left out: mounted, undeformed."""
        if half_plays is None:
            even = np.full((len(self.bearings), 4), self.reference)
            half_plays = self.half_plays(even, reference=self.reference)
        frame = MeshFrame(
            base_radii=(pair.pinion.base_radius, pair.wheel.base_radius),
            teeth=(pair.pinion.teeth, pair.wheel.teeth),
            pressure_angle=pair.operating_pressure_angle,
            centre_line=self.centre_line,
            sense=self.sense,
        )
        half = 0.5 * self.nominal_force
        return DriveTrain(
            frame=frame,
            bearings=tuple(
                one.placed(float(c), half) for one, c in zip(self.bearings, half_plays, strict=True)
            ),
            **{one.name: getattr(self, one.name) for one in fields(TrainParts)},
        )

    def half_plays(self, temperatures: Floats, *, reference: float) -> Floats:
        """Half of the play [m] of every bearing at ``temperatures`` (bearing, 4) [K].

        Inner ring and shaft, elements, outer ring, housing; nan where a bearing has none.
        """
        return np.array(
            [
                one.clearance(t, reference)
                for one, t in zip(self.bearings, temperatures, strict=True)
            ]
        )

    def bearing_temperatures(self, at: Operating, balance: HeatBalance | None) -> Floats:
        """(operating, bearing, 4) [K]: inner ring and shaft, elements, outer ring, housing.

        The rings' own nodes where the heat balance has them, else the gear's bore and the housing;
        what the case gives comes first, elements lie between the rings. Undeformed all is at the
        reference.
        """
        count = at.speed.size
        found = np.empty((count, len(self.bearings), 4))
        nodes: Mapping[str, Any] = {} if balance is None else balance.steady.temperatures
        names = self.heated_names
        cold = all(np.all(t == at.temperatures.reference) for t in at.temperatures.bodies.values())
        for place, one in enumerate(self.bearings):
            bore = getattr(at.temperatures, f"{one.shaft}_bore")
            inner = f"{names[one.name]}_inner"
            rings = [
                nodes.get(inner, bore),
                nodes.get(f"{names[one.name]}_outer", nodes.get(inner, at.temperatures.housing)),
            ]
            rings = (
                [
                    seen if told is None else told
                    for seen, told in zip(rings, one.given, strict=True)
                ]
                if not cold
                else [bore, at.temperatures.housing]
            )
            found[:, place, 0], found[:, place, 2] = (np.broadcast_to(t, count) for t in rings)
            found[:, place, 1] = 0.5 * (found[:, place, 0] + found[:, place, 2])
            found[:, place, 3] = np.broadcast_to(at.temperatures.housing, count)
        return found

    @property
    def heated_names(self) -> dict[str, str]:
        """Name of every bearing in the heat network, by its own."""
        along = sorted(self.bearings, key=lambda b: b.position)
        return {
            one.name: f"{shaft}_bearing_{n}"
            for shaft in SHAFTS
            for n, one in enumerate((b for b in along if b.shaft == shaft), 1)
        }

    def heat(self, pair: GearPair, *, coefficient: float) -> ShaftHeat:
        """Shafts and bearings for the heat network.

        Two bearings of a shaft share the mesh force by their levers, more by their stiffness under
        the greatest torque. A bearing whose inside is not known turns with the friction
        ``coefficient`` [-] at the shaft's diameter, and its rings are one node.
        """
        shares = self._shares(pair)
        return ShaftHeat(
            shafts=self.shafts,
            bearings=tuple(
                HeatedBearing(
                    shaft=one.shaft,
                    position=one.position,
                    size=one.rolling,
                    friction=self._friction(one, coefficient),
                    seat=one.seat_conductance,
                    share=shares.get(one.name),
                )
                for one in self.bearings
            ),
        )

    def _shares(self, pair: GearPair) -> dict[str, float]:
        """Part of the mesh force on every bearing where a shaft has more than two; else nothing."""
        if all(sum(b.shaft == s for b in self.bearings) == 2 for s in SHAFTS):
            return {}
        from thermogear.shafts.assembly import assemble
        from thermogear.shafts.statics import equilibrium

        force = max(self.nominal_force, 1.0)
        parts = assemble(replace(self, gravity=0.0).drive_train(pair=pair))
        torque = force * pair.pinion.base_radius
        found = equilibrium(parts, torque, mesh=1e8, half_backlash=0.0).bearing_force
        loads = np.linalg.norm(found, axis=1) / force
        return dict(zip(self.bearing_names, loads.tolist(), strict=True))

    def _friction(self, one: BearingPlan, coefficient: float) -> Friction:
        if one.rolling is None:
            under = section_at(self.shafts[SHAFTS.index(one.shaft)], one.position)
            return CoefficientFriction(coefficient=coefficient, diameter=under.outer_diameter)
        made = SkfFriction if one.friction == "skf" else PalmgrenFriction
        return made(bearing=one.rolling, lubrication=one.lubrication)

    def limits(self, loads: Floats, speed: float, ratio: float) -> dict[str, Floats]:
        """Static safety, load over least load and L10 [s] of every bearing; nan where unknown.

        ``loads`` (bearing,) [N], ``speed`` [rad/s] of the pinion, ``ratio`` of the wheel's to it.
        """
        found = {
            name: np.full(len(self.bearings), np.nan)
            for name in ("static_safety", "least_load_ratio", "life")
        }
        for place, one in enumerate(self.bearings):
            if one.rolling is None:
                continue
            load = float(loads[place])
            turns = abs(speed * (1.0 if one.shaft == SHAFTS[0] else ratio)) / (2.0 * math.pi)
            found["static_safety"][place] = static_safety(one.rolling, load)
            found["least_load_ratio"][place] = load / least_load(one.rolling)
            if turns > 0.0:
                found["life"][place] = rating_life(one.rolling, load) / turns
        return found

    def misfits(self) -> Iterator[Notice]:
        """What of the bearings is unusual: bores that differ from the shaft's size, preloads."""
        for one in self.bearings:
            if one.rolling is None:
                continue
            under = section_at(self.shafts[SHAFTS.index(one.shaft)], one.position).outer_diameter
            if abs(under / one.rolling.bore - 1.0) > MISFIT:
                yield Notice.of(
                    "bore_unlike_shaft", about=one.name, bore=one.rolling.bore, shaft=under
                )
            if one.play < 0.0:
                yield Notice.of("bearing_preloaded_as_delivered", about=one.name, play=one.play)


def loaded_stiffness(law: BearingLaw, load: float) -> float:
    """Tangent stiffness [N/m] of a law, its clearance taken out, under ``load`` [N] along x."""
    if isinstance(law, LinearLaw):
        return float(0.5 * np.trace(np.asarray(law.stiffness_matrix)))
    if isinstance(law, RingLaw):
        scale, exponent = law.coefficient, law.exponent
    else:
        assert isinstance(law, ElementLaw)
        still = ElementLaw(
            elements=law.elements, coefficient=law.coefficient, exponent=law.exponent
        )
        scale, exponent = float(-still.force([1.0, 0.0])[0]), law.exponent
    return float(exponent * scale ** (1.0 / exponent) * max(load, 1.0) ** (1.0 - 1.0 / exponent))


def section_at(shaft: Shaft, position: float) -> Section:
    """The section at ``position`` [m]; at a step the thicker one."""
    start, found = 0.0, []
    for one in shaft.sections:
        if start - 1e-9 <= position <= start + one.length + 1e-9:
            found.append(one)
        start += one.length
    return max(found or shaft.sections[-1:], key=lambda one: one.outer_diameter)
