"""Pictures of a whole turn of gears whose teeth differ: its error, its orders, its teeth."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MEGAPASCAL, MICROMETRE
from thermogear.base.period import Period
from thermogear.views.picture import Axis, Panel, Picture, Top
from thermogear.views.plots.curves import MOST_POINTS, draw_phase, shows_course
from thermogear.views.plots.spectrum import draw_lines, floor_of
from thermogear.views.style import COLD, HOT, INK, OKABE_ITO, QUIET, WIDE

TICKS = 14
NAMED_LINES = 7
KINDS = {"mesh": INK, "pinion": HOT, "wheel": COLD, "other": OKABE_ITO[2]}
"""Kinds of lines of a turn and their colours; others lie beside the mesh, or are of the hunting
tooth."""


def period_of(data: Dataset) -> Period:
    """The period that the group was computed over."""
    pinion, wheel = (int(z) for z in data.attrs["teeth"])
    return Period(int(data.attrs["mesh_periods"]), (pinion, wheel))


def tooth_axis(data: Dataset, low: int, high: int) -> Axis:
    """Mesh phases from ``low`` to ``high``, named by the teeth that enter: pinion/wheel."""
    (z1, z2), (first, second) = (np.array(data.attrs[name], int) for name in ("teeth", "first"))
    least = -(-(high - low) // TICKS)
    # whole turns of the pinion where many teeth pass
    step = least if least < z1 else int(z1) * -(-least // int(z1))
    places = np.arange(low, high, step)
    names = [f"{(n + first - 1) % z1 + 1}/{(n + second - 1) % z2 + 1}" for n in places]
    return Axis(
        "teeth that enter contact, pinion/wheel [–]",
        low=low, high=high, ticks=places, names=names, slant=30.0 if len(names[-1]) > 4 else 0.0,
    )  # fmt: skip


def error_of_turn(data: Dataset) -> Picture:
    """The error over the turn, with and without load; below it the stretch where it swings most."""
    phase, of = data["mesh_phase"].values, int(data.attrs["mesh_periods"])
    curves = [(MICROMETRE(data[name].values), colour, words) for name, colour, words in (
        ("transmission_error", HOT, "under load"), ("unloaded_error", COLD, "without load"),
    )]  # fmt: skip
    words = "transmission error δ [µm]"
    whole = Panel(tooth_axis(data, 0, of), Axis(words), "Whole turn")
    whole.top = Top("mesh periods [–]", 1.0)
    # bands over each other cannot be told apart
    for values, colour, label in curves if shows_course(phase.size, of) else curves[:1]:
        draw_phase(whole, phase, values, colour=colour, label=label, width=1.2)
    shown = min(of, int(data.attrs["teeth"][0]))
    if shown == of:
        return Picture([[whole]], size=(WIDE, 3.4), legend=2, top=0.75)
    each = phase.size // of
    stretches = curves[0][0].reshape(of, each)[: of // shown * shown].reshape(of // shown, -1)
    start = int(np.argmax(np.ptp(stretches, axis=1))) * shown
    near = Panel(
        tooth_axis(data, start, start + shown), Axis(words),
        "Turn of the pinion in which it swings most",
    )  # fmt: skip
    whole.span(x=(start, start + shown), colour=QUIET, opacity=0.15)
    here = slice(start * each, (start + shown) * each)
    step = -(-shown * each // MOST_POINTS)
    for values, colour, label in curves:
        x, y = phase[here][::step], values[here][::step]
        near.curve(x, y, colour=colour, label=label, width=1.2)
    return Picture([[whole], [near]], size=(WIDE, 6.2), legend=2, top=0.75, above=1.0)


def kind_of(name: str) -> str:
    """The kind of the line with this ``name``, of :data:`KINDS`."""
    if "mesh" not in name:
        return next((gear for gear in ("pinion", "wheel") if gear in name), "other")
    return "other" if " + " in name or " − " in name else "mesh"


def orders_of_turn(data: Dataset) -> Picture:
    """Lines of the loaded error: those of the shafts, and of the mesh with its side lines."""
    period = period_of(data)
    order, amplitude = data["order"].values, MICROMETRE(data["line_amplitude"].values)
    names = np.array([period.line(round(q * period.mesh_periods)) for q in order])
    kinds = np.array([kind_of(str(name)) for name in names])
    floor, top = floor_of(amplitude, order=order, highest=4.0)
    floor *= 10.0
    panels = []
    shaft = 1.0 / max(period.teeth or (1,))
    for words, factor, high in (
        ("orders of the slower shaft [–]", 1.0 / shaft, 12.0), ("orders of the mesh [–]", 1.0, 3.4)
    ):  # fmt: skip
        panel = Panel(
            Axis(words, low=0.0, high=high),
            Axis("amplitude of the loaded error [µm]", low=floor, high=8.0 * top, log="decades"),
        )
        here = order * factor < high
        for kind, colour in KINDS.items():
            some = here & (kinds == kind)
            draw_lines(
                panel, order=order[some] * factor, amplitude=amplitude[some], colour=colour,
                label="" if panels else kind,
            )  # fmt: skip
        if panels:
            here &= order > 12.0 * shaft
        greatest = np.flatnonzero(here)[np.argsort(amplitude[here])[::-1][:NAMED_LINES]]
        taken: list[float] = []
        for n in greatest:
            at = float(order[n] * factor)
            if all(abs(at - other) > 0.12 * high for other in taken):
                taken.append(at)
                panel.text(at, amplitude[n], str(names[n]), offset=(0, 5), up="bottom", size=7.5)
        panels.append(panel)
    return Picture([panels], size=(WIDE, 3.8), legend=4)


def teeth_of_turn(data: Dataset) -> Picture:
    """Of every tooth of both gears: its place, and the greatest pressure on its flank."""
    rows = []
    for gear, colour in (("pinion", HOT), ("wheel", COLD)):
        here = data.isel(tooth=np.flatnonzero(data["gear"].values == gear))
        number = here["number"].values.astype(float)
        row = []
        for name, scale, words in (
            ("index_error", MICROMETRE, "index error, > 0 early [µm]"),
            ("contact_pressure", MEGAPASCAL, "greatest pressure [MPa]"),
        ):
            values = scale(here[name].values)
            ticks = number[:: -(-number.size // TICKS)]
            x = Axis(f"{gear} tooth [–]", low=0.0, high=number[-1] + 1.0, ticks=ticks)
            panel = Panel(x, Axis(words))
            if name == "index_error":
                panel.bars(number, values, width=0.8, colour=colour)
                panel.line(y=0.0, colour=INK, width=0.8)
            else:
                panel.points(number, values, colour=colour, size=4.0)
            row.append(panel)
        rows.append(row)
    return Picture(rows, size=(WIDE, 5.6), above=0.75, between=0.8)
