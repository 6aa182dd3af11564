"""Spectral lines over orders of the mesh frequency, drawn so that small files stay honest."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from thermogear.views.style import FAINT, QUIET

Floats = NDArray[np.float64]

FEW_LINES = 80
"""Up to so many lines above the floor are drawn as stems; more are a continuum."""
DECADES = 5.0
"""How far below the greatest line the picture reaches."""


def mark_half_orders(axes: Axes, highest: float) -> None:
    """A dotted line at every half order of the mesh frequency."""
    for order in np.arange(0.5, highest + 0.2, 1.0):
        axes.axvline(order, color=QUIET, linewidth=0.8, linestyle=(0, (1, 2.5)), zorder=0.4)
    for order in np.arange(1.0, highest + 0.2, 1.0):
        axes.axvline(order, color=FAINT, linewidth=0.7, zorder=0.3)
    axes.grid(visible=False, axis="x")
    axes.set_xlim(0.0, highest + 0.25)
    axes.set_xticks(np.arange(0.0, highest + 0.1, 1.0))


def draw_lines(
    axes: Axes,
    *,
    order: Floats,
    amplitude: Floats,
    colour: str,
    floor: float,
    highest: float,
    label: str,
    filled: bool = True,
) -> None:
    """Lines above ``floor`` up to the order ``highest``; the line at zero is left out."""
    kept = (order > 0.0) & (order <= highest + 0.2) & np.isfinite(amplitude)
    x, y = order[kept], amplitude[kept]
    above = y > floor
    if above.sum() <= FEW_LINES:
        axes.vlines(x[above], floor, y[above], color=colour, linewidth=1.3)
        axes.plot(
            x[above],
            y[above],
            linestyle="none",
            marker="o",
            markersize=4.2 if filled else 6.4,
            markerfacecolor=colour if filled else "none",
            markeredgecolor=colour,
            label=label,
        )
        return
    x, y = _envelope(x, np.maximum(y, floor))
    axes.plot(x, y, color=colour, linewidth=0.8, label=label)


def _envelope(x: Floats, y: Floats, most: int = 700) -> tuple[Floats, Floats]:
    """The greatest of neighbouring lines, so that no peak is lost in a small picture."""
    step = max(1, -(-x.size // most))
    whole = (x.size // step) * step
    blocks = y[:whole].reshape(-1, step)
    places = np.argmax(blocks, axis=1) + step * np.arange(blocks.shape[0])
    return x[places], y[places]


def floor_of(amplitudes: Floats, *, order: Floats, highest: float) -> tuple[float, float]:
    """(floor, top) of a logarithmic axis that holds every line worth seeing."""
    kept = (order > 0.0) & (order <= highest + 0.2)
    values = np.asarray(amplitudes)[..., kept]
    values = values[np.isfinite(values)]
    greatest = float(values.max()) if values.size else 0.0
    if greatest <= 0.0:
        return 1e-6, 1.0
    return greatest * 10.0**-DECADES, greatest * 3.0
