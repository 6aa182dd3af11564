"""The page of a drive train's run-up."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import number
from thermogear.base.units import RPM
from thermogear.base.vocabulary import STATUS, STILL
from thermogear.results.result import Result
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages.survey import survey
from thermogear.views.plots import waterfall as plots
from thermogear.views.plots.shafts import not_valid

if TYPE_CHECKING:
    import xarray as xr

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
    made = [("speed", "Vibration over speed", OVER, partial(plots.over_speed, data))]
    if data.sizes["pinion_speed"] > 1:
        made.append(("orders", "Bearing forces by order", LINES, partial(plots.lines, data, 0)))
        if np.isfinite(data["housing_line"].values).any():
            made.append(("sound", "Housing by order", LINES, partial(plots.sound, data, 0)))
    pictures = [Shown(*one, wide=True) for one in made]
    tables = [_jumps(data), _critical(data)]
    return survey(result, summary(data), pictures, tables, numbers=numbers, lines=lines)


def summary(data: xr.Dataset) -> str:
    """What was found, in a sentence or two."""
    speeds = data["pinion_speed"].values / RPM
    rms = data["mesh_force_rms"].values
    if not np.isfinite(rms).any():
        why = [STILL[STATUS[code]] for code in np.unique(data["status"].values)]
        return f"No state of heat moves: {'; '.join(why)}."
    place = np.unravel_index(int(np.nanargmax(rms)), rms.shape)
    state = plots.states_of(data)[place[0]]
    way = ("up", "down")[place[1]]
    count = int(data["apart_held"].values.sum())
    jumps = f"two motions on {count} stretch{'es' * (count != 1)}" if count else "no jump"
    return (
        f"The teeth vibrate most at {speeds[place[2]]:.6g} rpm, {state}, running {way}: "
        f"{number(float(rms[place]))} N rms; {jumps} between {speeds[0]:.6g} and "
        f"{speeds[-1]:.6g} rpm."
    )


def _apart(data: xr.Dataset) -> list[dict[str, Any]]:
    """The stretches on which the ways up and down differ."""
    states = plots.states_of(data)
    parts = ["mesh force", *json.loads(data.attrs["bearing_names"])]
    stretches = [data.isel(stretch=i) for i in range(data.sizes["stretch"])]
    return [
        {
            "state": states[int(one["apart_state"])],
            **{f"{end}_rpm": float(one[f"apart_{end}"]) / RPM for end in ("from", "to", "at")},
            "of": parts[int(one["apart_part"])],
            "up_rms_N": float(one["apart_up"]),
            "down_rms_N": float(one["apart_down"]),
            "because_of": "two motions" if int(one["apart_held"]) else "the rate of the run",
        }
        for one in stretches
    ]


def _shown(stretch: dict[str, Any]) -> list[str]:
    """One of them as the cells of a table."""
    digits = {"rpm": "{:.6g}".format, "N": number}
    return [
        value if isinstance(value, str) else digits[name.rpartition("_")[2]](value)
        for name, value in stretch.items()
    ]


def _jumps(data: xr.Dataset) -> Table:
    rows = [_shown(one) for one in _apart(data)]
    head = [
        "state", "from [rpm]", "to [rpm]", "most at [rpm]", "of", "up, rms [N]", "down, rms [N]",
        "because of",
    ]  # fmt: skip
    title = "Where up and down differ." if rows else "Up and down agree: no jump."
    return Table(title, head, rows)


def _critical(data: xr.Dataset) -> Table:
    states = plots.states_of(data)
    low, high = data["pinion_speed"].values[[0, -1]]
    rows = []
    for state, found in zip(states, json.loads(data.attrs["critical"]), strict=True):
        for one in sorted(found, key=lambda c: c["speed"]):
            if low <= one["speed"] <= high:
                force = one["force"]
                told = number(force) if force is not None and np.isfinite(force) else "–"
                if np.isfinite(one.get("lift_off", np.nan)):
                    told = not_valid(one["lift_off"])
                speed = f"{one['speed'] / RPM:.5g}"
                hertz = f"{one['frequency'] / (2.0 * np.pi):.5g}"
                rows.append([state, one["order"], speed, hertz, one["mostly"], told])
    head = ["state", "order", "speed [rpm]", "mode [Hz]", "mostly", "force on a bearing [N]"]
    return Table("Critical speeds of the linear train within the run.", head, rows, names=2)


def numbers(result: Result) -> dict[str, Any]:
    """The figures of a run-up, JSON-ready."""
    data = result.data
    found: dict[str, Any] = {"speeds_rpm": (data["pinion_speed"].values / RPM).tolist()}
    for s, state in enumerate(plots.states_of(data)):
        found[state] = {}
        for d, way in enumerate(("up", "down")):
            one = data.isel(state=s, direction=d)
            found[state][way] = {
                "mesh_force_rms_N": one["mesh_force_rms"].values.tolist(),
                "mesh_force_max_N": one["mesh_force_max"].values.tolist(),
                "contact_loss_share": one["contact_loss_share"].values.tolist(),
                "bearing_force_max_N": np.nanmax(one["bearing_force_max"].values, axis=1).tolist(),
                "housing_rms_m_per_s2": one["housing_rms"].values.tolist(),
            }
    return found | {"apart": _apart(data)}


def _span(low: str, high: str) -> str:
    return low if low == high else f"{low} to {high}"


def lines(result: Result) -> list[str]:
    """What the terminal tells."""
    data = result.data
    told = [
        f"  {row[0]}, {_span(row[1], row[2])} rpm: {row[4]} {row[5]} N rms up, {row[6]} N "
        f"down, because of {row[7]}"
        for row in map(_shown, _apart(data))
    ]
    return [summary(data), *told]
