"""Loaded contact over position, load and temperature; double contact lost at light load."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import MEGAPASCAL, MILLIMETRE, STIFFNESS
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, INK, OKABE_ITO, WIDE, ramp

if TYPE_CHECKING:
    import xarray as xr

EDGE = OKABE_ITO[4]
STATES: dict[str, tuple[str, tuple[float, ...]]] = {UNDEFORMED: (COLD, (5, 2)), "hot": (HOT, ())}


def over_phase(data: xr.Dataset) -> Picture:
    """Tangent and secant stiffness and transmission error over a mesh period, hot, by load."""
    here = data.sel(temperature="hot")
    panels = []
    for name, scale, words in (
        ("tangent_stiffness", 1e-8, "tangent stiffness [10⁸ N/m]"),
        ("secant_stiffness", 1e-8, "secant stiffness [10⁸ N/m]"),
        ("transmission_error", 1e6, "transmission error δ, heat's shift in it [µm]"),
    ):
        panel = Panel(Axis("mesh phase φ [–]", low=0.0, high=1.0), Axis(words))
        for place, colour in enumerate(ramp(here.sizes["load"])):
            label = f"{float(here['load'][place]):.4g} N m"
            values = scale * here[name].values[place]
            panel.curve(here["mesh_phase"].values, values, colour=colour, label=label)
        panels.append(panel)
    return Picture([panels], size=(WIDE, 3.3), legend=6)


def along_path(data: xr.Dataset, points: dict[str, float]) -> Picture:
    """Load share and pressure of a tooth pair along the path at the first and the last load.

    The pressure stops where a tip corner carries, and those stretches are shaded.
    """
    across = "distance from the pinion's tangent point [mm]"
    share = Panel(Axis(across), Axis("share of the load [–]", low=0.0))
    pressure = Panel(Axis(across), Axis("greatest Hertzian pressure on the flanks [MPa]", low=0.0))
    for name, (colour, dash) in STATES.items():
        if name not in data["temperature"].values:
            continue
        here = data.sel(temperature=name)
        last = here.sizes["load"] - 1
        for load in sorted({0, last}):
            one, width = here.isel(load=load), 1.8 if load == last else 1.0
            s = MILLIMETRE(one["pair_position"].values.ravel())
            order = np.argsort(s)
            words = f"{name}, {float(one['load']):.4g} N m"
            shares = one["load_share"].values.ravel()[order]
            pressures = MEGAPASCAL(one["contact_pressure"].values.ravel()[order])
            for panel, values in ((share, shares), (pressure, pressures)):
                panel.curve(s[order], values, colour=colour, dash=dash, width=width, label=words)
    for panel in (share, pressure):
        _corners(panel, data)
        _marks(panel, points)
    return Picture([[share, pressure]], size=(WIDE, 3.3), legend=4)


def _corners(panel: Panel, data: xr.Dataset) -> None:
    """Shade where a tip corner carries at any load and temperature."""
    positions, flags = data["pair_position"].values, data["edge_contact"].values
    label = "edge contact: pressure not valid"
    for corner in (1, 2):
        touched = MILLIMETRE(positions[(flags == corner).any(axis=tuple(range(flags.ndim - 2)))])
        if touched.size:
            ends = float(touched.min()), float(touched.max())
            panel.span(x=ends, colour=EDGE, opacity=0.25, order=0.1, label=label)
            label = ""


def _marks(panel: Panel, points: dict[str, float]) -> None:
    for name, position in points.items():
        panel.line(x=MILLIMETRE(position), colour=INK, width=0.6, dash=(1, 2), order=0.5)
        panel.text(MILLIMETRE(position), 1.015, name, at="x", up="bottom")
    if points:
        low, high = MILLIMETRE(min(points.values())), MILLIMETRE(max(points.values()))
        panel.x.low, panel.x.high = low - 0.12 * (high - low), high + 0.12 * (high - low)


def double_contact(data: xr.Dataset, base_pitch: float, name: str) -> Picture:
    """``name`` over the load (logarithmic) for gears of unequal temperature."""
    words = {
        "double_contact_length": (1e3, "length of double contact [mm]"),
        "mean_stiffness": (1e-8, "mean tangent stiffness [10⁸ N/m]"),
        "peak_to_peak_error": (1e6, "transmission error, peak to peak [µm]"),
    }
    scale, text = words[name]
    panel = Panel(Axis("pinion torque [N m]", log="full"), Axis(text, low=0.0))
    colours = (OKABE_ITO[0], OKABE_ITO[5], INK, OKABE_ITO[4], OKABE_ITO[1])
    for place, difference in enumerate(data["temperature_difference"].values):
        panel.curve(
            data["load"].values,
            scale * data[name].values[place],
            colour=colours[place % len(colours)],
            label=f"pinion {difference:+.0f} K".replace("-", "−") if difference else "equally hot",
        )
    if name == "double_contact_length":
        panel.y.high = 1.03 * MILLIMETRE(base_pitch)
    return Picture([[panel]])


def iso(data: xr.Dataset) -> Picture:
    """Mean stiffness of the loaded contact beside that of ISO 6336-1 over the load."""
    panel = Panel(Axis("pinion torque [N m]"), Axis("mean mesh stiffness [10⁸ N/m]", low=0.0))
    for name, words, colour in (
        ("loaded_stiffness", "loaded contact, undeformed", HOT),
        ("iso_stiffness", "ISO 6336-1, method B", COLD),
    ):
        values = STIFFNESS(data[name].values)
        panel.curve(
            data["load"].values, values, colour=colour, marker="circle", size=3.5, label=words
        )
    return Picture([[panel]], legend=2)
