"""One self-contained page from one ``results.nc``."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from thermogear.base.files import put
from thermogear.results.result import Results, read_results
from thermogear.views import gear_sections, opening, row_sections, tables
from thermogear.views.closing import closing
from thermogear.views.page import Pictures, Section, render

REPORT = "report.html"

ORDER = (
    gear_sections.friction,
    gear_sections.heat,
    gear_sections.gap,
    gear_sections.springs,
    gear_sections.vibration,
    gear_sections.row,
    row_sections.base_sets,
    row_sections.points,
)
"""The sections between key results and closing, in the order of the page."""


def write_report(directory: str | Path) -> Path:
    """Draw ``directory/report.html`` from ``directory/results.nc`` alone; the page's path.

    The page needs no other file, no script and no network; the same results give the same
    page. Raises InputError, in one line, where the results are missing, damaged or not ours.
    """
    directory = Path(directory)
    return put(directory / REPORT, page(read_results(directory)))


def page(results: Results) -> str:
    """The whole page as text."""
    results = with_hot_temperature(results)
    return render(
        title=results.text("title") or "thermogear",
        summary=opening.summary(results),
        tiles=opening.tiles(results),
        notices=results.rows("notices"),
        sections=_sections(results),
        version=results.text("thermogear"),
    )


def _sections(results: Results) -> list[Section]:
    found: list[Section] = []
    mesh = results.group("mesh")
    if mesh is not None:
        table = tables.key_results(mesh, results.group("path"), results.group("motion"))
        found.append(Section("results", "Key results", [table]))
    for make in ORDER:
        section = make(results, Pictures())
        if section is not None:
            found.append(section)
    return found + closing(results)


def with_hot_temperature(results: Results) -> Results:
    """The mesh's figures with both tips' temperatures of the same points beside them."""
    path, mesh = results.group("path"), results.group("mesh")
    if path is None or mesh is None or "pinion_body_temperature" not in path:
        return results
    tip: xr.DataArray = path["pinion_body_temperature"].isel(path_position=-1, drop=True)
    grown = mesh.assign(hot_temperature=tip.variable)
    if "wheel_body_temperature" in path:
        other = path["wheel_body_temperature"].isel(path_position=0, drop=True)
        grown = grown.assign(hot_wheel_temperature=other.variable)
    return Results(results.texts, {**results.groups, "mesh": grown})
