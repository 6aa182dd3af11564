"""The cells of a table in a text: what parts them, what is a number, what says there is none."""

from __future__ import annotations

import re

NUMBER = re.compile(r"^[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?$")
MISSING = {"", "nan", "na", "n/a", "null", "-", "--", "inf", "-inf", "#n/a", "-nan", "1.#qnan"}


def cells_of(line: str, separator: str | None) -> list[str]:
    """The fields of a line, without quotes and without the empty one after a last separator."""
    if separator is None:
        return line.split()
    cells = [cell.strip().strip('"').strip() for cell in line.split(separator)]
    if len(cells) > 1 and cells[-1] == "":
        cells.pop()
    return cells
