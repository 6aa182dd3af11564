"""Spectral lines over orders of the mesh frequency, drawn so that small files stay honest."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.views.picture import Axis, Panel
from thermogear.views.style import FAINT, QUIET

FEW_LINES = 80
"""Up to so many lines above the floor are drawn as stems; more are a continuum."""
DECADES = 5.0
"""How far below the greatest line the picture reaches."""
ROOM, END = 0.2, 0.05
"""Lines so far [orders] beyond the highest one are drawn still, and what is free after them."""


SHAFT_ORDERS, MESH_ORDERS = 12.0, 3.4
"""How far pictures of a turn reach, in orders of the slower shaft and of the mesh."""


def shaft_orders(data: Dataset) -> tuple[str, float]:
    """Words of an axis in orders of the slower shaft that fills a turn, and how many one mesh is.

    ``data`` with the attributes ``mesh_periods`` and ``teeth`` of pinion and wheel.
    """
    of, teeth = int(data.attrs["mesh_periods"]), map(int, data.attrs["teeth"])
    count, gear = max((z, name) for z, name in zip(teeth, ("pinion", "wheel"), strict=True)
                      if of % z == 0)  # fmt: skip
    return f"order of the {gear}'s shaft [–]", float(count)


def over_orders(x: str, y: str, *, floor: float, top: float, highest: float) -> Panel:
    """A panel from order 0 to ``highest`` with a dotted line at every half order."""
    panel = Panel(
        Axis(
            x,
            low=0.0,
            high=highest + ROOM + END,
            ticks=np.arange(0.0, highest + 0.1, 1.0),
            grid=False,
        ),
        Axis(y, low=floor, high=top, log="decades"),
    )
    for order in np.arange(0.5, highest + ROOM, 1.0):
        panel.line(x=order, colour=QUIET, width=0.8, dash=(1, 2.5), order=0.4)
    for order in np.arange(1.0, highest + ROOM, 1.0):
        panel.line(x=order, colour=FAINT, width=0.7, order=0.3)
    return panel


def draw_lines(
    panel: Panel,
    *,
    order: Floats,
    amplitude: Floats,
    colour: str,
    label: str,
    filled: bool = True,
) -> None:
    """Lines above the panel's floor up to its highest order; the line at zero is left out."""
    floor, end = panel.y.low or 0.0, panel.x.high or np.inf
    kept = (order > 0.0) & (order <= end - END) & np.isfinite(amplitude)
    x, y = order[kept], amplitude[kept]
    above = y > floor
    if above.sum() <= FEW_LINES:
        panel.stems(
            x[above], y[above], low=floor, colour=colour, size=4.2 if filled else 6.4,
            open=not filled, label=label,
        )  # fmt: skip
        return
    x, y = _envelope(x, np.maximum(y, floor))
    panel.curve(x, y, colour=colour, width=0.8, label=label)


def _envelope(x: Floats, y: Floats, most: int = 700) -> tuple[Floats, Floats]:
    """The greatest of neighbouring lines, so that no peak is lost in a small picture."""
    step = max(1, -(-x.size // most))
    whole = (x.size // step) * step
    blocks = y[:whole].reshape(-1, step)
    places = np.argmax(blocks, axis=1) + step * np.arange(blocks.shape[0])
    return x[places], y[places]


def floor_of(amplitudes: Floats, *, order: Floats, highest: float) -> tuple[float, float]:
    """(floor, top) of a logarithmic axis that holds every line worth seeing."""
    kept = (order > 0.0) & (order <= highest + ROOM)
    values = np.asarray(amplitudes)[..., kept]
    values = values[np.isfinite(values)]
    greatest = float(values.max()) if values.size else 0.0
    return (1e-6, 1.0) if greatest <= 0.0 else (greatest * 10.0**-DECADES, greatest * 3.0)
