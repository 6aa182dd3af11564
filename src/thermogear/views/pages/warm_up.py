"""What the page of a warm-up holds: the answer, pictures, tables."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import (
    CELSIUS,
    KELVIN,
    MICROMETRE,
    MINUTE,
    PERCENT,
    STIFFNESS,
    Display,
    exactly,
    number,
)
from thermogear.results.result import Result
from thermogear.views.columns import Column, declared, rows_along
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages.survey import survey
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import HOT, INK, OKABE_ITO, QUIET, WIDE

KINDS = ("warmup",)


def page(result: Result) -> Page:
    """A pair through its duty."""
    data, steady = result.groups["course"], result.groups["steady"]
    record = result.group("record")
    worst = result.table("worst")
    cold = float(worst["undeformed_half_backlash_m"])
    logarithmic = result.text("duty") != "table"
    pictures = [
        Shown(
            "course",
            "Temperatures and half backlash over time",
            _course_words(worst, logarithmic, record is not None),
            partial(course, data, steady, record, worst, cold=cold, logarithmic=logarithmic),
            wide=True,
        ),
        Shown(
            "mesh",
            "Flash, film, margin and stiffness over time",
            "Gaps: a pair without load has no flash, film or stiffness, one at rest no film.",
            partial(mesh, data, worst, logarithmic=logarithmic),
            wide=True,
        ),
        Shown(
            "sensors",
            "What thermometers show, and what is true",
            "; ".join(f"{k}: {words}" for k, words in result.table("sensors").items()) + ".",
            partial(sensors, data, record, logarithmic=logarithmic),
            wide=True,
        ),
    ]
    tables = [_moments(data, worst), _pieces(data, steady), _sensors(data)]
    if record is not None:
        tables.append(_differences(record))
    return survey(
        result,
        answer(worst, cold),
        pictures,
        tables,
        numbers=partial(_numbers, result),
    )


def answer(worst: Mapping[str, Any], cold: float) -> str:
    """When the half backlash is least, how much is left, and how that compares."""
    least, minutes = MICROMETRE(float(worst["half_backlash_m"])), MINUTE(float(worst["time_s"]))
    point = (
        f"{exactly(round(float(worst['pinion_speed_rpm']), 6))} rpm and "
        f"{exactly(float(worst['pinion_torque_Nm']))} N m"
    )
    if worst["at_the_start"]:
        when = "at the start, heat never takes any of it"
    elif worst["at_the_end"]:
        when = f"at the end, after {number(minutes)} min"
    else:
        begin, end = (number(MINUTE(float(time))) for time in worst["between_s"])
        flat = f" (within {number(MICROMETRE(worst['flat_m']))} um)" * (begin != end)
        span = begin if begin == end else f"from {begin} to {end}"
        when = f"{span} min after the start{flat}, at {point}"
    text = f"The half backlash is least {when}: {number(least, 4)} um of "
    text += f"{number(MICROMETRE(cold), 4)} um"
    text += " undeformed." if least > 0.0 else " undeformed: the pair is jammed."
    rest, below = worst["steady_half_backlash_m"], worst["below_steady_m"]
    if rest is not None and not worst["at_the_start"]:
        if below > 5e-9 and not worst["at_the_end"]:
            text += f" That is {number(MICROMETRE(below))} um below the steady "
            text += f"{number(MICROMETRE(rest), 4)} um"
            if worst["loss_above_steady"] is not None:
                text += (
                    f"; the loss of backlash is {number(PERCENT(worst['loss_above_steady']))} % "
                    "greater than the steady one"
                )
            text += "."
        else:
            text += f" Held for good, this point would leave {number(MICROMETRE(rest), 4)} um."
    margin, borne = worst["margin_K"], worst.get("borne_K")
    if margin is not None and borne is not None and 0.0 < borne < margin and least > 0.0:
        text += (
            f" It does not jam below {number(worst['borne_degC'])} °C of the pinion's teeth "
            f"({worst['borne_why']}), the wheel's changed alike and the housing as it is."
        )
    elif margin is not None and least > 0.0:
        text += (
            f" Both gears could then be {number(margin)} K hotter, the housing as it is, until "
            "the pair jams."
        )
    return text


def _course_words(worst: Mapping[str, Any], logarithmic: bool, measured: bool) -> str:
    words = ["Dotted: the moment of the least half backlash."]
    if not (worst["at_the_end"] or worst["at_the_start"]):
        warmed = worst["warmed"]
        words.append(
            "Gears warm before the housing, which then follows and opens the axes again."
            if warmed
            else "The housing cools before the gears and closes the axes on them."
        )
    words.append("Dashed below: what would be left if the point were held for good.")
    if measured:
        words.append("Circles: the record.")
    if logarithmic:
        words.append("Time runs logarithmically.")
    return " ".join(words)


def _thousandths(kelvin: float) -> str:
    return number(round(kelvin, 3) + 0.0)


NODES = ("pinion_tooth", "wheel_tooth", "pinion_shaft", "wheel_shaft", "oil", "housing")
MOMENTS = (
    Column("moment", "name"),
    Column("time", "time", 4, MINUTE),
    Column("b′", "half_backlash", 4),
    Column("margin", "jam_margin", 3, KELVIN),
    *(Column(node.replace("_", " "), node, 4, CELSIUS) for node in NODES),
    Column("flash", "greatest_flash", 3, KELVIN),
    Column("Λ least", "least_film_parameter"),
    Column("k mean", "mean_stiffness"),
)


def _moments(data: Dataset, worst: Mapping[str, Any]) -> Table:
    """Start, worst moment, end."""
    of_nodes = {node: data["node_temperature"].sel(node=node, drop=True) for node in NODES}
    places = [0, int(np.argmin(data["half_backlash"].values)), data.sizes["moment"] - 1]
    start, least, end = rows_along(data.assign(of_nodes).isel(moment=places), "moment")
    found = {"time": worst["time_s"], "half_backlash": worst["half_backlash_m"]}
    rows = [
        start | {"name": "start"},
        least | found | worst["temperatures_K"] | {"name": "least backlash"},
        end | {"name": "end"},
    ]
    return declared(
        "Start, worst moment, end.",
        MOMENTS,
        rows,
        marked=lambda row: row["name"] == "least backlash",
    )


MOST_ROWS = 40
PIECES = (
    Column("from", "begin", 4, MINUTE),
    Column("speed", "pinion_speed", lambda rpm: exactly(round(rpm, 6))),
    Column("torque", "pinion_torque", exactly),
    Column("ambient", "ambient", 4, CELSIUS),
    Column("b′ least", "least", 4, MICROMETRE),
    Column("b′ for good", "half_backlash", 4),
    Column("oil for good", "oil", 4, CELSIUS),
)


def _pieces(data: Dataset, steady: Dataset) -> Table:
    """The pieces of the duty, and what each would leave for good."""
    time, gap = data["time"].values, data["half_backlash"].values
    begins = steady["begin"].values
    ends = np.append(begins[1:], time[-1])
    least = [
        gap[(time >= begin) & (time <= end)].min(initial=np.inf)
        for begin, end in zip(begins, ends, strict=True)
    ]
    oil = steady["node_temperature"].sel(node="oil", drop=True)
    rows = rows_along(steady.assign(least=("piece", least), oil=oil), "piece")
    more = len(rows) - MOST_ROWS
    caption = "The duty, and what each point would leave if it were held for good."
    caption += f" {more} more rows stand in the CSV." * (more > 0)
    return declared(caption, PIECES, rows[:MOST_ROWS], names=0)


SENSORS = (
    Column("sensor", "sensor"),
    Column("at the end", "end", _thousandths, KELVIN),
    Column("least", "least", _thousandths, KELVIN),
    Column("greatest", "greatest", _thousandths, KELVIN),
    Column("shown", "sensor_temperature", 4, CELSIUS),
    Column("true", "true_temperature", 4, CELSIUS),
)


def _sensors(data: Dataset) -> Table:
    error = data["sensor_temperature"] - data["true_temperature"]
    last = data.isel(moment=-1).assign(
        end=error.isel(moment=-1),
        least=error.min("moment", skipna=False),
        greatest=error.max("moment", skipna=False),
    )
    return declared(
        "What each sensor shows less what is true.", SENSORS, rows_along(last, "sensor")
    )


DIFFERENCES = (
    Column("channel", "channel"),
    Column("readings", "readings"),
    Column("mean", "mean", 3, KELVIN),
    Column("rms", "rms", 3, KELVIN),
    Column("farthest", "farthest", 3, KELVIN),
)


def _differences(record: Dataset) -> Table:
    difference = record["difference"]
    over = [dim for dim in difference.dims if dim != "channel"]
    low, high = difference.min(over), difference.max(over)
    told = record.assign(
        readings=difference.count(over),
        mean=difference.mean(over),
        rms=np.sqrt((difference**2).mean(over)),
        farthest=high.where(high > -low, low),
    )
    rows = [row for row in rows_along(told, "channel") if row["readings"]]
    return declared("Computed less measured.", DIFFERENCES, rows)


# --- figures as JSON wants them ---------------------------------------------------------------


def _numbers(result: Result) -> dict[str, Any]:
    last = result.groups["course"].isel(moment=-1)
    last = last.assign(error=last["sensor_temperature"] - last["true_temperature"])
    return {
        "worst": result.table("worst"),
        "jams_s": result.values("jams"),
        "end_K": dict(last["node_temperature"].to_series()),
        "sensor_error_at_the_end_K": dict(last["error"].to_series()),
        "greatest_imbalance": float(result.text("greatest_imbalance")),
        "evaluations": int(result.text("evaluations")),
        "seconds": float(result.text("seconds")),
    }


# --- pictures -----------------------------------------------------------------------------------


NODE_COLOURS: dict[str, tuple[str, tuple[float, ...]]] = {
    "pinion_tooth": (OKABE_ITO[1], ()),
    "pinion_body": (OKABE_ITO[1], (4, 1.5)),
    "pinion_shaft": (OKABE_ITO[1], (1, 1.5)),
    "wheel_tooth": (OKABE_ITO[0], ()),
    "wheel_body": (OKABE_ITO[0], (4, 1.5)),
    "wheel_shaft": (OKABE_ITO[0], (1, 1.5)),
    "oil": (OKABE_ITO[2], ()),
    "housing": (QUIET, ()),
}


SENSOR_COLOURS = {
    "thermocouple": OKABE_ITO[1],
    "ring": OKABE_ITO[0],
    "infrared": OKABE_ITO[3],
}
FIRST = 0.1
"""Least time [min] on a logarithmic axis."""


def course(
    data: Dataset,
    steady: Dataset,
    record: Dataset | None,
    worst: Mapping[str, Any],
    *,
    cold: float,
    logarithmic: bool,
) -> Picture:
    """Node temperatures above, half backlash below, the worst moment marked in both."""
    minutes = MINUTE(data["time"].values)
    above = Panel(Axis(), Axis("temperature [°C]"))
    below = Panel(_time(minutes, logarithmic), Axis("half backlash b′ [µm]"))
    for name in (str(n) for n in data["node"].values):
        if name not in NODE_COLOURS:
            continue
        colour, dash = NODE_COLOURS[name]
        values = CELSIUS(data["node_temperature"].sel(node=name).values)
        above.curve(minutes, values, colour=colour, dash=dash, label=name.replace("_", " "))
    if record is not None:
        _points(above, record, {name: colour for name, (colour, _) in NODE_COLOURS.items()})
    left = MICROMETRE(data["half_backlash"].values)
    below.curve(minutes, left, colour=INK, label="half backlash left")
    held = MICROMETRE(steady["half_backlash"].values)
    ends = np.append(MINUTE(steady["begin"].values[1:]), minutes[-1])
    begins = np.maximum(MINUTE(steady["begin"].values), FIRST if logarithmic else 0.0)
    for place, (begin, end, value) in enumerate(zip(begins, ends, held, strict=True)):
        if math.isfinite(float(value)) and end > begin:
            label = "" if place else "steady, if held for good"
            level = [value, value]
            below.curve([begin, end], level, colour=QUIET, dash=(4, 2), width=1.2, label=label)
    below.line(y=MICROMETRE(cold), colour=OKABE_ITO[5], width=1.1, label="undeformed")
    if left.min() <= 0.0:
        below.line(y=0.0, colour=HOT, width=1.1, label="jammed below")
    _mark(above, below, worst, logarithmic)
    return Picture([[above], [below]], size=(WIDE, 6.4), above=0.28, share_x="column", legend=6)


def _worst(panel: Panel, worst: Mapping[str, Any], logarithmic: bool) -> float:
    """Mark the worst moment; where it is drawn [min]."""
    at = max(MINUTE(float(worst["time_s"])), FIRST if logarithmic else 0.0)
    panel.line(x=at, colour=HOT, width=1.0, dash=(1, 1.5), order=0.6)
    return at


def _mark(above: Panel, below: Panel, worst: Mapping[str, Any], logarithmic: bool) -> None:
    least = MICROMETRE(float(worst["half_backlash_m"]))
    at = [_worst(panel, worst, logarithmic) for panel in (above, below)][-1]
    below.points([at], [least], colour=HOT, order=5)
    low, high = below.x.low or 0.0, below.x.high or 1.0
    share = np.log(at / low) / np.log(high / low) if below.x.log else (at - low) / (high - low)
    across, away = ("right", -8) if share > 0.75 else ("left", 8)
    words = f"least: {number(least, 4)} µm\nat {number(MINUTE(float(worst['time_s'])))} min"
    below.text(
        at, least, words, offset=(away, 10), across=across, up="baseline", colour=HOT, box=True,
        order=1.5,
    )  # fmt: skip


def mesh(data: Dataset, worst: Mapping[str, Any], *, logarithmic: bool) -> Picture:
    """Flash temperature, film parameter, margin to the jam, mean stiffness over time."""
    minutes = MINUTE(data["time"].values)
    panels = []
    for name, words, scale, colour in (
        ("greatest_flash", "greatest flash temperature [K]", KELVIN, OKABE_ITO[1]),
        ("least_film_parameter", "least film parameter Λ [–]", Display("–"), OKABE_ITO[2]),
        ("jam_margin", "margin to the jam [K]", KELVIN, OKABE_ITO[3]),
        ("mean_stiffness", "mean mesh stiffness [10⁸ N/m]", STIFFNESS, OKABE_ITO[0]),
    ):
        values = scale(data[name].values)
        panel = Panel(_time(minutes, logarithmic), Axis(words))
        if np.isfinite(values).any():
            panel.curve(minutes, values, colour=colour)
            _worst(panel, worst, logarithmic)
        else:
            panel.note("nothing to draw: no load, or no heat that jams")
        panels.append(panel)
    return Picture([panels[:2], panels[2:]], size=(WIDE, 5.6), above=0.62)


def sensors(data: Dataset, record: Dataset | None, *, logarithmic: bool) -> Picture:
    """What every sensor shows (solid) beside the true temperature (dashed), and the error."""
    minutes = MINUTE(data["time"].values)
    level = Panel(_time(minutes, logarithmic), Axis("temperature [°C]"))
    error = Panel(_time(minutes, logarithmic), Axis("shown less true [K]"))
    for name in (str(n) for n in data["sensor"].values):
        shown = data["sensor_temperature"].sel(sensor=name).values
        true = data["true_temperature"].sel(sensor=name).values
        colour = SENSOR_COLOURS.get(name, INK)
        level.curve(minutes, CELSIUS(shown), colour=colour, label=f"{name} shows")
        level.curve(
            minutes, CELSIUS(true), colour=colour, dash=(3, 1.5), width=1.1, label=f"{name}: true"
        )
        error.curve(minutes, shown - true, colour=colour)
    if record is not None:
        _points(level, record, SENSOR_COLOURS)
    return Picture([[level, error]], size=(WIDE, 3.6), legend=6)


def _points(panel: Panel, record: Dataset, colours: Mapping[str, str]) -> None:
    """The record's readings of what is drawn here."""
    minutes = MINUTE(record["time"].values)
    for name in (str(n) for n in record["channel"].values):
        if name in colours:
            values = CELSIUS(record["measured"].sel(channel=name).values)
            label = f"{name.replace('_', ' ')}, measured"
            panel.points(minutes, values, size=3.2, open=True, colour=colours[name], label=label)


def _time(minutes: Any, logarithmic: bool) -> Axis:
    axis = Axis("time from the start [min]", low=0.0, high=float(minutes[-1]))
    if logarithmic and minutes[-1] > 10.0 * FIRST:
        axis.low, axis.log = FIRST, "plain"
    return axis
