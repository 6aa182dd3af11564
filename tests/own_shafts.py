"""Two shafts with four bearings as heat sees them: the simplest, and random ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear import Gear, GearPair
from thermogear.base.materials import MATERIALS
from thermogear.heat.shaft_heat import Friction, HeatedBearing, ShaftHeat
from thermogear.shafts.train import SHAFTS, Section, Shaft

STEEL = MATERIALS["steel"]


@dataclass(frozen=True, kw_only=True)
class Size:
    """Of a bearing; left out, that of a 6205."""

    bore: float = 25e-3
    outside_diameter: float = 52e-3
    width: float = 15e-3
    pitch_diameter: float = 38.5e-3
    element_diameter: float = 7.938e-3
    elements: int = 9
    contact_angle: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Rubbing:
    """M = c (nu w)^(2/3) + f F r."""

    thick: float = 0.5
    arm: float = 4e-6

    def moment(
        self, *, force: ArrayLike, speed: ArrayLike, viscosity: ArrayLike
    ) -> NDArray[np.float64]:
        product = np.asarray(viscosity, float) * np.asarray(speed, float)
        return np.asarray(self.thick * product ** (2.0 / 3.0) + self.arm * np.asarray(force))


SMOOTH = Rubbing(thick=0.0, arm=0.0)


def train(
    *,
    length: float = 60e-3,
    diameters: tuple[float, float] = (25e-3, 25e-3),
    face: float = 20e-3,
    size: Size | None = Size(),
    friction: Friction = Rubbing(),
    seat: float = 10.0,
) -> ShaftHeat:
    """Bearings ``length`` from both faces of each gear, at the ends of the shafts."""
    whole = 2.0 * length + face
    shafts = [
        Shaft(
            sections=(Section(length=whole, outer_diameter=d, material=STEEL),),
            gear_position=0.5 * whole,
        )
        for d in diameters
    ]
    bearings = tuple(
        HeatedBearing(shaft=name, position=place, size=size, friction=friction, seat=seat)
        for name in SHAFTS
        for place in (0.0, whole)
    )
    return ShaftHeat(shafts=(shafts[0], shafts[1]), bearings=bearings)


def random_pair(random: np.random.Generator) -> GearPair:
    module = float(random.uniform(2e-3, 6e-3))
    pinion, wheel = (
        Gear(
            int(random.integers(*teeth)),
            module,
            face_width=float(random.uniform(8.0, 14.0)) * module,
            bore_radius=float(random.uniform(4.0, 6.0)) * module,
        )
        for teeth in ((18, 40), (40, 90))
    )
    return GearPair(pinion, wheel)


def random_train(random: np.random.Generator, pair: GearPair) -> ShaftHeat:
    """Stepped, hollow or solid shafts; a gear between its bearings or overhung."""
    shafts, bearings = [], []
    for name, gear in zip(SHAFTS, (pair.pinion, pair.wheel), strict=True):
        lengths = gear.face_width * random.uniform(0.8, 3.0, 4)
        outer = 2.0 * gear.bore_radius * random.uniform(0.7, 1.0, 4)
        hollow = random.uniform(0.0, 0.6) * outer.min() * float(random.integers(0, 2))
        sections = tuple(
            Section(length=float(x), outer_diameter=float(d), inner_diameter=hollow, material=STEEL)
            for x, d in zip(lengths, outer, strict=True)
        )
        whole, half = float(lengths.sum()), 0.5 * gear.face_width
        if random.integers(0, 3):
            at = float(random.uniform(0.35, 0.65)) * whole
            places = [0.02 * whole, 0.97 * whole]
        else:
            at = half
            places = [at + 1.3 * half, 0.95 * whole]
        shafts.append(Shaft(sections=sections, gear_position=at))
        bore = 0.9 * float(outer.min())
        size = Size(
            bore=bore,
            outside_diameter=2.08 * bore,
            width=0.6 * bore,
            pitch_diameter=1.54 * bore,
            element_diameter=0.32 * bore,
            elements=int(random.integers(7, 12)),
        )
        bearings += [
            HeatedBearing(
                shaft=name,
                position=place,
                size=size,
                friction=Rubbing(
                    thick=9e3 * (1.54 * bore) ** 3, arm=float(random.uniform(1e-4, 4e-4)) * bore
                ),
                seat=float(random.uniform(2.0, 40.0)),
            )
            for place in places
        ]
    return ShaftHeat(shafts=(shafts[0], shafts[1]), bearings=tuple(bearings))
