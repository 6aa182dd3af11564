"""The fields of a gear case as rows of a form, each as ``--set`` names and takes it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

from thermogear.base.errors import InputError
from thermogear.base.toml import NAMED, given, settable
from thermogear.case.described import in_words
from thermogear.case.schema import json_schema

_BESIDE = ("files", "ours")
"""Tables that say where values come from; nobody sets them in a form."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One field: ``path`` as ``--set`` takes it, ``given`` the text behind ``PATH=``.

    ``given`` is empty where the file does not give the field; ``left_out`` says what holds then
    ("needed": the case is refused; "with its table": only
    where others of its table are given). ``kind`` is the ``x-kind`` of
    :mod:`~thermogear.case.described`; ``minimum``, ``maximum`` and ``step`` are in ``unit``,
    ``several`` where a list of values may be written. ``group`` names the table of the file,
    ``about`` the range in words. A list of tables is one entry, its text a list of inline tables.
    """

    path: str
    title: str
    group: str
    kind: str
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    step: float | None = None
    choices: tuple[str, ...] = ()
    several: bool = False
    given: str = ""
    left_out: str = ""
    about: str = ""

    @property
    def row(self) -> dict[str, Any]:
        """The entry as JSON holds it."""
        return {**asdict(self), "choices": list(self.choices)}


def form(data: Mapping[str, Any]) -> list[Entry]:
    """Every field that a gear case may give, in the order of the schema; ``data`` its tables.

    ``load_case(text, {one.path: one.given for one in form(data) if one.given})`` is the case again.
    Of tables with names of the user's own, as ``[materials.bronze]``, those that ``data`` holds
    have entries; a name that ``--set`` cannot write leaves one entry of all of them. ``[files]``
    and ``[ours]``, which say where values come from, have none. Raises InputError for a case
    without gears.

    >>> case = load_case("rig")
    >>> next(one.given for one in form(case.data) if one.path == "gears.module")
    '5 mm'
    """
    if data.get("kind", "gear") != "gear":
        got = f"kind = {data['kind']!r}"
        raise InputError("case", got, allowed="kind = 'gear'", why="there is no gear in it")
    return list(_entries(_Place(table="GearFile"), data))


@dataclass(frozen=True, kw_only=True)
class _Place:
    """Where a table is: its name in the schema, its path, what is said of leaving it out.

    ``there``: whether the case has it, so that its needed fields are needed.
    """

    table: str
    path: tuple[str, ...] = ()
    left_out: str = ""
    there: bool = True

    def needs(self, key: str) -> bool:
        """Whether the table cannot be without the field ``key``."""
        return key in _defs()[self.table].get("required", ())

    def below(self, key: str, about: Mapping[str, Any], held: bool) -> _Place:
        """The place of the table ``key`` in this one."""
        words = "" if held else about.get("x-left-out") or self.left_out
        return _Place(
            table=_table_of(about),
            path=(*self.path, key),
            left_out=words,
            there=held or (self.there and self.needs(key)),
        )

    def entry(self, key: str, about: Mapping[str, Any], value: Any) -> Entry:
        """The entry of the field ``key``."""
        words = about.get("description", "")
        own = about.get("x-left-out") or ("" if words == about.get("$comment") else words)
        needed = ("needed" if self.there else "with its table") if self.needs(key) else ""
        return Entry(
            path=".".join((*self.path, key)),
            title=about["title"],
            group=", ".join(in_words(part) for part in self.path) or "case",
            kind=about["x-kind"],
            unit=about.get("x-unit", ""),
            minimum=about.get("x-minimum"),
            maximum=about.get("x-maximum"),
            step=about.get("x-step"),
            choices=tuple(about.get("x-choices", ())),
            several=about.get("x-list", False),
            given="" if value is None else given(value),
            left_out=own or self.left_out or needed,
            about=about.get("x-about", ""),
        )


def _entries(place: _Place, data: Mapping[str, Any]) -> Iterator[Entry]:
    for key, about in _defs()[place.table]["properties"].items():
        if place.path or key not in _BESIDE:
            yield from _field(place, key, about, data.get(key))


def _field(place: _Place, key: str, about: Mapping[str, Any], value: Any) -> Iterator[Entry]:
    kind = about["x-kind"]
    inside = value if isinstance(value, Mapping) else {}
    if not _table_of(about):
        yield place.entry(key, about, value)
        return
    below = place.below(key, about, value is not None)
    named = NAMED.get(".".join(below.path))
    if kind == "table" or (named and isinstance(value, Mapping)):
        yield from _entries(below, inside)
    elif named:  # a name, or a table that holds it
        yield place.entry(key, about, value)
        law = ".".join((*below.path, named))
        yield from (one for one in _entries(below, {}) if one.path != law)
    elif (
        kind == "named tables"
        and inside
        and all(settable(name) and "." not in name for name in inside)
    ):
        for name, table in inside.items():
            yield from _entries(_Place(table=below.table, path=(*below.path, name)), table)
    else:
        yield place.entry(key, about, value)


def _table_of(about: Mapping[str, Any]) -> str:
    """The name of the table that a property holds, one or several; empty where it is none."""
    if "$ref" in about:
        return str(about["$ref"]).rsplit("/", 1)[1]
    inner = [*about.get("anyOf", ()), about.get("items"), about.get("additionalProperties")]
    found = (_table_of(one) for one in inner if isinstance(one, Mapping))
    return next((name for name in found if name), "")


@lru_cache(maxsize=1)
def _defs() -> dict[str, Any]:
    tables: dict[str, Any] = json_schema()["$defs"]
    return tables
