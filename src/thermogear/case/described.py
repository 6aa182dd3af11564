"""What a form needs to know of each field of a table, for its JSON schema.

Keys of a property: ``x-kind`` (the kind of a measure such as "length", else "number", "count",
"choice", "text", "yes/no", "number or temperature", "table", "tables", "named tables"); of a
measure ``x-unit``, the unit of its example; ``x-minimum``, ``x-maximum`` and ``x-step`` in that
unit; ``x-choices``; ``x-list`` where several may be written; ``x-about``, range and reason in
words; ``x-left-out``, what holds where it is left out and the description does not say;
``x-order`` in its table and ``x-group``, the table in words; ``title``, the field in words.
"""

from __future__ import annotations

import re
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from thermogear.case.refusals import models_of, reader_of


def described(table: type[BaseModel]) -> dict[str, dict[str, Any]]:
    """The keys of every field of ``table`` by its name."""
    name = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", table.__name__.removesuffix("Table")).lower()
    return {
        key: {
            "title": in_words(key),
            **_facts(field),
            **({"x-left-out": field.title.removeprefix("left out: ")} if field.title else {}),
            "x-order": order,
            "x-group": name,
        }
        for order, (key, field) in enumerate(table.model_fields.items())
    }


def in_words(name: str) -> str:
    """A field's name in words: "tip_diameter" is "tip diameter"."""
    return name.replace("_", " ")


def _facts(field: FieldInfo) -> dict[str, Any]:
    if reader := reader_of(field):
        return reader.facts()
    annotation = field.annotation
    one, several = models_of(annotation)
    if one:
        return {"x-kind": "table"}
    if several:
        named = getattr(annotation, "__origin__", None) is dict
        return {"x-kind": "named tables" if named else "tables"}
    inner = [annotation, *get_args(annotation)]
    truth = any(bool in (one, *get_args(one)) for one in inner)
    return {"x-kind": "yes/no" if truth else "table"}
