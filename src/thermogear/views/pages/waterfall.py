"""The page of a drive train's run-up."""

from __future__ import annotations

import json
from functools import partial
from operator import itemgetter
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import HERTZ, NEWTON, SPEED, number
from thermogear.base.vocabulary import STATUS, STILL
from thermogear.results.result import Result
from thermogear.views.columns import Column, Row, by_name, declared, in_full, key, rows_along
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages.survey import survey
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.shafts import not_valid
from thermogear.views.plots.sweeps import edges
from thermogear.views.style import INK, QUIET, STATES, WIDE, scale

KINDS = ("waterfall",)
OVER = (
    "Vibration at the end of every step of speed. Full lines run up, dashed ones down. Dotted: "
    "critical speeds of the linear train, hot, that a bearing feels."
)
LINES = (
    "Orders of the mesh frequency over speed, running up: a resonance is bright where its order "
    "passes it; half orders stand for a motion of two mesh periods."
)


def page(result: Result) -> Page:
    """Vibration over speed both ways, order waterfalls, jumps and critical speeds."""
    data = result.data
    made = [("speed", "Vibration over speed", OVER, partial(over_speed, data))]
    if data.sizes["pinion_speed"] > 1:
        made.append(("orders", "Bearing forces by order", LINES, partial(lines, data, 0)))
        if np.isfinite(data["housing_line"].values).any():
            made.append(("sound", "Housing by order", LINES, partial(sound, data, 0)))
    pictures = [Shown(*one, wide=True) for one in made]
    tables = [jumps(data), _critical(data)]
    return survey(result, summary(data), pictures, tables, numbers=partial(numbers, data))


def summary(data: Dataset) -> str:
    """What was found, in a sentence or two."""
    speeds = SPEED(data["pinion_speed"].values)
    rms = data["mesh_force_rms"].values
    if not np.isfinite(rms).any():
        why = [STILL[STATUS[code]] for code in np.unique(data["status"].values)]
        return f"No state of heat moves: {'; '.join(why)}."
    place = np.unravel_index(int(np.nanargmax(rms)), rms.shape)
    state = states_of(data)[place[0]]
    way = ("up", "down")[place[1]]
    count = int(data["apart_held"].values.sum())
    jumps = f"two motions on {count} stretch{'es' * (count != 1)}" if count else "no jump"
    return (
        f"The teeth vibrate most at {speeds[place[2]]:.6g} rpm, {state}, running {way}: "
        f"{number(float(rms[place]))} N rms; {jumps} between {speeds[0]:.6g} and "
        f"{speeds[-1]:.6g} rpm."
    )


APART = (
    Column("state", "apart_state", key="state"),
    Column("from", "apart_from", ".6g", SPEED, "from_rpm"),
    Column("to", "apart_to", ".6g", SPEED, "to_rpm"),
    Column("most at", "apart_at", ".6g", SPEED, "at_rpm"),
    Column("of", "apart_part", key="of"),
    Column("up, rms", "apart_up", 3, NEWTON, "up_rms_N"),
    Column("down, rms", "apart_down", 3, NEWTON, "down_rms_N"),
    Column(
        "because of",
        lambda row: "two motions" if row["apart_held"] else "the rate of the run",
        key="because_of",
    ),
)


def _apart(data: Dataset) -> list[dict[str, Any]]:
    """The stretches on which the ways up and down differ, with the words of states and parts."""
    states = np.array(states_of(data))[data["apart_state"].values]
    parts = np.array(["mesh force", *json.loads(data.attrs["bearing_names"])])
    parts = parts[data["apart_part"].values]
    named = data.assign(apart_state=("stretch", states), apart_part=("stretch", parts))
    return rows_along(named, "stretch")


def jumps(data: Dataset) -> Table:
    """The stretches of speed on which the ways up and down differ."""
    rows = _apart(data)
    return declared(
        "Where up and down differ." if rows else "Up and down agree: no jump.", APART, rows
    )


def _force(row: Row) -> float | str:
    """The force of a resonance on a bearing [N], or from which speed on none is valid."""
    lift_off = row.get("lift_off", np.nan)
    return not_valid(lift_off) if np.isfinite(lift_off) else row["force"]


CRITICAL = (
    Column("state", "state"),
    Column("order", "order"),
    Column("speed", "speed", ".5g", SPEED),
    Column("mode", "frequency", ".5g", HERTZ),
    Column("mostly", "mostly"),
    Column("force on a bearing", _force, 3, NEWTON),
)


def _critical(data: Dataset) -> Table:
    low, high = data["pinion_speed"].values[[0, -1]]
    rows = [
        {"state": state, **resonance}
        for state, found in zip(states_of(data), json.loads(data.attrs["critical"]), strict=True)
        for resonance in sorted(found, key=itemgetter("speed"))
        if low <= resonance["speed"] <= high
    ]
    return declared("Critical speeds of the linear train within the run.", CRITICAL, rows, names=2)


IN_JSON = (
    key("mesh_force_rms_N", "mesh_force_rms"),
    key("mesh_force_max_N", "mesh_force_max"),
    key("contact_loss_share"),
    key("bearing_force_max_N", lambda data: np.nanmax(data["bearing_force_max"].values, axis=1)),
    key("housing_rms_m_per_s2", "housing_rms"),
)


def numbers(data: Dataset) -> dict[str, Any]:
    """The figures of a run-up, JSON-ready."""
    return {
        "speeds_rpm": SPEED(data["pinion_speed"].values).tolist(),
        **by_name(data, IN_JSON, "state", "direction"),
        "apart": [in_full(APART, row) for row in _apart(data)],
    }


# --- pictures -----------------------------------------------------------------------------------


LEAST = 1e-4
"""Of the greatest line, below which nothing is told apart."""
LEAST_FORCE = 0.1
"""Of the greatest resonant force on a bearing, from which a critical speed is drawn."""
WAYS = ((0, "up", ()), (1, "down", (4.0, 3.0)))


def over_speed(data: Dataset) -> Picture:
    """Vibration of the mesh force, the bearings and the housing over speed, up and down."""
    rpm = SPEED(data["pinion_speed"].values)
    panels = []
    wanted = [
        ("mesh_force_rms", "mesh force, rms [N]"),
        ("bearing_force_rms", "bearing force, rms [N]"),
        ("housing_rms", "housing, rms [m/s²]"),
        ("contact_loss_share", "out of contact [%]"),
    ]
    for name, words in wanted:
        values = data[name].values
        if name == "bearing_force_rms":
            values = np.nanmax(values, axis=-1)
        if not np.isfinite(values).any() or (name == "contact_loss_share" and not values.any()):
            continue
        panel = Panel(Axis(""), Axis(words))
        factor = 100.0 if name == "contact_loss_share" else 1.0
        for s, state in enumerate(states_of(data)):
            for d, way, dash in WAYS:
                panel.curve(
                    rpm, factor * values[s, d], colour=STATES.get(state, INK), dash=dash,
                    width=1.3, label=f"{state}, {way}",
                )  # fmt: skip
        for speed in critical(data):
            panel.line(x=SPEED(speed), colour=QUIET, width=0.8, dash=(1.0, 2.5))
        panels.append([panel])
    panels[-1][0].x = Axis("pinion speed [rpm]")
    size = (WIDE, 1.9 * len(panels) + 0.9)
    return Picture(panels, size=size, above=0.2, share_x="column", legend=4)


def states_of(data: Dataset) -> list[str]:
    """Names of the states of heat."""
    return [str(one) for one in json.loads(data.attrs["state_names"])]


def critical(data: Dataset) -> list[float]:
    """Critical speeds [rad/s] of the last state within the run that a bearing feels."""
    rows = [one for one in json.loads(data.attrs.get("critical", "[]")) if one]
    if not rows:
        return []
    speeds = data["pinion_speed"].values
    inside = [one for one in rows[-1] if speeds[0] <= one["speed"] <= speeds[-1]]
    known = [one["force"] for one in inside if np.isfinite(one["force"])]
    least = LEAST_FORCE * max(known, default=0.0)
    return sorted(
        {one["speed"] for one in inside if not np.isfinite(one["force"]) or one["force"] >= least}
    )


def lines(data: Dataset, direction: int) -> Picture:
    """Largest line of any bearing's force over speed and order, one panel a state."""
    values = np.nanmax(data["bearing_force_line"].values[:, direction], axis=2)
    return _field(data, values, "line of bearing force [N]")


def sound(data: Dataset, direction: int) -> Picture:
    """Lines of the housing's acceleration over speed and order, one panel a state."""
    return _field(data, data["housing_line"].values[:, direction], "acceleration [m/s²]")


def _field(data: Dataset, values: Floats, words: str) -> Picture:
    rpm, order = SPEED(data["pinion_speed"].values), data["order"].values
    # halves alone: the shafts' own orders lie too near for cells
    half = np.isclose(2.0 * order, np.round(2.0 * order))
    top = float(np.nanmax(values[..., half], initial=1e-12))
    panels = []
    for s, state in enumerate(states_of(data)):
        panel = Panel(Axis("pinion speed [rpm]"), Axis("order of the mesh frequency [–]"), state)
        shown = np.clip(np.nan_to_num(values[s][:, half], nan=LEAST * top), LEAST * top, None)
        panel.field(
            edges(rpm), edges(order[half]), shown.T, low=LEAST * top, high=top, log=True,
            colours=scale("magma"), words=words,
        )  # fmt: skip
        panels.append(panel)
    return Picture([panels], size=(WIDE, 4.4), share_y="row")
