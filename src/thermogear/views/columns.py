"""One declaration of a table: rows along named dimensions, columns with words, unit and digits.

A page's table, its lines in a terminal, its rows of CSV and its numbers in JSON are made of the
same columns.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import Display, display, number, span
from thermogear.base.vocabulary import QUANTITIES
from thermogear.results import tables
from thermogear.views.page import Cell, Table
from thermogear.views.style import names_of
from thermogear.views.typesetting import operating_names

Row = Mapping[str, Any]
"""One place: stored names with their values, SI numbers or words."""

PLAIN = Display("")


@dataclass(frozen=True)
class Column:
    """A column of a table.

    ``head``: its words, to which the unit is added. ``value``: the name of what it shows in a row,
    or a function of the row that returns it: an SI number; words and whole numbers are shown as
    they are, None and what is not finite as a dash. ``digits`` of a number: how many significant
    figures, a format as ".2f", or a function that writes it. ``shown``: its unit as shown and how
    to get there; without it the vocabulary's, or none. ``key``: its name in JSON, where it has one.
    """

    head: Cell
    value: str | Callable[[Row], Any]
    digits: int | str | Callable[[float], str] = 3
    shown: Display | None = None
    key: str = ""

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
        """What it holds in ``row``, in full: a word, a whole number or a number in its unit.

        Of a Dataset in place of a row the whole array, as lists.
        """
        value = self.value(row) if callable(self.value) else row.get(self.value)
        if value is None or isinstance(value, str | int | list | Mapping):
            return value
        values = np.asarray(value)
        return (self.display(values) if values.dtype.kind == "f" else values).tolist()

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


def key(name: str, value: str | Callable[[Any], Any] = "", shown: Display | None = PLAIN) -> Column:
    """A number for JSON alone, as it is stored unless ``shown`` says how: its name and value."""
    return Column("", value or name, shown=shown, key=name)


def in_full(columns: Iterable[Column], row: Row) -> dict[str, Any]:
    """The numbers of ``row`` under their names in JSON, nothing rounded."""
    return {column.key: column.figure(row) for column in columns if column.key}


def by_name(data: Dataset, columns: Sequence[Column], *dims: str) -> dict[str, Any]:
    """The arrays of ``data`` under their names in JSON: a table for each place along ``dims``."""

    def at(here: Dataset, *along: str) -> dict[str, Any]:
        if not along:
            return in_full(columns, cast(Row, here))
        first, *rest = along
        places = enumerate(names_of(here, first))
        return {name: at(here.isel({first: place}), *rest) for place, name in places}

    return at(tables.in_words(data), *dims)


def units(columns: Iterable[Column], data: Dataset) -> dict[str, str]:
    """The stored units of the numbers that have their stored names in JSON, pure numbers aside."""
    stored = {c.key: data[c.key].attrs.get("units", "1") for c in columns if c.key in data}
    return {name: unit for name, unit in stored.items() if unit != "1"}


def reaches(caption: str, columns: Iterable[Column], data: Dataset) -> Table:
    """The least and the greatest of each of the ``columns`` over all of ``data``."""
    row = cast(Row, data)
    return pairs(
        caption, ("", "least to greatest"), {c.title: span(c.figure(row)) for c in columns}
    )


OF_STATE = (Column("state", "state"), Column("operating point", "operating"))
"""The state of heat and the operating point, as the first columns of a table."""


def rows_along(data: Dataset, *dims: str) -> list[dict[str, Any]]:
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
    """The page's table of ``rows``; the first ``names`` columns hold words.

    What has a name in JSON and no words is left out.
    """
    there = list(rows)
    columns = [column for column in columns if column.head or not column.key]
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
