"""The part of a record's page that shows orders over speed."""

from __future__ import annotations

from functools import partial
from typing import Any

from thermogear.results.result import Result
from thermogear.views.columns import Column, by_name, key
from thermogear.views.page import Pictures, Section, Text
from thermogear.views.pages import record_lines
from thermogear.views.plots import slices as plots


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
        partial(plots.order_map, shown, resonances, unit, count),
        wide=True,
    )
    for number, channel in enumerate(data["channel"].values[:4]):
        pictures.add(
            f"slices-{number + 1}",
            f"Order slices, {channel}",
            "The highest orders over speed; shaded: 95 % intervals.",
            data,
            ["slice_reading", "slice_reading_half_width"],
            partial(plots.over_speed, data, number, unit),
            wide=True,
        )
    told = results.table("figures").get("slices") or {}
    words = [Text(record_lines.resonance(one)) for one in told.get("resonances", [])]
    return Section("orders", "Orders over speed", [*pictures.take(), *words], folded=False)
