"""What the page of a warm-up holds: the answer, pictures, tables."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import exactly, number
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.results.result import Result
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages.survey import survey
from thermogear.views.plots import warm_up as plots

if TYPE_CHECKING:
    import xarray as xr

KINDS = ("warmup",)


def page(result: Result) -> Page:
    """A pair through its duty."""
    data, steady = result.groups["course"], result.groups["steady"]
    record, fit = result.group("record"), result.group("fit")
    worst = result.table("worst")
    cold = float(worst["undeformed_half_backlash_m"])
    logarithmic = result.text("duty") != "table"
    pictures = [
        Shown(
            "course",
            "Temperatures and half backlash over time",
            _course_words(worst, logarithmic, record is not None),
            partial(plots.course, data, steady, record, worst, cold=cold, logarithmic=logarithmic),
            wide=True,
        ),
        Shown(
            "mesh",
            "Flash, film, margin and stiffness over time",
            "Gaps: a pair without load has no flash, film or stiffness, one at rest no film.",
            partial(plots.mesh, data, worst, logarithmic=logarithmic),
            wide=True,
        ),
        Shown(
            "sensors",
            "What thermometers show, and what is true",
            _sensor_words(result.table("sensors")),
            partial(plots.sensors, data, record, logarithmic=logarithmic),
            wide=True,
        ),
    ]
    tables = [_moments(data, worst), _pieces(data, steady), _sensors(data)]
    if record is not None:
        tables.append(_differences(record))
    if fit is not None:
        tables.insert(0, _fitted(result.table("fit")))
    return survey(
        result,
        answer(worst, cold) + fit_sentence(result.table("fit")),
        pictures,
        tables,
        numbers=_numbers,
        lines=_lines,
    )


def answer(worst: Mapping[str, Any], cold: float) -> str:
    """When the half backlash is least, how much is left, and how that compares."""
    least, minutes = 1e6 * float(worst["half_backlash_m"]), float(worst["time_s"]) / 60.0
    point = (
        f"{exactly(round(float(worst['pinion_speed_rpm']), 6))} rpm and "
        f"{exactly(float(worst['pinion_torque_Nm']))} N m"
    )
    if worst["at_the_start"]:
        when = "at the start, heat never takes any of it"
    elif worst["at_the_end"]:
        when = f"at the end, after {number(minutes)} min"
    else:
        when = f"{number(minutes)} min after the start, at {point}"
    text = f"The half backlash is least {when}: {number(least, 4)} um of {number(1e6 * cold, 4)} um"
    text += " undeformed." if least > 0.0 else " undeformed: the pair is jammed."
    rest, below = worst["steady_half_backlash_m"], worst["below_steady_m"]
    if rest is not None and not worst["at_the_start"]:
        if below > 5e-9 and not worst["at_the_end"]:
            text += f" That is {number(1e6 * below)} um below the steady {number(1e6 * rest, 4)} um"
            if worst["loss_above_steady"] is not None:
                text += (
                    f"; the loss of backlash is {number(100.0 * worst['loss_above_steady'])} % "
                    "greater than the steady one"
                )
            text += "."
        else:
            text += f" Held for good, this point would leave {number(1e6 * rest, 4)} um."
    margin = worst["margin_K"]
    if margin is not None and least > 0.0:
        text += (
            f" Both gears could then be {number(margin)} K hotter, the housing as it is, until "
            "the pair jams."
        )
    return text


def fit_sentence(fit: Mapping[str, Any]) -> str:
    """What the fit found, with intervals; nothing where none was asked for."""
    if not fit:
        return ""
    parts = [f"{one['name']} {_interval(one)}" for one in fit["factors"]]
    return (
        f" Fitted to the record: {' and '.join(parts)}; the rms difference goes from "
        f"{number(fit['rms_before_K'])} to {number(fit['rms_after_K'])} K."
    )


def _interval(one: Mapping[str, Any]) -> str:
    if one["low"] is None or one["high"] is None:
        return f"times {number(one['value'])} (no interval: the record says too little of it)"
    return f"times {number(one['value'])} ({number(one['low'])} to {number(one['high'])})"


def _course_words(worst: Mapping[str, Any], logarithmic: bool, measured: bool) -> str:
    words = ["Dotted: the moment of the least half backlash."]
    if not (worst["at_the_end"] or worst["at_the_start"]):
        warmed = worst["warmed"]
        words.append(
            "Gears warm before the housing, which then follows and opens the axes again."
            if warmed
            else "The housing cools before the gears and closes the axes on them."
        )
    words.append("Dashed below: what would be left if the point were held for good.")
    if measured:
        words.append("Circles: the record.")
    if logarithmic:
        words.append("Time runs logarithmically.")
    return " ".join(words)


def _sensor_words(names: Mapping[str, str]) -> str:
    return "; ".join(f"{name}: {words}" for name, words in names.items()) + "."


def _degrees(kelvin: float) -> str:
    return number(kelvin - ZERO_CELSIUS, 4) if np.isfinite(kelvin) else "–"


def _thousandths(kelvin: float) -> str:
    return number(round(kelvin, 3) + 0.0)


def _moments(data: xr.Dataset, worst: Mapping[str, Any]) -> Table:
    """Start, worst moment, end."""
    places = [0, int(np.argmin(data["half_backlash"].values)), data.sizes["moment"] - 1]
    names = ["start", "least backlash", "end"]
    nodes = ("pinion_tooth", "wheel_tooth", "pinion_shaft", "wheel_shaft", "oil", "housing")
    rows = []
    for name, place in zip(names, places, strict=True):
        here = data.isel(moment=place)
        worst_row = name == "least backlash"
        minutes = float(worst["time_s"] if worst_row else here["time"]) / 60.0
        gap = float(worst["half_backlash_m"] if worst_row else here["half_backlash"])
        temperatures = [
            worst["temperatures_K"].get(node, float(here["node_temperature"].sel(node=node)))
            if worst_row
            else float(here["node_temperature"].sel(node=node))
            for node in nodes
        ]
        rows.append(
            [
                name,
                number(minutes, 4),
                number(1e6 * gap, 4),
                number(float(here["jam_margin"])),
                *(_degrees(t) for t in temperatures),
                number(float(here["greatest_flash"])),
                number(float(here["least_film_parameter"])),
                number(1e-8 * float(here["mean_stiffness"])),
            ]
        )
    return Table(
        "Start, worst moment, end.",
        [
            "moment", "time [min]", "b′ [µm]", "margin [K]",
            *(f"{node.replace('_', ' ')} [°C]" for node in nodes),
            "flash [K]", "Λ least", "k mean [10⁸ N/m]",
        ],
        rows,
        marked=frozenset({1}),
    )  # fmt: skip


MOST_ROWS = 40


def _pieces(data: xr.Dataset, steady: xr.Dataset) -> Table:
    """The pieces of the duty, and what each would leave for good."""
    time = data["time"].values
    ends = np.append(steady["begin"].values[1:], time[-1])
    rows = []
    for place in range(min(steady.sizes["piece"], MOST_ROWS)):
        here = steady.isel(piece=place)
        begin, end = float(here["begin"]), float(ends[place])
        inside = (time >= begin) & (time <= end)
        least = float(data["half_backlash"].values[inside].min()) if inside.any() else np.nan
        rows.append(
            [
                number(begin / 60.0, 4),
                exactly(round(float(here["pinion_speed"]) / RPM, 6)),
                exactly(float(here["pinion_torque"])),
                _degrees(float(here["ambient"])),
                number(1e6 * least, 4),
                number(1e6 * float(here["half_backlash"]), 4),
                _degrees(float(here["node_temperature"].sel(node="oil"))),
            ]
        )
    more = steady.sizes["piece"] - len(rows)
    return Table(
        "The duty, and what each point would leave if it were held for good."
        + (f" {more} more rows stand in the CSV." if more else ""),
        [
            "from [min]", "speed [rpm]", "torque [N m]", "ambient [°C]", "b′ least [µm]",
            "b′ for good [µm]", "oil for good [°C]",
        ],
        rows,
        names=0,
    )  # fmt: skip


def _sensors(data: xr.Dataset) -> Table:
    error = data["sensor_temperature"].values - data["true_temperature"].values
    rows = []
    for place, name in enumerate(str(n) for n in data["sensor"].values):
        own = error[:, place]
        rows.append(
            [
                name,
                _thousandths(float(own[-1])),
                _thousandths(float(own.min())),
                _thousandths(float(own.max())),
                _degrees(float(data["sensor_temperature"].values[-1, place])),
                _degrees(float(data["true_temperature"].values[-1, place])),
            ]
        )
    return Table(
        "What each sensor shows less what is true.",
        ["sensor", "at the end [K]", "least [K]", "greatest [K]", "shown [°C]", "true [°C]"],
        rows,
    )


def _differences(record: xr.Dataset) -> Table:
    rows = []
    for name in (str(n) for n in record["channel"].values):
        own = record["difference"].sel(channel=name).values
        known = own[np.isfinite(own)]
        if not known.size:
            continue
        rows.append(
            [
                name,
                str(known.size),
                number(float(known.mean())),
                number(float(np.sqrt(np.mean(known**2)))),
                number(float(known[np.argmax(np.abs(known))])),
            ]
        )
    return Table(
        "Computed less measured.",
        ["channel", "readings", "mean [K]", "rms [K]", "farthest [K]"],
        rows,
    )


def _fitted(fit: Mapping[str, Any]) -> Table:
    rows = [
        [
            one["name"],
            *(number(one[k]) if one[k] is not None else "–" for k in ("value", "low", "high")),
        ]
        for one in fit["factors"]
    ]
    text = (
        f"Factors on conductances with 95 % intervals from {fit['count']} readings, worth "
        f"{number(fit['effective'])} independent ones."
    )
    if fit["correlation"] is not None:
        text += f" Errors of both factors correlate with {number(fit['correlation'], 2)}."
    return Table(text, ["factor", "value", "from", "to"], rows)


# --- figures as the terminal and JSON want them -----------------------------------------------


def _numbers(result: Result) -> dict[str, Any]:
    data = result.groups["course"]
    error = data["sensor_temperature"].values[-1] - data["true_temperature"].values[-1]
    last = data["node_temperature"].values[-1]
    return {
        "worst": result.table("worst"),
        "jams_s": result.values("jams"),
        "end_K": {str(node): float(t) for node, t in zip(data["node"].values, last, strict=True)},
        "sensor_error_at_the_end_K": {
            str(name): float(e) for name, e in zip(data["sensor"].values, error, strict=True)
        },
        "greatest_imbalance": float(result.text("greatest_imbalance")),
        "evaluations": int(result.text("evaluations")),
        "seconds": float(result.text("seconds")),
        "fit": result.table("fit"),
    }


def _lines(result: Result) -> list[str]:
    found = _numbers(result)
    cold = float(found["worst"]["undeformed_half_backlash_m"])
    lines = [answer(found["worst"], cold).replace("−", "-")]
    if found["fit"]:
        lines.append(fit_sentence(found["fit"]).strip())
    degrees = [(name, f"{t - ZERO_CELSIUS:.1f}") for name, t in found["end_K"].items()]
    lines.append("at the end [degC]: " + ", ".join(f"{name} {t}" for name, t in degrees))
    shown = [f"{n} {e:+.2f}" for n, e in found["sensor_error_at_the_end_K"].items()]
    return [*lines, "sensors, shown less true at the end [K]: " + ", ".join(shown)]
