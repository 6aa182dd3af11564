"""The page of a run: a gear pair from friction to motion, or rows of the dimensionless equation."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

from thermogear.base.arrays import DataArray, Dataset
from thermogear.base.display import SPEED
from thermogear.base.vocabulary import DIMENSIONLESS, told_labels
from thermogear.results.result import Result
from thermogear.results.tables import csv_tables
from thermogear.views import tables
from thermogear.views.columns import Column, in_full, key, rows_along, units
from thermogear.views.page import OPEN, Page, Pictures, Section
from thermogear.views.pages import (
    answers,
    dial,
    drawn,
    gear_sections,
    row_sections,
    shafts,
    train_motion,
)
from thermogear.views.pages.background import background


def numbers(result: Result) -> dict[str, Any]:
    """The figures a script wants (non-finite numbers are None)."""
    groups = result.groups
    found: dict[str, Any] = {"answers": [one.row for one in result.answers]}
    if "mesh" in groups:
        operating = ("bundle", "state", "operating")
        data = _operating(groups)
        found["operating"] = _rows(data, AT_STATE, *operating)
        found["units"] = units(AT_STATE, data)
    if "temperature" in groups:
        operating = ("bundle", "gear_temperature", "operating")
        found["temperature_row"] = _rows(groups["temperature"], AT_TEMPERATURE, *operating)
    sets = {
        name.split("/")[-1]: _rows(data, OF_POINT, "point")
        for name, data in groups.items()
        if name.split("/")[0] in ("points", "base_sets")
    }
    return found | ({"points": sets} if sets else {}) | answers.of_series(result)


def _rows(data: Dataset, columns: Sequence[Column], *dims: str) -> list[dict[str, Any]]:
    """The numbers of every place, as far as they are stored."""
    there = [column for column in columns if column.key in data or column.value in data]
    return [in_full(there, row) for row in rows_along(data, *dims)]


def _count(name: str) -> Column:
    """A count, None where there is none."""
    return key(name, lambda row: int(row[name]) if isfinite(row[name]) else None)


FOLLOWED = (_count("followed_periods"), _count("followed_starts"))
MOTION = (
    key("label"),
    key("dte_peak_to_peak"),
    key("peak_to_peak_displacement"),
    key("half_order_amplitude"),
    key("contact_loss_share"),
    *FOLLOWED,
)
FIGURES = (
    key("bundle"),
    key("pinion_speed_rpm", "pinion_speed", SPEED),
    key("status"),
    key("mean_stiffness"),
    key("peak_to_peak_stiffness"),
    key("half_backlash"),
    key("least_half_backlash"),
    key("cold_half_backlash"),
    key("jam_temperature"),
    key("proportional_jam_temperature"),
    key("edge_contact_share"),
    key("natural_frequency"),
    *map(key, DIMENSIONLESS[1:]),
    *MOTION,
)
AT_STATE = (
    key("state"),
    key("pinion_torque_Nm", "pinion_torque"),
    key("greatest_flash_temperature_K", "greatest_flash_temperature"),
    key("greatest_friction", "friction"),
    *FIGURES,
)
AT_TEMPERATURE = (key("gear_temperature_K", "gear_temperature"), *FIGURES)
OF_POINT = (
    key("row"),
    key("parameter"),
    key("value"),
    key("unit", "value_unit"),
    key("reason", "label_reason"),
    key("expected"),
    key("label"),
    key("half_order_amplitude"),
    *FOLLOWED,
)


def _operating(groups: Mapping[str, Dataset]) -> Dataset:
    """The figures of the mesh with the extremes along the path and those of the motion."""
    path, motion = groups["path"], groups.get("motion")
    data = groups["mesh"].assign(
        friction=path["friction_coefficient"].max("path_position"),
    )
    if motion is None or "label" not in motion:
        return data
    return data.assign({one.key: motion[one.key] for one in MOTION if one.key in motion})


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
        answers.summary(result) or rows_summary(result),
        _sections(whole),
        numbers=lambda: numbers(result),
        told=lambda: [*answers.told(result), *train_motion.told(result)],
        most=OPEN if result.answers else None,
        tables=lambda: csv_tables(result.groups, "csv/"),
        first=(*FIRST, *gear_sections.first(result)),
    )


def rows_summary(result: Result) -> str:
    """How many points of the dimensionless equation there are, and which motions."""
    points = result.group("points")
    if points is None:
        return ""
    found = Counter(map(str, told_labels(points).flat))
    motions = ", ".join(f"{count} × {name}" for name, count in found.most_common())
    return (
        f"{points.sizes['point']} points of the dimensionless equation of motion; found: "
        f"{motions}. These numbers are not derived from any gear pair."
    )


def _sections(results: Result) -> list[Section]:
    pictures = Pictures()
    found = answers.sections(results, pictures)
    mesh = results.group("mesh")
    if mesh is not None:
        table = tables.key_results(mesh, results.group("motion"), results.group("series"))
        found.append(Section("results", "Key results", [table]))
    for make in ORDER:
        section = make(results, pictures)
        if section is not None:
            found.append(section)
    return found + background(results)


def with_hot_temperature(results: Result) -> Result:
    """The mesh's figures with the temperature of the pinion's tip beside them."""
    path, mesh = results.group("path"), results.group("mesh")
    if path is None or mesh is None or "pinion_body_temperature" not in path:
        return results
    tip: DataArray = path["pinion_body_temperature"].isel(path_position=-1, drop=True)
    grown = mesh.assign(hot_temperature=tip.variable)
    return replace(results, groups={**results.groups, "mesh": grown})
