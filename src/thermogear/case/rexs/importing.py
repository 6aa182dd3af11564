"""A REXS model as a list of what it holds, and one of its stages as a case file."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from copy import deepcopy
from dataclasses import dataclass
from functools import reduce
from itertools import accumulate
from typing import Any

import numpy as np

from thermogear.base.errors import InputError, InputErrors, short
from thermogear.base.materials import NEVER, POLYMER_LIMITS, Material
from thermogear.base.toml import flat, overridden, tables
from thermogear.base.units import RPM
from thermogear.case.assumptions import Assumption
from thermogear.case.case import GearCase, case_of, gear_case, load_case
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import CASE, OURS, USED, Plain, Reader, plain
from thermogear.case.rexs.draft import Draft
from thermogear.case.rexs.drive import Drive
from thermogear.case.rexs.exporting import WRITTEN, model_of_case
from thermogear.case.rexs.gearbox import Stage
from thermogear.case.rexs.lines import Line, some, stored, toml
from thermogear.case.rexs.model import MOST_LOAD_CASES, Component, Model
from thermogear.case.rexs.shaft_train import without_train
from thermogear.case.rexs.stage_case import draft, one_rack, require_spur
from thermogear.case.rexs.substances import label_of
from thermogear.case.rexs.values import (
    TITLE,
    Key,
    Values,
    alike,
    put_back,
    shown,
    values,
)


class Exported:
    """A case as it was exported: its ``data`` and the values ``old`` that the file had then.

    ``now``: the values it has; ``keys``: those that changed. ``made``: what an import of the file
    makes, None where nothing changed; ``changed``: fields taken from there, with their origins.
    """

    def __init__(self, reader: Reader, stage: Stage, data: dict[str, Any], old: Values) -> None:
        self.reader, self.stage, self.data, self.old = reader, stage, data, old
        self.parts = gearbox.parts_of(reader.model, stage)
        self.made: Draft | None = None
        self.changed: dict[str, str] = {}
        self.unused: list[str] = []
        self.notes: list[str] = []
        self.case = checked(stage, data)
        if not old:  # written by an earlier version, without values
            self.old = _said_by(self.case, results=True)
        title = {key: name for key, name in self.old.items() if key == TITLE}
        self.now = title | values(reader, stage)  # a name that is gone was none to change
        every = self.old | self.now
        self.keys = [key for key in every if not alike(self.old.get(key), self.now.get(key))]

    def text(self, head: Iterable[str] = ()) -> str:
        """The case file."""
        return stored(self.data, head, self.changed)

    def take(self, speed: str | None, torque: str | None) -> None:
        """Put in what another program changed, and ``speed`` and ``torque`` as given.

        InputError in one line, with the names of what changed, where the case cannot say the same.
        """
        if not self.keys and speed is None and torque is None:
            return
        try:
            self.made = draft(self.reader, self.stage, speed, torque)
            model = put_back(self.reader.model, self.stage, self.old, self.keys)
            before = draft(Reader(model), gearbox.stages(model)[self.stage.number - 1])
            self._fields(before, self.made)
            again = _said_by(checked(self.stage, self.data))
        except InputError as error:
            raise self._refused(self.keys, str(error)) from error
        known = self.old | again
        wrong = [key for key in self.keys if key in known and not _agree(self.now, again, key)]
        if wrong:
            follows = self._shown(again, wrong[0])
            raise self._refused(wrong, f"the case of this file would have {follows}")
        self.notes = [*self._lines(again), *self.notes]
        self.unused = [line for line in self.made.unused if line not in before.unused]

    # --- fields ----------------------------------------------------------------------------
    def _fields(self, before: Draft, made: Draft) -> None:
        """Put the fields into the data that an import ``made`` otherwise than ``before``.

        The fields of a table go together, so that none of them is left to follow from what changed;
        of those that are the same the case keeps its own. A backlash that it leaves open is the
        file's, too, once the teeth are.
        """
        old, new = (
            {line.path: line for line in lines if "[" not in line.path}
            for lines in (before.lines, made.lines)
        )
        differ = {
            path
            for path in old.keys() | new.keys()
            if path not in old or path not in new or old[path].value != new[path].value
        }
        differ |= {"title"} if TITLE in self.keys else set()
        turned = {_table(new.get(path) or old[path]) for path in differ}
        if "backlash" in turned or ("gears" in turned and not self.data.get("backlash")):
            turned.add("backlash")
            self.data.pop("backlash", None)
        if "oil" in turned and "viscosity_40" not in self.data.get("oil", {}):
            name = self.case.stated.lubricant.name
            self.notes.append(f"oil: mineral, by two viscosities; what else {name} has is left out")
        gears = self.data["gears"]
        both = [key for key in ("face_width", "rack") if key in gears and "gears" in turned]
        shared = {key: gears.pop(key) for key in both}
        for name, _ in made.both:
            gears[name] = gear = deepcopy(shared) | gears[name]
            material = new.get(f"gears.{name}.material")
            if material is not None and _table(material) in turned:
                gear.pop("material", None)
                known = getattr(self.case.pair, name).material
                other = any(key.name == "material_designation" for key in self.keys)
                mine = {} if other else _unsaid(known)
                self.data.setdefault("materials", {}).setdefault(material.value, mine)
                if known.name in POLYMER_LIMITS:
                    limits = f"the temperatures that {known.name} bears are left out"
                    self.notes.append(f"{material.value}: {limits}")
        for path in differ - new.keys():
            *way, last = path.split(".")
            reduce(lambda held, key: held.get(key, {}), way, self.data).pop(last, None)
        for path, line in new.items():
            *way, last = path.split(".")
            if _table(line) in turned:
                table: Any = reduce(lambda held, key: held.setdefault(key, {}), way, self.data)
                if path in differ or last not in table:
                    table[last] = line.value
                    since = "; changed since the export" if path in differ else ""
                    self.changed[path] = f"{line.origin}: {line.note}{since}"

    # --- words -----------------------------------------------------------------------------
    def _called(self, key: Key) -> str:
        """The attribute of a key."""
        return key.called(self.parts, self.reader.model.version)

    def _shown(self, of: Values, key: Key) -> str:
        return shown(of.get(key), key, self.reader.model)

    def _refused(self, keys: list[Key], why: str) -> InputError:
        """Values that were changed and that no case follows from, by name."""
        names = list(dict.fromkeys(map(self._called, keys)))
        alone = len(names) == 1
        return InputError(
            some(names),
            self._shown(self.now, keys[0]) if alone else "values changed since the export",
            allowed=f"{self._shown(self.old, keys[0])}, as exported" if alone else None,
            why=why,
            fix=f"change what goes with it, or take {CASE} out of the file",
        )

    def _lines(self, again: Values) -> Iterator[str]:
        """A line for every value that was changed, for those added, for those left behind."""
        known, changed = self.old | again, set(self.keys)
        for name, key in {self._called(key): key for key in self.keys if key in known}.items():
            got, was = self._shown(self.now, key), self._shown(self.old, key)
            yield f"{name}: got {got}; it was {was} when exported"
        if added := dict.fromkeys(self._called(key) for key in self.keys if key not in known):
            yield f"{some(added)}: added since the export"
        left = {
            self._called(key): key
            for key, value in self.now.items()
            if key in again
            and key not in changed
            and isinstance(value, float)
            and not _agree(self.now, again, key)
        }
        if left:
            key = next(iter(left.values()))
            stays, follows = self._shown(self.now, key), self._shown(again, key)
            yield f"{some(left)}: {stays} in the file, {follows} follows from what changed"


def checked(stage: Stage, file: str | dict[str, Any]) -> GearCase:
    """The case of a text or of its tables; what is impossible in it speaks of the stage."""
    try:
        return gear_case(load_case(file) if isinstance(file, str) else case_of(file, "", ()))
    except InputError as error:
        first = error.errors[0] if isinstance(error, InputErrors) else error
        raise first.under(stage.field) from error


def exported(reader: Reader, stage: Stage) -> Exported | None:
    """The case that a stage was exported from; None in others."""
    holders = (stage.component, *reader.model.of_type("gear_unit"))
    holder = next((part for part in holders if CASE in part.attributes), None)
    if holder is None:
        return None
    try:
        kept = json.loads(str(holder.attributes[CASE].value))
        changes = tuple((str(path), str(text)) for path, text in kept["overrides"])
        data = overridden(tables("case", str(kept["text"])), changes)
        old = {
            Key(min(abs(load), MOST_LOAD_CASES), str(part), str(name)): _plain(value)
            for load, part, name, value in kept.get("values", ())
        }
    except (ValueError, KeyError, TypeError, RecursionError) as cause:
        raise InputError(
            f"{holder.called}.{CASE}",
            "no case of thermogear",
            fix=f"take the attribute {CASE} out of the file",
        ) from cause
    return Exported(reader, stage, data, old)


def _plain(value: Any) -> Plain:
    if isinstance(value, list):
        return [float(item) for item in value]
    return value if isinstance(value, str) else float(value)


def _said_by(case: GearCase, *, results: bool = False) -> Values:
    """What a case says in a REXS file."""
    model = model_of_case(case, WRITTEN[-1], results=results)
    return values(Reader(model), gearbox.stages(model)[0])


def _agree(now: Values, again: Values, key: Key) -> bool:
    """Whether a case says ``again`` what a file says ``now``, as far as it can.

    It has the middle of a least and a greatest backlash, and names a material as a table.
    """
    both = [of.get(key) for of in (now, again)]
    if key.name == "material_designation":
        both = [name and re.sub(r"_\d+$", "", label_of(str(name))) for name in both]
    elif key.name.endswith("_normal_backlash") and None not in both:
        ends = [key._replace(name=f"{end}_normal_backlash") for end in ("minimum", "maximum")]
        both = [float(np.mean([of[end] for end in ends if end in of])) for of in (now, again)]
    return alike(*both)


def _table(line: Line) -> str:
    """The table whose fields go together with a field."""
    if line.path.endswith(".material"):
        return f"materials.{line.value}"
    parts = line.path.split(".")
    alone = line.path == "oil.temperature" or parts[0] == "operating"
    return line.path if alone else ".".join(parts[: 2 if parts[0] == "materials" else 1])


def _unsaid(material: Material) -> dict[str, Any]:
    """What a case knows of a material and REXS has no name for."""
    tempered = material.tempering_temperature
    slope = {"modulus_slope": f"{material.modulus_slope!r} 1/K"}
    return slope | ({} if tempered == NEVER else {"tempering_temperature": f"{tempered!r} K"})


@dataclass(frozen=True)
class Found:
    """A stage as a list shows it: the pair in words, or why no case comes of it."""

    stage: Stage
    words: str
    why: InputError | None


@dataclass(frozen=True)
class Imported:
    """A stage as a case: the ``text`` of the case file, what could not be used, notes on units
    and on what another program changed of a case that was exported.

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
            mine = {name for name in one.attributes if name not in USED and OURS not in name}
            names[one.type] = names.get(one.type, set()) | mine
        elif one.id not in silent:
            parts[one.type] += 1
    lines = [f"{short(kind).strip(chr(39))}: {count}" for kind, count in parts.items()]
    for kind, several in names.items():
        if several:
            count = "1 attribute" if len(several) == 1 else f"{len(several)} attributes"
            lines.append(f"{kind}: {count}: {flat(some(sorted(several)))}"[:400])
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
    if (kept := exported(reader, one)) is not None:
        kept.take(speed, torque)
        unused = [*kept.unused, *left_out(model, _used(model, one))]
        duty = "" if kept.made is None else _duty(kept.made)
        text = kept.text(_head(model, one, unused))
        return Imported(text, tuple(unused), (*reader.said, *kept.notes), duty)
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
    return [*gearbox.parts_of(model, stage).values(), *whole]


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
