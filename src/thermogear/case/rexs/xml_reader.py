"""A model out of XML, read as a stream: no DTD, no entity, no tree in memory."""

from __future__ import annotations

from typing import Any
from xml.parsers import expat

from thermogear.base.errors import InputError, short
from thermogear.case.rexs.coded import decoded_array, decoded_matrix
from thermogear.case.rexs.model import (
    LONGEST_TEXT,
    Attribute,
    Component,
    LoadCase,
    Model,
    Relation,
    identity,
    known_version,
    too_many,
)

MOST_NODES = 2_000_000
DEEPEST = 32
_CHUNK = 1 << 16
_ROOT = "model"


def read_xml(raw: bytes, container: str) -> Model:
    """The model in the bytes of an XML file; InputError in one line."""
    return _Reader(container).read(raw)


class _Reader:
    """What has been opened and not closed yet, and the model as far as it is read."""

    def __init__(self, container: str) -> None:
        self.container = container
        self.model: Model | None = None
        self.path: list[str] = []
        self.nodes = 0
        self.refs: list[tuple[str, int]] = []
        self.relation: dict[str, str] = {}
        self.component: Component | None = None
        self.attribute: dict[str, str] | None = None
        self.text: list[str] | None = None
        self.length = 0
        self.cells: list[Any] | None = None
        self.rows: list[Any] | None = None
        self.coded: dict[str, str] | None = None
        self.spectrum = 0
        self.case: LoadCase | None = None
        self.accumulated = False

    def read(self, raw: bytes) -> Model:
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
        if self.model is None:
            raise InputError("REXS file", "no element 'model'", allowed="a REXS model")
        return self.model

    def _doctype(self, *_: object) -> None:
        raise InputError(
            "REXS file", "a DOCTYPE", allowed="none", why="no REXS file has entities or a DTD"
        )

    # --- elements --------------------------------------------------------------------------
    def _start(self, name: str, given: dict[str, str]) -> None:
        self.nodes += 1
        if self.nodes > MOST_NODES:
            raise too_many("nodes", MOST_NODES)
        name = name.rpartition(":")[2]
        self.path.append(name)
        if len(self.path) > DEEPEST:
            raise InputError("REXS file", f"elements {DEEPEST} deep", allowed="no deeper nesting")
        if self.model is None:
            self._root(name, given)
        elif self.attribute is not None:
            self._value(name, given)
        elif name == "attribute":
            self.attribute, self.text, self.length = given, [], 0
            self.cells = self.rows = self.coded = None
        elif name == "component":
            found = identity(given.get("id"), "component")
            self.component = Component(found, given.get("type", ""), given.get("name", ""))
        elif name == "relation":
            self.relation, self.refs = given, []
        elif name == "ref":
            self.refs.append((given.get("role", ""), identity(given.get("id"), "ref")))
        elif name == "load_spectrum":
            self.spectrum = identity(given.get("id", "0"), name)
        elif name == "load_case":
            self.case = LoadCase(
                id=identity(given.get("id"), name), spectrum=self.spectrum, components={}
            )
        elif name == "accumulation":
            self.accumulated = True

    def _root(self, name: str, given: dict[str, str]) -> None:
        if name != _ROOT:
            raise InputError("REXS file", f"the element {short(name)}", allowed="'model'")
        says = [given.get(key, "") for key in ("applicationId", "applicationVersion")]
        self.model = Model(
            known_version(given.get("version")), " ".join(filter(None, says)), self.container
        )

    def _value(self, name: str, given: dict[str, str]) -> None:
        if name == "matrix":
            self.rows, self.coded = [], given if "code" in given else None
        elif name == "array":
            self.cells, self.coded = [], given if "code" in given else None
        elif name == "r":
            self.cells = []
        if self.coded is None:
            self.text = []

    def _characters(self, text: str) -> None:
        if self.text is None:
            return
        self.length += len(text)
        if self.length > LONGEST_TEXT:
            raise too_many("characters in one value", LONGEST_TEXT)
        self.text.append(text)

    def _end(self, name: str) -> None:
        name = self.path.pop()
        model = self.model
        assert model is not None
        if self.attribute is not None:
            if name == "attribute":
                self._close_attribute(model)
            else:
                self._close_value(name)
        elif name == "component":
            self._close_component(model)
        elif name == "relation":
            order = self.relation.get("order")
            found = identity(self.relation.get("id", "0"), "relation")
            place = None if order is None else identity(order, "relation order")
            model.relate(Relation(found, self.relation.get("type", ""), place, tuple(self.refs)))
        elif name == "load_case" and self.case is not None:
            model.load(self.case)
            self.case = None
        elif name == "accumulation":
            self.accumulated = False

    def _close_value(self, name: str) -> None:
        said = "".join(self.text or [])
        if name == "c" and self.cells is not None:
            self.cells.append(said.strip())
            self.text = []
        elif name == "r" and self.rows is not None:
            self.rows.append(self.cells)
            self.cells = None
        elif name == "array" and self.coded is not None:
            self.cells = list(decoded_array(self.coded.get("code"), said))
        elif name == "matrix" and self.coded is not None:
            self.rows = decoded_matrix(
                self.coded.get("code"), said, self.coded.get("rows"), self.coded.get("columns")
            )

    def _close_attribute(self, model: Model) -> None:
        given = self.attribute or {}
        value: Any = "".join(self.text or []).strip()
        if self.rows is not None:
            value = self.rows
        elif self.cells is not None:
            value = self.cells
        self.attribute = self.text = None
        found = given.get("id", "")
        if self.component is not None and found:
            model.count()
            self.component.attributes[found] = Attribute(found, given.get("unit"), value)

    def _close_component(self, model: Model) -> None:
        component, self.component = self.component, None
        if component is None:
            return
        if self.case is not None:
            self.case.components.setdefault(component.id, {}).update(component.attributes)
        elif self.accumulated:
            model.accumulation.setdefault(component.id, {}).update(component.attributes)
        else:
            model.add(component)
