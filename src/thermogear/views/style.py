"""One look for all pictures: colours that a colour-blind reader tells apart, quiet axes."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, cast

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from thermogear.base.vocabulary import UNDEFORMED
from thermogear.views.words import axis_label, math_symbol, plain, raised

COLD, HOT = "#0072B2", "#D55E00"
INK, QUIET, FAINT = "#22303c", "#66727d", "#d5dbe0"
DRY, MIXED = "#8a5a2b", "#009E73"
STATES = {UNDEFORMED: COLD, "hot": HOT}
OKABE_ITO = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")

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


@contextmanager
def styled() -> Iterator[None]:
    """Matplotlib's settings of this house, and nothing a user has set elsewhere."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(cast(Any, RC))  # its keys are a list of literals
        yield


LEFT, RIGHT, TOP, BOTTOM = 0.72, 0.14, 0.30, 0.48
"""Margins [in] of every picture: fixed, so that axes of neighbouring pictures line up."""
BETWEEN, ABOVE = 0.78, 0.86
"""Space [in] between the columns and between the rows of axes."""
LEGEND_LINE = 0.20
HANDLE, LETTER = 0.55, 0.066
"""Width [in] of a legend's line with its gaps, and of a letter."""


def picture(
    rows: int = 1,
    columns: int = 1,
    size: tuple[float, float] = SINGLE,
    *,
    top: float = TOP,
    between: float = BETWEEN,
    above: float = ABOVE,
    left: float = LEFT,
    **layout: Any,
) -> tuple[Figure, np.ndarray[Any, np.dtype[np.object_]]]:
    """A figure without any global state, and its axes as an array (rows, columns).

    Lengths are in inches: ``top`` and ``left`` margins, the space ``between`` columns and
    ``above`` each further row. Room for a legend is made by :func:`legend_below`.
    """
    figure = Figure(figsize=size)
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False, **layout)
    width, height = size
    one_wide = (width - left - RIGHT - (columns - 1) * between) / columns
    one_high = (height - top - BOTTOM - (rows - 1) * above) / rows
    figure.subplots_adjust(
        left=left / width,
        right=1.0 - RIGHT / width,
        top=1.0 - top / height,
        bottom=BOTTOM / height,
        wspace=between / one_wide,
        hspace=above / one_high,
    )
    return figure, axes


def legend_below(figure: Figure, source: Axes | Sequence[Axes], columns: int = 3) -> None:
    """One legend under the picture, never over data; entries of the same name once.

    At most so many ``columns`` as fit beside each other. The picture grows downwards by the
    legend's height, so that the axes keep theirs.
    """
    found: dict[str, Any] = {}
    for axes in [source] if isinstance(source, Axes) else source:
        for handle, name in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(name, handle)
    if not found:
        return
    width, height = figure.get_size_inches()
    columns = min(columns, len(found))
    while columns > 1 and _legend_width(list(found), columns) > width:
        columns -= 1
    room = LEGEND_LINE * -(-len(found) // columns) + 0.08
    layout = figure.subplotpars
    grown = height + room
    figure.set_size_inches(width, grown)
    figure.subplots_adjust(
        bottom=(layout.bottom * height + room) / grown,
        top=(layout.top * height + room) / grown,
    )
    figure.legend(
        list(found.values()),
        list(found),
        loc="lower center",
        bbox_to_anchor=(0.5, 0.0),
        ncols=columns,
        borderaxespad=0.25,
        labelspacing=0.3,
    )


def _legend_width(names: Sequence[str], columns: int) -> float:
    """About how wide [in] a legend is whose entries run down its columns."""
    rows = -(-len(names) // columns)
    longest = [max(map(_letters, names[i : i + rows])) for i in range(0, len(names), rows)]
    return sum(HANDLE + LETTER * count for count in longest)


def _letters(name: str) -> int:
    """How many letters a label shows, its marks of mathematics aside."""
    return len(name) - 2 * name.count("$") - name.count("{") - name.count("_")


def log_axis(axes: Axes) -> None:
    """A logarithmic vertical axis with powers of ten written plainly."""
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(_power_of_ten))
    axes.yaxis.set_minor_locator(NullLocator())


def _power_of_ten(value: float, _: object = None) -> str:
    power = round(np.log10(value)) if value > 0.0 else 0
    return {0: "1", 1: "10", -1: "0.1"}.get(power, f"10{raised(power)}")


def name_axes(axes: Axes, x: str, y: str, **words: str | None) -> None:
    """Label both axes with words, symbol and unit of the stored quantities ``x`` and ``y``."""
    axes.set_xlabel(axis_label(x, words.get("x_words"), words.get("x_unit")))
    axes.set_ylabel(axis_label(y, words.get("y_words"), words.get("y_unit")))


def mark_path(axes: Axes, data: xr.Dataset) -> None:
    """Mark A..E of the path of contact [mm]; C, the pitch point, stands out."""
    axes.set_xlabel(axis_label("path_position", "distance from the pinion's tangent point"))
    for name, position in path_points(data).items():
        pitch = name == "C"
        axes.axvline(
            1e3 * position,
            color=QUIET if pitch else FAINT,
            linewidth=1.1 if pitch else 0.9,
            linestyle=(0, (1, 2)) if pitch else "-",
            zorder=0.5,
        )
        axes.text(
            1e3 * position,
            1.015,
            name,
            transform=axes.get_xaxis_transform(),
            ha="center",
            va="bottom",
            fontsize=8.5,
            color=INK if pitch else QUIET,
            fontweight="bold" if pitch else "normal",
        )
    axes.grid(visible=False, axis="x")
    s = data["path_position"].values
    low, high = 1e3 * float(s.min()), 1e3 * float(s.max())
    axes.set_xlim(low - 0.02 * (high - low), high + 0.02 * (high - low))


def path_points(data: xr.Dataset) -> dict[str, float]:
    """A..E [m] of the path of contact as stored with it; nothing where they are not."""
    try:
        found = json.loads(str(data.attrs.get("path_points", "{}")))
        return {str(k)[:2]: float(v) for k, v in found.items()}
    except (ValueError, AttributeError, TypeError):
        return {}


def bundle_line(bundles: Sequence[str], place: int) -> Any:
    """Solid for a bundle, dashed for the thesis's; others get dotted lines."""
    name = bundles[place]
    if name.startswith("thesis"):
        return (0, (5, 2))
    return "-" if place == 0 or name.startswith("consistent") else (0, (1, 1.5))


def ramp(count: int, warm: bool = False) -> list[str]:
    """``count`` colours in order: dark to light, or a warm ramp for temperatures."""
    colours = mpl.colormaps["YlOrRd" if warm else "viridis"]
    low, high = (0.42, 0.95) if warm else (0.12, 0.72)
    places = np.linspace(low, high, count) if count > 1 else np.array([high if warm else 0.3])
    return [mpl.colors.to_hex(colours(float(p))) for p in places]


def chosen(count: int, *, most: int = MOST_POINTS) -> list[int]:
    """Which of ``count`` operating points are drawn: all, or ``most`` spread evenly."""
    if count <= most:
        return list(range(count))
    return sorted({round(i * (count - 1) / (most - 1)) for i in range(most)})


def names_of(data: xr.Dataset, axis: str) -> list[str]:
    """The names along a text coordinate, as stored."""
    return [str(v) for v in data[axis].values]


def note(axes: Axes, text: str) -> None:
    """A sentence in the middle of an axis that has nothing to draw."""
    axes.text(
        0.5, 0.5, plain(text), transform=axes.transAxes, ha="center", va="center",
        color=QUIET, fontsize=9.0, wrap=True,
    )  # fmt: skip


__all__ = [
    "COLD",
    "DRY",
    "FAINT",
    "HOT",
    "INK",
    "MIXED",
    "OKABE_ITO",
    "QUIET",
    "SINGLE",
    "STATES",
    "WIDE",
    "bundle_line",
    "chosen",
    "legend_below",
    "log_axis",
    "mark_path",
    "math_symbol",
    "name_axes",
    "names_of",
    "note",
    "path_points",
    "picture",
    "ramp",
    "styled",
]
