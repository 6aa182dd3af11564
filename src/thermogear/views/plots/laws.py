"""All friction laws on one picture, with the regime the film stands in."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MILLIMETRE, PERCENT
from thermogear.views.picture import Axis, Picture
from thermogear.views.plots.curves import along_path
from thermogear.views.style import DRY, FAINT, INK, OKABE_ITO, QUIET, WIDE, chosen
from thermogear.views.typesetting import operating_names, plain

REGIME_COLOURS = {
    "boundary": "#c0504d",
    "mixed": "#e0b34c",
    "elastohydrodynamic": "#5b9bd5",
    "unloaded": FAINT,
}
LAW_COLOURS = (*OKABE_ITO, DRY, INK, QUIET)
BAND = 0.05
"""Height of the regime's band, part of the axis."""


def laws(data: Dataset, place: int, means: frozenset[str] = frozenset()) -> Picture:
    """|mu| of every law along the path at one operating point; the band on top is the regime.

    Laws in ``means`` give one value for the mesh and are drawn dashed; where the contact leaves a
    law's range its curve is thin and dotted.
    """
    panel = along_path(data, Axis("friction coefficient |μ| [–]", low=0.0))
    panel.title = plain(operating_names(data)[place])
    here = data.isel(operating=place)
    x = MILLIMETRE(here["path_position"].values)
    for i, name in enumerate(str(n) for n in here["law"].values):
        one = here.isel(law=i)
        mu, outside = one["friction_coefficient"].values, one["outside_range"].values == 1
        if not np.isfinite(mu).any():
            continue
        colour = LAW_COLOURS[i % len(LAW_COLOURS)]
        inside = np.where(outside, np.nan, mu)
        dash = (5, 2) if name in means else ()
        panel.curve(x, inside, colour=colour, dash=dash, label=plain(name))
        if outside.any():
            beyond, label = np.where(outside, mu, np.nan), plain(f"{name}, outside its range")
            panel.curve(x, beyond, colour=colour, width=0.9, dash=(1, 2), label=label)
    panel.y.high = panel.extent("y")[1] * (1.0 + 1.5 * BAND)
    shares = here["regime_share"].values
    for k, name in enumerate(str(n) for n in here["regime_name"].values):
        low = np.where(here["regime"].values == k, 1.0 - BAND, np.nan)
        panel.band(
            x, low=low, high=np.ones(x.size), step=True, at="x",
            colour=REGIME_COLOURS.get(name, QUIET),
            label=f"band: {name}, {PERCENT(float(shares[k])):.0f} % of the path",
        )  # fmt: skip
    return Picture([[panel]], size=(WIDE, 4.6), top=0.55, legend=4)


def film(data: Dataset) -> Picture:
    """Film parameter along the path at every operating point, with the regimes' borders."""
    panel = along_path(data, Axis("film parameter Λ [–]", low=0.0))
    x = MILLIMETRE(data["path_position"].values)
    values = data["film_parameter"].values
    names = operating_names(data)
    for i in chosen(len(names)):
        panel.curve(x, values[i], colour=OKABE_ITO[i % len(OKABE_ITO)], label=plain(names[i]))
    highest = float(np.nanmax(np.where(np.isfinite(values), values, np.nan), initial=1.0))
    for border in (1.0, 3.0):
        if border <= 1.3 * highest:
            panel.line(y=border, colour=INK, width=0.9, dash=(2, 2))
    return Picture([[panel]], legend=2)
