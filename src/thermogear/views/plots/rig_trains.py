"""Pictures of the thesis's experiment on sampled drive trains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import MICROMETRE, PERCENT, SPEED
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, FAINT, HOT, INK, OKABE_ITO, SINGLE, WIDE, scale

if TYPE_CHECKING:
    import xarray as xr


def displacements(data: xr.Dataset) -> Picture:
    """Every train's nearest channel over speed, the spread of the largest, and the printed ones."""
    rpm = SPEED(data["rig_speed"].values)
    panels = []
    for place, words in zip(data["place"].values, data["place_words"].values, strict=True):
        one = data.sel(place=place)
        panel = Panel(
            Axis("pinion speed [rpm]", ticks=rpm, names=[f"{v:.0f}" for v in rpm]),
            Axis(log="plain", low=0.01, high=100.0),
            str(words),
        )
        low, middle, high = (MICROMETRE(one["spread"].values[:, k]) for k in range(3))
        panel.band(
            rpm, low=low, high=high, colour=FAINT, order=0.5,
            label="largest of all channels, 5 to 95 % of the trains",
        )  # fmt: skip
        for number, line in enumerate(MICROMETRE(one["nearest"].values)):
            label = "nearest channel of each train" if number == 0 else ""
            panel.curve(rpm, line, colour=COLD, width=0.25, opacity=0.6, label=label)
        panel.curve(rpm, middle, colour=INK, width=1.6, dash=(4, 3), label="its median")
        panel.curve(rpm, MICROMETRE(data["printed"].values), colour=HOT, width=1.6)
        panel.points(
            rpm, MICROMETRE(data["printed"].values), colour=HOT, label="measured, as printed"
        )
        panels.append(panel)
    panels[0].y.words = "displacement at the mesh line [µm]"
    return Picture([panels], size=(WIDE, 3.4), share_y="row", between=0.2, legend=4)


def factors(data: xr.Dataset) -> Picture:
    """The share of trains whose nearest channel lies within a factor of the printed values."""
    panel = Panel(
        Axis("factor allowed at all three speeds [–]", log="full", low=1.0, high=1000.0),
        Axis("share of the sampled trains [%]", low=0.0, high=100.0),
    )
    count = data.sizes["train"]
    for place, colour in zip(data["seen"].values, (INK, *OKABE_ITO), strict=False):
        needed = np.sort(data["needed_factor"].sel(seen=place).values)
        share = PERCENT(np.arange(1, count + 1) / count)
        words = str(data["seen_words"].sel(seen=place).item())
        panel.curve(needed, share, colour=colour, label=words)
    panel.line(x=float(data.attrs["near"]), colour=HOT, width=1.0, dash=(4, 3))
    return Picture([[panel]], size=(SINGLE[0] + 1.6, SINGLE[1]), legend=1)


def ranks(data: xr.Dataset) -> Picture:
    """Rank correlations as a map: a row for every result, a column for every assumption."""
    outputs = [str(v) for v in data["target_words"].values]
    inputs = [str(v) for v in data["input_words"].values]
    columns, rows = np.arange(len(inputs) + 1) - 0.5, np.arange(len(outputs) + 1) - 0.5
    panel = Panel(
        Axis(ticks=columns[:-1] + 0.5, names=inputs, slant=60.0),
        Axis(low=rows[-1], high=rows[0], ticks=rows[:-1] + 0.5, names=outputs),
    )
    rank, error = data["rank"].values, data["rank_error"].values
    panel.field(columns, rows, np.abs(rank), colours=scale("Blues"), low=0.0, high=1.0)
    for r, c in np.argwhere(np.abs(rank) > 3.0 * error).tolist():
        colour = "#ffffff" if abs(rank[r, c]) > 0.6 else INK
        words = f"{PERCENT(rank[r, c]):+.0f}".replace("-", "−")
        panel.text(c, r, words, size=7.4, colour=colour)
    return Picture([[panel]], size=(WIDE, 4.2), left=3.0, top=0.2, bottom=2.9)
