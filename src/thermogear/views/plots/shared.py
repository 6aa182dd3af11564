"""The load-shared mesh force beside the one-spring form, at rest and in motion."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from thermogear.base.units import RPM
from thermogear.views.style import COLD, HOT, INK, QUIET, WIDE, legend_below, picture

FORMS = {
    "exact": ("exact loaded contact", INK, (0, (5, 2))),
    "shared": ("one spring for each tooth pair", COLD, "-"),
    "one_spring": ("one spring k(t)", HOT, "-"),
}


def shared_picture(rest: xr.Dataset, motion: xr.Dataset) -> Figure:
    """Stiffness and deflection over load; swing of the motion over speed at two loads."""
    figure, axes = picture(2, 2, (WIDE, 6.4), above=0.85, between=0.85)
    (stiffness, swing), below = axes
    load = rest["load"].values
    mean = float(load[np.argmin(np.abs(rest["factor"].values - 1.0))])
    for form, (words, colour, line) in FORMS.items():
        drawn = {"color": colour, "linestyle": line, "linewidth": 1.5, "label": words}
        stiffness.plot(load, 1e-8 * rest[f"{form}_stiffness"].values, **drawn)
        swing.plot(load, 1e6 * rest[f"{form}_swing"].values, **drawn)
    for axis in (stiffness, swing):
        axis.set_xscale("log")
        axis.axvline(mean, color=QUIET, linewidth=1.0, linestyle=(0, (1, 2)))
        axis.set_xlabel("normal force [N]")
    swing.set_yscale("log")
    stiffness.set(title="At rest: stiffness", ylabel="mean stiffness [10⁸ N/m]")
    swing.set(title="At rest: deflection", ylabel="peak to peak [µm]")
    rpm = motion["speed"].values / RPM
    for place, axis in enumerate(below):
        part = float(motion["part"].values[place])
        for form in ("shared", "one_spring"):
            words, colour, line = FORMS[form]
            values = 1e6 * motion[f"{form}_swing"].values[:, place]
            axis.plot(
                rpm, values, color=colour, linestyle=line, linewidth=1.3, marker=".", label=words
            )
        axis.set(
            title=f"In motion at {part:g} of the mean load",
            xlabel="pinion speed [rpm]",
            ylabel="displacement, peak to peak [µm]",
        )
    legend_below(figure, stiffness, 3)
    return figure
