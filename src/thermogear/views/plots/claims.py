"""Pictures of the thesis's report that no run has: diagrams with flips, grids, the test table."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS, PERCENT, SPEED, Display
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import (
    COLD,
    FAINT,
    HOT,
    INK,
    MIXED,
    QUIET,
    SINGLE,
    WIDE,
    ramp,
    scale,
)

HEATS = {
    "none": ("without heat", COLD),
    "thesis": ("heat as in the thesis", HOT),
    "consistent": ("heat by E(T)", MIXED),
}


def over_grid(data: Dataset, name: str, unit: str, scale: Display) -> Picture:
    """One quantity over speed, a curve per torque: temperatures given beside the heat balance."""
    rpm = SPEED(data["speed"].values)
    torques = data["torque"].values
    titles = {"given": "gear temperature given", "balance": "gear temperature from the balance"}
    kinds: dict[str, tuple[str, tuple[float, ...]]] = {
        "_mixed": ("mixed, ", ()), "_dry": ("dry, ", (5, 2)), "": ("", ())
    }  # fmt: skip
    panels = []
    for thermal, title in titles.items():
        here = data.sel(thermal=thermal)
        panel = Panel(Axis("pinion speed $n_{1}$ [rpm]"), Axis(low=0.0), title)
        for place, colour in enumerate(ramp(len(torques))):
            for kind, (words, dash) in kinds.items():
                if name + kind in here:
                    values = scale(here[name + kind].values[:, place])
                    label = f"{words}{torques[place]:.0f} N m"
                    panel.curve(rpm, values, colour=colour, dash=dash, label=label)
        panels.append(panel)
    panels[0].y.words = unit
    return Picture([panels], size=(WIDE, 3.3), share_y="row", between=0.3, legend=5)


def warming(data: Dataset) -> Picture:
    """The largest Floquet multiplier over temperature, and where it reaches the border."""
    panel = Panel(Axis("gear temperature T [°C]"), Axis("largest Floquet multiplier, modulus [–]"))
    celsius = CELSIUS(data["temperature"].values)
    for row, colour in (("thesis", HOT), ("consistent", MIXED)):
        modulus = data["multiplier"].sel(row=row).values
        flip = CELSIUS(float(data["flip"].sel(row=row)))
        x, y = celsius, modulus
        if np.isfinite(flip):
            place = int(np.searchsorted(celsius, flip))
            x, y = np.insert(celsius, place, flip), np.insert(modulus, place, 1.0)
            panel.line(x=flip, colour=QUIET, width=0.9, dash=(4, 3))
            panel.text(
                flip, 0.5, f"flip at {flip:.1f} °C", at="x", offset=(4, 0), across="left",
                up="baseline", colour=QUIET,
            )  # fmt: skip
        panel.curve(x, y, colour=colour, label=HEATS[row][0])
        panel.points(celsius, modulus, colour=colour)
    panel.line(y=1.0, colour=FAINT, width=1.2)
    return Picture([[panel]], legend=2)


def experiment(data: Dataset) -> Picture:
    """Errors of the displacement, printed and recomputed, beside the validation uncertainty."""
    here = data.isel(row=np.flatnonzero(data["quantity"].values == "displacement"))
    rpm = SPEED(here["pinion_speed"].values)
    place = np.arange(rpm.size)
    panel = Panel(
        Axis("pinion speed [rpm]", ticks=place, names=[f"{v:.0f}" for v in rpm]),
        Axis("error of the displacement [%]"),
    )
    words, uncertain = "validation uncertainty u_val", PERCENT(here["u_val"].values)
    panel.bars(place, uncertain, width=0.86, colour=FAINT, label=words, order=0.6)
    for column, (shift, colour) in enumerate(((-0.2, HOT), (0.2, COLD))):
        one = here.isel(model=column)
        panel.bars(
            place + shift, PERCENT(np.abs(one["comparison_error"].values)), width=0.36,
            colour=colour, label=f"{one['model'].item()}, recomputed",
        )  # fmt: skip
        printed = [float(v) for v in one["printed"].values]
        panel.points(
            place + shift, printed, marker="level", size=14, colour=INK, label="as printed"
        )
    return Picture([[panel]], size=(SINGLE[0] + 0.6, SINGLE[1]), legend=2)


def sensitivity(data: Dataset) -> Picture:
    """Total indices as a map: a row for every result, a column for every input."""
    outputs = [str(v) for v in data["output_words"].values]
    inputs = [str(v) for v in data["input_words"].values]
    total = np.clip(data["total"].values, 0.0, None)
    columns, rows = np.arange(len(inputs) + 1) - 0.5, np.arange(len(outputs) + 1) - 0.5
    panel = Panel(
        Axis(ticks=columns[:-1] + 0.5, names=inputs, slant=35.0),
        Axis(low=rows[-1], high=rows[0], ticks=rows[:-1] + 0.5, names=outputs),
    )
    panel.field(columns, rows, total, colours=scale("Blues"), low=0.0, high=1.0)
    spread = data["total_conf"].values
    for r, c in np.argwhere(total - spread > 0.01).tolist():
        value = float(total[r, c])
        words = f"{PERCENT(value):.0f}±{PERCENT(float(spread[r, c])):.0f}"
        panel.text(c, r, words, size=7.4, colour="#ffffff" if value > 0.6 else INK)
    size = (WIDE, 0.36 * len(outputs) + 2.5)
    return Picture([[panel]], size=size, left=3.1, top=0.2, bottom=1.45)
