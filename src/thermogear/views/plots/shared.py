"""The load-shared mesh force beside the one-spring form, at rest and in motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import MICROMETRE, SPEED
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, INK, QUIET, WIDE

if TYPE_CHECKING:
    import xarray as xr

FORMS: dict[str, tuple[str, str, tuple[float, ...]]] = {
    "exact": ("exact loaded contact", INK, (5, 2)),
    "shared": ("one spring for each tooth pair", COLD, ()),
    "one_spring": ("one spring k(t)", HOT, ()),
}


def shared_picture(rest: xr.Dataset, motion: xr.Dataset) -> Picture:
    """Stiffness and error over load; swing of the error in motion over speed at two loads."""
    load = rest["load"].values
    mean = float(load[np.argmin(np.abs(rest["factor"].values - 1.0))])
    stiffness = Panel(
        Axis("normal force [N]", log="full"), Axis("mean stiffness [10⁸ N/m]"),
        "At rest: stiffness",
    )  # fmt: skip
    swing = Panel(
        Axis("normal force [N]", log="full"), Axis("peak to peak [µm]", log="full"),
        "At rest: transmission error",
    )  # fmt: skip
    for panel, name, scale in ((stiffness, "stiffness", 1e-8), (swing, "swing", 1e6)):
        for form, (words, colour, dash) in FORMS.items():
            values = scale * rest[f"{form}_{name}"].values
            panel.curve(load, values, colour=colour, dash=dash, width=1.5, label=words)
        panel.line(x=mean, colour=QUIET, width=1.0, dash=(1, 2))
    rpm = SPEED(motion["speed"].values)
    below = []
    for place, part in enumerate(motion["part"].values):
        panel = Panel(
            Axis("pinion speed [rpm]"), Axis("transmission error, peak to peak [µm]"),
            f"In motion at {float(part):g} of the mean load",
        )  # fmt: skip
        for form in ("shared", "one_spring"):
            words, colour, dash = FORMS[form]
            values = MICROMETRE(motion[f"{form}_swing"].values[:, place])
            panel.curve(rpm, values, colour=colour, dash=dash, width=1.3, marker="dot", label=words)
        below.append(panel)
    return Picture([[stiffness, swing], below], size=(WIDE, 6.4), above=0.85, between=0.85)
