"""The page of the thesis's claims, and of a sensitivity study, from what is stored alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from markupsafe import Markup

from thermogear.base.arrays import Dataset
from thermogear.base.display import MICROMETRE, celsius
from thermogear.results.result import Result
from thermogear.views.columns import PLAIN, Column, Row, declared, in_full, key, pairs, rows_along
from thermogear.views.page import (
    LEAD,
    Block,
    Gallery,
    Page,
    Pictures,
    Section,
    Table,
    Text,
    without,
)
from thermogear.views.pages import captions, gear_sections, rig_trains, row_sections
from thermogear.views.pages.background import background
from thermogear.views.pages.record_tables import comparison_table, implied_table
from thermogear.views.pages.sensitivity import sensitivity_section
from thermogear.views.plots import claims as plots
from thermogear.views.plots.sweeps import over_each_other
from thermogear.views.typesetting import html_symbol, prose

PREFIX = "diagrams/"
DIAGRAMS = {"zeta": "damping", "omega": "frequency", "epsilon": "stiffness"}
SECTIONS = {
    2: "Thermal deformation of the tooth",
    3: "Dynamic model",
    4: "Simulation results",
    5: "Tests",
    6: "Conclusions",
}
CONCLUSIONS = 6
OPENING = "warming"
"""The picture that the page opens with."""
NOT_HERE = "Stopped before it was computed."
MARKED = ("contradicted",)
BASE_SETS = ("base_sets/table-4.2", "base_sets/section-4.1")


KINDS = ("thesis",)


def page(result: Result) -> Page:
    """What holds and what does not, verdicts, then every section with its claims and pictures."""
    pictures = Pictures()
    sections = _thesis_sections(result, pictures)
    opening = _opening(result, sections)
    sections = [opening, *(without(one, {OPENING}) for one in sections), _outlook(result)]
    if "sensitivity" in result.groups:
        sections.append(sensitivity_section(result, pictures))
    return Page(
        replace(result, notices=()),
        _summary(result),
        sections + background(result),
        numbers=lambda: _numbers(result),
        told=lambda: _told(result),
    )


def _summary(results: Result) -> str:
    sentences = results.table("sentences")
    count = sum(results.table("counts").values())
    total = int(results.text("claims_in_all") or count)
    cut = (
        f"Stopped on request before the end: {total - count} of {total} claims are not judged "
        "here, and what only they need is missing; the same command computes all of it. "
    )
    return (cut if count < total else "") + (
        f"{count} statements, formulas, figures and table entries of sections 2 to 6, each with "
        "what the package computes as in the thesis and consistently, a verdict, its argument and "
        f"the code behind it. {sentences.get('claimed', 0)} of the document's "
        f"{sentences.get('all', 0)} sentences claim something; the others are headings, background "
        f"and outlook. Computed in {float(results.text('seconds')):.0f} s."
    )


def _opening(results: Result, sections: Sequence[Section]) -> Section:
    """The conclusions, those that hold first, and one picture."""
    claims, verdicts = results.groups["claims"], list(results.table("counts"))
    rows = [row for row in rows_along(claims, "claim") if _section(row["number"]) == CONCLUSIONS]
    rows.sort(key=lambda row: verdicts.index(row["verdict"]))
    blocks: list[Block] = []
    if rows:
        caption = "Its conclusions, one by one."
        blocks.append(declared(caption, CONCLUSION, rows, names=3, wordy=True))
    galleries = [b for one in sections for b in one.blocks if isinstance(b, Gallery)]
    shown = [one for gallery in galleries for one in gallery.pictures if one.name == OPENING]
    blocks += [Gallery(shown)] * bool(shown)
    return Section(LEAD, "What holds, what does not, and why", blocks, folded=False)


def _outlook(results: Result) -> Section:
    """What the document leaves to later work: what is computed of it, here and for any pair."""
    path, trains = results.group("path"), results.group("rig_trains")
    film = "" if path is None else captions.regimes(path.isel(bundle=-1, state=-1))
    rows = [
        {
            "left": "other regimes of lubrication",
            "of_rig": film or NOT_HERE,
            "for_any": "thermogear friction CASE",
        },
        {
            "left": "shafts that bend, bearings with clearance",
            "of_rig": NOT_HERE if trains is None else str(trains.attrs["sentence"]),
            "for_any": "thermogear run CASE, with [[shafts]] and [[bearings]]",
        },
        {
            "left": "temperatures measured better",
            "of_rig": "The rig's temperatures are given. Readings in the case are corrected, and "
            "the heat balance is held to them.",
            "for_any": "thermogear temperature CASE, with [gearbox.readings]",
        },
        {
            "left": "design, and diagnosis of faults",
            "of_rig": "An appraisal, not judged here.",
            "for_any": "thermogear answers CASE; thermogear measure FILE",
        },
    ]
    return Section("outlook", "Outlook", [declared("", OUTLOOK, rows, names=3, wordy=True)])


def _thesis_sections(results: Result, pictures: Pictures) -> list[Section]:
    claims = results.groups["claims"]
    ordered = {name: results.groups[name] for name in BASE_SETS if name in results.groups}
    rest = {name: data for name, data in results.groups.items() if name not in ordered}
    results = replace(results, groups={**ordered, **rest})
    found = [_counted(results, claims)]
    drawn = {
        2: _deformation(results, pictures),
        3: _model(results, pictures),
        4: _simulation(results, pictures),
        5: _tests(results, pictures),
        6: [],
    }
    galleries = [b for blocks in drawn.values() for b in blocks if isinstance(b, Gallery)]
    shown = {f"fig-{picture.name}" for gallery in galleries for picture in gallery.pictures}
    for place, title in SECTIONS.items():
        here = claims.isel(claim=np.flatnonzero([_section(n) == place for n in _names(claims)]))
        if not here.sizes["claim"]:
            continue  # stopped before it
        blocks: list[Block] = [_claims_table(here, place, shown), *drawn[place]]
        found.append(Section(f"section-{place}", f"{place} {title}", blocks))
    return found


def _names(claims: Dataset) -> list[str]:
    return [str(value) for value in claims["number"].values]


def _section(name: str) -> int:
    return int(name.split(".")[0])


def _counted(results: Result, claims: Dataset) -> Section:
    verdicts = list(results.table("counts"))
    found = Counter(
        (_section(n), str(v)) for n, v in zip(_names(claims), claims["verdict"].values, strict=True)
    )
    rows: list[Row] = [
        {"name": f"{place} {title}", **{v: found[place, v] for v in verdicts}}
        for place, title in SECTIONS.items()
    ]
    rows.append({"name": "all", **{v: sum(row[v] for row in rows) for v in verdicts}})
    columns = [
        Column("section", "name"),
        *(Column(verdict, verdict) for verdict in verdicts),
        Column("claims", lambda row: sum(row[v] for v in verdicts)),
    ]
    intro = Text(
        "A claim is reproduced where the computation gives it from what the document states; under "
        "a stated assumption where a value or a reading of ours is needed; it cannot be decided "
        "where what is missing decides the result; it is contradicted where the result differs "
        "whatever is assumed."
    )
    table = declared("Verdicts by section of the document.", columns, rows)
    return Section("verdicts", "Verdicts", [intro, table], folded=False)


def _claims_table(claims: Dataset, place: int, shown: Collection[str]) -> Table:
    rows = [
        row | {"drawn": f"fig-{row['picture']}" in shown} for row in rows_along(claims, "claim")
    ]
    return declared(
        f"Section {place}, claim by claim; contradicted ones are marked.",
        CLAIM,
        rows,
        names=4,
        marked=lambda row: row["verdict"] in MARKED,
        wordy=True,
    )


def _number(row: Row) -> Markup:
    words = Markup('<b id="claim-{0}">{0}</b><br/><small>{1}</small>')
    return words.format(row["number"], row["kind"])


def _words(row: Row) -> Markup:
    link = Markup('<br/><small><a href="#fig-{}">picture</a></small>').format(row["picture"])
    words = Markup("{}<br/><small>{}</small>").format(prose(row["words"]), row["place"])
    return words + link if row["drawn"] else words


def _computed(row: Row) -> Markup:
    words = Markup("<b>as in the thesis:</b> {}<br/><b>consistent:</b> {}")
    return words.format(prose(row["as_in_the_thesis"]), prose(row["consistent"]))


def _judged(row: Row) -> Markup:
    words = Markup("<b>{}</b><br/>{}<br/><small>{}</small>")
    return words.format(row["verdict"], prose(row["argument"]), _code(row["code"]))


CONCLUSION = (
    Column("verdict", lambda row: Markup("<b>{}</b>").format(row["verdict"])),
    Column(
        "conclusion of the document",
        lambda row: Markup('{} <a href="#claim-{}">{}</a>').format(
            prose(row["words"]), row["number"], row["number"]
        ),
    ),
    Column("why", lambda row: prose(row["argument"])),
)
OUTLOOK = (
    Column("left to later work", "left"),
    Column("of the rig", "of_rig"),
    Column("for any gears", "for_any"),
)
CLAIM = (
    Column("no.", _number),
    Column("claim, in our words", _words),
    Column("computed", _computed),
    Column("verdict, argument, code", _judged),
)


def _code(names: str) -> Markup:
    short = [name.removeprefix("thermogear.") for name in names.split()]
    return Markup(", ").join(Markup("{}").format(name.replace(".", ".\u200b")) for name in short)


def _blocks(section: Section | None) -> list[Block]:
    return [] if section is None else [block for block in section.blocks if block.kind != "text"]


def _deformation(results: Result, pictures: Pictures) -> list[Block]:
    found = _blocks(gear_sections.friction(results, pictures))
    grid = results.group("grid")
    if grid is not None:
        for name, heading, unit, scale in (
            ("friction", "Friction over speed and torque", "mean friction coefficient [–]", PLAIN),
            ("flash", "Flash temperature over speed and torque", "highest flash [K]", PLAIN),
            (
                "growth",
                "Growth over speed and torque",
                "mean growth of both flanks [µm]",
                MICROMETRE,
            ),
        ):
            pictures.add(
                f"grid-{name}", heading,
                "Left with the gear temperature of the case at every point, right with the one "
                "that losses and cooling lead to. Full lines mixed, dashed ones dry.",
                grid, ("speed", "torque"),
                lambda n=name, u=unit, s=scale: plots.over_grid(grid, n, u, s),  # type: ignore[misc]
                wide=True,
            )  # fmt: skip
        found += pictures.take()
    return found + _blocks(gear_sections.heat(results, pictures))


def _model(results: Result, pictures: Pictures) -> list[Block]:
    found = _blocks(gear_sections.gap(results, pictures))
    return found + _blocks(gear_sections.springs(results, pictures))


def _simulation(results: Result, pictures: Pictures) -> list[Block]:
    found = _blocks(row_sections.base_sets(results, pictures))
    warming, flips = results.group("warming"), results.group("flips")
    if warming is not None:
        pictures.add(
            "warming", "Stability over temperature",
            "The temperature row of section 4.1. Stiffening by heat leads to a flip; the softening "
            "of steel leads away from it.",
            warming, ("multiplier",), lambda: plots.warming(warming),
        )  # fmt: skip
    for row, words in DIAGRAMS.items():
        heats = [heat for heat in plots.HEATS if f"{PREFIX}{row}/{heat}" in results.groups]
        each = [results.groups[f"{PREFIX}{row}/{heat}"] for heat in heats]
        for data in each[:1]:
            pictures.add(
                f"diagram-{row}", f"Bifurcation diagram over {words}",
                "Sections of the settled motion, swept up and down: without heat, with the heat of "
                "the thesis, with the consistent one. The largest Lyapunov exponent below.",
                data, (),
                lambda e=each, n=heats: over_each_other(e, [plots.HEATS[h][0] for h in n]),  # type: ignore[misc]
                wide=True,
            )  # fmt: skip
    if flips is None:
        return found + pictures.take()
    return [*found, *pictures.take(), _flip_table(flips)]


def _flip_table(flips: Dataset) -> Table:
    heats = {
        "none": "none",
        "thesis": "as in the thesis",
        "consistent": "by E(T)",
        "backlash": "closing gap alone",
    }
    warm = celsius(float(flips.attrs.get("temperature", np.nan)))
    caption = (
        "Period doublings located by continuation, along the document's direction; heat is that "
        f"at {warm}. The gap alone moves nothing as long as no back flank is hit."
    )
    columns = (
        Column("parameter", lambda row: html_symbol(SYMBOLS[row["row"]])),
        Column("heat", lambda row: heats[row["heat"]]),
        Column("why no more", "note"),
        *(
            Column(f"{2**k} → {2 ** (k + 1)}", f"flip_{k}", ".9g", PLAIN)
            for k in range(flips.sizes["flip"])
        ),
    )
    values = {f"flip_{k}": flips["value"].isel(flip=k) for k in range(flips.sizes["flip"])}
    rows = rows_along(flips.assign(values), "row", "heat")
    return declared(caption, columns, rows, names=3)


SYMBOLS = {"zeta": "ζ", "omega": "ω_h", "epsilon": "ε"}


def _tests(results: Result, pictures: Pictures) -> list[Block]:
    data = results.group("experiment")
    if data is None:
        return []
    pictures.add(
        "experiment", "Errors of the printed table",
        "Recomputed from the table's own entries; black bars as printed. Grey is what the unstated "
        "processing leaves open: a smaller difference of two bars tells nothing.",
        data, ("u_val",), lambda: plots.experiment(data),
    )  # fmt: skip
    found: list[Block] = [comparison_table(data)]
    found += [implied_table(results.groups["implied"]), *pictures.take()]
    found += rig_trains.blocks(results, pictures)
    return found + _blocks(gear_sections.vibration(results, pictures))


# --- figures as JSON wants them ---------------------------------------------------------------


def _numbers(result: Result) -> dict[str, Any]:
    """Counts, verdicts and the ranking of the inputs, JSON-ready."""
    claims = result.groups["claims"]
    columns = [key(str(name)) for name in claims.data_vars]
    rows = [in_full(columns, row) for row in rows_along(claims, "claim")]
    found = {
        "claims": len(rows),
        "claims_in_all": int(result.text("claims_in_all")),
        "verdicts": result.table("counts"),
        "sentences": result.table("sentences"),
        "seconds": float(result.text("seconds")),
        "rows": rows,
    }
    trains = result.group("rig_trains")
    if trains is not None:
        found["experiment"] = rig_trains.numbers(trains)
    if "sensitivity" in result.groups:
        ranked = result.groups["sensitivity"]
        found["sensitivity"] = {
            "evaluations": int(ranked.attrs["evaluations"]),
            "seconds": float(ranked.attrs["seconds"]),
            "results": ranked["sentence"].values.tolist(),
        }
    return found


def _told(result: Result) -> list[Block]:
    counts, all_ = result.table("counts"), int(result.text("claims_in_all"))
    claims = sum(counts.values())
    of = f" of {all_}" if claims < all_ else ""
    seconds = float(result.text("seconds"))
    return [
        Text(f"{claims}{of} claims in {seconds:.0f} s"),
        pairs("", ("verdict", "claims"), counts),
    ]
