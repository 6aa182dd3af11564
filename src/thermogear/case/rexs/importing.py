"""A REXS model as a list of what it holds, and one of its stages as a case file."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from thermogear.base.errors import InputError, InputErrors, short
from thermogear.base.toml import flat, overridden, tables
from thermogear.base.units import RPM
from thermogear.case.assumptions import Assumption
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import EXACT, USED, Reader, plain
from thermogear.case.rexs.draft import Draft
from thermogear.case.rexs.drive import Drive
from thermogear.case.rexs.gearbox import Stage
from thermogear.case.rexs.lines import Line, stored, toml
from thermogear.case.rexs.model import Component, Model
from thermogear.case.rexs.shaft_train import without_train
from thermogear.case.rexs.stage_case import draft, require_spur

CASE = f"{EXACT}case"
"""The attribute that holds a whole case."""


@dataclass(frozen=True)
class Found:
    """A stage as a list shows it: the pair in words, or why no case comes of it."""

    stage: Stage
    words: str
    why: InputError | None


@dataclass(frozen=True)
class Imported:
    """A stage as a case: the ``text`` of the case file, what could not be used, notes on units.

    ``duty``: the load spectrum as the table that `thermogear warmup --duty` reads; empty without
    times of the load cases.
    """

    text: str
    unused: tuple[str, ...]
    notes: tuple[str, ...]
    duty: str = ""


# --- lists ----------------------------------------------------------------------------------


def listed(model: Model) -> tuple[list[Found], list[str]]:
    """The stages of a model, and its notes on units."""
    reader = Reader(model)
    found = []
    for stage in gearbox.stages(model):
        try:
            teeth = require_spur(reader, stage)
            module = reader.number(stage.gears[0], "normal_module")
            size = "" if module is None else f", module {module.text}"
            found.append(Found(stage, f"{teeth[0]}:{teeth[1]} teeth{size}, spur", None))
        except InputError as error:
            found.append(Found(stage, "", error))
    return found, reader.said


def shafts(model: Model) -> list[str]:
    """A line for every shaft: its speed and what loads it."""
    reader = Reader(model)
    drive = Drive(reader)
    over = model.load_cases[0].components if model.load_cases else {}
    speeds, read, _ = drive.speeds(over)
    lines = []
    for shaft in model.of_type("shaft"):
        parts = [shaft.called]
        if shaft.id in speeds:
            how = "read" if shaft.id in read else "derived"
            parts.append(f"{speeds[shaft.id] / RPM:.6g} rpm ({how})")
        for load in drive.loads.get(shaft.id, ()):
            torque = reader.number(load, "torque_around_u_axis", over.get(load.id))
            power = reader.number(load, "power", over.get(load.id))
            if torque is not None:
                parts.append(f"{torque.si:.6g} N m")
            elif power is not None:
                parts.append(f"{power.si:.6g} W")
        lines.append(", ".join(parts))
    return lines


def left_out(
    model: Model, used: Iterable[Component] = (), told: Iterable[Component] = ()
) -> list[str]:
    """What a model holds beyond what becomes a case: a line for each type of component.

    Of those ``used`` the attributes that are not, nothing of those ``told`` already.
    """
    known, silent = {one.id for one in used}, {one.id for one in told}
    parts: Counter[str] = Counter()
    names: dict[str, dict[str, None]] = {}
    for one in model.components.values():
        if one.id in silent:
            continue
        if one.id not in known:
            parts[one.type] += 1
            continue
        mine = names.setdefault(one.type, {})
        mine.update(
            dict.fromkeys(name for name in one.attributes if name not in USED and EXACT not in name)
        )
    lines = [f"{short(kind).strip(chr(39))}: {count}" for kind, count in parts.items()]
    for kind, several in names.items():
        if several:
            some = ", ".join(sorted(several)[:8])
            more = f" and {len(several) - 8} more" if len(several) > 8 else ""
            count = "1 attribute" if len(several) == 1 else f"{len(several)} attributes"
            lines.append(f"{kind}: {count}: {flat(some)}{more}"[:400])
    if model.accumulation:
        lines.append("accumulation: results over all load cases")
    return lines


# --- a case ---------------------------------------------------------------------------------


def chosen(model: Model, number: int | None) -> Stage:
    """The stage ``number`` as the list counts them, or of that id; the only one without."""
    every = gearbox.stages(model)
    if not every:
        raise InputError(
            "REXS file", "no cylindrical stage", allowed="one or more", why="no gear pair in it"
        )
    if number is None:
        if len(every) > 1:
            raise InputError(
                "--stage",
                "nothing",
                allowed=f"1..{len(every)}",
                why="the file has several stages",
                fix="without -o they are listed",
            )
        return every[0]
    if 1 <= number <= len(every):
        return every[number - 1]
    for one in every:
        if one.component.id == number:
            return one
    raise InputError("--stage", number, allowed=f"1..{len(every)}")


def imported(
    model: Model,
    stage: int | None = None,
    *,
    speed: str | None = None,
    torque: str | None = None,
) -> Imported:
    """The case file of a ``stage``, checked; InputError in one line where none comes of it.

    ``speed`` and ``torque`` of the pinion, "1000 rpm" and "100 N m", replace what the model
    does not say.
    """
    reader = Reader(model)
    one = chosen(model, stage)
    made = draft(reader, one, speed, torque)
    data = _stored(model)
    unused: list[str] = []
    if data is not None:
        text = _restored(data, made, _head(model, one, unused))
    else:
        if made.train:
            try:
                _checked(one, toml(made.lines, (), ()))
            except InputError as error:
                without_train(made, error)
        shapes = _modifications(model, made)
        unused += [*made.unused, *shapes]
        unused += left_out(model, _used(model, made), told=shapes.values())
        text = _fresh(made, _head(model, one, unused))
    return Imported(text, tuple(unused), tuple(reader.said), _duty(made))


def _head(model: Model, stage: Stage, unused: list[str]) -> list[str]:
    found = [
        f"Stage {stage.number} ({stage.component.called}) of a REXS {model.version} model of "
        f"{model.application or 'an unnamed program'}.",
        "Each line says whether it was read, derived from what is there, given with the command,",
        "or left to a default.",
    ]
    return [flat(line) for line in (*found, *(f"not used: {one}" for one in unused))]


def _fresh(made: Draft, head: list[str]) -> str:
    bare = toml(made.lines, head, ())
    case = _checked(made.stage, bare)
    return toml(made.lines, head, _defaults(made, case.assumptions))


def _checked(stage: Stage, text: str) -> GearCase:
    """The case of a text; what is impossible in it speaks of the stage."""
    try:
        return gear_case(load_case(text))
    except InputError as error:
        first = error.errors[0] if isinstance(error, InputErrors) else error
        raise first.under(stage.field) from error


_TOLD = ("gears.", "oil.", "backlash.", "flanks.", "housing.")


def _defaults(made: Draft, found: Iterable[Assumption]) -> list[tuple[str, str]]:
    """The defaults of the tables that a REXS file could fill, with their reasons."""
    lines = [
        (one.field, f"{one.value}; {one.default}")
        for one in found
        if one.default and one.field.startswith(_TOLD)
    ]
    has = {one.path for one in made.lines}
    if any(path.startswith("backlash.") for path in has):
        lines = [one for one in lines if not one[0].startswith("backlash.")]
    if "gears.centre_distance" not in has:
        lines.append(("gears.centre_distance", "that of the shifts without backlash"))
    if "oil.temperature" not in has:
        lines.append(("oil.temperature", "computed from the losses"))
    return lines


# --- a case that was exported ---------------------------------------------------------------


def _stored(model: Model) -> dict[str, Any] | None:
    """The tables of the case that a model was exported from; None in others."""
    for unit in model.of_type("gear_unit"):
        found = unit.attributes.get(CASE)
        if found is None:
            continue
        where = f"{unit.called}.{CASE}"
        try:
            kept = json.loads(str(found.value))
            changes = tuple((str(path), str(text)) for path, text in kept["overrides"])
            return overridden(tables("case", str(kept["text"])), changes)
        except (ValueError, KeyError, TypeError, RecursionError) as cause:
            raise InputError(
                where,
                "no case of thermogear",
                fix=f"take the attribute {CASE} out of the file",
            ) from cause
    return None


def _restored(data: dict[str, Any], made: Draft, head: list[str]) -> str:
    """The stored case, with what another program changed put in."""
    new = [one for one in made.lines if one.changed]
    roots = {_root(one) for one in new}
    for one in made.lines:
        if _root(one) in roots and (one.changed or _root(one) in _WHOLE):
            new.append(one)
    if any(root.startswith("materials.") for root in roots):
        new += [one for one in made.lines if one.path.endswith(".material")]
    for root in roots & {"backlash"}:
        data.pop(root, None)
    notes = {}
    for one in {one.path: one for one in new}.values():
        table = data
        *way, last = one.path.split(".")
        for key in way:
            table = table.setdefault(key, {})
        table[last] = one.value
        notes[one.path] = f"{one.origin}: {one.note}; changed since the export"
    text = stored(data, head, notes)
    _checked(made.stage, text)
    return text


_WHOLE = ("oil", "backlash", "materials")
"""Tables that are taken as a whole where one of their values changed."""


def _root(one: Line) -> str:
    """The table that has to be taken over together with a line."""
    parts = one.path.split(".")
    if parts[0] == "materials":
        return ".".join(parts[:2])
    return parts[0] if parts[0] in _WHOLE else one.path


# --- what is used and what is not -------------------------------------------------------------


def _used(model: Model, made: Draft) -> list[Component]:
    """The components that a stage takes its case from."""
    stage = made.stage.component
    found: list[Component | None] = [stage, gearbox.lubricant_of(model, stage)]
    found += [*made.train, *made.seats]
    of_gear = gearbox.shafts_of_gears(model)
    for _, gear in made.both:
        flanks = gearbox.flanks_of(model, gear)
        found += [gear, *flanks.values(), gearbox.tool_of(model, gear, flanks)]
        found += [gearbox.gear_data_of(model, stage, gear)]
        found += gearbox.settings_of(model, gear, flanks)
        found += model.referenced(gear.id, "material")[:1]
        found += [model.at(of_gear.get(gear.id))]
        for flank in flanks.values():
            found += model.referenced(flank.id, "tip_relief", "root_relief")
    found += model.of_type("shaft", "external_load", "gear_unit", "gear_casing")
    return [one for one in found if one is not None]


_MODIFICATIONS = (
    "profile_crowning",
    "profile_slope",
    "profile_twist",
    "helix_crowning",
    "helix_slope",
    "end_relief_datum_face",
    "end_relief_non_datum_face",
    "topographical_modification",
    "triangular_tip_relief",
    "triangular_root_relief",
    "profile_deviation",
    "helix_deviation",
)


def _modifications(model: Model, made: Draft) -> dict[str, Component]:
    """Modifications of the flanks that a case cannot hold: they change the mesh, so by name."""
    found: dict[str, Component] = {}
    for name, gear in made.both:
        for flank in gearbox.flanks_of(model, gear).values():
            for one in model.referenced(flank.id, *_MODIFICATIONS):
                found.setdefault(f"{one.called} of the {name}: a case has no field for it", one)
    return found


def _duty(made: Draft) -> str:
    """The load spectrum over time, one load case after the other; an hour where the file gives
    shares of the time alone."""
    if len(made.loads) < 2:
        return ""
    times = [one.duration for one in made.loads]
    if not all(times):
        shares = [one.share for one in made.loads]
        if not all(shares):
            return ""
        times = [3600.0 * (one or 0.0) for one in shares]
    rows, at = ["time [h],speed [rpm],torque [N m]"], 0.0
    for one, lasts in zip(made.loads, times, strict=True):
        rows.append(f"{plain(at / 3600.0)},{plain(one.speed)},{plain(one.torque)}")
        at += lasts or 0.0
    last = made.loads[-1]
    rows.append(f"{plain(at / 3600.0)},{plain(last.speed)},{plain(last.torque)}")
    return "\n".join(rows) + "\n"
