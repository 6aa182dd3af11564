"""Tables of the case file that say how the flanks of a gear deviate from the involute."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from thermogear.base import bounds
from thermogear.case.fields import Choice, Count, Several, measure
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


class FlanksTable(Table):
    """How true the flanks are: an accuracy class, from which seeded deviations are drawn."""

    accuracy: Annotated[int | None, Count(low=0, high=12, example="6")] = Field(
        default=None,
        description="class 6 of ISO 1328-1 for metal (ground gears are made to 4 to 6), 9 for "
        "plastics. Decides the transmission error that excites the vibration",
    )
    edition: Annotated[str, Choice("2013", "1995")] = Field(default="2013", title="of ISO 1328-1")
    seed: Annotated[int, Count(low=0, high=2**31 - 1, example="1")] = Field(
        default=1,
        description="one drawing of the flanks of the class; another seed, other flanks "
        "of the same class",
    )
