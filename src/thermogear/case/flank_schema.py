"""Tables of the case file that say how the flanks of a gear deviate from the involute."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from thermogear.base import bounds
from thermogear.case.fields import Choice, Several, measure
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
