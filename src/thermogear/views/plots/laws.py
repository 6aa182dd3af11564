"""All friction laws on one picture, with the regime the film stands in."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from thermogear.views.style import (
    DRY,
    FAINT,
    INK,
    OKABE_ITO,
    QUIET,
    WIDE,
    chosen,
    legend_below,
    mark_path,
    picture,
)
from thermogear.views.words import operating_names, plain

REGIME_COLOURS = {
    "boundary": "#c0504d",
    "mixed": "#e0b34c",
    "elastohydrodynamic": "#5b9bd5",
    "unloaded": FAINT,
}
LAW_COLOURS = (*OKABE_ITO, DRY, INK, QUIET)
BAND = 0.05
"""Height of the regime's band, part of the axis."""


def laws(data: xr.Dataset, place: int, means: frozenset[str] = frozenset()) -> Figure:
    """|mu| of every law along the path at one operating point; the band on top is the regime.

    Laws in ``means`` give one value for the mesh and are drawn dashed; where the contact leaves a
    law's range its curve is thin and dotted.
    """
    figure, axes = picture(size=(WIDE, 4.6), top=0.55)
    axis = axes[0, 0]
    here = data.isel(operating=place)
    x = 1e3 * here["path_position"].values
    for i, name in enumerate(str(n) for n in here["law"].values):
        one = here.isel(law=i)
        mu, outside = one["friction_coefficient"].values, one["outside_range"].values == 1
        if not np.isfinite(mu).any():
            continue
        colour = LAW_COLOURS[i % len(LAW_COLOURS)]
        line = (0, (5, 2)) if name in means else "-"
        inside = np.where(outside, np.nan, mu)
        axis.plot(x, inside, color=colour, linestyle=line, label=plain(name))
        if outside.any():
            axis.plot(
                x,
                np.where(outside, mu, np.nan),
                color=colour,
                linewidth=0.9,
                linestyle=(0, (1, 2)),
                label=plain(f"{name}, outside its range"),
            )
    top = axis.get_ylim()[1]
    axis.set_ylim(0.0, top * (1.0 + 1.5 * BAND))
    shares = here["regime_share"].values
    for k, name in enumerate(str(n) for n in here["regime_name"].values):
        axis.fill_between(
            x,
            1.0 - BAND,
            1.0,
            where=list(here["regime"].values == k),
            step="mid",
            transform=axis.get_xaxis_transform(),
            color=REGIME_COLOURS.get(name, QUIET),
            linewidth=0.0,
            label=f"band: {name}, {100.0 * float(shares[k]):.0f} % of the path",
        )
    axis.set_ylabel("friction coefficient |μ| [–]")
    mark_path(axis, data)
    axis.set_title(plain(operating_names(data)[place]), pad=18.0)
    legend_below(figure, axis, 4)
    return figure


def film(data: xr.Dataset) -> Figure:
    """Film parameter along the path at every operating point, with the regimes' borders."""
    figure, axes = picture()
    axis = axes[0, 0]
    x = 1e3 * data["path_position"].values
    values = data["film_parameter"].values
    names = operating_names(data)
    for i in chosen(len(names)):
        name = names[i]
        finite = np.where(np.isfinite(values[i]), values[i], np.nan)
        axis.plot(x, finite, color=OKABE_ITO[i % len(OKABE_ITO)], label=plain(name))
    highest = float(np.nanmax(np.where(np.isfinite(values), values, np.nan), initial=1.0))
    for border in (1.0, 3.0):
        if border <= 1.3 * highest:
            axis.axhline(border, color=INK, linewidth=0.9, linestyle=(0, (2, 2)))
    axis.set_ylim(bottom=0.0)
    axis.set_ylabel("film parameter Λ [–]")
    mark_path(axis, data)
    legend_below(figure, axis, 2)
    return figure
