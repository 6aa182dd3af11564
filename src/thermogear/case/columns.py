"""Small tables with a unit in every head: ``time [min],speed [rpm]``, as a user types them."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError, nearest
from thermogear.base.files import decoded, require_regular
from thermogear.case.units import KINDS, convert

MOST_BYTES = 20_000_000
MOST_ROWS = 100_000
_HEAD = re.compile(r"\s*(?P<name>[^\[\]]*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?\s*")


@dataclass(frozen=True, eq=False)
class Column:
    """SI ``values`` of one column, nan where a cell is empty; ``unit`` and ``cells`` as written."""

    values: NDArray[np.float64]
    unit: str
    cells: tuple[str, ...]

    def shown(self, row: int) -> str:
        """A cell as the file has it, with its unit and row (from 1, the head not counted)."""
        return f"{self.cells[row]} {self.unit} in row {row + 1}"


def read_columns(
    path: str | Path, field: str, kinds: Mapping[str, str], needed: Collection[str], *, gaps: bool
) -> dict[str, Column]:
    """The columns of a CSV file by name, in SI.

    ``kinds``: name to kind of quantity, all that the table may have; ``needed`` of them must be
    there; ``gaps``: empty cells are nan, else refused. Separated by comma, semicolon or tab.
    Raises InputError, whose field begins with ``field``, in one line.
    """
    example = ",".join(f"{name} [{KINDS[kind].shown}]" for name, kind in kinds.items())
    text = _text(Path(path), field)
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines:
        raise InputError(field, "an empty file", allowed="a table", fix=f"begin with {example}")
    separator = max(",;\t", key=lines[0].count)
    rows = list(csv.reader(io.StringIO("\n".join(lines)), delimiter=separator))
    if len(rows) - 1 > MOST_ROWS:
        raise InputError(field, f"{len(rows) - 1} rows", allowed=f"at most {MOST_ROWS}")
    head = _head(rows[0], field, kinds, example)
    for name in needed:
        if name not in head:
            raise InputError(f"{field}.{name}", "no such column", fix=f"begin with {example}")
    for place, row in enumerate(rows[1:], 1):
        if len(row) != len(rows[0]):
            raise InputError(
                field,
                f"{len(row)} cells in row {place}",
                allowed=f"{len(rows[0])}, as in the head",
                fix="decimals follow a point" if separator == "," else None,
            )
    found = {}
    for at, (name, unit) in enumerate(head.items()):
        cells = tuple(row[at].strip() for row in rows[1:])
        point = cells if separator == "," else tuple(c.replace(",", ".") for c in cells)
        values = [
            _value(cell, unit, kinds[name], f"{field}.{name}", row, gaps)
            for row, cell in enumerate(point, 1)
        ]
        found[name] = Column(np.asarray(values, dtype=float), unit, cells)
    return found


def _text(path: Path, field: str) -> str:
    require_regular(path, field)
    try:
        raw = path.read_bytes()
    except (FileNotFoundError, IsADirectoryError, NotADirectoryError):
        raise InputError(field, str(path), why="there is no such file") from None
    if len(raw) > MOST_BYTES:
        raise InputError(field, f"{len(raw)} bytes", allowed=f"at most {MOST_BYTES}")
    try:
        text = decoded(raw)
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise InputError(field, str(path), why="it is no text", fix="save it as CSV in UTF-8")
    return text


def _head(cells: list[str], field: str, kinds: Mapping[str, str], example: str) -> dict[str, str]:
    """Name to unit of every column."""
    found: dict[str, str] = {}
    for cell in cells:
        match = _HEAD.fullmatch(cell)
        name = "" if match is None else match["name"].lower().replace(" ", "_")
        if match is None or name not in kinds:
            raise InputError(
                field,
                f"column {cell.strip()[:40]!r}",
                allowed=" | ".join(kinds),
                fix=nearest(name, kinds) if name in _near(name, kinds) else f"begin with {example}",
            )
        if name in found:
            raise InputError(f"{field}.{name}", "two columns", allowed="one")
        shown = KINDS[kinds[name]].shown
        if not (match["unit"] or "").strip():
            raise InputError(
                f"{field}.{name}",
                f"column {cell.strip()[:40]!r}",
                why="its unit is missing",
                fix=f"write {name} [{shown}]",
            )
        unit = match["unit"].strip()
        try:
            convert(1.0, unit, KINDS[kinds[name]])
        except InputError as error:
            raise InputError(
                f"{field}.{name}", f"unit [{unit}]", why=error.why, fix=f"write {name} [{shown}]"
            ) from error
        found[name] = unit
    return found


def _near(name: str, kinds: Mapping[str, str]) -> Collection[str]:
    """The name itself where one of the known ones is near it."""
    return () if nearest(name, kinds).startswith("known:") else (name,)


def _value(cell: str, unit: str, kind: str, field: str, row: int, gaps: bool) -> float:
    if not cell:
        if gaps:
            return math.nan
        raise InputError(
            field,
            f"an empty cell in row {row}",
            allowed="a number",
            fix="fill the gap, or leave the row out",
        )
    try:
        number = float(cell)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise InputError(field, f"{cell[:40]!r} in row {row}", allowed="a number")
    return convert(number, unit, KINDS[kind])


def require_times(time: Column, field: str) -> None:
    """Refuse times that are negative or do not rise."""
    for row, value in enumerate(time.values):
        if not value >= 0.0:
            raise InputError(f"{field}.time", time.shown(row), allowed=f">= 0 {time.unit}")
        if row and not value > time.values[row - 1]:
            raise InputError(
                f"{field}.time",
                f"{time.shown(row)}, after {time.cells[row - 1]} {time.unit}",
                allowed="times that rise",
            )
