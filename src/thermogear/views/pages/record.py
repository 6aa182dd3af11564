"""The page of a measured record, and of a comparison, from its stored tree alone."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from thermogear.base.display import SPEED, number
from thermogear.base.units import STANDARD_GRAVITY
from thermogear.results.result import Result
from thermogear.views import tables
from thermogear.views.page import Block, Cell, Page, Pictures, Section, Table, Text
from thermogear.views.pages import record_lines, record_slices
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, INK, WIDE
from thermogear.views.typesetting import html_symbol, prose

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
        lines=lambda: LINES[result.kind](result),
    )


LINES = {"measured": record_lines.measured, "comparison": record_lines.comparison}


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
    data = results.group("lines")
    if data is None:
        return None
    strongest = np.argsort(-data["line_prominence"].values)[:_SHOWN]
    unit = results.text("unit") or "file's"
    head: list[Cell] = ["channel", "line", "order", "cycles/sample", "f [Hz]", "± [Hz]"]
    head += [f"reading [{unit}]", "a [g]", "x [µm]", html_symbol("u_D [%]"), "± [%]"]
    head += ["over floor", "off bin"]
    rows: list[list[str | Markup]] = []
    for place in np.sort(strongest):
        one = data.isel(line=int(place))

        def value(name: str, factor: float = 1.0, *, digits: int = 4, one: xr.Dataset = one) -> str:
            if name not in one:  # stored by an older version
                return "–"
            found = float(one[name]) * factor
            return number(found, digits) if np.isfinite(found) else "–"

        rows.append(
            [
                str(one["channel"].values),
                str(one["name"].values),
                f"{float(one['line_order']):.3f}" if np.isfinite(float(one["line_order"])) else "–",
                f"{float(one['line_position']):.6f}",
                value("line_frequency", digits=8),
                value("line_frequency_half_width", digits=2),
                value("line_reading"),
                value("line_acceleration", 1 / STANDARD_GRAVITY),
                value("line_displacement", 1e6),
                value("line_uncertainty", 100.0),
                value("line_half_width", 100.0, digits=3),
                value("line_prominence"),
                value("line_bin_offset"),
            ]
        )
    caption = prose(
        "Peak amplitudes over the record (root mean square of a line's own amplitude); u_D: "
        "relative standard uncertainty; ±: half width of the 95 % interval. – : the record does "
        "not tell."
    )
    return Section("lines", "Lines", [Table(caption, head, rows, names=2)])


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
    table = tables.words("", ["setting", "value"], [[k, v] for k, v in found.items()])
    return Section("settings", "Settings", [table])


_SHOWN_AS = {
    "displacement": ("displacement [µm]", 1e6),
    "frequency": ("frequency [Hz]", 1.0),
    "acceleration": ("acceleration [m/s²]", 1.0),
}


def comparison_table(data: xr.Dataset) -> Table:
    """Measured and simulated values with the errors of every model and their uncertainties."""
    models = [str(name) for name in data["model"].values]
    beside = {
        words: [str(one) for one in data[name].values]
        for words, name in (("record", "record"), ("channel: place, axis; line", "where"))
        if name in data.coords and any(data[name].values)
    }
    head: list[Cell] = [*beside, "speed [rpm]", "quantity", "verdict", "measured", *models]
    printed, blank = "printed" in data.coords, [""] * len(models)
    head += [f"error {name} [%]{', printed | recomputed' * printed}" for name in models]
    head += [html_symbol(f"{u} [%]") for u in ("u_num", "u_input", "u_D", "u_val")]
    rows: list[list[str | Markup]] = []
    for place in range(data.sizes["row"]):
        one = data.isel(row=place)
        words, factor = _SHOWN_AS[str(one["quantity"].values)]
        rows.append(
            [
                *(texts[place] for texts in beside.values()),
                number(SPEED(float(one["pinion_speed"])), 4),
                words,
                str(one["verdict"].values) or "–",
                number(float(one["measured_value"]) * factor, 5),
                *(number(float(v) * factor, 5) for v in one["simulated_value"].values),
                *(
                    f"{text} | {100 * v:+.2f}".removeprefix(" | ").replace("-", "−")
                    for v, text in zip(
                        one["comparison_error"].values.tolist(),
                        one["printed"].values if printed else blank,
                        strict=True,
                    )
                ),
                *(f"{100 * float(one[u]):.2f}" for u in ("u_num", "u_input", "u_data", "u_val")),
            ]
        )
    marked = np.flatnonzero(data["misprinted"].values).tolist() if printed else []
    wrong = " Marked: a printed error that its entries cannot give, however they were rounded."
    return Table(
        f"Error: (simulated − measured)/measured.{wrong * bool(marked)}", head, rows,
        names=3 + len(beside), marked=frozenset(marked),
    )  # fmt: skip


def implied_table(implied: xr.Dataset) -> Table:
    """Acceleration, speed and distance from the mesh line that measured lines imply."""
    lines: list[list[str | Markup]] = [
        [
            number(SPEED(float(implied["pinion_speed"].values[i])), 4),
            f"{float(implied['implied_acceleration'].values[i]) / STANDARD_GRAVITY:.1f}",
            _maybe(SPEED(float(implied["implied_shaft_speed"].values[i])), 1),
            _maybe(float(implied["mesh_line_offset"].values[i]), 2),
            _maybe(float(implied["line_bin_offset"].values[i]), 2),
        ]
        for i in range(implied.sizes["speed"])
    ]
    names = [
        "speed [rpm]", "implied a [g]", "implied speed [rpm]", "off mesh [Hz]", "off mesh [bins]",
    ]  # fmt: skip
    return Table("What the measured lines imply.", names, lines, names=0)


def _comparison(results: Result) -> Section | None:
    data = results.group("comparison")
    if data is None:
        return None
    blocks: list[Block] = [comparison_table(data)]
    heat = results.table("figures").get("heat", ())
    if heat:
        told: list[list[str | Markup]] = [
            [one["bundle"] or "–", one["verdict"], f"{one['nearer']} of {one['rows']}",
             *(f"{100 * one[name]:+.2f}".replace("-", "−") for name in ("gain", "u_val"))]
            for one in heat
        ]  # fmt: skip
        heads = ["bundle", "nearer", "with heat nearer in", "mean gain [%]", "mean u_val [%]"]
        blocks.insert(
            0, Table("Gain: |E without heat| − |E with heat|, over all.", heads, told, names=2)
        )
    implied = results.group("implied")
    blocks += [implied_table(implied)] if implied is not None else []
    return Section("comparison", "Comparison", blocks, folded=False)


def _maybe(value: float, digits: int) -> str:
    return f"{value:.{digits}f}".replace("-", "−") if np.isfinite(value) else "–"
