"""The page of a run: a gear pair from friction to motion, or rows of the dimensionless equation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING, Any

from thermogear.base.display import SPEED
from thermogear.base.vocabulary import DIMENSIONLESS
from thermogear.results.result import Result
from thermogear.views import tables
from thermogear.views.columns import Row, rows_along
from thermogear.views.csv_files import curve_tables
from thermogear.views.page import OPEN, Page, Pictures, Section, notice_lines
from thermogear.views.pages import (
    answers,
    dial,
    drawn,
    gear_sections,
    headline,
    row_sections,
    shafts,
    train_motion,
)
from thermogear.views.pages.background import background

if TYPE_CHECKING:
    import xarray as xr


def numbers(result: Result) -> dict[str, Any]:
    """The figures a script wants, JSON-ready (non-finite numbers are None)."""
    found: dict[str, Any] = {
        "thermogear": result.text("thermogear"),
        "title": result.title,
        "kind": result.kind,
        "answers": [one.row for one in result.answers],
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


ORDER = (
    shafts.section,
    drawn.section,
    gear_sections.measured,
    gear_sections.friction,
    gear_sections.heat,
    gear_sections.gap,
    gear_sections.springs,
    gear_sections.vibration,
    train_motion.section,
    dial.section,
    gear_sections.row,
    row_sections.base_sets,
    row_sections.points,
)
"""The sections between key results and closing, in the order of the page."""


FIRST = (
    ("sketch",),
    ("gears", "gap-temperature", "gap-phase"),
    ("dial", "stiffness-0"),
    ("dynamic-factor",),
    ("flash-own", "flash-mixed", "friction"),
    ("train-motion-0", "motion-0-0"),
)
"""The pictures that carry the answers: shafts, gears or gap, heat, speeds, friction, motion."""
KINDS = ("gear", "dimensionless")


def page(result: Result) -> Page:
    """Friction, temperature, gap, springs and vibration, and what they rest on."""
    whole = with_hot_temperature(result)
    return Page(
        result,
        answers.summary(result) or headline.summary(whole),
        _sections(whole),
        tiles=headline.tiles(whole),
        numbers=lambda: numbers(result),
        lines=lambda: [
            *answers.lines(result),
            *train_motion.lines(result),
            *notice_lines(result, OPEN if result.answers else None),
        ],
        tables=lambda: curve_tables(result),
        first=(*FIRST, *gear_sections.first(result)),
    )


def _sections(results: Result) -> list[Section]:
    pictures = Pictures()
    found = answers.sections(results, pictures)
    mesh = results.group("mesh")
    if mesh is not None:
        table = tables.key_results(mesh, results.group("path"), results.group("motion"))
        found.append(Section("results", "Key results", [table]))
    for make in ORDER:
        section = make(results, pictures)
        if section is not None:
            found.append(section)
    return found + background(results)


def with_hot_temperature(results: Result) -> Result:
    """The mesh's figures with both tips' temperatures of the same points beside them."""
    path, mesh = results.group("path"), results.group("mesh")
    if path is None or mesh is None or "pinion_body_temperature" not in path:
        return results
    tip: xr.DataArray = path["pinion_body_temperature"].isel(path_position=-1, drop=True)
    grown = mesh.assign(hot_temperature=tip.variable)
    if "wheel_body_temperature" in path:
        other = path["wheel_body_temperature"].isel(path_position=0, drop=True)
        grown = grown.assign(hot_wheel_temperature=other.variable)
    return replace(results, groups={**results.groups, "mesh": grown})
