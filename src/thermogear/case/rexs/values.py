"""What a model says of one stage, whatever ids, order, units and spelling it has.

A value is known by its :class:`Key`: the load case that repeats it, the part of the stage, the name
of the attribute. Two models say the same where their values are alike.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from thermogear.base.errors import short
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import (
    EARLIER,
    MEANINGS,
    USED,
    Plain,
    Reader,
    from_si,
    spelled,
)
from thermogear.case.rexs.gearbox import Stage
from thermogear.case.rexs.model import Component, Model

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


def shown(value: Plain | None, key: Key, model: Model) -> str:
    """A value as messages say it, in the unit of the schema."""
    means = MEANINGS.get(key.name)
    if value is None:
        return "nothing"
    if means is None or isinstance(value, str):
        return short(value)
    items = [from_si(item, means, model.after) for item in np.ravel(value).tolist()]
    numbers = [number for number, _ in items]
    text = f"{short(numbers if isinstance(value, list) else numbers[0])} {items[0][1]}"
    return text.removesuffix(" none")
