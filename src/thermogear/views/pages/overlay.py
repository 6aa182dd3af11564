"""The page of two orbit diagrams over each other, and of what became of each bifurcation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from thermogear.base.display import PERCENT, Display, number
from thermogear.base.parameters import Parameter
from thermogear.results.result import Result
from thermogear.views.columns import Column, declared
from thermogear.views.csv_files import table_text
from thermogear.views.page import LEAD, Page, Pictures, Section, Table, Text
from thermogear.views.pages.findings import finding
from thermogear.views.pages.sweeps import numbers
from thermogear.views.plots.parameters import parameter_of
from thermogear.views.plots.sweeps import overlay_picture, state_of

KINDS = ("overlay",)
PLACES = ("one", "other", "met")
CAPTION = (
    "Sections at phase 0 of the settled motion in both states, up and down; branches from "
    "continuation, and thin lines from a bifurcation to the same one in the other state. The "
    "largest Lyapunov exponent below."
)
FOLLOWED = (
    "Each bifurcation is followed while every coefficient of the equation goes from one state to "
    "the other; neither order nor nearness makes a pair. Where two of one state meet on the way, "
    "neither has a partner."
)


def page(result: Result) -> Page:
    """One picture, one table."""
    data, states = result.data, result.values("states")
    pictures = Pictures()
    pictures.add(
        "orbits", "Both orbit diagrams", CAPTION, data, (),
        lambda: overlay_picture(data, states, result.rows("matches")), wide=True,
    )  # fmt: skip
    table = table_of(result)
    sections = [Section(LEAD, "In pictures", pictures.take(), folded=False)]
    if table.rows:
        sections.append(Section("matches", "Bifurcations", [table]))
    parts = [f"{words}: {finding(state_of(data, i))}" for i, words in enumerate(states)]
    return Page(
        result, " ".join((*parts, _headline(result))), sections,
        numbers=lambda: _numbers(result),
        told=lambda: [*map(Text, parts), Text(_headline(result)), *[table] * bool(table.rows)],
        tables=lambda: {
            "overlay_bifurcations.csv": table_text([*map(str, table.head)], table.figures)
        },
    )  # fmt: skip


def _headline(result: Result) -> str:
    rows = result.rows("matches")
    if not rows:
        return "No bifurcation is located in either state."
    matched = sum(row["partner"] == "matched" for row in rows)
    return f"{matched} of {len(rows)} bifurcations were followed from one state to the other."


def _numbers(result: Result) -> dict[str, Any]:
    """Both diagrams, and what became of each bifurcation, in the units shown."""
    data, name = result.data, str(result.data.attrs["parameter"])

    def alone(place: int) -> dict[str, Any]:
        part = replace(result, kind="diagram", groups={"": state_of(data, place)})
        return numbers(part.with_(parameter=name))

    return {
        "parameter": name, "states": result.values("states"),
        "one": alone(0), "other": alone(1), "moved": _moved(result),
    }  # fmt: skip


def _parameter(result: Result) -> Parameter:
    name = str(result.data.attrs["parameter"])
    return parameter_of(name, result.data[name])


def _moved(result: Result) -> list[dict[str, Any]]:
    """The matches with their values as shown, and how far each moved."""
    parameter, rows = _parameter(result), []
    for row in result.rows("matches"):
        at = {k: None if row[k] is None else float(parameter.show(row[k])) for k in PLACES}
        moved = None if at["one"] is None or at["other"] is None else at["other"] - at["one"]
        rows.append({**row, **at, "moved": moved})
    return rows


def table_of(result: Result) -> Table:
    """The bifurcations of both states, and in words what became of each on the way."""
    unit = Display(_parameter(result).shown)
    names = zip((*result.values("states"), "moved by"), ("one", "other", "moved"), strict=True)
    columns = (
        Column("kind", "kind"),
        Column("period", "period"),
        *(Column(words, name, 9, unit) for words, name in names),
        Column("on the way", partial(_became, unit=unit.unit)),
    )
    return declared(FOLLOWED, columns, _moved(result))


def _became(row: Mapping[str, Any], unit: str) -> str:
    """What became of a bifurcation on the way to the other state."""
    share = row["share"] if row["one"] is not None else 1.0 - row["share"]
    at = f"at {number(PERCENT(share), 3)} % of the way"
    if row["partner"] == "matched":
        return "" if row["drawn"] else "its branch is not among those drawn"
    if row["partner"] == "meets another":
        return f"meets the one at {number(row['met'], 9)} {unit}".rstrip() + f" {at}: no partner"
    if row["partner"] == "leaves the range":
        return f"leaves the range {at}: no partner in it"
    return f"not followed beyond, {at}: {row['why']}"
