"""What several pictures share: named axes, the path of contact, curves by point and by bundle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import MILLIMETRE
from thermogear.views.picture import Axis, Panel
from thermogear.views.style import (
    FAINT,
    INK,
    QUIET,
    bundle_line,
    chosen,
    names_of,
    path_points,
    ramp,
)
from thermogear.views.typesetting import axis_label, operating_names, plain, shown

MOST_POINTS = 2000
"""Points of a curve over the mesh phase."""
FEWEST = 24
"""Points in a mesh period that show its course; where fewer are left, its extremes are drawn."""


def axis_of(
    name: str, words: str | None = None, *, low: float | None = None, high: float | None = None
) -> Axis:
    """The axis of a stored quantity: its words, symbol and unit."""
    return Axis(axis_label(name, words), low=low, high=high)


def phase_panel(data: Dataset, y: Axis) -> Panel:
    """A panel over one mesh period, or over all mesh periods of a turn."""
    periods = float(int(data["mesh_phase"].values[-1]) + 1)
    return Panel(axis_of("mesh_phase", "mesh phase", low=0.0, high=periods), y)


def draw_phase(panel: Panel, x: Floats, *, values: Floats, **look: Any) -> None:
    """``values`` over the mesh phases ``x`` in at most :data:`MOST_POINTS` points.

    Every so many samples where :data:`FEWEST` of a mesh period are left; else a band from the
    least to the greatest of each mesh period, or of as many as it takes.
    """
    of, step = int(x[-1] - x[0]) + 1, -(-x.size // MOST_POINTS)
    if x.size >= FEWEST * of * step:
        panel.curve(x[::step], values[::step], **look)
        return
    cuts = np.arange(0, x.size, x.size // of * -(-of // (MOST_POINTS // 2 - 2)))
    ends = np.append(x[cuts], 2.0 * x[-1] - x[-2])
    # in the middle of each stretch, and out to both ends of the whole
    places = np.concatenate([ends[:1], 0.5 * (ends[1:] + ends[:-1]), ends[-1:]])
    low, high = (np.pad(f.reduceat(values, cuts), 1, "edge") for f in (np.minimum, np.maximum))
    colour, label = look["colour"], look.get("label", "")
    panel.band(places, low=low, high=high, opacity=0.4, colour=colour, label=label)
    for edge in (low, high):
        panel.curve(places, edge, colour=colour, width=0.4)


def along_path(data: Dataset, y: Axis, *, letters: bool = True) -> Panel:
    """A panel over the path of contact [mm], A..E marked; C, the pitch point, stands out."""
    s = MILLIMETRE(data["path_position"].values)
    room = 0.02 * float(np.ptp(s))
    x = axis_of("path_position", "distance from the pinion's tangent point")
    panel = Panel(x, y)
    x.low, x.high, x.grid = float(s.min()) - room, float(s.max()) + room, False
    for name, position in path_points(data).items():
        pitch, at = name == "C", MILLIMETRE(position)
        panel.line(
            x=at,
            colour=QUIET if pitch else FAINT,
            width=1.1 if pitch else 0.9,
            dash=(1, 2) if pitch else (),
            order=0.5,
        )
        if letters:
            colour = INK if pitch else QUIET
            panel.text(at, 1.015, name, at="x", up="bottom", colour=colour, bold=pitch)
    return panel


def hot_state(data: Dataset) -> Dataset:
    """The last state, which is the hot one; ``data`` itself if it has none."""
    return data.isel(state=-1) if "state" in data.dims else data


def distinct(curves: Sequence[Floats]) -> bool:
    """Whether the curves differ by more than rounding."""
    first = curves[0]
    scale = float(np.nanmax(np.abs(first))) if np.isfinite(first).any() else 1.0
    return any(
        not np.allclose(first, other, rtol=0.0, atol=1e-6 * scale, equal_nan=True)
        for other in curves[1:]
    )


def draw_by_operating(
    panel: Panel, data: Dataset, name: str, x: Floats, label: str = "", **look: Any
) -> None:
    """``name`` over ``x``, one curve per operating point; a single one where all agree.

    ``data`` has the dimension ``operating`` left beside the curve's own; a ``colour`` is that of
    the single one.
    """
    values = shown(data, name)
    places = chosen(values.shape[0])
    names = operating_names(data)
    alone = look.pop("colour", ramp(1)[0])
    if not distinct([values[i] for i in places]):
        if np.isfinite(values[0]).any():
            words = label or "all operating points"
            panel.curve(x, values[0], colour=alone, label=words, **look)
        return
    for i, own in zip(places, ramp(len(places)), strict=True):
        if np.isfinite(values[i]).any():
            words = plain(f"{label}, {names[i]}" if label else names[i])
            panel.curve(x, values[i], colour=own, label=words, **look)


def draw_by_bundle(
    panel: Panel, data: Dataset, name: str, x: Floats, *, colour: str, what: str = ""
) -> None:
    """``name`` over ``x`` at the first operating point, one line style per bundle.

    Over the mesh phase by :func:`draw_phase`.
    """
    bundles = names_of(data, "bundle")
    values = shown(data.isel(operating=0) if "operating" in data.dims else data, name)
    for place, bundle in enumerate(bundles):
        if np.isfinite(values[place]).any():
            words = plain(f"{what}, {bundle}" if what else bundle)
            dash = bundle_line(bundles, place)
            if "mesh_phase" in data[name].dims:
                draw_phase(panel, x, values=values[place], colour=colour, dash=dash, label=words)
            else:
                panel.curve(x, values[place], colour=colour, dash=dash, label=words)


def draw_by_both(
    panel: Panel, data: Dataset, name: str, x: Floats, *, thin: float = 1.7, **look: Any
) -> None:
    """``name`` over ``x``, the first axis left: points by colour, bundles by line style.

    ``thin`` is the width [pt] of every bundle but the first.
    """
    bundles, names = names_of(data, "bundle"), operating_names(data)
    places = chosen(data.sizes["operating"])
    for place, bundle in enumerate(bundles):
        values = shown(data.isel(bundle=place).transpose("operating", ...), name)
        for i, colour in zip(places, ramp(len(places)), strict=True):
            if np.isfinite(values[i]).any():
                panel.curve(
                    x, values[i], colour=colour, dash=bundle_line(bundles, place),
                    width=1.7 if place == 0 else thin, label=plain(f"{names[i]}, {bundle}"), **look,
                )  # fmt: skip
