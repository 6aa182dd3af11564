"""Stored samples of a motion made into smooth curves, and no longer than they need to be."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SMOOTH = 640
"""Points wanted in a mesh period of a drawn curve."""


def refined(t: Floats, *, x: Floats, v: Floats, times: int) -> tuple[Floats, Floats, Floats]:
    """Smooth (t, x, v) through every sample, ``times`` as many points.

    ``t``, ``x`` and ``v`` = dx/dt in units that belong together: x by cubics with the slope v,
    v by cubics with the slope of its neighbours.
    """
    if times <= 1 or t.size < 3:
        return t, x, v
    u = np.arange(times) / times
    h = np.diff(t)[:, None]

    def through(y: Floats, slope: Floats) -> Floats:
        y0, y1, s0, s1 = y[:-1, None], y[1:, None], slope[:-1, None] * h, slope[1:, None] * h
        a, b = 2.0 * (y0 - y1) + s0 + s1, 3.0 * (y1 - y0) - 2.0 * s0 - s1
        return np.append((y0 + u * (s0 + u * (b + u * a))).ravel(), y[-1])

    fine = np.append((t[:-1, None] + u * h).ravel(), t[-1])
    return fine, through(x, v), through(v, np.gradient(v, t, edge_order=2))


def periods_to_draw(label: str, *, samples_per_period: int, stored: int, least: int = 1) -> int:
    """How many stored samples show the whole orbit: n periods where the label says so."""
    found = re.match(r"period-(\d+)$", label)
    if not found:
        return stored
    return int(min(stored, max(int(found[1]), least) * samples_per_period + 1))


def thinned(
    *, x: Floats, y: Floats, scale: tuple[float, float], cells: float = 400.0
) -> tuple[Floats, Floats]:
    """Points that a reader can tell apart: one for each cell of a grid over the picture.

    ``scale`` is the picture's extent in x and y, ``cells`` the grid's fineness: a settled
    motion keeps a point per period. Points that are not finite are left out.
    """
    kept = np.isfinite(x) & np.isfinite(y)
    x, y = x[kept], y[kept]
    steps = [size / cells if size > 0.0 else 1.0 for size in scale]
    places = np.stack([np.round(v / step) for v, step in zip((x, y), steps, strict=True)])
    _, first = np.unique(places, axis=1, return_index=True)
    first.sort()
    return x[first], y[first]
