"""The values that are ours: declared in the file's table ``[ours]``, or left to a default.

A declared reason holds for the value given with it and for no other: where the case has
another value, whoever edited, overrode or left it out, the entry is silent. A reason without a
value, as older files have them, is left out with a warning.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
from pydantic import BaseModel, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from thermogear.base.display import in_words
from thermogear.base.errors import InputError, ValidityWarning, nearest, printable, short
from thermogear.case.fields import Measure
from thermogear.case.refusals import dotted, table_at

ROUNDING = 1e-12
"""Relative difference that a change of units leaves."""


def same(one: Any, other: Any) -> bool:
    """Whether ``one`` and ``other`` hold the same values; numbers but for the rounding of units.

    Tables, dataclasses and lists are compared entry by entry; nan is the same as nan.
    """
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        a, b = np.asarray(one), np.asarray(other)
        return a.shape == b.shape and all(map(same, a.ravel().tolist(), b.ravel().tolist()))
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=ROUNDING) or (one != one and other != other)
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, BaseModel):
        return type(one) is type(other) and same(dict(one), dict(other))
    if is_dataclass(one) and not isinstance(one, type):
        return type(one) is type(other) and all(
            same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one) if f.compare
        )
    return bool(one == other)


@dataclass(frozen=True)
class Assumption:
    """A value that no source states: its field, what it is, why it was taken.

    ``real`` where the field holds a real number and no count.
    """

    field: str
    value: str
    reason: str
    real: bool = False

    @property
    def default(self) -> str:
        """What is known of a default left to act; empty where the file declares the value."""
        return self.reason.removeprefix(LEFT) if self.reason.startswith(LEFT) else ""

    @property
    def figure(self) -> dict[str, Any]:
        """The value as a number, or a list of them, with its unit and what else is said of it.

        Counts and classes are whole numbers. A text stays one.
        """
        found = _NUMBERS.fullmatch(self.value)
        if found is None:
            return {"value": self.value, "unit": ""}
        texts, unit = found[1].split(","), found[2] or ""
        real = self.real or bool(unit) or "." in found[1] or "e" in found[1]
        numbers = [float(one) if real else int(one) for one in texts]
        value = {"value": numbers if len(numbers) > 1 else numbers[0], "unit": unit}
        return value | ({"note": found[3]} if found[3] else {})


_NUMBERS = re.compile(
    r"([-+]?[\d.]+(?:e[-+]?\d+)?(?:, [-+]?[\d.]+(?:e[-+]?\d+)?)*)(?: ([^\d,][^,]*))?(?:, (\D.*))?"
)
LEFT = "not in the file; the default: "
"""How the reason of a default begins that was left to act."""


def assumptions(
    data: dict[str, Any], file: BaseModel, decided: Mapping[str, str] = MappingProxyType({})
) -> tuple[Assumption, ...]:
    """Declared assumptions that hold, in the file's order, then the defaults left to act.

    ``decided``: what a value left out amounts to in this case, by its field.
    """
    declared = _declared(data.get("ours", {}), data, file)
    covered = {a.field for a in declared}
    silent = [
        a
        for a in _defaults(file, (), decided)
        if not any(a.field == c or a.field.startswith(f"{c}.") for c in covered)
    ]
    return (*declared, *silent)


def _declared(table: dict[str, Any], data: dict[str, Any], file: BaseModel) -> list[Assumption]:
    found, bare = [], []
    for path, entry in _entries(table):
        _require_field(path, type(file))
        if isinstance(entry, str) and entry.strip():
            bare.append(path)
            continue
        value, reason = _spoken(path, entry)
        if _holds(path, value, data, file):
            real = _real(_read(file, _split(path)))
            words = printable(" ".join(reason.split()))
            found.append(Assumption(path, _value(data, path), words, real))
    if bare:
        warnings.warn(
            f"ours: {len(bare)} reasons without the value they speak of are left out; write "
            f'"{bare[0]}" = {{ value = ..., reason = "..." }}',
            ValidityWarning,
            stacklevel=4,
        )
    return found


def _entries(table: dict[str, Any], above: str = "") -> list[tuple[str, Any]]:
    """(dotted path, entry), nested or with a quoted dotted key alike."""
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        path = f"{above}.{key}" if above else key
        # a field may be named "value" too: its entry is a table
        nested = isinstance(value, dict) and "reason" not in value
        nested = nested and isinstance(value.get("value", {}), dict)
        found += _entries(value, path) if nested else [(path, value)]
    return found


def _spoken(path: str, entry: Any) -> tuple[Any, str]:
    """Value and reason of an entry."""
    reason = entry.get("reason") if isinstance(entry, dict) else None
    whole = isinstance(entry, dict) and set(entry) == {"value", "reason"}
    if not (whole and isinstance(reason, str) and reason.strip()):
        raise InputError(
            f"ours.{path}",
            short(entry),
            why="a reason holds for one value: an entry needs a value and a reason",
            fix=f'write "{path}" = {{ value = ..., reason = "..." }}',
        )
    return entry["value"], reason


def _holds(path: str, value: Any, data: dict[str, Any], file: BaseModel) -> bool:
    """Whether the case has the ``value`` that an entry speaks of, by value and not by text."""
    parts = _split(path)
    if _in_table(data, parts) == (True, value):
        return True
    found = _read(file, parts)
    above = table_at(type(file), parts[:-1])
    if found is None or above is None:
        return False
    try:
        return same(_reader(above, parts[-1]).validate_python(value), found)
    except (ValidationError, InputError):
        return False


def _read(file: BaseModel, parts: tuple[str, ...]) -> Any:
    """What the file was read as at a field; None where there is no such field."""
    found: Any = file
    for part in parts:
        found = found.get(part) if isinstance(found, dict) else getattr(found, part, None)
    return found


def _real(value: Any) -> bool:
    """Whether a number as it was read, or one of several, is real and no count."""
    several = value if isinstance(value, tuple) else (value,)
    return any(isinstance(one, float) for one in several)


@lru_cache(maxsize=512)
def _reader(table: type[BaseModel], name: str) -> TypeAdapter[Any]:
    """What reads one field of a table."""
    return TypeAdapter(table.model_fields[name].rebuild_annotation())


def _split(path: str) -> tuple[str, ...]:
    """The parts of a dotted path; a part in quotes may hold points."""
    parts, rest = [], path
    while rest:
        if rest[0] in "\"'" and rest.find(rest[0], 1) > 0:
            end = rest.find(rest[0], 1)
            parts.append(rest[1:end])
            rest = rest[end + 1 :].removeprefix(".")
        else:
            part, _, rest = rest.partition(".")
            parts.append(part)
    return tuple(parts)


def _require_field(path: str, file: type[BaseModel]) -> None:
    parts = _split(path)
    for depth, part in enumerate(parts):
        above = table_at(file, parts[:depth])
        if above is None:
            if table_at(file, parts[: depth + 1]) is None:
                break
            continue  # a name of the user's own: rows.zeta, materials.bronze
        if part not in above.model_fields:
            break
    else:
        if parts:
            return
    above_it = dotted(parts[:depth]) if parts else ""
    known = table_at(file, parts[:depth]) if parts else file
    names = known.model_fields if known else {}
    fields = [f"{above_it}.{name}" if above_it else name for name in names]
    raise InputError(
        "ours", repr(path), why="no such field", fix=nearest(path, fields) if fields else None
    )


def _in_table(data: dict[str, Any], parts: tuple[str, ...]) -> tuple[bool, Any]:
    """Whether the file states a field, and what it states."""
    entry: Any = data
    for part in parts:
        if not isinstance(entry, dict) or part not in entry:
            return False, None
        entry = entry[part]
    return True, entry


def _value(data: dict[str, Any], path: str) -> str:
    stated, entry = _in_table(data, _split(path))
    return in_words(entry) if stated else "left out"


def _defaults(
    table: BaseModel, above: tuple[str, ...], decided: Mapping[str, str]
) -> list[Assumption]:
    found = []
    for name, field in type(table).model_fields.items():
        value = getattr(table, name)
        if isinstance(value, BaseModel):
            found += _defaults(value, (*above, name), decided)
        elif isinstance(value, dict) and value:
            for key, entry in value.items():
                if isinstance(entry, BaseModel):
                    found += _defaults(entry, (*above, name, key), decided)
        elif isinstance(value, tuple) and value and name in _LISTS and _tables(value):
            each = [one for entry in value for one in _defaults(entry, (*above, name), decided)]
            found += list({one.field: one for one in each}.values())
        elif name not in table.model_fields_set and field.description and name not in _SILENT:
            path = dotted((*above, name))
            text = decided.get(path) or _shown(value, field)
            reason = f"{LEFT}{field.description}"
            found.append(Assumption(path, text, reason, _real(value)))
    return found


def _tables(entries: tuple[Any, ...]) -> bool:
    return all(isinstance(entry, BaseModel) for entry in entries)


def _shown(value: Any, field: FieldInfo) -> str:
    """A default as a file would hold it: with its unit."""
    if value is None:
        return "left out"
    readers = [m for m in field.metadata if isinstance(m, Measure)]
    return readers[0].shown(value) if readers else in_words(value)


_LISTS = ("shafts", "bearings", "discs")
"""Lists of tables whose defaults are told once, whatever number of tables left them out."""
_SILENT = ("materials", "ours", "row", "pictures", "base_sets", "expected")
