"""The page of several records beside a baseline."""

from __future__ import annotations

from functools import partial
from typing import Any

from thermogear.results.result import Result
from thermogear.views.page import Page, Pictures, Section, Table
from thermogear.views.plots import records as plots

KINDS = ("records",)
_SHOWN = 200


def page(result: Result) -> Page:
    """What changed beyond its uncertainty, the course of the lines, trends."""
    found = result.table("figures")
    data = result.group("records")
    sections = []
    if data is not None and data.sizes["record"] > 1:
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
        ]
        for one in found.get("changed", [])[:_SHOWN]
    ]
    head: list[Any] = ["record", "channel", "line", "reading", "change [%]", "± [%]"]
    if rows:
        sections.append(
            Section("changed", "Changed", [Table("Beyond the 95 % interval.", head, rows, names=3)])
        )
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


def _half(one: dict[str, Any], name: str) -> float:
    """The half width of a change or a trend; results of older versions call it otherwise."""
    return float(one.get(f"{name}_half_width", one.get("half_width", 0.0)))


def summary(found: dict[str, Any]) -> str:
    """How many of the lines changed, in a sentence."""
    changed, compared = len(found.get("changed", [])), found.get("compared", 0)
    chance = 0.05 * compared
    return (
        f"{changed} of {compared} lines differ from {found.get('baseline', '')} beyond their 95 % "
        f"intervals; {chance:.3g} would by chance where nothing changed and intervals are exact."
    )


def lines(result: Result) -> list[str]:
    """Refusals, what changed, trends, the summary."""
    found = result.table("figures")
    told = [f"{one.level}: {one.text}" for one in result.notices]
    for one in found["changed"]:
        told.append(
            f"{one['record'][:24]:24} {one['channel'][:12]:12} {one['name'][:22]:22} "
            f"{one['reading']:10.5g} {100 * one['change']:+8.2f} % +- "
            f"{100 * _half(one, 'change'):.2f}"
        )
    for one in found["trends"]:
        told.append(
            f"trend of {one['channel']}, {one['name']}: {100 * one['trend']:+.3g} % a record +- "
            f"{100 * _half(one, 'trend'):.2g}"
        )
    return [*told, summary(found)]
