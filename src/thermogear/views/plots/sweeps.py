"""Pictures of diagrams, maps, basins, sweeps and run-ups, from their stored datasets."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from thermogear.base.units import ZERO_CELSIUS
from thermogear.views.plots.parameters import axis_words, shown
from thermogear.views.style import (
    COLD,
    FAINT,
    HOT,
    INK,
    OKABE_ITO,
    QUIET,
    WIDE,
    legend_below,
    picture,
)

Floats = NDArray[np.float64]

CLASSES = (
    ("period 1", "#0072B2"),
    ("period 2", "#56B4E9"),
    ("period 3", "#009E73"),
    ("period 4", "#B3DE69"),
    ("period 5", "#CC79A7"),
    ("period 6", "#F0E442"),
    ("period 7, 8", "#E69F00"),
    ("longer", "#8a5a2b"),
    ("chaotic, estimate", "#D55E00"),
    ("undecided", "#999999"),
    ("diverged", "#22303c"),
    ("jammed", "#ffffff"),
)
KINDS = ("fold", "period doubling", "grazing", "period halving", "pitchfork")
MARKS = ("s", "D", "|", "d", "P")


def classes_of(data: xr.Dataset) -> NDArray[np.int64]:
    """Numbers into :data:`CLASSES` from stored label and period."""
    label, period = data["label"].values, data["period"].values
    found = np.full(label.shape, 9, np.int64)
    periodic = label == 1
    found[periodic] = np.clip(period[periodic], 1, 6) - 1
    found[periodic & ((period == 7) | (period == 8))] = 6
    found[periodic & (period > 8)] = 7
    found[label == 2] = 8
    found[label == 3] = 10
    found[label == 4] = 11
    return found


def _edges(values: Floats) -> Floats:
    """Cell borders about sample places."""
    if values.size == 1:
        half = 0.5 * max(abs(float(values[0])), 1.0) * 1e-3
        return np.array([values[0] - half, values[0] + half])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate(
        [[values[0] - (middle[0] - values[0])], middle, [2 * values[-1] - middle[-1]]]
    )


def _dot(values: Floats) -> str:
    """The marker of a line: a line of one value would not be seen."""
    return "o" if values.size == 1 else ""


def _parameter(data: xr.Dataset) -> str:
    return str(data.attrs["parameter"])


def orbit_diagram_picture(data: xr.Dataset) -> Figure:
    """Sections over the parameter, up and down, with branches and bifurcations; exponent below."""
    name = _parameter(data)
    p = shown(name, data[name].values)
    figure, axes = picture(
        2, 1, (WIDE, 6.0), sharex=True, above=0.15, gridspec_kw={"height_ratios": (3, 1)}
    )
    top, low = axes[0, 0], axes[1, 0]
    colours = (COLD, HOT)
    for direction, (colour, word) in enumerate(zip(colours, ("up", "down"), strict=True)):
        x = data["section_x"].values[direction]
        places = np.broadcast_to(p[None, :, None], x.shape)
        top.plot(
            places.ravel(),
            x.ravel(),
            linestyle="none",
            marker=".",
            markersize=1.6 if p.size > 1 else 8.0,
            markeredgewidth=0.0,
            color=colour,
            alpha=0.8,
            rasterized=True,
            zorder=2,
        )
        top.plot([], [], ".", color=colour, label=word)
        exponent = data["lyapunov"].values[direction]
        for row in exponent:
            low.plot(p, row, color=colour, linewidth=0.8, marker=_dot(p))
    _branches(top, data, name)
    low.axhline(0.0, color=INK, linewidth=0.8)
    top.set_ylabel("X at phase 0 [–]")
    low.set_ylabel("exponent λ₁ [–]")
    low.set_xlabel(axis_words(name))
    legend_below(figure, top, 6)
    return figure


def _branches(axes: Axes, data: xr.Dataset, name: str, column: str = "branch_x") -> None:
    if "branch_value" not in data:
        return
    value, x = shown(name, data["branch_value"].values), data[column].values
    stable = data["branch_multiplier"].values < 1.0
    for row in range(value.shape[0]):
        axes.plot(
            np.where(stable[row], value[row], np.nan), x[row], color=INK, linewidth=0.7, zorder=3
        )
        axes.plot(
            np.where(~stable[row], value[row], np.nan),
            x[row],
            color=QUIET,
            linewidth=0.7,
            linestyle=(0, (4, 2)),
            zorder=3,
        )
    known = np.isfinite(value)
    if (stable & known).any():
        axes.plot([], [], color=INK, linewidth=0.9, label="stable branch")
    if (~stable & known).any():
        line = (0, (4, 2))
        axes.plot([], [], color=QUIET, linewidth=0.9, linestyle=line, label="unstable branch")
    at = shown(name, data["bifurcation_value"].values)
    kinds = data["bifurcation_kind"].values
    for kind in (0, 1, 4):
        chosen = kinds == kind
        if chosen.any():
            axes.plot(
                at[chosen],
                data["bifurcation_x"].values[chosen],
                MARKS[kind],
                color=OKABE_ITO[3],
                markersize=4,
                label=KINDS[kind],
                zorder=4,
            )


def map_picture(data: xr.Dataset) -> Figure:
    """The regime over two parameters."""
    one, two = data["label"].dims[:2]
    figure, axes = picture(size=(WIDE, 6.4))
    _regimes(axes[0, 0], data, str(one), str(two), figure)
    return figure


def _regimes(axes: Axes, data: xr.Dataset, one: str, two: str, figure: Figure) -> None:
    code = classes_of(data)
    colours = ListedColormap([c for _, c in CLASSES])
    axes.pcolormesh(
        _edges(shown(one, data[one].values)),
        _edges(shown(two, data[two].values)),
        code.T,
        cmap=colours,
        norm=BoundaryNorm(np.arange(len(CLASSES) + 1) - 0.5, len(CLASSES)),
        rasterized=True,
    )
    axes.grid(visible=False)
    axes.set_xlabel(axis_words(one))
    axes.set_ylabel(axis_words(two))
    present = np.unique(code)
    for n in present:
        axes.plot([], [], "s", color=CLASSES[n][1], markeredgecolor=QUIET, label=CLASSES[n][0])
    legend_below(figure, axes, 6)


def basins_picture(data: xr.Dataset) -> Figure:
    """Which attractor each start ends on, with the attractors' sections."""
    figure, axes = picture(size=(7.4, 7.4))
    count = data.sizes["attractor_number"]
    colours = [mpl.colors.to_hex(mpl.colormaps["tab20"](n % 20)) for n in range(count)]
    table = ListedColormap(["#22303c", "#bbbbbb", *colours])
    axes[0, 0].pcolormesh(
        _edges(data["x"].values),
        _edges(data["v"].values),
        data["attractor"].values.T,
        cmap=table,
        norm=BoundaryNorm(np.arange(-2.5, count + 0.5), count + 2),
        rasterized=True,
    )
    for n in range(count):
        x, v = data["attractor_x"].values[n], data["attractor_v"].values[n]
        axes[0, 0].plot(
            x, v, "o", color=colours[n], markeredgecolor="white", markersize=5, zorder=3
        )
        period = int(data["attractor_period"].values[n])
        kind = f"period {period}" if period else "chaotic, estimate"
        share = 100.0 * float(data["fraction"].values[n])
        axes[0, 0].plot([], [], "o", color=colours[n], label=f"{kind}: {share:.3g} %")
    axes[0, 0].grid(visible=False)
    axes[0, 0].set_xlabel("displacement X at phase 0 [–]")
    axes[0, 0].set_ylabel("velocity X′ at phase 0 [–]")
    axes[0, 0].set_xlim(_edges(data["x"].values)[[0, -1]])
    axes[0, 0].set_ylim(_edges(data["v"].values)[[0, -1]])
    legend_below(figure, axes[0, 0], 4)
    return figure


def _state_words(data: xr.Dataset, state: int) -> str:
    return f"{float(data['gear_temperature'].values[state]) - ZERO_CELSIUS:.4g} °C"


def run_up_picture(data: xr.Dataset) -> Figure:
    """Transmission error, mesh force and dynamic factor over speed, up and down, by state."""
    rows = (
        ("dte_peak_to_peak", "transmission error, p-p [µm]", 1e6),
        ("mesh_force_max", "greatest mesh force [kN]", 1e-3),
        ("dynamic_factor", "dynamic factor $K_{v}$ [–]", 1.0),
    )
    figure, axes = picture(3, 1, (WIDE, 8.0), above=0.15, sharex=True)
    n = shown("pinion_speed", data["pinion_speed"].values)
    count = data.sizes["state"]
    colours = [COLD, HOT, *OKABE_ITO[2:]][:count]
    for place, (name, label, factor) in enumerate(rows):
        ax = axes[place, 0]
        for state in range(count):
            for direction in range(2):
                ax.plot(
                    n,
                    factor * data[name].values[state, direction],
                    color=colours[state % len(colours)],
                    linestyle="-" if direction == 0 else (0, (3, 2)),
                    linewidth=1.2,
                    marker=_dot(n),
                    label=f"{_state_words(data, state)} {'up' if direction == 0 else 'down'}",
                )
            if "bifurcation_kind" in data:
                fold = (data["bifurcation_kind"].values == 0) & (
                    data["bifurcation_state"].values == state
                )
                for value in shown("pinion_speed", data["bifurcation_value"].values[fold]):
                    ax.axvline(value, color=colours[state % len(colours)], linewidth=0.7, alpha=0.6)
        ax.set_ylabel(label)
    axes[2, 0].set_xlabel(axis_words("pinion_speed"))
    legend_below(figure, axes[0, 0], 4)
    return figure


def waterfall_picture(data: xr.Dataset) -> Figure:
    """Lines of the transmission error over speed and order, running up, one panel a state."""
    count = data.sizes["state"]
    figure, axes = picture(1, count, (WIDE, 4.2), sharey=True)
    n = shown("pinion_speed", data["pinion_speed"].values)
    lines = 1e6 * data["dte_line"].values[:, 0]
    known = lines[np.isfinite(lines) & (lines > 0.0)]
    top = float(known.max()) if known.size else 1.0
    mesh = None
    for state in range(count):
        ax = axes[0, state]
        mesh = ax.pcolormesh(
            _edges(n),
            _edges(data["order"].values),
            np.clip(np.nan_to_num(lines[state], nan=1e-4 * top), 1e-4 * top, None).T,
            norm=LogNorm(1e-4 * top, top),
            cmap="magma",
            rasterized=True,
        )
        ax.grid(visible=False)
        ax.set_title(_state_words(data, state))
        ax.set_xlabel(axis_words("pinion_speed"))
    axes[0, 0].set_ylabel("order of the mesh frequency [–]")
    if mesh is not None:
        figure.colorbar(mesh, ax=list(axes[0]), label="line of the transmission error [µm]")
    return figure


def sweep_picture(data: xr.Dataset) -> Figure:
    """Dynamic factor and regime over the first one or two axes of a sweep."""
    dims = [str(d) for d in data["label"].dims]
    here = data.isel(dict.fromkeys(dims[2:], 0))
    if len(dims) == 1:
        figure, axes = picture(2, 1, (WIDE, 5.4), above=0.15, sharex=True)
        p = shown(dims[0], here[dims[0]].values)
        axes[0, 0].plot(p, 1e6 * here["dte_peak_to_peak"].values, color=COLD, marker=_dot(p))
        axes[0, 0].set_ylabel("transmission error, p-p [µm]")
        axes[1, 0].plot(p, here["dynamic_factor"].values, color=COLD, marker=_dot(p))
        axes[1, 0].set_ylabel("dynamic factor $K_{v}$ [–]")
        axes[1, 0].set_xlabel(axis_words(dims[0]))
        return figure
    figure, axes = picture(1, 2, (WIDE, 4.6))
    _regimes(axes[0, 0], here, dims[0], dims[1], figure)
    mesh = axes[0, 1].pcolormesh(
        _edges(shown(dims[0], here[dims[0]].values)),
        _edges(shown(dims[1], here[dims[1]].values)),
        here["dynamic_factor"].values.T,
        cmap="viridis",
        rasterized=True,
    )
    axes[0, 1].set_facecolor(FAINT)
    axes[0, 1].grid(visible=False)
    axes[0, 1].set_xlabel(axis_words(dims[0]))
    figure.colorbar(mesh, ax=axes[0, 1], label="dynamic factor $K_{v}$ [–]")
    return figure
