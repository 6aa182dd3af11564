"""Mesh stiffness undeformed and hot, its parts, and its mean and swing as bars."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.curves import (
    along_path,
    axis_of,
    draw_by_bundle,
    draw_phase,
    hot_state,
    phase_panel,
)
from thermogear.views.style import HOT, INK, OKABE_ITO, STATES, names_of
from thermogear.views.typesetting import math_symbol, plain, shown

PARTS = {
    "hertz": ("contact", OKABE_ITO[4]),
    "bending": ("bending", OKABE_ITO[0]),
    "shear": ("shear", OKABE_ITO[5]),
    "axial": ("axial", OKABE_ITO[3]),
    "body": ("body", OKABE_ITO[2]),
    "gear": ("tooth and body", OKABE_ITO[0]),
}


def by_state(data: Dataset) -> Panel:
    """Mesh stiffness over a mesh period or a turn, undeformed and hot, with its means."""
    panel = phase_panel(data, axis_of("mesh_stiffness", low=0.0))
    x = shown(data, "mesh_phase")
    for place, state in enumerate(names_of(data, "state")):
        colour, one = STATES.get(state, INK), data.isel(state=place)
        draw_phase(panel, x, values=shown(one, "mesh_stiffness"), colour=colour, label=plain(state))
        mean = float(shown(one, "mean_stiffness"))
        panel.line(y=mean, colour=colour, width=1.0, dash=(2, 2), label=plain(f"{state}, mean"))
    return panel


def over_phase(data: Dataset, bundle: int) -> Picture:
    """Mesh stiffness of one bundle over a mesh period or a turn, undeformed and hot."""
    x, here = shown(data, "mesh_phase"), data.isel(bundle=bundle, operating=0)
    panel = by_state(here)
    if float(np.nanmax(np.abs(data["thermal_stiffness"].isel(bundle=bundle).values))) > 0.0:
        elastic = shown(here.isel(state=-1), "elastic_stiffness")
        words = f"hot without {math_symbol('k_T')}"
        draw_phase(panel, x, values=elastic, colour=HOT, width=1.1, dash=(5, 2), label=words)
    return Picture([[panel]])


def pair(data: Dataset) -> Picture:
    """Stiffness of one tooth pair along the path, undeformed and hot, for every bundle."""
    panel = along_path(data, axis_of("pair_stiffness", "stiffness of one pair", low=0.0))
    x = shown(data, "path_position")
    for place, state in enumerate(names_of(data, "state")):
        here, colour = data.isel(state=place), STATES.get(state, INK)
        draw_by_bundle(panel, here, "pair_stiffness", x, colour=colour, what=state)
    return Picture([[panel]], legend=2)


def parts(data: Dataset, bundle: int) -> Picture:
    """The springs in series that make one pair, hot: pinion solid, wheel dotted."""
    panel = along_path(data, Axis("stiffness of one part k [10⁸ N/m]", log="decades"))
    x = shown(data, "path_position")
    here = hot_state(data).isel(bundle=bundle, operating=0)
    for part, (words, colour) in PARTS.items():
        for gear, dash in (("pinion", ()), ("wheel", (1.2, 1.2))):
            name = "hertz_stiffness" if part == "hertz" else f"{gear}_{part}_stiffness"
            if name not in here or (part == "hertz" and gear == "wheel"):
                continue
            text = words if part == "hertz" else f"{words}, {gear}"
            panel.curve(x, shown(here, name), colour=colour, dash=dash, label=text)
    series = shown(here, "pair_stiffness")
    panel.curve(x, series, colour=INK, width=2.4, label="pair (series)")
    return Picture([[panel]])
