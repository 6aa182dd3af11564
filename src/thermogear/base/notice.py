"""What a reader should know beside the numbers: a code with data, its sentence from a catalogue.

The catalogue is the folder ``notices`` beside this module: of each code the level, the sentence
with the fields of the data in braces, and what the reader can do. A sentence is made here and
nowhere else.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from string import Formatter
from typing import Any

import numpy as np

from thermogear.base.display import CELSIUS, MICROMETRE, MINUTE, PERCENT, SPEED
from thermogear.base.errors import printable

LEVELS = ("important", "warning", "info")
"""From what must be known to what is good to know."""
SENTENCE = "sentence"
"""Code of a notice that is known by its sentence alone: of results of older versions."""
_UNITS = {shown.unit: shown for shown in (CELSIUS, MICROMETRE, MINUTE, PERCENT, SPEED)}


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
    """Every code with its entry, as the files ``notices/*.toml`` have them.

    Raises ValueError for a code that two files have.
    """
    entries: dict[str, Entry] = {}
    for file in resources.files(__package__).joinpath("notices").iterdir():
        if file.name.endswith(".toml"):
            read = tomllib.loads(file.read_text(encoding="utf-8"))
            if twice := entries.keys() & read.keys():
                raise ValueError(f"{file.name}: codes of another file: {', '.join(twice)}")
            entries |= {code: Entry(**entry) for code, entry in read.items()}
    return dict(sorted(entries.items()))


class _Sentence(Formatter):
    """Fields as ``{speed:.0f rpm}``: SI data in the unit named; a list is parted by commas.

    ``{count|point has|points have}`` chooses words by a number (or the length of a list): the first
    where it is one or true, else the second.
    """

    def get_value(self, key: int | str, args: Any, kwargs: Mapping[str, Any]) -> Any:
        name, *words = str(key).split("|")
        value = kwargs[name]
        if not words:
            return value
        return words[(len(value) if isinstance(value, list) else value) != 1]

    def format_field(self, value: Any, format_spec: str) -> str:
        form, _, unit = format_spec.partition(" ")
        if isinstance(value, list):
            return ", ".join(self.format_field(each, form) for each in value) + f" {unit}".rstrip()
        if unit in _UNITS:
            return f"{float(_UNITS[unit](value)):{form}} {unit}"
        return f"{value:{form}} {unit}".rstrip()


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
    def of(cls, code: str, /, **data: Any) -> Notice:
        """The notice ``code`` of the catalogue with its ``data``, in SI units.

        Raises KeyError for a code that there is not, TypeError where the data are not the fields
        of its sentence.
        """
        entry = catalogue()[code]
        if data.keys() != entry.fields:
            wrong = ", ".join(sorted(data.keys() ^ entry.fields))
            raise TypeError(f"notice {code}: missing or unknown data: {wrong}")
        plain = {name: _plain(value) for name, value in data.items()}
        return cls(entry.level, _Sentence().vformat(entry.sentence, (), plain), code, plain)

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


def _plain(value: Any) -> Any:
    """A value as JSON has it: Python's numbers, printable texts, lists, None for no number."""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
