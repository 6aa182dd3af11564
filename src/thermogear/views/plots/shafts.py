"""Drive trains: the sketch to scale, deflections, modes, the Campbell diagram, the response."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import HERTZ, MICROMETRE, MILLIMETRE, PERCENT, SPEED, display
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import (
    FAINT,
    INK,
    OKABE_ITO,
    QUIET,
    STATES,
    WIDE,
    names_of,
    scale,
)

PINION, WHEEL = OKABE_ITO[0], OKABE_ITO[1]
SHAFTS = {"pinion": PINION, "wheel": WHEEL}
DASHES = {"undeformed": (4.0, 3.0), "hot": ()}
LEAST_SHARE = 1e-5
"""Of the greatest amplitude of a panel, below which nothing is drawn."""
LEAST_FORCE = 0.05
"""Of the greatest resonant force on a bearing, from which a critical speed is drawn."""
MOST_MODES = 8
"""Modes that are drawn."""


def sketch(said: Mapping[str, Any]) -> Picture:
    """Both shafts side by side, as far apart as their centres are, to one scale, in mm."""
    shafts, apart = said["shafts"], MILLIMETRE(float(said["centre_distance"]))
    panel = Panel(
        Axis("along the shafts [mm]", grid=False), Axis("across [mm]", grid=False), equal=True
    )
    for number, shaft in enumerate(shafts):
        centre, colour = -number * apart, SHAFTS[shaft["name"]]
        ends = [MILLIMETRE(shaft["sections"][0][0]), MILLIMETRE(shaft["sections"][-1][1])]
        for start, end, outer, inner in shaft["sections"]:
            _box(panel, (MILLIMETRE(start), MILLIMETRE(end)), centre, MILLIMETRE(outer), INK)
            if inner:
                _box(
                    panel,
                    (MILLIMETRE(start), MILLIMETRE(end)),
                    centre,
                    MILLIMETRE(inner),
                    FAINT,
                    dash=(3.0, 2.0),
                )
        face, tip = (MILLIMETRE(one) for one in shaft["gear"])
        _box(panel, (-0.5 * face, 0.5 * face), centre, tip, colour, width=2.2)
        panel.text(
            0.0, centre + 0.5 * tip, shaft["name"], up="bottom", offset=(0.0, 2.0), bold=True
        )
        size = 0.55 * max(MILLIMETRE(one[2]) for one in shaft["sections"])
        for name, at in shaft["bearings"]:
            _bearing(panel, MILLIMETRE(at), centre, size, name)
        for name, at in shaft["discs"]:
            panel.curve(
                [MILLIMETRE(at)] * 2,
                [centre - 1.6 * size, centre + 1.6 * size],
                colour=QUIET,
                width=5.0,
            )
            panel.text(
                MILLIMETRE(at), centre - 1.6 * size, name, up="top", offset=(0.0, -2.0), size=7.5
            )
        if shaft["end"]:
            name, at = shaft["end"][0], MILLIMETRE(shaft["end"][1])
            side = -1.0 if abs(at - ends[0]) <= abs(at - ends[1]) else 1.0
            long = 0.12 * (ends[1] - ends[0])
            panel.curve([at, at + side * long], [centre] * 2, colour=QUIET, dash=(2.0, 2.0))
            panel.points([at + side * long], [centre], colour=QUIET, marker="square", size=11.0)
            panel.text(at + side * long, centre, name, up="bottom", offset=(0.0, 8.0), size=8.0)
        panel.curve([ends[0], ends[1]], [centre] * 2, colour=QUIET, width=0.7, dash=(8.0, 2.0))
    (left, right), (low, high) = panel.extent("x"), panel.extent("y")
    tall = (WIDE - 1.0) * (high - low) / (right - left)
    return Picture([[panel]], size=(WIDE, 1.0 + float(np.clip(tall, 2.5, 5.5))))


def _box(
    panel: Panel,
    along: tuple[float, float],
    centre: float,
    across: float,
    colour: str,
    *,
    width: float = 1.3,
    dash: tuple[float, ...] = (),
) -> None:
    a, b = along
    low, high = centre - 0.5 * across, centre + 0.5 * across
    panel.curve([a, b, b, a, a], [low, low, high, high, low], colour=colour, width=width, dash=dash)


def _bearing(panel: Panel, at: float, centre: float, size: float, name: str) -> None:
    for side in (-1.0, 1.0):
        low, high = centre + side * size, centre + side * 1.75 * size
        half = 0.3 * size
        x = [at - half, at + half, at + half, at - half, at - half]
        panel.curve(x, [low, low, high, high, low], colour=INK, width=1.1)
        for cross in ((low, high), (high, low)):
            panel.curve([at - half, at + half], cross, colour=INK, width=0.8)
    panel.text(at, centre - 1.75 * size, name, up="top", offset=(0.0, -3.0), size=7.5)


def deflection(data: Dataset, place: int) -> Picture:
    """Deflection of both shafts along x and y at one operating point."""
    panels = []
    for shaft, colour in SHAFTS.items():
        panel = Panel(
            Axis("along the shaft, gear at 0 [mm]"),
            Axis("deflection [µm]"),
            f"{shaft}'s shaft",
        )
        x = MILLIMETRE(data[f"{shaft}_position"].values)
        for state, name in enumerate(names_of(data, "state")):
            for c, thick in (("x", 1.0), ("y", 2.0)):
                values = MICROMETRE(data[f"{shaft}_{c}"].values[state, place])
                panel.curve(
                    x,
                    values,
                    colour=STATES.get(name, colour),
                    width=thick,
                    dash=DASHES.get(name, ()),
                    label=f"along {c}, {name}",
                )
        panels.append(panel)
    return Picture([panels], size=(WIDE, 3.2), legend=4)


def _at_bearings(panel: Panel, data: Dataset, values: Floats, apart: float) -> None:
    """A mark for each state, operating point and bearing; points ``apart`` on the axis."""
    names, count = names_of(data, "bearing"), data.sizes["operating"]
    for state, name in enumerate(names_of(data, "state")):
        for point in range(count):
            x = np.arange(len(names)) + (state - 0.5) * 0.25 + apart * (point - 0.5 * (count - 1))
            panel.points(
                x,
                values[state, point],
                colour=STATES.get(name, INK),
                marker="circle" if state else "square",
                open=not state,
                label=name if point == 0 else "",
            )
    panel.x.ticks, panel.x.names = np.arange(len(names)), names


def loads(data: Dataset) -> Picture:
    """Load of every bearing at every operating point, cold and hot."""
    panel = Panel(Axis(""), Axis("bearing load [N]", low=0.0))
    _at_bearings(panel, data, data["bearing_load"].values, 0.08)
    panel.y.high = 1.1 * float(np.nanmax(data["bearing_load"].values, initial=1.0))
    return Picture([[panel]], size=(WIDE, 3.2))


def clearances(data: Dataset) -> Picture:
    """Radial internal clearance of every bearing, cold and hot; below zero it is a preload."""
    panel = Panel(Axis(""), Axis("radial internal clearance [µm]"))
    _at_bearings(panel, data, MICROMETRE(data["radial_internal_clearance"].values), 0.0)
    panel.line(y=0.0, colour=QUIET, width=1.0, dash=(4.0, 3.0))
    return Picture([[panel]], size=(WIDE, 3.0))


def modes(table: Dataset, shapes: Dataset, state: int) -> Picture:
    """The lowest modes: deflection of both shafts across (full) and their twist (dashed)."""
    panels = []
    for mode in range(min(MOST_MODES, table.sizes["mode"])):
        both = HERTZ(table["natural_frequency"].values[:, mode])
        names = names_of(table, "state")
        others = [f"{v:.4g} {n}" for v, n in zip(both, names, strict=True) if n != names[state]]
        panel = Panel(
            Axis("along the shaft [mm]", small=True, most=4),
            Axis("shape [–]", low=-1.15, high=1.15, most=3, small=True),
            f"{mode + 1}: {both[state]:.4g} Hz ({', '.join(others)})",
        )
        for shaft, colour in SHAFTS.items():
            x = MILLIMETRE(shapes[f"{shaft}_position"].values)
            parts = {
                c: shapes[f"{shaft}_{c}_real"].values[state, mode] for c in ("x", "y", "twist")
            }
            across = max(("x", "y"), key=lambda c: float(np.abs(parts[c]).max()))
            words = f"{shaft}'s shaft, " if mode == 0 else ""
            panel.curve(x, parts[across], colour=colour, label=words and f"{words}across")
            panel.curve(
                x,
                parts["twist"],
                colour=colour,
                dash=(4.0, 3.0),
                width=1.2,
                label=words and f"{words}twist times base radius",
            )
        panels.append(panel)
    rows = in_rows(panels, 4)
    return Picture(rows, size=(WIDE, 2.4 * len(rows) + 0.4), legend=4, between=0.75, above=0.85)


def empty(like: Panel) -> Panel:
    """A panel beside ``like`` for which nothing is left to draw."""
    panel = Panel(like.x, like.y)
    panel.note("no more of them")
    return panel


def in_rows(panels: Sequence[Panel], columns: int) -> list[list[Panel]]:
    """Rows of at most so many panels; the last is filled up with empty ones."""
    columns = min(columns, len(panels))
    rows = [list(panels[i : i + columns]) for i in range(0, len(panels), columns)]
    rows[-1].extend(empty(panels[0]) for _ in range(columns - len(rows[-1])))
    return rows


def energies(table: Dataset, state: int) -> Picture:
    """Which part bends in which mode: shares of the strain energy."""
    values = PERCENT(table["energy_share"].values[state].T)
    parts = names_of(table, "part")
    columns = np.arange(table.sizes["mode"] + 1) - 0.5
    rows = np.arange(len(parts) + 1) - 0.5
    panel = Panel(
        Axis("mode", ticks=columns[:-1] + 0.5, names=[str(int(m)) for m in table["mode"].values]),
        Axis(low=rows[-1], high=rows[0], ticks=rows[:-1] + 0.5, names=parts),
    )
    panel.field(columns, rows, values, colours=scale("Blues"), low=0.0, high=100.0)
    for r, c in np.argwhere(values >= 5.0).tolist():
        share = float(values[r, c])
        panel.text(c, r, f"{share:.0f}", size=7.4, colour="#ffffff" if share > 60.0 else INK)
    return Picture([[panel]], size=(WIDE, 0.28 * len(parts) + 1.0), left=2.2)


def not_valid(speed: float) -> str:
    """What stands in place of the force of a resonance that lifts off from ``speed`` [rad/s] on."""
    return f"not valid: lifts off from {SPEED(speed):.0f} rpm"


def campbell(data: Dataset, critical: Dataset, speeds: Sequence[float]) -> Picture:
    """Natural frequencies over speed with the band of the mesh, the orders, the critical speeds."""
    rpm = display("pinion_speed")
    x = rpm(data["pinion_speed"].values)
    panels = []
    states = names_of(data, "state")
    inside = critical["critical_speed"].values <= data["pinion_speed"].values[-1]
    force, lifts = critical["resonant_force"].values, critical["lift_off_speed"].values
    known = np.where(inside & np.isfinite(force), force, np.nan)
    most = max(float(np.nanmax(known, initial=0.0)), 1e-12)
    for state, name in enumerate(states):
        low, mean, high = HERTZ(data["natural_frequency"].values[state])
        top = 1.05 * float(np.nanmax(high))
        panel = Panel(
            Axis("pinion speed [rpm]", low=float(x[0]), high=float(x[-1])),
            Axis("frequency [Hz]", low=0.0, high=top),
            name,
        )
        for mode in range(mean.shape[1]):
            panel.band(x, low=low[:, mode], high=high[:, mode], colour=QUIET, opacity=0.35)
            panel.curve(x, mean[:, mode], colour=INK, width=1.2)
        for line, words in enumerate(names_of(critical, "line")):
            order = float(critical["order"].values[line])
            y = HERTZ(order * data["pinion_speed"].values)
            panel.curve(
                x,
                np.where(y <= top, y, np.nan),
                colour=OKABE_ITO[line % len(OKABE_ITO)],
                width=1.0,
                dash=(5.0, 2.0) if line < len(OKABE_ITO) else (1.5, 2.0),
                label=words if state == 0 else "",
            )
            met = critical["critical_speed"].values[state, 1, line]
            shares = np.minimum(force[state, 1, line] / most, 1.0)
            shares[np.isfinite(lifts[state, 1, line])] = 1.0
            for speed, share in zip(met, shares, strict=True):
                if np.isfinite(speed) and share >= LEAST_FORCE and rpm(speed) <= x[-1]:
                    panel.points(
                        [float(rpm(speed))],
                        [HERTZ(order * speed)],
                        colour=OKABE_ITO[line % len(OKABE_ITO)],
                        size=3.0 + 7.0 * float(np.sqrt(share)),
                        edge=INK,
                        edge_width=0.6,
                        order=3.0,
                    )
        for own in np.unique(speeds):
            panel.line(x=float(rpm(own)), colour=QUIET, width=1.0, dash=(4.0, 3.0))
        panels.append(panel)
    return Picture([panels], size=(WIDE, 4.4), legend=4, share_y="row")


def response(data: Dataset, quantity: str, words: str) -> Picture:
    """Amplitude over speed, hot full, undeformed dashed; a panel a bearing, a colour a source."""
    rpm = display("pinion_speed")(data["response_speed"].values)
    panels = []
    for number, bearing in enumerate(names_of(data, "bearing")):
        panel = Panel(Axis("pinion speed [rpm]"), Axis(words, log="decades"), bearing)
        parts = [data[f"{quantity}_{c}"].values[..., number] for c in ("x", "y")]
        floor = LEAST_SHARE * float(np.nanmax(np.hypot(*parts), initial=0.0))
        for place, source in enumerate(names_of(data, "source")):
            for state, name in enumerate(names_of(data, "state")):
                size = np.hypot(*(part[state, place] for part in parts))
                if np.any(size > floor):
                    panel.curve(
                        rpm,
                        np.where(size > floor, size, np.nan),
                        colour=OKABE_ITO[place % len(OKABE_ITO)],
                        width=1.3 if name == "hot" else 0.9,
                        dash=DASHES.get(name, ()),
                        label=source if number == 0 and name == "hot" else "",
                    )
        panels.append(panel)
    rows = in_rows(panels, 2)
    return Picture(rows, size=(WIDE, 2.7 * len(rows) + 0.3), legend=3)
