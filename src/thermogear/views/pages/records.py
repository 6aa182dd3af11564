"""The page of several records beside a baseline."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import PERCENT, SPEED, Display
from thermogear.results.result import Result
from thermogear.views.columns import PLAIN, Column, Row, declared
from thermogear.views.page import Page, Pictures, Section, Table, Text
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import OKABE_ITO, WIDE

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
            partial(course, data),
            wide=True,
        )
        sections.append(Section("course", "Course", pictures.take(), folded=False))
    sections += [
        Section(name, name.capitalize(), [table], folded=name != "speeds" or not _moved(found))
        for name, table in _tables(found, _SHOWN).items()
    ]
    return Page(
        result,
        summary(found),
        sections,
        numbers=lambda: found,
        told=lambda: [*_tables(found).values(), Text(summary(found))],
    )


def _is_compared(data: Dataset) -> bool:
    """Whether a line of any record has a change against the baseline's."""
    known = np.isfinite(data["record_line_change"].values)
    return bool(np.any(known.sum(axis=0) > 1))


def _half(name: str) -> Callable[[Row], float]:
    """The half width of a change or a trend; results of older versions call it otherwise."""
    return lambda row: float(row.get(f"{name}_half_width", row.get("half_width", 0.0)))


# results of older versions hold neither
TURNS = (Column("speed", "shaft_speed", ".5g", SPEED), Column("mesh line", "mesh_frequency", 6))
PER_RECORD = Display("%/record", 100.0)


def _tables(found: dict[str, Any], most: int | None = None) -> dict[str, Table]:
    """What changed, speeds, trends, as far as there are any; of each at ``most`` so many rows."""
    unit = found.get("units", {}).get("reading") or "the file's"
    ratio = f"speed over that of {found.get('baseline', '')} [–]"
    line = (Column("channel", "channel"), Column("line", "name"))
    declarations: dict[str, tuple[str, tuple[Column, ...], int]] = {
        "changed": (
            "Beyond the 95 % interval.",
            (
                Column("record", "record"),
                *line,
                Column("reading", "reading", ".5g", Display(unit)),
                Column("change", "change", "+.2f", PERCENT),
                Column("±", _half("change"), ".2f", PERCENT),
                *TURNS,
            ),
            3,
        ),
        "speeds": (
            "Speed of the first shaft and frequency of the mesh line found. The level of a mesh "
            "line changes with speed. Where nothing tells whether a line is the baseline's, its "
            "change is withheld. – : the record does not tell.",
            (
                Column("record", "record"),
                *TURNS,
                Column(ratio, "speed_ratio", ".4g", PLAIN),
                Column("lines compared [–]", "compared"),
            ),
            1,
        ),
        "trends": (
            "A straight line over the records; beyond its 95 % interval.",
            (
                *line,
                Column("trend", "trend", "+.3g", PER_RECORD),
                Column("±", _half("trend"), ".2g", PER_RECORD),
            ),
            2,
        ),
    }
    return {
        name: declared(caption, columns, found[name][:most], names=names)
        for name, (caption, columns, names) in declarations.items()
        if found.get(name)
    }


def _moved(found: dict[str, Any]) -> bool:
    """Whether a record is apart from the baseline, or runs at another speed."""
    ratios = [row["speed_ratio"] or 1.0 for row in found["speeds"]]
    return bool(found["apart"]) or any(abs(ratio - 1.0) > _STEADY for ratio in ratios)


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


# --- pictures -----------------------------------------------------------------------------------


MOST = 6
"""Lines drawn: those that changed most for their uncertainty."""
_NAMED, _LETTERS = 12, 18  # records that the axis names, and letters of a name
_KNOWN = 50.0  # per cent: a line of a wider interval hides the others


def course(data: Dataset) -> Picture:
    """Change of the lines that changed most for their uncertainty, of those known to +-50 % if
    there are any; shaded: 95 % intervals."""
    change = PERCENT(data["record_line_change"].values)
    half = PERCENT(data["record_line_change_half_width"].values)
    score = np.nan_to_num(np.abs(change) / np.maximum(half, 1e-12)).max(axis=0)
    known = np.nan_to_num(half, nan=0.0).max(axis=0) <= _KNOWN
    drawn = [k for k in np.argsort(-score) if known[k] or not known.any()][:MOST]
    number = np.arange(1.0, change.shape[0] + 1.0)
    panel = Panel(_records(data), Axis("change against the baseline [%]"))
    for k, colour in zip(drawn, OKABE_ITO, strict=False):
        y, h = change[:, k], half[:, k]
        words = f"{data['channel'].values[k]}, {data['name'].values[k]}"
        panel.band(number, low=y - h, high=y + h, colour=colour, opacity=0.2)
        panel.curve(number, y, colour=colour, width=1.2, marker="circle", size=3.0, label=words)
    return Picture([[panel]], size=(WIDE, 4.0), legend=3)


def _records(data: Dataset) -> Axis:
    """The axis of the records: their names where they are few, else their numbers."""
    names = [str(one) for one in data["record"].values]
    if len(names) <= _NAMED:
        ticks = np.arange(1.0, len(names) + 1.0)
        return Axis(ticks=ticks, names=[n[:_LETTERS] for n in names], slant=20.0)
    ticks = np.unique(np.rint(np.linspace(1.0, len(names), _NAMED)))
    return Axis("record [–]", ticks=ticks, names=[f"{tick:.0f}" for tick in ticks])
