"""What a page shows of a whole turn of gears whose teeth differ."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MEGAPASCAL, MICROMETRE, MILLIMETRE, PERCENT, number, span
from thermogear.results.result import Result
from thermogear.results.tables import rows_along
from thermogear.views.columns import Column, declared, in_full, key
from thermogear.views.page import Shown, Table
from thermogear.views.plots.turn import error_of_turn, orders_of_turn, period_of, teeth_of_turn

MOST_LINES = 16
"""Lines of a table, the greatest; all are stored."""
TEETH_TOLD = 5
"""Teeth named in a caption."""

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
    Column("load carried, of the mean", "load_carried", 1, PERCENT),
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
ASSEMBLIES = (
    Column("wheel tooth at the pinion's mark", "wheel_tooth", key="wheel_tooth"),
    Column("under load", "peak_to_peak_error", 3, MICROMETRE),
    Column("without load", "unloaded_swing", 3, MICROMETRE),
    key("peak_to_peak_m", "peak_to_peak_error"),
    key("unloaded_peak_to_peak_m", "unloaded_swing"),
)


def figures(turn: Dataset) -> dict[str, float]:
    """Peak to peak [m] of the error under load, without, and of what repeats with the mesh."""
    names = ("transmission_error", "unloaded_error", "mesh_synchronous_error")
    return {name: float(np.ptp(turn[name].values)) for name in names}


def lines(turn: Dataset) -> list[dict[str, Any]]:
    """The greatest lines of the loaded error with their names."""
    period, order = period_of(turn), turn["order"].values
    greatest = np.argsort(turn["line_amplitude"].values)[::-1][:MOST_LINES]
    rows = rows_along(turn[["line_amplitude", "unloaded_line"]].isel(order=greatest), "order")
    return [
        {**row, "name": period.line(round(q * period.mesh_periods))}
        for row, q in zip(rows, order[greatest], strict=True)
    ]


def numbers(result: Result) -> dict[str, Any]:
    """What JSON holds of the turn; nothing where the teeth of each gear are alike."""
    if "turn" not in result.groups:
        return {}
    turn = result.groups["turn"]
    swings = {f"{name}_peak_to_peak_m": swing for name, swing in figures(turn).items()}
    found: dict[str, Any] = {
        "mesh_periods": int(turn.attrs["mesh_periods"]),
        "orders": period_of(turn).orders,
        "pinion_torque_Nm": float(turn.attrs["torque"]),
        **swings,
        "lines": [in_full(LINES, row) for row in lines(turn)],
        "teeth": [in_full(TEETH, row) for row in rows_along(result.groups["teeth"], "tooth")],
    }
    if "assemblies" in result.groups:
        ways = result.groups["assemblies"]
        found["assemblies"] = {
            "of": int(ways.attrs["of"]),
            "rows": [in_full(ASSEMBLIES, row) for row in rows_along(ways, "wheel_tooth")],
        }
    return {"turn": found}


def pictures(groups: Mapping[str, Dataset]) -> list[Shown]:
    """The error of the turn, its orders and its teeth."""
    if "turn" not in groups:
        return []
    turn, teeth = groups["turn"], groups["teeth"]
    return [
        Shown("turn", "Transmission error over the turn, hot", _of_error(turn),
              partial(error_of_turn, turn), wide=True),
        Shown("turn_orders", "Orders of the turn", _of_orders(turn),
              partial(orders_of_turn, turn), wide=True),
        Shown("turn_teeth", "Tooth by tooth", _of_teeth(teeth),
              partial(teeth_of_turn, teeth), wide=True),
    ]  # fmt: skip


def _of_error(turn: Dataset) -> str:
    loaded, unloaded, mesh = (number(MICROMETRE(swing)) for swing in figures(turn).values())
    of = turn.attrs["mesh_periods"]
    return (
        f"At {turn.attrs['torque']:.4g} N m: {loaded} µm peak to peak over the turn of {of} mesh "
        f"periods, {unloaded} µm without load. Of it {mesh} µm repeat in every mesh period: these "
        "are heard as the mesh, the rest as shaft orders and side lines. Numbers are those of the "
        "case file. Bands run from the least to the greatest of each mesh period."
    )


def _of_orders(turn: Dataset) -> str:
    told = [
        f"{row['name']} {number(MICROMETRE(row['line_amplitude']))} µm"
        for row in lines(turn)[:TEETH_TOLD]
    ]
    return (
        f"Greatest: {', '.join(told)}. Eccentricity stands at the order of its shaft; pitch errors "
        "spread over all shaft orders and lie beside the mesh."
    )


def _of_teeth(teeth: Dataset) -> str:
    told = []
    for gear in ("pinion", "wheel"):
        here = teeth.isel(tooth=np.flatnonzero(teeth["gear"].values == gear))
        far = MICROMETRE(here["index_error"].values)
        told.append(f"{gear} {span([far.min(), far.max()])} µm")
    pressure = np.nan_to_num(teeth["contact_pressure"].values)
    worst = teeth.isel(tooth=int(np.argmax(pressure)))
    return (
        f"Drive flanks at the pitch point, from the mean of the gear: {'; '.join(told)}. "
        "A flank that is early takes load from its neighbours. "
        f"The greatest pressure is on {worst['gear'].item()} tooth {int(worst['number'])}."
    )


def tables(groups: Mapping[str, Dataset]) -> tuple[list[Table], list[Table]]:
    """Tables that a terminal shows too, and those of the page alone."""
    if "turn" not in groups:
        return [], []
    turn, teeth = groups["turn"], groups["teeth"]
    loaded, unloaded, mesh = (number(MICROMETRE(swing)) for swing in figures(turn).values())
    first = [
        declared(
            f"Turn of {turn.attrs['mesh_periods']} mesh periods, hot, "
            f"{turn.attrs['torque']:.4g} N m: transmission error {loaded} µm peak to peak, "
            f"{unloaded} µm without load, {mesh} µm in every mesh period alike. Its greatest lines "
            "(amplitudes); all are stored.",
            LINES,
            lines(turn),
        )
    ]
    if "assemblies" in groups:
        ways = groups["assemblies"]
        first.append(
            declared(
                f"Error of the turn, peak to peak, by which teeth meet: wheel tooth against pinion "
                f"tooth {ways.attrs['pinion_tooth']}; {ways.sizes['wheel_tooth']} of "
                f"{ways.attrs['of']} assemblies, at the same temperatures.",
                ASSEMBLIES,
                rows_along(ways, "wheel_tooth"),
            )
        )
    every = declared(
        "Tooth by tooth. Index error: the drive flank at the pitch point along the line of action, "
        "from the mean of its gear, > 0 early, eccentricity included. The greatest pressure on the "
        "flank, with the distance from the pinion's tangent point and the mate; no pressure is "
        "known on a corner.",
        TEETH,
        rows_along(teeth, "tooth"),
        names=2,
    )
    return first, [every]
