"""The page of the thesis's claims, and of a sensitivity study, from what is stored alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from thermogear.base.display import celsius
from thermogear.results.result import Result
from thermogear.views.page import (
    LEAD,
    Block,
    Cell,
    Code,
    Gallery,
    Page,
    Pictures,
    Section,
    Table,
    Text,
    Tile,
    without,
)
from thermogear.views.pages import captions, gear_sections, rig_trains, row_sections
from thermogear.views.pages.background import background
from thermogear.views.pages.record_tables import comparison_table, implied_table
from thermogear.views.pages.sensitivity import sensitivity_section
from thermogear.views.plots import claims as plots
from thermogear.views.plots.sweeps import over_each_other
from thermogear.views.typesetting import html_symbol, prose

if TYPE_CHECKING:
    import xarray as xr

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
        tiles=_tiles(result),
        numbers=lambda: _numbers(result),
        lines=lambda: _lines(result),
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
    """The conclusions, those that hold first, one picture, and the same for the reader's gears."""
    claims, verdicts = results.groups["claims"], list(results.table("counts"))
    rows: list[list[Cell]] = [
        [
            Markup("<b>{}</b>").format(str(one["verdict"].item())),
            Markup('{} <a href="#claim-{}">{}</a>').format(
                prose(str(one["words"].item())), name, name
            ),
            prose(str(one["argument"].item())),
        ]
        for place, name in enumerate(_names(claims))
        for one in (claims.isel(claim=place),)
        if _section(name) == CONCLUSIONS
    ]
    rows.sort(key=lambda row: verdicts.index(Markup(row[0]).striptags()))
    blocks: list[Block] = []
    if rows:
        head = ["verdict", "conclusion of the document", "why"]
        blocks.append(Table("Its conclusions, one by one.", head, rows, names=3, wordy=True))
    galleries = [b for one in sections for b in one.blocks if isinstance(b, Gallery)]
    shown = [one for gallery in galleries for one in gallery.pictures if one.name == OPENING]
    blocks += [Gallery(shown)] * bool(shown)
    blocks += [
        Text("Redo this for your gears: every step of the document for one pair."),
        Code("thermogear new -o mine.toml\nthermogear thesis mine.toml -o mine"),
    ]
    return Section(LEAD, "What holds, what does not, and why", blocks, folded=False)


def _outlook(results: Result) -> Section:
    """What the document leaves to later work: what is computed of it, here and for any pair."""
    path, trains = results.group("path"), results.group("rig_trains")
    film = "" if path is None else captions.regimes(path.isel(bundle=-1, state=-1))
    rows: list[list[Cell]] = [
        [
            "other regimes of lubrication", film or NOT_HERE,
            "thermogear friction CASE",
        ],
        [
            "shafts that bend, bearings with clearance",
            NOT_HERE if trains is None else str(trains.attrs["sentence"]),
            "thermogear run CASE, with [[shafts]] and [[bearings]]",
        ],
        [
            "temperatures measured better",
            "The rig's temperatures are given. Readings in the case are corrected, and the heat "
            "balance is held to them.",
            "thermogear temperature CASE, with [gearbox.readings]",
        ],
        [
            "design, and diagnosis of faults",
            "An appraisal, not judged here.",
            "thermogear answers CASE; thermogear measure FILE",
        ],
    ]  # fmt: skip
    head = ["left to later work", "of the rig", "for any gears"]
    return Section("outlook", "Outlook", [Table("", head, rows, names=3, wordy=True)])


def _tiles(results: Result) -> list[Tile]:
    found = results.table("counts")
    total = sum(found.values())
    return [
        Tile(name, str(count), f"{100 * count / total:.0f} % of {total} claims")
        for name, count in found.items()
    ]


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


def _names(claims: xr.Dataset) -> list[str]:
    return [str(value) for value in claims["number"].values]


def _section(name: str) -> int:
    return int(name.split(".")[0])


def _counted(results: Result, claims: xr.Dataset) -> Section:
    verdicts = list(results.table("counts"))
    found = Counter(
        (_section(n), str(v)) for n, v in zip(_names(claims), claims["verdict"].values, strict=True)
    )
    rows: list[list[Cell]] = []
    for place, title in SECTIONS.items():
        numbers = [found[place, verdict] for verdict in verdicts]
        rows.append([f"{place} {title}", *map(str, numbers), str(sum(numbers))])
    total = [sum(found[p, v] for p in SECTIONS) for v in verdicts]
    rows.append(["all", *map(str, total), str(sum(total))])
    intro = Text(
        "A claim is reproduced where the computation gives it from what the document states; under "
        "a stated assumption where a value or a reading of ours is needed; it cannot be decided "
        "where what is missing decides the result; it is contradicted where the result differs "
        "whatever is assumed."
    )
    table = Table("Verdicts by section of the document.", ["section", *verdicts, "claims"], rows)
    return Section("verdicts", "Verdicts", [intro, table], folded=False)


def _claims_table(claims: xr.Dataset, place: int, shown: Collection[str]) -> Table:
    rows: list[list[Cell]] = []
    marked: set[int] = set()
    for k in range(claims.sizes["claim"]):
        one = {name: str(claims[name].values[k]) for name in claims.data_vars}
        if one["verdict"] in MARKED:
            marked.add(k)
        picture = (
            Markup('<br/><small><a href="#fig-{}">picture</a></small>').format(one["picture"])
            if f"fig-{one['picture']}" in shown
            else Markup("")
        )
        rows.append([
            Markup('<b id="claim-{0}">{0}</b><br/><small>{1}</small>').format(
                one["number"], one["kind"]),
            Markup("{}<br/><small>{}</small>{}").format(
                prose(one["words"]), one["place"], picture),
            Markup("<b>as in the thesis:</b> {}<br/><b>consistent:</b> {}").format(
                prose(one["as_in_the_thesis"]), prose(one["consistent"])),
            Markup("<b>{}</b><br/>{}<br/><small>{}</small>").format(
                one["verdict"], prose(one["argument"]), _code(one["code"])),
        ])  # fmt: skip
    head: list[Cell] = ["no.", "claim, in our words", "computed", "verdict, argument, code"]
    caption = f"Section {place}, claim by claim; contradicted ones are marked."
    return Table(caption, head, rows, names=4, marked=frozenset(marked), wordy=True)


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
            ("friction", "Friction over speed and torque", "mean friction coefficient [–]", 1.0),
            ("flash", "Flash temperature over speed and torque", "highest flash [K]", 1.0),
            ("growth", "Growth over speed and torque", "mean growth of both flanks [µm]", 1e6),
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


def _flip_table(flips: xr.Dataset) -> Table:
    heats = {
        "none": "none",
        "thesis": "as in the thesis",
        "consistent": "by E(T)",
        "backlash": "closing gap alone",
    }
    rows: list[list[Cell]] = []
    for row in flips["row"].values:
        for heat in flips["heat"].values:
            one = flips.sel(row=row, heat=heat)
            cells = [f"{v:.9g}" if np.isfinite(v) else "–" for v in one["value"].values]
            symbol = {"zeta": "ζ", "omega": "ω_h", "epsilon": "ε"}[str(row)]
            rows.append([html_symbol(symbol), heats[str(heat)], *cells, str(one["note"].item())])
    head = [
        "parameter", "heat", *(f"{2**k} → {2 ** (k + 1)}" for k in range(flips.sizes["flip"])),
        "why no more",
    ]  # fmt: skip
    warm = celsius(float(flips.attrs.get("temperature", np.nan)))
    caption = (
        "Period doublings located by continuation, along the document's direction; heat is that "
        f"at {warm}. The gap alone moves nothing as long as no back flank is hit."
    )
    lines = [[*row[:2], row[-1], *row[2:-1]] for row in rows]
    return Table(caption, [head[0], head[1], head[-1], *head[2:-1]], lines, names=3)


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


# --- figures as the terminal and JSON want them -----------------------------------------------


def _numbers(result: Result) -> dict[str, Any]:
    """Counts, verdicts and the ranking of the inputs, JSON-ready."""
    claims = result.groups["claims"]
    rows = [
        {str(name): str(column.values[k]) for name, column in claims.data_vars.items()}
        for k in range(claims.sizes["claim"])
    ]
    found = {
        "thermogear": result.text("thermogear"),
        "title": result.title,
        "kind": "thesis",
        "claims": len(rows),
        "claims_in_all": int(result.text("claims_in_all")),
        "verdicts": result.table("counts"),
        "sentences": result.table("sentences"),
        "seconds": round(float(result.text("seconds")), 1),
        "rows": rows,
    }
    trains = result.group("rig_trains")
    if trains is not None:
        found["experiment"] = rig_trains.numbers(trains)
    if "sensitivity" in result.groups:
        ranked = result.groups["sensitivity"]
        found["sensitivity"] = {
            "evaluations": int(ranked.attrs["evaluations"]),
            "seconds": round(float(ranked.attrs["seconds"]), 1),
            "results": [str(text) for text in ranked["sentence"].values],
        }
    return found


def _lines(result: Result) -> list[str]:
    found = _numbers(result)
    cut = found["claims"] < found["claims_in_all"]
    of = f" of {found['claims_in_all']}" if cut else ""
    return [
        f"{found['claims']}{of} claims in {found['seconds']:.0f} s",
        *(f"{count:6d}  {verdict}" for verdict, count in found["verdicts"].items()),
    ]
