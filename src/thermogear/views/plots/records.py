"""Lines of several records: amplitude from record to record, with its interval."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import OKABE_ITO, WIDE

if TYPE_CHECKING:
    import xarray as xr

MOST = 6
"""Lines drawn: those that changed most for their uncertainty."""


def course(data: xr.Dataset) -> Picture:
    """Change of the lines that changed most for their uncertainty; shaded: 95 % intervals."""
    change = 100.0 * data["record_line_change"].values
    half = 100.0 * data["record_line_change_half_width"].values
    score = np.nan_to_num(np.abs(change) / np.maximum(half, 1e-12)).max(axis=0)
    number = np.arange(1.0, change.shape[0] + 1.0)
    panel = Panel(Axis("record [–]", most=12), Axis("change against the baseline [%]"))
    for k, colour in zip(np.argsort(-score)[:MOST], OKABE_ITO, strict=False):
        y, h = change[:, k], half[:, k]
        words = f"{data['channel'].values[k]}, {data['name'].values[k]}"
        panel.band(number, low=y - h, high=y + h, colour=colour, opacity=0.2)
        panel.curve(number, y, colour=colour, width=1.2, marker="circle", size=3.0, label=words)
    return Picture([[panel]], size=(WIDE, 3.6), legend=3)
