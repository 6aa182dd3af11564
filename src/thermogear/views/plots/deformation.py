"""What heat does to the flanks: growth along the path, and the profile over the involute."""

from __future__ import annotations

import math

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MILLIMETRE
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.curves import along_path, hot_state
from thermogear.views.style import HOT, INK, OKABE_ITO, QUIET, bundle_line, names_of
from thermogear.views.typesetting import plain, shown


def growth(data: Dataset) -> Picture:
    """Normal growth of both flanks and their sum, each bundle with a line style of its own."""
    panel = along_path(data, Axis("normal growth of the hot flank $δ_{n}$ [µm]"))
    x, here = shown(data, "path_position"), hot_state(data).isel(operating=0)
    bundles = names_of(data, "bundle")
    lines = {
        "deformation_sum": ("sum", INK),
        "wheel_deformation": ("wheel", OKABE_ITO[3]),
        "pinion_deformation": ("pinion", OKABE_ITO[2]),
    }
    for place, bundle in enumerate(bundles):
        for name, (words, colour) in lines.items():
            panel.curve(
                x,
                shown(here.isel(bundle=place), name),
                colour=colour,
                dash=bundle_line(bundles, place),
                label=plain(f"{words}, {bundle}"),
            )
    panel.y.low = min(0.0, panel.extent("y")[0])
    return Picture([[panel]], legend=2)


def hot_profiles(data: Dataset) -> dict[str, tuple[str, str, tuple[float, ...], float]]:
    """The hot profiles that are stored: words, colour, dash and width of each."""
    printed = "printed_x" in data
    words = "hot, repaired" if printed else "hot"
    found: dict[str, tuple[str, str, tuple[float, ...], float]] = {
        "consistent": (words, HOT, (), 2.4)
    }
    if printed:
        found["printed"] = ("hot, as printed", INK, (4, 2), 1.3)
    return found


def magnification(data: Dataset, gear: int) -> int:
    """The round factor that makes the largest displacement about a fifth of the tooth's height."""
    here = data.isel(gear=gear)
    height = float(np.ptp(here["involute_y"].values))
    moved = max(
        float(np.nanmax(np.abs(here[f"{kind}_{axis}"].values - here[f"involute_{axis}"].values)))
        for kind in hot_profiles(data)
        for axis in "xy"
    )
    if not moved > 0.0 or not math.isfinite(moved):
        return 1
    wanted = max(0.2 * height / moved, 1.0)
    power = 10.0 ** math.floor(math.log10(wanted))
    return int(next(step * power for step in (5.0, 2.0, 1.0) if step * power <= wanted))


def profile(data: Dataset, gear: int) -> Picture:
    """One tooth: cold involute and the hot profiles, their displacement magnified."""
    here = data.isel(gear=gear)
    factor = magnification(data, gear)
    panel = Panel(
        Axis("across the tooth, from its centre line x [mm]"),
        Axis("radius along the centre line y [mm]"),
        plain(f"{here['gear'].item()}: displacement × {factor}"),
        equal=True,
    )
    x0, y0 = here["involute_x"].values, here["involute_y"].values
    curves = {**hot_profiles(data), "involute": ("cold involute", QUIET, (), 1.3)}
    for kind, (words, colour, dash, width) in curves.items():
        x = MILLIMETRE(x0 + factor * (here[f"{kind}_x"].values - x0))
        y = MILLIMETRE(y0 + factor * (here[f"{kind}_y"].values - y0))
        x, y = np.concatenate([-x, x[::-1]]), np.concatenate([y, y[::-1]])
        panel.curve(x, y, colour=colour, dash=dash, width=width, label=words)
    return Picture([[panel]], size=(4.9, 4.3))
