"""Measured flanks: the traces of a chart, their fit and what of it acts in the mesh."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MICROMETRE, MILLIMETRE
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, FAINT, HOT, INK, QUIET

NEEDS = ("trace_deviation", "trace_flank", "diameter")
SIDES = {"drive": "drive flank", "back": "back flank"}


def sides(data: Dataset) -> list[str]:
    """The sides that were measured, drive first."""
    return [side for side in SIDES if f"{side}_acting" in data]


def traces(data: Dataset) -> Picture:
    """Each side's traces, the smoothed mean of the teeth and what acts, over the diameter."""
    row = []
    x = MILLIMETRE(data["diameter"].values)
    acts_as = data["trace_flank"].values
    ends = tuple(MILLIMETRE(float(data.attrs[f"evaluated_{end}"])) for end in ("from", "to"))
    for side in sides(data):
        panel = Panel(
            Axis("diameter d [mm]", margin=0.02),
            Axis("deviation, outside positive [µm]"),
            SIDES[side],
        )
        panel.span(x=(ends[0], ends[1]), colour=FAINT, opacity=0.45, label="evaluated")
        for number, values in enumerate(
            MICROMETRE(data["trace_deviation"].values[acts_as == side])
        ):
            label = "" if number else "traces"
            panel.curve(x, values, colour=QUIET, width=0.7, opacity=0.7, label=label)
        fit, acting = (MICROMETRE(data[f"{side}_{name}"].values) for name in ("fit", "acting"))
        panel.curve(x, fit, colour=COLD, width=1.7, label="fit: mean of the teeth, smoothed")
        panel.curve(x, acting, colour=HOT, width=1.7, dash=(5, 2), label="acts")
        pitch = MILLIMETRE(float(data.attrs["pitch_diameter"]))
        if x.min() <= pitch <= x.max():
            panel.line(x=pitch, colour=INK, width=0.9, dash=(2, 2), label="pitch circle")
        row.append(panel)
    wide = (4.9 * len(row), 3.1)
    return Picture([row], size=wide, legend=5 if len(row) > 1 else 3)


def peak(data: Dataset) -> float:
    """Most that acts, peak to peak over both sides [m]."""
    return max(
        float(np.nanmax(acts) - np.nanmin(acts))
        for acts in (data[f"{side}_acting"].values for side in sides(data))
    )
