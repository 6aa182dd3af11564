"""Small tables of a user: the duty of a pair, and temperatures measured over it."""

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

from thermogear.base import bounds
from thermogear.base.bounds import Bounds
from thermogear.base.errors import InputError, nearest
from thermogear.base.files import decoded, require_regular
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.case import GearCase
from thermogear.case.gearbox_schema import NODES
from thermogear.case.ranges import CRUSHING, crushing_torque
from thermogear.case.sensors import SENSORS
from thermogear.case.units import KINDS, convert
from thermogear.mesh.warm_up import Duty

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


DUTY_COLUMNS = {
    "time": "time",
    "speed": "rotational speed",
    "torque": "torque",
    "ambient": "temperature",
}
"""The columns of a duty table and what they hold."""


def read_duty(path: str | Path, case: GearCase, field: str = "duty") -> Duty:
    """The duty in a CSV file with units in its head: ``time [min],speed [rpm],torque [N m]``.

    Each row holds from its time until the next row's; the last row says the end alone. A column
    ``ambient [degC]`` is left out where the air stays as the case has it. Speeds and torques are
    the pinion's, 0 for a stop. Units as in a case file. Raises InputError in one line for times
    that are negative or do not rise from 0, gaps, a torque that would crush the flanks of any
    steel, and an ambient outside the range of the oil's viscosity line.
    """
    table = read_columns(path, field, DUTY_COLUMNS, ("time", "speed", "torque"), gaps=False)
    time = table["time"]
    require_times(time, field)
    if time.values.size < 2:
        raise InputError(
            field,
            f"{time.values.size} rows",
            allowed="two or more",
            fix="the last row says when the duty ends",
        )
    if time.values[0] != 0.0:
        raise InputError(f"{field}.time", time.shown(0), allowed=f"0 {time.unit} in the first row")
    _require(table["speed"], bounds.SPEED, f"{field}.speed")
    _require_torque(table["torque"], case, f"{field}.torque")
    ambient = table.get("ambient")
    if ambient is None:
        around = np.full(time.values.size - 1, case.gearbox.surroundings.ambient)
    else:
        for row, value in enumerate(ambient.values):
            _require_air(case, value, f"{field}.ambient", ambient.shown(row))
        around = ambient.values[:-1]
    return Duty(
        time=time.values,
        speed=table["speed"].values[:-1],
        torque=table["torque"].values[:-1],
        ambient=around,
    )


def chosen_point(case: GearCase) -> tuple[float, float]:
    """(speed [rad/s], torque [N m]) of the case's operating point of the greatest power."""
    place = int(np.argmax(case.stated.speed * case.stated.torque))
    return float(case.stated.speed[place]), float(case.stated.torque[place])


def point_duty(case: GearCase, speed: float, torque: float, field: str = "duty") -> Duty:
    """One operating point, ``speed`` [rad/s] and ``torque`` [N m], held until it is steady.

    Raises InputError for a torque that would crush the flanks, and for an ambient of the case
    outside the range of the oil's viscosity line.
    """
    ambient = case.gearbox.surroundings.ambient
    _require_air(case, ambient, "gearbox.ambient", f"{ambient - ZERO_CELSIUS:g} degC")
    most = crushing_torque(case.pair)
    if not 0.0 <= torque <= most:
        raise InputError(field, f"{torque:g} N m", allowed=f"0..{most:.4g} N m")
    bounds.SPEED.require(field, speed)
    return Duty.steady(speed, torque, ambient=ambient)


@dataclass(frozen=True, eq=False, kw_only=True)
class Measured:
    """A measured record: ``time`` [s], ``names`` of nodes or sensors, ``values`` [K] or nan."""

    time: NDArray[np.float64]
    names: tuple[str, ...]
    values: NDArray[np.float64]


def read_measured(path: str | Path, field: str = "measured") -> Measured:
    """The record in a CSV file with units in its head: ``time [min],pinion_tooth [degC],...``.

    Columns are named by nodes of the heat balance or by sensors; empty cells are left out. Units as
    in a case file, times [s] from the start of the duty. Raises InputError in one line.
    """
    kinds = {"time": "time"} | dict.fromkeys((*NODES, *SENSORS), "temperature")
    table = read_columns(path, field, kinds, ("time",), gaps=True)
    when = table.pop("time")
    require_times(when, field)
    values = np.stack([c.values for c in table.values()], axis=1) if table else np.empty((0, 0))
    if not np.any(np.isfinite(values)):
        raise InputError(
            field,
            "no temperature",
            allowed="time and one or more of " + ", ".join((*NODES, *SENSORS)),
        )
    for name, column in table.items():
        bounds.BODY.require(f"{field}.{name}", column.values[np.isfinite(column.values)])
    return Measured(time=when.values, names=tuple(table), values=values)


def _require(column: Column, allowed: Bounds, field: str) -> None:
    for row, value in enumerate(column.values):
        if not allowed.least <= value <= allowed.most * (1.0 + 1e-12):
            raise InputError(
                field,
                column.shown(row),
                allowed=f"{allowed.low:g}..{allowed.high:g} {allowed.unit}",
            )


def _require_torque(column: Column, case: GearCase, field: str) -> None:
    most = crushing_torque(case.pair)
    for row, value in enumerate(column.values):
        if not 0.0 <= value <= most:
            why = (
                f"above it more than {1e-9 * CRUSHING:g} GPa between the flanks, where no steel "
                "stays elastic"
            )
            raise InputError(
                field,
                column.shown(row),
                allowed=f"0..{most:.4g} N m",
                why=why if value > most else "the pinion drives; a stop is 0",
            )


def _require_air(case: GearCase, value: float, field: str, got: str) -> None:
    oil = case.stated.lubricant
    low, high = oil.temperature_range
    if not low <= value <= high:
        raise InputError(
            field,
            got,
            allowed=f"{low - ZERO_CELSIUS:g}..{high - ZERO_CELSIUS:g} degC",
            why=f"the range of the viscosity line of {oil.name}",
        )
