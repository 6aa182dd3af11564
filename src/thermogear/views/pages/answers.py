"""The answers: a table of questions, sentences, limits and verdicts, and the speeds behind them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any

import numpy as np
from markupsafe import Markup

from thermogear.base.arrays import Dataset
from thermogear.base.display import PERCENT, display
from thermogear.base.limits import FINE, LOOK, OPEN
from thermogear.results.answer import Answer, worst
from thermogear.results.result import Result
from thermogear.results.tables import csv_tables
from thermogear.views.columns import Column, declared
from thermogear.views.page import Block, Code, Made, Page, Pictures, Section, Table
from thermogear.views.pages.background import background
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import HOT, INK, OKABE_ITO, QUIET, WIDE

KINDS = ("answers",)
MOST_POINTS = 6
"""Operating points that the table shows one by one; of more only the gravest answers."""


def page(result: Result) -> Page:
    """The answers alone."""
    pictures = Pictures()
    return Page(
        result,
        summary(result),
        Made(lambda: sections(result, pictures) + background(result)),
        numbers=lambda: {"answers": result.rows("answers")} | of_series(result),
        told=lambda: told(result),
        tables=lambda: csv_tables(result.groups, "answers_") if "series" in result.groups else {},
    )


def summary(result: Result) -> str:
    """How many answers are fine, and which want a look."""
    found = gravest(result.answers)
    if not found:
        return ""
    fine = sum(one.verdict == FINE for one in found)
    looks = [one.sentence for one in found if one.verdict == LOOK]
    open_ = sum(one.verdict == OPEN for one in found)
    words = [f"{fine} of {len(found)} answers are fine."]
    if looks:
        words.append("Look here: " + " ".join(looks))
    if open_:
        words.append(f"{open_} not decided.")
    return " ".join(words)


def gravest(answers: Sequence[Answer]) -> list[Answer]:
    """One answer for each figure: that of the operating point that wants a look most."""
    by_name: dict[str, list[Answer]] = {}
    for one in answers:
        by_name.setdefault(one.name, []).append(one)
    return [worst(several) for several in by_name.values()]


def sections(result: Result, pictures: Pictures) -> list[Section]:
    """First of a page: every answer with its verdict, then the speeds; each point's, folded."""
    found = result.answers
    if not found:
        return []
    speeds = result.group("speeds")
    if speeds is not None:
        pictures.add(
            "dynamic-factor",
            "Dynamic factor over speed",
            "Every motion found at each speed, the hot pair's: filled where the flanks part, a "
            "second one where two exist. Dashed: the case's own speeds.",
            speeds,
            ("dynamic_factor", "contact_loss_share"),
            lambda: speeds_picture(speeds),
            wide=True,
        )
    series = result.group("series")
    if series is not None:
        pictures.add(
            "dynamic-factor",
            "Dynamic factor of the series over speed",
            "Of the operating point with the greatest dynamic factor. Above: the median pair and "
            "the band of 90 % of pairs; dashed: the median with other dampings, up to the own "
            "speed; dots: every pair at it. Below: the share of pairs that lose contact.",
            series,
            ("dynamic_factor", "parting_share"),
            lambda: series_picture(series),
            wide=True,
        )
    blocks: list[Block] = [_table("", gravest(found)), *pictures.take()]
    first = Section("answers", "Answers", blocks, folded=False)
    points = list(dict.fromkeys(one.operating for one in found if one.operating))
    if not 1 < len(points) <= MOST_POINTS:
        return [first]
    each = [_table(point, [one for one in found if one.operating == point]) for point in points]
    return [first, Section("answers-each", "Answers at each operating point", each)]


ANSWER = (
    Column("question", lambda row: row["answer"].question if row["first"] else ""),
    Column("verdict", lambda row: Markup("<b>{}</b>").format(row["answer"].verdict)),
    Column("answer", lambda row: _sentence(row["answer"])),
    Column("limit", lambda row: row["answer"].limit),
    Column("from", lambda row: row["answer"].source),
)


def _table(caption: str, answers: Sequence[Answer]) -> Table:
    rows = [{"first": first, "answer": answer} for first, answer in _firsts(answers)]
    return declared(
        caption,
        ANSWER,
        rows,
        names=5,
        marked=lambda row: row["answer"].verdict == LOOK,
        wordy=True,
    )


def _firsts(answers: Sequence[Answer]) -> Iterator[tuple[bool, Answer]]:
    """Every answer, and whether it is the first to its question."""
    for _, several in groupby(answers, key=lambda one: one.question):
        for place, one in enumerate(several):
            yield place == 0, one


def _sentence(one: Answer) -> str:
    return f"{one.sentence[:-1]}, at {one.operating}." if one.operating else one.sentence


def told(result: Result) -> Iterator[Code]:
    """The answers for a terminal: one line each, under their questions, as they are."""
    for first, one in _firsts(gravest(result.answers)):
        if first:
            yield Code(one.question)
        yield Code(f"  {one.verdict:<11}  {_sentence(one)} [{one.limit}]")


# --- pictures -----------------------------------------------------------------------------------


KEPT = 1e-3
"""Share of time out of contact below which contact is kept."""


def speeds_picture(data: Dataset) -> Picture:
    """Every motion's dynamic factor over pinion speed: open in contact, filled where it is lost."""
    panel = Panel(Axis("pinion speed [rpm]"), Axis("dynamic factor [–]"))
    rpm = display("pinion_speed")(data["pinion_speed"].values)
    factor, lost = data["dynamic_factor"].values, data["contact_loss_share"].values > KEPT
    for where, colour, label in ((~lost, INK, "in contact"), (lost, HOT, "flanks part")):
        if where.any():
            panel.points(
                rpm[where], factor[where], colour=colour, size=4.0, open=not lost[where].all(),
                label=label,
            )  # fmt: skip
    for own in np.unique(np.atleast_1d(data.attrs.get("own_speeds", ()))):
        panel.line(x=float(display("pinion_speed")(own)), colour=QUIET, width=1.0, dash=(4.0, 3.0))
    return Picture([[panel]], size=(WIDE, 3.2))


def series_picture(data: Dataset) -> Picture:
    """Band of the dynamic factor over pinion speed, dampings and parts; below, who parts.

    Of the operating point with the greatest dynamic factor.
    """
    data = data.isel(operating=int(data.attrs["gravest"]))
    rpm = display("pinion_speed")(data["pinion_speed"].values)
    low, middle, high = data["dynamic_factor"].values
    dampings = data["damping_ratio"].values
    factor = Panel(Axis("pinion speed [rpm]"), Axis("dynamic factor [–]", low=0.0))
    parting = Panel(Axis("pinion speed [rpm]"), Axis("pairs that part [%]", low=0.0))
    factor.band(rpm, low=low[0], high=high[0], colour=INK, opacity=0.2, label="90 % of pairs")
    for place in range(dampings.size):
        look = {"colour": INK} if place == 0 else {"colour": OKABE_ITO[place], "dash": (5.0, 3.0)}
        label = f"median, damping {dampings[place]:.2g}"
        factor.curve(rpm, middle[place], label=label, **look)
        share = PERCENT(data["parting_share"].values[place])
        parting.curve(rpm, share, **look)
    speed = float(display("pinion_speed")(data["own_speed"]))
    parts = data["own_dynamic_factor"].values[0]
    factor.points(np.full(parts.size, speed), parts, colour=HOT, size=3.0, open=True, label="pairs")
    for panel in (factor, parting):
        panel.line(x=speed, colour=QUIET, width=1.0, dash=(4.0, 3.0))
    return Picture([[factor], [parting]], size=(WIDE, 5.2))


def of_series(result: Result) -> dict[str, Any]:
    """What is behind the answers of a series for JSON: SI values, with unit and dimensions."""
    data = result.group("series")
    if data is None:
        return {}
    return {
        "series": {
            str(name): {
                "unit": entry.attrs.get("units", "1"),
                "along": list(entry.dims),
                "values": entry.values.tolist(),
            }
            for name, entry in data.variables.items()
        }
    }
