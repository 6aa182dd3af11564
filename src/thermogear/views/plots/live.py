"""Pictures that answer a dial: stiffness, backlash, run-up and orbit of one operating point."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS, MICROMETRE, SPEED, STIFFNESS, number
from thermogear.base.vocabulary import STATUS, STILL, is_known
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.curves import axis_of
from thermogear.views.plots.motion import HALF_ORDERS, HIGHEST_ORDER, thinned
from thermogear.views.plots.one_motion import edges_in_sight
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.plots.stiffness import by_state
from thermogear.views.style import COLD, FAINT, HOT, INK, OKABE_ITO, QUIET, STATES, names_of
from thermogear.views.typesetting import FAR, axis_label, shown

DASHED = (3, 2)
SHOWN = 6
"""Mesh periods of a turn that are drawn."""
STARTS = {"the case's start": INK, "running up": OKABE_ITO[2], "running down": OKABE_ITO[3]}
"""Where a motion comes from, and its colour."""


def stiffness(data: Dataset) -> Picture:
    """Mesh stiffness over a mesh period, undeformed and hot, with its means."""
    return Picture([[by_state(data)]], size=(4.9, 3.0))


def gap(data: Dataset) -> Picture:
    """Half backlash over the gears' temperature, where the gears are, and the way to the jam."""
    panel = Panel(axis_of("gear_temperature"), axis_of("half_backlash", "half backlash"))
    x, values = shown(data, "gear_temperature"), shown(data, "half_backlash")
    panel.curve(x, values, colour=HOT, label="both gears")
    hot = float(CELSIUS(data.attrs["hot_temperature"]))
    here = float(np.interp(hot, x, values))
    jam = float(CELSIUS(data.attrs["jam_temperature"]))
    if np.isfinite(jam) and jam < FAR:
        panel.curve([hot, jam], [here, 0.0], colour=INK, width=1.1, dash=(1, 2),
                    label="gears alone hotter")  # fmt: skip
        panel.points([jam], [0.0], marker="cross", colour=INK, size=7)
        panel.text(jam, 0.0, f"jams at {jam:.0f} °C", offset=(-9, -5), across="right", up="top")
    panel.points([hot], [here], colour=HOT, size=8.0, edge="white", label="here")
    panel.line(y=0.0, colour=INK, width=0.9)
    low, high = panel.extent("y")
    panel.y.low, panel.y.high = min(low, -0.16 * abs(high)), high
    panel.span(y=(panel.y.low, 0.0), colour=FAINT, opacity=0.5)
    return Picture([[panel]], size=(4.9, 3.0))


def run_up(states: Mapping[str, Dataset], speed: float) -> Picture:
    """Transmission error over speed, up and down, by state; below the section of the hot pair.

    ``states``: what :class:`~thermogear.study.live.LiveRunUp` holds of each. ``speed`` [rad/s] is
    that of the orbit shown. Crosses: where a run leaves its motion.
    """
    above = Panel(Axis(), Axis("transmission error, p-p [µm]"))
    below = Panel(Axis("pinion speed [rpm]"), Axis("section x at phase 0 [µm]"))
    ways = (("up", ()), ("down", DASHED))
    for name, data in states.items():
        colour = STATES.get(name, INK)
        n = SPEED(data["pinion_speed"].values)
        error = MICROMETRE(data["dte_peak_to_peak"].values[0])
        for way, (words, dash) in enumerate(ways):
            known = np.isfinite(error[way])
            kept = known if data.attrs.get("preview") else np.ones(n.size, bool)
            above.curve(n[kept], error[way][kept], colour=colour, dash=dash, width=1.3,
                        label=f"{name}, {words}")  # fmt: skip
        leaps = data["leap_fold"].values[0]
        size = MICROMETRE(data["leap_before"].values[0])
        there = np.isfinite(leaps)
        if there.any():
            above.points(SPEED(leaps[there]), size[there], marker="cross", colour=colour, size=7,
                         label=f"{name}, jump")  # fmt: skip
    if "hot" in states:
        _section(below, states["hot"])
    for panel in (above, below):
        panel.line(x=SPEED(speed), colour=QUIET, width=1.2, dash=(1, 2), label="the orbit's speed")
    return Picture([[above], [below]], size=(10.0, 5.2), share_x="column", heights=(3, 2), legend=5)


def series(data: Dataset) -> Picture:
    """Band of the dynamic factor over speed, the median, the pair shown, every pair's own."""
    panel = Panel(Axis("pinion speed [rpm]"), Axis("dynamic factor [–]", low=0.0))
    rpm, (low, middle, high) = SPEED(data["pinion_speed"].values), data["band"].values
    panel.band(rpm, low=low, high=high, colour=INK, opacity=0.2, label="90 % of pairs")
    panel.curve(rpm, middle, colour=INK, width=1.3, label="median")
    pair, parts = data.attrs["shown"], data["own_dynamic_factor"].values
    if 0 <= pair < parts.size:
        curve = data["dynamic_factor"].values[pair]
        panel.curve(rpm, curve, colour=HOT, width=1.5, label=f"pair {pair}")
    speed = float(SPEED(data.attrs["own_speed"]))
    panel.points(np.full(parts.size, speed), parts, colour=HOT, size=3.0, open=True, label="pairs")
    panel.line(x=speed, colour=QUIET, width=1.2, dash=(1, 2))
    return Picture([[panel]], size=(10.0, 3.2), legend=4)


def told_series(data: Dataset) -> list[str]:
    """The band at the own speed in words, with how many pairs it is of."""
    rpm, known = SPEED(data.attrs["own_speed"]), np.isfinite(data["own_dynamic_factor"].values)
    if not known.any():
        return ["no pair moves at this speed: jammed, without load, or too slow to vibrate"]
    place = np.searchsorted(data["pinion_speed"].values, data.attrs["own_speed"])
    low, middle, high = data["band"].values[:, place]
    return [
        f"at {rpm:.6g} rpm the dynamic factor is {middle:.2g} in the "
        f"median of {known.sum()} pairs, {low:.2g} to {high:.2g} in 90 % of them"
    ]


def _section(panel: Panel, data: Dataset) -> None:
    """Sections of the hot run over speed, blue up and red down."""
    n = SPEED(data["pinion_speed"].values)
    scale = MICROMETRE(float(data.attrs.get("length", 1.0)))
    for way, (words, colour) in enumerate((("section, up", COLD), ("section, down", HOT))):
        x = scale * data["section_x"].values[0, way]
        places = np.broadcast_to(n[:, None], x.shape)
        known = np.isfinite(x)
        if not known.any():
            continue
        at, up = thinned(
            x=places[known], y=x[known], scale=(float(np.ptp(n)), float(np.ptp(x[known])))
        )
        panel.points(at, up, colour=colour, marker="dot", edge_width=0.0, size=1.8, label=words)


def jumps(data: Dataset) -> list[str]:
    """The jumps of a run-up so far, in words: from where to where, at which speed."""
    found = []
    for way, words in enumerate(("up", "down")):
        fold = data["leap_fold"].values[0, way]
        for place, k in np.argwhere(np.isfinite(fold)):
            before, after = (
                MICROMETRE(float(data[f"leap_{n}"].values[0, way, place, k]))
                for n in ("before", "after")
            )
            kind = (
                "at a fold"
                if data["leap_kind"].values[0, way, place, k] == 0
                else ("at a subcritical period doubling")
            )
            found.append(
                f"running {words}: {SPEED(fold[place, k]):.1f} rpm, {kind}: "
                f"{number(before)} to {number(after)} µm peak to peak"
            )
    return found


def orbits(found: Mapping[str, Dataset]) -> Picture:
    """Phase plane with section, time history and spectrum of motions by where they come from."""
    x, v = "displacement x [µm]", axis_label("velocity")
    phase = Panel(Axis(x), Axis(v), "Phase plane, section at phase 0")
    history = Panel(Axis(axis_label("time")), Axis(x), "Time history")
    spectra = {name: one for name, one in found.items() if "line_amplitude" in one}
    for name, data in found.items():
        colour, of = STARTS.get(name, INK), int(data.attrs.get("mesh_periods", 1))
        t, at, speed = (shown(data, n) for n in ("time", "displacement", "velocity"))
        if of > 1:  # a closed orbit of many mesh periods
            part = slice(0, SHOWN * t.size // max(of * int(data["orbit_period"]), SHOWN))
            t, at, speed = t[part], at[part], speed[part]
            phase.title = history.title = f"{SHOWN} mesh periods of the turn of {of}"
        elif "order" in data:  # a closed orbit
            t = np.append(t, t[-1] + (t[1] - t[0]))
            at, speed = np.append(at, at[0]), np.append(speed, speed[0])
        phase.curve(at, speed, colour=colour, width=1.2, label=name)
        history.curve(t, at, colour=colour, width=1.2)
        phase.points(
            *thinned(
                x=shown(data, "section_displacement"), y=shown(data, "section_velocity"),
                scale=(float(np.ptp(at)), float(np.ptp(speed))),
            ),
            colour=colour, size=5.0, edge="white",
        )  # fmt: skip
    for edge in edges_in_sight(next(iter(found.values()))):
        phase.line(
            x=MICROMETRE(edge), colour=QUIET, width=1.0, dash=(4, 2), label="edge of the gap"
        )
        history.line(y=MICROMETRE(edge), colour=QUIET, width=1.0, dash=(4, 2))
    panels = [phase, history]
    if spectra:
        panels.append(_spectra(spectra))
    return Picture([panels], size=(11.4, 3.4), between=0.9, legend=4)


def _spectra(found: Mapping[str, Dataset]) -> Panel:
    ends = [
        floor_of(
            MICROMETRE(one["line_amplitude"].values),
            order=one["order"].values,
            highest=HIGHEST_ORDER,
        )
        for one in found.values()
    ]
    panel = over_orders(
        HALF_ORDERS, axis_label("line_amplitude", "amplitude of displacement"),
        floor=min(low for low, _ in ends), top=max(high for _, high in ends), highest=HIGHEST_ORDER,
    )  # fmt: skip
    panel.title = "Spectrum"
    for name, one in found.items():
        draw_lines(
            panel, order=one["order"].values, amplitude=MICROMETRE(one["line_amplitude"].values),
            colour=STARTS.get(name, INK), label="",
        )  # fmt: skip
    return panel


def told_mesh(data: Dataset) -> list[str]:
    """Stiffness, half backlash and jam in words."""
    found = []
    for place, state in enumerate(names_of(data, "state")):
        one = data.isel(state=place)
        status = STATUS[int(one["status"])]
        if not is_known(int(one["status"])):
            found.append(f"{state}: {STILL[status]}")
            continue
        stiff = f"mean stiffness {number(STIFFNESS(float(one['mean_stiffness'])), 4)}·10⁸ N/m"
        left = MICROMETRE(float(one["half_backlash"]))
        words = f"{state}: {stiff}; half backlash {number(left, 4)} µm"
        taken = MICROMETRE(float(data["half_backlash"].values[0])) - left
        if place and np.isfinite(taken):
            needed = number(2.0 * max(taken, 0.0), 4)
            words += f"; heat and speed take {number(taken, 4)} µm, so that {needed} µm of total"
            words += " backlash is needed"
        found.append(words + ("; jammed" if status == "jammed" else ""))
    jam = float(CELSIUS(data["jam_temperature"].values[-1]))
    if np.isfinite(jam) and jam < FAR:
        found.append(f"jams with the gears at {jam:.1f} °C, the other bodies as they are")
    return found
