"""A model out of XML, read as a stream into the tables of a JSON file: no DTD, no entity."""

from __future__ import annotations

from typing import Any
from xml.parsers import expat

from thermogear.base.errors import InputError, short
from thermogear.case.rexs.json_reader import MOST_NODES, model_in
from thermogear.case.rexs.model import LONGEST_TEXT, Model, too_many

DEEPEST = 32
_CHUNK = 1 << 16
_ROOT = "model"
_GIVEN = {"id", "type", "name", "unit", "order", "role", "version", "applicationId"} | {
    *("applicationVersion", "code", "rows", "columns"),
}
"""Attributes of elements that are read; others would pass for lists."""
_LISTS = {
    name: f"{name}s" for name in ("relation", "ref", "component", "attribute", "load_case")
} | {"load_spectrum": "load_spectrum"}
"""Elements that a table has several of, and the key of their list."""
_CELLS = {"c": "string_array", "r": "string_matrix"}
"""Cells of an array or a row, rows of a matrix, and the key of their list."""


def read_xml(raw: bytes, container: str) -> Model:
    """The model in the bytes of an XML file; InputError in one line."""
    return model_in(_Reader().read(raw), container)


class _Reader:
    """Elements that have been opened and not closed yet as (name, table); the text of the last."""

    def __init__(self) -> None:
        self.root: dict[str, Any] | None = None
        self.open: list[tuple[str, dict[str, Any]]] = []
        self.text: list[str] = []
        self.nodes = self.length = 0

    def read(self, raw: bytes) -> dict[str, Any]:
        parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.StartDoctypeDeclHandler = self._doctype
        parser.EntityDeclHandler = self._doctype
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._characters
        try:
            view = memoryview(raw)
            for place in range(0, len(raw), _CHUNK):
                parser.Parse(view[place : place + _CHUNK].tobytes(), False)
            parser.Parse(b"", True)
        except (expat.ExpatError, UnicodeError, ValueError) as cause:
            if isinstance(cause, InputError):
                cause.line = cause.line or parser.CurrentLineNumber
                raise
            line = getattr(cause, "lineno", parser.CurrentLineNumber)
            raise InputError(
                "REXS file", f"XML that breaks off in line {line}", why=str(cause).split(":")[0]
            ) from cause
        if self.root is None:
            raise InputError("REXS file", "no element 'model'", allowed="a REXS model")
        return self.root

    def _doctype(self, *_: object) -> None:
        raise InputError(
            "REXS file", "a DOCTYPE", allowed="none", why="no REXS file has entities or a DTD"
        )

    def _start(self, name: str, given: dict[str, str]) -> None:
        self.nodes += 1
        if self.nodes > MOST_NODES:
            raise too_many("nodes", MOST_NODES)
        name = name.rpartition(":")[2]
        if len(self.open) >= DEEPEST:
            raise InputError("REXS file", f"elements {DEEPEST} deep", allowed="no deeper nesting")
        if not self.open and name != _ROOT:
            raise InputError("REXS file", f"the element {short(name)}", allowed="'model'")
        self.open.append((name, {key: given[key] for key in given if key in _GIVEN}))
        self.text, self.length = [], 0

    def _characters(self, text: str) -> None:
        self.length += len(text)
        if self.length > LONGEST_TEXT:
            raise too_many("characters in one value", LONGEST_TEXT)
        self.text.append(text)

    def _end(self, name: str) -> None:
        name, table = self.open.pop()
        text, self.text = "".join(self.text).strip(), []
        if not self.open:
            self.root = table
            return
        above = self.open[-1][1]
        if name in ("relations", "components"):
            above.setdefault(name, []).extend(table.get(name, ()))
        elif name in ("array", "matrix"):
            plain = {f"string_{name}": table.get(f"string_{name}", [])}
            above |= {f"string_{name}_coded": table | {"value": text}} if "code" in table else plain
        elif name in _CELLS:
            above.setdefault(_CELLS[name], []).append(table.get("string_array", text))
        elif name in _LISTS:
            if name == "attribute" and table.keys() <= {"id", "unit"}:
                table["string"] = text
            above.setdefault(_LISTS[name], []).append(table)
