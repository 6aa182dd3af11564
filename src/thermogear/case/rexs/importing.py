"""A REXS model as a list of what it holds, and one of its stages as a case file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import accumulate

from thermogear.base.errors import InputError, InputErrors, short
from thermogear.base.toml import flat
from thermogear.base.units import RPM
from thermogear.case.assumptions import Assumption
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import USED, Reader, plain
from thermogear.case.rexs.draft import Draft
from thermogear.case.rexs.drive import Drive
from thermogear.case.rexs.gearbox import Stage
from thermogear.case.rexs.lines import some, toml
from thermogear.case.rexs.model import Component, Model
from thermogear.case.rexs.shaft_train import without_train
from thermogear.case.rexs.stage_case import draft, one_rack, require_spur


def checked(stage: Stage, text: str) -> GearCase:
    """The case of a text; what is impossible in it speaks of the stage."""
    try:
        return gear_case(load_case(text))
    except InputError as error:
        first = error.errors[0] if isinstance(error, InputErrors) else error
        raise first.under(stage.field) from error


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
            for name, unit in (("torque_around_u_axis", "N m"), ("power", "W")):
                if (found := reader.number(load, name, over.get(load.id))) is not None:
                    parts.append(f"{found.si:.6g} {unit}")
                    break
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
    names: dict[str, set[str]] = {}
    for one in model.components.values():
        if one.id in known - silent:
            mine = {name for name in one.attributes if name not in USED}
            names[one.type] = names.get(one.type, set()) | mine
        elif one.id not in silent:
            parts[one.type] += 1
    lines = [f"{short(kind).strip(chr(39))}: {count}" for kind, count in parts.items()]
    for kind, several in names.items():
        if several:
            count = "1 attribute" if len(several) == 1 else f"{len(several)} attributes"
            lines.append(f"{kind}: {count}: {flat(some(sorted(several)))}"[:400])
    return lines


# --- a case ---------------------------------------------------------------------------------


def chosen(model: Model, number: int | None) -> Stage:
    """The stage ``number`` as the list counts them, or of that id; the only one without."""
    every = gearbox.stages(model)
    if not every:
        raise InputError(
            "REXS file", "no cylindrical stage", allowed="one or more", why="no gear pair in it"
        )
    if number is None and len(every) > 1:
        raise InputError(
            "--stage",
            "nothing",
            allowed=f"1..{len(every)}",
            why="the file has several stages",
            fix="without -o they are listed",
        )
    known = {one.component.id: one for one in every} | {one.number: one for one in every}
    if (asked := 1 if number is None else number) not in known:
        raise InputError("--stage", asked, allowed=f"1..{len(every)}")
    return known[asked]


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
    one_rack(made)
    if made.train:
        try:
            checked(one, toml(made.lines, (), ()))
        except InputError as error:
            without_train(made, error)
    shapes = _modifications(model, made)
    unused = [*made.unused, *shapes]
    unused += left_out(model, [*_used(model, one), *made.train, *made.seats], told=shapes.values())
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
    case = checked(made.stage, toml(made.lines, head, ()))
    return toml(made.lines, head, _defaults(made, case.assumptions))


_TOLD = ("gears.", "oil.", "backlash.", "flanks.", "housing.")
_LEFT_OPEN = {
    "gears.centre_distance": "that of the shifts without backlash",
    "oil.temperature": "computed from the losses",
}


def _defaults(made: Draft, found: Iterable[Assumption]) -> list[tuple[str, str]]:
    """The defaults of the tables that a REXS file could fill, with their reasons."""
    has = {one.path for one in made.lines}
    known = tuple(one for one in _TOLD if one != "backlash." or not any(p[:9] == one for p in has))
    lines = [
        (one.field, f"{one.value}; {one.default}")
        for one in found
        if one.default and one.field.startswith(known)
    ]
    return [*lines, *(one for one in _LEFT_OPEN.items() if one[0] not in has)]


# --- what is used and what is not -------------------------------------------------------------


def _used(model: Model, stage: Stage) -> list[Component]:
    """The components that a stage takes its case from."""
    whole = model.of_type("shaft", "external_load", "gear_unit", "gear_casing")
    return [*gearbox.parts_of(model, stage), *whole]


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
    loads = made.loads
    times = [one.duration for one in loads]
    if not all(times):
        times = [3600.0 * (one.share or 0.0) for one in loads]
    if len(loads) < 2 or not all(times):
        return ""
    starts = accumulate((one or 0.0 for one in times), initial=0.0)
    rows = [
        f"{plain(at / 3600.0)},{plain(one.speed)},{plain(one.torque)}"
        for at, one in zip(starts, [*loads, loads[-1]], strict=True)
    ]
    return "\n".join(["time [h],speed [rpm],torque [N m]", *rows]) + "\n"
