"""Numbers told as texts, and numbers that stand for none, in what is meant for scripts."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping
from typing import Any

UNIT = r"(?:%|°C|degC|[kmµu]?(?:m|s|N|W|g|Pa|Hz|rad)|rpm|K|N m|N/m|rad/s|m/s\^?2?|min|h)"
SHOWN = re.compile(
    r"(?!\d\.\d\.\d+$)"
    rf"[-+−]?\d[\d.,  ]*(?:e[-+]?\d+|·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?(?:\.\.[-+]?\d[\d.e]*)?(?: ?{UNIT})?"
)
"""A whole text that is a number, with thousands set off, powers of ten, a unit, or two of them.

The numbers of the thesis's statements (2.1.10) are none."""
TEXTS = {
    "thermogear",
    "unit",
    "units",
    "name",
    "case",
    "differences",
    "values",
    "title",
    "kind",
    "version",
    "printed",
    "place",
    "as_in_the_thesis",
    "consistent",
}
"""Keys of names, of units ("1"), of versions, of fields as a case file spells them and of figures
as another document prints them and of its sections ("2.3"), and of
findings, which are sentences."""


def told_as_text(value: Any, key: str = "") -> Iterator[str]:
    """Key and text of every number that is a text."""
    if isinstance(value, Mapping):
        for name, one in value.items():
            if name not in TEXTS and not str(name).endswith("_unit"):
                yield from told_as_text(one, f"{key}.{name}")
    elif isinstance(value, list | tuple):
        for one in value:
            yield from told_as_text(one, f"{key}[]")
    elif isinstance(value, str) and SHOWN.fullmatch(value.strip()):
        yield f"{key} {value!r}"


SIGNS = re.compile(r"direction|sign|rotation")
"""Columns of signs, whose -1 is a number."""


def told_in_csv(text: str) -> Iterator[str]:
    """Column and cell of every number of a CSV text that has a unit or a power of ten in words,
    and of every -1 or -2 in a column of whole numbers that has no other below 0.

    Of a long table some 200 rows are looked at."""
    lines = text.splitlines()
    rows = list(csv.reader([*lines[:1], *lines[1 :: 1 + len(lines) // 200]]))
    for head, *cells in zip(*rows, strict=True) if rows else ():
        known = [cell.strip() for cell in cells if cell.strip()]
        numbers = [float(cell) for cell in known if _plain(cell)]
        for cell in known:
            if not _plain(cell) and SHOWN.fullmatch(cell):
                yield f"{head}: {cell!r}"
        whole = len(numbers) == len(known) and all(one == int(one) for one in numbers)
        mixed = bool(numbers) and -2.0 <= min(numbers) < 0.0 <= max(numbers)
        if whole and mixed and not SIGNS.search(head):
            yield f"{head}: {min(numbers):g} among {sorted(set(numbers))[:5]}"


def _plain(cell: str) -> bool:
    """Whether a cell is a finite number as a program reads it."""
    return re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", cell) is not None
