"""The section with the temperature dial."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS, MICROMETRE, SPEED, STIFFNESS, number
from thermogear.base.vocabulary import STATUS, STILL, is_known
from thermogear.results.result import Result
from thermogear.views.moving import Dial
from thermogear.views.page import Pictures, Section
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.curves import axis_of
from thermogear.views.plots.motion import BEYOND, label_of, moving, orbit_of
from thermogear.views.plots.motion import SPEED as SPEED_AXIS
from thermogear.views.style import COLD, FAINT, HOT, INK, QUIET
from thermogear.views.typesetting import FAR, plain, shown

NAME = "dial"
NEEDS = ("mesh_stiffness", "half_backlash", "status")


def section(results: Result, pictures: Pictures) -> Section | None:
    """Stiffness, backlash and orbit over a dial of the gears' temperature; None without one."""
    data = results.group("dial")
    if data is None:
        return None
    values = [f"{number(float(CELSIUS(t)))} °C" for t in data["gear_temperature"].values]
    start = int(data.attrs["start"])
    turned = Dial(
        "temperature of both gears",
        values,
        [f"{t}: {told(data, i)}" for i, t in enumerate(values)],
        start,
        partial(at, data),
    )
    pictures.add(
        NAME, "Turn the temperature", caption(data, values[start]), data, NEEDS,
        partial(at, data, start), wide=True, dial=turned,
    )  # fmt: skip
    return Section("dial", "Over temperature", pictures.take())


def caption(data: Dataset, start: str) -> str:
    """Which operating point, and what is shown without the dial."""
    torque, speed = float(data.attrs["pinion_torque"]), SPEED(data.attrs["pinion_speed"])
    jammed = int(data.attrs["jammed"])
    whose = "Of the mean tooth. " * bool(data.attrs.get("mean_tooth", 0))
    some = f" {jammed} of {data.sizes['gear_temperature']} temperatures jam." if jammed else ""
    return (
        f"{whose}At {speed:.6g} rpm and {torque:.6g} N m, both gears at one temperature, the other "
        f"bodies as temperatures.follow says. A still picture shows {start}. Each orbit is settled "
        f"by itself: where several motions exist, another start may find another one.{some}"
    )


# --- pictures -----------------------------------------------------------------------------------


POINTS = 400


def at(data: Dataset, place: int) -> Picture:
    """Mesh stiffness, half backlash and orbit at the ``place``-th temperature of a dial.

    Faint: the other ends of the dial. All pictures of one dial have the same axes.
    """
    return Picture(
        [[_stiffness(data, place), _backlash(data, place), _orbit(data, place)]],
        size=(11.4, 3.5), between=0.95, legend=4,
    )  # fmt: skip


def told(data: Dataset, place: int) -> str:
    """What is found at one temperature, in words."""
    one = data.isel(gear_temperature=place)
    state = STATUS[int(one["status"])]
    if not is_known(int(one["status"])):
        return STILL[state]
    stiffness = f"mean stiffness {number(STIFFNESS(float(one['mean_stiffness'])))}·10⁸ N/m"
    left = f"half backlash {number(MICROMETRE(float(one['half_backlash'])))} µm"
    if state == "jammed":
        return f"{stiffness}; the pair is jammed"
    if state != "ok" or "label" not in data:
        return f"{stiffness}; {left}; {state.replace('_', ' ')}"
    return f"{stiffness}; {left}; {label_of(one)}"


def _stiffness(data: Dataset, place: int) -> Panel:
    panel = Panel(
        axis_of("mesh_phase", "mesh phase", low=0.0, high=1.0),
        axis_of("mesh_stiffness", low=0.0),
        "Mesh stiffness",
    )
    x = shown(data, "mesh_phase")
    values = shown(data.transpose("gear_temperature", ...), "mesh_stiffness")
    panel.y.high = 1.06 * float(np.nanmax(values))
    panel.curve(x, values[0], colour=COLD, width=1.0, opacity=0.5, label="coldest")
    panel.curve(x, values[-1], colour=HOT, width=1.0, opacity=0.5, label="hottest")
    panel.curve(x, values[place], colour=INK, label="here")
    return panel


def _backlash(data: Dataset, place: int) -> Panel:
    panel = Panel(
        axis_of("gear_temperature"), axis_of("half_backlash", "half backlash"), "Half backlash"
    )
    x, values = shown(data, "gear_temperature"), shown(data, "half_backlash")
    panel.curve(x, values, colour=QUIET, width=1.2, marker="circle", size=3.5)
    panel.line(y=0.0, colour=INK, width=0.9)
    jam = float(CELSIUS(data.attrs["jam_temperature"]))
    if np.isfinite(jam) and jam < min(FAR, float(x[-1])):
        panel.line(x=jam, colour=HOT, width=1.0, dash=(4, 2), label="jam")
    low, high = panel.extent("y")
    panel.y.low, panel.y.high = min(low, -0.1 * abs(high)), high
    panel.span(y=(panel.y.low, 0.0), colour=FAINT, opacity=0.5)
    panel.points([x[place]], [values[place]], colour=INK, size=9.0, label="here")
    return panel


def thin(count: int) -> NDArray[np.int64]:
    """Which of ``count`` points of an orbit a small panel shows, both ends among them."""
    return np.unique(np.linspace(0, count - 1, min(count, POINTS)).round().astype(int))


def _orbit(data: Dataset, place: int) -> Panel:
    panel = Panel(Axis(BEYOND), Axis(SPEED_AXIS), "Orbit")
    one = data.isel(gear_temperature=place)
    if "displacement" not in data or not moving(one):
        panel.note(plain(told(data, place)))
        return panel
    orbit, gap = orbit_of(one), 2.0 * MICROMETRE(float(one["half_backlash"]))
    loop = thin(orbit.loop)
    panel.curve(orbit.x[loop], orbit.v[loop], colour=INK, width=1.2, label="here")
    panel.points(orbit.section_x, orbit.section_v, colour=HOT, size=5.0, edge="white",
                 label="section at phase 0")  # fmt: skip
    panel.line(x=0.0, colour=QUIET, width=1.0, dash=(4, 2), label="edge of the gap")
    if float(orbit.x.min()) < -0.7 * gap:
        panel.line(x=-gap, colour=QUIET, width=1.0, dash=(1, 1.5), label="its back edge")
    return panel
