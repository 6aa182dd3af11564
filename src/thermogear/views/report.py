"""One self-contained page from one ``results.nc``."""

from __future__ import annotations

from pathlib import Path

import jinja2
import xarray as xr
from markupsafe import Markup

from thermogear.views import gear_sections, opening, row_sections, tables
from thermogear.views.closing import closing
from thermogear.views.page import Pictures, Section
from thermogear.views.results import Results, put, read_results
from thermogear.views.words import prose

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

LEVELS = {"important": "Important", "warning": "Mind", "info": "Note"}


def write_report(directory: Path) -> Path:
    """Draw ``directory/report.html`` from ``directory/results.nc`` alone; the page's path.

    The page needs no other file, no script and no network; the same results give the same
    page. Raises InputError, in one line, where the results are missing, damaged or not ours.
    """
    directory = Path(directory)
    return put(directory / REPORT, page(read_results(directory)))


def page(results: Results) -> str:
    """The whole page as text."""
    results = _with_hot_temperature(results)
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("thermogear.views"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    sheet, _, _ = environment.loader.get_source(environment, "page.css")  # type: ignore[union-attr]
    return environment.get_template("report.html").render(
        title=" ".join(results.text("title").split()) or "thermogear",
        style=Markup(sheet),
        summary=opening.summary(results),
        tiles=opening.tiles(results),
        notices=_notices(results),
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


def _notices(results: Results) -> list[tuple[str, str, Markup]]:
    """(level, its word, text) of every notice, most important first."""
    rows = results.rows("notices")
    order = list(LEVELS)
    levels = [level if (level := str(row.get("level"))) in LEVELS else "info" for row in rows]
    pairs = sorted(zip(levels, rows, strict=True), key=lambda pair: order.index(pair[0]))
    return [(level, LEVELS[level], prose(row.get("text", ""))) for level, row in pairs]


def _with_hot_temperature(results: Results) -> Results:
    """The mesh's figures with the pinion's tip temperature of the same points beside them."""
    path, mesh = results.group("path"), results.group("mesh")
    if path is None or mesh is None or "pinion_body_temperature" not in path:
        return results
    tip: xr.DataArray = path["pinion_body_temperature"].isel(path_position=-1, drop=True)
    grown = mesh.assign(hot_temperature=tip.variable)
    return Results(results.texts, {**results.groups, "mesh": grown})
