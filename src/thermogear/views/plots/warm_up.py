"""A pair through its duty: temperatures, the backlash that is left, and what sensors show."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator
from numpy.typing import NDArray

from thermogear.views.style import (
    HOT,
    INK,
    OKABE_ITO,
    QUIET,
    WIDE,
    legend_below,
    note,
    picture,
)
from thermogear.views.words import CELSIUS, number

Floats = NDArray[np.float64]

NODE_COLOURS = {
    "pinion_tooth": (OKABE_ITO[1], "-"),
    "pinion_body": (OKABE_ITO[1], (0, (4, 1.5))),
    "pinion_shaft": (OKABE_ITO[1], (0, (1, 1.5))),
    "wheel_tooth": (OKABE_ITO[0], "-"),
    "wheel_body": (OKABE_ITO[0], (0, (4, 1.5))),
    "wheel_shaft": (OKABE_ITO[0], (0, (1, 1.5))),
    "oil": (OKABE_ITO[2], "-"),
    "housing": (QUIET, "-"),
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
) -> Figure:
    """Node temperatures above, half backlash below, the worst moment marked in both."""
    figure, axes = picture(2, 1, size=(WIDE, 6.4), above=0.28, sharex=True)
    above, below = axes[:, 0]
    minutes = data["time"].values / 60.0
    for name in (str(n) for n in data["node"].values):
        if name not in NODE_COLOURS:
            continue
        colour, line = NODE_COLOURS[name]
        values = CELSIUS(data["node_temperature"].sel(node=name).values)
        above.plot(minutes, values, color=colour, linestyle=line, label=name.replace("_", " "))
    if record is not None:
        _points(above, record, {name: colour for name, (colour, _) in NODE_COLOURS.items()})
    above.set_ylabel("temperature [°C]")
    left = 1e6 * data["half_backlash"].values
    below.plot(minutes, left, color=INK, label="half backlash left")
    held = 1e6 * steady["half_backlash"].values
    ends = np.append(steady["begin"].values[1:] / 60.0, minutes[-1])
    begins = np.maximum(steady["begin"].values / 60.0, FIRST if logarithmic else 0.0)
    for place, (begin, end, value) in enumerate(zip(begins, ends, held, strict=True)):
        if math.isfinite(float(value)) and end > begin:
            below.hlines(
                value, begin, end, color=QUIET, linestyle=(0, (4, 2)), linewidth=1.2,
                label="steady, if held for good" if place == 0 else None,
            )  # fmt: skip
    below.axhline(1e6 * cold, color=OKABE_ITO[5], linewidth=1.1, label="cold")
    if left.min() <= 0.0:
        below.axhline(0.0, color=HOT, linewidth=1.1, label="jammed below")
    below.set_ylabel("half backlash b′ [µm]")
    _time(below, minutes, logarithmic)
    _mark(above, below, worst, logarithmic)
    legend_below(figure, [above, below], 6)
    return figure


def _mark(above: Axes, below: Axes, worst: Mapping[str, Any], logarithmic: bool) -> None:
    when, least = float(worst["time_s"]) / 60.0, 1e6 * float(worst["half_backlash_m"])
    at = max(when, FIRST) if logarithmic else when
    for axis in (above, below):
        axis.axvline(at, color=HOT, linewidth=1.0, linestyle=(0, (1, 1.5)), zorder=0.6)
    below.plot([at], [least], marker="o", markersize=6, color=HOT, zorder=5)
    low, high = below.get_xlim()
    share = np.log(at / low) / np.log(high / low) if logarithmic else (at - low) / (high - low)
    right = bool(share > 0.75)
    below.annotate(
        f"least: {number(least, 4)} µm\nat {number(when)} min",
        (at, least),
        xytext=(-8 if right else 8, 10),
        ha="right" if right else "left",
        textcoords="offset points",
        fontsize=8.5,
        color=HOT,
        zorder=1.5,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.5},
    )


def mesh(data: xr.Dataset, worst: Mapping[str, Any], *, logarithmic: bool) -> Figure:
    """Flash temperature, film parameter, margin to the jam, mean stiffness over time."""
    figure, axes = picture(2, 2, size=(WIDE, 5.6), above=0.62)
    minutes = data["time"].values / 60.0
    panels = (
        ("greatest_flash", "greatest flash temperature [K]", 1.0, OKABE_ITO[1]),
        ("least_film_parameter", "least film parameter Λ [–]", 1.0, OKABE_ITO[2]),
        ("jam_margin", "margin to the jam [K]", 1.0, OKABE_ITO[3]),
        ("mean_stiffness", "mean mesh stiffness [10⁸ N/m]", 1e-8, OKABE_ITO[0]),
    )
    when = float(worst["time_s"]) / 60.0
    for axis, (name, words, scale, colour) in zip(axes.ravel(), panels, strict=True):
        values = scale * data[name].values
        axis.set_ylabel(words)
        if np.isfinite(values).any():
            axis.plot(minutes, values, color=colour)
            axis.axvline(
                max(when, FIRST) if logarithmic else when,
                color=HOT, linewidth=1.0, linestyle=(0, (1, 1.5)), zorder=0.6,
            )  # fmt: skip
        else:
            note(axis, "nothing to draw: no load, or no heat that jams")
        _time(axis, minutes, logarithmic)
    return figure


def sensors(data: xr.Dataset, record: xr.Dataset | None, *, logarithmic: bool) -> Figure:
    """What every sensor shows (solid) beside the true temperature (dashed), and the error."""
    figure, axes = picture(1, 2, size=(WIDE, 3.6))
    minutes = data["time"].values / 60.0
    for name in (str(n) for n in data["sensor"].values):
        shown = data["sensor_temperature"].sel(sensor=name).values
        true = data["true_temperature"].sel(sensor=name).values
        colour = SENSOR_COLOURS.get(name, INK)
        axes[0, 0].plot(minutes, CELSIUS(shown), color=colour, label=f"{name} shows")
        axes[0, 0].plot(
            minutes, CELSIUS(true), color=colour, linestyle=(0, (3, 1.5)), linewidth=1.1,
            label=f"{name}: true",
        )  # fmt: skip
        axes[0, 1].plot(minutes, shown - true, color=colour)
    if record is not None:
        _points(axes[0, 0], record, SENSOR_COLOURS)
    axes[0, 0].set_ylabel("temperature [°C]")
    axes[0, 1].set_ylabel("shown less true [K]")
    for axis in axes.ravel():
        _time(axis, minutes, logarithmic)
    legend_below(figure, axes[0, 0], 6)
    return figure


def _points(axis: Axes, record: xr.Dataset, colours: Mapping[str, Any]) -> None:
    """The record's readings of what is drawn here."""
    minutes = record["time"].values / 60.0
    for name in (str(n) for n in record["channel"].values):
        if name not in colours:
            continue
        axis.plot(
            minutes,
            CELSIUS(record["measured"].sel(channel=name).values),
            linestyle="none",
            marker="o",
            markersize=3.2,
            markerfacecolor="none",
            color=colours[name],
            label=f"{name.replace('_', ' ')}, measured",
        )


def _time(axis: Axes, minutes: Floats, logarithmic: bool) -> None:
    axis.set_xlabel("time from the start [min]")
    if logarithmic and minutes[-1] > 10.0 * FIRST:
        axis.set_xscale("log")
        axis.set_xlim(FIRST, float(minutes[-1]))
        axis.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
        axis.xaxis.set_minor_locator(NullLocator())
    else:
        axis.set_xlim(0.0, float(minutes[-1]))
