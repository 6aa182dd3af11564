"""REXS files: a model as XML, as JSON, or as XML in a zip."""

from __future__ import annotations

import io
import json
import zipfile
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from thermogear.base.errors import InputError, short
from thermogear.base.files import put_new, require_new_file
from thermogear.case.case import GearCase, gear_case
from thermogear.case.rexs.exporting import model_of_case
from thermogear.case.rexs.model import Attribute, Model

_KINDS = {
    ".rexs": "xml",
    ".xml": "xml",
    ".rexsj": "json",
    ".json": "json",
    ".rexsz": "zip",
    ".zip": "zip",
}
_TYPES = {
    list: "floating_point_array",
    bool: "boolean",
    int: "integer",
    float: "floating_point",
    str: "string",
}
_NAMED = {
    "shape_of_relief": "enum",
    "reference_component_for_position": "reference_component",
}
"""The key that says the type of a value: by the value, but for these attributes."""


def write_rexs(case: GearCase, path: str | Path, *, version: str = "1.7") -> Path:
    """Write ``case`` and its quasi-static results as a new REXS file; its path.

    The name says the container: ``.rexs`` XML, ``.rexsj`` JSON, ``.rexsz`` XML in a zip;
    ``version`` "1.4" to "1.7" or "2.0.0". Gears, tools, materials, oil, reliefs, a load case for
    each operating point with speeds, torques, temperatures and results; values in the units of
    REXS, such as [mm] and [1 / min], the whole case as ``custom_thermogear_case``. ``thermogear
    import`` gives the same case, bit for bit. Raises InputError for a case without gears, more
    than 2000 operating points, another ending and a file that is there already.
    Source: REXS specification (rexs.info).
    """
    place = Path(path)
    kind = _KINDS.get(place.suffix.lower())
    if kind is None:
        raise InputError(
            "output", short(place.name), allowed=" | ".join(_KINDS), fix="write mine.rexs"
        )
    require_new_file(place)
    content = _content(model_of_case(gear_case(case), version))
    if kind == "json":
        text = json.dumps({"model": content}, indent=1, ensure_ascii=False, allow_nan=False)
        return put_new(place, f"{text}\n")
    text = _xml(content)
    return put_new(place, text if kind == "xml" else _zip(place.stem, text))


def _zip(name: str, text: str) -> bytes:
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"{name}.rexs", text)
    return held.getvalue()


# --- XML ------------------------------------------------------------------------------------


def _xml(content: dict[str, Any]) -> str:
    root = ElementTree.Element("model")
    _fill(root, content)
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, "unicode") + "\n"


def _fill(element: ElementTree.Element, table: dict[str, Any]) -> None:
    """Put the table of a JSON file into an element: its lists as children, else as attributes."""
    for key, value in table.items():
        if isinstance(value, dict):
            _fill(ElementTree.SubElement(element, key), value)
        elif element.tag == "attribute" and key not in ("id", "unit"):
            if isinstance(value, list):
                array = ElementTree.SubElement(element, "array")
                for item in value:
                    ElementTree.SubElement(array, "c").text = _text(item)
            else:
                element.text = _text(value)
        elif isinstance(value, list):
            whole = element.tag == "model"
            holder = ElementTree.SubElement(element, key) if whole else element
            for item in value:
                _fill(ElementTree.SubElement(holder, key.removesuffix("s")), item)
        else:
            element.set(key, "".join(c if c.isprintable() else " " for c in str(value)))


def _text(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


# --- JSON -----------------------------------------------------------------------------------


def _content(model: Model) -> dict[str, Any]:
    """The table ``model`` of a JSON file."""
    name, _, number = model.application.partition(" ")
    spectrum: dict[str, Any] = {
        "id": 1,
        "load_cases": [
            {"id": case.id, "components": _tables(model, case.components)}
            for case in model.load_cases
        ],
        "accumulation": {"components": _tables(model, model.accumulation)},
    }
    return {
        "version": model.version,
        "applicationId": name,
        "applicationVersion": number,
        "date": datetime.now(UTC).replace(microsecond=0).isoformat(),
        "relations": [
            {"id": one.id, "type": one.type}
            | ({} if one.order is None else {"order": one.order})
            | {"refs": [{"id": ident, "role": role} for role, ident in one.refs]}
            for one in model.relations
        ],
        "components": _tables(
            model, {ident: one.attributes for ident, one in model.components.items()}
        ),
        "load_spectrum": spectrum,
    }


def _tables(model: Model, of: dict[int, dict[str, Attribute]]) -> list[dict[str, Any]]:
    named = {ident: model.components[ident] for ident in of}
    return [
        {"id": ident, "type": named[ident].type}
        | ({"name": named[ident].name} if named[ident].name else {})
        | {
            "attributes": [
                {
                    "id": one.id,
                    "unit": one.unit or "none",
                    _NAMED.get(one.id, _TYPES[type(one.value)]): one.value,
                }
                for one in attributes.values()
            ]
        }
        for ident, attributes in of.items()
    ]
