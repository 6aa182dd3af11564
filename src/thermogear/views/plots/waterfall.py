"""Run-ups of a drive train: vibration over speed both ways, and lines over speed and order."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from thermogear.base.display import SPEED
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.sweeps import edges
from thermogear.views.style import INK, QUIET, STATES, WIDE, scale

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
LEAST = 1e-4
"""Of the greatest line, below which nothing is told apart."""
LEAST_FORCE = 0.1
"""Of the greatest resonant force on a bearing, from which a critical speed is drawn."""
WAYS = ((0, "up", ()), (1, "down", (4.0, 3.0)))


def over_speed(data: xr.Dataset) -> Picture:
    """Vibration of the mesh force, the bearings and the housing over speed, up and down."""
    rpm = SPEED(data["pinion_speed"].values)
    panels = []
    wanted = [
        ("mesh_force_rms", "mesh force, rms [N]"),
        ("bearing_force_rms", "bearing force, rms [N]"),
        ("housing_rms", "housing, rms [m/s²]"),
        ("contact_loss_share", "out of contact [%]"),
    ]
    for name, words in wanted:
        values = data[name].values
        if name == "bearing_force_rms":
            values = np.nanmax(values, axis=-1)
        if not np.isfinite(values).any() or (name == "contact_loss_share" and not values.any()):
            continue
        panel = Panel(Axis(""), Axis(words))
        factor = 100.0 if name == "contact_loss_share" else 1.0
        for s, state in enumerate(states_of(data)):
            for d, way, dash in WAYS:
                panel.curve(
                    rpm, factor * values[s, d], colour=STATES.get(state, INK), dash=dash,
                    width=1.3, label=f"{state}, {way}",
                )  # fmt: skip
        for speed in critical(data):
            panel.line(x=SPEED(speed), colour=QUIET, width=0.8, dash=(1.0, 2.5))
        panels.append([panel])
    panels[-1][0].x = Axis("pinion speed [rpm]")
    size = (WIDE, 1.9 * len(panels) + 0.9)
    return Picture(panels, size=size, above=0.2, share_x="column", legend=4)


def states_of(data: xr.Dataset) -> list[str]:
    """Names of the states of heat."""
    return [str(one) for one in json.loads(data.attrs["state_names"])]


def critical(data: xr.Dataset) -> list[float]:
    """Critical speeds [rad/s] of the last state within the run that a bearing feels."""
    rows = [one for one in json.loads(data.attrs.get("critical", "[]")) if one]
    if not rows:
        return []
    speeds = data["pinion_speed"].values
    inside = [one for one in rows[-1] if speeds[0] <= one["speed"] <= speeds[-1]]
    known = [one["force"] for one in inside if np.isfinite(one["force"])]
    least = LEAST_FORCE * max(known, default=0.0)
    return sorted(
        {one["speed"] for one in inside if not np.isfinite(one["force"]) or one["force"] >= least}
    )


def lines(data: xr.Dataset, direction: int) -> Picture:
    """Largest line of any bearing's force over speed and order, one panel a state."""
    rpm, order = SPEED(data["pinion_speed"].values), data["order"].values
    values = np.nanmax(data["bearing_force_line"].values[:, direction], axis=2)
    return _field(data, rpm, order, values, "line of bearing force [N]")


def sound(data: xr.Dataset, direction: int) -> Picture:
    """Lines of the housing's acceleration over speed and order, one panel a state."""
    rpm, order = SPEED(data["pinion_speed"].values), data["order"].values
    return _field(
        data, rpm, order, data["housing_line"].values[:, direction], "acceleration [m/s²]"
    )


def _field(
    data: xr.Dataset,
    rpm: Floats,
    order: Floats,
    values: Floats,
    words: str,
) -> Picture:
    # halves alone: the shafts' own orders lie too near for cells
    half = np.isclose(2.0 * order, np.round(2.0 * order))
    top = float(np.nanmax(values[..., half], initial=1e-12))
    panels = []
    for s, state in enumerate(states_of(data)):
        panel = Panel(Axis("pinion speed [rpm]"), Axis("order of the mesh frequency [–]"), state)
        shown = np.clip(np.nan_to_num(values[s][:, half], nan=LEAST * top), LEAST * top, None)
        panel.field(
            edges(rpm), edges(order[half]), shown.T, low=LEAST * top, high=top, log=True,
            colours=scale("magma"), words=words,
        )  # fmt: skip
        panels.append(panel)
    return Picture([panels], size=(WIDE, 4.4), share_y="row")
