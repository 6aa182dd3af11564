"""What a page shows of a whole turn of gears whose teeth differ: its error, orders and teeth."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MEGAPASCAL, MICROMETRE, MILLIMETRE, PERCENT, number
from thermogear.base.period import line_names
from thermogear.results.tables import rows_along
from thermogear.views.columns import Column, declared, in_full, key
from thermogear.views.page import Shown, Table
from thermogear.views.picture import Axis, Panel, Picture, Top
from thermogear.views.plots.curves import draw_phase
from thermogear.views.plots.spectrum import draw_lines, floor_of
from thermogear.views.style import COLD, HOT, INK, OKABE_ITO, QUIET, WIDE

MOST_LINES = 16
"""Lines of a table, the greatest; all are stored."""
TICKS = 14
NAMED = 6
"""Lines named in a panel: the greatest in as many stretches."""
COLOURS = {"mesh": INK, "pinion": HOT, "wheel": COLD, "other": OKABE_ITO[2]}
"""Kinds of lines of a turn and their colours; others lie beside the mesh, or are of both shafts or
of the hunting tooth."""
LINES = (
    Column("line", "name", key="line"),
    Column("order of the mesh", "order", 4, key="order"),
    Column("under load", "line_amplitude", 3, MICROMETRE),
    Column("without load", "unloaded_line", 3, MICROMETRE),
    key("amplitude_m", "line_amplitude"),
    key("unloaded_amplitude_m", "unloaded_line"),
)
TEETH = (
    Column("gear", "gear", key="gear"),
    Column("tooth", "number", key="tooth"),
    Column("index error", "index_error", "+.2f", MICROMETRE),
    Column("load carried, of the mean", "load_carried", ".0f", PERCENT),
    Column("greatest share", "greatest_share", 3, PERCENT),
    Column("greatest pressure", "contact_pressure", 4, MEGAPASCAL),
    Column("at", "position", 4, MILLIMETRE),
    Column("against tooth", lambda row: int(row["mate"]) or None),
    key("index_error_m", "index_error"),
    key("load_carried"),
    key("greatest_share"),
    key("contact_pressure_Pa", "contact_pressure"),
    key("position_m", "position"),
    key("mate", lambda row: int(row["mate"]) or None),
)
SWINGS = ("transmission_error", "unloaded_error", "mesh_synchronous_error")


def lines(turn: Dataset) -> list[dict[str, Any]]:
    """All lines of the loaded error with their names, the greatest first."""
    names = line_names(turn.attrs, turn["order"].values)
    rows = zip(rows_along(turn, "order"), names, strict=True)
    named = [row | {"name": name} for row, name in rows]
    return sorted(named, key=lambda row: -float(row["line_amplitude"]))


def numbers(groups: Mapping[str, Dataset]) -> dict[str, Any]:
    """What JSON holds of the turn; nothing where the teeth of each gear are alike."""
    if "turn" not in groups:
        return {}
    turn = groups["turn"]
    found: dict[str, Any] = {
        "mesh_periods": int(turn.attrs["mesh_periods"]),
        "pinion_torque_Nm": float(turn.attrs["torque"]),
        **{f"{name}_peak_to_peak_m": float(np.ptp(turn[name].values)) for name in SWINGS},
        "lines": [in_full(LINES, row) for row in lines(turn)[:MOST_LINES]],
        "teeth": [in_full(TEETH, row) for row in rows_along(groups["teeth"], "tooth")],
    }
    return {"turn": found}


def _swings(turn: Dataset) -> str:
    loaded, unloaded, mesh = (number(MICROMETRE(np.ptp(turn[name].values))) for name in SWINGS)
    return (
        f"{loaded} µm peak to peak over the turn of {turn.attrs['mesh_periods']} mesh periods, hot "
        f"at {turn.attrs['torque']:.4g} N m; {unloaded} µm without load; {mesh} µm repeat in every "
        "mesh period"
    )


def pictures(groups: Mapping[str, Dataset]) -> list[Shown]:
    """The error of the turn, its orders and its teeth."""
    if "turn" not in groups:
        return []
    turn, teeth = groups["turn"], groups["teeth"]
    worst = teeth.isel(tooth=int(np.argmax(np.nan_to_num(teeth["contact_pressure"].values))))
    greatest = [
        f"{row['name']} {number(MICROMETRE(row['line_amplitude']))} µm" for row in lines(turn)[:5]
    ]
    made = {
        "turn": ("Transmission error over the turn", error_of_turn, turn,
                 f"{_swings(turn)}: these are heard as the mesh, the rest as shaft orders and side "
                 "lines. Teeth have their numbers in the case file. A band runs from the least to "
                 "the greatest of each mesh period."),
        "turn_orders": ("Orders of the turn", orders_of_turn, turn,
                        f"Greatest: {', '.join(greatest)}. Eccentricity stands at the order of its "
                        "shaft; pitch errors spread over all orders of a shaft and beside the "
                        "mesh."),
        "turn_teeth": ("Tooth by tooth", teeth_of_turn, teeth,
                       "Left: drive flanks at the pitch point from the mean of the gear, "
                       "eccentricity included. A flank that is early takes load from its "
                       "neighbours. The greatest pressure is on "
                       f"{worst['gear'].item()} tooth {int(worst['number'])}."),
    }  # fmt: skip
    return [
        Shown(name, heading, caption, partial(make, data), wide=True)
        for name, (heading, make, data, caption) in made.items()
    ]


def tables(groups: Mapping[str, Dataset]) -> list[Table]:
    """The greatest lines, which a terminal shows too, and every tooth."""
    if "turn" not in groups:
        return []
    return [
        declared(
            f"Transmission error: {_swings(groups['turn'])}. Its greatest lines (amplitudes).",
            LINES,
            lines(groups["turn"])[:MOST_LINES],
        ),
        declared(
            "Tooth by tooth. Index error: the drive flank at the pitch point along the line of "
            "action, from the mean of its gear, > 0 early, eccentricity included. The greatest "
            "pressure on the flank, with the distance from the pinion's tangent point and the "
            "mate; no pressure is known on a corner.",
            TEETH,
            rows_along(groups["teeth"], "tooth"),
            names=2,
        ),
    ]


# --- pictures -----------------------------------------------------------------------------------


def tooth_axis(data: Dataset, *, low: int, high: int) -> Axis:
    """Mesh phases from ``low`` to ``high``, named by the teeth that enter: pinion/wheel."""
    (z1, z2), (first, second) = (np.array(data.attrs[name], int) for name in ("teeth", "first"))
    least = -(-(high - low) // TICKS)
    # whole turns of the pinion where many teeth pass
    places = np.arange(low, high, least if least < z1 else int(z1) * -(-least // int(z1)))
    names = [f"{(n + first - 1) % z1 + 1}/{(n + second - 1) % z2 + 1}" for n in places]
    words = "teeth that enter contact, pinion/wheel [–]"
    return Axis(words, low=low, high=high, ticks=places, names=names, slant=30.0)


def error_of_turn(data: Dataset) -> Picture:
    """The error over the turn; below it the turn of the pinion in which it swings most."""
    phase, of = data["mesh_phase"].values, int(data.attrs["mesh_periods"])
    curves = {"under load": (SWINGS[0], HOT), "without load": (SWINGS[1], COLD)}
    shown = min(of, int(data.attrs["teeth"][0]))
    each, words = phase.size // of, "transmission error δ [µm]"
    turns = data[SWINGS[0]].values[: of // shown * shown * each].reshape(of // shown, -1)
    start = int(np.argmax(np.ptp(turns, axis=1))) * shown
    near = Panel(tooth_axis(data, low=start, high=start + shown), Axis(words))
    here = slice(start * each, (start + shown) * each)
    for label, (name, colour) in curves.items():
        y = MICROMETRE(data[name].values[here])
        draw_phase(near, phase[here], values=y, colour=colour, label=label, width=1.2)
    if shown == of:
        return Picture([[near]], size=(WIDE, 3.4), legend=2)
    near.title = "Turn of the pinion in which it swings most"
    top = Top("mesh periods [–]", 1.0)
    whole = Panel(tooth_axis(data, low=0, high=of), Axis(words), "Whole turn, under load", top=top)
    whole.span(x=(start, start + shown), colour=QUIET, opacity=0.15)
    draw_phase(whole, phase, values=MICROMETRE(data[SWINGS[0]].values), colour=HOT, width=1.2)
    return Picture([[whole], [near]], size=(WIDE, 6.2), legend=2, top=0.75, above=1.0)


def orders_of_turn(data: Dataset) -> Picture:
    """Lines of the loaded error: those of the shafts, and of the mesh with its side lines."""
    rows = lines(data)
    order = np.array([row["order"] for row in rows])
    amplitude = MICROMETRE(np.array([row["line_amplitude"] for row in rows]))
    plain = [row["name"].lstrip("0123456789 ") for row in rows]  # no side line
    kinds = np.array([name if name in COLOURS else "other" for name in plain])
    floor, top = floor_of(amplitude, order=order, highest=4.0)
    panels = []
    for words, factor, high in (
        ("orders of the slower shaft [–]", float(max(data.attrs["teeth"])), 12.0),
        ("orders of the mesh [–]", 1.0, 3.4),
    ):
        y = Axis("amplitude of the loaded error [µm]", low=10.0 * floor, high=8.0 * top,
                 log="decades")  # fmt: skip
        panel, x = Panel(Axis(words, low=0.0, high=high), y), order * factor
        for kind, colour in COLOURS.items():
            (some,) = np.nonzero((kinds == kind) & (x < high))
            some = some[np.argsort(x[some])]
            draw_lines(panel, order=x[some], amplitude=amplitude[some], colour=colour, label=kind)
        # the greatest come first
        _, greatest = np.unique((x / high * NAMED).astype(int), return_index=True)
        for n in greatest[:NAMED]:
            panel.text(x[n], amplitude[n], rows[n]["name"], offset=(0, 5), up="bottom", size=7.5)
        panels.append(panel)
    return Picture([panels], size=(WIDE, 3.8), legend=4)


def teeth_of_turn(data: Dataset) -> Picture:
    """Of every tooth of both gears: its place, and the greatest pressure on its flank."""
    rows = []
    for gear, colour in (("pinion", HOT), ("wheel", COLD)):
        here = data.isel(tooth=np.flatnonzero(data["gear"].values == gear))
        number = here["number"].values.astype(float)
        x = Axis(f"{gear} tooth [–]", low=0.0, high=number[-1] + 1.0,
                 ticks=number[:: -(-number.size // TICKS)])  # fmt: skip
        place, pressure = Panel(x, Axis("index error, > 0 early [µm]")), Panel(x)
        place.bars(number, MICROMETRE(here["index_error"].values), width=0.8, colour=colour)
        place.line(y=0.0, colour=INK, width=0.8)
        pressure.y = Axis("greatest pressure [MPa]")
        values = MEGAPASCAL(here["contact_pressure"].values)
        pressure.points(number, values, colour=colour, size=4.0)
        rows.append([place, pressure])
    return Picture(rows, size=(WIDE, 5.6), above=0.75, between=0.8)
