"""Mesh stiffness undeformed and hot, its parts, and its mean and swing as bars."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from thermogear.views.plots.curves import draw_by_bundle, hot_state
from thermogear.views.style import (
    HOT,
    INK,
    OKABE_ITO,
    STATES,
    legend_below,
    log_axis,
    mark_path,
    name_axes,
    names_of,
    picture,
)
from thermogear.views.words import math_symbol, plain, shown

PARTS = {
    "hertz": ("contact", OKABE_ITO[4]),
    "bending": ("bending", OKABE_ITO[0]),
    "shear": ("shear", OKABE_ITO[5]),
    "axial": ("axial", OKABE_ITO[3]),
    "body": ("body", OKABE_ITO[2]),
}


def over_phase(data: xr.Dataset, bundle: int) -> Figure:
    """Mesh stiffness of one bundle over a mesh period, undeformed and hot."""
    figure, axes = picture()
    axis, x = axes[0, 0], shown(data, "mesh_phase")
    here = data.isel(bundle=bundle, operating=0)
    for place, state in enumerate(names_of(data, "state")):
        colour = STATES.get(state, INK)
        one = here.isel(state=place)
        axis.plot(x, shown(one, "mesh_stiffness"), color=colour, label=plain(state))
        axis.axhline(
            float(shown(one, "mean_stiffness")),
            color=colour,
            linewidth=1.0,
            linestyle=(0, (2, 2)),
            label=plain(f"{state}, mean"),
        )
    if float(np.nanmax(np.abs(data["thermal_stiffness"].isel(bundle=bundle).values))) > 0.0:
        axis.plot(
            x,
            shown(here.isel(state=-1), "elastic_stiffness"),
            color=HOT,
            linewidth=1.1,
            linestyle=(0, (5, 2)),
            label=f"hot without {math_symbol('k_T')}",
        )
    axis.set_xlim(0.0, 1.0)
    axis.set_ylim(bottom=0.0)
    name_axes(axis, "mesh_phase", "mesh_stiffness", x_words="mesh phase")
    legend_below(figure, axis)
    return figure


def pair(data: xr.Dataset) -> Figure:
    """Stiffness of one tooth pair along the path, undeformed and hot, for every bundle."""
    figure, axes = picture()
    axis, x = axes[0, 0], shown(data, "path_position")
    for place, state in enumerate(names_of(data, "state")):
        draw_by_bundle(
            axis, data.isel(state=place), "pair_stiffness", x, STATES.get(state, INK), state
        )
    name_axes(axis, "path_position", "pair_stiffness", y_words="stiffness of one pair")
    axis.set_ylim(bottom=0.0)
    mark_path(axis, data)
    legend_below(figure, axis, 2)
    return figure


def parts(data: xr.Dataset, bundle: int) -> Figure:
    """The springs in series that make one pair, hot: pinion solid, wheel dotted."""
    figure, axes = picture()
    axis, x = axes[0, 0], shown(data, "path_position")
    here = hot_state(data).isel(bundle=bundle, operating=0)
    for part, (words, colour) in PARTS.items():
        for gear, style in (("pinion", "-"), ("wheel", (0, (1.2, 1.2)))):
            name = "hertz_stiffness" if part == "hertz" else f"{gear}_{part}_stiffness"
            if name not in here or (part == "hertz" and gear == "wheel"):
                continue
            text = words if part == "hertz" else f"{words}, {gear}"
            axis.plot(x, shown(here, name), color=colour, linestyle=style, label=text)
    axis.plot(x, shown(here, "pair_stiffness"), color=INK, linewidth=2.4, label="pair (series)")
    log_axis(axis)
    axis.set_ylabel("stiffness of one part k [10⁸ N/m]")
    mark_path(axis, data)
    legend_below(figure, axis)
    return figure


def bars(data: xr.Dataset) -> Figure:
    """Mean and peak-to-peak mesh stiffness of every bundle, undeformed beside hot, with values."""
    figure, axes = picture(1, 2)
    bundles, states = names_of(data, "bundle"), names_of(data, "state")
    places = np.arange(len(bundles), dtype=float)
    width = 0.8 / max(len(states), 1)
    titles = {"mean_stiffness": "time mean", "peak_to_peak_stiffness": "peak to peak"}
    for axis, (name, title) in zip(axes[0], titles.items(), strict=True):
        for i, state in enumerate(states):
            values = shown(data.isel(operating=0, state=i), name)
            bar = axis.bar(
                places + (i - 0.5 * (len(states) - 1)) * width,
                values,
                0.92 * width,
                color=STATES.get(state, INK),
                label=plain(state),
            )
            axis.bar_label(bar, fmt="%.2f", fontsize=8.0, padding=1.5, color=INK)
        axis.set_xticks(places, [plain(name[:18]) for name in bundles])
        axis.grid(visible=False, axis="x")
        axis.set_xlabel("bundle of choices")
        axis.set_title(title)
        axis.set_ylabel("mesh stiffness k [10⁸ N/m]")
        axis.set_ylim(0.0, 1.12 * axis.get_ylim()[1])
    legend_below(figure, axes[0, 0])
    return figure
