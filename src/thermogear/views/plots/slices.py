"""Orders of a measured run over speed: the map, and slices with their intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import HERTZ, SPEED
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.sweeps import edges
from thermogear.views.style import OKABE_ITO, WIDE, scale

if TYPE_CHECKING:
    import xarray as xr

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
