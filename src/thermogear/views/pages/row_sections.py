"""Sections for rows of the dimensionless equation: base sets, or a case of its own."""

from __future__ import annotations

from thermogear.base.arrays import Dataset
from thermogear.base.display import number
from thermogear.results.result import Result
from thermogear.views import tables
from thermogear.views.page import Block, Pictures, Section, Text
from thermogear.views.plots import rows

PREFIX = "base_sets/"


def base_sets(results: Result, pictures: Pictures) -> Section | None:
    """Every base set beside the rig's own numbers."""
    names = [name for name in results.groups if name.startswith(PREFIX)]
    if not names:
        return None
    mesh = results.group("mesh")
    blocks: list[Block] = [
        Text(
            "These sets of numbers are not derived from the rig. They were found by search, so "
            "that the equation of motion shows what the thesis describes; the rig's own numbers "
            "stand beside them and lie elsewhere.",
            "note",
        )
    ]
    for place, name in enumerate(names):
        points = results.groups[name]
        short = name.removeprefix(PREFIX)
        title = str(points.attrs.get("title", short))
        blocks.append(Text(title, "title"))
        blocks += _rows(points, pictures, f"base-{place}")
        blocks.append(tables.numbers_beside(points, mesh, short))
    return Section("base-sets", "Base sets of the equation of motion", blocks)


def points(results: Result, pictures: Pictures) -> Section | None:
    """The rows of a dimensionless case."""
    data = results.group("points")
    if data is None:
        return None
    blocks = _rows(data, pictures, "points")
    blocks.append(tables.numbers_beside(data, None, "case"))
    return Section("motion", "Motion", blocks)


def _rows(data: Dataset, pictures: Pictures, prefix: str) -> list[Block]:
    """Picture and table of every row, then the half-order line where temperatures run."""
    needs = ("scaled_displacement", "scaled_velocity", "section_displacement", "line_amplitude")
    width = float(data.attrs.get("bin_width_orders", 0.0))
    blocks: list[Block] = []
    for place, row in enumerate(rows.row_names(data)):
        pictures.add(
            f"{prefix}-{place}", f"Row {row}",
            "From above: time history; orbit and Poincaré section over the gap in which no teeth "
            f"touch; spectrum, bin width {number(width)} of the mesh frequency, half orders "
            "dotted.",
            data, needs, lambda r=row: rows.panels(data, r), wide=True,  # type: ignore[misc]
        )  # fmt: skip
        blocks += [*pictures.take(), tables.row_table(data, row)]
    return blocks
