"""What several pictures share: one curve for each operating point, bundle and state."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from thermogear.views.style import bundle_line, chosen, names_of, ramp
from thermogear.views.words import operating_names, plain, shown

Floats = NDArray[np.float64]


def hot_state(data: xr.Dataset) -> xr.Dataset:
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
    axes: Axes, data: xr.Dataset, name: str, x: Floats, colour: str | None = None, **line: Any
) -> None:
    """``name`` over ``x``, one curve per operating point; a single one where all agree.

    ``data`` has the dimension ``operating`` left beside the curve's own.
    """
    values = shown(data, name)
    places = chosen(values.shape[0])
    names = operating_names(data)
    prefix = line.pop("label", "")
    if not distinct([values[i] for i in places]):
        if np.isfinite(values[0]).any():
            axes.plot(
                x,
                values[0],
                color=colour or ramp(1)[0],
                label=prefix or "all operating points",
                **line,
            )
        return
    for i, own in zip(places, ramp(len(places)), strict=True):
        if np.isfinite(values[i]).any():
            text = f"{prefix}, {names[i]}" if prefix else names[i]
            axes.plot(x, values[i], color=own, label=plain(text), **line)


def draw_by_bundle(
    axes: Axes, data: xr.Dataset, name: str, x: Floats, colour: str, what: str = "", **line: Any
) -> None:
    """``name`` over ``x`` at the first operating point, one line style per bundle."""
    bundles = names_of(data, "bundle")
    values = shown(data.isel(operating=0) if "operating" in data.dims else data, name)
    for place, bundle in enumerate(bundles):
        if np.isfinite(values[place]).any():
            axes.plot(
                x,
                values[place],
                color=colour,
                linestyle=bundle_line(bundles, place),
                label=plain(f"{what}, {bundle}" if what else bundle),
                **line,
            )
