"""Pages of one motion: its orbit, its Lyapunov exponent, its branches."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from operator import itemgetter
from typing import Any

from thermogear.base.arrays import Dataset
from thermogear.base.display import MICROMETRE, PERCENT, Display, number
from thermogear.base.vocabulary import label_words, of_turn
from thermogear.results.result import Result
from thermogear.results.tables import csv_text, frames
from thermogear.views.columns import Column, Row, declared, pairs
from thermogear.views.page import (
    LEAD,
    Block,
    Gallery,
    Page,
    Section,
    Shown,
    Text,
)
from thermogear.views.picture import Picture
from thermogear.views.plots import one_motion as plots
from thermogear.views.plots.parameters import page_words
from thermogear.views.typesetting import prose

Summary = dict[str, Any]
MESH = "mesh periods"
SMALL = 1e-4
"""A multiplier below it is written as a power of ten: nine places would leave little of it."""
SECOND = "second_shown"
PLANE = "Where the motion jumps or changes"


def shown(point: Row, digits: int = 8, which: str = "shown") -> str:
    """The value of a point with its unit, of the first or the second parameter."""
    return f"{point[which]:.{digits}g} {point[f'{which}_unit']}".strip()


def _turns(curve: Row) -> list[str]:
    """Where a curve turns back, in both parameters."""
    return [f"{shown(one, 6)} at {shown(one, 6, SECOND)}" for one in curve["turns"]]


def _meets(curve: Row) -> list[str]:
    """What a grazing meets on its way, in both parameters."""
    return [
        f"{event['what']}: {shown(event, 6)} at {shown(event, 6, SECOND)}"
        for event in curve.get("meets", ())
    ]


def plane_headline(summary: Summary) -> str:
    """How many were followed; "" without a second parameter."""
    if "curves" not in summary:
        return ""
    count = len(summary["curves"])
    return f"{count} followed in a second parameter." if count else "None followed further."


def plane_caption(summary: Summary) -> str:
    """What the plane shows: only what is drawn in it."""
    words = ["A motion that crosses a solid line changes there"]
    if any(not one["stable"] for curve in summary["curves"] for one in curve["asked"]):
        words.append("dotted: the orbit is unstable already, so that no motion meets it")
    return "; ".join(words) + ". Marks: at the values asked for."


def plane_tables(summary: Summary) -> list[Block]:
    """The curves at the values asked for, and how each ended."""
    if "curves" not in summary:
        return []
    second = page_words(summary["second"])
    if not summary["curves"]:
        return [Text(f"No bifurcation was followed in the second parameter, {second}.")]
    turn = of_turn(summary.get("mesh_periods", 1))
    curves = []
    for row, curve in enumerate(summary["curves"], start=1):
        words = plots.event_words(curve["kind"], curve.get("contact", ""))
        curves.append({**curve, "name": f"{row} {words}, period {curve['period']}{turn}"})
    points = (
        Column("curve", "name"),
        Column(second, lambda point: shown(point, 6, SECOND)),
        Column(page_words(summary["parameter"]), shown),
        Column("", lambda point: "" if point["stable"] else "on an unstable orbit"),
    )
    ends = (
        Column("curve", "name"),
        Column("points", "points"),
        Column("turns at", lambda curve: "; ".join(_turns(curve)) or "–"),
        Column("meets", lambda curve: "; ".join(_meets(curve)) or "–"),
        Column("ended", "ended"),
    )
    asked = [{**point, "name": curve["name"]} for curve in curves for point in curve["asked"]]
    return [
        declared("Bifurcations in two parameters", points, asked),
        declared("The curves", ends, curves),
    ]


Groups = Mapping[str, Dataset]

KINDS = ("orbit", "lyapunov", "branch")


def page(result: Result) -> Page:
    """One picture, and the numbers of the summary as tables."""
    kind, groups, summary = result.kind, result.groups, result.summary
    caption = _caption(kind, summary, groups)
    shown = [Shown(kind, HEADINGS[kind], caption, _picture(kind, groups), wide=True)]
    if "curve_0" in groups:
        made = partial(plots.plane_picture, _numbered(groups, "curve_"))
        shown.append(Shown("plane", PLANE, plane_caption(summary), made, wide=True))
    headline, blocks = _headline(kind, summary), _TABLES[kind](summary)
    return Page(
        result,
        headline,
        [
            Section("numbers", "Numbers", blocks),
            Section(LEAD, "In pictures", [Gallery(shown)], folded=False),
        ],
        numbers=lambda: summary,
        told=lambda: [Text(summary["title"]), Text(headline), *blocks],
        tables=lambda: curve_tables(kind, groups),
        files=("svg", "png"),
    )


def _picture(kind: str, groups: Groups) -> Callable[[], Picture]:
    if kind == "branch":
        return partial(plots.branch_picture, _numbered(groups, "branch_"))
    return partial(plots.orbit_picture if kind == "orbit" else plots.lyapunov_picture, groups[kind])


def _numbered(groups: Groups, begin: str) -> list[Dataset]:
    """The groups named ``begin`` and a number, in order."""
    names = sorted((n for n in groups if n.startswith(begin)), key=lambda n: int(n[len(begin) :]))
    return [groups[name] for name in names]


def curve_tables(kind: str, groups: Groups) -> dict[str, str]:
    """Every array along an axis as CSV: one file for each axis, branches below each other."""
    import pandas as pd

    parts: dict[str, list[pd.DataFrame]] = {}
    for name, data in groups.items():
        file = "plane" if name.startswith("curve_") else kind
        attributes = {k: data.attrs[k] for k in ("kind", "period") if k in data.attrs}
        for (axis, *more), frame in frames(data).items():
            if not more and axis not in ("multiplier", "coordinate"):
                columns = [*attributes, *frame.columns.drop(axis, errors="ignore")]
                parts.setdefault(f"{file}_{axis}.csv", []).append(
                    frame.assign(**attributes)[columns]
                )
    return {file: csv_text(pd.concat(each)) for file, each in parts.items()}


HEADINGS = {
    "orbit": "The orbit",
    "lyapunov": "The exponent as batches come in",
    "branch": "Branches along the parameter",
}


def _caption(kind: str, summary: Summary, groups: Groups) -> str:
    """What the picture shows: only what is drawn in it."""
    if kind == "orbit":
        edges = plots.edges_in_sight(groups["orbit"])
        half = any(line["half_order"] for line in summary["lines"])
        words = ["Dashed: edges of the backlash."] * bool(edges)
        words.append("An orbit is stable where its multipliers lie inside the circle.")
        words += ["Lines at half orders show a doubled period."] * half
        if "mesh_periods" in summary:
            words.append(
                f"The orbit closes after turns of {summary['mesh_periods']} mesh periods; the "
                "phase plane shows the first of them."
            )
        return " ".join(words)
    if kind == "branch":
        legs, points = summary["branches"], summary["bifurcations"]
        unstable = any(leg["stable_points"] < leg["points"] for leg in legs)
        stable = any(leg["stable_points"] for leg in legs)
        words = [
            "; ".join(["solid: stable"] * stable + ["dotted: unstable"] * unstable).capitalize()
        ]
        words += ["Marks: where bifurcations were located"] * bool(points)
        if "mesh_periods" in summary:
            words.append(f"Periods are those of the turn of {summary['mesh_periods']} mesh periods")
        return ". ".join(words) + "."
    return "The band is one standard error of the mean."


def _headline(kind: str, summary: Summary) -> str:
    if kind == "orbit":
        largest = summary["multipliers"][0]["modulus"]
        firm = "stable" if summary["stable"] else "unstable"
        return (
            f"{summary['label']}, {firm}: largest Floquet multiplier {_part(largest)} in modulus."
        )
    if kind == "lyapunov":
        return (
            f"λ₁ = {summary['exponent']:.5f} ± {summary['error']:.5f} ({summary['verdict']}); "
            f"the sum of both exponents is {summary['sum']:.6g}."
        )
    events, legs = len(summary["bifurcations"]), len(summary["branches"])
    counts = f"{events} bifurcation{'s' * (events != 1)} on {legs} branch{'es' * (legs != 1)}."
    return f"{counts} {plane_headline(summary)}".strip()


def _orbit_tables(summary: Summary) -> list[Block]:
    length = MICROMETRE if summary["units"] == "SI" else Display("–")
    share = summary["time_share"]
    factor, of = summary["dynamic_load_factor"], summary.get("mesh_periods", 1)
    values = {
        "period n": (str(summary["period"]), f"turns of {of} mesh periods" if of > 1 else MESH),
        **{
            f"multiplier {i}": (_complex(mu), f"modulus {_part(mu['modulus'])}")
            for i, mu in enumerate(summary["multipliers"], start=1)
        },
        "state at phase 0": (
            prose(f"{summary['state'][0]:.12g}, {summary['state'][1]:.12g}"), "X, X′",
        ),
        "losses of contact": (str(summary["contact_losses"]), "per orbit"),
        "back-side impacts": (str(summary["back_impacts"]), "per orbit"),
        **{
            f"time in {words}": (f"{PERCENT(share[name]):.4g}", "%")
            for words, name in (
                ("drive contact", "drive"), ("free flight", "free"), ("back contact", "back"),
            )
        },
        "dynamic load factor": ("–" if factor is None else number(factor, 5), ""),
        **{
            words: (number(float(length(summary[name])), 6), length.unit)
            for words, name in (
                ("least displacement", "least"), ("greatest displacement", "greatest"),
                (f"half backlash{', mean of the turn' * (of > 1)}", "half_backlash"),
            )
        },
    }  # fmt: skip
    rows = [{"name": k, "value": value, "unit": unit} for k, (value, unit) in values.items()]
    columns = (
        Column("order", "order", 4),
        Column("", lambda line: "half order" if line["half_order"] else line.get("name") or ""),
        Column(f"amplitude [{length.unit}]", lambda line: length(line["amplitude"]), 5),
        Column("frequency [Hz]", "frequency_hz", 6),
    )
    strongest = sorted(summary["lines"], key=lambda line: -float(line["amplitude"]))[:12]
    half = itemgetter("half_order")
    return [
        declared("Orbit", ORBIT, rows),
        declared("Greatest lines", columns, strongest, names=2, marked=half),
    ]


def _complex(mu: dict[str, float]) -> str:
    """A multiplier to nine places, of a train to those that finer steps confirm."""
    error = mu.get("error", 0.0)
    text = _part(mu["real"], error)
    if mu["imag"] != 0.0:
        text += f" {'+' if mu['imag'] > 0 else '−'} {_part(abs(mu['imag']), error)} i"
    return text


def _part(value: float, error: float = 0.0) -> str:
    """``value`` to nine places, or fewer that ``error`` leaves; a small one as a power of ten."""
    if error < abs(value) < SMALL:
        return number(value, 1 if error else 5)
    places = min(max(math.floor(-math.log10(2.0 * error)), 0), 9) if error else 9
    return f"{value:z.{places}f}".replace("-", "−")


def _lyapunov_tables(summary: Summary) -> list[Block]:
    per_second = summary["per_second"]
    values = {
        "largest exponent λ₁": f"{summary['exponent']:.6f}",
        **({} if per_second is None else {"λ₁ [1/s]": number(per_second, 5)}),
        "standard error": f"{summary['error']:.6f}",
        "other exponent": f"{summary['second']:.6f}",
        "sum = −2 ζ": f"{summary['sum']:.9g}",
        "Kaplan-Yorke dimension of the section": f"{summary['kaplan_yorke']:.5f}",
        "λ₁ per mesh period": f"{summary['per_mesh_period']:.6f}",
        "batches": f"{summary['batches']} of {summary['batch_periods']} periods",
    }
    return [pairs("Lyapunov exponents", ("quantity", "value"), values)]


def _branch_tables(summary: Summary) -> list[Block]:
    points = (
        Column("kind", "kind"),
        Column("orbit", "orbit"),
        Column(page_words(summary["parameter"]), lambda point: shown(point, 10)),
        Column("largest multiplier", lambda point: _complex(point["multipliers"][0])),
        Column("note", "note"),
    )
    legs = (
        Column("orbit", "orbit"),
        Column("ended", "ended"),
        Column("points", "points"),
        Column("stable", "stable_points"),
    )
    of = summary.get("mesh_periods", 1)
    words = partial(label_words, followed=0, starts=1, mesh_periods=of)
    found, branches = (
        [row | {"orbit": words(f"period-{row['period']}")} for row in summary[name]]
        for name in ("bifurcations", "branches")
    )
    none = Text("No bifurcation was found on the way.")
    return [
        *_train_words(summary.get("train", {})),
        declared("Bifurcations", points, found, names=2) if found else none,
        declared("Branches", legs, branches, names=2),
        *plane_tables(summary),
    ]


def _train_words(train: Summary) -> list[Block]:
    """What the reduced drive train is, and how far values between its computed ones are off."""
    words = (
        [f"Drive train in {train['coordinates']} coordinates; {train['began']}."] if train else []
    )
    straight = train.get("straight")
    if straight is not None:
        words.append(
            f"Half way between computed values the greatest mesh force is off by "
            f"{PERCENT(straight['force']):.2g} %, the largest multiplier by "
            f"{straight['multiplier']:.2g}."
        )
    return [Text(text, "note") for text in words]


ORBIT = (Column("quantity", "name"), Column("value", "value"), Column("unit", "unit"))
_TABLES: dict[str, Callable[[Summary], list[Block]]] = {
    "orbit": _orbit_tables,
    "lyapunov": _lyapunov_tables,
    "branch": _branch_tables,
}
