"""The page of a tip relief: the relieved pair against the unrelieved one."""

from __future__ import annotations

from functools import partial

import numpy as np

from thermogear.base.arrays import DataArray, Dataset
from thermogear.base.display import CELSIUS, MICROMETRE, MILLIMETRE, STIFFNESS, Display, exactly
from thermogear.results.result import Result
from thermogear.views.columns import Column, declared
from thermogear.views.page import Code, Page, Shown, Text
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import survey
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, INK, names_of

KINDS = ("relief",)


def page(result: Result) -> Page:
    """The relief found, beside the unrelieved pair."""
    torque, paste = float(result.text("torque")), result.text("paste")
    before, after = (
        MICROMETRE(float(result.text("unrelieved"))),
        MICROMETRE(float(result.text("relieved"))),
    )
    hot = [CELSIUS(float(result.text(f"{gear}_addendum"))) for gear in ("pinion", "wheel")]
    summary = (
        f"Made for {exactly(torque)} N m with teeth at {hot[0]:.0f} °C (pinion) and "
        f"{hot[1]:.0f} °C (wheel): the transmission error goes from {before:.2f} to {after:.2f} "
        f"um peak to peak, by {result.text('evaluations')} evaluations of the mesh period."
    )
    pictures = [
        Shown(
            "error",
            "Transmission error over a mesh period",
            words.relief_error(result.groups["error"]),
            partial(error, result.groups["error"]),
        ),
        Shown(
            "stiffness",
            "Tangent stiffness over a mesh period",
            words.relief_stiffness(result.groups["error"]),
            partial(stiffness, result.groups["error"]),
        ),
        Shown(
            "loads",
            "What the relief does at other loads",
            words.relief_loads(result.groups["loads"]),
            partial(over_load, result.groups["loads"], torque),
        ),
    ]
    columns = (
        Column("gear", "gear"),
        Column("amount", "amount_m", ".3f", MICROMETRE),
        Column("length", "length_m", ".4f", MILLIMETRE),
        Column("shape", "shape"),
    )
    rows = [{"gear": gear, **row} for gear, row in result.table("reliefs").items()]
    table = declared("Tip relief; lengths along the line of action.", columns, rows)
    helps = any(row["amount_m"] > 0.0 for row in rows)
    if not helps:
        summary += " No tip relief makes it more even: none is proposed."
    return survey(
        result,
        summary,
        pictures,
        [table] * helps,
        numbers=lambda: {
            "torque_Nm": torque,
            **{f"{name}_m": float(result.text(name)) for name in ("unrelieved", "relieved")},
            "evaluations": int(result.text("evaluations")),
            "reliefs": result.table("reliefs"),
            "edge_contact_share": dict(result.groups["error"]["edge_contact_share"].to_series()),
            "paste": paste,
        },
        told=[
            table,
            Text("# for the case file, in place of tip reliefs it has already"),
            Code(paste),
        ]
        * helps,
        code=paste * helps,
    )


# --- pictures -----------------------------------------------------------------------------------


COLOURS = {"unrelieved": COLD, "relieved": HOT}


def error(data: Dataset) -> Picture:
    """Static transmission error over a mesh period at the design load, mean taken off."""
    panel = Panel(
        Axis("mesh phase φ [–]", low=0.0, high=1.0), Axis("transmission error, mean removed [µm]")
    )
    x = data["mesh_phase"].values
    for place, name in enumerate(names_of(data, "pair_kind")):
        values = MICROMETRE(data["transmission_error"].values[place])
        label = f"{name}, {float(np.ptp(values)):.2f} µm peak to peak"
        panel.curve(x, values - values.mean(), colour=COLOURS.get(name, INK), label=label)
    return Picture([[panel]], legend=1)


def stiffness(data: Dataset) -> Picture:
    """Tangent stiffness over a mesh period at the design load."""
    panel = Panel(
        Axis("mesh phase φ [–]", low=0.0, high=1.0),
        Axis("tangent mesh stiffness [10⁸ N/m]", low=0.0),
    )
    _pairs(panel, data["mesh_phase"], data["tangent_stiffness"], STIFFNESS)
    return Picture([[panel]], legend=2)


def over_load(data: Dataset, design: float) -> Picture:
    """Peak-to-peak error over the torque, the design torque marked."""
    panel = Panel(
        Axis("pinion torque [N m]", low=0.0), Axis("transmission error, peak to peak [µm]", low=0.0)
    )
    _pairs(panel, data["load"], data["peak_to_peak_error"], MICROMETRE)
    panel.line(x=design, colour=INK, width=0.9, dash=(2, 2), label="designed for")
    return Picture([[panel]])


def _pairs(panel: Panel, x: DataArray, y: DataArray, shown: Display) -> None:
    for place, name in enumerate(str(n) for n in y["pair_kind"].values):
        panel.curve(x.values, shown(y.values[place]), colour=COLOURS.get(name, INK), label=name)
