"""One declaration of a table: rows along named dimensions, columns with words, unit and digits.

A page's table, its lines in a terminal and its numbers in JSON are made of the same rows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from thermogear.base.display import Display, display, number
from thermogear.base.vocabulary import QUANTITIES
from thermogear.results import tables
from thermogear.views.page import Block, Cell, Table, Text
from thermogear.views.typesetting import operating_names

if TYPE_CHECKING:
    import xarray as xr

Row = Mapping[str, Any]
"""One place: stored names with their values, SI numbers or words."""

PLAIN = Display("")
TYPEWRITTEN = str.maketrans(
    {"µ": "u", "±": "+-", "−": "-", "–": "-", "→": "->", "°": "deg", "′": "'", "⁻": "-"}
    | dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789", strict=True))
)
"""Letters of a page as any terminal has them."""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    ``head``: its words, to which the unit is added. ``value``: the name of what it shows in a row,
    or a function of the row that returns it: an SI number; words and whole numbers are shown as
    they are, None and what is not finite as a dash. ``digits`` of a number: how many significant
    figures, a format as ".2f", or a function that writes it. ``shown``: its unit as shown and how
    to get there; without it the vocabulary's, or none.
    """

    head: Cell
    value: str | Callable[[Row], Any]
    digits: int | str | Callable[[float], str] = 3
    shown: Display | None = None

    @property
    def display(self) -> Display:
        """How its numbers are shown."""
        if self.shown is None and self.value in QUANTITIES:
            return display(str(self.value))
        return self.shown or PLAIN

    @property
    def title(self) -> Cell:
        """Its words with the unit."""
        unit = self.display.unit.strip("–")
        return self.head + f" [{unit}]" if unit else self.head

    def figure(self, row: Row) -> Any:
        """What it holds in ``row``, in full: a word, a whole number or a number in its unit."""
        value = self.value(row) if callable(self.value) else row.get(self.value)
        if value is None or isinstance(value, str | int):
            return value
        return float(self.display(value))

    def cell(self, row: Row) -> Cell:
        """What stands in it in ``row``."""
        figure = self.figure(row)
        if isinstance(figure, str):
            return figure
        if isinstance(figure, int):
            return str(figure)
        if figure is None or not math.isfinite(figure):
            return "–"
        if callable(self.digits):
            return self.digits(figure)
        if isinstance(self.digits, int):
            return number(figure, self.digits)
        return format(figure, self.digits.replace(".", "z.")).replace("-", "−")


OF_STATE = (Column("state", "state"), Column("operating point", "operating"))
"""The state of heat and the operating point, as the first columns of a table."""


def rows_along(data: xr.Dataset, *dims: str) -> list[dict[str, Any]]:
    """A row for each place along ``dims``, as :func:`~thermogear.results.tables.rows_along`.

    Under ``operating`` stands the name of the operating point where these have none.
    """
    if "operating" in dims and "operating" not in data.variables:
        data = data.assign(operating=operating_names(data))
    return tables.rows_along(data, *dims)


def declared(
    caption: str,
    columns: Sequence[Column],
    rows: Iterable[Row],
    *,
    names: int = 1,
    marked: Callable[[Row], bool] = lambda row: False,
    wordy: bool = False,
) -> Table:
    """The page's table of ``rows``; the first ``names`` columns hold words."""
    there = list(rows)
    cells = [[column.cell(row) for column in columns] for row in there]
    stand_out = frozenset(place for place, row in enumerate(there) if marked(row))
    figures = [[column.figure(row) for column in columns] for row in there]
    return Table(caption, [c.title for c in columns], cells, names, stand_out, wordy, figures)


def pairs(
    caption: str, head: tuple[Cell, Cell], values: Mapping[Any, Any], *, wordy: bool = False
) -> Table:
    """A table of two columns: what is what; ``wordy`` where that is told in words."""
    rows = [{"name": name, "value": value} for name, value in values.items()]
    name, value = head
    columns = (Column(name, "name"), Column(value, lambda row: str(row["value"])))
    return declared(caption, columns, rows, names=1 + wordy, wordy=wordy)


def typed(text: Cell) -> str:
    """A cell of a page as any terminal shows it: no marks, no letters that may be missing."""
    words = text.striptags() if isinstance(text, Markup) else text
    return words.replace("·10", "e").replace("10⁸", "1e8").translate(TYPEWRITTEN)


def lines_of(*blocks: Block) -> list[str]:
    """Texts and tables as lines of a terminal: words to the left, numbers to the right.

    Heads are folded over their columns; what is neither is left out.
    """
    lines: list[str] = []
    for block in blocks:
        if isinstance(block, Text):
            lines.append(typed(block.words))
        elif isinstance(block, Table):
            lines += [*[typed(block.caption)] * bool(block.caption), *_grid(block)]
    return lines


def _grid(table: Table) -> Iterator[str]:
    columns = [[*map(typed, cells)] for cells in zip(table.head, *table.rows, strict=True)]
    widths = [max(map(len, [" ", *head.split(), *cells])) for head, *cells in columns]
    heads = [wrap(head, width) for (head, *_), width in zip(columns, widths, strict=True)]
    body = zip(*(cells[1:] for cells in columns), strict=True)
    for line in [*zip_longest(*heads, fillvalue=""), *body]:
        placed = zip(line, widths, range(len(widths)), strict=True)
        words = (c.ljust(w) if k < table.names else c.rjust(w) for c, w, k in placed)
        yield f"  {'  '.join(words)}".rstrip()
