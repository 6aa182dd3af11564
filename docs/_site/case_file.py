"""The reference of the case file, from the JSON schema that `thermogear schema` prints."""

from __future__ import annotations

from typing import Any

from thermogear.case.schema import json_schema

TITLES = {
    "GearFile": "A gear pair",
    "DimensionlessFile": "A dimensionless case",
}


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ").replace("*", "\\*").replace("<", "&lt;")


def _number(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _kind(field: dict[str, Any]) -> str:
    """What may stand there, in words."""
    if "$ref" in field:
        name = field["$ref"].rsplit("/", 1)[1]
        return f"[table {_table(name)}](#{_anchor(name)})"
    if "const" in field:
        return f"`{field['const']!r}`"
    if "enum" in field:
        return ", ".join(f"`{value!r}`".replace("'", '"') for value in field["enum"])
    if "anyOf" in field:
        kinds = [_kind(one) for one in field["anyOf"] if one.get("type") != "null"]
        return " or ".join(dict.fromkeys(kinds))
    if field.get("type") == "array":
        return f"list of: {_kind(field.get('items', {}))}"
    if field.get("type") == "object":
        inner = field.get("additionalProperties")
        return f"table of: {_kind(inner)}" if isinstance(inner, dict) else "table"
    if field.get("type") == "string":
        example = field.get("examples")
        words = field.get("$comment", "text")
        return f'{_cell(words)}, as `"{example[0]}"`' if example else _cell(words)
    if field.get("type") in ("integer", "number"):
        low = field.get("minimum", field.get("exclusiveMinimum"))
        high = field.get("maximum", field.get("exclusiveMaximum"))
        limited = low is not None and high is not None
        return field["type"] + (f" {_number(low)} .. {_number(high)}" if limited else "")
    return {"boolean": "`true` or `false`"}.get(str(field.get("type")), "any value")


def _default(field: dict[str, Any], required: bool) -> str:
    if required:
        return "**required**"
    about = field.get("description", "")
    note = field.get("x-left-out") or ("" if about == field.get("$comment") else about)
    default = field.get("default")
    shown = "" if default is None or default in ({}, [], "") else f"`{default!r}`".replace("'", '"')
    said = "; ".join(part for part in (shown, _cell(note)) if part)
    return said or ("every default below" if "$ref" in field else "may be left out")


def _table(name: str) -> str:
    return name.removesuffix("Table").lower()


def _anchor(name: str) -> str:
    return f"case-{name.lower()}"


def _section(name: str, table: dict[str, Any]) -> str:
    title = TITLES.get(name, f"Table {_table(name)}")
    text = f"({_anchor(name)})=\n## {title}\n\n"
    about = (table.get("description") or "").strip()
    if about:
        text += about.replace("*", "\\*") + "\n\n"
    required = set(table.get("required", ()))
    text += "| field | what may stand there | if left out |\n|---|---|---|\n"
    for field, about_field in table.get("properties", {}).items():
        kind = _kind(about_field)
        default = _default(about_field, field in required)
        text += f"| `{field}` | {kind} | {default} |\n"
    return text + "\n"


def case_file() -> dict[str, str]:
    """One section per table of the case file."""
    whole = json_schema()
    tables = whole["$defs"]
    first = [one["$ref"].rsplit("/", 1)[1] for one in whole["anyOf"]]
    text = "# The case file\n\n"
    text += (
        'A case is a TOML file. A number with a unit is a text, `"5 mm"`; a pure number stands '
        "alone, `0.07`. Units stand as catalogues write them: `1/min`, `Nmm`, `µm`, `mm²/s`, `°C`. "
        "The commented examples of `thermogear example NAME` are the best start; "
        "this page lists every field, from the schema that `thermogear schema` prints. A field "
        "under `[gears.pinion]` is put in place on the command line by "
        "`--set gears.pinion.teeth=30`; with nothing behind the sign, "
        "`--set gears.pinion.tip_diameter=`, a field or a whole table of the file is left out, and "
        "its default acts.\n\n"
    )
    for name in [*first, *(one for one in tables if one not in first)]:
        text += _section(name, tables[name])
    return {"generated/case_file.md": text}
