"""The line of a field in the text of a case file."""

from __future__ import annotations

import re

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
    for length in range(len(parts), 0, -1):
        if parts[:length] in places:
            return places[parts[:length]]
    return None


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
