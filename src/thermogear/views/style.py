"""One look for all pictures: colours that a colour-blind reader tells apart, quiet axes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.vocabulary import UNDEFORMED

COLD, HOT = "#0072B2", "#D55E00"
INK, QUIET, FAINT = "#22303c", "#66727d", "#d5dbe0"
DRY, MIXED = "#8a5a2b", "#009E73"
STATES = {UNDEFORMED: COLD, "hot": HOT}
OKABE_ITO = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
SCALES = {
    "viridis": "440154 48186a 472d7b 424086 3b528b 33638d 2c728e 26828e 21918c 1f9f88 27ad81 3dbc74"
    " 5cc863 81d34d aadc32 d5e21a fde725",
    "magma": "000004 0a0822 1d1147 36106b 51127c 6a1c81 832681 9c2e7f b73779 cf4070 e55064 f4695c"
    " fb8761 fea571 fec287 fde0a1 fcfdbf",
    "YlOrRd": "ffffcc ffeda0 fed976 feb24c fd8d3c fc4e2a e31a1c bd0026 800026",
    "Reds": "fff5f0 fee0d2 fcbba1 fc9272 fb6a4a ef3b2c cb181d a50f15 67000d",
    "PuBu": "fff7fb ece7f2 d0d1e6 a6bddb 74a9cf 3690c0 0570b0 045a8d 023858",
    "Blues": "f7fbff deebf7 c6dbef 9ecae1 6baed6 4292c6 2171b5 08519c 08306b",
    "RdYlGn": "a50026 d73027 f46d43 fdae61 fee08b ffffbf d9ef8b a6d96a 66bd63 1a9850 006837",
    "tab20": "1f77b4 aec7e8 ff7f0e ffbb78 2ca02c 98df8a d62728 ff9896 9467bd c5b0d5 8c564b c49c94"
    " e377c2 f7b6d2 7f7f7f c7c7c7 bcbd22 dbdb8d 17becf 9edae5",
}
"""Scales of colours, evenly from low to high; of tab20 each stands by itself."""

SINGLE = (4.9, 3.1)
"""Size [in] of a picture with one axis, readable at phone width."""
WIDE = 10.0
"""Width [in] of a picture that spans the page."""

MOST_POINTS = 6
"""At most so many operating points are drawn in one picture."""

RC: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"],
    "font.size": 9.0,
    "mathtext.fontset": "dejavusans",
    "mathtext.default": "regular",
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlecolor": INK,
    "axes.labelsize": 9.0,
    "axes.labelcolor": INK,
    "axes.edgecolor": QUIET,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "grid.color": FAINT,
    "grid.linewidth": 0.6,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "legend.handlelength": 2.8,
    "legend.columnspacing": 1.4,
    "lines.linewidth": 1.7,
    "lines.solid_capstyle": "round",
    "text.color": INK,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "path.simplify": True,
    "path.simplify_threshold": 0.2,
    "svg.fonttype": "none",
    "svg.image_inline": True,
}


LEFT, RIGHT, TOP, BOTTOM = 0.72, 0.14, 0.30, 0.48
"""Margins [in] of every picture: fixed, so that axes of neighbouring pictures line up."""
BETWEEN, ABOVE = 0.78, 0.86
"""Space [in] between the columns and between the rows of axes."""
LEGEND_LINE = 0.20
HANDLE, LETTER = 0.55, 0.066
"""Width [in] of a legend's line with its gaps, and of a letter."""


def path_points(data: Dataset) -> dict[str, float]:
    """A..E [m] of the path of contact as stored with it; nothing where they are not."""
    try:
        found = json.loads(str(data.attrs.get("path_points", "{}")))
        return {str(k)[:2]: float(v) for k, v in found.items()}
    except (ValueError, AttributeError, TypeError):
        return {}


def bundle_line(bundles: Sequence[str], place: int) -> tuple[float, ...]:
    """Solid for a bundle, dashed for the thesis's; others get dotted lines."""
    name = bundles[place]
    if name.startswith("thesis"):
        return (5, 2)
    return () if place == 0 or name.startswith("consistent") else (1, 1.5)


def scale(name: str) -> list[str]:
    """The colours of a scale, evenly from its low to its high end."""
    return [f"#{colour}" for colour in SCALES[name].split()]


RAMPS = {"cool": ("viridis", 0.12, 0.72, 0.3), "warm": ("YlOrRd", 0.42, 0.95, 0.95)}
"""Scale, its part from low to high, and the place of a single colour; warm is for temperatures."""


def ramp(count: int, kind: str = "cool") -> list[str]:
    """``count`` colours in order, by one of :data:`RAMPS`."""
    name, low, high, single = RAMPS[kind]
    colours = scale(name)
    places = np.linspace(low, high, count) if count > 1 else np.array([single])
    parts = np.array([[int(c[i : i + 2], 16) for c in colours] for i in (1, 3, 5)])
    evenly = np.linspace(0.0, 1.0, len(colours))
    found = np.round([np.interp(places, evenly, part) for part in parts]).astype(int)
    return ["#{:02x}{:02x}{:02x}".format(*colour) for colour in found.T]


def chosen(count: int, *, most: int = MOST_POINTS) -> list[int]:
    """Which of ``count`` operating points are drawn: all, or ``most`` spread evenly."""
    if count <= most:
        return list(range(count))
    return sorted({round(i * (count - 1) / (most - 1)) for i in range(most)})


def names_of(data: Dataset, axis: str) -> list[str]:
    """The names along a text coordinate, as stored."""
    return [str(v) for v in data[axis].values]
