"""The part of a record's page that shows orders over speed."""

from __future__ import annotations

from functools import partial

from thermogear.results.result import Result
from thermogear.views.page import Pictures, Section, Text
from thermogear.views.pages import record_lines
from thermogear.views.plots import slices as plots


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
