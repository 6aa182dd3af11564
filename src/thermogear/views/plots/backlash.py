"""The gap between the teeth: over the mesh phase, and over the gears' temperature."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermogear.base.vocabulary import UNDEFORMED
from thermogear.views.plots.curves import draw_by_bundle
from thermogear.views.style import (
    COLD,
    FAINT,
    HOT,
    INK,
    QUIET,
    STATES,
    bundle_line,
    legend_below,
    name_axes,
    names_of,
    picture,
)
from thermogear.views.words import CELSIUS, FAR, axis_label, plain, shown


def over_phase(data: xr.Dataset) -> Figure:
    """Half backlash over a mesh period, undeformed and hot, at the first operating point."""
    figure, axes = picture()
    axis, x = axes[0, 0], shown(data, "mesh_phase")
    for place, state in enumerate(names_of(data, "state")):
        here = data.isel(state=place)
        colour = STATES.get(state, INK)
        draw_by_bundle(axis, here, "half_backlash_curve", x, colour, state)
    axis.axhline(0.0, color=INK, linewidth=0.9)
    axis.set_xlim(0.0, 1.0)
    low, high = axis.get_ylim()
    low = min(low, -0.12 * high)
    axis.axhspan(low, 0.0, color=FAINT, alpha=0.5, linewidth=0)
    axis.set_ylim(low, high + 0.05 * (high - low))
    axis.text(0.99, 0.5 * low, "jammed", transform=axis.get_yaxis_transform(),
              ha="right", va="center", color=QUIET, fontsize=8.5)  # fmt: skip
    name_axes(
        axis, "mesh_phase", "half_backlash_curve", x_words="mesh phase", y_words="half backlash"
    )
    legend_below(figure, axis, 2)
    return figure


WAYS: dict[str, tuple[Any, str]] = {
    "jam_temperature": ((0, (1, 2)), "gears alone hotter"),
    "proportional_jam_temperature": ((0, (6, 2, 1, 2)), "all in proportion"),
}
"""Ways to the jam by the stored temperature at their end: line and words."""


def over_temperature(row: xr.Dataset, mesh: xr.Dataset | None) -> Figure:
    """Half backlash over the gears' temperature, with the line at which the pair jams.

    ``mesh`` adds both ways to the jam: the gears alone get hotter and the housing stays, and all
    bodies rise on in proportion.
    """
    figure, axes = picture()
    axis, x = axes[0, 0], shown(row, "gear_temperature")
    bundles = names_of(row, "bundle")
    cold = 1e6 * float(row["cold_half_backlash"].max())
    if mesh is not None:
        cold = 1e6 * float(mesh["half_backlash"].isel(state=0, operating=0).max())
    axis.axhline(cold, color=COLD, linewidth=1.2, label=UNDEFORMED)
    for place, bundle in enumerate(bundles):
        values = shown(row.isel(bundle=place, operating=0), "half_backlash")
        axis.plot(
            x,
            values,
            color=HOT,
            marker="o",
            markersize=4.5,
            linestyle=bundle_line(bundles, place),
            label=plain(f"{bundle}, both gears"),
        )
        for jam, (line, words) in WAYS.items():
            way = None if mesh is None else _way_to_jam(mesh, bundle, jam)
            if way is not None:
                axis.plot(*way, color=INK, linewidth=1.1, linestyle=line,
                          label=plain(f"{bundle}, {words}"))  # fmt: skip
                _mark_jam(axis, way[0][1], left=way[0][1] > float(x.mean()))
    axis.axhline(0.0, color=INK, linewidth=0.9)
    low = min(axis.get_ylim()[0], -0.16 * abs(cold))
    axis.axhspan(low, 0.0, color=FAINT, alpha=0.5, linewidth=0)
    axis.set_ylim(low, max(1.08 * cold, axis.get_ylim()[1]))
    axis.set_xlabel(axis_label("gear_temperature"))
    axis.set_ylabel(axis_label("half_backlash", "half backlash"))
    legend_below(figure, axis, 2)
    return figure


def _mark_jam(axis: Axes, jam: float, *, left: bool) -> None:
    """A cross where the backlash is used up, its temperature [degC] once beside it."""
    axis.plot([jam], [0.0], marker="X", color=INK, markersize=7, linestyle="none")
    words = f"jams at {jam:.0f} °C"
    if words in (text.get_text() for text in axis.texts):
        return
    axis.annotate(
        words, (jam, 0.0), xytext=(-9 if left else 9, -5), textcoords="offset points",
        ha="right" if left else "left", va="top", fontsize=8.5,
    )  # fmt: skip


def jams(row: xr.Dataset, mesh: xr.Dataset | None) -> list[str]:
    """The jam temperatures whose way is drawn for any bundle."""
    if mesh is None:
        return []
    bundles = names_of(row, "bundle")
    return [jam for jam in WAYS if any(_way_to_jam(mesh, name, jam) for name in bundles)]


def _way_to_jam(mesh: xr.Dataset, bundle: str, jam: str) -> tuple[list[float], list[float]] | None:
    """From the hot state to the jam [degC], [um]; None where the jam is out of reach."""
    bundles = names_of(mesh, "bundle")
    if bundle not in bundles or "hot_temperature" not in mesh or jam not in mesh:
        return None
    here = mesh.isel(bundle=bundles.index(bundle), state=-1, operating=0)
    end = float(CELSIUS(here[jam].item()))
    start = float(CELSIUS(here["hot_temperature"].item()))
    if not np.isfinite(end) or end > FAR:
        return None
    return [start, end], [float(here["half_backlash"]) * 1e6, 0.0]
