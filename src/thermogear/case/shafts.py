"""From the tables of a case file to its drive train.

What is impossible comes back under the field of the file it came from.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any, TypeVar

from thermogear.base.errors import InputError
from thermogear.base.materials import Material
from thermogear.case.build import named_material
from thermogear.case.schema import GearFile
from thermogear.case.shaft_plan import GRAVITY, LOSS_TIME, RINGS, BearingPlan, TrainPlan, section_at
from thermogear.case.shaft_schema import BearingTable, DiscTable, ShaftTable, TrainTable
from thermogear.gears.pair import GearPair
from thermogear.shafts.bearings.catalogue import catalogue_bearing
from thermogear.shafts.bearings.clearance import Fit, class_clearance
from thermogear.shafts.bearings.friction import has_skf
from thermogear.shafts.bearings.geometry import RollingBearing
from thermogear.shafts.bearings.laws import LinearLaw, RingLaw
from thermogear.shafts.drive_ends import InductionMotor
from thermogear.shafts.train import (
    SHAFTS,
    Casing,
    Damping,
    Disc,
    DriveEnd,
    GearBody,
    RunOut,
    Seat,
    Section,
    Shaft,
    Unbalance,
)

_Made = TypeVar("_Made")


def train_plan(
    file: GearFile, pair: GearPair, known: Mapping[str, Material], inertias: tuple[float, float]
) -> TrainPlan | None:
    """The drive train that a file draws; None where it draws none.

    ``inertias`` [kg m^2] of the gears, used where the file gives them outright.
    """
    if not file.shafts:
        for name in ("bearings", "discs", "motor", "load", "train"):
            if getattr(file, name):
                raise InputError(
                    name,
                    "one without shafts",
                    fix='add [[shafts]] with gear = "pinion" and "wheel"',
                )
        return None
    shafts = _shafts(file, pair, known)
    force = max(file.operating.torque) / pair.pinion.base_radius
    table = file.train or TrainTable()
    if table.cage_slip and table.cages == "standing":
        raise InputError(
            "train.cage_slip",
            f"{table.cage_slip:g} of cages that stand",
            allowed="0",
            fix='write cages = "turning", or leave the slip out',
        )
    bearings = _bearings(file, shafts, known, pair)
    given = inertias if file.inertia.model == "given" else (None, None)
    gears = (pair.pinion, pair.wheel)
    bodies = tuple(
        _body(gear, section_at(shaft, shaft.gear_position).outer_diameter, polar)
        for gear, shaft, polar in zip(gears, shafts, given, strict=True)
    )
    casing = None
    if file.housing.mass is not None and file.housing.mount_stiffness is not None:
        springs = file.housing.mount_stiffness
        casing = Casing(
            mass=file.housing.mass,
            stiffness=(springs[0], springs[-1]),
            damping=file.housing.mount_damping,
        )
    drawn = {one.gear: one for one in file.shafts}
    places = dict(zip(SHAFTS, shafts, strict=True))
    return TrainPlan(
        shafts=shafts,
        gears=(bodies[0], bodies[1]),
        bearings=bearings,
        discs=tuple(_disc(n, one, places, known) for n, one in enumerate(file.discs)),
        motor=None if file.motor is None else _end("motor", file.motor, places["pinion"], 0.0),
        load=None
        if file.load is None
        else _end("load", file.load, places["wheel"], places["wheel"].length),
        casing=casing,
        unbalances=tuple(
            Unbalance(
                shaft=name,
                position=places[name].gear_position,
                moment=one.unbalance,
                angle=one.unbalance_angle,
            )
            for name, one in drawn.items()
            if one.unbalance > 0.0
        ),
        run_outs=tuple(
            RunOut(shaft=name, eccentricity=one.eccentricity, angle=one.eccentricity_angle)
            for name, one in drawn.items()
            if one.eccentricity > 0.0
        ),
        damping=Damping(
            kind=table.damping,
            shafts=table.shaft_damping,
            mass=table.mass_damping,
            ratio=table.modal_ratio,
            mesh=file.dynamics.damping_ratio,
        ),
        centre_line=table.centre_line,
        sense=1 if table.sense == "counter-clockwise" else -1,
        gravity=GRAVITY if table.gravity else 0.0,
        least_elements=table.elements,
        cage_slip=table.cage_slip if table.cages == "turning" else 1.0,
        nominal_force=force,
        reference=file.temperatures.reference,
    )


def _shafts(file: GearFile, pair: GearPair, known: Mapping[str, Material]) -> tuple[Shaft, Shaft]:
    names = [one.gear for one in file.shafts]
    for name in SHAFTS:
        if names.count(name) != 1:
            raise InputError(
                "shafts",
                f"{names.count(name) or 'no'} shaft{'s' * (names.count(name) > 1)} of the {name}",
                allowed="one of the pinion, one of the wheel",
                fix=f'write one [[shafts]] with gear = "{name}"',
            )
    order = [names.index(name) for name in SHAFTS]
    made = [_shaft(f"shafts[{n}]", file.shafts[n], pair, known) for n in order]
    for place, one in enumerate(made):
        _apart(f"shafts[{order[place]}]", place, one, made[1 - place], pair)
    return made[0], made[1]


def _apart(field: str, place: int, shaft: Shaft, other: Shaft, pair: GearPair) -> None:
    """Refuse a shaft that runs into the other gear or the other shaft; gears lie in z = 0."""
    gear = (pair.wheel, pair.pinion)[place]
    half = 0.5 * gear.face_width
    bodies = [(-half, half, gear.tip_radius, f"tip circle of the {SHAFTS[1 - place]}")]
    thick = [(a, b, r, f"shaft of the {SHAFTS[1 - place]}") for a, b, r in _pieces(other)]
    for start, end, radius in _pieces(shaft):
        for first, last, reach, called in (*bodies, *(one for one in thick if one[2] <= radius)):
            within = min(end, last) - max(start, first) > 1e-9
            if within and radius + reach >= pair.centre_distance:
                raise InputError(
                    field,
                    f"{2e3 * radius:.6g} mm thick beside the {called}",
                    allowed=f"< {2e3 * (pair.centre_distance - reach):.6g} mm there",
                    why=f"the axes are {1e3 * pair.centre_distance:.6g} mm apart",
                    fix="take a thinner shaft",
                )


def _pieces(shaft: Shaft) -> list[tuple[float, float, float]]:
    """(from, to, radius) of every section [m], from the middle of the gear's face."""
    found, start = [], -shaft.gear_position
    for one in shaft.sections:
        found.append((start, start + one.length, 0.5 * one.outer_diameter))
        start += one.length
    return found


def _shaft(at: str, table: ShaftTable, pair: GearPair, known: Mapping[str, Material]) -> Shaft:
    gear = pair.pinion if table.gear == "pinion" else pair.wheel
    sections = tuple(
        Section(
            length=one.length,
            outer_diameter=one.diameter,
            inner_diameter=one.inner_diameter,
            material=named_material(
                one.material or table.material,
                f"{at}.sections[{n}].material" if one.material else f"{at}.material",
                known,
            ),
        )
        for n, one in enumerate(table.pieces)
    )
    total = sum(one.length for one in sections)
    place = 0.5 * total if table.gear_position is None else table.gear_position
    _on_shaft(f"{at}.gear_position", place, total, table.gear)
    found = Shaft(sections=sections, gear_position=place)
    under = section_at(found, place).outer_diameter
    if under > 2.0 * gear.root_radius * (1.0 + 1e-12):
        raise InputError(
            f"{at}.diameter" if table.diameter else f"{at}.sections",
            f"{1e3 * under:.6g} mm under the gear",
            allowed=f"<= {2e3 * gear.root_radius:.6g} mm, the root circle of the {table.gear}",
            fix="take a thinner shaft, or more teeth",
        )
    return found


def _on_shaft(field: str, place: float, total: float, shaft: str) -> None:
    if not 0.0 <= place <= total * (1.0 + 1e-12):
        raise InputError(
            field,
            f"{1e3 * place:.6g} mm",
            allowed=f"0..{1e3 * total:.6g} mm, along the {shaft}'s shaft",
            fix="positions count from the shaft's left end",
        )


def _beside_the_gear(one: BearingPlan, shaft: Shaft, pair: GearPair) -> None:
    """Refuse a bearing in the middle of which the gear sits."""
    face = pair.pinion.face_width if one.shaft == SHAFTS[0] else pair.wheel.face_width
    if abs(one.position - shaft.gear_position) <= 0.5 * face:
        ends = [1e3 * (shaft.gear_position + side * 0.5 * face) for side in (-1.0, 1.0)]
        field = one.field if one.field.startswith("shafts") else f"{one.field}.position"
        raise InputError(
            field,
            f"a bearing at {1e3 * one.position:.6g} mm",
            allowed=f"beyond the {one.shaft}'s face, {ends[0]:.6g} to {ends[1]:.6g} mm",
            fix="move the bearing, or the gear by gear_position",
        )


def _bearings(
    file: GearFile, shafts: Sequence[Shaft], known: Mapping[str, Material], pair: GearPair
) -> tuple[BearingPlan, ...]:
    if not file.bearings:
        raise InputError(
            "bearings",
            "nothing",
            why="shafts without bearings fall",
            fix='write bearings = "6205" in each of [[shafts]], or [[bearings]]',
        )
    found: list[BearingPlan] = []
    ends = [f"shafts[{n}].bearings" for n, one in enumerate(file.shafts) if one.bearings]
    fields = [f"bearings[{n}]" for n in range(len(file.bearings) - 2 * len(ends))]
    fields += [field for field in ends for _ in range(2)]
    for number, (at, table) in enumerate(zip(fields, file.bearings, strict=True)):
        shaft = shafts[SHAFTS.index(table.shaft)]
        found.append(_bearing(at, number, table, shaft, file, known))
    for name in SHAFTS:
        mine = sorted((b for b in found if b.shaft == name), key=lambda b: b.position)
        if len(mine) < 2:
            raise InputError(
                "bearings",
                f"{len(mine) or 'no'} bearing{'s' * (len(mine) != 1)} on the {name}'s shaft",
                allowed="two or more",
                why="the shaft could tilt freely",
                fix="add a bearing",
            )
        for first, second in pairwise(mine):
            if second.position - first.position < 1e-6:
                written = [one.field for one in (second, first) if not one.field.startswith("sh")]
                raise InputError(
                    f"{written[0]}.position",
                    f"{1e3 * second.position:.6g} mm",
                    allowed="another place than the other bearings'",
                    fix="join both in one bearing, or move one",
                )
    for one in found:
        _beside_the_gear(one, shafts[SHAFTS.index(one.shaft)], pair)
    named = [one.name for one in found]
    for one in found:
        if named.count(one.name) > 1:
            raise InputError(f"{one.field}.name", repr(one.name), allowed="each name once")
    return tuple(found)


def _bearing(
    at: str,
    number: int,
    table: BearingTable,
    shaft: Shaft,
    file: GearFile,
    known: Mapping[str, Material],
) -> BearingPlan:
    rolling, play = None, 0.0
    law: RingLaw | LinearLaw | None = None
    if table.type is not None or table.inside is not None:
        rolling = _under(at, lambda: _rolling(table), alone=at.startswith("shafts"))
        play = _under(at, lambda: _play(table, rolling))
    elif table.ring is not None:
        ring = table.ring
        law = RingLaw(
            coefficient=ring.load / ring.deflection**ring.exponent,
            exponent=ring.exponent,
            clearance=0.5 * ring.play,
        )
    else:
        assert table.stiffness is not None
        kx, ky = table.stiffness[0], table.stiffness[-1]
        cross = table.cross_stiffness or 0.0
        law = _under(at, lambda: LinearLaw(stiffness_matrix=((kx, cross), (cross, ky))))
    half = 0.0 if rolling is None else 0.5 * rolling.width
    if table.end is not None and 2.0 * half >= shaft.length:
        raise InputError(
            at if at.startswith("shafts") else f"{at}.end",
            f"a bearing {2e3 * half:.6g} mm wide on a shaft of {1e3 * shaft.length:.6g} mm",
            allowed="a bearing narrower than its shaft is long",
            fix="give a longer shaft",
        )
    place = {"left": half, "right": shaft.length - half}.get(table.end or "", table.position)
    assert place is not None
    _on_shaft(f"{at}.position", place, shaft.length, table.shaft)
    under = section_at(shaft, place)
    fit = None
    if rolling is not None:
        housing = named_material(file.housing.material, "housing.material", known)
        bore = min(under.inner_diameter, 0.95 * rolling.bore)
        fit = Fit(
            ring=RINGS,
            shaft=under.material,
            housing=housing,
            shaft_interference=table.shaft_interference,
            housing_interference=table.housing_interference,
            shaft_bore=bore,
        )
    skf = rolling is not None and has_skf(rolling)
    friction = table.friction or ("skf" if skf else "palmgren")
    if friction == "skf" and not skf:
        raise InputError(
            f"{at}.friction",
            "skf",
            allowed="deep groove ball bearings of the series 60, 62 and 63 by type",
            fix='write friction = "palmgren"',
        )
    return BearingPlan(
        name=table.name or _called(number, table, file),
        shaft=table.shaft,
        position=place,
        field=at,
        rolling=rolling,
        play=play,
        fit=fit,
        law=law,
        damping=table.damping,
        seat=_seat(at, table, rolling),
        seat_conductance=table.seat_conductance,
        lubrication=table.lubrication,
        friction=friction,
        given=(table.inner_temperature, table.outer_temperature),
    )


def _called(number: int, table: BearingTable, file: GearFile) -> str:
    """ "pinion left" and "pinion right" at the ends, else the shaft and a number."""
    if table.end is not None:
        return f"{table.shaft} {table.end}"
    mine = [n for n, one in enumerate(file.bearings) if one.shaft == table.shaft]
    return f"{table.shaft} {1 + mine.index(number)}"


def _rolling(table: BearingTable) -> RollingBearing:
    if table.inside is None:
        return catalogue_bearing(str(table.type))
    try:
        return RollingBearing(**table.inside.model_dump())
    except InputError as error:
        raise error.named(f"inside.{error.field}") from error


def _play(table: BearingTable, rolling: RollingBearing) -> float:
    if table.play is not None:
        return table.play
    return 0.5 * sum(class_clearance(rolling.kind, rolling.bore, table.clearance_class or "CN"))


def _seat(at: str, table: BearingTable, rolling: RollingBearing | None) -> Seat | None:
    springs = table.seat_stiffness
    if springs is None:
        for name in ("seat_mass", "seat_damping"):
            if getattr(table, name) is not None:
                raise InputError(
                    f"{at}.{name}", "one without seat_stiffness", fix="give seat_stiffness too"
                )
        return None
    mass = table.seat_mass
    if mass is None:
        if rolling is None:
            raise InputError(
                f"{at}.seat_mass", "nothing", why="a seat that gives has a mass", fix="write it"
            )
        mass = rolling.outer_ring_mass
    damping = LOSS_TIME * sum(springs) / len(springs)
    return Seat(
        mass=mass,
        stiffness=(springs[0], springs[-1]),
        damping=damping if table.seat_damping is None else table.seat_damping,
    )


def _body(gear: Any, shaft_diameter: float, polar: float | None) -> GearBody:
    """The gear as a ring from its shaft to the pitch circle; ``polar`` where it is given."""
    inner, outer, width = 0.5 * shaft_diameter, gear.pitch_radius, gear.face_width
    mass = gear.material.density * math.pi * (outer**2 - inner**2) * width
    ring = 0.5 * mass * (outer**2 + inner**2)
    found = ring if polar is None else polar
    return GearBody(
        mass=mass, polar_inertia=found, diametral_inertia=0.5 * found + mass * width**2 / 12.0
    )


def _disc(
    number: int, table: DiscTable, shafts: Mapping[str, Shaft], known: Mapping[str, Material]
) -> Disc:
    at = f"discs[{number}]"
    _on_shaft(f"{at}.position", table.position, shafts[table.shaft].length, table.shaft)
    if table.mass is not None:
        mass, polar, diametral = table.mass, table.polar_inertia, table.diametral_inertia
    else:
        made = named_material(table.material, f"{at}.material", known)
        outer, width = 0.5 * (table.outer_diameter or 0.0), table.width or 0.0
        inner = 0.5 * table.inner_diameter
        mass = made.density * math.pi * (outer**2 - inner**2) * width
        polar = 0.5 * mass * (outer**2 + inner**2)
        diametral = 0.5 * polar + mass * width**2 / 12.0
    assert polar is not None
    assert diametral is not None
    return Disc(
        shaft=table.shaft,
        position=table.position,
        mass=mass,
        polar_inertia=polar,
        diametral_inertia=diametral,
        name=table.name,
    )


def _end(name: str, table: Any, shaft: Shaft, left_out: float) -> DriveEnd:
    place = left_out if table.position is None else table.position
    _on_shaft(f"{name}.position", place, shaft.length, "pinion" if name == "motor" else "wheel")
    slip, lag = getattr(table, "slip_damping", 0.0), getattr(table, "lag", 0.0)
    plate = getattr(table, "plate", None)
    if plate is not None:
        motor = _under("motor.plate", lambda: InductionMotor(**plate.model_dump()))
        slip, lag = motor.slip_damping, motor.lag
    return DriveEnd(
        position=place,
        inertia=table.inertia,
        stiffness=table.coupling_stiffness,
        damping=table.coupling_damping,
        slip_damping=slip,
        lag=lag,
    )


def _under(prefix: str, make: Callable[[], _Made], *, alone: bool = False) -> _Made:
    """What ``make`` makes; its complaints speak of the table of the file, or of it ``alone``."""
    try:
        return make()
    except InputError as error:
        raise error.named(prefix if alone else f"{prefix}.{error.field}") from error
