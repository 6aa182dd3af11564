"""The page of the thesis's steps for one pair: a section each, its finding first."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import celsius, exactly, number, span
from thermogear.base.parameters import PARAMETERS
from thermogear.base.units import RPM
from thermogear.base.vocabulary import STATUS
from thermogear.results.result import Result
from thermogear.views import tables
from thermogear.views.page import Block, Gallery, Page, Pictures, Section, Table, Text, notice_lines
from thermogear.views.pages import captions, gear_sections, overlay
from thermogear.views.pages.background import background
from thermogear.views.pages.record import comparison_table
from thermogear.views.plots import laws
from thermogear.views.plots.motion import label_of, moving
from thermogear.views.plots.parameters import shown
from thermogear.views.plots.sweeps import CLASSES, classes_of

if TYPE_CHECKING:
    import xarray as xr

KINDS = ("thesis-pair",)
LOST = STATUS.index("not_converged")
ROUNDING = 1e-9
"""A line at half the mesh frequency below this part of the swing is rounding."""


def page(result: Result) -> Page:
    """Every step as a section that begins with what was found."""
    pictures = Pictures()
    return Page(
        replace(result, notices=()),
        _summary(result),
        [make(result, pictures) for make in STEPS] + background(result),
        numbers=lambda: _numbers(result),
        lines=lambda: [
            _summary(result),
            *(f"{name}: {words}" for name, words in _findings(result).items()),
            *notice_lines(result),
        ],
    )


def _summary(result: Result) -> str:
    mesh = _hot(result.groups["mesh"])
    ratio = float(mesh["frequency_ratio"])
    at = f" (ω_h = {number(ratio)})" if np.isfinite(ratio) else ""
    cut = "Stopped on request before the end: what is missing was not computed. "
    return (
        f"{cut if result.interrupted else ''}The steps of the thesis for this pair at "
        f"{exactly(float(mesh['pinion_speed']) / RPM)} rpm and "
        f"{exactly(float(mesh['pinion_torque']))} N m{at}, bundle {mesh['bundle'].item()}."
    )


def _hot(data: xr.Dataset) -> xr.Dataset:
    """The one point of a group, hot."""
    one = data.isel(bundle=0, operating=0)
    return one.isel(state=-1) if "state" in one.dims else one


def _findings(result: Result) -> dict[str, str]:
    """Title of every section -> its sentence."""
    sections = [make(result, Pictures()) for make in STEPS]
    return {one.title: str(one.blocks[0].words) for one in sections}  # type: ignore[union-attr]


def _pictured(blocks: list[Block], names: set[str]) -> list[Block]:
    """Galleries with the pictures of these ``names`` alone."""
    kept = [
        [one for one in block.pictures if one.name in names]
        for block in blocks
        if isinstance(block, Gallery)
    ]
    return [Gallery(some) for some in kept if some]


# --- heat ---------------------------------------------------------------------------------


def _temperature(result: Result, pictures: Pictures) -> Section:
    row = result.groups["temperature"]
    section = gear_sections.row(result, pictures)
    here = row.isel(bundle=0, operating=0)
    points = [here.isel(gear_temperature=k) for k in range(here.sizes["gear_temperature"])]
    drawn = section is not None and any(map(moving, points)) if "displacement" in here else False
    blocks = [one for one in section.blocks if one.kind != "text"] if drawn and section else []
    words = _warming(points, result.rows("left_out"))
    return Section("temperature", "Gear temperature", [Text(words), *blocks], False)


def _warming(points: list[xr.Dataset], left_out: list[dict[str, Any]]) -> str:
    """What the motion does over the gears' temperature."""
    places = [celsius(float(one["gear_temperature"])) for one in points]
    there = [one for one in points if "displacement" in one and moving(one)]
    told = []
    if there:
        first, last = there[0], there[-1]
        ends = f"At {celsius(float(first['gear_temperature']))}"
        if len(there) > 1:
            ends = f"From{ends[2:]} to {celsius(float(last['gear_temperature']))}"
        labels = [label_of(one) for one in there]
        if len(set(labels)) == 1:
            words = f"{ends} the motion is {labels[0]}"
        else:
            each = (
                f"{name} at {celsius(float(one['gear_temperature']))}"
                for name, one in zip(labels, there, strict=True)
            )
            words = f"The motion is {', '.join(each)}"
        told.append(words)
        told.append(f"its swing goes from {_micro(first, SWING)} to {_micro(last, SWING)} µm")
        sizes = [float(one["multiplier_modulus"]) for one in (first, last)]
        if np.isfinite(sizes).all():
            told.append(
                "its largest Floquet multiplier from "
                f"{number(sizes[0], 4)} to {number(sizes[1], 4)} in modulus"
            )
        half = [float(one["half_order_amplitude"]) for one in there]
        swing = [float(one[SWING]) for one in there]
        if max(np.divide(half, swing)) > ROUNDING:
            told.append(
                "the line at half the mesh frequency goes from "
                f"{_micro(first, HALF)} to {_micro(last, HALF)} µm"
            )
        else:
            told.append("it has no line at half the mesh frequency")
    for words, status in ((_no_gap(points), JAMMED), (UNSETTLED, LOST)):
        where = [at for at, one in zip(places, points, strict=True) if int(one["status"]) == status]
        if where:
            told.append(f"at {', '.join(where)} {words}")
    for why in dict.fromkeys(str(one["why"]) for one in left_out):
        where = [celsius(one["gear_temperature_K"]) for one in left_out if one["why"] == why]
        told.append(f"{', '.join(where)} left out, {why}")
    words = f"{'; '.join(told)}."
    return words[:1].upper() + words[1:]


SWING, HALF = "peak_to_peak_displacement", "half_order_amplitude"
JAMMED = STATUS.index("jammed")
UNSETTLED = "the heat balance does not settle, so nothing is known of the motion"


def _micro(one: xr.Dataset, name: str) -> str:
    return number(1e6 * float(one[name]))


def _no_gap(points: list[xr.Dataset]) -> str:
    gaps = [1e6 * float(one["half_backlash"]) for one in points if int(one["status"]) == JAMMED]
    jams = [float(one["jam_temperature"]) for one in points if "jam_temperature" in one]
    at = f", the pair jams at {celsius(jams[-1])}" if jams and np.isfinite(jams[-1]) else ""
    return f"no gap is left: half backlash {span(gaps)} µm{at}"


# --- bifurcations -------------------------------------------------------------------------


def _diagram(name: str, title: str, result: Result, pictures: Pictures) -> Section:
    """The diagrams over one parameter, undeformed and hot, in one picture and one table."""
    data = result.group(f"diagrams/{name}")
    if data is None:
        words = "Not computed: "
        words += "stopped before it." if result.interrupted else f"{_undeformed(result)}."
        return Section(name, title, [Text(words)], False)
    states = json.loads(str(data.attrs["state_names"]))
    rows = result.table("matches").get(name, [])
    both = Result.of("overlay", title, {"states": data}, matches=rows, states=states)
    here = [overlay.state_of(data, place) for place in range(len(states))]
    values = shown(name, data[name].values)
    unit = PARAMETERS[name].shown
    told = [f"{state} {_share(one)}" for state, one in zip(states, here, strict=True)]
    if rows:
        matched = sum(row["partner"] == "matched" for row in rows)
        found = [one.sizes.get("bifurcation", 0) for one in here]
        told.append(
            f"{found[0]} bifurcations {states[0]}, {found[1]} {states[1]}, {matched} of them "
            "followed from one state to the other"
        )
    else:
        told.append("no bifurcation was found")
    span_ = f"{exactly(float(values[0]), 4)} to {exactly(float(values[-1]), 4)} {unit}".strip()
    blocks: list[Block] = [Text(f"From {span_}: {'; '.join(told)}.")]
    if any((one["status"].values == 0).any() for one in here):
        pictures.add(
            f"diagram-{name}", f"{title}, undeformed and hot", overlay.CAPTION, data, (),
            lambda: overlay.overlay_picture(data, states, rows), wide=True,
        )  # fmt: skip
        blocks += pictures.take()
    if rows:
        head, lines = overlay.table_of(both)
        blocks.append(Table(overlay.FOLLOWED, head, lines))
    return Section(name, title, blocks, False)


def _share(one: xr.Dataset) -> str:
    """Which motions one state settles on, by their shares of the values."""
    status = one["status"].values
    if not (status == 0).any():
        return "has no gap left at any value" if (status == JAMMED).any() else UNSETTLED
    code = classes_of(one)[status == 0]
    parts = [f"{CLASSES[n][0]} at {number(100.0 * np.mean(code == n))} %" for n in np.unique(code)]
    left = float(np.mean(status != 0))
    return ", ".join(parts + [f"no motion at {number(100.0 * left)} %"] * (left > 0.0))


def _undeformed(result: Result) -> str:
    """Why a pair does not move undeformed."""
    mesh = result.groups["mesh"].isel(bundle=0, operating=0, state=0)
    gap = number(1e6 * float(mesh["half_backlash"]))
    return f"undeformed no gap is left, half backlash {gap} µm"


# --- friction and the film ----------------------------------------------------------------


def _friction(result: Result, pictures: Pictures) -> Section:
    path = result.groups["path"]
    here = _hot(path)
    rows = [
        [
            name,
            number(float(np.mean(here[f"friction_coefficient_{name}"].values))),
            number(float(np.max(here[f"flash_temperature_{name}"].values))),
        ]
        for name in ("mixed", "dry")
    ]
    blocks: list[Block] = []
    if all("–" not in row for row in rows):
        words = (
            f"Hot, mixed lubrication gives a mean friction coefficient of {rows[0][1]} and a flash "
            f"temperature of at most {rows[0][2]} K along the path, dry friction {rows[1][1]} and "
            f"{rows[1][2]} K."
        )
        head = ["friction", "mean coefficient", "greatest flash temperature [K]"]
        blocks.append(Table("Along the path of contact, hot.", head, rows))
        section = gear_sections.friction(result, pictures)
        drawn = {"friction", "flash-mixed", "flash-dry"}
        blocks += _pictured(list(section.blocks), drawn) if section is not None else []
    else:
        status = int(_hot(result.groups["mesh"])["status"])
        why = UNSETTLED if status == LOST else "Benedict and Kelley's law has no value for it"
        words = f"Mixed lubrication cannot be put beside dry friction at this point: {why}."
    return Section("friction", "Mixed and dry friction", [Text(words), *blocks], False)


def _film(result: Result, pictures: Pictures) -> Section:
    path = result.groups["path"].isel(bundle=0, state=-1)
    words = captions.regimes(path)
    known = np.isfinite(path["film_parameter"].values).any()
    if known:
        pictures.add(
            "film-path", "Film parameter along the path",
            "Least film thickness over the combined rms roughness; below 1 boundary, from 3 on a "
            "full film.",
            path, ("film_parameter",), lambda: laws.film(path),
        )  # fmt: skip
    words = words or f"The film along the path is not known: {UNSETTLED}."
    return Section("film", "Outlook: film", [Text(words), *pictures.take()], False)


# --- records and readings -----------------------------------------------------------------


def _records(result: Result, pictures: Pictures) -> Section:
    data = result.group("comparison")
    if data is None:
        words = "No record was given; each --record FILE is put beside this pair, cold and hot."
        return Section("records", "Records", [Text(words)], False)
    swings = data.isel(row=np.flatnonzero(data["quantity"].values == "displacement"))
    verdicts = [str(one).partition(";")[0] for one in swings["verdict"].values]
    counts = ", ".join(f"{name} {verdicts.count(name)} times" for name in dict.fromkeys(verdicts))
    count = len(set(map(str, data["record"].values)))
    words = f"Of {len(verdicts)} displacements in {count} record{'s' * (count > 1)}: {counts}."
    return Section("records", "Records", [Text(words), comparison_table(data)], False)


def _sensors(result: Result, pictures: Pictures) -> Section:
    balance = result.group("balance")
    read = [] if balance is None else json.loads(str(balance.attrs.get("readings", "[]")))
    if balance is None or not read:
        words = (
            "No thermometer reading is in the case: a table [gearbox.readings.oil], or of another "
            "node, corrects one and holds the heat balance to it."
        )
        return Section("sensors", "Outlook: temperature sensors", [Text(words)], False)
    off = [one["temperature_K"] - one["indicated_K"] for one in read]
    gap = 1e6 * float(_hot(balance)["half_backlash_uncertainty"])
    words = (
        f"The {len(read)} reading{'s' * (len(read) > 1)} of the case are corrected by "
        f"{span(off)} K; what stays uncertain of them moves the half backlash by {number(gap)} µm "
        "(standard uncertainty)."
    )
    rows = [
        [
            one["node"].replace("_", " "), one["kind"], celsius(one["indicated_K"]),
            celsius(one["temperature_K"]), number(one["uncertainty_K"]),
        ]
        for one in read
    ]  # fmt: skip
    head = ["node", "kind", "shown", "corrected", "standard uncertainty [K]"]
    table = Table("Readings.", head, rows, names=2)
    return Section("sensors", "Outlook: temperature sensors", [Text(words), table], False)


STEPS: tuple[Callable[[Result, Pictures], Section], ...] = (
    _temperature,
    partial(_diagram, "damping_ratio", "Damping"),
    partial(_diagram, "pinion_speed", "Speed"),
    partial(_diagram, "stiffness_fluctuation", "Stiffness fluctuation"),
    _friction, _records, _film, _sensors,
)  # fmt: skip


# --- figures as the terminal and JSON want them -------------------------------------------


def _numbers(result: Result) -> dict[str, Any]:
    mesh, row = _hot(result.groups["mesh"]), result.groups["temperature"]
    here = row.isel(bundle=0, operating=0)
    kept = ("half_backlash", SWING, HALF, "multiplier_modulus")
    return {
        "thermogear": result.text("thermogear"),
        "title": result.title,
        "kind": result.kind,
        "pinion_speed_rpm": float(mesh["pinion_speed"]) / RPM,
        "pinion_torque_Nm": float(mesh["pinion_torque"]),
        "frequency_ratio": float(mesh["frequency_ratio"]),
        "findings": _findings(result),
        "temperature": [
            {
                "gear_temperature_K": float(one["gear_temperature"]),
                "status": STATUS[int(one["status"])],
                "label": str(one["label"].item()),
                **{name: float(one[name]) for name in kept if name in one},
            }
            for one in (here.isel(gear_temperature=k) for k in range(here["status"].size))
        ],
        "notices": [one._asdict() for one in result.notices],
    }
