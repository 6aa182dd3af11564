"""The gap between the teeth: over the mesh phase, and over the gears' temperature."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

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
    """Half backlash over a mesh period, cold and hot, at the first operating point."""
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


def over_temperature(row: xr.Dataset, mesh: xr.Dataset | None) -> Figure:
    """Half backlash over the gears' temperature, with the line at which the pair jams.

    ``mesh`` adds the way to the jam if the gears alone get hotter and the housing stays.
    """
    figure, axes = picture()
    axis, x = axes[0, 0], shown(row, "gear_temperature")
    bundles = names_of(row, "bundle")
    cold = float(row["cold_half_backlash"].max()) * 1e6
    axis.axhline(cold, color=COLD, linewidth=1.2, label="cold")
    for place, bundle in enumerate(bundles):
        values = shown(row.isel(bundle=place, operating=0), "half_backlash")
        axis.plot(
            x,
            values,
            color=HOT,
            marker="o",
            markersize=4.5,
            linestyle=bundle_line(bundles, place),
            label=plain(f"{bundle}, housing follows"),
        )
        way = None if mesh is None else _way_to_jam(mesh, bundle)
        if way is not None:
            axis.plot(*way, color=INK, linewidth=1.1, linestyle=(0, (1, 2)),
                      label=plain(f"{bundle}, housing stays"))  # fmt: skip
            axis.plot(way[0][1:], [0.0], marker="X", color=INK, markersize=7, linestyle="none")
            right = way[0][1] > float(x.mean())
            words = f"jams at {way[0][1]:.0f} °C"
            if words in (text.get_text() for text in axis.texts):
                continue
            axis.annotate(
                words, (way[0][1], 0.0),
                xytext=(-9 if right else 9, -5), textcoords="offset points",
                ha="right" if right else "left", va="top", fontsize=8.5,
            )  # fmt: skip
    axis.axhline(0.0, color=INK, linewidth=0.9)
    low = min(axis.get_ylim()[0], -0.16 * cold)
    axis.axhspan(low, 0.0, color=FAINT, alpha=0.5, linewidth=0)
    axis.set_ylim(low, 1.08 * cold)
    axis.set_xlabel(axis_label("gear_temperature"))
    axis.set_ylabel(axis_label("half_backlash", "half backlash"))
    legend_below(figure, axis, 2)
    return figure


def _way_to_jam(mesh: xr.Dataset, bundle: str) -> tuple[list[float], list[float]] | None:
    """From the hot state to the jam [degC], [um]; None where the jam is out of reach."""
    bundles = names_of(mesh, "bundle")
    if bundle not in bundles or "hot_temperature" not in mesh:
        return None
    here = mesh.isel(bundle=bundles.index(bundle), state=-1, operating=0)
    jam = float(CELSIUS(here["jam_temperature"].item()))
    start = float(CELSIUS(here["hot_temperature"].item()))
    if not np.isfinite(jam) or jam > FAR:
        return None
    return [start, jam], [float(here["half_backlash"]) * 1e6, 0.0]
