"""Matplotlib draws a picture: one function for each kind of mark, and nothing about gears."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from itertools import chain
from typing import Any, cast

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import (
    BoundaryNorm,
    Colormap,
    LinearSegmentedColormap,
    ListedColormap,
    LogNorm,
    Normalize,
)
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullLocator

from thermogear.base.display import raised
from thermogear.views import picture as data
from thermogear.views.style import HANDLE, INK, LEGEND_LINE, LETTER, QUIET, RC

MARKERS = {
    "": "", "circle": "o", "dot": ".", "square": "s", "diamond": "D", "thin diamond": "d",
    "up": "^", "down": "v", "cross": "X", "plus": "P", "upright": "|", "level": "_",
}  # fmt: skip
BOX = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.5}


@contextmanager
def styled() -> Iterator[None]:
    """Matplotlib's settings of this house, and nothing a user has set elsewhere."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(cast(Any, RC))  # its keys are a list of literals
        yield


def image(picture: data.Picture, kind: str, *, salt: str = "", **how: Any) -> bytes:
    """The file that shows ``picture``; ``kind`` is png, svg or pdf, ``how`` as savefig takes it.

    The same picture gives the same SVG, with the ids of its ``salt``.
    """
    stream = io.BytesIO()
    told = {"Date": None, "Creator": None} if kind == "svg" else None
    with styled():
        mpl.rcParams["svg.hashsalt"] = salt or kind
        draw(picture).savefig(stream, format=kind, metadata=told, **how)
    return stream.getvalue()


def draw(picture: data.Picture) -> Figure:
    """The figure that shows ``picture``, without any global state."""
    with styled():
        figure, places = _frame(picture)
        bars: dict[str, tuple[Any, data.Field, list[Axes]]] = {}
        panels = list(chain(*picture.panels))
        for one, panel in zip(places, panels, strict=True):
            for mark in panel.marks:
                drawn = DRAWN[type(mark)](one, mark)
                if isinstance(mark, data.Field) and mark.words:
                    bars.setdefault(mark.words, (drawn, mark, []))[2].append(one)
        for one, panel in zip(places, panels, strict=True):
            _finish(one, panel)
        if picture.title:
            figure.suptitle(picture.title, y=0.985, fontsize=11, fontweight="bold")
        _legend(figure, places, picture.legend)
        for drawn, field, beside in bars.values():
            _colour_bar(figure, drawn, field, beside)
    return figure


def _frame(picture: data.Picture) -> tuple[Figure, list[Axes]]:
    rows, columns = len(picture.panels), len(picture.panels[0])
    width, height = picture.size
    figure = Figure(figsize=(width, height), dpi=picture.resolution)
    FigureCanvasAgg(figure)
    shared: dict[str, Any] = {"": "none", "row": "row", "column": "col"}
    axes = figure.subplots(
        rows, columns, squeeze=False, height_ratios=picture.heights or None,
        sharex=shared[picture.share_x], sharey=shared[picture.share_y],
    )  # fmt: skip
    wide = width - picture.left - picture.right - (columns - 1) * picture.between
    high = height - picture.top - picture.bottom - (rows - 1) * picture.above
    figure.subplots_adjust(
        left=picture.left / width,
        right=1.0 - picture.right / width,
        top=1.0 - picture.top / height,
        bottom=picture.bottom / height,
        wspace=picture.between * columns / wide,
        hspace=picture.above * rows / high,
    )
    return figure, list(axes.flat)


def _curve(axes: Axes, mark: data.Curve) -> None:
    axes.plot(
        mark.x, mark.y, color=mark.colour, linewidth=mark.width, linestyle=_dash(mark.dash),
        marker=MARKERS[mark.marker], markersize=mark.size, alpha=_part(mark.opacity),
        zorder=mark.order, label=mark.label, rasterized=mark.pixels,
    )  # fmt: skip


def _points(axes: Axes, mark: data.Points) -> None:
    axes.plot(
        mark.x, mark.y, color=mark.colour, linestyle="none", marker=MARKERS[mark.marker],
        markersize=mark.size, markerfacecolor="none" if mark.open else mark.colour,
        markeredgecolor=mark.edge or mark.colour, markeredgewidth=mark.edge_width,
        alpha=_part(mark.opacity), zorder=mark.order, label=mark.label, rasterized=mark.pixels,
    )  # fmt: skip


def _stems(axes: Axes, mark: data.Stems) -> None:
    axes.vlines(mark.x, mark.low, mark.y, color=mark.colour, linewidth=1.3, zorder=mark.order)
    heads = {"size": mark.size, "open": mark.open, "order": mark.order, "label": mark.label}
    _points(axes, data.Points(mark.x, mark.y, colour=mark.colour, **heads))  # type: ignore[arg-type]


def _band(axes: Axes, mark: data.Band) -> None:
    where: Any = {"transform": axes.get_xaxis_transform()} if mark.at == "x" else {}
    axes.fill_between(
        mark.x, mark.low, mark.high, color=mark.colour, alpha=_part(mark.opacity), linewidth=0.0,
        step="mid" if mark.step else None, zorder=mark.order, label=mark.label, **where,
    )  # fmt: skip


def _span(axes: Axes, mark: data.Span) -> None:
    for ends, shade in ((mark.x, axes.axvspan), (mark.y, axes.axhspan)):
        if ends is not None:
            look: Any = {"color": mark.colour, "alpha": _part(mark.opacity), "linewidth": 0.0}
            shade(*ends, zorder=mark.order, label=mark.label, **look)


def _line(axes: Axes, mark: data.Line) -> None:
    for place, draw_at in ((mark.x, axes.axvline), (mark.y, axes.axhline)):
        if place is not None:
            draw_at(
                place, color=mark.colour, linewidth=mark.width, linestyle=_dash(mark.dash),
                alpha=_part(mark.opacity), zorder=mark.order, label=mark.label,
            )  # fmt: skip


def _text(axes: Axes, mark: data.Text) -> None:
    systems = {
        "data": axes.transData, "panel": axes.transAxes,
        "x": axes.get_xaxis_transform(), "y": axes.get_yaxis_transform(),
    }  # fmt: skip
    axes.annotate(
        mark.words, (mark.x, mark.y), xycoords=systems[mark.at], xytext=mark.offset,
        textcoords="offset points", ha=mark.across, va=mark.up, fontsize=mark.size,
        color=mark.colour or INK, fontweight="bold" if mark.bold else "normal",
        bbox=BOX if mark.box else None, wrap=mark.wrap, zorder=mark.order,
    )  # fmt: skip


def _bars(axes: Axes, mark: data.Bars) -> None:
    drawn = axes.bar(
        mark.x, mark.y, mark.width, color=mark.colour, zorder=mark.order, label=mark.label
    )
    if mark.words:
        axes.bar_label(drawn, mark.words, fontsize=8.0, padding=1.5, color=INK)


def _field(axes: Axes, mark: data.Field) -> Any:
    if np.size(mark.levels):
        return axes.contourf(
            mark.x, mark.y, mark.values, levels=mark.levels, cmap=_scale(mark), extend="both"
        )
    norm: Normalize = (LogNorm if mark.log else Normalize)(mark.low, mark.high)
    if mark.classes:
        norm = BoundaryNorm(np.arange(len(mark.classes) + 1) - 0.5, len(mark.classes))
        values = np.asarray(mark.values, dtype=float)
        for code in np.unique(values[np.isfinite(values)]).astype(int):
            axes.plot(
                [], [], "s", color=mark.colours[code], markeredgecolor=QUIET,
                label=mark.classes[code],
            )  # fmt: skip
    return axes.pcolormesh(
        mark.x, mark.y, mark.values, cmap=_scale(mark), norm=norm, rasterized=True
    )


def _scale(mark: data.Field) -> Colormap:
    if mark.classes:
        return ListedColormap(list(mark.colours))
    return LinearSegmentedColormap.from_list("", list(mark.colours))


def _contours(axes: Axes, mark: data.Contours) -> None:
    levels = np.asarray(mark.levels)
    lines = axes.contour(mark.x, mark.y, mark.values, levels=levels, colors=INK, linewidths=1.1)
    words = dict(zip(lines.levels, mark.words, strict=True))
    for label in axes.clabel(lines, fmt=words, fontsize=7.5):
        label.set_bbox(BOX)


def _hatch(axes: Axes, mark: data.Hatch) -> None:
    hatched = axes.contourf(
        mark.x, mark.y, mark.values, levels=[0.5, 1.5], colors="none", hatches=["///"]
    )
    hatched.set_edgecolor(QUIET)
    hatched.set_linewidth(0.0)


DRAWN: dict[type, Callable[[Axes, Any], Any]] = {
    data.Curve: _curve, data.Points: _points, data.Stems: _stems, data.Band: _band,
    data.Span: _span, data.Line: _line, data.Text: _text, data.Bars: _bars, data.Field: _field,
    data.Contours: _contours, data.Hatch: _hatch,
}  # fmt: skip


def _dash(lengths: Sequence[float]) -> Any:
    return (0, tuple(lengths)) if lengths else "-"


def _part(opacity: float) -> float | None:
    return None if opacity == 1.0 else opacity


def _finish(axes: Axes, panel: data.Panel) -> None:
    """What is around the marks: axes, words, grid, title."""
    if panel.background:
        axes.set_facecolor(panel.background)
    covered = any(isinstance(mark, data.Field) for mark in panel.marks)
    for name, axis in (("x", panel.x), ("y", panel.y)):
        _axis(axes, name, axis)
        if covered or axis.names or not axis.grid:
            axes.grid(visible=False, axis=cast(Any, name))
    if not (panel.x.words or panel.y.words or panel.x.names or panel.y.names):
        axes.set_axis_off()
    if panel.equal:
        ends = (panel.x.low, panel.x.high, panel.y.low, panel.y.high)
        axes.set_aspect("equal", adjustable="datalim" if None in ends else "box")
    if panel.top:
        factor = panel.top.factor
        above = axes.secondary_xaxis(
            "top", functions=(partial(np.multiply, factor), lambda f: np.divide(f, factor))
        )
        above.set_xlabel(panel.top.words)
    letters = any(isinstance(m, data.Text) and m.at == "x" and m.y > 1.0 for m in panel.marks)
    if panel.title:
        size: Any = {"fontsize": 9.0} if panel.x.small else None
        axes.set_title(panel.title, size, pad=18.0 if letters else None)


def _axis(axes: Axes, name: str, axis: data.Axis) -> None:
    own = axes.xaxis if name == "x" else axes.yaxis
    if axis.margin != 0.05:
        getattr(axes, f"set_{name}margin")(axis.margin)
    if axis.log:
        getattr(axes, f"set_{name}scale")("log")
        if axis.log != "full":
            own.set_major_formatter(FuncFormatter(WRITTEN[axis.log]))
            own.set_minor_locator(NullLocator())
    if axis.inner:
        own.set_major_locator(MaxNLocator(axis.most, prune="both"))
    elif axis.most:
        axes.locator_params(axis=cast(Any, name), nbins=axis.most)
    if np.size(axis.ticks):
        slanted: Any = {"rotation": axis.slant, "ha": "right"} if axis.slant else {}
        own.set_ticks(axis.ticks, axis.names or None, **slanted)
    if (axis.low, axis.high) != (None, None):
        getattr(axes, f"set_{name}lim")(axis.low, axis.high)
    own.set_label_text(axis.words)
    if axis.small:
        own.label.set_fontsize(8.5)
        own.labelpad = 1.5 if name == "x" else 1.0


def _power_of_ten(value: float, _: object = None) -> str:
    power = round(np.log10(value)) if value > 0.0 else 0
    return {0: "1", 1: "10", -1: "0.1"}.get(power, f"10{raised(power)}")


WRITTEN: dict[str, Callable[[float, object], str]] = {
    "decades": _power_of_ten,
    "plain": lambda value, _: f"{value:g}",
}


def _colour_bar(figure: Figure, drawn: Any, field: data.Field, beside: list[Axes]) -> None:
    """One bar for all panels of the same words; narrow where contours stand under a title."""
    where: Any = beside[0] if len(beside) == 1 else beside
    if not np.size(field.levels):
        figure.colorbar(drawn, ax=where, label=field.words)
        return
    bar = figure.colorbar(drawn, ax=where, pad=0.02, aspect=24, format="%.3g")
    low, high = float(np.min(field.levels)), float(np.max(field.levels))
    bar.set_ticks([tick for tick in MaxNLocator(5).tick_values(low, high) if low <= tick <= high])
    bar.ax.tick_params(labelsize=7.5)
    cast(Any, bar.outline).set_visible(False)


def _legend(figure: Figure, source: Sequence[Axes], columns: int) -> None:
    """One legend under the picture, never over data; entries of the same name once.

    At most so many ``columns`` as fit beside each other. The picture grows downwards by the
    legend's height, so that the axes keep theirs.
    """
    found: dict[str, Any] = {}
    for axes in source:
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
        list(found.values()), list(found), loc="lower center", bbox_to_anchor=(0.5, 0.0),
        ncols=columns, borderaxespad=0.25, labelspacing=0.3,
    )  # fmt: skip


def _legend_width(names: Sequence[str], columns: int) -> float:
    """About how wide [in] a legend is whose entries run down its columns."""
    rows = -(-len(names) // columns)
    longest = [max(map(_letters, names[i : i + rows])) for i in range(0, len(names), rows)]
    return sum(HANDLE + LETTER * count for count in longest)


def _letters(name: str) -> int:
    """How many letters a label shows, its marks of mathematics aside."""
    return len(name) - 2 * name.count("$") - name.count("{") - name.count("_")
