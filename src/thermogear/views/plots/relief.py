"""The relieved pair against the unrelieved one: over a mesh period and over the load."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from thermogear.views.style import COLD, HOT, INK, legend_below, picture

COLOURS = {"unrelieved": COLD, "relieved": HOT}


def error(data: xr.Dataset) -> Figure:
    """Static transmission error over a mesh period at the design load, mean taken off."""
    figure, axes = picture()
    axis = axes[0, 0]
    x = data["mesh_phase"].values
    for place, name in enumerate(str(n) for n in data["pair_kind"].values):
        values = 1e6 * data["transmission_error"].values[place]
        spread = float(np.ptp(values))
        axis.plot(
            x,
            values - values.mean(),
            color=COLOURS.get(name, INK),
            label=f"{name}, {spread:.2f} µm peak to peak",
        )
    axis.set_xlim(0.0, 1.0)
    axis.set_xlabel("mesh phase φ [–]")
    axis.set_ylabel("transmission error, mean removed [µm]")
    legend_below(figure, axis, 1)
    return figure


def stiffness(data: xr.Dataset) -> Figure:
    """Tangent stiffness over a mesh period at the design load."""
    figure, axes = picture()
    axis = axes[0, 0]
    for place, name in enumerate(str(n) for n in data["pair_kind"].values):
        axis.plot(
            data["mesh_phase"].values,
            1e-8 * data["tangent_stiffness"].values[place],
            color=COLOURS.get(name, INK),
            label=name,
        )
    axis.set_xlim(0.0, 1.0)
    axis.set_ylim(bottom=0.0)
    axis.set_xlabel("mesh phase φ [–]")
    axis.set_ylabel("tangent mesh stiffness [10⁸ N/m]")
    legend_below(figure, axis, 2)
    return figure


def over_load(data: xr.Dataset, design: float) -> Figure:
    """Peak-to-peak error over the torque, the design torque marked."""
    figure, axes = picture()
    axis = axes[0, 0]
    for place, name in enumerate(str(n) for n in data["pair_kind"].values):
        axis.plot(
            data["load"].values,
            1e6 * data["peak_to_peak_error"].values[place],
            color=COLOURS.get(name, INK),
            label=name,
        )
    axis.axvline(design, color=INK, linewidth=0.9, linestyle=(0, (2, 2)), label="designed for")
    axis.set_xlim(left=0.0)
    axis.set_ylim(bottom=0.0)
    axis.set_xlabel("pinion torque [N m]")
    axis.set_ylabel("transmission error, peak to peak [µm]")
    legend_below(figure, axis, 3)
    return figure
