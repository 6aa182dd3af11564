"""Loaded contact over position, load and temperature; double contact lost at light load."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermogear.base.vocabulary import UNDEFORMED
from thermogear.views.style import COLD, HOT, INK, OKABE_ITO, WIDE, legend_below, picture, ramp

EDGE = OKABE_ITO[4]
STATES = {UNDEFORMED: (COLD, (0, (5, 2))), "hot": (HOT, "-")}


def over_phase(data: xr.Dataset) -> Figure:
    """Tangent and secant stiffness and transmission error over a mesh period, hot, by load."""
    figure, axes = picture(1, 3, size=(WIDE, 3.3))
    here = data.sel(temperature="hot")
    x = here["mesh_phase"].values
    panels = (
        ("tangent_stiffness", 1e-8, "tangent stiffness [10⁸ N/m]"),
        ("secant_stiffness", 1e-8, "secant stiffness [10⁸ N/m]"),
        ("transmission_error", 1e6, "transmission error δ, heat's shift in it [µm]"),
    )
    colours = ramp(here.sizes["load"])
    for axis, (name, scale, words) in zip(axes[0], panels, strict=True):
        for place, colour in enumerate(colours):
            torque = float(here["load"][place])
            axis.plot(x, scale * here[name].values[place], color=colour, label=f"{torque:.4g} N m")
        axis.set_xlim(0.0, 1.0)
        axis.set_xlabel("mesh phase φ [–]")
        axis.set_ylabel(words)
    legend_below(figure, axes[0, 0], 6)
    return figure


def along_path(data: xr.Dataset, points: dict[str, float]) -> Figure:
    """Load share and pressure of a tooth pair along the path at the first and the last load.

    The pressure stops where a tip corner carries, and those stretches are shaded.
    """
    figure, axes = picture(1, 2, size=(WIDE, 3.3))
    for name, (colour, line) in STATES.items():
        if name not in data["temperature"].values:
            continue
        here = data.sel(temperature=name)
        last = here.sizes["load"] - 1
        for load in sorted({0, last}):
            one, width = here.isel(load=load), 1.8 if load == last else 1.0
            s = 1e3 * one["pair_position"].values.ravel()
            order = np.argsort(s)
            words = f"{name}, {float(one['load']):.4g} N m"
            shares = one["load_share"].values.ravel()[order]
            pressures = 1e-6 * one["contact_pressure"].values.ravel()[order]
            for axis, values in ((axes[0, 0], shares), (axes[0, 1], pressures)):
                axis.plot(
                    s[order], values, color=colour, linestyle=line, linewidth=width, label=words
                )
    for axis, words in (
        (axes[0, 0], "share of the load [–]"),
        (axes[0, 1], "greatest Hertzian pressure on the flanks [MPa]"),
    ):
        _corners(axis, data)
        _marks(axis, points)
        axis.set_xlabel("distance from the pinion's tangent point [mm]")
        axis.set_ylabel(words)
        axis.set_ylim(bottom=0.0)
    legend_below(figure, axes[0, 0], 4)
    return figure


def _corners(axis: Axes, data: xr.Dataset) -> None:
    """Shade where a tip corner carries at any load and temperature."""
    positions, flags = data["pair_position"].values, data["edge_contact"].values
    label = "edge contact: pressure not valid"
    for corner in (1, 2):
        touched = positions[(flags == corner).any(axis=tuple(range(flags.ndim - 2)))]
        if touched.size:
            low, high = 1e3 * touched.min(), 1e3 * touched.max()
            axis.axvspan(low, high, color=EDGE, alpha=0.25, linewidth=0.0, zorder=0.1, label=label)
            label = ""


def _marks(axis: Axes, points: dict[str, float]) -> None:
    for name, position in points.items():
        axis.axvline(1e3 * position, color=INK, linewidth=0.6, linestyle=(0, (1, 2)), zorder=0.5)
        axis.text(
            1e3 * position,
            1.015,
            name,
            transform=axis.get_xaxis_transform(),
            ha="center",
            va="bottom",
            fontsize=8.5,
        )
    if points:
        low, high = 1e3 * min(points.values()), 1e3 * max(points.values())
        axis.set_xlim(low - 0.12 * (high - low), high + 0.12 * (high - low))


def double_contact(data: xr.Dataset, base_pitch: float, name: str) -> Figure:
    """``name`` over the load (logarithmic) for gears of unequal temperature."""
    words = {
        "double_contact_length": (1e3, "length of double contact [mm]"),
        "mean_stiffness": (1e-8, "mean tangent stiffness [10⁸ N/m]"),
        "peak_to_peak_error": (1e6, "transmission error, peak to peak [µm]"),
    }
    scale, text = words[name]
    figure, axes = picture()
    axis = axes[0, 0]
    colours = (OKABE_ITO[0], OKABE_ITO[5], INK, OKABE_ITO[4], OKABE_ITO[1])
    for place, difference in enumerate(data["temperature_difference"].values):
        axis.plot(
            data["load"].values,
            scale * data[name].values[place],
            color=colours[place % len(colours)],
            label=f"pinion {difference:+.0f} K".replace("-", "−") if difference else "equally hot",
        )
    axis.set_xscale("log")
    axis.set_xlabel("pinion torque [N m]")
    axis.set_ylabel(text)
    axis.set_ylim(bottom=0.0)
    if name == "double_contact_length":
        axis.set_ylim(top=1.03e3 * base_pitch)
    legend_below(figure, axis, 3)
    return figure


def iso(data: xr.Dataset) -> Figure:
    """Mean stiffness of the loaded contact beside that of ISO 6336-1 over the load."""
    figure, axes = picture()
    axis = axes[0, 0]
    for name, words, colour in (
        ("loaded_stiffness", "loaded contact, undeformed", HOT),
        ("iso_stiffness", "ISO 6336-1, method B", COLD),
    ):
        axis.plot(
            data["load"].values, 1e-8 * data[name].values, color=colour, marker="o",
            markersize=3.5, label=words,
        )  # fmt: skip
    axis.set_ylim(bottom=0.0)
    axis.set_xlabel("pinion torque [N m]")
    axis.set_ylabel("mean mesh stiffness [10⁸ N/m]")
    legend_below(figure, axis, 2)
    return figure
