"""The part of a record's page that shows orders over speed."""

from __future__ import annotations

from functools import partial
from typing import Any

from thermogear.results.result import Result
from thermogear.views.page import Pictures, Section, Text
from thermogear.views.pages import record_lines
from thermogear.views.plots import slices as plots


def numbers(results: Result) -> dict[str, Any]:
    """The figures, with every order at every step of a run over speed."""
    found, data = results.table("figures"), results.group("slices")
    if data is None or not isinstance(found.get("slices"), dict):
        return found
    steps = {
        name: data[f"slice_{name}"].values.tolist() for name in ("time", "speed", "speed_rate")
    }
    orders = []
    for channel in data["channel"].values:
        for k, name in enumerate(data["name"].values):
            one = data.sel(channel=channel).isel(slice=k)
            share = one["slice_half_width"].values
            rows = {
                "frequency": one["slice_frequency"].values,
                "reading": one["slice_reading"].values,
                "reading_half_width": one["slice_reading_half_width"].values,
                "phase": one["slice_phase"].values,
                "turns": one["slice_turns"].values,
            }
            for moved in ("acceleration", "displacement"):
                rows[moved] = one[f"slice_{moved}"].values
                rows[f"{moved}_half_width"] = share * rows[moved]
            told = {"channel": str(channel), "name": str(name), "order": float(one["slice_order"])}
            orders.append(told | {key: values.tolist() for key, values in rows.items()})
    return {**found, "slices": {**found["slices"], **steps, "orders": orders}}


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
