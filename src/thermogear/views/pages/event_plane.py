"""What is said of bifurcations followed in a second parameter: tables, lines, a caption."""

from __future__ import annotations

from typing import Any

from thermogear.views.columns import Column, Row, declared
from thermogear.views.page import Block, Text
from thermogear.views.plots.parameters import page_words

Summary = dict[str, Any]
SECOND = "second_shown"
PLANE = "Where the motion jumps or changes"


def shown(point: Row, digits: int = 8, which: str = "shown") -> str:
    """The value of a point with its unit, of the first or the second parameter."""
    return f"{point[which]:.{digits}g} {point[f'{which}_unit']}".strip()


def _turns(curve: Row) -> list[str]:
    """Where a curve turns back, in both parameters."""
    return [f"{shown(one, 6)} at {shown(one, 6, SECOND)}" for one in curve["turns"]]


def plane_headline(summary: Summary) -> str:
    """How many were followed; "" without a second parameter."""
    if "curves" not in summary:
        return ""
    count = len(summary["curves"])
    return f"{count} followed in a second parameter." if count else "None followed further."


def plane_caption(summary: Summary) -> str:
    """What the plane shows: only what is drawn in it."""
    words = ["A motion that crosses a solid line changes there"]
    if any(not one["stable"] for curve in summary["curves"] for one in curve["asked"]):
        words.append("dotted: the orbit is unstable already, so that no motion meets it")
    return "; ".join(words) + ". Marks: at the values asked for."


def plane_tables(summary: Summary) -> list[Block]:
    """The curves at the values asked for, and how each ended."""
    if "curves" not in summary:
        return []
    second = page_words(summary["second"])
    if not summary["curves"]:
        return [Text(f"No bifurcation was followed in the second parameter, {second}.")]
    curves = [
        {**curve, "name": f"{number} {curve['kind']}, period {curve['period']}"}
        for number, curve in enumerate(summary["curves"], start=1)
    ]
    points = (
        Column("curve", "name"),
        Column(second, lambda point: shown(point, 6, SECOND)),
        Column(page_words(summary["parameter"]), shown),
        Column("", lambda point: "" if point["stable"] else "on an unstable orbit"),
    )
    ends = (
        Column("curve", "name"),
        Column("points", "points"),
        Column("turns at", lambda curve: "; ".join(_turns(curve)) or "–"),
        Column("ended", "ended"),
    )
    asked = [{**point, "name": curve["name"]} for curve in curves for point in curve["asked"]]
    return [
        declared("Bifurcations in two parameters", points, asked),
        declared("The curves", ends, curves),
    ]
