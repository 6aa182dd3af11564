"""The page of a tip relief: the relieved pair against the unrelieved one."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from thermogear.base.arrays import DataArray, Dataset
from thermogear.base.display import (
    CELSIUS,
    DEGREE,
    MICROMETRE,
    MILLIMETRE,
    PERCENT,
    Display,
    exactly,
)
from thermogear.results.result import Result
from thermogear.views.columns import Column, declared
from thermogear.views.page import Code, Page, Shown, Text
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import survey
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, INK, names_of

KINDS = ("relief",)
PASTED = Text("# for the case file, in place of tip reliefs it has already")


def page(result: Result) -> Page:
    """The relief found, beside the unrelieved pair; of a series beside other reliefs."""
    if "parts" in result.groups:
        return of_parts(result)
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
            "Under the design load.",
            partial(error, result.groups["error"]),
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
            PASTED,
            Code(paste),
        ]
        * helps,
        code=paste * helps,
    )


# --- of a series --------------------------------------------------------------------------------


def of_parts(result: Result) -> Page:
    """The relief designed on some parts, judged by others, beside the one on perfect flanks."""
    data, gains = result.groups["parts"], result.table("gains")
    reliefs, paste = result.table("reliefs"), result.text("paste")
    torques = data["load"].values
    judged, designed = data.sizes["part"], int(result.text("designed_on"))
    rows = [{"gear": gear, **row} for gear, row in reliefs.items()]
    helps = any(row["amount_m"] > 0.0 for row in rows)
    summary = _judged(gains["series"], judged, designed, ", ".join(map(exactly, torques)))
    if not helps:
        least = PERCENT(float(result.text("least_gain")))
        summary = (
            f"No tip relief makes the {designed} parts more even by {least:g} % in the mean: none "
            "is proposed."
        )
    ground = declared(
        "Tip relief as it can be ground; lengths along the line of action.",
        (
            Column("gear", "gear"),
            Column("amount", "amount_m", ".0f", MICROMETRE),
            Column("length", "length_m", ".2f", MILLIMETRE),
            Column("shape", "shape"),
            Column("start, diameter", "start_diameter_m", ".2f", MILLIMETRE),
            Column("start, roll angle", "start_roll_angle_rad", ".2f", DEGREE),
        ),
        rows,
    )
    compared = declared(
        f"{judged} parts: root mean square of the transmission error about its mean over each mesh "
        "period, mean over the loads, with a relief over without. Interval of 95 %.",
        (
            Column("relief designed for", "relief"),
            Column("gain", "gain", ".1f", PERCENT),
            Column("± standard error", "standard_error", ".1f", PERCENT),
            Column("worst part, of without", "worst", ".0f", PERCENT),
            Column("parts made worse", "worse"),
            Column("share worse, from", "worse_low", ".1f", PERCENT),
            Column("to", "worse_high", ".1f", PERCENT),
        ),
        [{"relief": name, **row} for name, row in gains.items()],
    )
    pictures = [
        Shown(
            "parts",
            "Each part with the relief, over without",
            f"{judged} parts in order; below 1 it runs more evenly than without relief.",
            partial(each_part, data),
        ),
        Shown(
            "profile",
            "Profile chart of both gears",
            "Material taken off along the line of action, from the start of contact to the tip.",
            partial(profile, result.groups["profile"]),
        ),
    ]
    return survey(
        result,
        summary,
        pictures,
        [*[ground] * helps, compared],
        numbers=lambda: {
            "torques_Nm": torques.tolist(),
            "gains": gains,
            "reliefs": reliefs,
            "parts_designed_on": designed,
            "parts_judged": judged,
            "mesh_periods": int(result.text("mesh_periods")),
            "evaluations": int(result.text("evaluations")),
            "paste": paste,
        },
        told=[ground, compared, PASTED, Code(paste)] if helps else [compared],
        code=paste * helps,
    )


def _judged(gain: Mapping[str, float], judged: int, designed: int, torques: str) -> str:
    """The gain in a sentence, with what it is of and how sure it is."""
    mean, worst = PERCENT(gain["gain"]), PERCENT(gain["worst"])
    what = "the transmission error within a mesh period (rms, mean over the loads)"
    if judged == 1:
        return f"Made for {torques} N m: it changes {what} by {-mean:+.1f} %."
    return (
        f"Made for {torques} N m on {designed} parts of the class and judged by {judged} others: "
        f"it changes {what} by {-mean:+.1f} % in the mean, standard error "
        f"{PERCENT(gain['standard_error']):.1f} %; the worst part has {worst:.0f} % of what it has "
        f"without, {gain['worse']:.0f} of {judged} parts run less evenly (share of all parts "
        f"{PERCENT(gain['worse_low']):.1f} to {PERCENT(gain['worse_high']):.1f} %)."
    )


def each_part(data: Dataset) -> Picture:
    """Ratio of each part, in order, of every relief."""
    panel = Panel(
        Axis("share of the parts [–]", low=0.0, high=1.0),
        Axis("error, with over without [–]", low=0.0),
    )
    colours = (COLD, HOT, INK)
    for place, name in enumerate(names_of(data, "relief")[1:]):
        values = np.sort(data["ratio"].values[1 + place])
        x = (np.arange(values.size) + 0.5) / values.size
        panel.curve(x, values, colour=colours[place], label=str(name))
    panel.line(y=1.0, colour=INK, width=0.9, dash=(2, 2), label="without relief")
    return Picture([[panel]], legend=1)


def profile(data: Dataset) -> Picture:
    """What is taken off over the roll angle, of both gears."""
    panel = Panel(Axis("roll angle [°]"), Axis("taken off [µm]", low=0.0))
    for place, name in enumerate(names_of(data, "gear")):
        x, y = (data[key].values[place] for key in ("roll_angle", "taken_off"))
        start = MILLIMETRE(float(data["diameter"].values[place, 1]))
        label = f"{name}, starts at Ø {start:.2f} mm, {DEGREE(x[1]):.2f}°"
        panel.curve(DEGREE(x), MICROMETRE(y), colour=(COLD, HOT)[place], label=label)
    return Picture([[panel]], legend=1)


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
