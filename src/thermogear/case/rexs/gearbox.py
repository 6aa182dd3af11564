"""How the components of a model belong together: gears of a stage, shafts of gears, loads."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from thermogear.base.errors import InputError
from thermogear.case.rexs.model import Component, Model

GEARS = ("cylindrical_gear", "ring_gear")
_TOOL = "rack_shaped_tool"
_SWITCHED = "switchable_coupling"
_JOINS = ("coupling", "connection", "fit", "spline", "feather_key")
"""Parts of the type names of what turns two shafts alike."""


@dataclass(frozen=True)
class Stage:
    """A cylindrical stage: ``number`` counts from 1 in the file's order.

    ``why`` says in one line that no case can come of it.
    """

    number: int
    component: Component
    gears: tuple[Component, ...]
    why: InputError | None = None

    @property
    def field(self) -> str:
        """How messages call it."""
        return f"stage {self.number}"


def stages(model: Model) -> list[Stage]:
    """The cylindrical stages in the file's order, with their gears or what they lack."""
    meshes = {
        relation.role("stage"): (relation.role("gear_1"), relation.role("gear_2"))
        for relation in model.related("stage")
    }
    carried = _planetary(model)
    found_stages = []
    for number, component in enumerate(model.of_type("cylindrical_stage"), start=1):
        ids = meshes.get(component.id, (None, None))
        gears = tuple(one for one in (model.at(i) for i in ids) if one is not None)
        found_stages.append(
            Stage(number, component, gears, _lacking(number, gears, component.id in carried))
        )
    return found_stages


def _lacking(number: int, gears: tuple[Component, ...], carried: bool) -> InputError | None:
    field = f"stage {number}"
    if len(gears) < 2:
        count = "no gear" if not gears else "one gear"
        return InputError(
            f"{field}.gears",
            count,
            allowed="gear_1 and gear_2",
            why="its relation 'stage' names no two gears of the file",
        )
    if gears[0].id == gears[1].id:
        return InputError(f"{field}.gears", "one gear twice", allowed="two gears")
    for gear in gears:
        if gear.type == "ring_gear":
            return internal(f"{field}.{gear.type} {gear.id}", "a ring gear")
        if gear.type not in GEARS:
            return InputError(
                f"{field}.gears", gear.called, allowed="cylindrical gears", why="no spur gear"
            )
    if carried:
        return InputError(
            field,
            "a stage of a planetary gear",
            allowed="gears on fixed axes",
            why="its axes turn with the carrier",
            fix="take another stage",
        )
    return None


def internal(field: str, got: str) -> InputError:
    """What is said of a ring gear."""
    return InputError(
        field,
        got,
        allowed="two external gears",
        why="internal gears are not computed",
        fix="take another stage",
    )


def assembled(model: Model) -> Iterator[tuple[Component, Component]]:
    """(whole, part) of every assembly."""
    for relation in model.related("assembly", "ordered_assembly"):
        whole = model.at(relation.role("assembly"))
        parts = [model.at(ident) for role, ident in relation.refs if role == "part"]
        if whole is not None:
            yield from ((whole, part) for part in parts if part is not None)


def _planetary(model: Model) -> set[int]:
    """Cylindrical stages that are parts of planetary ones."""
    return {part.id for whole, part in assembled(model) if whole.type == "planetary_stage"}


def planetary_shafts(model: Model) -> set[int]:
    """Shafts that a planetary stage or its carrier may turn."""
    carried, of_gear = _planetary(model), shafts_of_gears(model)
    held = model.related("central_shaft", "planet_shaft", "planet_carrier_shaft")
    found = {ident for relation in held for role, ident in relation.refs if role == "shaft"}
    for relation in model.related("stage"):
        if relation.role("stage") in carried:
            gears = (relation.role("gear_1"), relation.role("gear_2"))
            found.update(of_gear[one] for one in gears if one in of_gear)
    found |= {part.id for whole, part in assembled(model) if whole.type == "planet_carrier"}
    return found & {one.id for one in model.of_type("shaft")}


def meshes(model: Model) -> Iterator[tuple[Component, Component, Component]]:
    """(stage, gear_1, gear_2) of every stage on fixed axes, of whatever type."""
    carried = _planetary(model)
    for relation in model.related("stage"):
        stage = model.at(relation.role("stage"))
        first, second = model.at(relation.role("gear_1")), model.at(relation.role("gear_2"))
        if stage and first and second and stage.id not in carried:
            yield stage, first, second


def shafts_of_gears(model: Model) -> dict[int, int]:
    """Gear -> shaft it turns with: by assembly, or over a shaft-hub connection."""
    found = {part.id: whole.id for whole, part in assembled(model) if whole.type == "shaft"}
    for inner, outer, by in sides(model):
        if not _turns(by):
            continue
        for mine, other in ((inner, outer), (outer, inner)):
            if mine.type == "shaft" and other.type.endswith(("gear", "wheel")):
                found.setdefault(other.id, mine.id)
    return found


def joined_shafts(model: Model) -> list[tuple[int, int]]:
    """Pairs of shafts that a connection always turns alike."""
    return [
        (inner.id, outer.id)
        for inner, outer, by in sides(model)
        if inner.type == outer.type == "shaft" and _turns(by)
    ]


def switched_shafts(model: Model) -> list[tuple[int, int, Component]]:
    """Pairs of shafts that turn alike while a coupling between them is engaged."""
    return [
        (inner.id, outer.id, by)
        for inner, outer, by in sides(model)
        if inner.type == outer.type == "shaft" and by.type == _SWITCHED
    ]


def _turns(by: Component) -> bool:
    """Whether what is between two parts turns both alike: no bearing, no switched coupling."""
    return by.type != _SWITCHED and any(part in by.type for part in _JOINS)


def sides(model: Model) -> Iterator[tuple[Component, Component, Component]]:
    """(inner part, outer part, what is between them); "coupling" is REXS 1.0."""
    for relation in model.related("side", "coupling"):
        by = model.at(relation.role("assembly"))
        inner = model.at(relation.role("inner_part", "side_1"))
        outer = model.at(relation.role("outer_part", "side_2"))
        if by and inner and outer:
            yield inner, outer, by


def loads_of_shafts(model: Model) -> dict[int, list[Component]]:
    """Shaft -> its external loads."""
    found: dict[int, list[Component]] = {}
    for whole, part in assembled(model):
        if whole.type == "shaft" and part.type == "external_load":
            found.setdefault(whole.id, []).append(part)
    return found


def flanks_of(model: Model, gear: Component) -> dict[str, Component]:
    """ "left" and "right" flank of a gear, as far as the file has them."""
    return {
        side: flank
        for relation in model.related("flank")
        if relation.role("gear") == gear.id
        for side in ("left", "right")
        if (flank := model.at(relation.role(side))) is not None
    }


def tool_of(model: Model, gear: Component, flanks: dict[str, Component]) -> Component | None:
    """The rack-shaped tool that cuts a gear: that of the first step, which cuts the root."""
    workpieces = {gear.id, *(flank.id for flank in flanks.values())}
    steps = model.related("manufacturing_step")
    tools = [model.at(one.role("tool")) for one in steps if one.role("workpiece") in workpieces]
    for ident in workpieces:
        tools += model.referenced(ident, _TOOL)
    return next((one for one in tools if one is not None and one.type == _TOOL), None)


def settings_of(
    model: Model, gear: Component, flanks: dict[str, Component]
) -> tuple[Component, ...]:
    """Where the generated profile shift may be: settings of the steps, flanks, the gear."""
    workpieces = {gear.id, *(flank.id for flank in flanks.values())}
    found = [
        settings
        for relation in model.related("manufacturing_step")
        if relation.role("workpiece") in workpieces
        and (settings := model.at(relation.role("manufacturing_settings"))) is not None
    ]
    return (*found, *flanks.values(), gear)


def lubricant_of(model: Model, stage: Component) -> Component | None:
    """The oil of a stage, else of the casing, else the only one."""
    holders, oils = (stage, *model.of_type("gear_casing")), model.of_type("lubricant")
    found = [oil for one in holders for oil in model.referenced(one.id, "lubricant")]
    return next(iter(found or (oils if len(oils) == 1 else [])), None)


def gear_data_of(model: Model, stage: Component, gear: Component) -> Component | None:
    """What a stage says of one of its gears."""
    both = (stage.id, gear.id)
    return next(
        (
            model.at(one.role("stage_gear_data"))
            for one in model.related("stage_gear_data")
            if (one.role("stage"), one.role("gear")) == both
        ),
        None,
    )


def parts_of(model: Model, stage: Stage) -> list[Component]:
    """The components that a stage takes its case from, but shafts, loads and casing."""
    parts = [stage.component, lubricant_of(model, stage.component)]
    for gear in stage.gears:
        flanks = flanks_of(model, gear)
        parts += [gear, tool_of(model, gear, flanks), gear_data_of(model, stage.component, gear)]
        parts += [*settings_of(model, gear, flanks), *model.referenced(gear.id, "material")[:1]]
        for flank in flanks.values():
            parts += model.referenced(flank.id, "tip_relief", "root_relief")
    return [part for part in parts if part is not None]
