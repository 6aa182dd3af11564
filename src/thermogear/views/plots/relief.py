"""The relieved pair against the unrelieved one: over a mesh period and over the load."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import MICROMETRE, STIFFNESS, Display
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, INK, names_of

if TYPE_CHECKING:
    import xarray as xr

COLOURS = {"unrelieved": COLD, "relieved": HOT}


def error(data: xr.Dataset) -> Picture:
    """Static transmission error over a mesh period at the design load, mean taken off."""
    panel = Panel(
        Axis("mesh phase φ [–]", low=0.0, high=1.0), Axis("transmission error, mean removed [µm]")
    )
    x = data["mesh_phase"].values
    for place, name in enumerate(names_of(data, "pair_kind")):
        values = MICROMETRE(data["transmission_error"].values[place])
        label = f"{name}, {float(np.ptp(values)):.2f} µm peak to peak"
        panel.curve(x, values - values.mean(), colour=COLOURS.get(name, INK), label=label)
    return Picture([[panel]], legend=1)


def stiffness(data: xr.Dataset) -> Picture:
    """Tangent stiffness over a mesh period at the design load."""
    panel = Panel(
        Axis("mesh phase φ [–]", low=0.0, high=1.0),
        Axis("tangent mesh stiffness [10⁸ N/m]", low=0.0),
    )
    _pairs(panel, data["mesh_phase"], data["tangent_stiffness"], STIFFNESS)
    return Picture([[panel]], legend=2)


def over_load(data: xr.Dataset, design: float) -> Picture:
    """Peak-to-peak error over the torque, the design torque marked."""
    panel = Panel(
        Axis("pinion torque [N m]", low=0.0), Axis("transmission error, peak to peak [µm]", low=0.0)
    )
    _pairs(panel, data["load"], data["peak_to_peak_error"], MICROMETRE)
    panel.line(x=design, colour=INK, width=0.9, dash=(2, 2), label="designed for")
    return Picture([[panel]])


def _pairs(panel: Panel, x: xr.DataArray, y: xr.DataArray, shown: Display) -> None:
    for place, name in enumerate(str(n) for n in y["pair_kind"].values):
        panel.curve(x.values, shown(y.values[place]), colour=COLOURS.get(name, INK), label=name)
