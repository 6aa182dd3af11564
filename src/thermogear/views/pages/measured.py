"""The page of a measured record, and of a comparison, from its stored tree alone."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import PERCENT, SPEED, number
from thermogear.results.result import Result
from thermogear.views.columns import Column, by_name, key, pairs
from thermogear.views.page import Block, Page, Pictures, Section, Text
from thermogear.views.pages.record_tables import comparison_tables, line_table
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.sweeps import edges
from thermogear.views.style import COLD, HOT, INK, OKABE_ITO, WIDE, scale

_SHOWN = 60  # lines of the table: the most prominent


KINDS = ("measured", "comparison")


def page(result: Result) -> Page:
    """A measured record, or models against one."""
    made = (
        _comparison,
        _findings,
        _record,
        _spectrum,
        _orders,
        _lines,
        _evidence,
        _settings,
    )
    return Page(
        result,
        result.text("conclusion") or headline(result.table("figures")),
        [section for make in made if (section := make(result)) is not None],
        numbers=lambda: numbers(result),
        told=lambda: TOLD[result.kind](result),
    )


def headline(figures: Mapping[str, Any]) -> str:
    """What a record shows, in one sentence: its first line in the channel where it is highest.

    >>> line = {"channel": "a", "name": "line x 1", "kind": "line", "unit": "g", "reading": 1.5,
    ...         "frequency": 29.667, "position": 0.002, "relative_half_width": 0.01}
    >>> headline({"lines": [line], "teeth": None, "course": "steady"})
    'Clearest line at 29.667 Hz, 1.50 g; no gear is decided: steady.'
    """
    lines = [line for line in figures["lines"] if line["reading"] is not None]
    named = next((line["name"] for line in lines if line["kind"] != "order"), None)
    if named is None:
        return "No line is told from the noise."
    first = max((line for line in lines if line["name"] == named), key=lambda line: line["reading"])
    hertz, kind = first["frequency"], first["kind"]
    place = f"{first['position']:.6f} cycles/sample" if hertz is None else f"{number(hertz, 5)} Hz"
    what = {"mesh": "Mesh line", "shaft": f"Line of the shaft ({named})"}.get(kind, "Clearest line")
    teeth = f" of {figures['teeth']} teeth" if kind == "mesh" else ""
    sides = [
        line["reading"] / first["reading"]
        for line in lines
        if line["kind"] == "sideband"
        and line["channel"] == first["channel"]
        and line["name"].startswith(f"{named} ")
    ]
    size = f"{number(first['reading'], 3)} {first['unit'] or '(no unit)'}"
    beside = f", sidebands {number(PERCENT(max(sides)), 2)} %" if sides else ""
    open_to = "" if kind == "mesh" else "; no gear is decided"
    return f"{what}{teeth} at {place}, {size}{beside}{open_to}: {figures['course']}."


def _record(results: Result) -> Section | None:
    data, whole = results.group("record"), results.group("whole")
    if data is None:
        return None
    pictures = Pictures()
    if whole is not None:
        pictures.add(
            "whole", "The whole record",
            "Lowest to highest reading of each piece, after repair: a burst, a drift or a pause "
            "shows here.",
            whole, ("piece_lowest", "piece_highest"), partial(_whole_record, results, whole),
            wide=True,
        )  # fmt: skip
    pictures.add(
        "record", "Start of the record", "The first samples, unfiltered.", data,
        ("record_reading",), partial(_start_of_record, results, data), wide=True,
    )  # fmt: skip
    return Section("record", "Time record", pictures.take(), folded=False)


def _over_time(results: Result, samples: Floats) -> tuple[Panel, Floats]:
    """An empty panel of readings, and where ``samples`` stand in it."""
    rate = results.text("rate")
    x = Axis("time [s]" if rate else "sample [–]")
    panel = Panel(x, Axis(f"reading [{_unit(results)}]"))
    return panel, samples / float(rate) if rate else samples


def _start_of_record(results: Result, data: Dataset) -> Picture:
    shown = data.isel(sample=slice(2048))
    panel, x = _over_time(results, shown["record_sample"].values)
    for channel, colour in zip(data["channel"].values[:4], _COLOURS, strict=False):
        values = shown["record_reading"].sel(channel=channel).values
        panel.curve(x, values, colour=colour, width=0.6, label=str(channel))
    return Picture([[panel]], size=(WIDE, 2.8), legend=4)


def _whole_record(results: Result, whole: Dataset) -> Picture:
    panel, x = _over_time(results, whole["piece_sample"].values)
    for channel, colour in zip(whole["channel"].values[:4], _COLOURS, strict=False):
        one = whole.sel(channel=channel)
        low, high = one["piece_lowest"].values, one["piece_highest"].values
        panel.band(x, low=low, high=high, colour=colour, opacity=0.4, label=str(channel))
    return Picture([[panel]], size=(WIDE, 2.8), legend=4)


def _spectrum(results: Result) -> Section | None:
    """The spectrum over time: with the lines where the speed is steady, else in hertz without."""
    data, lines = results.group("spectrum"), results.group("lines")
    if data is None:
        return None
    slices = results.group("slices")
    if slices is not None:
        return _spectrum_of_run(results, data, slices)
    mesh, teeth = results.text("mesh_position"), results.text("teeth")
    scale = int(teeth) / float(mesh) if mesh and teeth else 1.0
    words = "order of the first shaft [–]" if scale != 1.0 else "frequency [cycles/sample]"
    caption = (
        "Hann window over the whole record; of each run of bins the highest is drawn. A mark is "
        "above the curve where a line lies over several bins, as the speed or the load wanders."
    )
    pictures = Pictures()
    make = partial(_drawn_spectrum, data, lines, scale, words, _unit(results))
    needs = ["spectrum_reading"]
    pictures.add("spectrum", "Spectrum with the lines found", caption, data, needs, make, wide=True)
    return Section("spectrum", "Spectrum", pictures.take(), folded=False)


def _spectrum_of_run(results: Result, data: Dataset, slices: Dataset) -> Section:
    """Of a run whose speed changes: no line has one frequency, so none is marked."""
    rate, speed = results.text("rate"), SPEED(slices["slice_speed"].values)
    words = "frequency [Hz]" if rate else "frequency [cycles/sample]"
    known = bool(rate) and not int(slices.attrs.get("of_mesh", 0))
    ends = f"from {speed.min():.5g} to {speed.max():.5g} rpm"
    span = ends if known else f"by a factor {speed.max() / speed.min():.3g}"
    caption = (
        f"Hann window over the whole record in time, in which the speed changes {span}: an order "
        "is spread over its frequencies, so this shows no order, and no line of the table is "
        "marked (Orders over speed has them). What is sharp here has a fixed frequency, or a speed "
        "was held. Of each run of bins the highest is drawn."
    )
    pictures = Pictures()
    scale = float(rate) if rate else 1.0
    make = partial(_drawn_spectrum, data, None, scale, words, _unit(results))
    needs = ["spectrum_reading"]
    pictures.add("spectrum", "Spectrum over time", caption, data, needs, make, wide=True)
    return Section("spectrum", "Spectrum", pictures.take(), folded=False)


def _drawn_spectrum(
    data: Dataset, lines: Dataset | None, scale: float, words: str, unit: str
) -> Picture:
    """Curves over ``spectrum_position`` times ``scale``, and marks of lines but sidebands."""
    panel = Panel(Axis(words), Axis(f"amplitude (peak) [{unit}]", log="decades"))
    x = data["spectrum_position"].values * scale
    for channel, colour in zip(data["channel"].values[:4], _COLOURS, strict=False):
        values = data["spectrum_reading"].sel(channel=channel).values
        panel.curve(x[1:], values[1:], colour=colour, width=0.5, label=str(channel))
    if lines is not None:
        marked = lines["kind"].values != "sideband"
        places = lines["line_position"].values[marked] * scale
        readings, text = lines["line_reading"].values[marked], "lines of the table"
        panel.points(places, readings, size=4, open=True, colour=INK, label=text)
    return Picture([[panel]], size=(WIDE, 3.6), legend=5)


def _unit(results: Result) -> str:
    return results.text("unit") or "the file's numbers"


_COLOURS = (COLD, HOT, "#009E73", "#CC79A7")


def _lines(results: Result) -> Section | None:
    table = line_table(results, _SHOWN)
    return None if table is None else Section("lines", "Lines", [table])


def _findings(results: Result) -> Section | None:
    found = results.values("findings")
    if not found:
        return None
    texts = [Text(str(text)) for text in found]
    return Section("findings", "Damage of the record", texts, folded=False)


def _evidence(results: Result) -> Section | None:
    found = results.values("evidence")
    if not found:
        return None
    told = [*given_and_found(results.table("figures")), *map(str, found)]
    return Section("evidence", "How the gearing was found", [Text(text) for text in told])


def _settings(results: Result) -> Section | None:
    found = results.table("settings")
    if not found:
        return None
    table = pairs("", ("setting", "value"), found, wordy=True)
    return Section("settings", "Settings", [table])


def _comparison(results: Result) -> Section | None:
    tables = comparison_tables(results)
    if results.group("comparison") is None:
        return None
    return Section("comparison", "Comparison", tables, folded=False)


# --- pictures -----------------------------------------------------------------------------------


def measured(result: Result) -> list[Block]:
    """Evidence, settings, and a row for each line."""
    found = result.table("figures")
    told = [headline(found), *given_and_found(found)]
    told += [f"evidence: {text}" for text in found["evidence"]]
    told += [f"{name}: {value}" for name, value in result.table("settings").items()]
    if found.get("shaft_speed") is not None:
        told.append(_shaft(found))
    table = line_table(result)
    tables = [table] if table else []
    return [*map(Text, told), *tables, *map(Text, slices(found.get("slices")))]


def slices(found: Mapping[str, Any] | None) -> list[str]:
    """Greatest amplitude of every order of a run over speed."""
    if found is None:
        return []
    what = "the mesh line" if found["of_mesh"] else "the first shaft"
    told = [
        f"orders of {what} over speed, {found['steps']} steps; where each reads highest, and the "
        "95 % interval of the greatest true amplitude of all its steps (one step alone is known "
        "better, but the highest of many is high by noise too):"
    ]
    return told + [_greatest(one) for one in found["greatest"]]


def _greatest(one: Mapping[str, Any]) -> str:
    interval = ""
    if "greatest_low" in one:  # not stored by older versions
        low, high = one["greatest_low"], one["greatest_high"]
        interval = f"; greatest of {one['steps']} steps {low:.5g}..{high:.5g}"
    return (
        f"{one['channel'][:12]:12} {one['name'][:22]:22} order {one['order']:9.3f}: "
        f"{one['reading']:.5g} at {SPEED(one['speed']):.5g} rpm, "
        f"{one['frequency']:.5g} Hz{interval}"
    )


def _shaft(found: Mapping[str, Any]) -> str:
    """The shaft's speed with its interval, or as a mean with its range."""
    speed, half = SPEED(found["shaft_speed"]), found["shaft_speed_half_width"]
    span = found.get("shaft_speed_range")
    if span is not None:
        low, high = (SPEED(one) for one in span)
        return f"mean shaft speed over the record: {speed:.6g} rpm (from {low:.5g} to {high:.5g})"
    around = f" +- {SPEED(half):.3g} rpm (95 %)" if half is not None else ""
    return f"shaft speed: {speed:.8g} rpm{around}"


def given_and_found(figures: Mapping[str, Any]) -> list[str]:
    """What the user said, and whether lines confirm the teeth, apart; nothing for results of older
    versions."""
    if "teeth_confirmed" not in figures:
        return []
    given = figures["given"]
    said = [f"{given['teeth']} teeth"] if given["teeth"] is not None else []
    said += [f"{SPEED(given['speed']):.6g} rpm"] if given["speed"] is not None else []
    teeth, seen = figures["teeth"], "undecided"
    if figures["teeth_confirmed"]:
        seen = f"sidebands of the {teeth} teeth given"
    elif teeth is not None and teeth == given["teeth"]:
        seen = f"{teeth} as given; no sidebands confirm them"
    elif teeth is not None:
        seen = f"{teeth}, by the shaft's speed and the sidebands; no other number fits"
    return [f"given: {', '.join(said) if said else 'neither teeth nor speed'}", f"teeth: {seen}"]


def comparison(result: Result) -> list[Block]:
    """The tables of the page, the conclusion."""
    return [*comparison_tables(result), Text(result.table("figures")["conclusion"])]


TOLD = {"measured": measured, "comparison": comparison}


# --- pictures -----------------------------------------------------------------------------------


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


def _orders(results: Result) -> Section | None:
    """Order map, slices with their intervals; None for a steady speed."""
    data, shown = results.group("slices"), results.group("map")
    if data is None or shown is None:
        return None
    unit = results.text("unit") or "the file's numbers"
    count = "the mesh line" if int(data.attrs.get("of_mesh", 0)) else "the first shaft"
    pictures = Pictures()
    pictures.add(
        "order-map",
        "Order map",
        "Amplitude by order over speed, Hann window, the first channel. Orders lie level; what "
        "has a fixed frequency falls from left to right.",
        shown,
        ["map_reading"],
        partial(order_map, shown, unit, count),
        wide=True,
    )
    for place, channel in enumerate(data["channel"].values[:4]):
        pictures.add(
            f"slices-{place + 1}",
            f"Order slices, {channel}",
            "The highest orders over speed; shaded: 95 % intervals.",
            data,
            ["slice_reading", "slice_reading_half_width"],
            partial(over_speed, data, place, unit),
            wide=True,
        )
    return Section("orders", "Orders over speed", pictures.take(), folded=False)


# --- pictures -----------------------------------------------------------------------------------


LEAST = 1e-4
"""Of the greatest amplitude, below which nothing is told apart."""
MOST = 6
"""Orders drawn as slices."""


def order_map(data: Dataset, unit: str, count: str) -> Picture:
    """Amplitude over order and speed."""
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
    return Picture([[panel]], size=(WIDE, 4.4), legend=4)


def over_speed(data: Dataset, channel: int, unit: str) -> Picture:
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
