"""The page of the loaded contact over position, load and temperature."""

from __future__ import annotations

from functools import partial

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import (
    CELSIUS,
    MEGAPASCAL,
    MICROMETRE,
    MILLIMETRE,
    PERCENT,
    STIFFNESS,
    exactly,
    number,
)
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.results.result import Result
from thermogear.views.columns import Column, by_name, declared, key, rows_along, units
from thermogear.views.page import Page, Shown
from thermogear.views.pages import survey_captions as captions
from thermogear.views.pages import turn
from thermogear.views.pages.survey import survey
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, INK, OKABE_ITO, WIDE, ramp
from thermogear.views.typesetting import prose

KINDS = ("contact",)


def page(result: Result) -> Page:
    """Loaded contact over position, load and temperature."""
    data, light, beside = (
        result.groups["contact"],
        result.groups["base_pitch"],
        result.groups["iso_6336"],
    )
    pitch = float(result.text("base_pitch_length"))
    points = {str(k): float(v) for k, v in result.table("path_points").items()}
    pictures = [
        *turn.pictures(result.groups),
        Shown(
            "phase",
            "Stiffness and transmission error over a mesh period, hot",
            "The tangent stiffness is that of a small change of load, the secant one of the whole.",
            partial(over_phase, data),
            wide=True,
        ),
        Shown(
            "path",
            "Load share and pressure of one tooth pair",
            captions.CONTACT_PATH,
            partial(along_path, data, points),
            wide=True,
        ),
        Shown(
            "double_contact",
            "Double contact lost at light load",
            "A base-pitch difference between gears of unequal temperature leaves one pair unloaded "
            "until the teeth bend enough.",
            partial(double_contact, light, pitch, "double_contact_length"),
        ),
        Shown(
            "uneven_error",
            "Transmission error of unequally hot gears",
            "A hotter pinion and a hotter wheel need not be mirror images.",
            partial(double_contact, light, pitch, "peak_to_peak_error"),
        ),
    ]
    error = data["transmission_error"]
    of_period = data.assign(
        secant_stiffness=data["secant_stiffness"].mean("mesh_phase"),
        mean_error=error.mean("mesh_phase"),
        error_swing=error.max("mesh_phase") - error.min("mesh_phase"),
        contact_pressure=data["contact_pressure"].max(
            set(data["contact_pressure"].dims) - {"load", "temperature"}
        ),
    )
    table = declared(
        f"Loaded contact by load and temperature. The nominal contact ratio is "
        f"{data.attrs['contact_ratio']:.3f}, the effective one the mean number of tooth pairs that "
        "carry. The Hertzian pressure is not valid on a tip corner; the greatest one is that of "
        "the flanks alone.",
        COLUMNS,
        rows_along(of_period, "load", "temperature"),
        names=2,
    )
    corners = declared(
        "Edge contact: share of the mesh period in which a tip corner carries, the wheel's before "
        "A (approach), the pinion's beyond E (recess), what it carries of the load at most, and "
        "the pinion torque from which on.",
        CORNERS,
        rows_along(data, "load", "temperature", "gear"),
        names=3,
    )
    against = declared(
        "Mean mesh stiffness, undeformed [10⁸ N/m]. Method B knows neither bore nor rim, and lets "
        "the stiffness fall below 100 N/mm.",
        AGAINST_ISO,
        rows_along(beside, "load"),
    )
    summary = (
        f"{data.sizes['mesh_phase']} mesh positions, "
        f"{captions.several(data.sizes['load'], 'load')} "
        f"and {data.sizes['temperature']} temperatures; body "
        f"{result.text('body').replace('_', ' ')}."
    )
    of_turn = turn.tables(result.groups)
    of_survey = [against, table, corners]
    summary += " Of the mean tooth; below, the turn of all teeth." * bool(of_turn)
    every = data.assign(iso_6336_stiffness=beside["iso_stiffness"])
    return survey(
        result,
        summary,
        pictures,
        [*of_survey, *of_turn],
        numbers=lambda: {
            **by_name(every, IN_JSON),
            **turn.numbers(result.groups),
            "units": units(IN_JSON, every),
        },
        told=[*of_survey, *of_turn[:1]],
    )


COLUMNS = (
    Column("torque [N m]", "load", exactly),
    Column("temperature", lambda row: prose(row["temperature"])),
    Column("k tangent", "mean_stiffness"),
    Column("k secant", "secant_stiffness", 3, STIFFNESS),
    Column("δ mean", "mean_error", 3, MICROMETRE),
    Column("δ peak to peak", "error_swing", 3, MICROMETRE),
    Column("double contact", "double_contact_length", 3, MILLIMETRE),
    Column("effective contact ratio", "effective_contact_ratio", ".2f"),
    Column("greatest pressure on the flanks", "contact_pressure", 3, MEGAPASCAL),
)
CORNERS = (
    Column("torque [N m]", "load", exactly),
    Column("temperature", lambda row: prose(row["temperature"])),
    Column("tip", "gear"),
    Column("of the period", "corner_period_share", 2, PERCENT),
    Column("of the load", "corner_load_share", 2, PERCENT),
    Column("from [N m]", lambda row: row["corner_onset_torque"] or "any load"),
)
AGAINST_ISO = (
    Column("torque [N m]", "load", exactly),
    Column("loaded contact", lambda row: number(STIFFNESS(row["loaded_stiffness"]))),
    Column("ISO 6336-1 method B", lambda row: number(STIFFNESS(row["iso_stiffness"]))),
    Column(
        "difference",
        lambda row: row["iso_stiffness"] / row["loaded_stiffness"] - 1.0,
        "+.1f",
        PERCENT,
    ),
)


IN_JSON = (
    key("pinion_torque_Nm", "load"),
    key(
        "temperature_degC",
        lambda data: [
            name if np.isnan(given) else float(CELSIUS(given))
            for name, given in zip(
                data["temperature"].values.tolist(), data["gear_temperature"].values, strict=True
            )
        ],
    ),
    key("mean_stiffness"),
    key("double_contact_length_m", "double_contact_length"),
    key("edge_contact_share"),
    key("contact_ratio", lambda data: data.attrs["contact_ratio"]),
    key("effective_contact_ratio"),
    key("gear", lambda data: data["gear"].values.tolist()),
    key("corner_period_share"),
    key("corner_load_share"),
    key("corner_onset_torque"),
    key("iso_6336_stiffness"),
)


# --- pictures -----------------------------------------------------------------------------------


EDGE = OKABE_ITO[4]
STATES: dict[str, tuple[str, tuple[float, ...]]] = {UNDEFORMED: (COLD, (5, 2)), "hot": (HOT, ())}


def over_phase(data: Dataset) -> Picture:
    """Tangent and secant stiffness and transmission error over a mesh period, hot, by load."""
    here = data.sel(temperature="hot")
    panels = []
    for name, scale, words in (
        ("tangent_stiffness", STIFFNESS, "tangent stiffness [10⁸ N/m]"),
        ("secant_stiffness", STIFFNESS, "secant stiffness [10⁸ N/m]"),
        ("transmission_error", MICROMETRE, "transmission error δ, heat's shift in it [µm]"),
    ):
        panel = Panel(Axis("mesh phase φ [–]", low=0.0, high=1.0), Axis(words))
        for place, colour in enumerate(ramp(here.sizes["load"])):
            label = f"{float(here['load'][place]):.4g} N m"
            values = scale(here[name].values[place])
            panel.curve(here["mesh_phase"].values, values, colour=colour, label=label)
        panels.append(panel)
    return Picture([panels], size=(WIDE, 3.3), legend=6)


def along_path(data: Dataset, points: dict[str, float]) -> Picture:
    """Load share and pressure of a tooth pair along the path at the first and the last load.

    The pressure stops where a tip corner carries, and those stretches are shaded.
    """
    across = "distance from the pinion's tangent point [mm]"
    share = Panel(Axis(across), Axis("share of the load [–]", low=0.0))
    pressure = Panel(Axis(across), Axis("greatest Hertzian pressure on the flanks [MPa]", low=0.0))
    for name, (colour, dash) in STATES.items():
        if name not in data["temperature"].values:
            continue
        here = data.sel(temperature=name)
        last = here.sizes["load"] - 1
        for load in sorted({0, last}):
            one, width = here.isel(load=load), 1.8 if load == last else 1.0
            s = MILLIMETRE(one["pair_position"].values.ravel())
            order = np.argsort(s)
            words = f"{name}, {float(one['load']):.4g} N m"
            shares = one["load_share"].values.ravel()[order]
            pressures = MEGAPASCAL(one["contact_pressure"].values.ravel()[order])
            for panel, values in ((share, shares), (pressure, pressures)):
                panel.curve(s[order], values, colour=colour, dash=dash, width=width, label=words)
    for panel in (share, pressure):
        _corners(panel, data)
        _marks(panel, points)
    return Picture([[share, pressure]], size=(WIDE, 3.3), legend=4)


def _corners(panel: Panel, data: Dataset) -> None:
    """Shade where a tip corner carries at any load and temperature."""
    positions, flags = data["pair_position"].values, data["edge_contact"].values
    label = "edge contact: pressure not valid"
    for corner in (1, 2):
        touched = MILLIMETRE(positions[(flags == corner).any(axis=tuple(range(flags.ndim - 2)))])
        if touched.size:
            ends = float(touched.min()), float(touched.max())
            panel.span(x=ends, colour=EDGE, opacity=0.25, order=0.1, label=label)
            label = ""


def _marks(panel: Panel, points: dict[str, float]) -> None:
    for name, position in points.items():
        panel.line(x=MILLIMETRE(position), colour=INK, width=0.6, dash=(1, 2), order=0.5)
        panel.text(MILLIMETRE(position), 1.015, name, at="x", up="bottom")
    if points:
        low, high = MILLIMETRE(min(points.values())), MILLIMETRE(max(points.values()))
        panel.x.low, panel.x.high = low - 0.12 * (high - low), high + 0.12 * (high - low)


def double_contact(data: Dataset, base_pitch: float, name: str) -> Picture:
    """``name`` over the load (logarithmic) for gears of unequal temperature."""
    words = {
        "double_contact_length": (MILLIMETRE, "length of double contact [mm]"),
        "peak_to_peak_error": (MICROMETRE, "transmission error, peak to peak [µm]"),
    }
    scale, text = words[name]
    panel = Panel(Axis("pinion torque [N m]", log="full"), Axis(text, low=0.0))
    colours = (OKABE_ITO[0], OKABE_ITO[5], INK, OKABE_ITO[4], OKABE_ITO[1])
    for place, difference in enumerate(data["temperature_difference"].values):
        panel.curve(
            data["load"].values,
            scale(data[name].values[place]),
            colour=colours[place % len(colours)],
            label=f"pinion {difference:+.0f} K".replace("-", "−") if difference else "equally hot",
        )
    if name == "double_contact_length":
        panel.y.high = 1.03 * MILLIMETRE(base_pitch)
    return Picture([[panel]])
