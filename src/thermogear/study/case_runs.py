"""A case that is computed again with some of its fields changed by factors."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from thermogear.base.errors import InputError
from thermogear.base.toml import literal, overridden, pairs
from thermogear.case.allowed import gear_parameter
from thermogear.case.base import Case
from thermogear.case.case import GearCase, gear_case, load_case


@dataclass(frozen=True)
class CaseRuns:
    """A case that is run again with some of its fields changed."""

    text: str
    kept: Mapping[str, str]

    @classmethod
    def of(cls, case: Case | str | Path) -> CaseRuns:
        """The case, or that of a file or a text, as it is stated."""
        given = load_case(case) if isinstance(case, str | Path) else case
        return cls(given.text, dict(given.overrides))

    def case(self, changes: Mapping[str, str]) -> GearCase:
        """The case with these overrides."""
        return gear_case(load_case(self.text, {**self.kept, **changes}))

    def changes(self, factors: Mapping[str, float]) -> dict[str, str]:
        """The overrides that multiply every named field by its factor."""
        changes: dict[str, str] = {}
        for name, factor in factors.items():
            changes |= overrides_of(self.text, self.kept, name, factor)
        return changes


def _stated(text: str, changes: Mapping[str, str], name: str) -> str:
    """A field as the case states it, as text."""
    value: Any = overridden(tomllib.loads(text), pairs(changes))
    for part in name.split("."):
        if not isinstance(value, dict) or part not in value:
            raise InputError("tolerances", repr(name), why="the case states no such field")
        value = value[part]
    if not isinstance(value, (str, int, float)) or isinstance(value, bool):
        raise InputError("tolerances", repr(name), why="it is no single number with a unit")
    return str(value)


def scaled(value: str, factor: float) -> str:
    """A number with its unit times a factor: "100 N m" by 1.1 is "110 N m"."""
    found = re.match(r"^\s*([-+]?\d*\.?\d+(?:[eE][-+]?\d+)?)\s*(.*)$", value)
    if not found:
        raise InputError("tolerances", repr(value), why="it is no number with a unit")
    number = float(found.group(1)) * factor
    return f"{number!r} {found.group(2)}".strip()


def overrides_of(text: str, changes: Mapping[str, str], name: str, factor: float) -> dict[str, str]:
    """The overrides that multiply a parameter by a factor, in every field it stands for.

    ``name``: a gear parameter by any of its names, or a dotted field;
    "transmission_error.amplitude" means the amplitudes of all its harmonics.
    """
    if name != "transmission_error.amplitude":
        fields = gear_parameter(name, "tolerances").fields
        return {one: scaled(_stated(text, changes, one), factor) for one in fields}
    field = "transmission_error.harmonics"
    table = overridden(tomllib.loads(text), pairs(changes)).get("transmission_error", {})
    rows = table.get("harmonics", [])
    if not rows:
        raise InputError("parameters", repr(name), why="the case states no transmission error")
    parts = []
    for row in rows:
        grown = {**row, "amplitude": scaled(str(row["amplitude"]), factor)}
        parts.append(grown)
    return {field: literal(parts)}
