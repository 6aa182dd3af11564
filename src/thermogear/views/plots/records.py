"""Lines of several records: amplitude from record to record, with its interval."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import PERCENT
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import OKABE_ITO, WIDE

if TYPE_CHECKING:
    import xarray as xr

MOST = 6
"""Lines drawn: those that changed most for their uncertainty."""
_NAMED, _LETTERS = 12, 18  # records that the axis names, and letters of a name
_KNOWN = 50.0  # per cent: a line of a wider interval hides the others


def course(data: xr.Dataset) -> Picture:
    """Change of the lines that changed most for their uncertainty, of those known to +-50 % if
    there are any; shaded: 95 % intervals."""
    change = PERCENT(data["record_line_change"].values)
    half = PERCENT(data["record_line_change_half_width"].values)
    score = np.nan_to_num(np.abs(change) / np.maximum(half, 1e-12)).max(axis=0)
    known = np.nan_to_num(half, nan=0.0).max(axis=0) <= _KNOWN
    drawn = [k for k in np.argsort(-score) if known[k] or not known.any()][:MOST]
    number = np.arange(1.0, change.shape[0] + 1.0)
    panel = Panel(_records(data), Axis("change against the baseline [%]"))
    for k, colour in zip(drawn, OKABE_ITO, strict=False):
        y, h = change[:, k], half[:, k]
        words = f"{data['channel'].values[k]}, {data['name'].values[k]}"
        panel.band(number, low=y - h, high=y + h, colour=colour, opacity=0.2)
        panel.curve(number, y, colour=colour, width=1.2, marker="circle", size=3.0, label=words)
    return Picture([[panel]], size=(WIDE, 4.0), legend=3)


def _records(data: xr.Dataset) -> Axis:
    """The axis of the records: their names where they are few, else their numbers."""
    names = [str(one) for one in data["record"].values]
    if len(names) <= _NAMED:
        ticks = np.arange(1.0, len(names) + 1.0)
        return Axis(ticks=ticks, names=[n[:_LETTERS] for n in names], slant=20.0)
    ticks = np.unique(np.rint(np.linspace(1.0, len(names), _NAMED)))
    return Axis("record [–]", ticks=ticks, names=[f"{tick:.0f}" for tick in ticks])
