"""What pydantic found wrong, said in one line: field, value, what is allowed, what to do."""

from __future__ import annotations

import difflib
import re
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from thermogear.base.errors import InputError, InputErrors, nearest, short
from thermogear.case.fields import Reader

_HEADER = re.compile(r"\s*\[\[?\s*(?P<path>[^\[\]]+?)\s*\]\]?\s*(#.*)?$")
_KEY = re.compile(
    r"""\s*(?P<path>(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
    r"""(?:\s*\.\s*(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*'))*)\s*="""
)


def line_of(text: str, field: str) -> int | None:
    """The line (from 1) of the dotted ``field`` in a TOML ``text``, else of the table it is in.

    None where neither is written: a table left out, a value put in from elsewhere.
    """
    places = _places(text)
    parts = _parts(field)
    above = (parts[:length] for length in range(len(parts), 0, -1))
    return next((places[one] for one in above if one in places), None)


def _parts(path: str) -> tuple[str, ...]:
    """The keys of a path; the first of a list of tables counts as the table itself."""
    found = re.findall(r"""\[\d+\]|[A-Za-z0-9_-]+|"[^"]*"|'[^']*'""", path)
    return tuple(part.strip("\"'") for part in found if part != "[0]")


def _places(text: str) -> dict[tuple[str, ...], int]:
    """Line of every table and key; of what is written twice the first."""
    found: dict[tuple[str, ...], int] = {}
    table: tuple[str, ...] = ()
    seen: dict[tuple[str, ...], int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if header := _HEADER.match(line):
            table = _parts(header["path"])
            if line.lstrip().startswith("[["):
                nth = seen[table] = seen.get(table, -1) + 1
                table = (*table, f"[{nth}]") if nth else table
            found.setdefault(table, number)
        elif key := _KEY.match(line):
            path = (*table, *_parts(key["path"]))
            for length in range(len(table) + 1, len(path) + 1):
                found.setdefault(path[:length], number)
    return found


MOST = 20
"""Faults of one file that are told: each unknown key is held against all known ones."""
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_RANK = {"extra_forbidden": 0, "missing": 2}  # a misspelt key explains the missing one
_SHAPES = {
    "model_type": ("a table", None),
    "dict_type": ("a table", None),
    "tuple_type": ("a list", None),
    "bool_type": ("true or false", None),
    "bool_parsing": ("true or false", None),
    "string_type": ("a text", None),
}


def complaints(error: ValidationError, file: type[BaseModel]) -> list[InputError]:
    """Every one of pydantic's complaints, the gravest first: what explains others leads."""
    found = sorted(error.errors(include_url=False), key=lambda e: _RANK.get(e["type"], 1))
    if any("helix" in str(e["loc"][-1]) for e in found if e["loc"]):
        found.sort(key=lambda e: "helix" not in str(e["loc"][-1:]))
    found, others = found[:MOST], len(found[MOST:])
    unknown = [one for one in found if one["type"] == "extra_forbidden"]
    meant = {
        (*one["loc"][:-1], name)
        for one in unknown
        if (name := _meant(str(one["loc"][-1]), table_at(file, one["loc"][:-1])))
    }
    # a misspelt key says by itself what is missing
    lines = [_said(dict(one), file) for one in found if one["loc"] not in meant]
    if others:
        lines.append(InputError("case", f"{others} more faults", fix="mend these first"))
    return lines


def _meant(key: str, table: type[BaseModel] | None) -> str | None:
    """The field that a misspelt key most likely means."""
    if "diametral" in key:
        return "module"
    close = difflib.get_close_matches(key, table.model_fields if table else (), n=1, cutoff=0.5)
    return close[0] if close else None


def dotted(location: tuple[int | str, ...]) -> str:
    """``("gears", "pinion", "teeth")`` as ``gears.pinion.teeth``, list places in brackets."""
    text = ""
    for part in location:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            key = part if _BARE.fullmatch(part) and len(part) <= 60 else short(part)
            text += f".{key}" if text else key
    return text


def _said(complaint: dict[str, Any], file: type[BaseModel]) -> InputError:
    location, kind, raw = complaint["loc"], complaint["type"], complaint["input"]
    field = dotted(location)
    cause = complaint.get("ctx", {}).get("error")
    if isinstance(cause, InputError):
        joint = "" if not field or not cause.field or cause.field.startswith("[") else "."
        return cause.named(field + joint + cause.field or "case")
    if kind == "extra_forbidden":
        return _unknown_key(location, field, file)
    if kind == "missing":
        reader = reader_at(file, location)
        key = location[-1]
        fix = f"write {key} = {reader.example}" if reader else f"add the table [{field}]"
        return InputError(field, "nothing", why="needed", fix=fix)
    if kind in _SHAPES:
        allowed, why = _SHAPES[kind]
        table = f"write [{field}]" if allowed == "a table" else None
        return InputError(field, short(raw), allowed=allowed, why=why, fix=table)
    return InputError(field or "case", short(raw), why=complaint["msg"])


def _unknown_key(location: tuple[int | str, ...], field: str, file: type[BaseModel]) -> InputError:
    key = str(location[-1])
    if "helix" in key:
        return InputError(
            field,
            "a helix angle",
            why="thermogear treats spur gears only",
            fix="leave it out",
        )
    if "diametral" in key:
        return InputError(
            field,
            "a diametral pitch",
            why="the field is module",
            fix='write module = "8 1/in" for a diametral pitch of 8',
        )
    table = table_at(file, location[:-1])
    # what is excluded is not written by hand
    fields = table.model_fields.items() if table else ()
    known = {name for name, one in fields if not one.exclude}
    where = f"[{dotted(location[:-1])}]" if len(location) > 1 else "the case file"
    return InputError(
        field, "an unknown key", why=f"{where} does not have it", fix=nearest(key, known)
    )


def table_at(file: type[BaseModel], location: tuple[int | str, ...]) -> type[BaseModel] | None:
    """The model that reads the table at ``location``, or None where there is none."""
    table: type[BaseModel] | None = file
    waiting: type[BaseModel] | None = None  # entries of a dict or a list: one more step to go
    for part in location:
        if waiting is not None:
            table, waiting = waiting, None
            continue
        if table is None or str(part) not in table.model_fields:
            return None
        annotation = table.model_fields[str(part)].annotation
        table, waiting = models_of(annotation)
    return table


def models_of(annotation: Any) -> tuple[type[BaseModel] | None, type[BaseModel] | None]:
    """(model, None) of a table, (None, model) of a dict or list of tables."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation, None
    inner = [a for a in get_args(annotation) if isinstance(a, type) and issubclass(a, BaseModel)]
    if not inner:
        return None, None
    collection = getattr(annotation, "__origin__", None) in (dict, tuple)
    return (None, inner[0]) if collection else (inner[0], None)


def reader_at(file: type[BaseModel], location: tuple[int | str, ...]) -> Reader | None:
    """What reads the field at ``location``, or None where there is no such field."""
    table = table_at(file, location[:-1])
    if table is None or str(location[-1]) not in table.model_fields:
        return None
    return reader_of(table.model_fields[str(location[-1])])


def reader_of(field: FieldInfo) -> Reader | None:
    """What reads a field, or None of a table or a truth."""
    readers = [m for m in field.metadata if isinstance(m, Reader)]
    for inner in get_args(field.annotation):
        readers += [m for m in getattr(inner, "__metadata__", ()) if isinstance(m, Reader)]
    return readers[0] if readers else None


def together(
    errors: list[InputError], text: str, changes: tuple[tuple[str, str], ...]
) -> InputError:
    """Errors of one file as one, each with its line where the file's own text is at fault."""
    changed = {path.partition(".")[0] for path, _ in changes}
    for error in errors:
        if error.field.partition(".")[0] not in changed:
            error.line = line_of(text, error.field)
    return errors[0] if len(errors) == 1 else InputErrors(errors)
