"""The values that are ours: declared in the file's table ``[ours]``, or left to a default."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from thermogear.base.errors import InputError, nearest
from thermogear.study.complaints import dotted, table_at
from thermogear.study.units import short


@dataclass(frozen=True)
class Assumption:
    """A value that no source states: where it stands, what it is, why it was taken."""

    field: str
    value: str
    reason: str


def assumptions(
    data: dict[str, Any], file: BaseModel, overridden: tuple[str, ...]
) -> tuple[Assumption, ...]:
    """Declared assumptions in the file's order, then the defaults that were left to act.

    A field the user has ``overridden`` is no longer ours.
    """

    def is_overridden(path: str) -> bool:
        return any(path == o or path.startswith(f"{o}.") for o in overridden)

    declared = _declared(data.get("ours", {}), data, type(file))
    covered = {a.field for a in declared}
    silent = [
        a
        for a in _defaults(file, ())
        if not any(a.field == c or a.field.startswith(f"{c}.") for c in covered)
    ]
    return tuple(a for a in [*declared, *silent] if not is_overridden(a.field))


def _declared(
    table: dict[str, Any], data: dict[str, Any], file: type[BaseModel]
) -> list[Assumption]:
    found = []
    for path, reason in _leaves(table):
        _require_field(path, file)
        if not isinstance(reason, str) or not reason.strip():
            raise InputError(
                f"ours.{path}", short(reason), allowed="a text", why="an assumption has a reason"
            )
        found.append(Assumption(path, _value(data, path), " ".join(reason.split())))
    return found


def _leaves(table: dict[str, Any], above: str = "") -> list[tuple[str, Any]]:
    """(dotted path, value) of every entry, nested or with a quoted dotted key alike."""
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        path = f"{above}.{key}" if above else key
        found += _leaves(value, path) if isinstance(value, dict) else [(path, value)]
    return found


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


def _value(data: dict[str, Any], path: str) -> str:
    entry: Any = data
    for part in _split(path):
        if not isinstance(entry, dict) or part not in entry:
            return "left out"
        entry = entry[part]
    return in_words(entry)


def in_words(entry: Any) -> str:
    """A TOML value as a reader would write it, without quotes."""
    if isinstance(entry, dict):
        return ", ".join(f"{key} = {in_words(value)}" for key, value in entry.items())
    if isinstance(entry, list | tuple):
        return ", ".join(in_words(value) for value in entry)
    return entry if isinstance(entry, str) else short(entry)


def _defaults(table: BaseModel, above: tuple[str, ...]) -> list[Assumption]:
    found = []
    for name, field in type(table).model_fields.items():
        value = getattr(table, name)
        if isinstance(value, BaseModel):
            found += _defaults(value, (*above, name))
        elif isinstance(value, dict) and value:
            for key, entry in value.items():
                if isinstance(entry, BaseModel):
                    found += _defaults(entry, (*above, name, key))
        elif name not in table.model_fields_set and field.description and name not in _SILENT:
            text = "left out" if value is None else in_words(value)
            reason = f"not in the file; the default: {field.description}"
            found.append(Assumption(dotted((*above, name)), text, reason))
    return found


_SILENT = ("materials", "ours", "row", "pictures", "base_sets", "expected")
