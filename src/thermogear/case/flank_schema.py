"""Tables of the case file that say how the flanks of a gear deviate from the involute."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from thermogear.base import bounds
from thermogear.base.errors import InputError, short
from thermogear.case.fields import Choice, Count, Reader, Several, Words, measure
from thermogear.case.table import Table

Flank = Annotated[str, Choice("drive", "back", "both")]


class ReliefTable(Table):
    """Material taken off towards the tip or the root."""

    amount: Annotated[float, measure("length", bounds.RELIEF_AMOUNT, example="20 um")]
    length: Annotated[
        float,
        measure("length", bounds.RELIEF_LENGTH, "measured along the line of action", "3 mm"),
    ]
    shape: Annotated[str, Choice("linear", "parabolic")] = Field(
        default="linear", description="linear relief"
    )
    flank: Flank = Field(default="both", description="drive and back flanks alike")


class ProfileTable(Table):
    """Added material over the radius: wear (negative), a measured profile."""

    radius: Annotated[
        tuple[float, ...],
        Several(
            measure("length", bounds.PROFILE_RADIUS, example="62 mm"),
            least=2,
            most=5000,
            single=False,
        ),
    ]
    added: Annotated[
        tuple[float, ...],
        Several(measure("length", bounds.ADDED, example="-3 um"), least=2, most=5000, single=False),
    ]
    flank: Flank = Field(default="both", description="drive and back flanks alike")


Charts = Annotated[
    tuple[str, ...] | None, Several(Words('"pinion.csv"'), least=1, most=2, distinct=True)
]


class Content(Reader):
    """The text of a file that a case names, line breaks and all."""

    example = "'''...'''"

    def read(self, raw: object) -> str:
        if not isinstance(raw, str):
            raise InputError("", short(raw), allowed="a text", fix="leave [files] out")
        return raw

    def schema(self) -> dict[str, Any]:
        return {"type": "string"}


class EnclosedTable(Table):
    """A file that the case names, in the case itself: results keep it so."""

    text: Annotated[str, Content()]


class FlanksTable(Table):
    """How true the flanks are: measured, or an accuracy class that seeded deviations keep."""

    pinion: Charts = Field(
        default=None, title="CSV of the pinion's inspection chart, beside the case file; none"
    )
    wheel: Charts = Field(default=None, title="the same of the wheel; none")

    accuracy: Annotated[int | None, Count(low=0, high=12, example="6")] = Field(
        default=None,
        description="class 6 of ISO 1328-1 for metal (ground gears are made to 4 to 6), 9 for "
        "plastics. Decides the transmission error that excites the vibration",
    )
    edition: Annotated[str, Choice("2013", "1995")] = Field(default="2013", title="of ISO 1328-1")
    seed: Annotated[int, Count(low=0, high=2**31 - 1, example="1")] = Field(
        default=1,
        description="one drawing of the flanks of the class; another seed decides for other flanks "
        "of the same class",
    )
