"""The parts of a gear case, each made from the tables of the file that describe it.

What the floors below find impossible comes back under the field of the file it came from.
"""

from __future__ import annotations

import cmath
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base import materials
from thermogear.base.errors import InputError, ValidityWarning, nearest, short
from thermogear.base.excitation import Periodic
from thermogear.base.materials import MATERIALS, Lubricant, Material
from thermogear.base.toml import held
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.backlash import (
    Backlash,
    from_tolerances,
    from_value,
    normal_half,
    recommended,
    require_room,
)
from thermogear.case.fields import BODY
from thermogear.case.schema import GearFile, GearTable
from thermogear.case.units import rounding, shown
from thermogear.gears.geometry import LEFT_OUT, Gear, Rack
from thermogear.gears.pair import GearPair, tight_distance
from thermogear.heat.friction import LAWS, ROUGHNESS_LIMIT
from thermogear.heat.law_parameters import parameters, with_parameters
from thermogear.mesh.excite import disc_inertia
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Temperatures

_Made = TypeVar("_Made")

BORE = 0.3
"""A bore that is not given, over the root circle (usual, unconfirmed)."""


@dataclass(frozen=True)
class Follows:
    """A temperature [K] given outright, or as ``value`` kelvins below an addendum's."""

    value: ArrayLike
    below: bool

    def at(self, addendum: ArrayLike) -> ArrayLike:
        """The temperature [K] belonging to an ``addendum`` [K]; numbers, or one for each point."""
        return np.subtract(addendum, self.value) if self.below else self.value

    def checked(self, addendum: ArrayLike, field: str) -> ArrayLike:
        """The same, refused under the name of its ``field`` where no such body may be."""
        temperature = self.at(addendum)
        if not self.below:
            return temperature
        every = np.ravel(temperature)
        for place in {int(every.argmin()), int(every.argmax())}:
            tip, drop = (
                float(np.broadcast_to(np.ravel(one), every.shape)[place])
                for one in (addendum, self.value)
            )
            try:
                BODY.within(float(every[place]))
            except InputError as error:
                raise InputError(
                    f"{field}_below_addendum",
                    f"{drop:.6g} K below {shown(tip, 'temperature')} = {error.got}",
                    allowed=error.allowed,
                ) from error
        return temperature


@dataclass(frozen=True)
class TemperatureRule:
    """How bores, housing and oil go along with the addendum temperatures.

    Housing and oil follow the pinion's addendum where they follow at all.
    """

    reference: float
    pinion_bore: Follows
    wheel_bore: Follows
    housing: Follows
    oil: Follows

    def at(self, *, pinion_addendum: ArrayLike, wheel_addendum: ArrayLike) -> Temperatures:
        """All body temperatures that belong to the two addenda [K]."""
        return Temperatures(
            reference=self.reference,
            pinion_addendum=pinion_addendum,
            pinion_bore=self.pinion_bore.checked(pinion_addendum, "temperatures.pinion_bore"),
            wheel_addendum=wheel_addendum,
            wheel_bore=self.wheel_bore.checked(wheel_addendum, "temperatures.wheel_bore"),
            housing=self.housing.checked(pinion_addendum, "temperatures.housing"),
        )

    def oil_at(self, pinion_addendum: ArrayLike) -> ArrayLike:
        """The oil's temperature [K] that belongs to the pinion's addendum [K]."""
        return self.oil.checked(pinion_addendum, "oil.temperature")


def own_materials(file: GearFile) -> dict[str, Material]:
    """The materials that the file describes itself."""
    return {
        name: _under(
            f"materials.{name}",
            partial(Material, name=name, **table.model_dump(exclude_none=True)),
        )
        for name, table in file.materials.items()
    }


def named_material(name: str, at: str, known: Mapping[str, _Made]) -> _Made:
    """The material of the field ``at``, or an error that says the nearest name."""
    meant = materials.spelled(name, known)
    if meant is None:
        raise InputError(
            at,
            short(name),
            allowed=" | ".join(known),
            fix=f"{nearest(name, known)} Or describe it in [materials.{name}]"
            if name.isidentifier()
            else nearest(name, known),
        )
    return known[meant]


def unknown_names(data: Mapping[str, Any]) -> list[InputError]:
    """Materials and oils of a file's bare tables that nobody knows."""
    own = data.get("materials")
    known = {**MATERIALS, **(own if isinstance(own, dict) else {})}
    found = []
    for path in ("gears.pinion.material", "gears.wheel.material", "housing.material", "oil.name"):
        depth, entry = held(data, path)
        if depth < len(path.split(".")) or not isinstance(entry, str):
            continue
        try:
            if path != "oil.name":
                named_material(entry, path, known)
            elif "viscosity_40" not in data["oil"]:
                named_oil(entry)
        except InputError as error:
            found.append(error)
    return found


def _under(prefix: str, make: Callable[[], _Made], *, own_rack: bool = False) -> _Made:
    """What ``make`` makes; its complaints speak of the field of the file."""
    try:
        return make()
    except InputError as error:
        inner, got = error.field, error.got
        for start in ("material.", "lubricant."):
            inner = inner.removeprefix(start)
        common = inner in ("module", "pressure_angle") or (
            inner.startswith("rack.") and not own_rack
        )
        where = f"{'gears' if common else prefix}.{inner}"
        if inner.endswith("tip_radius"):
            where = where.removesuffix("tip_radius") + "tip_diameter"
            got = f"a radius of {got}"
        raise type(error)(
            where, got, allowed=error.allowed, why=error.why, fix=error.fix
        ) from error


def _gear(table: GearTable, file: GearFile, prefix: str, known: Mapping[str, Material]) -> Gear:
    gears = file.gears
    tip = LEFT_OUT if table.tip_diameter is None else 0.5 * table.tip_diameter
    other = gears.wheel if table is gears.pinion else gears.pinion
    widths = (table.face_width, gears.face_width, other.face_width)
    width = next((one for one in widths if one is not None), LEFT_OUT)
    material = named_material(table.material, f"{prefix}.material", known)
    # a rack left out is the gear's own to choose, with a fillet that fits its pressure angle
    cut = table.rack or gears.rack
    rack: dict[str, Any] = {} if cut is None else {"rack": Rack(**cut.model_dump())}
    drawn = partial(
        Gear,
        teeth=table.teeth,
        module=gears.module,
        pressure_angle=gears.pressure_angle,
        profile_shift=table.profile_shift,
        face_width=width,
        tip_radius=tip,
        tip_rounding=table.tip_rounding,
        tip_chamfer=table.tip_chamfer,
        material=material,
        roughness=table.roughness,
        allow_undercut=table.allow_undercut,
        **rack,
    )
    bore = table.bore_radius
    if bore is None:
        bore = BORE * _under(prefix, drawn, own_rack=table.rack is not None).root_radius
    return _under(prefix, partial(drawn, bore_radius=bore), own_rack=table.rack is not None)


def faults(file: GearFile) -> list[InputError]:
    """What is impossible in parts of the file that do not rest on each other."""
    known = MATERIALS | own_materials(file)
    checks: tuple[Callable[[], object], ...] = (
        partial(_gear, file.gears.pinion, file, "gears.pinion", known),
        partial(_gear, file.gears.wheel, file, "gears.wheel", known),
        partial(named_material, file.housing.material, "housing.material", known),
        partial(lubricant, file),
    )
    found = []
    with warnings.catch_warnings(action="ignore", category=ValidityWarning):
        for check in checks:
            try:
                check()
            except InputError as error:
                found.append(error)
    return found


def pair_of(file: GearFile, known: Mapping[str, Material], data: Mapping[str, Any]) -> GearPair:
    """The two gears and their centre distance.

    One that misses the mesh without backlash by no more than half a unit of its last digit in
    ``data``, the bare tables, is taken as that, as long as the tips clear the roots at it: nearer,
    no rounding makes it a distance of these gears.
    """
    distance = file.gears.centre_distance
    pinion = _gear(file.gears.pinion, file, "gears.pinion", known)
    wheel = _gear(file.gears.wheel, file, "gears.wheel", known)
    if distance is not None:
        slack = rounding(data["gears"]["centre_distance"], "length")
        tight = tight_distance(pinion, wheel)
        near = 0.0 < tight - distance <= slack * (1.0 + 1e-9)
        hit = max(pinion.tip_radius + wheel.root_radius, wheel.tip_radius + pinion.root_radius)
        distance = tight if near and distance > hit else distance
    try:
        return _under(
            "gears", lambda: GearPair(pinion, wheel, LEFT_OUT if distance is None else distance)
        )
    except InputError as error:
        if distance is None or not error.field.endswith("contact_ratio"):
            raise
        raise type(error)(
            "gears.centre_distance",
            f"{shown(distance, 'length')}, a contact ratio of {error.got}",
            allowed=f"a contact ratio {error.allowed}",
            why="the gears stand too far apart for their teeth",
            fix="leave it out for the mesh without backlash, or shift the profiles",
        ) from error


def temperature_rule(file: GearFile) -> TemperatureRule | None:
    """How bores, housing and oil go along with the addenda; None where those are computed."""
    table = file.temperatures
    if table.pinion_addendum is None or table.wheel_addendum is None:
        return None

    def follows(given: float | None, below: float | None) -> Follows:
        return Follows(below or 0.0, True) if given is None else Follows(given, False)

    return TemperatureRule(
        table.reference,
        follows(table.pinion_bore, table.pinion_bore_below_addendum),
        follows(table.wheel_bore, table.wheel_bore_below_addendum),
        follows(table.housing, table.housing_below_addendum),
        follows(file.oil.temperature, file.oil.temperature_below_addendum),
    )


def named_oil(name: str) -> Lubricant:
    """The oil of that name, or an error that says the nearest."""
    try:
        return materials.lubricant(name)
    except InputError as error:
        own = "give viscosity_40, viscosity_100 and density_15"
        raise InputError(
            "oil.name",
            short(name),
            allowed=" | ".join(materials.LUBRICANTS),
            fix=f"{error.fix}, or {own}",
        ) from error


def lubricant(file: GearFile) -> Lubricant:
    """The named oil, or the one through the two viscosities, with the flash point given."""
    oil = file.oil
    if oil.viscosity_40 is None or oil.viscosity_100 is None:
        return replace(named_oil(oil.name), flash_point=oil.flash_point)
    cold, hot = (
        (ZERO_CELSIUS + 40.0, oil.viscosity_40),
        (ZERO_CELSIUS + 100.0, oil.viscosity_100),
    )
    return _under(
        "oil",
        lambda: replace(
            Lubricant.from_two_points(oil.name, cold, hot, density_15=oil.density_15),
            flash_point=oil.flash_point,
        ),
    )


def cold_backlash(file: GearFile, pair: GearPair, housing: Material) -> Backlash:
    """The cold half backlash out of whatever kind the file gives."""
    table = file.backlash
    if table.tolerances is not None:
        parts = table.tolerances
        found = from_tolerances(
            pinion=parts.pinion_tooth_thickness,
            wheel=parts.wheel_tooth_thickness,
            distance=parts.centre_distance,
            pair=pair,
        )
        require_room("backlash.tolerances", found.most, pair)
        return found
    if table.value is None:
        found = recommended(pair)
        require_room("backlash.value", found.half, pair)
        return found
    kind = (str(table.direction), str(table.extent))
    half = float(normal_half(table.value, *kind, pair))
    require_room("backlash.value", half, pair, of_half=table.value / half)
    rise = 0.0 if table.temperature is None else table.temperature - file.temperatures.reference
    return from_value(table.value, *kind, rise, pair, housing.thermal_expansion)


def inertias(file: GearFile, pair: GearPair) -> tuple[tuple[float, float], str]:
    """Both moments of inertia [kg m^2], and in words what they are."""
    table = file.inertia
    if table.pinion is not None and table.wheel is not None:
        return (table.pinion, table.wheel), "given"
    radius, bored = table.radius or "pitch", bool(table.bored)

    def disc(gear: Gear) -> float:
        outer = gear.pitch_radius if radius == "pitch" else gear.tip_radius
        inner = gear.bore_radius if bored else 0.0
        return disc_inertia(gear, radius=outer, bore_radius=inner)

    words = f"solid discs of {radius} radius, {'bored' if bored else 'unbored'}"
    return (disc(pair.pinion), disc(pair.wheel)), words


def transmission_error(file: GearFile) -> Periodic:
    """The kinematic error e [m] over the mesh phase."""
    given = file.transmission_error
    parts = (
        {}
        if given is None
        else {h.order: cmath.rect(h.amplitude, h.phase) for h in given.harmonics}
    )
    return Periodic(0.0, tuple(parts.get(q, 0j) for q in range(1, max(parts, default=0) + 1)))


def models(file: GearFile, pair: GearPair) -> tuple[MeshModel, ...]:
    """The bundles to compute with, single choices put in their place."""
    choices = file.model.model_dump(exclude_none=True)
    bundle = choices.pop("bundle")
    friction = choices.pop("friction", {})
    law = friction.pop("law", None)
    bundles = {"consistent": MeshModel.consistent(), "thesis": MeshModel.thesis()}
    whole = tuple(bundles.values()) if bundle == "both" else (bundles[bundle],)
    laws = [LAWS[law] if law else model.law for model in whole]
    known = {name for one in laws for name in parameters(one)}
    chosen = []
    for model, one in zip(whole, laws, strict=True):
        # a parameter without a law goes to the bundles whose law has it
        mine = {k: v for k, v in friction.items() if k in parameters(one) or k not in known}
        made = _under("model.friction", partial(with_parameters, one, mine))
        chosen.append(model.override(friction=made, **choices))
    roughness = 0.5 * (pair.pinion.roughness + pair.wheel.roughness)
    if roughness >= ROUGHNESS_LIMIT and any(m.law.name == "benedict-kelley" for m in chosen):
        raise InputError(
            "gears.pinion.roughness",
            f"{1e6 * roughness:.4g} um, the mean of both flanks",
            allowed=f"< {1e6 * ROUGHNESS_LIMIT:.4g} um",
            why="the friction law of Benedict and Kelley ends there",
            fix='use smoother flanks, or model.friction = "lambda-blend"',
        )
    return tuple(chosen)
