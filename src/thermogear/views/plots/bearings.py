"""Bearings of a drive train in motion: journals in their clearance, forces over time and order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.display import MICROMETRE, MILLIMETRE_PER_SECOND, number
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.shafts import internal_clearance
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import (
    ABOVE,
    BETWEEN,
    BOTTOM,
    INK,
    LEFT,
    QUIET,
    RIGHT,
    STATES,
    TOP,
    WIDE,
    names_of,
)

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
HIGHEST = 12.0
ACROSS = 4
"""Bearings side by side in the picture of their orbits."""
BESIDE = 2
"""Panels side by side in those of their forces."""
ROOM = 1.35
"""Half the width of a panel over the greatest displacement in it."""
ROUND = np.linspace(0.0, 2.0 * np.pi, 121)
DASH = (4.0, 3.0)
BETWEEN_SAMPLES = 4
"""Points of a drawn orbit for every sample."""


def bearing_orbits(data: xr.Dataset, operating: int, *, sample: int = 0) -> Picture:
    """Every journal in its clearance, above to scale, below about its mean place alone [um].

    A dot below shows where it is at that ``sample`` of the record.
    """
    here = data.isel(operating=operating)
    rows: list[list[Panel]] = []
    places = range(here.sizes["bearing"])
    for first in range(0, len(places), ACROSS):
        some = places[first : first + ACROSS]
        rows.append([_in_clearance(here, b) for b in some])
        rows.append([_about_mean(here, b, sample) for b in some])
    wide = max(len(row) for row in rows)
    for row in rows:
        row.extend(_empty(row[0]) for _ in range(wide - len(row)))
    each = (WIDE - LEFT - RIGHT - BETWEEN * (ACROSS - 1)) / ACROSS
    size = (
        LEFT + RIGHT + wide * each + BETWEEN * (wide - 1),
        TOP + BOTTOM + each * len(rows) + ABOVE * (len(rows) - 1),
    )
    return Picture(rows, size=size, legend=4)


def _axes(words: str, half: float) -> tuple[Axis, Axis]:
    """x and y of one scale, from -``half`` to ``half``."""
    x, y = (Axis(f"{c}{words} [µm]", low=-half, high=half, most=5) for c in "xy")
    return x, y


def _in_clearance(here: xr.Dataset, bearing: int) -> Panel:
    """Clearance circles, orbits and the direction of the load of one bearing."""
    states = names_of(here, "state")
    path = MICROMETRE(here["journal_path"].values[:, bearing])
    free = 0.5 * MICROMETRE(internal_clearance(here).values[:, bearing])
    far = float(np.nanmax(np.hypot(path[:, 0], path[:, 1]), initial=0.0))
    most = max(far, float(np.nanmax(free, initial=0.0))) or 1.0
    panel = Panel(*_axes("", ROOM * most), names_of(here, "bearing")[bearing], equal=True)
    for s, state in enumerate(states):
        colour = STATES.get(state, INK)
        if free[s] > 0.0:
            panel.curve(
                free[s] * np.cos(ROUND), free[s] * np.sin(ROUND), colour=colour, width=1.1,
                dash=DASH, label=f"clearance, {state}",
            )  # fmt: skip
        x, y = _smooth(_once(path[s], here, s))
        panel.curve(x, y, colour=colour, width=1.4, label=f"journal, {state}")
    panel.points(
        [0.0], [0.0], colour=QUIET, marker="plus", size=4.0, label="centre of the outer ring"
    )
    _load(panel, here["mean_bearing_load"].values[-1, bearing], ROOM * most, states[-1])
    _said(panel, _bound(free, states), here["mean_bearing_load"].values[-1, bearing])
    return panel


def _bound(free: Floats, states: Sequence[str]) -> str:
    """What is said of a bearing without a free circle."""
    if np.isnan(free).all():
        return "a linear spring"
    return "\n".join(
        f"{state}: preload {-gap:.1f} µm"
        for gap, state in zip(free, states, strict=True)
        if gap < 0.0
    )


def _said(panel: Panel, words: str, load: Floats) -> None:
    """``words`` at the rim that the journal is pushed to, where no arrow is."""
    low = bool(load[1] <= 0.0)
    if words:
        panel.text(
            0.03, 0.015 if low else 0.985, words, at="panel", across="left",
            up="bottom" if low else "top", size=7.4, colour=QUIET,
        )  # fmt: skip


def _once(path: Floats, here: xr.Dataset, state: int) -> Floats:
    """The part of ``path`` (2, sample) after which it comes again, closed; else all of it."""
    phase, name = here["phase"].values, str(here["label"].values[state])
    number = name.removeprefix("period-")
    if name == number or int(here.attrs.get("cycle", 1)) > 1:
        return path
    count = int(number) * round(1.0 / float(phase[1] - phase[0]))
    return path if count > phase.size else path[:, [*range(count), 0]]


def _smooth(path: Floats) -> Floats:
    """``path`` (2, sample) with cubics between the samples, sloped as their neighbours lie."""
    slope = np.gradient(path, axis=1)
    t = np.arange(BETWEEN_SAMPLES) / BETWEEN_SAMPLES
    one, other = path[:, :-1, None], path[:, 1:, None]
    rise, fall = slope[:, :-1, None], slope[:, 1:, None]
    found = (
        one * (1.0 + 2.0 * t) * (1.0 - t) ** 2 + other * t**2 * (3.0 - 2.0 * t)
        + rise * t * (1.0 - t) ** 2 - fall * t**2 * (1.0 - t)
    ).reshape(2, -1)  # fmt: skip
    return np.hstack([found, path[:, -1:]])


def _load(panel: Panel, load: Floats, half: float, state: str) -> None:
    """An arrow from the rim towards the centre, the way the journal is pushed, and its force."""
    size = float(np.hypot(*load))
    if not size > 0.0:
        return
    way = load / size
    tail, tip = -0.92 * half * way, -0.62 * half * way
    panel.curve(
        [tail[0], tip[0]], [tail[1], tip[1]], colour=INK, width=1.4, label=f"mean load, {state}"
    )
    _head(panel, tip, way, 0.1 * half, INK)
    low, left = bool(tail[1] < 0.0), bool(tail[0] > 0.0)
    panel.text(
        0.03 if left else 0.97, 0.015 if low else 0.985, f"{number(size)} N", at="panel",
        across="left" if left else "right", up="bottom" if low else "top", size=8.0,
    )  # fmt: skip


def _head(panel: Panel, tip: Floats, way: Floats, size: float, colour: str) -> None:
    """Both barbs of an arrow that ends at ``tip`` and points along ``way``."""
    side = np.array([-way[1], way[0]])
    barbs = [tip - size * (way + 0.5 * side), tip, tip - size * (way - 0.5 * side)]
    x, y = np.transpose(barbs)
    panel.curve(x, y, colour=colour, width=1.4)


def _about_mean(here: xr.Dataset, bearing: int, sample: int) -> Panel:
    """The orbits alone, each less its mean place; a dot at ``sample``, an arrow along the way."""
    path = MICROMETRE(here["journal_path"].values[:, bearing])
    path = path - path.mean(axis=2, keepdims=True)
    far = float(np.nanmax(np.hypot(path[:, 0], path[:, 1]), initial=0.0))
    half = 1.2 * far or 1.0
    panel = Panel(*_axes(" − mean", half), equal=True)
    for s, state in enumerate(names_of(here, "state")):
        colour = STATES.get(state, INK)
        if not np.isfinite(path[s]).all():
            continue
        x, y = _smooth(_once(path[s], here, s))
        panel.curve(x, y, colour=colour, width=1.1)
        now = path[s, :, sample]
        panel.points(
            [now[0]], [now[1]], colour=colour, size=5.5, edge="white", edge_width=0.6, order=3.0
        )
        steps = np.diff([x, y], axis=1)
        longs = np.hypot(*steps)
        fast = int(longs.argmax())
        if longs[fast] > 0.0:
            tip = np.array([x[fast + 1], y[fast + 1]])
            _head(panel, tip, steps[:, fast] / longs[fast], 0.12 * half, colour)
    return panel


def _empty(like: Panel) -> Panel:
    panel = Panel(like.x, like.y)
    panel.note("no more of them")
    return panel


def _rows(panels: Sequence[Panel]) -> list[list[Panel]]:
    rows = [list(panels[i : i + BESIDE]) for i in range(0, len(panels), BESIDE)]
    if len(rows) > 1:
        rows[-1].extend(_empty(panels[0]) for _ in range(BESIDE - len(rows[-1])))
    return rows


def bearing_force_time(data: xr.Dataset, operating: int) -> Picture:
    """Amount of the force on every bearing over the mesh periods, undeformed and hot."""
    here = data.isel(operating=operating)
    phase, force = here["phase"].values, here["bearing_force"].values
    panels = []
    for b, name in enumerate(names_of(here, "bearing")):
        panel = Panel(Axis("time [mesh periods]"), Axis("force on the bearing [N]"), name)
        for s, state in enumerate(names_of(here, "state")):
            colour = STATES.get(state, INK)
            panel.curve(phase, force[s, b], colour=colour, label=state)
            mean = float(here["mean_bearing_force"].values[s, b])
            if np.isfinite(mean):
                panel.line(
                    y=mean,
                    colour=colour,
                    width=0.9,
                    dash=DASH,
                    label=f"amount of the mean, {state}",
                )
        panels.append(panel)
    rows = _rows(panels)
    return Picture(rows, size=(WIDE, 2.4 * len(rows) + 0.3), legend=4)


def bearing_force_order(data: xr.Dataset, operating: int) -> Picture:
    """Lines of the force on every bearing over orders of the mesh frequency."""
    here = data.isel(operating=operating)
    order, lines = here["line_order"].values, here["bearing_force_line"].values
    floor, top = floor_of(lines, order=order, highest=HIGHEST)
    panels = []
    for b, name in enumerate(names_of(here, "bearing")):
        panel = over_orders(
            "order of the mesh frequency [–]", "line of the force [N]", floor=floor, top=top,
            highest=HIGHEST,
        )  # fmt: skip
        panel.title = name
        for s, state in enumerate(names_of(here, "state")):
            draw_lines(
                panel, order=order, amplitude=lines[s, b], colour=STATES.get(state, INK),
                label=state, filled=s > 0,
            )  # fmt: skip
        panels.append(panel)
    rows = _rows(panels)
    return Picture(rows, size=(WIDE, 2.6 * len(rows) + 0.3), legend=4)


HUES = ("#d62f4b", "#e8743b", "#d9a400", "#8fae2e", "#2f9e5f", "#17a2a2", "#2f7fc4", "#4a58c9",
        "#7a49c0", "#a845b8", "#c93f98", "#d5386f")  # fmt: skip
"""Colours once around: the last is next to the first."""
QUARTERS = (("0", 0.0), ("¼", 0.25), ("½", 0.5), ("¾", 0.75))


def turning(data: xr.Dataset, operating: int) -> list[int]:
    """Places of the states whose motion at this operating point lies on a torus."""
    found = data["label"].values[:, operating]
    return [s for s, name in enumerate(found) if str(name) == "quasi-periodic"]


def torus_section(data: xr.Dataset, operating: int) -> Picture:
    """Sections of a quasi-periodic motion, coloured by its second phase, on their closed curves."""
    here = data.isel(operating=operating)
    mesh = float(here["mesh_frequency"])
    panels = []
    for s in turning(data, operating):
        one = here.isel(state=s)
        nu = float(one["second_frequency"])
        x, y = (
            MICROMETRE(one["section_deflection"].values),
            MILLIMETRE_PER_SECOND(one["section_rate"].values),
        )
        panel = Panel(
            Axis("approach along the drive flank [µm]", margin=0.1),
            Axis("its rate [mm/s]", margin=0.1),
            f"{names_of(here, 'state')[s]}: mesh {mesh:.1f} Hz, second base frequency "
            f"{nu * mesh:.1f} Hz",
        )
        own = (
            MICROMETRE(one["torus_deflection"].values),
            MILLIMETRE_PER_SECOND(one["torus_rate"].values),
        )
        panel.curve(
            *own, colour=INK, width=0.8, order=2.5, label="closed curve through the sections"
        )
        kept = np.isfinite(x) & np.isfinite(y)
        around = np.mod(nu * np.arange(x.size), 1.0)
        part = np.minimum((around * len(HUES)).astype(int), len(HUES) - 1)
        for hue, colour in enumerate(HUES):
            chosen = kept & (part == hue)
            if chosen.any():
                panel.points(x[chosen], y[chosen], colour=colour, size=4.5)
        if np.isfinite(own).all():  # of several curves none is numbered
            _quarters(panel, own)
        panels.append(panel)
    return Picture([panels], size=(WIDE if len(panels) > 1 else 6.4, 4.0))


def _quarters(panel: Panel, curve: tuple[Any, Any]) -> None:
    """Turns of the second phase beside the curve, outside of it."""
    x, y = curve
    middle = np.array([np.mean(x), np.mean(y)])
    spread = np.array([np.ptp(x), np.ptp(y)])
    for words, turn in QUARTERS:
        at = round(turn * (x.size - 1))
        out = (np.array([x[at], y[at]]) - middle) / np.where(spread > 0.0, spread, 1.0)
        long = float(np.hypot(*out)) or 1.0
        panel.points([x[at]], [y[at]], colour=INK, size=7.0, open=True)
        panel.text(x[at], y[at], words, offset=(11.0 * out[0] / long, 11.0 * out[1] / long))
