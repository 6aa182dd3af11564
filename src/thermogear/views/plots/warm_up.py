"""A pair through its duty: temperatures, the backlash that is left, and what sensors show."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import CELSIUS, MICROMETRE, MINUTE, number
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import HOT, INK, OKABE_ITO, QUIET, WIDE

if TYPE_CHECKING:
    import xarray as xr

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
    data: xr.Dataset,
    steady: xr.Dataset,
    record: xr.Dataset | None,
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


def mesh(data: xr.Dataset, worst: Mapping[str, Any], *, logarithmic: bool) -> Picture:
    """Flash temperature, film parameter, margin to the jam, mean stiffness over time."""
    minutes = MINUTE(data["time"].values)
    panels = []
    for name, words, scale, colour in (
        ("greatest_flash", "greatest flash temperature [K]", 1.0, OKABE_ITO[1]),
        ("least_film_parameter", "least film parameter Λ [–]", 1.0, OKABE_ITO[2]),
        ("jam_margin", "margin to the jam [K]", 1.0, OKABE_ITO[3]),
        ("mean_stiffness", "mean mesh stiffness [10⁸ N/m]", 1e-8, OKABE_ITO[0]),
    ):
        values = scale * data[name].values
        panel = Panel(_time(minutes, logarithmic), Axis(words))
        if np.isfinite(values).any():
            panel.curve(minutes, values, colour=colour)
            _worst(panel, worst, logarithmic)
        else:
            panel.note("nothing to draw: no load, or no heat that jams")
        panels.append(panel)
    return Picture([panels[:2], panels[2:]], size=(WIDE, 5.6), above=0.62)


def sensors(data: xr.Dataset, record: xr.Dataset | None, *, logarithmic: bool) -> Picture:
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


def _points(panel: Panel, record: xr.Dataset, colours: Mapping[str, str]) -> None:
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
