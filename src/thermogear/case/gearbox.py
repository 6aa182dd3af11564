"""The gearbox of a case and its thermometers, out of the file's tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from thermogear.base.errors import InputError
from thermogear.base.materials import MATERIALS, Material
from thermogear.case.gearbox_schema import NODES, GearboxTable, ReadingTable
from thermogear.case.schema import GearFile
from thermogear.case.shaft_plan import TrainPlan
from thermogear.gears.pair import GearPair
from thermogear.heat.gearbox import Surroundings
from thermogear.heat.measured_temperature import InfraredReading, ThermocoupleReading
from thermogear.mesh.balance import Gearbox
from thermogear.shafts.train import SHAFTS

STATED = {
    "housing": "housing",
    "pinion_bore": "pinion_shaft",
    "wheel_bore": "wheel_shaft",
}
"""Temperatures of the file's table that hold a node where the addenda are computed."""

_OURS = Surroundings()
ROOM = 293.15
"""Window temperature [K] of an infrared reading that gives none."""


CLEAR = 0.02
"""From the gears' tips to the walls of a housing that is not given [m]; ours."""
WALL = 0.008
"""The thickness of those walls [m]; ours."""
OIL = 870.0
"""The density of the oil in it [kg/m^3]."""


class Box(NamedTuple):
    """A housing as a box: its outer area [m^2], its mass and that of the oil in it [kg]."""

    area: float
    mass: float
    oil_mass: float


def housing_box(
    pair: GearPair, shaft_length: float, immersion: float, material: Material = MATERIALS["steel"]
) -> Box:
    """A box around ``pair``, as wide as the face and two shafts of ``shaft_length`` [m] each.

    Length a + r_a1 + r_a2 + 2 c, height 2 max(r_a) + 2 c, with c of 20 mm; the oil level is
    ``immersion`` (over the wheel's tip radius) above the wheel's lowest point, gears not counted.
    """
    first, second = pair.pinion.tip_radius, pair.wheel.tip_radius
    length = pair.centre_distance + first + second + 2.0 * CLEAR
    height = 2.0 * max(first, second) + 2.0 * CLEAR
    width = pair.face_width + 2.0 * shaft_length
    area = 2.0 * (length * height + length * width + height * width)
    level = CLEAR + immersion * second
    return Box(area, area * WALL * material.density, OIL * length * width * level)


@dataclass(frozen=True, kw_only=True)
class Reading:
    """A corrected thermometer reading [K] of one node with its standard uncertainty [K]."""

    node: str
    kind: str
    indicated: float
    temperature: float
    uncertainty: float


def gearbox(
    file: GearFile, pair: GearPair, housing: Material
) -> tuple[Gearbox, tuple[Reading, ...]]:
    """What heats and cools the pair, and the readings that hold nodes of it."""
    table = GearboxTable() if file.gearbox is None else file.gearbox
    readings = tuple(_readings(table, pair))
    held: dict[str, float] = {one.node: one.temperature for one in readings}
    if table.measured is not None:
        held |= table.measured.model_dump(exclude_none=True)
    if file.temperatures.computed:
        held |= _stated(file, held)
    wetted, given = table.wetted_share, table.housing_coefficient
    box = housing_box(pair, table.shaft_length, table.immersion, housing)
    return Gearbox(
        surroundings=Surroundings(
            ambient=table.ambient,
            housing_area=box.area if table.housing_area is None else table.housing_area,
            housing_coefficient=_OURS.housing_coefficient if given is None else given,
            housing_coefficient_at=_OURS.housing_coefficient_at if given is None else None,
            oil_housing_coefficient=table.oil_housing_coefficient,
            wetted_share=(wetted[0], wetted[-1]),
            shaft_length=table.shaft_length,
            bearing_conductance=table.bearing_conductance,
            oil_mass=box.oil_mass if table.oil_mass is None else table.oil_mass,
            housing_mass=box.mass if table.housing_mass is None else table.housing_mass,
            housing_specific_heat=housing.specific_heat
            if table.housing_specific_heat is None
            else table.housing_specific_heat,
            oil_flow=table.oil_flow,
            supply_temperature=table.supply_temperature,
        ),
        immersion=table.immersion,
        bearing_coefficient=table.bearing_coefficient,
        measured=held,
    ), readings


def heated(
    file: GearFile, pair: GearPair, box: Gearbox, train: TrainPlan, housing: Material
) -> Gearbox:
    """The gearbox with shafts and bearings as nodes.

    A housing that is left out is as wide as the longer shaft between its bearings.
    """
    drawn = train.heat(pair, coefficient=box.bearing_coefficient)
    table = GearboxTable() if file.gearbox is None else file.gearbox
    places = [[b.position for b in train.bearings if b.shaft == name] for name in SHAFTS]
    width = max(max(mine) - min(mine) for mine in places)
    beside = max(0.0, 0.5 * (width - pair.face_width))
    walls = housing_box(pair, beside, table.immersion, housing)
    around = replace(
        box.surroundings,
        train=drawn,
        housing_area=walls.area if table.housing_area is None else table.housing_area,
        housing_mass=walls.mass if table.housing_mass is None else table.housing_mass,
        oil_mass=walls.oil_mass if table.oil_mass is None else table.oil_mass,
    )
    return replace(box, surroundings=around)


def _stated(file: GearFile, held: Mapping[str, float]) -> dict[str, float]:
    """Nodes that [temperatures] and [oil] hold where the addenda are computed."""
    given = {
        f"temperatures.{name}": (node, getattr(file.temperatures, name))
        for name, node in STATED.items()
    }
    given["oil.temperature"] = ("oil", file.oil.temperature)
    found: dict[str, float] = {}
    for field, (node, value) in given.items():
        if value is None:
            continue
        if node in held:
            raise InputError(
                field,
                "a temperature of a node that [gearbox] holds too",
                allowed="one of the two",
                fix=f"leave it out, or leave out {node} in [gearbox.measured] and its reading",
            )
        found[node] = value
    return found


def _readings(table: GearboxTable, pair: GearPair) -> list[Reading]:
    found = []
    for node in NODES:
        entry: ReadingTable | None = getattr(table.readings, node) if table.readings else None
        if entry is None:
            continue
        material = (pair.wheel if node.startswith("wheel") else pair.pinion).material
        try:
            made = _corrected(entry, material)
            temperature, sigma = made.temperature(), made.uncertainty()
        except InputError as error:
            raise InputError(
                f"gearbox.readings.{node}",
                f"{entry.kind} reading {entry.indicated:.6g} K",
                allowed=error.allowed,
                why=error.why or str(error),
                fix=error.fix,
            ) from error
        found.append(
            Reading(
                node=node,
                kind=entry.kind,
                indicated=entry.indicated,
                temperature=temperature,
                uncertainty=sigma,
            )
        )
    return found


def _corrected(entry: ReadingTable, material: Material) -> InfraredReading | ThermocoupleReading:
    if entry.kind == "infrared":
        waves = entry.wavelengths
        return InfraredReading(
            indicated=entry.indicated,
            emissivity=float(entry.emissivity or 1.0),
            surroundings=float(entry.surroundings or ROOM),
            transmission=entry.transmission or 1.0,
            path=entry.window_temperature or ROOM,
            band=None if waves is None else (waves[0], waves[1]),
            u_indicated=entry.indicated_uncertainty,
            u_emissivity=entry.emissivity_uncertainty or 0.0,
        )
    return ThermocoupleReading(
        indicated=entry.indicated,
        flux=entry.flux or 0.0,
        depth=entry.depth or 0.0,
        conductivity=material.thermal_conductivity,
        u_indicated=entry.indicated_uncertainty,
        u_flux=entry.flux_uncertainty or 0.0,
        u_depth=entry.depth_uncertainty or 0.0,
    )
