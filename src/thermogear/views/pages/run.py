"""The page of a run: a gear pair from friction to motion, or rows of the dimensionless equation."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from thermogear.results.result import Result
from thermogear.views import tables
from thermogear.views.csv_files import curve_tables
from thermogear.views.page import OPEN, Page, Pictures, Section, notice_lines
from thermogear.views.pages import (
    answers,
    dial,
    drawn,
    flank_sections,
    gear_sections,
    headline,
    row_sections,
    shafts,
    train_motion,
)
from thermogear.views.pages.background import background
from thermogear.views.pages.run_numbers import numbers

if TYPE_CHECKING:
    import xarray as xr

ORDER = (
    shafts.section,
    drawn.section,
    flank_sections.measured,
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
        first=(*FIRST, *flank_sections.first(result)),
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
