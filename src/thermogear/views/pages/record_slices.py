"""The part of a record's page that shows orders over speed."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import HERTZ, SPEED
from thermogear.results.result import Result
from thermogear.views.columns import Column, by_name, key
from thermogear.views.page import Pictures, Section, Text
from thermogear.views.pages import record_lines
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.sweeps import edges
from thermogear.views.style import OKABE_ITO, WIDE, scale

if TYPE_CHECKING:
    import xarray as xr


def _moved(name: str) -> tuple[Column, Column]:
    """A reading turned into acceleration or displacement, with its half width."""
    value = f"slice_{name}"
    return key(name, value), key(
        f"{name}_half_width", lambda data: data["slice_half_width"] * data[value]
    )


STEPS = [key(name, f"slice_{name}") for name in ("time", "speed", "speed_rate")]
OF_ORDER = (
    key("channel"),
    key("name"),
    key("order", "slice_order"),
    *(
        key(name, f"slice_{name}")
        for name in ("frequency", "reading", "reading_half_width", "phase", "turns")
    ),
    *_moved("acceleration"),
    *_moved("displacement"),
)


def numbers(results: Result) -> dict[str, Any]:
    """The figures, with every order at every step of a run over speed."""
    found, data = results.table("figures"), results.group("slices")
    if data is None or not isinstance(found.get("slices"), dict):
        return found
    orders = [
        by_name(data.sel(channel=channel).isel(slice=place), OF_ORDER)
        for channel in data["channel"].values
        for place in range(data.sizes["slice"])
    ]
    return {**found, "slices": {**found["slices"], **by_name(data, STEPS), "orders": orders}}


def section(results: Result) -> Section | None:
    """Order map, slices with their intervals, resonances in words; None for a steady speed."""
    data, shown = results.group("slices"), results.group("map")
    if data is None or shown is None:
        return None
    unit = results.text("unit") or "the file's numbers"
    count = "the mesh line" if int(data.attrs.get("of_mesh", 0)) else "the first shaft"
    resonances = results.group("resonances")
    pictures = Pictures()
    pictures.add(
        "order-map",
        "Order map",
        "Amplitude by order over speed, Hann window, the first channel. Orders lie level; what "
        "has a fixed frequency falls from left to right (dotted: resonances found).",
        shown,
        ["map_reading"],
        partial(order_map, shown, resonances, unit, count),
        wide=True,
    )
    for number, channel in enumerate(data["channel"].values[:4]):
        pictures.add(
            f"slices-{number + 1}",
            f"Order slices, {channel}",
            "The highest orders over speed; shaded: 95 % intervals.",
            data,
            ["slice_reading", "slice_reading_half_width"],
            partial(over_speed, data, number, unit),
            wide=True,
        )
    told = results.table("figures").get("slices") or {}
    words = [Text(record_lines.resonance(one)) for one in told.get("resonances", [])]
    return Section("orders", "Orders over speed", [*pictures.take(), *words], folded=False)


# --- pictures -----------------------------------------------------------------------------------


LEAST = 1e-4
"""Of the greatest amplitude, below which nothing is told apart."""
MOST = 6
"""Orders drawn as slices."""


def order_map(data: xr.Dataset, resonances: xr.Dataset | None, unit: str, count: str) -> Picture:
    """Amplitude over order and speed; dotted where a resonance in hertz would be."""
    rpm, order = SPEED(data["map_speed"].values), data["map_order"].values
    rising = np.argsort(rpm, kind="stable")
    rpm, values = rpm[rising], data["map_reading"].values[rising]
    kept = np.concatenate([[True], np.diff(rpm) > 1e-9 * rpm[-1]])
    rpm, values = rpm[kept], values[kept]
    top = float(np.nanmax(values, initial=1e-300))
    panel = Panel(Axis("speed [rpm]"), Axis(f"order of {count} [–]"))
    panel.field(
        edges(rpm), edges(order), np.clip(values, LEAST * top, None).T, low=LEAST * top, high=top,
        log=True, colours=scale("magma"), words=f"amplitude (peak) [{unit}]",
    )  # fmt: skip
    if resonances is not None:
        for one in range(resonances.sizes["resonance"]):
            if str(resonances["kind"].values[one]) != "resonance":
                continue
            along = float(resonances["resonance_frequency"].values[one]) / HERTZ(SPEED.stored(rpm))
            inside = (along >= order[0]) & (along <= order[-1])
            panel.curve(
                rpm[inside], along[inside], colour="white", width=0.8, dash=(1.0, 2.5),
                label=f"{float(resonances['resonance_frequency'].values[one]):.5g} Hz",
            )  # fmt: skip
    return Picture([[panel]], size=(WIDE, 4.4), legend=4)


def over_speed(data: xr.Dataset, channel: int, unit: str) -> Picture:
    """Amplitudes of the highest orders of a channel over speed, with their 95 % intervals."""
    rpm = SPEED(data["slice_speed"].values)
    a = data["slice_reading"].values[channel]
    half = data["slice_reading_half_width"].values[channel]
    seen = np.flatnonzero(np.isfinite(a).any(axis=-1))
    tops = np.array([np.nanmax(a[k]) for k in seen])
    panel = Panel(Axis("speed [rpm]"), Axis(f"amplitude (peak) [{unit}]"))
    rising = np.argsort(rpm, kind="stable")
    for k, colour in zip(seen[np.argsort(-tops)][:MOST], OKABE_ITO, strict=False):
        y, h = a[k][rising], half[k][rising]
        panel.band(rpm[rising], low=np.maximum(y - h, 0.0), high=y + h, colour=colour, opacity=0.25)
        panel.curve(rpm[rising], y, colour=colour, width=1.2, label=str(data["name"].values[k]))
    return Picture([[panel]], size=(WIDE, 3.6), legend=3)
