"""A case that was exported, and what another program changed in the file since.

Where nothing changed that is read, the case comes back as it was, bit for bit. Else the file counts
as it is: the fields that follow from what changed are those of an import of the file, all
others those of the case. The case that comes of it must say what the file says, value by value;
what it does not is refused by name.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from copy import deepcopy
from functools import reduce
from typing import Any

import numpy as np

from thermogear.base.errors import InputError, InputErrors
from thermogear.base.materials import NEVER, POLYMER_LIMITS, Material
from thermogear.base.toml import overridden, tables
from thermogear.case.case import GearCase, case_of, gear_case, load_case
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import CASE, Plain, Reader
from thermogear.case.rexs.draft import Draft
from thermogear.case.rexs.exporting import WRITTEN, model_of_case
from thermogear.case.rexs.gearbox import Stage
from thermogear.case.rexs.lines import Line, some, stored
from thermogear.case.rexs.model import MOST_LOAD_CASES
from thermogear.case.rexs.stage_case import draft
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
