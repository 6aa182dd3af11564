"""The figures of a run that a script wants: one row for each bundle, state and point."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any

from thermogear.base.display import SPEED
from thermogear.base.vocabulary import DIMENSIONLESS
from thermogear.results.result import Result
from thermogear.views.columns import Row, rows_along

if TYPE_CHECKING:
    import xarray as xr


def numbers(result: Result) -> dict[str, Any]:
    """The figures a script wants, JSON-ready (non-finite numbers are None)."""
    found: dict[str, Any] = {
        "thermogear": result.text("thermogear"),
        "title": result.title,
        "kind": result.kind,
        "answers": [one.row for one in result.answers],
        "notices": [one.as_dict() for one in result.notices],
    }
    groups = result.groups
    if "mesh" in groups:
        found["operating"] = _operating_summary(groups)
    if "temperature" in groups:
        found["temperature_row"] = _temperature_summary(groups["temperature"])
    sets = {
        name: data for name, data in groups.items() if name.split("/")[0] in ("points", "base_sets")
    }
    if sets:
        found["points"] = {name.split("/")[-1]: _point_summary(data) for name, data in sets.items()}
    return found


FIGURES = (
    "mean_stiffness",
    "peak_to_peak_stiffness",
    "half_backlash",
    "least_half_backlash",
    "cold_half_backlash",
    "jam_temperature",
    "proportional_jam_temperature",
    "edge_contact_share",
    "natural_frequency",
    *DIMENSIONLESS[1:],
)
FOLLOWED = ("followed_periods", "followed_starts")
MOTION_FIGURES = (
    "dte_peak_to_peak",
    "peak_to_peak_displacement",
    "half_order_amplitude",
    "contact_loss_share",
    *FOLLOWED,
)


def _of_point(row: Row) -> dict[str, Any]:
    """The figures of a mesh and of its motion, as far as they are there."""
    found = {name: float(row[name]) for name in FIGURES if name in row}
    if "label" in row:
        found["label"] = row["label"]
        found |= {name: float(row[name]) for name in MOTION_FIGURES if name in row}
    return found


def _operating_summary(groups: Mapping[str, xr.Dataset]) -> list[dict[str, Any]]:
    path, motion = groups["path"], groups.get("motion")
    data = groups["mesh"].assign(
        flash=path["flash_temperature"].max("path_position"),
        friction=path["friction_coefficient"].max("path_position"),
    )
    if motion is not None and "label" in motion:
        data = data.assign({n: motion[n] for n in ("label", *MOTION_FIGURES) if n in motion})
    return [
        {
            "bundle": row["bundle"],
            "state": row["state"],
            "pinion_speed_rpm": SPEED(row["pinion_speed"]),
            "pinion_torque_Nm": row["pinion_torque"],
            "status": row["status"],
            "greatest_flash_temperature_K": row["flash"],
            "greatest_friction": row["friction"],
            **_of_point(row),
        }
        for row in rows_along(data, "bundle", "state", "operating")
    ]


def _temperature_summary(data: xr.Dataset) -> list[dict[str, Any]]:
    return [
        {
            "bundle": row["bundle"],
            "gear_temperature_K": row["gear_temperature"],
            "pinion_speed_rpm": SPEED(row["pinion_speed"]),
            "status": row["status"],
            "label": row["label"],
            **_of_point(row),
        }
        for row in rows_along(data, "bundle", "gear_temperature", "operating")
    ]


def _count(number: float) -> int | None:
    """A count, None where there is none."""
    return int(number) if isfinite(number) else None


def _point_summary(points: xr.Dataset) -> list[dict[str, Any]]:
    return [
        {
            "row": row["row"],
            "parameter": row["parameter"],
            "value": row["value"],
            "unit": row["value_unit"],
            "label": row["label"],
            "reason": row["label_reason"],
            **{name: _count(row[name]) for name in FOLLOWED if name in row},
            "expected": row["expected"],
            "half_order_amplitude": row["half_order_amplitude"],
        }
        for row in rows_along(points, "point")
    ]
