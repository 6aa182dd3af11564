"""The motion over the gears' temperature: four views of each, and single figures."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import celsius, display
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.motion import draw_loop, label_of, moving, orbit_of
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import FAINT, INK, WIDE, chosen, ramp

MOST_COLUMNS = 6
HIGHEST_ORDER = 4.0
"""Spectra are drawn up to this order of the mesh frequency."""


def views(row: Dataset, *, bundle: int, operating: int) -> Picture:
    """Time history, phase plane, Poincare section and spectrum: a column for each temperature."""
    here = row.isel(bundle=bundle, operating=operating)
    temperatures = row["gear_temperature"].values
    columns = chosen(temperatures.size, most=MOST_COLUMNS)
    colours = ramp(len(columns), "warm")
    order, scale = row["order"].values, display("line_amplitude")
    floor, top = floor_of(
        scale(here["line_amplitude"].values), order=order, highest=HIGHEST_ORDER
    )  # fmt: skip
    rows: list[list[Panel]] = [[], [], [], []]
    for column, place in enumerate(columns):
        one = here.isel(gear_temperature=place)
        history = _panel("t [ms]", "x − b′ [µm]")
        history.title = f"{celsius(float(temperatures[place]))}: {label_of(one)}"
        phase = _panel("x − b′ [µm]", "ẋ [mm/s]")
        section = _panel("x − b′ [µm], section", "ẋ [mm/s]")
        lines = over_orders(
            "mesh order [–]", "|x| [µm]", floor=floor, top=top, highest=HIGHEST_ORDER
        )
        lines.x.small = lines.y.small = True
        if moving(one):
            orbit, colour = orbit_of(one), colours[column]
            history.curve(orbit.t, orbit.x, colour=colour, width=1.1)
            draw_loop(phase, orbit, colour=colour, width=1.3)
            draw_loop(section, orbit, colour=colour, width=0.7, opacity=0.3)
            section.points(
                orbit.section_x, orbit.section_v, size=4.6, colour=INK, edge="white",
                edge_width=0.5,
            )  # fmt: skip
            draw_lines(
                lines, order=order, amplitude=scale(one["line_amplitude"].values), colour=colour,
                label="",
            )  # fmt: skip
        else:
            for panel in (history, phase, section):
                panel.text(0.5, 0.5, _still(one), at="panel", size=9.5)
                panel.background = FAINT
        for panels, panel in zip(rows, (history, phase, section, lines), strict=True):
            panels.append(panel)
    width = max(WIDE, 2.4 * len(columns)) if len(columns) > 2 else 4.9
    return Picture(
        rows, size=(width, 9.0), share_x="row", share_y="row", between=0.42, above=0.6, left=0.85,
    )  # fmt: skip


def _panel(x: str, y: str) -> Panel:
    return Panel(Axis(x, most=4, small=True), Axis(y, most=4, small=True))


def _still(one: Dataset) -> str:
    """What stands in a panel without motion."""
    jam = float(one["jam_temperature"]) if "jam_temperature" in one else np.nan
    if str(one["label"].item()) == "jammed" and np.isfinite(jam):
        return f"no gap left:\njams at {celsius(jam)}"
    return label_of(one)
