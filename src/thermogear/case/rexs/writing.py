"""REXS files: a model as XML, as JSON, or as XML in a zip."""

from __future__ import annotations

import io
import json
import zipfile
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from thermogear.base.errors import InputError, short
from thermogear.base.files import put, require_new_file
from thermogear.case.case import GearCase, gear_case
from thermogear.case.rexs.exporting import model_of_case
from thermogear.case.rexs.model import Attribute, Component, Model

_KINDS = {
    ".rexs": "xml",
    ".xml": "xml",
    ".rexsj": "json",
    ".json": "json",
    ".rexsz": "zip",
    ".zip": "zip",
}
_ENUMS = ("shape_of_relief", "tolerance_class_according_to_iso_1328_2013")
_REFERENCES = ("reference_component_for_position",)


def write_rexs(case: GearCase, path: str | Path, *, version: str = "1.7") -> Path:
    """Write ``case`` and its quasi-static results as a new REXS file; its path.

    The name says the container: ``.rexs`` XML, ``.rexsj`` JSON, ``.rexsz`` XML in a zip;
    ``version`` "1.4" to "1.7" or "2.0.0". Gears, tools, materials, oil, reliefs, a load case for
    each operating point with speeds, torques, temperatures and results; values in the units of
    REXS, exactly and in SI as ``custom_thermogear_*`` beside them. ``thermogear import`` gives the
    same case, bit for bit. Raises InputError for a case without gears, more than 2000 operating
    points, another ending and a file that is there already.
    Source: REXS specification (rexs.info).
    """
    place = Path(path)
    kind = _KINDS.get(place.suffix.lower())
    if kind is None:
        raise InputError(
            "output", short(place.name), allowed=" | ".join(_KINDS), fix="write mine.rexs"
        )
    require_new_file(place)
    model = model_of_case(gear_case(case), version)
    date = datetime.now(UTC).replace(microsecond=0).isoformat()
    if kind == "json":
        return put(place, _json(model, date))
    text = _xml(model, date)
    return put(place, text if kind == "xml" else _zip(place.stem, text))


def _zip(name: str, text: str) -> bytes:
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"{name}.rexs", text)
    return held.getvalue()


# --- XML ------------------------------------------------------------------------------------


def _xml(model: Model, date: str) -> str:
    name, _, number = model.application.partition(" ")
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<model version="{model.version}" applicationId="{name}" applicationVersion="{number}" '
        f'date="{date}">',
        "  <relations>",
    ]
    for relation in model.relations:
        order = "" if relation.order is None else f' order="{relation.order}"'
        lines.append(f'    <relation id="{relation.id}" type="{relation.type}"{order}>')
        lines += [f'      <ref id="{found}" role="{role}"/>' for role, found in relation.refs]
        lines.append("    </relation>")
    lines += ["  </relations>", "  <components>"]
    for component in model.components.values():
        lines += _component(component, component.attributes, "    ")
    lines += ["  </components>", '  <load_spectrum id="1">']
    for case in model.load_cases:
        lines.append(f'    <load_case id="{case.id}">')
        for found, attributes in case.components.items():
            lines += _component(model.components[found], attributes, "      ")
        lines.append("    </load_case>")
    if model.accumulation:
        lines.append("    <accumulation>")
        for found, attributes in model.accumulation.items():
            lines += _component(model.components[found], attributes, "      ")
        lines.append("    </accumulation>")
    return "\n".join([*lines, "  </load_spectrum>", "</model>"]) + "\n"


def _component(component: Component, attributes: dict[str, Attribute], indent: str) -> list[str]:
    name = f" name={quoteattr(_printable(component.name))}" if component.name else ""
    head = f'{indent}<component id="{component.id}" type="{component.type}"{name}'
    if not attributes:
        return [head + "/>"]
    inside = [
        f"{indent}  <attribute id={quoteattr(one.id)} unit={quoteattr(one.unit or 'none')}>"
        f"{_value(one.value)}</attribute>"
        for one in attributes.values()
    ]
    return [head + ">", *inside, f"{indent}</component>"]


def _value(value: Any) -> str:
    if isinstance(value, list):
        return f"<array>{''.join(f'<c>{_value(one)}</c>' for one in value)}</array>"
    if isinstance(value, bool):
        return str(value).lower()
    return escape(value) if isinstance(value, str) else repr(value)


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else " " for c in text)


# --- JSON -----------------------------------------------------------------------------------


def _json(model: Model, date: str) -> str:
    name, _, number = model.application.partition(" ")
    relations = []
    for relation in model.relations:
        entry: dict[str, Any] = {"id": relation.id, "type": relation.type}
        if relation.order is not None:
            entry["order"] = relation.order
        entry["refs"] = [{"id": found, "role": role} for role, found in relation.refs]
        relations.append(entry)
    spectrum: dict[str, Any] = {
        "id": 1,
        "load_cases": [
            {"id": case.id, "components": _tables(model, case.components)}
            for case in model.load_cases
        ],
    }
    if model.accumulation:
        spectrum["accumulation"] = {"components": _tables(model, model.accumulation)}
    whole = {found: one.attributes for found, one in model.components.items()}
    content = {
        "version": model.version,
        "applicationId": name,
        "applicationVersion": number,
        "date": date,
        "relations": relations,
        "components": _tables(model, whole),
        "load_spectrum": spectrum,
    }
    return json.dumps({"model": content}, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _tables(model: Model, of: dict[int, dict[str, Attribute]]) -> list[dict[str, Any]]:
    found = []
    for place, attributes in of.items():
        component = model.components[place]
        table: dict[str, Any] = {"id": place, "type": component.type}
        if component.name:
            table["name"] = component.name
        table["attributes"] = [
            {"id": one.id, "unit": one.unit or "none", _key(one): one.value}
            for one in attributes.values()
        ]
        found.append(table)
    return found


def _key(one: Attribute) -> str:
    """The key that says the type of a value."""
    if isinstance(one.value, list):
        return "floating_point_array"
    if isinstance(one.value, bool):
        return "boolean"
    if isinstance(one.value, int):
        return "reference_component" if one.id in _REFERENCES else "integer"
    if isinstance(one.value, str):
        return "enum" if one.id in _ENUMS else "string"
    return "floating_point"
