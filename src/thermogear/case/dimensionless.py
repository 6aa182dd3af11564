"""Rows of the dimensionless equation of motion, point by point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from thermogear.base.errors import InputError, printable, short
from thermogear.base.parameters import NUMBERS
from thermogear.case.allowed import dimensionless_reader, positive_stiffness, within
from thermogear.case.dimensionless_schema import DimensionlessFile, RowTable


@dataclass(frozen=True, kw_only=True)
class Point:
    """One point of a dimensionless row: the swept ``parameter`` at ``value``, and the whole set.

    ``unit`` of the value is "1" or "K"; ``expected`` the label that is expected, or nothing.
    """

    row: str
    parameter: str
    value: float
    unit: str
    expected: str
    damping_ratio: float
    frequency: float
    stiffness_amplitude: float
    mean_force: float
    force_amplitude: float
    half_backlash: float
    thermal_stiffness: float

    def model_arguments(self) -> dict[str, float]:
        """The keywords of the dimensionless equation."""
        return {name: getattr(self, name) for name in NUMBERS}


def points_of(file: DimensionlessFile) -> tuple[Point, ...]:
    """Every point of every row, in the file's order."""
    points: list[Point] = []
    for name, row in file.rows.items():
        if not name.isprintable():
            raise InputError(f"rows.{printable(name)}", short(name), allowed="a name of one line")
        points += _row(name, row, file)
    return tuple(points)


def _row(name: str, row: RowTable, file: DimensionlessFile) -> list[Point]:
    count = len(row.values)
    where = f"rows.{name}"
    columns: dict[str, tuple[float, ...]] = {}
    for parameter in NUMBERS:
        own = getattr(row, parameter)
        if own is not None and parameter == row.parameter:
            raise InputError(
                f"{where}.{parameter}",
                "a value beside its own row",
                why="this parameter runs through `values`",
                fix="leave it out",
            )
        given = getattr(file.base, parameter) if own is None else own
        at = f"base.{parameter}" if own is None else f"{where}.{parameter}"
        columns[parameter] = _stretched(given, count, at)
    unit = "K" if row.parameter == "temperature" else "1"
    for place, (value, unit_of_value) in enumerate(row.values):
        if unit_of_value != unit:
            raise InputError(
                f"{where}.values[{place}]",
                "a temperature" if unit_of_value == "K" else f"{value:g} (no unit)",
                allowed="temperatures with unit" if unit == "K" else "pure numbers",
                why=f"the row runs through {row.parameter}",
                fix='write for instance "100 degC"' if unit == "K" else "write for instance 0.18",
            )
    if row.parameter in columns:
        reader = dimensionless_reader(row.parameter)
        for place, (value, _) in enumerate(row.values):
            within(f"{where}.values[{place}]", reader, value)
        columns[row.parameter] = tuple(value for value, _ in row.values)
    for place in range(count):
        positive_stiffness(
            f"{where}, point {place + 1}, stiffness_amplitude",
            columns["stiffness_amplitude"][place],
            thermal=columns["thermal_stiffness"][place],
        )
    expected: tuple[str, ...] = ("",) * count
    if row.expected:
        expected = _stretched(row.expected, count, f"{where}.expected")
    return [
        Point(
            row=name,
            parameter=row.parameter,
            value=row.values[i][0],
            unit=unit,
            expected=expected[i],
            **{parameter: columns[parameter][i] for parameter in NUMBERS},
        )
        for i in range(count)
    ]


_Entry = TypeVar("_Entry", float, str)


def _stretched(given: tuple[_Entry, ...], count: int, where: str) -> tuple[_Entry, ...]:
    if len(given) == 1:
        return given * count
    if len(given) != count:
        raise InputError(
            where, f"{len(given)} entries", allowed=f"one, or {count} as the row has values"
        )
    return given
