"""Pictures of one orbit, of a Lyapunov exponent, of branches and of a cascade."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from thermogear.views.plots.orbits import refined
from thermogear.views.plots.parameters import axis_words, shown
from thermogear.views.plots.spectrum import draw_lines, floor_of, mark_half_orders
from thermogear.views.style import (
    COLD,
    HOT,
    INK,
    OKABE_ITO,
    QUIET,
    SINGLE,
    WIDE,
    legend_below,
    log_axis,
    picture,
)
from thermogear.views.words import plain

Floats = NDArray[np.float64]

HIGHEST_ORDER = 8.0
DASHED = (0, (4, 2))
DOTTED = (0, (1, 1.5))
MARKS = {
    "fold": ("s", "#D55E00"),
    "period doubling": ("o", "#0072B2"),
    "grazing": ("^", "#009E73"),
    "period halving": ("v", "#CC79A7"),
    "pitchfork": ("D", "#E69F00"),
}


def orbit_picture(data: xr.Dataset) -> Figure:
    """Time history, phase plane with section, Floquet multipliers and spectrum of one orbit."""
    si = data["displacement"].attrs.get("units") == "m"
    length, speed = (1e6, 1e3) if si else (1.0, 1.0)
    x_words, v_words = (
        ("displacement x [µm]", "velocity [mm/s]")
        if si
        else ("displacement X [–]", "velocity X′ [–]")
    )
    # the orbit closed, and smooth between its samples
    t, x, v = (
        np.append(data[name].values, first)
        for name, first in (
            ("time", 2.0 * data["time"].values[-1] - data["time"].values[-2]),
            ("displacement", data["displacement"].values[0]),
            ("velocity", data["velocity"].values[0]),
        )
    )
    t, x, v = refined(t, x=x, v=v, times=4)
    turns = t * float(data["orbit_period"]) / t[-1]
    x, v = x * length, v * speed
    figure, axes = picture(2, 2, (WIDE, 6.6), above=0.95, between=0.9)
    history, phase, unit, spectrum = axes.ravel()

    history.plot(turns, x, color=COLD, linewidth=1.3)
    history.set(title="One orbit", xlabel="time in mesh periods t/T [–]", ylabel=x_words)
    phase.plot(x, v, color=COLD, linewidth=1.3)
    phase.plot(
        data["section_displacement"].values * length,
        data["section_velocity"].values * speed,
        linestyle="none", marker="o", markersize=6.5, color=HOT, markeredgecolor="white",
    )  # fmt: skip
    phase.set(title="Phase plane, section at phase 0", xlabel=x_words, ylabel=v_words)
    for place in edges_in_sight(data):
        history.axhline(length * place, color=QUIET, linewidth=1.0, linestyle=DASHED)
        phase.axvline(length * place, color=QUIET, linewidth=1.0, linestyle=DASHED)
    _multipliers(unit, data["multiplier_real"].values, data["multiplier_imag"].values)
    _spectrum(spectrum, data, length, "µm" if si else "")
    return figure


def edges_in_sight(data: xr.Dataset) -> list[float]:
    """The edges of the backlash that lie on an orbit or near it."""
    x, edge = data["displacement"].values, float(data["half_backlash"])
    low, high = float(x.min()), float(x.max())
    room = 0.15 * (high - low)
    return [place for place in (edge, -edge) if low - room <= place <= high + room]


def _multipliers(axes: Axes, real: Floats, imag: Floats) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    axes.plot(np.cos(angle), np.sin(angle), color=QUIET, linewidth=1.0)
    outside = np.hypot(real, imag) > 1.0
    for keep, colour in ((~outside, COLD), (outside, HOT)):
        axes.plot(real[keep], imag[keep], linestyle="none", marker="o", markersize=7, color=colour)
    axes.set(title="Floquet multipliers", xlabel="real part [–]", ylabel="imaginary part [–]")
    axes.set_aspect("equal", adjustable="datalim")


def _spectrum(axes: Axes, data: xr.Dataset, length: float, unit: str) -> None:
    order, amplitude = data["order"].values, data["line_amplitude"].values * length
    floor, top = floor_of(amplitude, order=order, highest=HIGHEST_ORDER)
    draw_lines(
        axes,
        order=order,
        amplitude=amplitude,
        colour=COLD,
        floor=floor,
        highest=HIGHEST_ORDER,
        label="",
    )
    log_axis(axes)
    axes.set_ylim(floor, top)
    mark_half_orders(axes, HIGHEST_ORDER)
    axes.set(
        title="Spectrum, half orders dotted",
        xlabel="order of the mesh frequency [–]",
        ylabel=f"amplitude [{unit}]" if unit else "amplitude [–]",
    )
    if "line_frequency" in data:
        mesh = float(data["line_frequency"].values[-1] / order[-1])
        above = axes.secondary_xaxis(
            "top", functions=(lambda q: np.multiply(q, mesh), lambda f: np.divide(f, mesh))
        )
        above.set_xlabel("frequency f [Hz]")
        axes.set_title("")


def lyapunov_picture(data: xr.Dataset) -> Figure:
    """Batch means and the running mean with its standard error."""
    values = data["lyapunov_batch"].values
    count = np.arange(1, values.size + 1)
    mean = np.cumsum(values) / count
    error = np.array(
        [values[:n].std(ddof=1) / np.sqrt(n) if n > 1 else np.nan for n in count.tolist()]
    )
    figure, axes = picture(1, 1, SINGLE)
    (only,) = axes.ravel()
    only.axhline(0.0, color=QUIET, linewidth=1.0)
    only.plot(count, values, linestyle="none", marker=".", color=QUIET, label="batch means")
    only.fill_between(count, mean - error, mean + error, color=COLD, alpha=0.25, linewidth=0.0)
    only.plot(count, mean, color=COLD, label="mean so far, one standard error")
    only.set(xlabel="batches", ylabel="largest Lyapunov exponent λ₁")
    legend_below(figure, only, 2)
    return figure


def branch_picture(branches: Sequence[xr.Dataset], title: str = "") -> Figure:
    """Displacement at phase 0 along the parameter: stable solid, unstable dotted."""
    figure, axes = picture(1, 1, (WIDE, 4.0))
    (only,) = axes.ravel()
    parameter = str(branches[0].attrs["parameter"])
    for data in branches:
        period = int(data.attrs["period"])
        colour = OKABE_ITO[min(int(np.log2(period)), len(OKABE_ITO) - 1)]
        draw_branch(only, data, parameter, colour, f"period {period}")
    _marks(only, branches, parameter)
    only.set(
        xlabel=axis_words(parameter), ylabel="displacement X at phase 0 [–]", title=plain(title)
    )
    legend_below(figure, only, 4)
    return figure


def draw_branch(axes: Axes, data: xr.Dataset, parameter: str, colour: str, label: str) -> None:
    """One branch, cut at the located bifurcations where its stability changes."""
    value = shown(parameter, data["value"].values)
    events = shown(parameter, data["event_value"].values)
    x, stable = data["section_x"].values, data["stable"].values.astype(bool)
    cuts = [0, *(np.flatnonzero(np.diff(stable.astype(int))) + 1).tolist(), value.size]
    for first, last in pairwise(cuts):
        along, up = value[first:last].tolist(), x[first:last].tolist()
        for cut, place in ((first, 0), (last, None)):
            if 0 < cut < value.size:
                end = _between(events, value[cut - 1], value[cut])
                at = (
                    (events[end], float(data["event_x"].values[end]))
                    if end is not None
                    else ((value[cut - 1], x[cut - 1]) if place == 0 else (value[cut], x[cut]))
                )
                along.insert(0 if place == 0 else len(along), float(at[0]))
                up.insert(0 if place == 0 else len(up), float(at[1]))
        firm = bool(stable[first])
        axes.plot(
            along, up, color=colour, linewidth=1.6 if firm else 1.1,
            linestyle="-" if firm else DOTTED, label=f"{label}{'' if firm else ', unstable'}",
        )  # fmt: skip


def _between(events: Floats, one: float, other: float) -> int | None:
    """The event that lies between two neighbouring points, if one does."""
    low, high = min(one, other), max(one, other)
    inside = np.flatnonzero((events >= low) & (events <= high))
    return int(inside[-1]) if inside.size else None


def _marks(axes: Axes, branches: Sequence[xr.Dataset], parameter: str) -> None:
    for kind, (marker, colour) in MARKS.items():
        for data in branches:
            here = data["event_kind"].values.astype(str) == kind
            if here.any():
                axes.plot(
                    shown(parameter, data["event_value"].values[here]),
                    data["event_x"].values[here],
                    linestyle="none", marker=marker, markersize=5.5, color=colour,
                    markeredgecolor="white", markeredgewidth=0.6, label=kind,
                )  # fmt: skip


def cascade_picture(branches: Sequence[xr.Dataset]) -> Figure:
    """One axis for each row: the doubling branches, one colour for each state of heat."""
    rows = list(dict.fromkeys(str(b.attrs["row"]) for b in branches))
    heats = list(dict.fromkeys(str(b.attrs["heat"]) for b in branches))
    figure, axes = picture(1, len(rows), (WIDE, 3.6), between=0.62)
    for axis, row in zip(axes.ravel(), rows, strict=True):
        own = [b for b in branches if str(b.attrs["row"]) == row]
        parameter = str(own[0].attrs["parameter"])
        for data in own:
            place = heats.index(str(data.attrs["heat"]))
            colour = INK if place == 0 else OKABE_ITO[place % len(OKABE_ITO)]
            if place == 0:
                colour = COLD
            axis.plot(
                shown(parameter, data["value"].values), data["section_x"].values,
                color=colour, linewidth=1.2, label=plain(heats[place]),
            )  # fmt: skip
            flips = data["event_kind"].values.astype(str) == "period doubling"
            axis.plot(
                shown(parameter, data["event_value"].values[flips]),
                data["event_x"].values[flips],
                linestyle="none", marker="o", markersize=4.5, color=colour,
                markeredgecolor="white", markeredgewidth=0.5,
            )  # fmt: skip
        axis.set_xlabel(axis_words(parameter))
    axes.ravel()[0].set_ylabel("displacement X at phase 0 [–]")
    legend_below(figure, list(axes.ravel()), 3)
    return figure
