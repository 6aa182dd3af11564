"""The map of everything hot over speed and torque."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import STATUS
from thermogear.views.style import INK, OKABE_ITO, QUIET, WIDE, note, picture
from thermogear.views.words import CELSIUS, plain

Floats = NDArray[np.float64]

AXES = ("pinion speed [rpm]", "pinion torque [N m]")
SAFE = 50.0
"""Scuffing margin [K] that is advised at least."""


def thermal_map(data: xr.Dataset) -> Figure:
    """Regime, flash, body temperature, backlash left, scuffing margin and friction: six maps.

    Points without a steady state are white; where the oil leaves its viscosity line the map is
    hatched. Where only one of speed and torque runs there are six lines over it instead.
    """
    figure, axes = picture(2, 3, size=(WIDE, 6.6), between=1.0, above=0.95)
    figure.subplots_adjust(right=0.95)
    settled = data["status"].values != STATUS.index("not_converged")

    def kept(values: Floats) -> Floats:
        return np.where(settled, values, np.nan)

    boundary = 100.0 * data["regime_share"].isel(regime_name=0).values
    film = kept(data["least_film_parameter"].values)
    _panel(axes[0, 0], data, kept(boundary), "boundary lubrication [% of path]", "Reds", (0, 100))
    _lines(axes[0, 0], data, film, _nice(film, 3), "Λ = %.2g")
    flash = kept(data["greatest_flash"].values)
    _panel(axes[0, 1], data, flash, "greatest flash temperature [K]", "YlOrRd")
    teeth = data["node_temperature"].sel(node="pinion_tooth").values
    body = kept(teeth - ZERO_CELSIUS)
    _panel(axes[0, 2], data, body, "pinion teeth, body temperature [°C]", "YlOrRd")
    tempering = np.where(data["tempered"].values == 1, 1.0, 0.0)
    if 0.0 < tempering.mean() < 1.0:
        _lines(axes[0, 2], data, tempering, [0.5], "tempered")
    left = kept(1e6 * data["least_half_backlash"].values)
    _panel(axes[1, 0], data, left, "half backlash left [µm]", "viridis")
    if min(left.shape) > 1:
        _jam(axes[1, 0], data, left)
    margin = kept(data["scuffing_margin"].values)
    if np.isfinite(margin).any():
        # red is always below 0 K and the deepest green the greatest margin
        ends = (min(-SAFE, float(np.nanmin(margin))), max(2.0 * SAFE, float(np.nanmax(margin))))
        _panel(axes[1, 1], data, margin, "scuffing margin [K]", "RdYlGn", ends)
        if min(margin.shape) < 2:
            for level in (0.0, SAFE):
                axes[1, 1].axhline(level, color=INK, linewidth=0.9, linestyle=(0, (2, 2)))
        _lines(axes[1, 1], data, margin, [0.0, SAFE], "%.0f K")
    else:
        note(axes[1, 1], "scuffing margin: oil.scuffing_load_stage is not given")
        if min(margin.shape) < 2:
            axes[1, 1].set_axis_off()
    friction = kept(data["mean_friction"].values)
    _panel(axes[1, 2], data, friction, "mean friction coefficient [–]", "PuBu")
    for axis in axes.ravel():
        _hatch(axis, data, settled)
        if min(settled.shape) > 1:
            axis.set_xlabel(AXES[0])
            axis.set_ylabel(AXES[1])
    return figure


def _grid(data: xr.Dataset) -> tuple[Floats, Floats]:
    return data["pinion_speed"].values / RPM, data["pinion_torque"].values


def _panel(
    axis: Axes,
    data: xr.Dataset,
    values: Floats,
    title: str,
    colours: str,
    ends: tuple[float, float] | None = None,
) -> None:
    """Filled contours over speed and torque; a grid of one line is drawn as that line."""
    speed, torque = _grid(data)
    line = min(values.shape) < 2
    if line:
        axis.set_xlabel(AXES[0] if speed.size >= torque.size else AXES[1])
        axis.set_ylabel(plain(title))
    else:
        axis.set_title(plain(title))
    if not np.isfinite(values).any():
        note(axis, "no point has a steady state")
        return
    low, high = ends or (float(np.nanmin(values)), float(np.nanmax(values)))
    if line:
        along = speed if speed.size >= torque.size else torque
        axis.plot(along, values.ravel(), marker="o", markersize=3.5, color=OKABE_ITO[1])
        return
    if high - low < 1e-9 * max(abs(high), 1e-12):
        high = low + max(abs(low), 1.0) * 1e-3
    levels = np.linspace(low, high, 13)
    drawn = axis.contourf(
        speed, torque, values.T, levels=levels, cmap=mpl.colormaps[colours], extend="both"
    )
    bar = axis.figure.colorbar(drawn, ax=axis, pad=0.02, aspect=24, format="%.3g")
    bar.set_ticks([t for t in MaxNLocator(5).tick_values(low, high) if low <= t <= high])
    bar.ax.tick_params(labelsize=7.5)
    bar.outline.set_visible(False)
    axis.grid(visible=False)


def _nice(values: Floats, count: int) -> list[float]:
    """A few levels in geometric steps that lie inside ``values``."""
    known = values[np.isfinite(values) & (values > 0.0)]
    if not known.size or known.max() <= 1.02 * known.min():
        return []
    steps = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
    inside = [s for s in steps if known.min() < s < known.max()]
    return inside[-count:]


def _lines(axis: Axes, data: xr.Dataset, values: Floats, levels: list[float], words: str) -> None:
    """Named contour lines, where they exist."""
    speed, torque = _grid(data)
    known = values[np.isfinite(values)]
    inside = [v for v in levels if known.size and known.min() < v < known.max()]
    if not inside or min(values.shape) < 2:
        return
    lines = axis.contour(speed, torque, values.T, levels=inside, colors=INK, linewidths=1.1)
    text = (lambda v: words % v) if "%" in words else (lambda _: words)
    for label in axis.clabel(lines, fmt=text, fontsize=7.5):
        label.set_bbox({"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.8})


def _jam(axis: Axes, data: xr.Dataset, left: Floats) -> None:
    """The border where the backlash is used up, or that there is none."""
    known = left[np.isfinite(left)]
    if known.size and known.min() <= 0.0:
        _lines(axis, data, left, [0.0], "jam")
        return
    jam = data["jam_temperature"].values
    finite = jam[np.isfinite(jam) & np.isfinite(left)]
    words = "no point jams"
    if finite.size:
        words += f";\npinion teeth would at {float(CELSIUS(finite.min())):.0f} °C, housing as it is"
    axis.text(
        0.03,
        0.04,
        words,
        transform=axis.transAxes,
        fontsize=7.5,
        color=INK,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 2.0},
    )


def _hatch(axis: Axes, data: xr.Dataset, settled: NDArray[np.bool_]) -> None:
    """Hatch what rests on an oil beyond its viscosity line."""
    outside = (data["within_oil_range"].values == 0) & settled
    if not outside.any() or min(outside.shape) < 2:
        return
    speed, torque = _grid(data)
    hatched = axis.contourf(
        speed,
        torque,
        outside.T.astype(float),
        levels=[0.5, 1.5],
        colors="none",
        hatches=["///"],
    )
    hatched.set_edgecolor(QUIET)
    hatched.set_linewidth(0.0)
