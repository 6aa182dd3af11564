"""What a model says of one stage, whatever ids, order, units and spelling it has.

A value is known by its :class:`Key`: the load case that repeats it, the part of the stage, the name
of the attribute. Two models say the same where their values are alike.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, NamedTuple

from thermogear.base.errors import short
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import (
    EARLIER,
    LATER,
    MEANINGS,
    USED,
    Plain,
    Reader,
    from_si,
    spelled,
)
from thermogear.case.rexs.gearbox import Stage
from thermogear.case.rexs.model import Attribute, Component, LoadCase, Model

_ALIKE = 1e-9
"""Relative difference up to which two values are one: what a number loses when it is written in
another unit or with 12 digits."""


class Key(NamedTuple):
    """Where a value is: ``load`` counts the load cases from 1, 0 is the model itself."""

    load: int
    part: str
    name: str

    def called(self, held: dict[str, Component], version: str) -> str:
        """The attribute as messages say it, by the parts ``held`` in a model of a ``version``."""
        load = f"load case {self.load} " if self.load else ""
        part = held[self.part].called if self.part in held else self.part
        return f"{load}{part}.{spelled(self.name, version)}"


Values = dict[Key, Plain]
TITLE = Key(0, "gear_unit", "name")
"""The name of the gear unit is no attribute, but is read."""


def values(reader: Reader, stage: Stage) -> Values:
    """Every value that is read of a stage; what is empty is none."""
    model = reader.model
    held = gearbox.parts_of(model, stage)
    parts = {str(holder.id): part for part, holder in held.items()}
    unit = held.get(TITLE.part)
    read: Values = {TITLE: unit.name} if unit is not None and unit.name else {}
    tables = [{holder.id: holder.attributes for holder in held.values()}]
    for load, table in enumerate([*tables, *(case.components for case in model.load_cases)]):
        for part, holder in held.items():
            for row in table.get(holder.id, {}).values():
                if row.id in USED and row.value not in (None, "", []):
                    value = reader.plain_value(holder, row)
                    if row.id == "reference_component_for_position":
                        value = parts.get(str(row.value).strip(), value)
                    read[Key(load, part, EARLIER.get(row.id, row.id))] = value
    return read


def alike(first: Plain | None, second: Plain | None) -> bool:
    """Whether two values are the same but for the digits that units and printing leave."""
    if isinstance(first, list) and isinstance(second, list):
        return len(first) == len(second) and all(map(alike, first, second))
    if isinstance(first, float) and isinstance(second, float):
        return math.isclose(first, second, rel_tol=_ALIKE, abs_tol=1e-15)
    return first == second


def put_back(model: Model, stage: Stage, old: Values, keys: Iterable[Key]) -> Model:
    """``model`` with the ``old`` values at ``keys``, none where ``old`` has none."""
    held = gearbox.parts_of(model, stage)
    again = replace(
        model,
        components={
            ident: replace(part, attributes=dict(part.attributes))
            for ident, part in model.components.items()
        },
        load_cases=[
            replace(case, components={ident: dict(rows) for ident, rows in case.components.items()})
            for case in model.load_cases
        ],
    )
    for load, part, name in keys:
        while len(again.load_cases) < load:
            again.load(LoadCase(id=len(again.load_cases) + 1, spectrum=1, components={}))
        if part in held:
            table = (
                again.load_cases[load - 1].components.setdefault(held[part].id, {})
                if load
                else again.components[held[part].id].attributes
            )
            for spelling in (name, *LATER.get(name, ())):
                table.pop(spelling, None)
            if (load, part, name) in old:
                value, unit = _written(old[Key(load, part, name)], name, model)
                table[name] = Attribute(name, unit, value)
    return again


def shown(value: Plain | None, key: Key, model: Model) -> str:
    """A value as messages say it, in the unit of the schema."""
    if value is None:
        return "nothing"
    number, unit = _written(value, key.name, model)
    return f"{short(number)} {unit}".removesuffix(" none")


def _written(value: Plain, name: str, model: Model) -> tuple[Any, str]:
    """A value in the unit of the schema, and that unit."""
    means = MEANINGS.get(name)
    if means is None or isinstance(value, str):
        return value, "none"
    if isinstance(value, float):
        return from_si(value, means, model.after)
    return [from_si(item, means, model.after)[0] for item in value], means.unit_in(model.after)
