"""The motion over the gears' temperature: a grid of orbits, and single figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import CELSIUS, celsius
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.curves import axis_of, draw_by_both
from thermogear.views.plots.motion import draw_loop, label_of, moving, orbit_of
from thermogear.views.style import FAINT, INK, QUIET, WIDE, chosen, ramp
from thermogear.views.typesetting import operating_names

if TYPE_CHECKING:
    import xarray as xr

MOST_COLUMNS = 6

FIGURES = {
    "peak_to_peak_displacement": "displacement, peak to peak [µm]",
    "half_order_amplitude": "half-order amplitude |x| [µm]",
}


def grid(row: xr.Dataset, bundle: int, operating: list[int]) -> Picture:
    """Phase plane with section: a column for each gear temperature, a row for each speed."""
    temperatures = row["gear_temperature"].values
    columns = chosen(temperatures.size, most=MOST_COLUMNS)
    names = operating_names(row)
    width = max(WIDE, 2.4 * len(columns)) if len(columns) > 2 else 4.9
    colours = ramp(len(columns), "warm")
    panels: list[list[Panel]] = []
    for point in operating:
        panels.append([])
        for column, place in enumerate(columns):
            one = row.isel(bundle=bundle, operating=point, gear_temperature=place)
            first = f"{names[point]}\n" if column == 0 else ""
            panel = Panel(
                Axis("x − b′ [µm]", most=4, small=True),
                Axis(f"{first}ẋ [mm/s]", most=4, small=True),
                f"{celsius(float(temperatures[place]))}: {label_of(one)}",
            )
            if moving(one):
                orbit = orbit_of(one)
                draw_loop(panel, orbit, colour=colours[column], width=1.3)
                panel.points(
                    orbit.section_x, orbit.section_v, size=4.6, colour=INK, edge="white",
                    edge_width=0.5,
                )  # fmt: skip
            else:
                panel.text(0.5, 0.5, _still(one), at="panel", size=9.5)
                panel.background = FAINT
            panels[-1].append(panel)
    return Picture(
        panels, size=(width, 2.35 * len(operating) + 0.5), share_x="row", share_y="row",
        between=0.42, above=0.78, left=0.85,
    )  # fmt: skip


def _still(one: xr.Dataset) -> str:
    """What stands in a panel without motion."""
    jam = float(one["jam_temperature"]) if "jam_temperature" in one else np.nan
    if str(one["label"].item()) == "jammed" and np.isfinite(jam):
        return f"no gap left:\njams at {celsius(jam)}"
    return label_of(one)


def over_temperature(row: xr.Dataset, name: str) -> Picture:
    """One figure of the motion over the gears' temperature: speeds by colour, bundles by line."""
    panel = Panel(axis_of("gear_temperature"), Axis(FIGURES[name]))
    x = CELSIUS(row["gear_temperature"].values)
    draw_by_both(panel, row, name, x, marker="circle", size=4)
    low, high = panel.extent("y")
    panel.y.low, panel.y.high = min(0.0, low), max(high, 1.05 * high)
    if not panel.marks:
        panel.text(0.5, 0.5, "no motion at any temperature", at="panel", size=9.0, colour=QUIET)
    return Picture([[panel]], legend=2)


def worth_drawing(row: xr.Dataset, name: str) -> bool:
    """Whether ``name`` rises above rounding anywhere, against the whole swing."""
    values = row[name].values
    swing = row["peak_to_peak_displacement"].values
    finite = np.isfinite(values) & np.isfinite(swing)
    return bool(np.any(values[finite] > 1e-4 * swing[finite]))
