"""From a path or a text to the nested tables of a case file, overrides applied."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from thermogear.base.errors import InputError
from thermogear.base.files import decoded
from thermogear.case.examples import EXAMPLES, example_text
from thermogear.case.units import short

LARGEST = 1_000_000
"""A case file is text written by hand: one larger than this [bytes] is something else."""

NAMED = {"model.friction": "law"}
"""A name that may stand for a table, and the field of the table that holds it."""

_KEY = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)*")


def case_text(source: str | Path) -> tuple[str, str]:
    """(name, text) of a case given by its path or as text.

    A ``str`` is a text when it holds a line break or an equals sign, or nothing; else a path. The
    bare name of a ready-made case stands for it where no such file exists.
    """
    if isinstance(source, str) and (not source.strip() or "\n" in source or "=" in source):
        return "case", source
    path = Path(source)
    name = path.name or str(path)
    if str(source) in EXAMPLES and not path.exists():
        return name, example_text(name)
    if path.is_dir():
        raise InputError(name, "a directory", allowed="a case file (TOML)")
    try:
        with path.open("rb") as file:
            raw = file.read(LARGEST + 1)
    except FileNotFoundError as cause:
        raise InputError(name, "no such file", fix=_instead(path)) from cause
    except (OSError, ValueError) as cause:
        reason = getattr(cause, "strerror", None) or str(cause)
        raise InputError(repr(name), "a file that cannot be read", why=str(reason)) from cause
    if len(raw) > LARGEST:
        raise InputError(
            name, f"more than {LARGEST} bytes", allowed=f"0..{LARGEST} bytes", why="no case file"
        )
    try:
        text = decoded(raw)
    except UnicodeDecodeError as cause:
        if b"\0" in raw:
            raise _binary(name) from cause
        line = raw.count(b"\n", 0, cause.start) + 1
        raise InputError(
            name,
            f"byte 0x{raw[cause.start]:02x} in line {line}",
            allowed="UTF-8 text (TOML)",
            why="another encoding",
            fix="save the file as UTF-8",
        ) from cause
    if "\0" in text:
        raise _binary(name)
    return name, text


def _binary(name: str) -> InputError:
    return InputError(name, "binary data", allowed="UTF-8 text (TOML)", why="it holds zero bytes")


def _instead(path: Path) -> str:
    import difflib

    try:
        beside = [p.name for p in path.parent.glob("*.toml")]
    except OSError:
        beside = []
    close = difflib.get_close_matches(path.name, beside, n=1, cutoff=0.6)
    if close:
        return f"did you mean {close[0]!r}?"
    example = path.stem if path.stem in EXAMPLES else "rig"
    return f"`thermogear example {example} -o {example}.toml` writes one"


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
    """``data`` with ``changes`` put in, in place; a table on the way is made where missing."""
    for path, text in changes:
        if not _KEY.fullmatch(path):
            raise InputError("--set", short(path), allowed="a dotted path: gears.pinion.teeth")
        *way, last = path.split(".")
        table: Any = data
        for depth, key in enumerate(way):
            above, table = table, table.setdefault(key, {})
            if isinstance(table, str) and ".".join(way[: depth + 1]) in NAMED:
                table = above[key] = {NAMED[".".join(way[: depth + 1])]: table}
            if not isinstance(table, dict):
                raise InputError(
                    path,
                    "an unknown path",
                    why=f"{'.'.join(way[: depth + 1])} is a value, not a table",
                )
        table[last] = _value(text)
    return data


def _value(text: str) -> Any:
    """The value of an override: TOML where it is TOML, else the text itself."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if set(parsed) == {"value"} else text
