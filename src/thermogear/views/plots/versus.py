"""Curves of several cases over each other: a colour for each case, hot solid, undeformed dashed."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import display
from thermogear.base.vocabulary import UNDEFORMED, label
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.curves import along_path
from thermogear.views.plots.motion import HALF_ORDERS
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import INK, OKABE_ITO, WIDE
from thermogear.views.typesetting import axis_label, plain

if TYPE_CHECKING:
    import xarray as xr

DASHES: dict[str, tuple[float, ...]] = {UNDEFORMED: (4, 2), "hot": ()}
HIGHEST_ORDER = 8.0
SHIFT = 0.07
"""Lines of neighbouring cases in a spectrum stand so far apart [orders]."""


def has_curve(data: xr.Dataset, name: str, *, bundle: int, operating: int) -> bool:
    """Whether any case has a curve ``name`` there that is not zero throughout."""
    if name not in data:
        return False
    values = data[name].isel(bundle=bundle, operating=operating).values
    return bool((np.isfinite(values) & (values != 0.0)).any())


def curve(data: xr.Dataset, name: str, *, bundle: int, operating: int) -> Picture:
    """``name`` of every case and state over its own positions, at one bundle and point."""
    along = "path_position" if "path_place" in data[name].dims else "mesh_phase"
    unit = str(data[name].attrs["units"])
    here = data.isel(bundle=bundle, operating=operating)
    y = Axis(axis_label(name, None if len(axis_label(name)) < 40 else WORDS.get(name)))
    panel = (
        Panel(Axis(axis_label(along), low=0.0, high=1.0), y)
        if along == "mesh_phase"
        else _path(data, y)
    )
    drawn: set[str] = set()
    count = data.sizes["case"]
    for c, colour in zip(range(count), OKABE_ITO, strict=False):
        # earlier cases are broader, so that a later one on the same curve does not hide them
        width = 1.3 + min(1.8, 3.0 / max(count - 1, 1)) * (count - 1 - c)
        x = display(along)(here[along].isel(case=c).values)
        for s, state in enumerate(str(one) for one in data["state"].values):
            values = here[name].isel(case=c, state=s).values
            if not (np.isfinite(values) & (values != 0.0)).any():
                continue
            drawn.add(state)
            dash = DASHES.get(state, ())
            panel.curve(x, display(name, unit)(values), colour=colour, dash=dash, width=width)
    y.low = min(0.0, panel.extent("y")[0])
    _entries(panel, data)
    for state in sorted(drawn) if len(drawn) > 1 else ():
        panel.curve([], [], colour=INK, dash=DASHES.get(state, ()), label=plain(state))
    return Picture([[panel]], legend=4)


WORDS = {
    "friction_coefficient": "friction coefficient",
    "flash_temperature": "flash temperature rise",
    "deformation_sum": "growth of both flanks",
    "half_backlash_curve": "half backlash",
    "mesh_stiffness": "mesh stiffness",
    "line_amplitude": "amplitude of displacement",
}
"""Words of an axis where the long name would not fit beside it."""


def spectrum(data: xr.Dataset, *, bundle: int, operating: int) -> Picture:
    """Spectral lines of the displacement: a colour for each case, open undeformed and full hot."""
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
    panel = over_orders(
        HALF_ORDERS, axis_label("line_amplitude", WORDS["line_amplitude"], unit),
        floor=max(low for low, _ in ends), top=max(high for _, high in ends), highest=HIGHEST_ORDER,
    )  # fmt: skip
    drawn: set[str] = set()
    for c, colour in zip(range(count), OKABE_ITO, strict=False):
        order = here["order"].isel(case=c).values
        for s, state in enumerate(str(one) for one in data["state"].values):
            lines = here["line_amplitude"].isel(case=c, state=s).values
            if not np.isfinite(lines).any():
                continue
            drawn.add(state)
            # the line at zero goes before the shift could move it away from zero
            kept = np.isfinite(order) & (order > 0.0)
            shift = SHIFT * (c - 0.5 * (count - 1))
            draw_lines(
                panel, order=order[kept] + shift, amplitude=scale(lines[kept]), colour=colour,
                label="", filled=state != UNDEFORMED,
            )  # fmt: skip
    _entries(panel, data)
    for state in sorted(drawn) if len(drawn) > 1 else ():
        cold = state == UNDEFORMED
        panel.points([], [], size=6.4 if cold else 4.2, open=cold, colour=INK, label=plain(state))
    return Picture([[panel]], size=(WIDE, 3.6), legend=4)


def _entries(panel: Panel, data: xr.Dataset) -> None:
    """An entry of the legend for each case in its colour."""
    for title, colour in zip(data["case"].values, OKABE_ITO, strict=False):
        panel.curve([], [], colour=colour, width=2.4, label=plain(title))


def _path(data: xr.Dataset, y: Axis) -> Panel:
    """Over the path of contact, A..E marked where the cases share one."""
    points = json.loads(str(data.attrs.get("path_points", "[]")))
    x = Axis(axis_label("path_position"))
    alike = bool(points) and all(
        set(each) == set(points[0])
        and np.allclose(list(each.values()), list(points[0].values()), rtol=1e-9)
        for each in points
    )
    if not alike:
        return Panel(x, y)
    values = data["path_position"].values
    told = {"path_points": json.dumps(points[0])}
    one = label({}, {"path_position": np.sort(values[np.isfinite(values)])}, told)
    panel = along_path(one, y)
    panel.x.words = x.words
    return panel
