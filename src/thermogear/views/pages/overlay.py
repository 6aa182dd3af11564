"""The page of two orbit diagrams over each other, with the bifurcations of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from thermogear.base.arrays import Dataset
from thermogear.results.result import Result
from thermogear.results.tables import table_text
from thermogear.views.columns import Column, declared, in_full
from thermogear.views.page import LEAD, Page, Pictures, Section, Table, Text
from thermogear.views.pages.findings import finding
from thermogear.views.pages.sweeps import bifurcations, numbers
from thermogear.views.plots.sweeps import overlay_picture, state_of

KINDS = ("overlay",)
CAPTION = (
    "Sections at phase 0 of the settled motion in both states, up and down; branches from "
    "continuation. The largest Lyapunov exponent below."
)


def page(result: Result) -> Page:
    """One picture, one table."""
    data, states = result.data, result.values("states")
    pictures = Pictures()
    pictures.add(
        "orbits", "Both orbit diagrams", CAPTION, data, (),
        lambda: overlay_picture(data, states), wide=True,
    )  # fmt: skip
    table = table_of(data, states)
    sections = [Section(LEAD, "In pictures", pictures.take(), folded=False)]
    if table.rows:
        sections.append(Section("bifurcations", "Bifurcations", [table]))
    parts = [f"{words}: {finding(state_of(data, i))}" for i, words in enumerate(states)]
    return Page(
        result, " ".join(parts), sections,
        numbers=lambda: _numbers(result),
        told=lambda: [*map(Text, parts), *[table] * bool(table.rows)],
        tables=lambda: {"overlay_bifurcations.csv": table_text(table.head, table.figures)},
    )  # fmt: skip


def _numbers(result: Result) -> dict[str, Any]:
    """Both diagrams, in the units shown."""
    data, name = result.data, str(result.data.attrs["parameter"])

    def alone(place: int) -> dict[str, Any]:
        part = replace(result, kind="diagram", groups={"": state_of(data, place)})
        return numbers(part.with_(parameter=name))

    return {
        "parameter": name, "states": result.values("states"), "one": alone(0), "other": alone(1),
    }  # fmt: skip


def _located(data: Dataset, states: Sequence[str]) -> tuple[list[Column], list[dict[str, Any]]]:
    """Columns and rows of the bifurcations of all ``states``."""
    each = [bifurcations(state_of(data, place)) for place in range(len(states))]
    columns = [Column("state", "state", key="state"), *each[0][0]]
    rows = [
        {**row, "state": words} for words, (_, of) in zip(states, each, strict=True) for row in of
    ]
    return columns, rows


def table_of(data: Dataset, states: Sequence[str]) -> Table:
    """The located bifurcations of all ``states``."""
    return declared("Located bifurcations", *_located(data, states))


def located(data: Dataset, states: Sequence[str]) -> list[dict[str, Any]]:
    """The located bifurcations of all ``states``, JSON-ready."""
    columns, rows = _located(data, states)
    return [in_full(columns, row) for row in rows]
