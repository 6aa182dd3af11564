"""Materials of the gears and the oil of a stage, out of a REXS model."""

from __future__ import annotations

import re

from thermogear.base import bounds
from thermogear.base.bounds import Bounds
from thermogear.base.errors import InputError, short
from thermogear.base.materials import LUBRICANTS, MATERIALS, Lubricant, lubricant
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import Read, Reader, plain
from thermogear.case.rexs.draft import Draft
from thermogear.case.rexs.drive import Drive
from thermogear.case.rexs.lines import DEFAULT, DERIVED, READ
from thermogear.case.rexs.model import Component

_POISSON = Bounds(low=0.0, high=0.499, unit="", si="")
_VALUES: tuple[tuple[str, str, Bounds, str], ...] = (
    ("youngs_modulus", "elastic_modulus", bounds.YOUNGS_MODULUS, "Pa"),
    ("poisson_ratio", "poisson_ratio", _POISSON, ""),
    ("density", "density", bounds.DENSITY, "kg/m^3"),
    ("thermal_conductivity", "thermal_conductivity", bounds.CONDUCTIVITY, "W/(m K)"),
    ("specific_heat", "thermal_capacity", bounds.SPECIFIC_HEAT, "J/(kg K)"),
    ("thermal_expansion", "thermal_expansion_coefficient_plus", bounds.EXPANSION, "1/K"),
)
"""Field of a material, attribute, what is allowed, unit of the default."""
_HOT = "temperature_lubricant"


def material_lines(reader: Reader, made: Draft) -> None:
    """The material of each gear: its values, those of steel where the file has none."""
    written: dict[int, str] = {}
    for name, gear in made.both:
        one, origin, note = _of(reader, gear)
        if one is None:
            continue
        if one.id not in written:
            label = _label(reader, one, set(written.values()))
            if not _described(reader, made, one, label):
                continue
            written[one.id] = label
        made.put(f"gears.{name}.material", written[one.id], origin, note)


def _of(reader: Reader, gear: Component) -> tuple[Component | None, str, str]:
    """The material of a gear, else that of its shaft; with its origin."""
    own = reader.model.referenced(gear.id, "material")
    if own:
        return own[0], READ, own[0].called
    shaft = gearbox.shafts_of_gears(reader.model).get(gear.id)
    its = [] if shaft is None else reader.model.referenced(shaft, "material")
    if its:
        return its[0], DERIVED, f"{its[0].called} of its shaft; the gear has none of its own"
    return None, "", ""


def _label(reader: Reader, one: Component, taken: set[str]) -> str:
    """A name for a table of the case file, none that the package or another material has."""
    says = reader.words(one, "material_designation") or one.name or f"material {one.id}"
    label = label_of(says) or f"material_{one.id}"
    return f"{label}_{one.id}" if label in taken or label in MATERIALS else label


def label_of(text: str) -> str:
    """A name as that of a table in a case file."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", text).strip("_")[:60]


def _described(reader: Reader, made: Draft, one: Component, label: str) -> bool:
    """Put the table of a material; False where the file says nothing of it."""
    found = {
        field: value
        for field, attribute, allowed, _ in _VALUES
        if (value := reader.number(one, attribute)) is not None
        and _allowed(made, one, attribute, value, allowed)
    }
    if not found:
        made.unused.append(f"{one.called}: no value that is used; the gear is of steel")
        return False
    steel = MATERIALS["steel"]
    for field, attribute, _, unit in _VALUES:
        path = f"materials.{label}.{field}"
        if field in found:
            made.read(path, found[field], attribute)
        else:
            value = getattr(steel, field)
            shown = f"{plain(value)} {unit}" if unit else value
            made.put(path, shown, DEFAULT, f"that of steel; no usable {attribute}")
    return True


def _allowed(made: Draft, one: Component, attribute: str, value: Read, allowed: Bounds) -> bool:
    try:
        allowed.require(f"{one.called}.{attribute}", value.si)
    except InputError as error:
        made.unused.append(str(error))
        return False
    return True


def oil_lines(reader: Reader, made: Draft, drive: Drive) -> None:
    """The oil by its two viscosities, else by its grade; its temperature, of the load with the
    greatest power where the loads have different ones."""
    oil = gearbox.lubricant_of(reader.model, made.stage.component)
    if oil is not None:
        _oil(reader, made, oil)
    cases = sorted(
        zip(drive.loads_of(made.stage), reader.model.load_cases, strict=False),
        key=lambda one: -abs((one[0].speed or 0.0) * (one[0].torque or 0.0)),
    )
    holders = (made.stage.component, *reader.model.of_type("gear_casing"))
    for over in (*(case.components for _, case in cases[:1]), {}):
        for holder in holders:
            found = reader.number(holder, _HOT, over.get(holder.id))
            if found is not None and _allowed(made, holder, _HOT, found, bounds.BODY):
                made.read("oil.temperature", found, f"{_HOT} of {holder.called}")
                return


def _oil(reader: Reader, made: Draft, oil: Component) -> None:
    words = reader.words(oil, "name") or oil.name
    name = "".join(c if c.isprintable() else " " for c in words)[:200]
    cold = reader.number(oil, "viscosity_at_40_degree_celsius")
    hot = reader.number(oil, "viscosity_at_100_degree_celsius")
    density = reader.number(oil, "density_at_15_degree_celsius")
    if density is not None and not _allowed(
        made, oil, "density_at_15_degree_celsius", density, bounds.OIL_DENSITY
    ):
        density = None
    if cold is not None and hot is not None and 1e-6 <= hot.si < cold.si:
        made.put("oil.name", name or f"oil {oil.id}", READ, oil.called)
        made.read("oil.viscosity_40", cold, "viscosity_at_40_degree_celsius")
        made.read("oil.viscosity_100", hot, "viscosity_at_100_degree_celsius")
        if density is not None:
            made.read("oil.density_15", density, "density_at_15_degree_celsius")
            return
        line = Lubricant.from_two_points(
            name, (ZERO_CELSIUS + 40.0, cold.si), (ZERO_CELSIUS + 100.0, hot.si)
        )
        made.put(
            "oil.density_15",
            f"{plain(float(line.density_15))} kg/m^3",
            DERIVED,
            "by its viscosity, ISO/TR 15144-1 eq. 21",
        )
        return
    known = _named(name)
    if known:
        made.put("oil.name", known, DERIVED, f"by the name {short(name)}")
    else:
        made.unused.append(f"{oil.called}: no two viscosities, no name of a known oil")


def _named(name: str) -> str:
    """The name of an oil of the package that a name means; empty where none does."""
    grade = re.search(r"(?:iso)?[\s_-]*vg[\s_-]*(\d+)", name, re.IGNORECASE)
    for one in (name, f"ISO VG {grade[1]}" if grade else ""):
        try:
            lubricant(one)
        except InputError:
            continue
        return one
    return name if name in LUBRICANTS else ""
