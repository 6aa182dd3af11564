"""Curves of several cases over each other: a colour for each case, hot solid, undeformed dashed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermogear.base.vocabulary import UNDEFORMED
from thermogear.views.plots.spectrum import draw_lines, floor_of, mark_half_orders
from thermogear.views.style import INK, OKABE_ITO, legend_below, log_axis, mark_path, picture
from thermogear.views.words import axis_label, display, plain

STYLES: dict[str, Any] = {UNDEFORMED: (0, (4, 2)), "hot": "-"}
HIGHEST_ORDER = 8.0
SHIFT = 0.07
"""Lines of neighbouring cases in a spectrum stand so far apart [orders]."""


def has_curve(data: xr.Dataset, name: str, *, bundle: int, operating: int) -> bool:
    """Whether any case has a curve ``name`` there that is not zero throughout."""
    if name not in data:
        return False
    values = data[name].isel(bundle=bundle, operating=operating).values
    return bool((np.isfinite(values) & (values != 0.0)).any())


def curve(data: xr.Dataset, name: str, *, bundle: int, operating: int) -> Figure:
    """``name`` of every case and state over its own positions, at one bundle and point."""
    figure, axes = picture()
    axis = axes[0, 0]
    along = "path_position" if "path_place" in data[name].dims else "mesh_phase"
    unit = str(data[name].attrs["units"])
    here = data.isel(bundle=bundle, operating=operating)
    drawn: set[str] = set()
    count = data.sizes["case"]
    for c, colour in zip(range(count), OKABE_ITO, strict=False):
        # earlier cases are broader, so that a later one on the same curve does not hide them
        width = 1.3 + min(1.8, 3.0 / max(count - 1, 1)) * (count - 1 - c)
        x = display(along)(here[along].isel(case=c).values)
        for s, state in enumerate(data["state"].values):
            y = here[name].isel(case=c, state=s).values
            if not (np.isfinite(y) & (y != 0.0)).any():
                continue
            drawn.add(str(state))
            axis.plot(
                x,
                display(name, unit)(y),
                color=colour,
                linestyle=STYLES.get(str(state), "-"),
                linewidth=width,
            )
    axis.set_xlabel(axis_label(along))
    axis.set_ylabel(axis_label(name, None if len(axis_label(name)) < 40 else WORDS.get(name)))
    if along == "mesh_phase":
        axis.set_xlim(0.0, 1.0)
    else:
        _mark_path(axis, data)
    axis.set_ylim(bottom=min(0.0, axis.get_ylim()[0]))
    _legend(figure, axis, data, sorted(drawn))
    return figure


WORDS = {
    "friction_coefficient": "friction coefficient",
    "flash_temperature": "flash temperature rise",
    "deformation_sum": "growth of both flanks",
    "half_backlash_curve": "half backlash",
    "mesh_stiffness": "mesh stiffness",
    "line_amplitude": "amplitude of displacement",
}
"""Words of an axis where the long name would not fit beside it."""


def spectrum(data: xr.Dataset, *, bundle: int, operating: int) -> Figure:
    """Spectral lines of the displacement: a colour for each case, open undeformed and full hot."""
    figure, axes = picture(size=(10.0, 3.6))
    axis = axes[0, 0]
    here = data.isel(bundle=bundle, operating=operating)
    unit = str(data["line_amplitude"].attrs["units"])
    scale = display("line_amplitude", unit)
    count = data.sizes["case"]
    ends = [
        floor_of(
            scale(here["line_amplitude"].isel(case=c).values),
            order=here["order"].isel(case=c).values,
            highest=HIGHEST_ORDER,
        )
        for c in range(count)
        if np.isfinite(here["line_amplitude"].isel(case=c).values).any()
    ]
    floor, top = max(low for low, _ in ends), max(high for _, high in ends)
    drawn: set[str] = set()
    for c, colour in zip(range(count), OKABE_ITO, strict=False):
        order = here["order"].isel(case=c).values
        for s, state in enumerate(data["state"].values):
            lines = here["line_amplitude"].isel(case=c, state=s).values
            if not np.isfinite(lines).any():
                continue
            drawn.add(str(state))
            # the line at zero goes before the shift could move it away from zero
            kept = np.isfinite(order) & (order > 0.0)
            shift = SHIFT * (c - 0.5 * (count - 1))
            draw_lines(
                axis, order=order[kept] + shift, amplitude=scale(lines[kept]), colour=colour,
                floor=floor, highest=HIGHEST_ORDER, label="", filled=str(state) != UNDEFORMED,
            )  # fmt: skip
    log_axis(axis)
    axis.set_ylim(floor, top)
    mark_half_orders(axis, HIGHEST_ORDER)
    axis.set_xlabel(axis_label("order") + ", half orders dotted")
    axis.set_ylabel(axis_label("line_amplitude", WORDS["line_amplitude"], unit))
    _legend(figure, axis, data, sorted(drawn), marks=True)
    return figure


def _legend(
    figure: Figure, axis: Axes, data: xr.Dataset, states: Sequence[str], marks: bool = False
) -> None:
    """An entry for each case in its colour, then one for each state that is drawn."""
    titles = [plain(title) for title in data["case"].values]
    for title, colour in zip(titles, OKABE_ITO, strict=False):
        axis.plot([], [], color=colour, linewidth=2.4, label=title)
    for state in states if len(states) > 1 else ():
        if marks:
            filled = INK if state != UNDEFORMED else "none"
            axis.plot(
                [], [], linestyle="none", marker="o",
                markersize=4.2 if state != UNDEFORMED else 6.4,
                markerfacecolor=filled, markeredgecolor=INK, label=plain(state),
            )  # fmt: skip
        else:
            axis.plot([], [], color=INK, linestyle=STYLES.get(state, "-"), label=plain(state))
    legend_below(figure, axis, 4)


def _mark_path(axis: Axes, data: xr.Dataset) -> None:
    """Mark A..E where the cases share one path of contact, else give the axis its ends."""
    points = json.loads(str(data.attrs.get("path_points", "[]")))
    values = data["path_position"].values
    flat = np.sort(values[np.isfinite(values)])
    alike = bool(points) and all(
        set(each) == set(points[0])
        and np.allclose(list(each.values()), list(points[0].values()), rtol=1e-9)
        for each in points
    )
    if alike:
        mark_path(
            axis,
            xr.Dataset(
                coords={"path_position": flat},
                attrs={"path_points": json.dumps(points[0])},
            ),
        )
        axis.set_xlabel(axis_label("path_position"))
