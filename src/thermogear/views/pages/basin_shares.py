"""The page of basins along a parameter, from its stored dataset alone."""

from __future__ import annotations

from functools import partial

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import (
    MICROMETRE,
    MILLIMETRE_PER_SECOND,
    PERCENT,
    Display,
    exactly,
    number,
    span,
)
from thermogear.base.vocabulary import FASTER_RULE
from thermogear.results.result import Result
from thermogear.views.columns import Column, Row, declared, in_full, key, rows_along
from thermogear.views.page import LEAD, Page, Pictures, Section, Text
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.parameters import axis_words, page_words, parameter_of, shown
from thermogear.views.style import INK, OKABE_ITO, QUIET, WIDE, scale

KINDS = ("basin-shares",)
CAPTION = (
    "Shares of the starts that end on each motion, one above the other; whiskers: 95 % interval of "
    "the share below them. Below, the least disturbance at mesh phase 0 that was seen to leave the "
    "motion: a displacement alone, and a change of velocity alone."
)
EXPLAINED = (
    "Starts are drawn evenly in the box of --x and --v, the same at every value: a share is one of "
    "this box. The interval is that of Clopper and Pearson and holds for each value by itself. "
    "Motions of neighbouring values whose sections are near have one number. The least disturbance "
    "is an upper bound: the first of 64 steps to the width of the box that ends elsewhere, drawn "
    "nearer by bisection; chaos has none. "
)


def page(result: Result) -> Page:
    """Shares and least disturbances as picture and table."""
    data = result.data
    pictures = Pictures()
    pictures.add(
        "shares",
        "Basins along the parameter",
        CAPTION,
        data,
        (),
        partial(shares_picture, data),
        wide=True,
    )
    rows = [
        row for row in rows_along(data, data.attrs["parameter"], "motion") if row["motion_count"]
    ]
    table = declared("Motions at each value.", columns(data), rows, names=2)
    summary = Text(finding(data))
    rule = Text(f"{EXPLAINED}{FASTER_RULE.capitalize()}.")
    return Page(
        result, summary.words,
        [
            Section(LEAD, "In pictures", pictures.take(), folded=False),
            Section("motions", "Motions", [table, rule]),
        ],
        numbers=lambda: {
            "starts": int(data.attrs["starts"]),
            "motions": [in_full(columns(data), row) for row in rows],
        },
        told=lambda: [summary, table],
    )  # fmt: skip


def _kind(row: Row) -> str:
    return f"period {row['motion_period']:.0f}" if row["motion_period"] else "chaotic, estimate"


def pushes(data: Dataset) -> list[tuple[str, Display]]:
    """Names and units of the least disturbances, in SI where the plane is one of lengths."""
    if np.isfinite(data["plane_scale"]).any():
        return [("least_displacement", MICROMETRE), ("least_velocity", MILLIMETRE_PER_SECOND)]
    return [("least_x", Display("as --x")), ("least_v", Display("as --v"))]


def columns(data: Dataset) -> list[Column]:
    """Of the table and of JSON."""
    name = str(data.attrs["parameter"])
    unit = parameter_of(name, data[name])
    words = ("least displacement to leave it", "least change of velocity")
    return [
        Column(
            page_words(name, data[name]), lambda row: float(unit.show(row[name])), exactly,
            key="value",
        ),
        Column("motion", "motion", key="motion"),
        Column("kind", _kind),
        Column("share", "motion_share", 3, PERCENT),
        Column("from", "motion_share_low", 3, PERCENT),
        Column("to", "motion_share_high", 3, PERCENT),
        Column("multiplier", "motion_multiplier", 4),
        *(Column(one, push, 3, way) for one, (push, way) in zip(words, pushes(data), strict=True)),
        Column("undecided", "undecided_share", 3, PERCENT),
        Column("diverged", "diverged_share", 3, PERCENT),
        *map(key, (
            "motion_count", "motion_period", "motion_share", "motion_share_low",
            "motion_share_high", "undecided", "diverged", "least_x", "least_v",
            "least_displacement", "least_velocity",
        )),
    ]  # fmt: skip


def finding(data: Dataset) -> str:
    """Between what each motion's share goes, and how little leaves a motion."""
    if not data.sizes["motion"]:
        return "No start ends on a motion that is known."
    words = "; ".join(
        f"motion {int(n)} takes {span(PERCENT(one.values))} % of the starts"
        for n, one in data["motion_share"].groupby("motion")
    )
    parts = []
    for (name, unit), axis in zip(
        pushes(data), ("displacement", "change of velocity"), strict=True
    ):
        if np.isfinite(data[name]).any():
            parts.append(f"{axis} {number(float(unit(data[name].min())))} {unit.unit}")
    least = f" The least disturbances that leave a motion: {', '.join(parts)}." if parts else ""
    return f"{words.capitalize()}.{least}"


def shares_picture(data: Dataset) -> Picture:
    """Shares one above the other with their intervals; below what leaves each motion."""
    name = str(data.attrs["parameter"])
    p, colours = shown(name, data[name]), [*OKABE_ITO, *scale("tab20")]
    top = Panel(Axis(), Axis("share of the starts [%]", low=0.0, high=100.0))
    low = [
        Panel(Axis(), Axis(f"{words} [{unit.unit}]", low=0.0))
        for words, (_, unit) in zip(("displacement", "velocity"), pushes(data), strict=True)
    ]
    base = np.zeros(p.size)
    for n in range(data.sizes["motion"]):
        here, colour = data.isel(motion=n), colours[n % len(colours)]
        share, least, most = (
            PERCENT(here[f"motion_share{end}"].values) for end in ("", "_low", "_high")
        )
        top.band(
            p, low=base, high=base + share, colour=colour, opacity=0.5, label=f"motion {n + 1}"
        )
        ends = np.stack([base + least, base + most, np.full(p.size, np.nan)], axis=1)
        top.curve(np.repeat(p, 3), ends.ravel(), colour=colour, width=1.4, order=3)
        base = base + share
        top.points(p, base, colour=colour, size=3)
        for panel, (push, unit) in zip(low, pushes(data), strict=True):
            panel.curve(p, unit(here[push].values), colour=colour, marker="circle", size=3)
    for rest, colour in (("undecided", QUIET), ("diverged", INK)):
        share = PERCENT(data[f"{rest}_share"].values)
        if share.any():
            top.band(p, low=base, high=base + share, colour=colour, opacity=0.6, label=rest)
            base = base + share
    low[-1].x = Axis(axis_words(name, data[name]))
    return Picture(
        [[top], *([panel] for panel in low)], size=(WIDE, 7.5), share_x="column", above=0.15,
        heights=(3, 1, 1), legend=6,
    )  # fmt: skip
