"""The nested tables of a TOML text, dotted overrides put into them, and TOML written."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from thermogear.base.errors import InputError, short

NAMED = {"model.friction": "law"}
"""A name that may replace a table, and the field of the table that holds it."""

_KEY = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)*")


def tables(name: str, text: str) -> dict[str, Any]:
    """The tables of a TOML text; a syntax error names line and column."""
    if not text.strip():
        raise InputError(name, "an empty file", fix="`thermogear example rig` shows a case file")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as cause:
        match = re.fullmatch(r"(?P<what>.*) \(at (?P<where>.*)\)", str(cause), re.DOTALL)
        what, where = (match["what"], match["where"]) if match else (str(cause), "some line")
        unquoted = what.startswith(("Invalid value", "Expected newline"))
        fix = 'a value with its unit stands in quotes: "5 mm"' if unquoted else None
        if text.lstrip().startswith(("{", "<")):
            fix = "a case file is TOML; `thermogear example rig` shows one"
        elif what.startswith("Illegal character '\\n'"):
            fix = "a text ends with the quote it began with"
        raise InputError(name, f"invalid TOML at {where}", why=what, fix=fix) from cause
    except (ValueError, RecursionError) as cause:
        raise InputError(name, "a number or a nesting beyond reason", allowed="TOML") from cause


def pairs(overrides: Mapping[str, str] | Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Overrides as (dotted path, text), from a mapping or from ``"a.b=c"``."""
    if isinstance(overrides, Mapping):
        return tuple((str(key), str(value)) for key, value in overrides.items())
    found = []
    for text in overrides:
        key, equals, value = text.partition("=")
        if not equals:
            raise InputError(
                "--set", short(text), allowed="PATH=VALUE", fix="write gears.pinion.teeth=30"
            )
        found.append((key.strip(), value.strip()))
    return tuple(found)


def overridden(data: dict[str, Any], changes: tuple[tuple[str, str], ...]) -> dict[str, Any]:
    """``data`` with ``changes`` put in; tables on the way are new, made where missing.

    ``data`` itself stays as it is.
    """
    made = dict(data)
    fresh: set[int] = set()
    for path, text in changes:
        if not _KEY.fullmatch(path):
            raise InputError("--set", short(path), allowed="a dotted path: gears.pinion.teeth")
        *way, last = path.split(".")
        table: Any = made
        for depth, key in enumerate(way):
            above, table = table, table.get(key, {})
            if isinstance(table, dict) and id(table) not in fresh:
                table = dict(table)
                fresh.add(id(table))
            above[key] = table
            if isinstance(table, str) and ".".join(way[: depth + 1]) in NAMED:
                table = above[key] = {NAMED[".".join(way[: depth + 1])]: table}
            if not isinstance(table, dict):
                raise InputError(
                    path,
                    "an unknown path",
                    why=f"{'.'.join(way[: depth + 1])} is a value, not a table",
                )
        table[last] = _value(text)
    return made


def _value(text: str) -> Any:
    """The value of an override: TOML where it is TOML, else the text itself."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if set(parsed) == {"value"} else text


# --- writing ----------------------------------------------------------------------------------


def line(key: str, value: Any, comment: str = "") -> str:
    """``key = value   # comment``, or nothing where there is no value."""
    if value is None:
        return ""
    return f"{quoted(key)} = {literal(value)}" + (f"   # {flat(comment)}" if comment else "")


def table(name: str, *lines: str) -> list[str]:
    """A table of those lines that say something; none where none does."""
    said = [one for one in lines if one]
    return [*([heading(name)] if name else []), *said] if said else []


def heading(name: str) -> str:
    """``[a.b]`` of a dotted name."""
    return f"[{name}]"


def literal(value: Any) -> str:
    """A text, number, truth, list or table as TOML, numbers to the last bit."""
    if isinstance(value, dict):
        inside = ", ".join(f"{quoted(key)} = {literal(one)}" for key, one in value.items())
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(literal(one) for one in value)}]"
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def flat(text: str) -> str:
    """``text`` as a comment may hold it: one line, printable."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))


def quoted(key: str) -> str:
    """``key`` bare where TOML allows it, else in quotes."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else literal(key)
