"""The dynamic factor over speed, as a coarse look found it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import display
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import HOT, INK, QUIET, WIDE

if TYPE_CHECKING:
    import xarray as xr

KEPT = 1e-3
"""Share of time out of contact below which contact is kept."""


def speeds_picture(data: xr.Dataset) -> Picture:
    """Every motion's dynamic factor over pinion speed: open in contact, filled where it is lost."""
    panel = Panel(Axis("pinion speed [rpm]"), Axis("dynamic factor [–]"))
    rpm = display("pinion_speed")(data["pinion_speed"].values)
    factor, lost = data["dynamic_factor"].values, data["contact_loss_share"].values > KEPT
    for where, colour, label in ((~lost, INK, "in contact"), (lost, HOT, "flanks part")):
        if where.any():
            panel.points(
                rpm[where], factor[where], colour=colour, size=4.0, open=not lost[where].all(),
                label=label,
            )  # fmt: skip
    for own in np.unique(np.atleast_1d(data.attrs.get("own_speeds", ()))):
        panel.line(x=float(display("pinion_speed")(own)), colour=QUIET, width=1.0, dash=(4.0, 3.0))
    return Picture([[panel]], size=(WIDE, 3.2))
