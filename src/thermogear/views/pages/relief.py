"""The page of a tip relief: the relieved pair against the unrelieved one."""

from __future__ import annotations

from functools import partial

from thermogear.base.display import CELSIUS, MICROMETRE, MILLIMETRE, exactly
from thermogear.results.result import Result
from thermogear.views.columns import Column, declared
from thermogear.views.page import Code, Page, Shown, Text
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import survey
from thermogear.views.plots import relief

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
            partial(relief.error, result.groups["error"]),
        ),
        Shown(
            "stiffness",
            "Tangent stiffness over a mesh period",
            words.relief_stiffness(result.groups["error"]),
            partial(relief.stiffness, result.groups["error"]),
        ),
        Shown(
            "loads",
            "What the relief does at other loads",
            words.relief_loads(result.groups["loads"]),
            partial(relief.over_load, result.groups["loads"], torque),
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
    return survey(
        result,
        summary,
        pictures,
        [table],
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
        ],
        code=paste,
    )
