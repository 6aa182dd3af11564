"""Pictures of one orbit, of a Lyapunov exponent, and of branches."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import MICROMETRE, MILLIMETRE_PER_SECOND, Display
from thermogear.base.vocabulary import of_turn
from thermogear.views.picture import Axis, Panel, Picture, Top
from thermogear.views.plots.curves import draw_phase
from thermogear.views.plots.motion import refined
from thermogear.views.plots.parameters import axis_words, shown
from thermogear.views.plots.spectrum import (
    MESH_ORDERS,
    SHAFT_ORDERS,
    draw_lines,
    floor_of,
    over_orders,
    shaft_orders,
)
from thermogear.views.style import COLD, HOT, OKABE_ITO, QUIET, WIDE
from thermogear.views.typesetting import plain

HIGHEST_ORDER = 8.0
LOOPS = 4
"""Mesh periods of a turn whose phase plane is drawn."""
DASHED = (4, 2)
DOTTED = (1, 1.5)
MARKS = {
    "fold": ("square", "#D55E00"),
    "period doubling": ("circle", "#0072B2"),
    "grazing": ("up", "#009E73"),
    "period halving": ("down", "#CC79A7"),
    "pitchfork": ("diamond", "#E69F00"),
    "torus": ("cross", "#56B4E9"),
}


def orbit_picture(data: Dataset) -> Picture:
    """Time history, phase plane with section, Floquet multipliers and spectrum of one orbit."""
    si = data["displacement"].attrs.get("units") == "m"
    length, speed = (MICROMETRE, MILLIMETRE_PER_SECOND) if si else (Display("–"), Display("–"))
    x_words, v_words = (
        ("displacement x [µm]", "velocity [mm/s]")
        if si
        else ("displacement X [–]", "velocity X′ [–]")
    )
    of, period = int(data.attrs.get("mesh_periods", 1)), float(data["orbit_period"])
    # the orbit closed, and smooth between its samples
    t, x, v = (
        np.append(data[name].values, first)
        for name, first in (
            ("time", 2.0 * data["time"].values[-1] - data["time"].values[-2]),
            ("displacement", data["displacement"].values[0]),
            ("velocity", data["velocity"].values[0]),
        )
    )
    loop = slice(None if of == 1 else 1 + LOOPS * round(x.size / (period * of)))
    along, whole = t * period * of / t[-1], length(x)
    t, x, v = refined(t[loop], x=x[loop], v=v[loop], times=4)
    x, v = length(x), speed(v)
    history = Panel(Axis("time in mesh periods t/T [–]"), Axis(x_words), "One orbit")
    phase = Panel(Axis(x_words), Axis(v_words), "Phase plane, section at phase 0")
    if of == 1:
        history.curve(t * period / t[-1], x, colour=COLD, width=1.3)
    else:
        draw_phase(history, along[:-1], values=whole[:-1], colour=COLD, width=0.8)
    phase.curve(x, v, colour=COLD, width=1.3)
    phase.points(
        length(data["section_displacement"].values), speed(data["section_velocity"].values),
        size=6.5, colour=HOT, edge="white",
    )  # fmt: skip
    for place in edges_in_sight(data):
        history.line(y=length(place), colour=QUIET, width=1.0, dash=DASHED)
        phase.line(x=length(place), colour=QUIET, width=1.0, dash=DASHED)
    unit = _multipliers(data["multiplier_real"].values, data["multiplier_imag"].values)
    spectrum = _spectrum(data, length)
    rows, high = [[history, phase], [unit, spectrum]], 6.6
    if "teeth" in data.attrs:
        mesh = ("order of the mesh frequency [–]", 1.0)
        near = (_lines(data, length, *mesh, MESH_ORDERS),
                _lines(data, length, *shaft_orders(data), SHAFT_ORDERS))  # fmt: skip
        rows, high = [*rows, [*near]], 9.6
    return Picture(rows, size=(WIDE, high), above=0.95, between=0.9)


def _lines(data: Dataset, length: Display, words: str, factor: float, highest: float) -> Panel:
    """Lines of a turn up to the ``highest`` order, of which one of the mesh is ``factor``."""
    order, amplitude = data["order"].values, length(data["line_amplitude"].values)
    floor, top = floor_of(amplitude, order=order, highest=HIGHEST_ORDER)
    y = Axis(f"amplitude [{length.unit}]", low=floor, high=top, log="decades")
    panel = Panel(Axis(words, low=0.0, high=highest), y)
    near = order * factor <= highest
    draw_lines(panel, order=order[near] * factor, amplitude=amplitude[near], colour=COLD, label="")
    return panel


def edges_in_sight(data: Dataset) -> list[float]:
    """The edges of the backlash that lie on an orbit or near it."""
    x, edge = data["displacement"].values, float(data["half_backlash"])
    low, high = float(x.min()), float(x.max())
    room = 0.15 * (high - low)
    return [place for place in (edge, -edge) if low - room <= place <= high + room]


def _multipliers(real: Floats, imag: Floats) -> Panel:
    panel = Panel(
        Axis("real part [–]"), Axis("imaginary part [–]"), "Floquet multipliers", equal=True
    )
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    panel.curve(np.cos(angle), np.sin(angle), colour=QUIET, width=1.0)
    outside = np.hypot(real, imag) > 1.0
    for keep, colour in ((~outside, COLD), (outside, HOT)):
        panel.points(real[keep], imag[keep], size=7, colour=colour)
    return panel


def _spectrum(data: Dataset, length: Display) -> Panel:
    order, amplitude = data["order"].values, length(data["line_amplitude"].values)
    floor, top = floor_of(amplitude, order=order, highest=HIGHEST_ORDER)
    panel = over_orders(
        "order of the mesh frequency [–]", f"amplitude [{length.unit}]", floor=floor, top=top,
        highest=HIGHEST_ORDER,
    )  # fmt: skip
    draw_lines(panel, order=order, amplitude=amplitude, colour=COLD, label="")
    if "line_frequency" in data:
        mesh = float(data["line_frequency"].values[-1] / order[-1])
        panel.top = Top("frequency f [Hz]", mesh)
    else:
        panel.title = "Spectrum, half orders dotted"
    return panel


def lyapunov_picture(data: Dataset) -> Picture:
    """Batch means and the running mean with its standard error."""
    values = data["lyapunov_batch"].values
    count = np.arange(1, values.size + 1)
    mean = np.cumsum(values) / count
    error = np.array(
        [values[:n].std(ddof=1) / np.sqrt(n) if n > 1 else np.nan for n in count.tolist()]
    )
    panel = Panel(Axis("batches [–]"), Axis("largest Lyapunov exponent λ₁ [–]"))
    panel.line(y=0.0, colour=QUIET, width=1.0)
    panel.points(count, values, marker="dot", colour=QUIET, label="batch means")
    panel.band(count, low=mean - error, high=mean + error, colour=COLD, opacity=0.25)
    panel.curve(count, mean, colour=COLD, label="mean so far, one standard error")
    return Picture([[panel]], legend=2)


def branch_picture(branches: Sequence[Dataset], title: str = "") -> Picture:
    """Displacement at phase 0 along the parameter: stable solid, unstable dotted."""
    parameter = str(branches[0].attrs["parameter"])
    train = "mesh_force" in branches[0]
    words = "greatest mesh force [N]" if train else "displacement X at phase 0 [–]"
    panel = Panel(Axis(axis_words(parameter, branches[0]["value"])), Axis(words), plain(title))
    rows = ("mesh_force", "event_mesh_force") if train else ("section_x", "event_x")
    for data in branches:
        period = int(data.attrs["period"])
        colour = OKABE_ITO[min(int(np.log2(period)), len(OKABE_ITO) - 1)]
        words = f"period {period}{of_turn(data.attrs.get('mesh_periods', 1))}"
        draw_branch(panel, data, parameter, colour, words, rows)
    _marks(panel, branches, parameter, rows[1])
    if not train:
        return Picture([[panel]], size=(WIDE, 4.0), legend=4)
    return Picture([[panel], [_sizes(branches, parameter)]], size=(WIDE, 6.2), legend=4)


def _sizes(branches: Sequence[Dataset], parameter: str) -> Panel:
    """The largest multiplier of every orbit, stable below 1."""
    panel = Panel(
        Axis(axis_words(parameter, branches[0]["value"])),
        Axis("largest Floquet multiplier, modulus [–]"),
    )
    panel.line(y=1.0, colour=QUIET, width=1.0, dash=DASHED)
    for data in branches:
        period = int(data.attrs["period"])
        colour = OKABE_ITO[min(int(np.log2(period)), len(OKABE_ITO) - 1)]
        size = np.hypot(data["multiplier_real"].values, data["multiplier_imag"].values)
        panel.curve(shown(parameter, data["value"]), size.max(axis=1), colour=colour, width=1.3)
    return panel


def draw_branch(
    panel: Panel,
    data: Dataset,
    parameter: str,
    colour: str,
    label: str,
    rows: tuple[str, str] = ("section_x", "event_x"),
) -> None:
    """One branch, cut at the located bifurcations where its stability changes.

    ``rows``: what is drawn of its points, and of its bifurcations.
    """
    value = shown(parameter, data["value"])
    events = shown(parameter, data["event_value"])
    x, stable = data[rows[0]].values, data["stable"].values.astype(bool)
    cuts = [0, *(np.flatnonzero(np.diff(stable.astype(int))) + 1).tolist(), value.size]
    for first, last in pairwise(cuts):
        along, up = value[first:last].tolist(), x[first:last].tolist()
        for cut, place in ((first, 0), (last, None)):
            if 0 < cut < value.size:
                end = _between(events, value[cut - 1], value[cut])
                at = (
                    (events[end], float(data[rows[1]].values[end]))
                    if end is not None
                    else ((value[cut - 1], x[cut - 1]) if place == 0 else (value[cut], x[cut]))
                )
                along.insert(0 if place == 0 else len(along), float(at[0]))
                up.insert(0 if place == 0 else len(up), float(at[1]))
        if stable[first]:
            panel.curve(along, up, colour=colour, width=1.6, label=label)
        else:
            words = f"{label}, unstable"
            panel.curve(along, up, colour=colour, width=1.1, dash=DOTTED, label=words)


def _between(events: Floats, one: float, other: float) -> int | None:
    """The event that lies between two neighbouring points, if one does."""
    low, high = min(one, other), max(one, other)
    inside = np.flatnonzero((events >= low) & (events <= high))
    return int(inside[-1]) if inside.size else None


def _marks(panel: Panel, branches: Sequence[Dataset], parameter: str, row: str = "event_x") -> None:
    for kind, (marker, colour) in MARKS.items():
        for data in branches:
            here = data["event_kind"].values.astype(str) == kind
            if here.any():
                at = shown(parameter, data["event_value"][here])
                panel.points(
                    at, data[row].values[here], marker=marker, size=5.5, colour=colour,
                    edge="white", edge_width=0.6, label=kind,
                )  # fmt: skip


def event_words(kind: str, contact: str) -> str:
    """A kind of bifurcation, of a grazing with what touches."""
    return f"{kind} of {contact}" if contact else kind


def plane_picture(curves: Sequence[Dataset]) -> Picture:
    """Every curve over both parameters: solid where a stable motion meets it, else dotted."""
    first, second = str(curves[0].attrs["first"]), str(curves[0].attrs["second"])
    panel = Panel(
        Axis(axis_words(first, curves[0]["first"])), Axis(axis_words(second, curves[0]["second"]))
    )
    for data in curves:
        kind = str(data.attrs["kind"])
        marker, colour = MARKS[kind]
        turn = of_turn(data.attrs.get("mesh_periods", 1))
        name = event_words(kind, str(data.attrs.get("contact", "")))
        label = f"{name}, period {int(data.attrs['period'])}{turn}"
        x, y = shown(first, data["first"]), shown(second, data["second"])
        met = data["stable"].values.astype(bool)
        cuts = [0, *(np.flatnonzero(np.diff(met.astype(int))) + 1).tolist(), met.size]
        for low, high in pairwise(cuts):
            end = min(high + 1, met.size)
            if met[low]:
                panel.curve(x[low:end], y[low:end], colour=colour, width=1.6, label=label)
            else:
                panel.curve(
                    x[low:end], y[low:end], colour=colour, width=1.1, dash=DOTTED,
                    label=f"{label}, no motion meets it",
                )  # fmt: skip
        asked = data["asked"].values.astype(bool)
        panel.points(
            x[asked], y[asked], marker=marker, size=4.5, colour=colour, edge="white",
            edge_width=0.5,
        )  # fmt: skip
    return Picture([[panel]], size=(WIDE, 4.4), legend=3)
