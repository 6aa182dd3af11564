"""The page of the thesis's steps for one pair: a section each, its finding first."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import (
    CELSIUS,
    MICROMETRE,
    PERCENT,
    SPEED,
    celsius,
    exactly,
    number,
    span,
)
from thermogear.base.parameters import PARAMETERS
from thermogear.base.vocabulary import STATUS, moves
from thermogear.results.result import Result
from thermogear.results.tables import rows_of
from thermogear.views.columns import Column, by_name, declared, in_full, key, rows_along
from thermogear.views.page import Block, Gallery, Page, Pictures, Section, Table, Text
from thermogear.views.pages import gear_sections
from thermogear.views.pages.background import background
from thermogear.views.pages.record_tables import comparison_table
from thermogear.views.pages.survey import OPERATING
from thermogear.views.pages.sweeps import bifurcations
from thermogear.views.plots.motion import label_of, moving
from thermogear.views.plots.parameters import shown
from thermogear.views.plots.sweeps import CLASSES, classes_of, overlay_picture, state_of

KINDS = ("thesis-pair",)
JAMMED = STATUS.index("jammed")
SWING, HALF = "peak_to_peak_displacement", "half_order_amplitude"
ROUNDING = 1e-9
"""A line at half the mesh frequency below this part of the swing is rounding."""
FRICTION = {"friction", "flash-mixed", "flash-dry"}
"""The pictures of mixed beside dry friction."""
CAPTION = (
    "Sections at phase 0 of the settled motion in both states, up and down; branches from "
    "continuation. The largest Lyapunov exponent below."
)
"""Of two diagrams over each other."""
Told = tuple[str, list[Block]]


def page(result: Result) -> Page:
    """Every step as a section that begins with what was found."""
    found = {title: (name, make(result, Pictures())) for name, title, make in STEPS}
    findings = {title: words for title, (_, (words, _)) in found.items()}
    sections = [
        Section(name, title, [Text(words), *blocks], folded=False)
        for title, (name, (words, blocks)) in found.items()
    ]
    summary = _summary(result)
    return Page(
        result,
        summary,
        sections + background(result),
        numbers=lambda: _numbers(result, findings),
        told=lambda: map(Text, [summary, *(f"{t}: {words}" for t, words in findings.items())]),
    )


def _summary(result: Result) -> str:
    mesh = _hot(result.groups["mesh"])
    cold, hot = result.groups["mesh"]["frequency_ratio"].isel(bundle=0, operating=0).values
    why = STATUS[int(mesh["status"])].replace("_", " ")
    at = number(float(hot)) if hot == hot else f"{number(float(cold))} undeformed; hot {why}"
    cut = "Stopped on request before the end: what is missing was not computed. "
    return (
        f"{cut if result.interrupted else ''}The steps of the thesis for this pair at "
        f"{exactly(SPEED(float(mesh['pinion_speed'])))} rpm and "
        f"{exactly(float(mesh['pinion_torque']))} N m (ω_h = {at}), "
        f"bundle {mesh['bundle'].item()}."
    )


def _hot(data: Dataset) -> Dataset:
    """The one point of a group, hot."""
    return data.isel(bundle=0, operating=0, state=-1)


def _sentence(parts: Sequence[str]) -> str:
    words = f"{'; '.join(parts)}."
    return words[:1].upper() + words[1:]


def _micro(one: Dataset, name: str) -> str:
    return number(MICROMETRE(float(one[name])))


def _temperatures(result: Result) -> list[Dataset]:
    """The point at every gear temperature."""
    here = result.groups["temperature"].isel(bundle=0, operating=0)
    return [here.isel(gear_temperature=k) for k in range(here.sizes["gear_temperature"])]


def _warming(result: Result, pictures: Pictures) -> Told:
    """What the motion does over the gears' temperature."""
    points = _temperatures(result)
    there = {_at(one): one for one in points if "displacement" in one and moving(one)}
    told, blocks = [], []
    if there:
        first, *_, last = [*there.values()] * 2
        labels = {at: label_of(one) for at, one in there.items()}
        kinds = set(labels.values())
        every = (f"{label} at {at}" for at, label in labels.items())
        told = [
            f"the motion is {kinds.pop()} at {', '.join(there)}"
            if len(kinds) == 1
            else f"the motion is {', '.join(every)}",
            f"its swing goes from {_micro(first, SWING)} to {_micro(last, SWING)} µm",
        ]
        sizes = [float(one["multiplier_modulus"]) for one in (first, last)]
        if np.isfinite(sizes).all():
            told.append(
                "its largest Floquet multiplier from "
                f"{number(sizes[0], 4)} to {number(sizes[1], 4)} in modulus"
            )
        lines = any(float(one[HALF]) > ROUNDING * float(one[SWING]) for one in there.values())
        ends = f"whose height goes from {_micro(first, HALF)} to {_micro(last, HALF)} µm"
        told.append(f"it has {'a' if lines else 'no'} line at half the mesh frequency")
        told[-1] += f", {ends}" * lines
        section = gear_sections.row(result, pictures)
        blocks = [one for one in section.blocks if one.kind != "text"] if section else []
    still = [one for one in points if not moves(one["status"])]
    for word in dict.fromkeys(map(label_of, still)):
        some = [one for one in still if label_of(one) == word]
        told.append(f"at {', '.join(map(_at, some))} {word}{_gap(some) * (word == 'jammed')}")
    left = result.rows("left_out")
    for why in dict.fromkeys(str(one["why"]) for one in left):
        where = [celsius(one["gear_temperature_K"]) for one in left if one["why"] == why]
        told.append(f"{', '.join(where)} left out, {why}")
    return _sentence(told), blocks


def _at(one: Dataset) -> str:
    return celsius(float(one["gear_temperature"]))


def _gap(points: list[Dataset]) -> str:
    """What is left at the tightest phase where it jams, and where: each has its own housing."""
    gaps = span([MICROMETRE(float(one["least_half_backlash"])) for one in points])
    jams = span([round(CELSIUS(float(one["jam_temperature"])), 0) for one in points])
    used = f", used up at {jams} °C with the housing of each" * (jams != "–")
    return f", least half backlash {gaps} µm{used}"


def _diagram(name: str, result: Result, pictures: Pictures) -> Told:
    """The diagrams over one parameter, undeformed and hot, in one picture and one table."""
    data = result.group(f"diagrams/{name}")
    if data is None:
        cold = result.groups["motion"].isel(bundle=0, operating=0, state=0)
        why = (
            "its stiffness does not fluctuate"
            if moves(cold["status"])
            else f"undeformed it is {label_of(cold)}"
        )
        why = "stopped before it" if result.interrupted else why
        return f"Not computed: {why}.", []
    states = json.loads(str(data.attrs["state_names"]))
    here = [state_of(data, place) for place in range(len(states))]
    ends = [exactly(float(v), 4) for v in shown(name, data[name][[0, -1]])]
    motions = [_shares(one) for one in here]
    told = [f"{state} {words}" for state, words in zip(states, motions, strict=True)]
    told = told if len(set(motions)) > 1 else [f"{' and '.join(states)} alike {motions[0]}"]
    counts = [f"{one.sizes.get('bifurcation', 0)} {s}" for s, one in zip(states, here, strict=True)]
    table = table_of(data, states)
    told.append(f"bifurcations: {', '.join(counts)}" if table.rows else "no bifurcation was found")
    if any(moves(one["status"]).any() for one in here):
        pictures.add(
            f"diagram-{name}", "Undeformed and hot", CAPTION, data, (),
            lambda: overlay_picture(data, states), wide=True,
        )  # fmt: skip
    blocks = [*pictures.take(), *[table] * bool(table.rows)]
    return _sentence([f"from {' to '.join(ends)} {PARAMETERS[name].shown}".strip(), *told]), blocks


def _located(data: Dataset, states: Sequence[str]) -> tuple[list[Column], list[dict[str, Any]]]:
    """Columns and rows of the bifurcations of all ``states``."""
    each = [bifurcations(state_of(data, place)) for place in range(len(states))]
    columns = [Column("state", "state", key="state"), *each[0][0]]
    rows = [
        {**row, "state": words} for words, (_, of) in zip(states, each, strict=True) for row in of
    ]
    return columns, rows


def table_of(data: Dataset, states: Sequence[str]) -> Table:
    """The located bifurcations of all ``states``."""
    return declared("Located bifurcations", *_located(data, states))


def located(data: Dataset, states: Sequence[str]) -> list[dict[str, Any]]:
    """The located bifurcations of all ``states``, JSON-ready."""
    columns, rows = _located(data, states)
    return [in_full(columns, row) for row in rows]


def _shares(one: Dataset) -> str:
    """Which motions one state settles on, by their shares of the values."""
    code = classes_of(one)
    parts = (f"{CLASSES[n][0]} at {number(PERCENT(np.mean(code == n)))} %" for n in np.unique(code))
    return ", ".join(parts)


def _friction(result: Result, pictures: Pictures) -> Told:
    here = _hot(result.groups["path"])
    names = ("mixed", "dry")
    mean = [number(float(np.mean(here[f"friction_coefficient_{n}"].values))) for n in names]
    flash = [number(float(np.max(here[f"flash_temperature_{n}"].values))) for n in names]
    if "–" in (*mean, *flash):
        hot = int(_hot(result.groups["mesh"])["status"])
        why = "Benedict and Kelley's law has no value for these flanks"
        why = STATUS[hot].replace("_", " ") if hot > JAMMED else why
        return f"Mixed lubrication cannot be put beside dry friction hot: {why}.", []
    section = gear_sections.friction(result, pictures)
    galleries = [one for one in section.blocks if isinstance(one, Gallery)] if section else []
    kept = [one for some in galleries for one in some.pictures if one.name in FRICTION]
    rows = rows_of({"friction": names, "mean": mean, "flash": flash})
    table = declared("Along the path of contact, hot.", FRICTION_TABLE, rows)
    return (
        f"Hot, mixed lubrication gives a mean friction coefficient of {mean[0]} and a flash "
        f"temperature of at most {flash[0]} K, dry friction {mean[1]} and {flash[1]} K."
    ), [table, Gallery(kept)]


def _records(result: Result, pictures: Pictures) -> Told:
    data = result.group("comparison")
    if data is None:
        return "No record was given; each --record FILE is put beside this pair, cold and hot.", []
    return result.text("conclusion"), [comparison_table(data)]


FRICTION_TABLE = (
    Column("friction", "friction"),
    Column("mean coefficient", "mean"),
    Column("greatest flash temperature [K]", "flash"),
)
DIAGRAMS = {
    "damping_ratio": ("damping", "Damping"),
    "pinion_speed": ("speed", "Speed"),
    "stiffness_fluctuation": ("fluctuation", "Stiffness fluctuation"),
}
"""Parameter of a diagram: name and title of its section."""
STEPS: tuple[tuple[str, str, Callable[[Result, Pictures], Told]], ...] = (
    ("temperature", "Gear temperature", _warming),
    *((*names, partial(_diagram, parameter)) for parameter, names in DIAGRAMS.items()),
    ("friction", "Mixed and dry friction", _friction),
    ("records", "Records", _records),
)


AT_TEMPERATURE = (
    key("gear_temperature_K", "gear_temperature"),
    *map(key, ("status", "label", "half_backlash", SWING, HALF, "multiplier_modulus")),
)


def _numbers(result: Result, findings: dict[str, str]) -> dict[str, Any]:
    """Findings as sentences, and the figures behind them in SI."""
    row = result.groups["temperature"].isel(bundle=0, operating=0)
    there = [one for one in AT_TEMPERATURE if one.value in row]
    return {
        **by_name(_hot(result.groups["mesh"]), (*OPERATING, key("frequency_ratio"))),
        "findings": findings,
        "temperature": [in_full(there, place) for place in rows_along(row, "gear_temperature")],
        "bifurcations": {
            name: located(data, json.loads(str(data.attrs["state_names"])))
            for name in DIAGRAMS
            if (data := result.group(f"diagrams/{name}")) is not None
        },
        "left_out": result.rows("left_out"),
    }
