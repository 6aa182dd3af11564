"""What a reader should know beside the numbers: a code with data, its sentence from a catalogue.

The catalogue is the folder ``notices`` beside this module: of each code the level, the sentence
with the fields of the data in braces, and what the reader can do. A sentence is made here and
nowhere else.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import resources
from string import Formatter
from typing import Any

import numpy as np

from thermogear.base.display import (
    CELSIUS,
    GRAVITY,
    MICROMETRE,
    MILLIMETRE,
    MINUTE,
    PERCENT,
    SPEED,
)
from thermogear.base.errors import printable

LEVELS = ("important", "warning", "info")
"""From what must be known to what is good to know."""
SENTENCE = "sentence"
"""Code of a notice that is known by its sentence alone: of results of older versions."""
_UNITS = {
    shown.unit: shown
    for shown in (CELSIUS, GRAVITY, MICROMETRE, MILLIMETRE, MINUTE, PERCENT, SPEED)
}
_CLAUSE = re.compile(r"\[([^\[\]]*)\]")
_LISTED = 8
"""Entries of a list that a sentence shows; its data have all."""


@dataclass(frozen=True)
class Entry:
    """A code of the catalogue: its ``level``, ``sentence`` and what ``to_do``."""

    level: str
    sentence: str
    to_do: str

    @property
    def fields(self) -> frozenset[str]:
        """Names of the data that the sentence holds."""
        parts = Formatter().parse(self.sentence)
        return frozenset(name.partition("|")[0] for _, name, _, _ in parts if name)


@cache
def catalogue() -> Mapping[str, Entry]:
    """Every code with its entry, as the files ``notices/*.toml`` have them, each code in one."""
    files = resources.files(__package__).joinpath("notices").iterdir()
    texts = [file.read_text(encoding="utf-8") for file in files if file.name.endswith(".toml")]
    entries = {code: entry for text in texts for code, entry in tomllib.loads(text).items()}
    return {code: Entry(**entries[code]) for code in sorted(entries)}


class _Sentence(Formatter):
    """Fields as ``{speed:.0f rpm}``: SI data in the unit named; a list is parted by commas, of a
    long one the first are shown. A list [least, greatest] in a list is a range, as "60 to 80". A
    clause in ``[brackets]`` of which a field is None is left out.

    ``{count|point has|points have}`` chooses words by a number (or the length of a list): the first
    where it is one or true, else the second.
    """

    def get_value(self, key: int | str, args: Any, kwargs: Mapping[str, Any]) -> Any:
        name, *words = str(key).split("|")
        value = kwargs[name]
        count = len(value) if isinstance(value, list) else value
        return words[count != 1] if words else value

    def format_field(self, value: Any, format_spec: str) -> str:
        form, _, unit = format_spec.partition(" ")
        values = value if isinstance(value, list) else [value]
        shown = [_shown(each, form, unit) for each in values[:_LISTED]]
        return f"{', '.join(shown + ['...'] * (len(values) > _LISTED))} {unit}".rstrip()

    def vformat(self, text: str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> str:
        def clause(found: re.Match[str]) -> str:
            names = Entry("", found[1], "").fields
            return "" if any(kwargs[name] is None for name in names) else found[1]

        return super().vformat(_CLAUSE.sub(clause, text), args, kwargs)


def _shown(value: Any, form: str, unit: str) -> str:
    """A datum in its unit; of a list its ends."""
    if value is None:
        return "no number"
    if isinstance(value, list):
        return " to ".join(dict.fromkeys(_shown(end, form, unit) for end in value))
    return format(float(_UNITS[unit](value)) if unit in _UNITS else value, form)


@dataclass(frozen=True)
class Notice:
    """``level`` one of :data:`LEVELS`, one line of ``text``; of :meth:`of`, ``code`` and ``data``.

    Without a code it is a :data:`SENTENCE`, as results of older versions have it.
    """

    level: str
    text: str
    code: str = SENTENCE
    data: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "text", printable(self.text))

    @classmethod
    def of(cls, code: str, /, *, about: str = "", **data: Any) -> Notice:
        """The notice ``code`` of the catalogue with its ``data``, in SI units.

        ``about``: the name of what it is about where there are several, as a bundle or a state; it
        begins the text, and is in the data.

        Raises KeyError for a code that there is not, TypeError where the data are not the fields
        of its sentence.
        """
        entry = catalogue()[code]
        if data.keys() != entry.fields:
            wrong = ", ".join(sorted(data.keys() ^ entry.fields))
            raise TypeError(f"notice {code}: missing or unknown data: {wrong}")
        plain = {name: _plain(value) for name, value in data.items()}
        text = _Sentence().vformat(entry.sentence, (), plain)
        if about:
            plain["about"], text = about, f"{about}: {text}"
        return cls(entry.level, text, code, plain)

    def of_files(self, files: Sequence[str]) -> Notice:
        """The same of the ``files`` named, which come first in the text."""
        named = _plain(list(files))
        text = f"{_Sentence().format_field(named, '')}: {self.text}"
        return replace(self, text=text, data={**self.data, "in_files": named})

    @classmethod
    def stored(cls, told: Notice | str | Mapping[str, Any]) -> Notice:
        """A notice as a result holds it, its text as it was written.

        Older versions stored a level with a text, or a bare text, which is an "info".
        """
        if isinstance(told, Notice):
            return told
        about = {"text": told} if isinstance(told, str) else told
        level, data = str(about.get("level")), about.get("data")
        return cls(
            level if level in LEVELS else "info",
            str(about.get("text", "")),
            str(about.get("code", SENTENCE)),
            data if isinstance(data, dict) else {},
        )

    def __iter__(self) -> Iterator[str]:
        """Level and text, so that a pair of names takes them."""
        return iter((self.level, self.text))

    def as_dict(self) -> dict[str, Any]:
        """Code, level, data and text, as JSON has them."""
        return {"code": self.code, "level": self.level, "data": self.data, "text": self.text}


def stored_notices(notices: Iterable[Notice]) -> str:
    """Notices as the JSON text that a store holds."""
    return json.dumps([notice.as_dict() for notice in notices])


def _plain(value: Any) -> Any:
    """A value as JSON has it: Python's numbers, printable texts, lists, None for no number."""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
