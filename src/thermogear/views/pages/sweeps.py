"""The page of a diagram, map, basin, sweep or run-up, from its stored dataset alone."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS, MICROMETRE, PERCENT, SPEED, exactly, number
from thermogear.base.period import line_names
from thermogear.base.vocabulary import ASSUMED, FASTER_RULE, contact_name, of_turn
from thermogear.results.result import Result
from thermogear.results.tables import in_words
from thermogear.views.columns import PLAIN, Column, Row, declared, in_full, key, pairs, rows_along
from thermogear.views.page import LEAD, Block, Page, Pictures, Section, Table, Text
from thermogear.views.pages.findings import finding, lost_rows, lost_words, ways_apart
from thermogear.views.picture import Picture
from thermogear.views.plots import sweeps
from thermogear.views.plots.lost_contact import (
    forces_picture,
    has_lost,
    lost_contact_picture,
    map_picture,
    things,
)
from thermogear.views.plots.parameters import named, page_words, parameter_of, shown

Words = Callable[[Dataset], str]
TITLES = {
    "diagram": "Orbit diagram",
    "map": "Map of regimes",
    "basins": "Basins of attraction",
    "sweep": "Sweep",
    "run-up": "Run-up",
}


JUMPS_EXPLAINED = (
    "Between two speeds the motion is followed slowly, so a jump stands where the motion ends, not "
    "at a step of the run; chaos is run through in steps of 0.5 % of the speed, and what lives on "
    "less than that is passed over. Between a jump and the return of the run back two motions "
    "exist, and which one is seen depends on where the run came from."
)
TURN_EXPLAINED = (
    "Over the turn the motion at each speed begins as the one at the speed before it, and is "
    "followed in fixed steps until it repeats itself after one turn or up to eight. A jump stands "
    "at the first speed behind it, and no orbit, fold or multiplier is located between two speeds."
)
TURN_LINES = "Lines of the transmission error, each where it is greatest."
EXPLAINED = {
    "fold": "Fold: the motion ends here and jumps to another one.",
    "period doubling": "Period doubling: from here on every second mesh is alike only.",
    "grazing": "Grazing: the teeth just touch, or just part: a contact begins or ends here.",
    "period halving": "Period halving: a motion of twice the period ends in one of half of it.",
    "pitchfork": "Pitchfork: a symmetric motion loses its symmetry here.",
}


OF_SERIES = (
    " Of the series of the case's class, pairs over their turns, the worse of two starts: band, "
    "median (long dashes) and what one pair in ten exceeds. All else is of one pair, the case's "
    "own drawing: its mean tooth, unless its turn is asked for."
)
LOST_MAP = (
    "Teeth: whether the drive flanks part at some moment of the settled motion, and whether the "
    "back flanks are hit then. Bearings: which bear nothing at some of 64 moments a mesh period. A "
    "preloaded bearing never does."
)
LOST_DIAGRAM = (
    "Greatest force of the drive flanks and on every bearing, up (full) and down (dashed); below "
    "the share of the time in which the drive flank, or the bearing, carries nothing."
)

KINDS = ("diagram", "map", "basins", "sweep", "run-up")


def page(result: Result) -> Page:
    """Pictures, located points, and how it was computed."""
    data = result.data
    if not result.title:
        result = replace(result, title=TITLES[result.kind])
    points, settings = _points(data, result), _settings(data)
    # what loses contact at each value is for the page
    located = [
        block for block in points.blocks if isinstance(block, Table) and block.caption != CONTACT
    ]
    return Page(
        result,
        _summary(data),
        [_pictures(data), points, settings],
        numbers=lambda: numbers(result),
        told=lambda: [Text(_summary(data)), *located, *settings.blocks],
    )


def _summary(data: Dataset) -> str:
    kind = str(data.attrs["kind"])
    if "label" in data:
        said = [lost_words(data), finding(data), f"{_rule(data).capitalize()}."]
        if kind in ("diagram", "run-up"):  # of the others the finding counts the points
            code, names = sweeps.classes_of(data), sweeps.class_words(data)
            parts = [f"{names[n]} at {PERCENT(np.mean(code == n)):.3g} %" for n in np.unique(code)]
            said.insert(2, f"Of {code.size} points: {', '.join(parts)}.")
        return " ".join(one for one in said if one)
    return finding(data)


def _rule(data: Dataset) -> str:
    """What stands behind the labels."""
    return str(data["label"].attrs.get("comment", FASTER_RULE)) if "label" in data else FASTER_RULE


def _pictures(data: Dataset) -> Section:
    pictures = Pictures()
    for kind, of_lost, name, heading, caption, make in PICTURES:
        if kind == data.attrs["kind"] and (has_lost(data) or not of_lost):
            words = caption if isinstance(caption, str) else caption(data)
            pictures.add(name, heading, words, data, (), partial(make, data), wide=True)
    return Section(LEAD, "In pictures", pictures.take(), folded=False)


MAP = (
    "What the motion from one start settles on; beside it what loses contact. Hatched: assumed, "
    "not computed; points computed around it are alike."
)
DIAGRAM = (
    "Sections at phase 0 of the settled motion, each value starting from the end of the last: up "
    "with rising values, down with falling ones; branches from continuation, where they were "
    "followed. The largest Lyapunov exponent below, full up, dashed down."
)


def _sweep_caption(data: Dataset) -> str:
    rest = [str(name) for name in data["label"].dims[2:]]
    at = [f"{page_words(n, data[n])} {number(float(shown(n, data[n][0])))}" for n in rest]
    drawn = f" Drawn at {', '.join(at)}." * bool(at)
    return f"Every point from the case's own start.{_of_series(data)}{drawn}"


def _run_up_caption(data: Dataset) -> str:
    words = "Full lines run up, dashed ones down; thin vertical lines are located folds."
    return words + _of_series(data)


def _of_series(data: Dataset) -> str:
    return OF_SERIES if "series_parts" in data else ""


def _waterfall_caption(data: Dataset) -> str:
    words = "Lines of the transmission error over speed and order, running up"
    of = int(data.attrs.get("mesh_periods", 1))
    if of == 1:
        return f"{words}."
    pinion, wheel = (int(z) for z in data.attrs["teeth"])
    return (
        f"{words}: of the mesh with the side lines beside its harmonics, below of the slower shaft "
        f"whose turns fill the {of} mesh periods. Order 1 of the pinion is 1/{pinion} of the mesh, "
        f"of the wheel 1/{wheel}."
    )


PICTURES: tuple[tuple[str, bool, str, str, str | Words, Callable[[Dataset], Picture]], ...] = (
    ("diagram", False, "orbits", "Orbit diagram", DIAGRAM, sweeps.orbit_diagram_picture),
    ("diagram", True, "forces", "Forces and losses of contact", LOST_DIAGRAM, forces_picture),
    ("map", True, "contact", "What loses contact", LOST_MAP, lost_contact_picture),
    ("map", False, "regimes", "Regimes over two parameters", MAP, map_picture),
    (
        "basins", False, "basins", "Basins",
        "Which attractor every start ends on; dots are their sections.", sweeps.basins_picture,
    ),
    ("sweep", False, "sweep", "Response", _sweep_caption, sweeps.sweep_picture),
    ("run-up", False, "runup", "Response over speed", _run_up_caption, sweeps.run_up_picture),
    ("run-up", False, "waterfall", "Waterfall", _waterfall_caption, sweeps.waterfall_picture),
)  # fmt: skip
"""Of which kind, whether only where losses of contact are told, name, heading, caption, picture."""


def _turn_lines(data: Dataset) -> list[dict[str, Any]]:
    """Of every line of a turn its greatest amplitude in the run-up and where; greatest first."""
    lines = data["dte_line"].values.reshape(-1, data.sizes["order"])
    names = line_names(data.attrs, data["order"].values)
    known = np.where(np.isfinite(lines), lines, -1.0)
    place = np.unravel_index(known.argmax(axis=0), data["dte_line"].shape[:-1])
    at = dict(zip(map(str, data["dte_line"].dims), place, strict=False))
    rows: list[dict[str, Any]] = [
        {"line": name, "order": float(order), "amplitude": float(known[:, n].max()),
         "speed": float(data["pinion_speed"].values[at["pinion_speed"][n]]),
         "gears": float(data["gear_temperature"].values[at["state"][n]])}
        for n, (name, order) in enumerate(zip(names, data["order"].values,
                                              strict=True))
        if known[:, n].max() > 0.0
    ]  # fmt: skip
    return sorted(rows, key=lambda row: -float(row["amplitude"]))[:MOST_LINES]


def _points(data: Dataset, result: Result) -> Section:
    blocks: list[Block] = [lost_table(data)] if result.kind == "diagram" and has_lost(data) else []
    if "label" in data:
        blocks.append(_motions(data))
    if has_lost(data):
        blocks.append(declared("What loses contact.", LOST_AT, lost_rows(data)))
    blocks += _borders(data)
    columns, found = bifurcations(data)
    if found:
        blocks.append(declared("Located bifurcations", columns, found))
        kinds = {columns[0].figure(row) for row in found}
        blocks.append(Text(" ".join(w for kind, w in EXPLAINED.items() if kind in kinds)))
    jumps = _jumps(data)
    if "series_dynamic_factor" in data:
        blocks.append(declared(SERIES_AT_WORST, SERIES, _series(data)))
    if jumps:
        blocks.append(declared("Jumps", JUMPS, jumps))
        blocks.append(Text(JUMPS_EXPLAINED))
    elif "mesh_periods" in data.attrs:
        blocks.append(Text(TURN_EXPLAINED))
        if str(data.attrs["kind"]) == "run-up":
            blocks.append(declared(TURN_LINES, LINES, _turn_lines(data)))
    elif str(data.attrs["kind"]) == "run-up":
        blocks.append(
            Text(
                "No motion was lost at a fold. Where up and down differ all the same (see the "
                "notes), a motion ended in another way, as chaos does, which is not located."
            )
        )
    attractors = _attractors(data)
    if attractors:
        blocks.append(declared("Attractors", ATTRACTORS, attractors))
        entropy = data.attrs
        blocks.append(
            Text(
                f"Basin entropy {entropy['basin_entropy']:.4f}, on borders "
                f"{entropy['boundary_basin_entropy']:.4f} (above ln 2 = 0.6931 a border is "
                f"fractal), in boxes of {entropy['box_cells']} x {entropy['box_cells']} starts. "
                f"{_rule(data).capitalize()}."
            )
        )
    return Section("points", "Located points", blocks)


def _borders(data: Dataset) -> list[Block]:
    """Where the borders of contact loss end, and why."""
    if "borders" not in data.attrs:
        return []
    bearings = named(data, "bearing") if "bearing" in data.coords else []
    states = named(data, "state") if "state" in data.dims else [""]
    rows = [
        {
            "border": f"{row + 1} {contact_name(int(data['border_contact'][row]), bearings)}",
            "state": states[int(data["border_state"][row])],
            "period": about["period"],
            "at": end[:2],
            "why": end[2],
        }
        for row, about in enumerate(json.loads(data.attrs["borders"]))
        for end in about["ends"]
    ]
    dims = [str(name) for name in data["label"].dims[-2:]]
    places = [
        Column(page_words(name, data[name]), partial(_shown_end, data, name, place))
        for place, name in enumerate(dims)
    ]
    columns = (*BORDER, *places, Column("why", "why"))
    ends: list[Block] = [declared("Ends of borders.", columns, rows)] if rows else []
    if data.attrs.get("borders_cut"):
        return [*ends, Text(CUT_BORDERS)]
    return ends or [Text(NO_BORDER)]


def _shown_end(data: Dataset, name: str, place: int, row: Row) -> str:
    """A parameter at the end of a border, as its axis shows it."""
    return number(float(parameter_of(name, data[name]).show(row["at"][place])), 6)


NO_BORDER = "No border of contact loss passes between closed orbits of one period."
CUT_BORDERS = "Stopped on request: other borders were not followed."
BORDER = (Column("border", "border"), Column("state", "state"), Column("period", "period"))
LOST_AT = (
    Column("state", "state"),
    Column("what", "what"),
    Column("where", "where"),
    Column("points computed", "points"),
    Column("of", "of"),
    Column("points assumed", "assumed"),
)
MOTIONS = (
    Column("motion", "motion"),
    Column("points computed", "labels"),
    Column("points assumed", "assumed"),
)


def _motions(data: Dataset) -> Table:
    """How often each motion was found."""
    found = _labels(data)
    counts = {name: found[name] for name in ("labels", "assumed")}
    rows = [
        {"motion": motion, **{name: here.get(motion, 0) for name, here in counts.items()}}
        for motion in dict.fromkeys((*counts["labels"], *counts["assumed"]))
    ]
    return declared("Motions found.", MOTIONS, rows)


def lost_table(data: Dataset) -> Table:
    """Of every value the motion, what loses contact and the greatest force, up and down."""
    name = str(data.attrs["parameter"])
    free, force = data["drive_free_share"].values, data["greatest_mesh_force"].values
    kinds, apart = sweeps.classes_of(data), ways_apart(data)
    rows = []
    for place, at in enumerate(shown(name, data[name])):
        told = (
            [sweeps.CLASSES[int(one)][0] for one in kinds[..., place].ravel()],
            [number(PERCENT(one)) for one in free[..., place].ravel()],
            [number(one, 4) for one in force[..., place].ravel()],
        )
        motions, shares, forces = (" / ".join(dict.fromkeys(each)) for each in told)
        here = [what for what, flags in things(data).items() if flags[..., place].any()]
        rows.append(
            {
                "at": float(at),
                "motion": motions,
                "apart": "two motions: one of them jumps" if apart[place] else "one motion",
                "loses": "; ".join(here) or "nothing",
                "free": shares,
                "force": forces,
            }
        )
    columns = (Column(page_words(name, data[name]), "at", exactly), *LOST)
    return declared(CONTACT, columns, rows)


CONTACT = "Contact over the parameter; up / down where they differ."
LOST = (
    Column("motion", "motion"),
    Column("up and down", "apart"),
    Column("what loses contact", "loses"),
    Column("drive flank apart [% of the time]", "free"),
    Column("greatest force of the teeth [N]", "force"),
)


def _returns(jump: Row) -> float | str:
    """Where a run back jumps again [rad/s], in words where it does not."""
    if np.isfinite(jump["jump_return"]):
        return float(jump["jump_return"])
    return "not in range" if jump["jump_into"] else "from chaos"


JUMPS_AT: tuple[str, ...] = ("fold", "subcritical period doubling")
GEARS = Column("gears", "gears", 4, CELSIUS, "gears_degC")
JUMPS = (
    Column("run", lambda row: "up" if row["jump_direction"] > 0 else "down", key="direction"),
    GEARS,
    Column("jumps at", "jump_fold", 8, SPEED, "fold_rpm"),
    Column("which is a", lambda row: JUMPS_AT[row["jump_kind"]], key="at"),
    Column("run back jumps at", _returns, 8, SPEED),
    Column("p-p before", "jump_before", 3, MICROMETRE, "before_um"),
    Column("p-p after", "jump_after", 3, MICROMETRE, "after_um"),
    key("from_rpm", "jump_from", SPEED),
    key("to_rpm", "jump_to", SPEED),
    key("return_rpm", "jump_return", SPEED),
    key("into_period", "jump_into"),
)
SERIES_AT_WORST = "The series at its worst speed: where one pair in ten exceeds most."
SERIES = (
    Column("gears", "gear_temperature", 4, CELSIUS, "gears_degC"),
    Column("damping", "damping_ratio", 2, PLAIN, "damping"),
    Column("pairs", "series_parts", key="pairs"),
    Column("worst at", "series_worst_speed", 4, SPEED, "speed_rpm"),
    Column("dynamic factor, 5 %", "low", 2, key="low"),
    Column("median", "median", 2, key="median"),
    Column("one in ten exceeds", "bad", 2, key="bad"),
    Column("95 %", "high", 2, key="high"),
    Column("pairs that part at some speed", "series_parting_parts", key="pairs_that_part"),
)
MOST_LINES = 16
LINES = (
    Column("line", "line", key="line"),
    Column("order of the mesh", "order", 4, key="order"),
    Column("amplitude", "amplitude", 3, MICROMETRE),
    Column("at", "speed", 6, SPEED, "speed_rpm"),
    Column("gears", "gears", 4, CELSIUS, "gears_degC"),
    key("amplitude_m", "amplitude"),
)
ATTRACTORS = (
    Column(
        "attractor",
        lambda row: f"period {row['period']}" if row["period"] else "chaotic, estimate",
    ),
    Column("x", "x", 9, key="x"),
    Column("x′", "v", 9, key="v"),
    Column("multiplier", "attractor_multiplier", 6),
    Column("starts", "count", key="count"),
    Column("share", "fraction", 5, PERCENT),
    Column("to the border [b]", "border_distance", key="border_distance"),
    key("period"),
    key("fraction"),
)


def _located(data: Dataset, dim: str) -> list[dict[str, Any]]:
    """The rows of bifurcations or jumps, with the temperature of the gears at each."""
    if f"{dim}_state" in data:
        gears = data["gear_temperature"].values[data[f"{dim}_state"].values]
        data = data.assign(gears=(dim, gears))
    return rows_along(data, dim)


def _jumps(data: Dataset) -> list[dict[str, Any]]:
    return _located(data, "jump") if "jump_kind" in data else []


def _series(data: Dataset) -> list[dict[str, Any]]:
    """The series of a run in each state and at each damping, at its worst speed."""
    worst = data["series_worst_dynamic_factor"].transpose("quantile", ...).drop_vars("quantile")
    named = dict(zip(("low", "median", "bad", "high"), worst, strict=True))
    return rows_along(data.assign(named), "state", "damping")


def bifurcations(data: Dataset) -> tuple[list[Column], list[dict[str, Any]]]:
    """Columns and rows of the located bifurcations; no rows where none were looked for."""
    if "bifurcation_kind" not in data:
        return [], []
    name, values = str(data.attrs.get("parameter", "pinion_speed")), data["bifurcation_value"]
    unit = parameter_of(name, values)
    columns = [
        Column("kind", lambda row: row["bifurcation_kind"].replace("_", " "), key="kind"),
        Column("period", "bifurcation_period", key="period"),
        Column(
            page_words(name, values), lambda row: float(unit.show(row["bifurcation_value"])), 8,
            PLAIN, "value",
        ),
    ]  # fmt: skip
    return columns + [GEARS] * ("bifurcation_state" in data), _located(data, "bifurcation")


def _attractors(data: Dataset) -> list[dict[str, Any]]:
    """The attractors, each with its first section."""
    if "attractor_x" not in data:
        return []
    first = {name: data[f"attractor_{name}"][:, 0] for name in ("x", "v")}
    periods = data["attractor_period"].drop_attrs()
    return rows_along(data.assign(first | {"period": periods}), "attractor_number")


def _settings(data: Dataset) -> Section:
    shown = {
        "total_periods": "mesh periods run",
        "full_periods": "mesh periods of the full run",
        "computed_points": "points computed; the rest is assumed, its neighbours are alike",
        "bundle": "bundle of choices",
        "branch_notes": "branches",
    }
    there = {words: data.attrs[name] for name, words in shown.items() if data.attrs.get(name)}
    tables = [pairs("", ("what", "value"), there)] if there else []
    return Section("settings", "How it was computed", tables)


# --- figures as JSON wants them ---------------------------------------------------------------


def numbers(result: Result) -> dict[str, Any]:
    """The figures of a stored result."""
    data, kind = result.data, result.kind
    found = _basin_numbers(data) if kind == "basins" else _labels(data)
    if kind == "diagram":
        parameter = str(data.attrs["parameter"])
        apart = shown(parameter, data[parameter])[ways_apart(data)]
        found |= {"parameter": parameter, "ways_apart": apart.tolist()}
    if kind == "run-up":
        found["jumps"] = [in_full(JUMPS, row) for row in _jumps(data)]
        if "series_dynamic_factor" in data:
            found["series"] = [in_full(SERIES, row) for row in _series(data)]
        if "mesh_periods" in data.attrs:
            found["lines"] = [in_full(LINES, row) for row in _turn_lines(data)]
            found["mesh_periods"] = int(data.attrs["mesh_periods"])
    if kind in ("diagram", "run-up"):
        columns, rows = bifurcations(data)
        found["bifurcations"] = [in_full(columns, row) for row in rows]
    seconds = result.text("seconds")
    return found | {"rule": _rule(data)} | ({"seconds": float(seconds)} if seconds else {})


def _labels(data: Dataset) -> dict[str, Any]:
    """How often each motion was found, and how often it is assumed."""
    told = np.char.replace(in_words(data)["label"].values, "_", " ").astype("U32")
    periodic = told == "periodic"
    told[periodic] = np.char.add("period-", data["period"].values[periodic].astype(str))
    told[periodic] = np.char.add(told[periodic], of_turn(data.attrs.get("mesh_periods", 1)))
    assumed = data["status"].values == ASSUMED
    found: dict[str, Any] = {
        "points": told.size,
        "labels": dict(Counter(sorted(told[~assumed].tolist())).most_common()),
        "assumed": dict(Counter(sorted(told[assumed].tolist())).most_common()),
    }
    found |= {
        name: int(data.attrs[name])
        for name in ("total_periods", "full_periods", "computed_points")
        if name in data.attrs
    }
    return found | ({"lost_contact": lost_rows(data)} if has_lost(data) else {})


def _basin_numbers(data: Dataset) -> dict[str, Any]:
    return {
        "points": data["attractor"].size,
        "attractors": [in_full(ATTRACTORS, row) for row in _attractors(data)],
        **{
            name: float(data.attrs[name])
            for name in ("basin_entropy", "boundary_basin_entropy", "unassigned")
        },
    }
