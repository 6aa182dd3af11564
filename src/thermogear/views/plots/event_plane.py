"""Bifurcations as curves in the plane of two parameters."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.one_motion import DOTTED, MARKS
from thermogear.views.plots.parameters import axis_words, shown
from thermogear.views.style import WIDE

if TYPE_CHECKING:
    import xarray as xr


def plane_picture(curves: Sequence[xr.Dataset]) -> Picture:
    """Every curve over both parameters: solid where a stable motion meets it, else dotted."""
    first, second = str(curves[0].attrs["first"]), str(curves[0].attrs["second"])
    panel = Panel(
        Axis(axis_words(first, curves[0]["first"])), Axis(axis_words(second, curves[0]["second"]))
    )
    for data in curves:
        kind = str(data.attrs["kind"])
        marker, colour = MARKS[kind]
        label = f"{kind}, period {int(data.attrs['period'])}"
        x, y = shown(first, data["first"]), shown(second, data["second"])
        met = data["stable"].values.astype(bool)
        cuts = [0, *(np.flatnonzero(np.diff(met.astype(int))) + 1).tolist(), met.size]
        for low, high in pairwise(cuts):
            end = min(high + 1, met.size)
            if met[low]:
                panel.curve(x[low:end], y[low:end], colour=colour, width=1.6, label=label)
            else:
                panel.curve(
                    x[low:end], y[low:end], colour=colour, width=1.1, dash=DOTTED,
                    label=f"{label}, no motion meets it",
                )  # fmt: skip
        asked = data["asked"].values.astype(bool)
        panel.points(
            x[asked], y[asked], marker=marker, size=4.5, colour=colour, edge="white",
            edge_width=0.5,
        )  # fmt: skip
    return Picture([[panel]], size=(WIDE, 4.4), legend=3)
