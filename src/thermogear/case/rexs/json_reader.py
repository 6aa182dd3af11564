"""A model out of the tables of JSON; what would not fit the memory is refused before it is read.

Coded arrays (REXS 1.4 and later) and matrices are passed over: no attribute that is used is long.
"""

from __future__ import annotations

import json
import re
from typing import Any, NoReturn

from thermogear.base.errors import InputError, short
from thermogear.case.rexs.model import (
    LONGEST_TEXT,
    Attribute,
    Component,
    LoadCase,
    Model,
    Relation,
    Value,
    identity,
    known_version,
    too_many,
)

MOST_NODES = 2_000_000
_TYPE = re.compile(
    r"(boolean|string|integer|floating_point|enum|reference_component|file_reference|date_time)"
    r"(_(array|matrix)(_coded)?)?"
)
"""The keys that hold a value, by its type."""


def read_json(raw: bytes, container: str) -> Model:
    """The model in the bytes of a JSON file; InputError in one line."""
    if sum(raw.count(sign) for sign in (b",", b"[", b"{")) > MOST_NODES:
        raise too_many("nodes", MOST_NODES)
    try:
        root = json.loads(raw.decode("utf-8-sig"), parse_constant=_no_number)
    except UnicodeDecodeError as cause:
        raise InputError(
            "REXS file", f"byte 0x{raw[cause.start]:02x}", allowed="UTF-8 text"
        ) from cause
    except json.JSONDecodeError as cause:
        raise InputError(
            "REXS file", f"JSON that breaks off in line {cause.lineno}", why=cause.msg
        ) from cause
    except (RecursionError, ValueError) as cause:
        if isinstance(cause, InputError):
            raise
        raise InputError(
            "REXS file", "a number or a nesting beyond reason", allowed="JSON"
        ) from cause
    found = root.get("model") if isinstance(root, dict) else None
    if not isinstance(found, dict):
        raise InputError("REXS file", "no entry 'model'", allowed="a REXS model")
    return model_in(found, container)


def _no_number(text: str) -> NoReturn:
    raise InputError("REXS file", text, allowed="finite numbers", why="JSON has no such number")


def model_in(root: dict[str, Any], container: str) -> Model:
    """The model in the tables of a file; InputError in one line."""
    says = [str(root.get(key) or "") for key in ("applicationId", "applicationVersion")]
    model = Model(known_version(root.get("version")), " ".join(filter(None, says))[:200], container)
    for one in _list(root, "relations"):
        order = one.get("order")
        refs = tuple(
            (str(ref.get("role", "")), identity(ref.get("id"), "ref")) for ref in _list(one, "refs")
        )
        model.relate(
            Relation(
                identity(one.get("id", 0), "relation"),
                str(one.get("type", "")),
                None if order is None else identity(order, "relation order"),
                refs,
            )
        )
    for one in _list(root, "components"):
        found = identity(one.get("id"), "component")
        name = one.get("name")
        model.add(
            Component(
                found,
                str(one.get("type", "")),
                name if isinstance(name, str) else "",
                _attributes(one, model),
            )
        )
    spectra = root.get("load_spectrum")
    for spectrum in spectra if isinstance(spectra, list) else [spectra]:
        _spectrum(spectrum, model)
    return model


def _spectrum(spectrum: object, model: Model) -> None:
    if spectrum is None:
        return
    if not isinstance(spectrum, dict):
        raise InputError("load_spectrum", short(spectrum), allowed="a table of load cases")
    of = identity(spectrum.get("id", 0), "load_spectrum")
    for case in _list(spectrum, "load_cases"):
        found = LoadCase(id=identity(case.get("id"), "load_case"), spectrum=of, components={})
        for one in _list(case, "components"):
            place = identity(one.get("id"), "component")
            found.components.setdefault(place, {}).update(_attributes(one, model))
        model.load(found)


def _list(table: dict[str, Any], key: str) -> list[dict[str, Any]]:
    found = table.get(key)
    if found is None:
        return []
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise InputError(key, short(found), allowed="a list of tables")
    return found


def _attributes(table: dict[str, Any], model: Model) -> dict[str, Attribute]:
    found: dict[str, Attribute] = {}
    for one in _list(table, "attributes"):
        name, unit = one.get("id"), one.get("unit")
        if not isinstance(name, str):
            raise InputError("attribute id", short(name), allowed="a text")
        model.count()
        found[name] = Attribute(name, unit if isinstance(unit, str) else None, _value(one))
    return found


def _value(entry: dict[str, Any]) -> Value:
    """What an attribute holds, under whichever key its type has; None where nothing."""
    key, value = next((one for one in entry.items() if _TYPE.fullmatch(one[0])), ("", None))
    if key.endswith("_coded"):
        return None
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        raise too_many("characters in one value", LONGEST_TEXT)
    if isinstance(value, dict):
        raise InputError(str(entry.get("id")), "a table", allowed="a value")
    return value
