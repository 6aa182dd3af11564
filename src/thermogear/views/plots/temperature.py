"""The motion over the gears' temperature: a grid of orbits, and single figures."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from thermogear.views.plots.motion import label_of, moving, orbit_of
from thermogear.views.style import (
    FAINT,
    INK,
    QUIET,
    WIDE,
    bundle_line,
    chosen,
    legend_below,
    names_of,
    picture,
    ramp,
)
from thermogear.views.words import CELSIUS, axis_label, celsius, operating_names, plain, shown

MOST_COLUMNS = 6

FIGURES = {
    "peak_to_peak_displacement": "displacement, peak to peak [µm]",
    "half_order_amplitude": "half-order amplitude |x| [µm]",
}


def grid(row: xr.Dataset, bundle: int, operating: list[int]) -> Figure:
    """Phase plane with section: a column for each gear temperature, a row for each speed."""
    temperatures = row["gear_temperature"].values
    columns = chosen(temperatures.size, most=MOST_COLUMNS)
    names = operating_names(row)
    width = max(WIDE, 2.4 * len(columns)) if len(columns) > 2 else 4.9
    figure, axes = picture(
        len(operating), len(columns), (width, 2.35 * len(operating) + 0.5),
        sharex="row", sharey="row", between=0.42, above=0.78, left=0.85,
    )  # fmt: skip
    colours = ramp(len(columns), warm=True)
    for line, point in enumerate(operating):
        for column, place in enumerate(columns):
            axis = axes[line, column]
            one = row.isel(bundle=bundle, operating=point, gear_temperature=place)
            if moving(one):
                orbit = orbit_of(one)
                loop = slice(0, orbit.loop)
                axis.plot(orbit.x[loop], orbit.v[loop], color=colours[column], linewidth=1.3)
                axis.plot(orbit.section_x, orbit.section_v, linestyle="none", marker="o",
                          markersize=4.6, color=INK, markeredgecolor="white",
                          markeredgewidth=0.5)  # fmt: skip
            else:
                axis.text(0.5, 0.5, _still(one), transform=axis.transAxes, ha="center",
                          va="center", color=INK, fontsize=9.5)  # fmt: skip
                axis.set_facecolor(FAINT)
            axis.set_title(f"{celsius(float(temperatures[place]))}: {label_of(one)}", fontsize=9)
            axis.set_xlabel("x − b′ [µm]", fontsize=8.5, labelpad=1.5)
            first = f"{names[point]}\n" if column == 0 else ""
            axis.set_ylabel(f"{first}ẋ [mm/s]", fontsize=8.5, labelpad=1.0)
            axis.locator_params(nbins=4)
    return figure


def _still(one: xr.Dataset) -> str:
    """What stands in a panel without motion."""
    jam = float(one["jam_temperature"]) if "jam_temperature" in one else np.nan
    if str(one["label"].item()) == "jammed" and np.isfinite(jam):
        return f"no gap left:\njams at {celsius(jam)}"
    return label_of(one)


def over_temperature(row: xr.Dataset, name: str) -> Figure:
    """One figure of the motion over the gears' temperature: speeds by colour, bundles by line."""
    figure, axes = picture()
    axis = axes[0, 0]
    x = CELSIUS(row["gear_temperature"].values)
    bundles, names = names_of(row, "bundle"), operating_names(row)
    places = chosen(row.sizes["operating"])
    for place, bundle in enumerate(bundles):
        values = shown(row.isel(bundle=place), name)
        for i, colour in zip(places, ramp(len(places)), strict=True):
            if np.isfinite(values[:, i]).any():
                axis.plot(
                    x, values[:, i], color=colour, marker="o", markersize=4,
                    linestyle=bundle_line(bundles, place), label=plain(f"{names[i]}, {bundle}"),
                )  # fmt: skip
    axis.set_xlabel(axis_label("gear_temperature"))
    axis.set_ylabel(FIGURES[name])
    low, high = axis.get_ylim()
    axis.set_ylim(min(0.0, low), max(high, 1.05 * high))
    if not axis.lines:
        axis.text(0.5, 0.5, "no motion at any temperature", transform=axis.transAxes,
                  ha="center", color=QUIET)  # fmt: skip
    legend_below(figure, axis, 2)
    return figure


def worth_drawing(row: xr.Dataset, name: str) -> bool:
    """Whether ``name`` rises above rounding anywhere, against the whole swing."""
    values = row[name].values
    swing = row["peak_to_peak_displacement"].values
    finite = np.isfinite(values) & np.isfinite(swing)
    return bool(np.any(values[finite] > 1e-4 * swing[finite]))
