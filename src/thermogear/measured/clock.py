"""Clock stamps of a text ("2024-01-05 12:00:00.001") as seconds, and LabVIEW's comment column."""

from __future__ import annotations

import datetime
import re
from collections.abc import Sequence

_STAMP = re.compile(
    r"(?:(\d{4})[-/.](\d{1,2})[-/.](\d{1,2})[T ]\s*)?"
    r"(\d{1,2}):([0-5]\d):([0-5]\d)((?:[.,]\d{1,9})?)Z?"
)
_DAY = 86_400
_SHARE = 0.5  # of the lines that must hold a stamp


def has_clocks(head: Sequence[str]) -> bool:
    """Whether most of a text's first lines hold one clock stamp or more."""
    rows = [line for line in head if line.strip()]
    return bool(rows) and sum(bool(_STAMP.search(line)) for line in rows) > _SHARE * len(rows)


def without_clocks(line: str) -> str:
    """The line with each stamp as seconds of its day, or since the year 2000 with a date.

    >>> without_clocks("12:00:01.5,3.2")
    '43201.500000000,3.2'
    """
    return _STAMP.sub(_seconds, line)


def _seconds(found: re.Match[str]) -> str:
    year, month, day, hour, minute, second, part = found.groups()
    whole = 3600 * int(hour) + 60 * int(minute) + int(second)
    if year is not None:
        try:
            date = datetime.date(int(year), int(month), int(day))
        except ValueError:
            return found.group(0)
        whole += _DAY * (date - datetime.date(2000, 1, 1)).days
    return f"{whole}.{part[1:]:0<9}"


def is_stamp_name(name: str) -> bool:
    """Whether a column's name says clock, date or stamp."""
    return bool(re.search(r"stamp|date|clock|datum|uhrzeit|时间|日期", name[:200], re.IGNORECASE))


def comment_column(table: Sequence[Sequence[str]]) -> tuple[int, int] | None:
    """(line, column) of a heading "Comment" that ends a line of names: LabVIEW's LVM has it."""
    places = (
        (number, len(cells) - 1)
        for number, cells in enumerate(table)
        if len(cells) > 1 and cells[-1].strip().lower() == "comment"
    )
    return next(places, None)
