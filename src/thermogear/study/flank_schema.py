"""Tables of the case file that say how the flanks of a gear deviate from the involute."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from thermogear.study.fields import Choice, Measure, Several
from thermogear.study.table import Table

Flank = Annotated[str, Choice("drive", "back", "both")]


class ReliefTable(Table):
    """Material taken off towards the tip or the root."""

    amount: Annotated[float, Measure("length", "0 um", "1000 um", example="20 um")]
    length: Annotated[
        float,
        Measure(
            "length",
            "0.01 mm",
            "1000 mm",
            "measured along the line of action",
            example="3 mm",
        ),
    ]
    shape: Annotated[str, Choice("linear", "parabolic")] = Field(
        default="linear", description="linear relief"
    )
    flank: Flank = Field(default="both", description="drive and back flanks alike")


class ProfileTable(Table):
    """Added material over the radius: wear (negative), a measured profile."""

    radius: Annotated[
        tuple[float, ...],
        Several(Measure("length", "0.1 mm", "10000 mm", example="62 mm"), 2, 5000, single=False),
    ]
    added: Annotated[
        tuple[float, ...],
        Several(Measure("length", "-2 mm", "2 mm", example="-3 um"), 2, 5000, single=False),
    ]
    flank: Flank = Field(default="both", description="drive and back flanks alike")
