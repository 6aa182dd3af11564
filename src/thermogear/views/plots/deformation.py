"""What heat does to the flanks: growth along the path, and the profile over the involute."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from thermogear.views.plots.curves import hot_state
from thermogear.views.style import (
    HOT,
    INK,
    OKABE_ITO,
    QUIET,
    bundle_line,
    legend_below,
    mark_path,
    names_of,
    picture,
)
from thermogear.views.words import plain, shown


def growth(data: xr.Dataset) -> Figure:
    """Normal growth of both flanks and their sum, each bundle with a line style of its own."""
    figure, axes = picture()
    axis, x = axes[0, 0], shown(data, "path_position")
    here = hot_state(data).isel(operating=0)
    bundles = names_of(data, "bundle")
    lines = {
        "deformation_sum": ("sum", INK),
        "wheel_deformation": ("wheel", OKABE_ITO[3]),
        "pinion_deformation": ("pinion", OKABE_ITO[2]),
    }
    for place, bundle in enumerate(bundles):
        for name, (words, colour) in lines.items():
            axis.plot(
                x,
                shown(here.isel(bundle=place), name),
                color=colour,
                linestyle=bundle_line(bundles, place),
                label=plain(f"{words}, {bundle}"),
            )
    axis.set_ylabel("normal growth of the hot flank $δ_{n}$ [µm]")
    axis.set_ylim(bottom=min(0.0, axis.get_ylim()[0]))
    mark_path(axis, data)
    legend_below(figure, axis, 2)
    return figure


def hot_profiles(data: xr.Dataset) -> dict[str, tuple[str, str, Any, float]]:
    """The hot profiles that are stored: words, colour, line style and width of each."""
    printed = "printed_x" in data
    words = "hot, repaired" if printed else "hot"
    found: dict[str, tuple[str, str, Any, float]] = {"consistent": (words, HOT, "-", 2.4)}
    if printed:
        found["printed"] = ("hot, as printed", INK, (0, (4, 2)), 1.3)
    return found


def magnification(data: xr.Dataset, gear: int) -> int:
    """The round factor that makes the largest displacement about a fifth of the tooth's height."""
    here = data.isel(gear=gear)
    height = float(np.ptp(here["involute_y"].values))
    moved = max(
        float(np.nanmax(np.abs(here[f"{kind}_{axis}"].values - here[f"involute_{axis}"].values)))
        for kind in hot_profiles(data)
        for axis in "xy"
    )
    if not moved > 0.0 or not math.isfinite(moved):
        return 1
    wanted = max(0.2 * height / moved, 1.0)
    power = 10.0 ** math.floor(math.log10(wanted))
    return int(next(step * power for step in (5.0, 2.0, 1.0) if step * power <= wanted))


def profile(data: xr.Dataset, gear: int) -> Figure:
    """One tooth: cold involute and the hot profiles, their displacement magnified."""
    figure, axes = picture(size=(4.9, 4.3))
    axis = axes[0, 0]
    here = data.isel(gear=gear)
    factor = magnification(data, gear)
    x0, y0 = here["involute_x"].values, here["involute_y"].values
    curves = {**hot_profiles(data), "involute": ("cold involute", QUIET, "-", 1.3)}
    for kind, (words, colour, style, width) in curves.items():
        x = 1e3 * (x0 + factor * (here[f"{kind}_x"].values - x0))
        y = 1e3 * (y0 + factor * (here[f"{kind}_y"].values - y0))
        axis.plot(
            np.concatenate([-x, x[::-1]]),
            np.concatenate([y, y[::-1]]),
            color=colour,
            linestyle=style,
            linewidth=width,
            label=words,
        )
    axis.set_aspect("equal", adjustable="datalim")
    axis.set_xlabel("across the tooth, from its centre line x [mm]")
    axis.set_ylabel("radius along the centre line y [mm]")
    axis.set_title(plain(f"{here['gear'].item()}: displacement × {factor}"))
    legend_below(figure, axis)
    return figure


def profile_growth(data: xr.Dataset, gear: int) -> Figure:
    """How far each hot profile stands off the cold involute, along the flank's normal."""
    figure, axes = picture()
    axis = axes[0, 0]
    here = data.isel(gear=gear)
    x0, y0 = here["involute_x"].values, here["involute_y"].values
    across, along = (np.gradient(part, edge_order=2) for part in (x0, y0))
    length = np.hypot(across, along)
    for kind, (words, colour, style, _) in hot_profiles(data).items():
        dx = here[f"{kind}_x"].values - x0
        dy = here[f"{kind}_y"].values - y0
        off = 1e6 * (dx * along - dy * across) / length
        axis.plot(1e3 * np.hypot(x0, y0), off, color=colour, linestyle=style, label=words)
    axis.set_xlabel("radius on the flank r [mm]")
    axis.set_ylabel("distance from the cold involute [µm]")
    axis.set_ylim(bottom=min(0.0, axis.get_ylim()[0]))
    legend_below(figure, axis)
    return figure
