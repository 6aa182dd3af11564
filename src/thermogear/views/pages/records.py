"""The page of several records beside a baseline."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.units import RPM
from thermogear.results.result import Result
from thermogear.views.page import Page, Pictures, Section, Table
from thermogear.views.plots import records as plots

if TYPE_CHECKING:
    import xarray as xr

KINDS = ("records",)
_SHOWN = 200
_STEADY = 0.02  # relative change of speed, up to which the table of speeds is folded


def page(result: Result) -> Page:
    """What changed beyond its uncertainty, the course of the lines, trends."""
    found = result.table("figures")
    data = result.group("records")
    sections = []
    if data is not None and _is_compared(data):
        pictures = Pictures()
        pictures.add(
            "course",
            "From record to record",
            "The lines that changed most for their uncertainty, of those known to ±50 % if there "
            "are any; shaded: 95 % intervals.",
            data,
            ["record_line_change", "record_line_change_half_width"],
            partial(plots.course, data),
            wide=True,
        )
        sections.append(Section("course", "Course", pictures.take(), folded=False))
    rows: list[list[Any]] = [
        [
            one["record"],
            one["channel"],
            one["name"],
            f"{one['reading']:.5g}",
            f"{100 * one['change']:+.2f}",
            f"{100 * _half(one, 'change'):.2f}",
            *_speed(one),
        ]
        for one in found.get("changed", [])[:_SHOWN]
    ]
    unit = found.get("units", {}).get("reading") or "the file's"
    head: list[Any] = ["record", "channel", "line", f"reading [{unit}]", "change [%]", "± [%]"]
    head += ["speed [rpm]", "mesh line [Hz]"]
    if rows:
        sections.append(
            Section("changed", "Changed", [Table("Beyond the 95 % interval.", head, rows, names=3)])
        )
    if found.get("speeds"):
        sections.append(_speeds(found))
    rows = [
        [
            one["channel"],
            one["name"],
            f"{100 * one['trend']:+.3g}",
            f"{100 * _half(one, 'trend'):.2g}",
        ]
        for one in found.get("trends", [])[:_SHOWN]
    ]
    if rows:
        words = "A straight line over the records; beyond its 95 % interval."
        head = ["channel", "line", "trend [%/record]", "± [%/record]"]
        sections.append(Section("trends", "Trends", [Table(words, head, rows, names=2)]))
    return Page(
        result,
        summary(found),
        sections,
        numbers=lambda: found,
        lines=lambda: lines(result),
    )


def _is_compared(data: xr.Dataset) -> bool:
    """Whether a line of any record has a change against the baseline's."""
    known = np.isfinite(data["record_line_change"].values)
    return bool(np.any(known.sum(axis=0) > 1))


def _speeds(found: dict[str, Any]) -> Section:
    """Speed and mesh line of every record, and whether its lines are the baseline's."""
    rows = [
        [
            one["record"],
            *_speed(one),
            _cell(one["speed_ratio"], 1.0, 4),
            str(one["compared"]),
        ]
        for one in found["speeds"][:_SHOWN]
    ]
    words = (
        "Speed of the first shaft and frequency of the mesh line found. The level of a mesh line "
        "changes with speed. Where nothing tells whether a line is the baseline's, its change is "
        "withheld. – : the record does not tell."
    )
    ratio = f"speed over that of {found['baseline']} [–]"
    head: list[Any] = ["record", "speed [rpm]", "mesh line [Hz]", ratio, "lines compared [–]"]
    off = [one for one in found["speeds"] if abs((one["speed_ratio"] or 1.0) - 1.0) > _STEADY]
    return Section(
        "speeds", "Speeds", [Table(words, head, rows)], folded=not (found["apart"] or off)
    )


def _speed(one: dict[str, Any]) -> list[str]:
    """Speed [rpm] and mesh line [Hz] of a row; results of older versions hold neither."""
    return [_cell(one.get("shaft_speed"), RPM, 5), _cell(one.get("mesh_frequency"), 1.0, 6)]


def _cell(value: float | None, unit: float, digits: int) -> str:
    return "–" if value is None else f"{value / unit:.{digits}g}"


def _half(one: dict[str, Any], name: str) -> float:
    """The half width of a change or a trend; results of older versions call it otherwise."""
    return float(one.get(f"{name}_half_width", one.get("half_width", 0.0)))


def _turning(one: dict[str, Any]) -> str:
    """Speed and mesh line of a row, with their units."""
    rpm, hertz = _speed(one)
    told = [f"{rpm} rpm"] if rpm != "–" else []
    told += [f"mesh line at {hertz} Hz"] if hertz != "–" else []
    return f" {', '.join(told)}" if told else ""


def summary(found: dict[str, Any]) -> str:
    """How many of the lines changed, in a sentence."""
    changed, compared = len(found.get("changed", [])), found.get("compared", 0)
    chance = 0.05 * compared
    apart = len(found.get("apart", []))
    withheld = (
        f" Changes of {apart} record{'s' * (apart > 1)} are withheld, all or some." if apart else ""
    )
    return (
        f"{changed} of {compared} lines differ from {found.get('baseline', '')} beyond their 95 % "
        f"intervals; {chance:.3g} would by chance where nothing changed and intervals are exact."
        f"{withheld}"
    )


def lines(result: Result) -> list[str]:
    """Refusals, what changed, trends, the summary."""
    found = result.table("figures")
    told = [f"{one.level}: {one.text}" for one in result.notices]
    for one in found["changed"]:
        told.append(
            f"{one['record'][:24]:24} {one['channel'][:12]:12} {one['name'][:22]:22} "
            f"{one['reading']:10.5g} {100 * one['change']:+8.2f} % +- "
            f"{100 * _half(one, 'change'):<6.2f}{_turning(one)}"
        )
    for one in found["trends"]:
        told.append(
            f"trend of {one['channel']}, {one['name']}: {100 * one['trend']:+.3g} % a record +- "
            f"{100 * _half(one, 'trend'):.2g}"
        )
    return [*told, summary(found)]
