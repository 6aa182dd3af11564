"""What the page may say to the server: each message checked whole before anything is done."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, model_validator

from thermogear.base.errors import InputError, short
from thermogear.front.lines import one_line

PARTS = ("mesh", "orbit", "gap", "gears", "series", "run-up", "answers")
"""The parts of the page, in the order in which they are made."""
Post = Callable[[str, dict[str, object]], None]
"""Tells a page a message, under the name by which a newer one takes the place of one unsent."""
MOST_BYTES = 2**20
"""Of one message."""
MOST_SPEEDS = 2000

_PATH = Annotated[str, Field(max_length=120)]
_TEXT = Annotated[str, Field(max_length=100_000)]
_Change = tuple[_PATH, _TEXT]
_Number = Annotated[int, Field(ge=0, le=2**53)]
_Finite = Annotated[float, Field(allow_inf_nan=False)]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class State(_Message):
    """What is set: ``changes`` of fields, then ``dials``; None of ``heat``: as the case has it."""

    changes: Annotated[tuple[_Change, ...], Field(max_length=400)] = ()
    dials: Annotated[dict[Annotated[str, Field(max_length=40)], _Finite], Field(max_length=20)] = {}
    heat: bool | None = None


class Speeds(_Message):
    """A run-up from ``low`` to ``high`` [rpm] in ``count`` steps."""

    low: Annotated[float, Field(ge=0.1, le=500_000.0)] = 200.0
    high: Annotated[float, Field(ge=0.1, le=500_000.0)] = 12_000.0
    count: Annotated[int, Field(ge=2, le=MOST_SPEEDS)] = 300

    @model_validator(mode="after")
    def _upwards(self) -> Speeds:
        if self.low >= self.high:
            raise ValueError("the first speed must be below the last")
        return self


class Show(_Message):
    """Show ``parts`` of a state; every message takes the place of the one before."""

    kind: Literal["show"]
    number: _Number
    state: State = State()
    speeds: Speeds = Speeds()
    parts: Annotated[tuple[Literal[PARTS], ...], Field(max_length=len(PARTS))] = PARTS  # type: ignore[valid-type]


class Export(_Message):
    """A state as a case file, a command, or the page that ``thermogear run`` writes."""

    kind: Literal["export"]
    number: _Number
    what: Literal["case", "command", "report"]
    state: State = State()


class Stop(_Message):
    """Leave what is being made as it is."""

    kind: Literal["stop"]
    number: _Number


Message: TypeAlias = Show | Export | Stop
_READER: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="kind")])


def read(text: str) -> Message:
    """The message in ``text``; InputError, in one line, where it is none."""
    try:
        return _READER.validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        place = one_line(".".join(str(one)[:40] for one in first["loc"]))[:120] or "message"
        got = one_line(short(first.get("input")))
        why = one_line(first["msg"])[:120]
        raise InputError(place, got, why=why, fix="load the page anew") from None
