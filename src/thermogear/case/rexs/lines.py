"""Fields of a case that come out of a REXS file, each with where it is from, as TOML."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from thermogear.base.toml import heading, line

READ, DERIVED, DEFAULT, GIVEN = "read", "derived", "default", "given"
"""In the file as it is; computed from what is there; left to the package; said by the user."""


@dataclass(frozen=True)
class Line:
    """A field of the case file: its dotted ``path``, the ``value`` a file holds, the origin.

    ``note``: the attribute it was read from, or how it was derived.
    """

    path: str
    value: Any
    origin: str
    note: str = ""


def some(names: Iterable[str]) -> str:
    """The first names; of more than eight the number."""
    every = list(names)
    more = f" and {len(every) - 8} more" if len(every) > 8 else ""
    return ", ".join(every[:8]) + more


def toml(lines: Iterable[Line], head: Iterable[str], defaults: Iterable[tuple[str, str]]) -> str:
    """The case file: comment lines ``head``, then the tables.

    ``defaults``: (dotted path, why) of fields left out, a comment in the table of each.
    """
    tables: dict[str, list[str]] = {"": []}
    for one in lines:
        table, _, key = one.path.rpartition(".")
        said = f"{one.origin}: {one.note}" if one.note else one.origin
        tables.setdefault(table, []).append(line(key, one.value, said))
    for path, why in defaults:
        table, _, key = path.rpartition(".")
        tables.setdefault(table, []).append(f"# {key} left out; {DEFAULT}: {why}")
    found = [f"# {text}" for text in head]
    for name in sorted(tables, key=_rank):
        if tables[name]:
            listed = _NTH.fullmatch(name)
            head_line = heading(f"[{listed[1]}]" if listed else name)
            found += ["", *([head_line] if name else []), *tables[name]]
    return "\n".join(found) + "\n"


_ORDER = ("", "gears", "materials", "housing", "oil", "operating", "temperatures", "backlash")


_NTH = re.compile(r"(\w+)\[(\d+)\]")
"""The name of a table in a list of tables."""


def _rank(table: str) -> tuple[int, str, int]:
    listed = _NTH.fullmatch(table)
    name, nth = (listed[1], int(listed[2])) if listed else (table, 0)
    first = name.split(".")[0]
    return (_ORDER.index(first) if first in _ORDER else len(_ORDER), name, nth)
