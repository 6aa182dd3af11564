"""Pages of a drive train: its loads at rest, its modes, its critical speeds."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import exactly, number
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.results.result import Result
from thermogear.views.page import Page, Pictures, Section, Shown, Table
from thermogear.views.pages.survey import operating_rows, survey
from thermogear.views.plots import shafts as plots
from thermogear.views.style import names_of
from thermogear.views.typesetting import operating_names

if TYPE_CHECKING:
    import xarray as xr

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
        *([] if np.isnan(plots.internal_clearance(rings).values).all() else [_clearances(rings)]),
        Shown(
            "deflection",
            f"Deflection at {names[last]}",
            "Both shafts along their length: bending and what the bearings give.",
            partial(plots.deflection, lines, last),
            wide=True,
        ),
    ]
    tables = [_mesh_table(mesh, names), _ring_table(rings, names)]
    hottest = np.nanmax(rings["bearing_load"].values) if rings["bearing_load"].size else 0.0
    summary = (
        f"Bearings carry up to {number(float(hottest))} N; the centres move apart by up to "
        f"{1e6 * float(np.nanmax(mesh['centre_distance_growth'].values)):.1f} µm."
    )
    return survey(result, summary, pictures, tables, numbers=_static_numbers, lines=_static_lines)


def _clearances(rings: xr.Dataset) -> Shown:
    return Shown(
        "clearances",
        "Clearance of the bearings",
        "Radial internal clearance (ISO 5753-1) as mounted, cold and hot: the whole play. Below "
        "the dashed line the bearing is preloaded.",
        partial(plots.clearances, rings),
        wide=True,
    )


def _mesh_table(data: xr.Dataset, names: list[str]) -> Table:
    head = [
        "state", "operating point", "mesh force [N]", "teeth give [µm]", "centres apart [µm]",
        "contact ratio", "backlash [µm]", "flanks part across the face [µm]",
    ]  # fmt: skip
    rows = []
    for s, state in enumerate(names_of(data, "state")):
        for o, name in enumerate(names):
            one = data.isel(state=s, operating=o)
            rows.append(
                [
                    state,
                    name,
                    _told(one["mesh_force"], 1.0, 0),
                    _told(one["mesh_deflection"], 1e6, 2),
                    _told(one["centre_distance_growth"], 1e6, 2),
                    _told(one["contact_ratio"], 1.0, 4),
                    _told(one["backlash_at_shift"], 1e6, 1),
                    _told(one["misalignment_across_face"], 1e6, 2),
                ]
            )
    return Table("The mesh on its deflected shafts.", head, rows, names=2)


def _ring_table(data: xr.Dataset, names: list[str]) -> Table:
    head = [
        "state", "operating point", "bearing", "load [N]", "radial internal clearance [µm]",
        "journal moves [µm]", "stiffness x [N/µm]", "stiffness y [N/µm]", "inner ring [°C]",
        "outer ring [°C]", "static safety", "life L10 [h]",
    ]  # fmt: skip
    rows = []
    for s, state in enumerate(names_of(data, "state")):
        for o, name in enumerate(names):
            for b, bearing in enumerate(names_of(data, "bearing")):
                one = data.isel(state=s, operating=o, bearing=b)
                moved = float(np.hypot(one["journal_x"], one["journal_y"]))
                rows.append(
                    [
                        state,
                        name,
                        bearing,
                        _told(one["bearing_load"], 1.0, 0),
                        _told(plots.internal_clearance(one), 1e6, 2),
                        _told(moved, 1e6, 2),
                        _told(one["bearing_stiffness_x"], 1e-6, 1),
                        _told(one["bearing_stiffness_y"], 1e-6, 1),
                        _told(float(one["inner_ring_temperature"]) - ZERO_CELSIUS, 1.0, 1),
                        _told(float(one["outer_ring_temperature"]) - ZERO_CELSIUS, 1.0, 1),
                        _told(one["static_safety"], 1.0, 1),
                        _told(one["bearing_life"], 1.0 / 3600.0, 0),
                    ]
                )
    return Table("The bearings.", head, rows, names=3)


def _told(value: Any, factor: float, digits: int) -> str:
    if value is None:
        return "–"
    found = factor * float(value) + 0.0
    if abs(found) < 0.5 * 10.0**-digits:
        found = 0.0
    return f"{found:.{digits}f}" if np.isfinite(found) else "–"


def _static_numbers(result: Result) -> dict[str, Any]:
    mesh, rings = result.groups["statics"], result.groups["bearings"]
    found: dict[str, Any] = {"operating": operating_rows(mesh), "states": {}}
    for s, state in enumerate(names_of(mesh, "state")):
        one = mesh.isel(state=s)
        found["states"][state] = {
            f"{name}_{one[name].attrs['units'].replace('/', '_per_')}": _list(one[name].values)
            for name in mesh.data_vars
            if "units" in mesh[name].attrs
        }
        found["states"][state]["bearings"] = {
            bearing: {
                f"{name}_{rings[name].attrs['units'].replace('/', '_per_')}": _list(
                    rings[name].values[s, :, b]
                )
                for name in rings.data_vars
            }
            for b, bearing in enumerate(names_of(rings, "bearing"))
        }
    return found


def _list(values: Any) -> Any:
    return [None if not np.isfinite(v) else float(v) for v in np.ravel(values)]


def _static_lines(result: Result) -> list[str]:
    rings, mesh = result.groups["bearings"], result.groups["statics"]
    names = operating_names(mesh)
    found = []
    for o, name in enumerate(names):
        found.append(name)
        found.append(f"  {'bearing':<16}{'load [N]':>20}{'radial internal clearance [um]':>32}")
        for b, bearing in enumerate(names_of(rings, "bearing")):
            both = rings.isel(operating=o, bearing=b)
            load = " -> ".join(_told(v, 1.0, 0) for v in both["bearing_load"].values)
            gap = " -> ".join(_told(v, 1e6, 1) for v in plots.internal_clearance(both).values)
            found.append(f"  {bearing:<16}{load:>20}{gap:>32}")
        one = mesh.isel(operating=o)
        apart = " -> ".join(_told(v, 1e6, 2) for v in one["centre_distance_growth"].values)
        tilt = " -> ".join(_told(v, 1e6, 2) for v in one["misalignment_across_face"].values)
        found.append(f"  centres move apart {apart} um; flanks part across the face {tilt} um")
    return [f"undeformed -> hot, {len(names)} operating point{'s' * (len(names) > 1)}", *found]


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
    hertz = table["natural_frequency"].values / (2.0 * np.pi)
    rows = [
        [
            str(m + 1),
            *(f"{hertz[s, m]:.2f}" for s in range(len(states))),
            f"{100.0 * float(table['modal_damping_ratio'].values[last, m]):.2f}",
            f"{100.0 * float(table['mesh_share'].values[last, m]):.1f}",
            _told(table["pinion_whirl"].values[last, m], 1.0, 2),
            _told(table["wheel_whirl"].values[last, m], 1.0, 2),
            str(table["mode_name"].values[last, m]),
        ]
        for m in range(table.sizes["mode"])
    ]
    head = [
        "mode", *(f"{s} [Hz]" for s in states), "damping [%]", "energy in the mesh [%]",
        "whirl, pinion", "whirl, wheel", "mostly",
    ]  # fmt: skip
    torque, speed = (float(result.text(name)) for name in ("torque", "speed"))
    summary = (
        f"The lowest natural frequency is {hertz[last].min():.4g} Hz {states[last]}, at "
        f"{exactly(speed / RPM)} rpm and {exactly(torque)} N m."
    )
    return survey(
        result,
        summary,
        pictures,
        [Table("Natural frequencies and what they are.", head, rows)],
        numbers=_mode_numbers,
        lines=_mode_lines,
    )


def _mode_numbers(result: Result) -> dict[str, Any]:
    table = result.groups["modes"]
    return {
        "speed_rpm": float(result.text("speed")) / RPM,
        "torque_Nm": float(result.text("torque")),
        "states": {
            state: {
                "natural_frequency_Hz": _list(table["natural_frequency"].values[s] / (2 * np.pi)),
                "modal_damping_ratio": _list(table["modal_damping_ratio"].values[s]),
                "mesh_share": _list(table["mesh_share"].values[s]),
                "mostly": [str(v) for v in table["mode_name"].values[s]],
            }
            for s, state in enumerate(names_of(table, "state"))
        },
    }


def _mode_lines(result: Result) -> list[str]:
    table = result.groups["modes"]
    states = names_of(table, "state")
    hertz = table["natural_frequency"].values / (2.0 * np.pi)
    heads = "".join(f"{s + ' [Hz]':>18}" for s in states)
    found = [f"{'mode':>4}{heads}{'mesh [%]':>10}  mostly"]
    for m in range(table.sizes["mode"]):
        cells = "".join(f"{hertz[s, m]:>18.2f}" for s in range(len(states)))
        share = 100.0 * float(table["mesh_share"].values[-1, m])
        found.append(f"{m + 1:>4}{cells}{share:>10.1f}  {table['mode_name'].values[-1, m]}")
    return found


# --- critical speeds --------------------------------------------------------------------------


def criticals(result: Result) -> Iterator[dict[str, Any]]:
    """Critical speeds with their participation, by state and rising speed, that are not nil."""
    data, modes = result.groups["critical"], result.groups["campbell"]
    limit = float(modes["pinion_speed"].values[-1])
    for s, state in enumerate(names_of(data, "state")):
        found = []
        every, lifts = data["resonant_force"].values[s, 1], plots.lift_offs(data)[s, 1]
        inside = data["critical_speed"].values[s, 1] <= limit
        known = np.where(inside & np.isfinite(every), every, np.nan)
        most = float(np.nanmax(known, initial=0.0))
        for line, words in enumerate(names_of(data, "line")):
            low, mean, high = data["critical_speed"].values[s, :, line]
            share = data["participation"].values[s, 1, line]
            gain = data["amplification"].values[s, 1, line]
            force = data["resonant_force"].values[s, 1, line]
            for m in range(mean.size):
                lifted = bool(np.isfinite(lifts[line, m]))
                felt = lifted or force[m] >= FELT * most
                if (gain[m] >= NIL or felt) and low[m] <= limit:
                    found.append(
                        {
                            "state": state,
                            "order": words,
                            "mode": m + 1,
                            "rpm": mean[m] / RPM,
                            "rpm_least": low[m] / RPM,
                            "rpm_greatest": high[m] / RPM,
                            "frequency_Hz": mean[m] * float(data["order"].values[line]) / 2 / np.pi,
                            "participation": float(share[m]),
                            "amplification": float(gain[m]),
                            "bearing_force_N": float(force[m]) if np.isfinite(force[m]) else None,
                            "lifts_off_from_rpm": lifts[line, m] / RPM if lifted else None,
                            "mostly": str(modes["mode_name"].values[s, m]),
                        }
                    )
        yield from sorted(found, key=lambda one: one["rpm"])


def _force(one: dict[str, Any]) -> str:
    """The dynamic force of a resonance on a bearing [N], or why there is none."""
    if one["lifts_off_from_rpm"] is not None:
        return plots.not_valid(one["lifts_off_from_rpm"] * RPM)
    return _told(one["bearing_force_N"], 1.0, 1)


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
    head = [
        "state", "speed [rpm]", "over the mesh's stiffness [rpm]", "frequency [Hz]", "excited by",
        "mode", "bearing force [N]", "participation", "amplification", "mostly",
    ]  # fmt: skip
    rows = [
        [
            one["state"],
            f"{one['rpm']:.0f}",
            f"{one['rpm_least']:.0f} to {one['rpm_greatest']:.0f}",
            f"{one['frequency_Hz']:.1f}",
            one["order"],
            str(one["mode"]),
            _force(one),
            f"{one['participation']:.4f}",
            f"{one['amplification']:.2f}",
            one["mostly"],
        ]
        for one in found
    ]
    hot = [one for one in found if one["state"] == names_of(data, "state")[-1]]
    strong = max(hot, key=lambda one: one["bearing_force_N"] or 0.0, default=None)
    summary = "No order meets a mode it can drive in this range."
    if strong is not None:
        summary = (
            f"{len(hot)} critical speeds hot; the loudest at {strong['rpm']:.0f} rpm, where "
            f"{strong['order']} meets {strong['frequency_Hz']:.0f} Hz ({strong['mostly']}): "
            f"{_told(strong['bearing_force_N'], 1.0, 0)} N on a bearing."
        )
    lost = [one for one in hot if one["lifts_off_from_rpm"] is not None]
    if lost:
        first = min(lost, key=lambda one: one["lifts_off_from_rpm"])
        summary += (
            f" At {len(lost)} of them a bearing lifts off or the teeth part, first from "
            f"{first['lifts_off_from_rpm']:.0f} rpm on (that at {first['rpm']:.0f} rpm): no linear "
            "force is valid there."
        )
    caption = (
        "Critical speeds: where an order meets a mode that it lifts by 0.1 or more, or that shakes "
        "a bearing with a twentieth of the greatest such force. The force is that of the mode "
        "alone; the response has all of them together. Above its static load a bearing "
        "lifts off, or the teeth part, from the speed given on: the linear force is not valid."
    )
    table = Table(caption, head, rows)
    return survey(
        result, summary, pictures, [table], numbers=_critical_numbers, lines=_critical_lines
    )


def _critical_numbers(result: Result) -> dict[str, Any]:
    return {"torque_Nm": float(result.text("torque")), "critical": list(criticals(result))}


def _critical_lines(result: Result) -> list[str]:
    head = f"{'state':<12}{'rpm':>8}{'band [rpm]':>16}{'Hz':>9}{'force [N]':>38}{'rises':>7}"
    found = [f"{head}  by: mostly"]
    for one in criticals(result):
        band = f"{one['rpm_least']:.0f}..{one['rpm_greatest']:.0f}"
        found.append(
            f"{one['state']:<12}{one['rpm']:>8.0f}{band:>16}{one['frequency_Hz']:>9.1f}"
            f"{_force(one):>38}{one['amplification']:>7.2f}"
            f"  {one['order']}: {one['mostly']}"
        )
    return ["no order meets a mode it can drive in this range"] if len(found) == 1 else found
