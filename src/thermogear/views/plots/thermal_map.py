"""The map of everything hot over speed and torque."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from thermogear.base.display import CELSIUS, MICROMETRE, PERCENT, SPEED
from thermogear.base.vocabulary import is_known
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import INK, OKABE_ITO, WIDE, scale

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]

AXES = ("pinion speed [rpm]", "pinion torque [N m]")
SAFE = 50.0
"""Scuffing margin [K] that is advised at least."""


def thermal_map(data: xr.Dataset) -> Picture:
    """Regime, flash, body temperature, backlash left, scuffing margin and friction: six maps.

    Points without a steady state are white; where the oil leaves its viscosity line the map is
    hatched. Where only one of speed and torque runs there are six lines over it instead.
    """
    settled = is_known(data["status"].values)

    def kept(values: Floats) -> Floats:
        return np.where(settled, values, np.nan)

    share = kept(PERCENT(data["regime_share"].isel(regime_name=0).values))
    boundary = _panel(data, share, "boundary lubrication [% of path]", "Reds", (0, 100))
    film = kept(data["least_film_parameter"].values)
    levels = _nice(film, 3)
    _lines(boundary, data, film, levels, [f"Λ = {level:.2g}" for level in levels])
    greatest = kept(data["greatest_flash"].values)
    flash = _panel(data, greatest, "greatest flash temperature [K]", "YlOrRd")
    teeth = kept(CELSIUS(data["node_temperature"].sel(node="pinion_tooth").values))
    body = _panel(data, teeth, "pinion teeth, body temperature [°C]", "YlOrRd")
    tempering = np.where(data["tempered"].values == 1, 1.0, 0.0)
    if 0.0 < tempering.mean() < 1.0:
        _lines(body, data, tempering, [0.5], ["tempered"])
    gap = kept(MICROMETRE(data["least_half_backlash"].values))
    left = _panel(data, gap, "half backlash left [µm]", "viridis")
    if min(gap.shape) > 1:
        _jam(left, data, gap)
    values, words = kept(data["scuffing_margin"].values), "scuffing margin [K]"
    if np.isfinite(values).any() or not settled.any():
        # red is always below 0 K and the deepest green the greatest margin
        known = values[np.isfinite(values)]
        ends = (float(np.min(known, initial=-SAFE)), float(np.max(known, initial=2.0 * SAFE)))
        margin = _panel(data, values, words, "RdYlGn", ends)
        if min(values.shape) < 2:
            for level in (0.0, SAFE):
                margin.line(y=level, colour=INK, width=0.9, dash=(2, 2))
        _lines(margin, data, values, [0.0, SAFE], ["0 K", f"{SAFE:.0f} K"])
    else:
        margin = Panel(Axis(AXES[0]), Axis(AXES[1])) if min(values.shape) > 1 else Panel()
        margin.note("no scuffing margin: the load stage of the oil is not known")
    mean = kept(data["mean_friction"].values)
    friction = _panel(data, mean, "mean friction coefficient [–]", "PuBu")
    panels = [[boundary, flash, body], [left, margin, friction]]
    outside = (data["within_oil_range"].values == 0) & settled
    if outside.any() and min(outside.shape) > 1:
        for panel in (*panels[0], *panels[1]):
            panel.hatch(*_grid(data), outside.T)
    return Picture(panels, size=(WIDE, 6.6), between=0.96, above=0.95, right=0.5)


def _grid(data: xr.Dataset) -> tuple[Floats, Floats]:
    return SPEED(data["pinion_speed"].values), data["pinion_torque"].values


def _panel(
    data: xr.Dataset,
    values: Floats,
    title: str,
    colours: str,
    ends: tuple[float, float] | None = None,
) -> Panel:
    """Filled contours over speed and torque; a grid of one line is drawn as that line."""
    speed, torque = _grid(data)
    line = min(values.shape) < 2
    along, words = (speed, AXES[0]) if speed.size >= torque.size else (torque, AXES[1])
    panel = Panel(Axis(words), Axis(title)) if line else Panel(Axis(AXES[0]), Axis(AXES[1]), title)
    if not np.isfinite(values).any():
        panel.note("no point has a steady state")
    elif line:
        panel.curve(along, values.ravel(), marker="circle", size=3.5, colour=OKABE_ITO[1])
    else:
        low, high = ends or (float(np.nanmin(values)), float(np.nanmax(values)))
        if high - low < 1e-9 * max(abs(high), 1e-12):
            high = low + max(abs(low), 1.0) * 1e-3
        levels = np.linspace(low, high, 13)
        panel.field(speed, torque, values.T, levels=levels, colours=scale(colours), words=title)
    return panel


def _nice(values: Floats, count: int) -> list[float]:
    """A few levels in geometric steps that lie inside ``values``."""
    known = values[np.isfinite(values) & (values > 0.0)]
    if not known.size or known.max() <= 1.02 * known.min():
        return []
    steps = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
    inside = [s for s in steps if known.min() < s < known.max()]
    return inside[-count:]


def _lines(
    panel: Panel, data: xr.Dataset, values: Floats, levels: Sequence[float], words: Sequence[str]
) -> None:
    """Named contour lines, where they exist."""
    known = values[np.isfinite(values)]
    inside = {
        level: name
        for level, name in zip(levels, words, strict=True)
        if known.size and known.min() < level < known.max()
    }
    if inside and min(values.shape) > 1:
        panel.contours(*_grid(data), values.T, levels=list(inside), words=list(inside.values()))


def _jam(panel: Panel, data: xr.Dataset, left: Floats) -> None:
    """The border where the backlash is used up, or that there is none."""
    known = left[np.isfinite(left)]
    if known.size and known.min() <= 0.0:
        _lines(panel, data, left, [0.0], ["jam"])
        return
    jam = data["jam_temperature"].values
    finite = jam[np.isfinite(jam) & np.isfinite(left)]
    words = "no point jams"
    if finite.size:
        at = float(CELSIUS(finite.min()))
        words += f"; pinion teeth\nwould at {at:.0f} °C, housing as it is"
    panel.text(0.03, 0.04, words, at="panel", across="left", up="baseline", size=7.5, box=True)
