"""Pages of a drive train: its loads at rest, its modes, its critical speeds."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from operator import itemgetter
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import (
    CELSIUS,
    HERTZ,
    HOUR,
    MICROMETRE,
    NEWTON,
    PER_MICROMETRE,
    PERCENT,
    SPEED,
    exactly,
    number,
)
from thermogear.results.files import finite
from thermogear.results.result import Result
from thermogear.views.columns import (
    OF_STATE,
    PLAIN,
    Column,
    Row,
    by_name,
    declared,
    in_full,
    key,
    rows_along,
)
from thermogear.views.page import Page, Pictures, Section, Shown, Table
from thermogear.views.pages.survey import operating_rows, survey
from thermogear.views.plots import shafts as plots
from thermogear.views.style import names_of
from thermogear.views.typesetting import operating_names

KINDS = ("statics", "modes", "campbell")
SKETCH = (
    "Both shafts to scale along their length, one centre distance apart; crossed boxes are "
    "bearings. Look here first: a slip in a position is seen at once."
)
FELT = 0.05
"""Of the greatest resonant force on a bearing, from which a critical speed is told."""
NIL = 0.1
"""Amplification below which a resonance does not rise over the load that drives it."""


def page(result: Result) -> Page:
    """The page of one of the three kinds."""
    return {"statics": _statics, "modes": _modes, "campbell": _campbell}[result.kind](result)


def _sketch(result: Result) -> Shown:
    said = result.table("train")
    return Shown("sketch", "The drive train", SKETCH, partial(plots.sketch, said), wide=True)


def section(result: Result, pictures: Pictures) -> Section | None:
    """The sketch of a run's drive train; None where the case draws none."""
    if not result.table("train"):
        return None
    pictures.found.append(_sketch(result))
    return Section("train", "Shafts and bearings", pictures.take())


# --- loads at rest ----------------------------------------------------------------------------


def _statics(result: Result) -> Page:
    mesh, rings = result.groups["statics"], result.groups["bearings"]
    lines = result.groups["deflection"]
    names = operating_names(mesh)
    last = mesh.sizes["operating"] - 1
    pictures = [
        _sketch(result),
        Shown(
            "loads",
            "Bearing loads",
            "Static load of every bearing at every operating point: mesh force by lever arms, "
            "weight, and what more than two bearings share by stiffness.",
            partial(plots.loads, rings),
            wide=True,
        ),
        *(
            []
            if np.isnan(rings["radial_internal_clearance"].values).all()
            else [_clearances(rings)]
        ),
        Shown(
            "deflection",
            f"Deflection at {names[last]}",
            "Both shafts along their length: bending and what the bearings give.",
            partial(plots.deflection, lines, last),
            wide=True,
        ),
    ]
    hottest = np.nanmax(rings["bearing_load"].values) if rings["bearing_load"].size else 0.0
    summary = (
        f"Bearings carry up to {number(float(hottest))} N; the centres move apart by up to "
        f"{MICROMETRE(float(np.nanmax(mesh['centre_distance_growth'].values))):.1f} µm."
    )
    return survey(
        result, summary, pictures, _static_tables(result), numbers=partial(_static_numbers, result)
    )


def _clearances(rings: Dataset) -> Shown:
    return Shown(
        "clearances",
        "Clearance of the bearings",
        "Radial internal clearance (ISO 5753-1) as mounted, cold and hot: the whole play. Below "
        "the dashed line the bearing is preloaded.",
        partial(plots.clearances, rings),
        wide=True,
    )


MESH = (
    *OF_STATE,
    Column("mesh force", "mesh_force", ".0f", NEWTON),
    Column("teeth give", "mesh_deflection", ".2f", MICROMETRE),
    Column("centres apart", "centre_distance_growth", ".2f", MICROMETRE),
    Column("contact ratio", "contact_ratio", ".4f"),
    Column("backlash", "backlash_at_shift", ".1f", MICROMETRE),
    Column("flanks part across the face", "misalignment_across_face", ".2f", MICROMETRE),
)
RINGS = (
    *OF_STATE,
    Column("bearing", "bearing"),
    Column("load", "bearing_load", ".0f", NEWTON),
    Column("radial internal clearance", "clearance", ".2f", MICROMETRE),
    Column(
        "journal moves", lambda row: np.hypot(row["journal_x"], row["journal_y"]), ".2f", MICROMETRE
    ),
    Column("stiffness x", "bearing_stiffness_x", ".1f", PER_MICROMETRE),
    Column("stiffness y", "bearing_stiffness_y", ".1f", PER_MICROMETRE),
    Column("inner ring", "inner_ring_temperature", ".1f", CELSIUS),
    Column("outer ring", "outer_ring_temperature", ".1f", CELSIUS),
    Column("static safety", "static_safety", ".1f"),
    Column("life L10", "bearing_life", ".0f", HOUR),
)


def _static_tables(result: Result) -> list[Table]:
    rings = result.groups["bearings"]
    rings = rings.assign(clearance=rings["radial_internal_clearance"])
    of_mesh = rows_along(result.groups["statics"], "state", "operating")
    of_rings = rows_along(rings, "state", "operating", "bearing")
    return [
        declared("The mesh on its deflected shafts.", MESH, of_mesh, names=2),
        declared("The bearings.", RINGS, of_rings, names=3),
    ]


def _static_numbers(result: Result) -> dict[str, Any]:
    mesh, rings = result.groups["statics"], result.groups["bearings"]
    at_rings = by_name(rings, _stored(rings), "state", "bearing")
    return {
        "operating": operating_rows(mesh),
        "states": {
            state: {**figures, "bearings": at_rings[state]}
            for state, figures in by_name(mesh, _stored(mesh), "state").items()
        },
    }


def _stored(data: Dataset) -> list[Column]:
    """Every variable with a unit, its unit in the name."""
    return [
        key(f"{name}_{variable.attrs['units'].replace('/', '_per_')}", str(name))
        for name, variable in data.data_vars.items()
        if "units" in variable.attrs
    ]


# --- modes ------------------------------------------------------------------------------------


def _modes(result: Result) -> Page:
    table, shapes = result.groups["modes"], result.groups["shapes"]
    states = names_of(table, "state")
    last = len(states) - 1
    pictures = [
        _sketch(result),
        Shown(
            "modes",
            f"The lowest modes, {states[last]}",
            "Full lines: deflection across the shaft in its larger direction; dashed: twist times "
            "base radius. All over the largest movement of the mode.",
            partial(plots.modes, table, shapes, last),
            wide=True,
        ),
        Shown(
            "energies",
            f"Which part gives, {states[last]}",
            "Share of each part in the strain energy of each mode, in per cent. A mode with energy "
            "in the mesh is one that the teeth drive and hear.",
            partial(plots.energies, table, last),
            wide=True,
        ),
    ]
    hertz = {
        state: table["natural_frequency"].isel(state=s, drop=True) for s, state in enumerate(states)
    }
    columns = (
        Column("mode", "mode"),
        *(Column(state, state, ".2f", HERTZ) for state in states),
        Column("damping", "modal_damping_ratio", ".2f", PERCENT),
        Column("energy in the mesh", "mesh_share", ".1f", PERCENT),
        Column("whirl, pinion", "pinion_whirl", ".2f"),
        Column("whirl, wheel", "wheel_whirl", ".2f"),
        Column("mostly", "mode_name"),
    )
    torque, speed = (float(result.text(name)) for name in ("torque", "speed"))
    summary = (
        f"The lowest natural frequency is {float(HERTZ(hertz[states[last]].min())):.4g} Hz "
        f"{states[last]}, at {exactly(SPEED(speed))} rpm and {exactly(torque)} N m."
    )
    rows = rows_along(table.isel(state=last).assign(hertz), "mode")
    tables = [declared("Natural frequencies and what they are.", columns, rows)]
    return survey(
        result,
        summary,
        pictures,
        tables,
        numbers=lambda: {
            "speed_rpm": SPEED(speed),
            "torque_Nm": torque,
            "states": by_name(table, IN_JSON, "state"),
        },
    )


IN_JSON = (
    key("natural_frequency_Hz", "natural_frequency", HERTZ),
    key("modal_damping_ratio"),
    key("mesh_share"),
    key("mostly", "mode_name"),
)


# --- critical speeds --------------------------------------------------------------------------


def criticals(result: Result) -> Iterator[dict[str, Any]]:
    """Critical speeds with their participation, by state and rising speed, that are not nil."""
    data, modes = result.groups["critical"], result.groups["campbell"]
    limit = float(modes["pinion_speed"].values[-1])
    low, mean, high = (data.isel(stiffness_level=level, drop=True) for level in range(3))
    force = mean["resonant_force"]
    inside = force.where((mean["critical_speed"] <= limit) & np.isfinite(force))
    every = mean.assign(
        low=low["critical_speed"],
        high=high["critical_speed"],
        lift_off=(force.dims, data["lift_off_speed"].values[:, 1]),
        greatest_force=inside.max(["line", "mode"]).fillna(0.0),
        mode_name=modes["mode_name"],
        place=("state", np.arange(data.sizes["state"])),
    )
    rows = rows_along(every, "state", "line", "mode")
    for row in sorted(rows, key=lambda row: (row["place"], row["critical_speed"])):
        lifted = np.isfinite(row["lift_off"])
        felt = lifted or row["resonant_force"] >= FELT * row["greatest_force"]
        if (row["amplification"] >= NIL or felt) and row["low"] <= limit:
            frequency = row["critical_speed"] * row["order"]
            yield {**row, "frequency": frequency, "lift_off": row["lift_off"] if lifted else None}


def _force(row: Row) -> float | str | None:
    """The dynamic force of a resonance on a bearing [N], or why there is none."""
    lift_off = row["lift_off"]
    return row["resonant_force"] if lift_off is None else plots.not_valid(lift_off)


CRITICAL = (
    Column("state", "state", key="state"),
    Column("speed", "critical_speed", ".0f", SPEED, "rpm"),
    Column(
        "over the mesh's stiffness [rpm]",
        lambda row: f"{SPEED(row['low']):.0f} to {SPEED(row['high']):.0f}",
    ),
    Column("frequency", "frequency", ".1f", HERTZ, "frequency_Hz"),
    Column("excited by", "line", key="order"),
    Column("mode", "mode", key="mode"),
    Column("bearing force", _force, ".1f", NEWTON),
    Column("participation", "participation", ".4f", PLAIN, "participation"),
    Column("amplification", "amplification", ".2f", PLAIN, "amplification"),
    Column("mostly", "mode_name", key="mostly"),
    key("rpm_least", "low", SPEED),
    key("rpm_greatest", "high", SPEED),
    key("bearing_force_N", "resonant_force"),
    key("lifts_off_from_rpm", "lift_off", SPEED),
)


def _campbell(result: Result) -> Page:
    data, critical = result.groups["campbell"], result.groups["critical"]
    answer = result.groups["response"]
    own = [float(v) for v in result.values("speeds")]
    found = list(criticals(result))
    pictures = [
        _sketch(result),
        Shown(
            "campbell",
            "Campbell diagram",
            "Natural frequencies (black; the grey band is the mesh stiffness from its least to its "
            "greatest), the orders that excite them, and a dot where an order meets a mode "
            "and shakes a bearing: the larger, the more, the largest where one lifts off or the "
            "teeth part. Dashed uprights are the case's speeds.",
            partial(plots.campbell, data, critical, own),
            wide=True,
        ),
        Shown(
            "bearing_forces",
            "Dynamic bearing forces over speed",
            "Amplitude by the loaded transmission error, by unbalance and by run-out, linear; hot "
            "full, undeformed dashed. A curve ends where a bearing would lift off or the teeth "
            "part.",
            partial(plots.response, answer, "bearing_force", "force [N]"),
            wide=True,
        ),
    ]
    if np.nanmax(np.abs(answer["ring_acceleration_x"].values), initial=0.0) > 0.0:
        pictures.append(
            Shown(
                "accelerations",
                "Acceleration of the bearing rings over speed",
                "What a sensor on the bearing's housing would show of each source.",
                partial(plots.response, answer, "ring_acceleration", "acceleration [m/s²]"),
                wide=True,
            )
        )
    hot = [one for one in found if one["state"] == names_of(data, "state")[-1]]
    strong = max(hot, key=lambda row: finite(row["resonant_force"]) or 0.0, default=None)
    summary = "No order meets a mode it can drive in this range."
    if strong is not None:
        summary = (
            f"{len(hot)} critical speeds hot; the loudest at {SPEED(strong['critical_speed']):.0f} "
            f"rpm, where {strong['line']} meets {HERTZ(strong['frequency']):.0f} Hz "
            f"({strong['mode_name']}): "
            f"{Column('', 'resonant_force', '.0f').cell(strong)} N on a bearing."
        )
    lost = [one for one in hot if one["lift_off"] is not None]
    if lost:
        first = min(lost, key=itemgetter("lift_off"))
        summary += (
            f" At {len(lost)} of them a bearing lifts off or the teeth part, first from "
            f"{SPEED(first['lift_off']):.0f} rpm on (that at {SPEED(first['critical_speed']):.0f} "
            "rpm): no linear force is valid there."
        )
    caption = (
        "Critical speeds: where an order meets a mode that it lifts by 0.1 or more, or that shakes "
        "a bearing with a twentieth of the greatest such force. The force is that of the mode "
        "alone; the response has all of them together. Above its static load a bearing "
        "lifts off, or the teeth part, from the speed given on: the linear force is not valid."
    )
    return survey(
        result,
        summary,
        pictures,
        [declared(caption, CRITICAL, found)],
        numbers=lambda: {
            "torque_Nm": float(result.text("torque")),
            "critical": [in_full(CRITICAL, row) for row in found],
        },
    )
