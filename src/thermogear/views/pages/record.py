"""The page of a measured record, and of a comparison, from its stored tree alone."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import SPEED, number
from thermogear.results.result import Result
from thermogear.views.columns import pairs
from thermogear.views.page import Page, Pictures, Section, Text
from thermogear.views.pages import record_lines, record_slices, record_tables
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, INK, WIDE

if TYPE_CHECKING:
    import xarray as xr

_SHOWN = 60  # lines of the table: the most prominent
_BINS = 3.0  # to each side of a line, in which its curve is looked at
_SCALLOP = 1.25  # of a line between two bins, by the window 1.18 at most


KINDS = ("measured", "comparison")


def page(result: Result) -> Page:
    """A measured record, or models against one."""
    made = (
        _comparison,
        _findings,
        _record,
        _spectrum,
        record_slices.section,
        _lines,
        _evidence,
        _settings,
    )
    return Page(
        result,
        result.text("conclusion") or _summary(result),
        [section for make in made if (section := make(result)) is not None],
        numbers=lambda: record_slices.numbers(result),
        told=lambda: record_lines.TOLD[result.kind](result),
    )


def _summary(results: Result) -> str:
    rate, unit, teeth = (results.text(name) for name in ("rate", "unit", "teeth"))
    said = [
        f"{number(float(rate), 6)} samples/s" if rate else "no rate is known: orders only",
        f"amplitudes in {unit}" if unit else "no unit is known: the file's own numbers",
        f"{teeth} teeth on the first shaft" if teeth else "the teeth are undecided",
    ]
    return "; ".join(said) + "."


def _record(results: Result) -> Section | None:
    data, whole = results.group("record"), results.group("whole")
    if data is None:
        return None
    rate = results.text("rate")
    unit = results.text("unit") or "the file's numbers"
    x_words = "time [s]" if rate else "sample [–]"

    def make() -> Picture:
        panel = Panel(Axis(x_words), Axis(f"reading [{unit}]"))
        count = min(data.sizes["sample"], 2048)
        place = data["record_sample"].values[:count]
        x = place / float(rate) if rate else place
        for channel, colour in zip(data["channel"].values[:4], _COLOURS, strict=False):
            values = data["record_reading"].sel(channel=channel).values[:count]
            panel.curve(x, values, colour=colour, width=0.6, label=str(channel))
        return Picture([[panel]], size=(WIDE, 2.8), legend=4)

    def make_whole() -> Picture:
        assert whole is not None
        panel = Panel(Axis(x_words), Axis(f"reading [{unit}]"))
        place = whole["piece_sample"].values
        x = place / float(rate) if rate else place
        for channel, colour in zip(whole["channel"].values[:4], _COLOURS, strict=False):
            one = whole.sel(channel=channel)
            low, high = one["piece_lowest"].values, one["piece_highest"].values
            panel.band(x, low=low, high=high, colour=colour, opacity=0.4, label=str(channel))
        return Picture([[panel]], size=(WIDE, 2.8), legend=4)

    pictures = Pictures()
    if whole is not None:
        caption = "Lowest to highest reading of each piece, after repair: a burst, a drift or a "
        caption += "pause shows here."
        needs = ["piece_lowest", "piece_highest"]
        pictures.add("whole", "The whole record", caption, whole, needs, make_whole, wide=True)
    caption = "The first samples, unfiltered."
    needs = ["record_reading"]
    pictures.add("record", "Start of the record", caption, data, needs, make, wide=True)
    return Section("record", "Time record", pictures.take(), folded=False)


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
    caption = "Hann window over the whole record; of each run of bins the highest is drawn."
    marked = None
    if lines is not None:
        marked = lines.where(lines["kind"] != "sideband", drop=True)
        if _above(data, marked):
            caption += (
                " Marks are above the curve where a line lies over several bins, as the speed or "
                "the load wanders: its amplitude holds them all."
            )
            words = words.replace("shaft [", "shaft at its mean speed [")
    pictures = Pictures()
    make = partial(_drawn_spectrum, data, marked, scale, words, _unit(results))
    needs = ["spectrum_reading"]
    pictures.add("spectrum", "Spectrum with the lines found", caption, data, needs, make, wide=True)
    return Section("spectrum", "Spectrum", pictures.take(), folded=False)


def _spectrum_of_run(results: Result, data: xr.Dataset, slices: xr.Dataset) -> Section:
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
    data: xr.Dataset, marked: xr.Dataset | None, scale: float, words: str, unit: str
) -> Picture:
    """Curves over ``spectrum_position`` times ``scale``, and marks of lines."""
    panel = Panel(Axis(words), Axis(f"amplitude (peak) [{unit}]", log="decades"))
    x = data["spectrum_position"].values * scale
    for channel, colour in zip(data["channel"].values[:4], _COLOURS, strict=False):
        values = data["spectrum_reading"].sel(channel=channel).values
        panel.curve(x[1:], values[1:], colour=colour, width=0.5, label=str(channel))
    if marked is not None:
        places = marked["line_position"].values * scale
        readings, text = marked["line_reading"].values, "lines of the table"
        panel.points(places, readings, size=4, open=True, colour=INK, label=text)
    return Picture([[panel]], size=(WIDE, 3.6), legend=5)


def _above(data: xr.Dataset, marked: xr.Dataset) -> bool:
    """Whether a channel's strongest line is above its curve by more than the window takes."""
    x = data["spectrum_position"].values
    if x.size < 2:
        return False
    for channel in data["channel"].values:
        own = marked.where(marked["channel"] == channel, drop=True)
        readings = own["line_reading"].values
        if not np.isfinite(readings).any():
            continue
        best = int(np.nanargmax(readings))
        near = np.abs(x - own["line_position"].values[best]) <= _BINS * (x[1] - x[0])
        curve = data["spectrum_reading"].sel(channel=channel).values[near]
        if curve.size and readings[best] > _SCALLOP * curve.max():
            return True
    return False


def _unit(results: Result) -> str:
    return results.text("unit") or "the file's numbers"


_COLOURS = (COLD, HOT, "#009E73", "#CC79A7")


def _lines(results: Result) -> Section | None:
    table = record_tables.line_table(results, _SHOWN)
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
    told = [*record_lines.given_and_found(results.table("figures")), *map(str, found)]
    return Section("evidence", "How the gearing was found", [Text(text) for text in told])


def _settings(results: Result) -> Section | None:
    found = results.table("settings")
    if not found:
        return None
    table = pairs("", ("setting", "value"), found, wordy=True)
    return Section("settings", "Settings", [table])


def _comparison(results: Result) -> Section | None:
    tables = record_tables.comparison_tables(results)
    if results.group("comparison") is None:
        return None
    return Section("comparison", "Comparison", tables, folded=False)
