"""Small tables of a user: the duty of a pair, and temperatures measured over it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.base import bounds
from thermogear.base.bounds import Bounds
from thermogear.base.errors import InputError
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.case import GearCase
from thermogear.case.columns import Column, read_columns, require_times
from thermogear.case.gearbox_schema import NODES
from thermogear.case.ranges import CRUSHING, crushing_torque
from thermogear.case.sensors import SENSORS
from thermogear.mesh.warm_up import Duty

KINDS = {
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
    table = read_columns(path, field, KINDS, ("time", "speed", "torque"), gaps=False)
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
        _require_ambient(ambient, case, f"{field}.ambient")
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


def _require_ambient(column: Column, case: GearCase, field: str) -> None:
    for row, value in enumerate(column.values):
        _require_air(case, value, field, column.shown(row))


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
