"""The table of the case file that says what is broken, worn or out of place on one gear."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field, model_validator

from thermogear.base import bounds
from thermogear.base.errors import InputError
from thermogear.case.fields import Choice, Count, Measure, Number, measure
from thermogear.case.table import Table
from thermogear.gears.tooth_damage import DEEPEST

MOST_FAULTS = 64
"""Faults of one case, at most."""

KINDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "crack": ((), ("tooth", "depth", "share", "angle", "width_share")),
    "chip": (("height",), ("tooth",)),
    "missing": ((), ("tooth",)),
    "spall": (("length", "depth"), ("tooth", "diameter", "width_share")),
    "wear": ((), ("tooth", "depth", "coefficient", "revolutions")),
    "pitch": (("amount",), ("tooth",)),
    "eccentricity": (("amount",), ("angle",)),
}
"""Of each kind of fault the fields that it needs, and those that it may have."""
_OF_ALL = {"kind", "gear"}


class FaultTable(Table):
    """One fault of one gear; each ``kind`` has fields of its own."""

    kind: Annotated[str, Choice(*KINDS)]
    gear: Annotated[str, Choice("pinion", "wheel")]
    tooth: Annotated[int | None, Count(low=1, high=bounds.MOST_TEETH, example="1")] = Field(
        default=None, title="1; of wear: all teeth alike. Counted as in pitch_errors"
    )
    depth: Annotated[float | None, measure("length", bounds.DEPTH, example="2 mm")] = Field(
        default=None, title="of a crack along itself, of a spall, of wear where it is greatest"
    )
    share: Annotated[float | None, Number(low=0.0, high=DEEPEST, example="0.3")] = Field(
        default=None, title="of a crack: of the way across the tooth, in place of the depth"
    )
    angle: Annotated[float | None, Measure("angle", "-360 deg", "360 deg", example="45 deg")] = (
        Field(
            default=None,
            title="of a crack to the tooth's axis, 45 to 90 deg; 45 deg. Of an eccentricity: where "
            "it is farthest out, from tooth 1 towards tooth 2; 0 deg",
        )
    )
    width_share: Annotated[float | None, Number(low=0.0, high=1.0, example="0.4")] = Field(
        default=None, title="of the face width that a crack or a spall takes; 1"
    )
    height: Annotated[float | None, measure("length", bounds.DEPTH, example="1.5 mm")] = Field(
        default=None, title="of a chip: how far below the tip circle the tooth ends"
    )
    length: Annotated[float | None, measure("length", bounds.RELIEF_LENGTH, example="2 mm")] = (
        Field(default=None, title="of a spall, along the flank from root to tip")
    )
    diameter: Annotated[float | None, Measure("length", "0.1 mm", "20000 mm", example="70 mm")] = (
        Field(default=None, title="at the middle of a spall; the operating pitch circle")
    )
    amount: Annotated[
        float | None,
        measure("length", bounds.PITCH_ERROR, "of an eccentricity 0 um at least", example="15 um"),
    ] = Field(
        default=None,
        title="of pitch: along the line of action, > 0 towards the drive flank; of eccentricity: "
        "of the centre, half the run-out",
    )
    coefficient: Annotated[
        float | None, Measure("wear coefficient", "1e-19 m^2/N", "1e-14 m^2/N", "Archard's k")
    ] = Field(default=None, title="of wear: 1e-18 to 5e-16 m^2/N of steel (recalled)")
    revolutions: Annotated[float | None, Number(low=0.0, high=1e13, example="1e7")] = Field(
        default=None, title="of wear: turns of this gear under the greatest torque of the case"
    )

    @model_validator(mode="after")
    def _of_its_kind(self) -> FaultTable:
        needed, optional = KINDS[self.kind]
        given = self.model_fields_set - _OF_ALL
        known = (*needed, *optional)
        for name in sorted(given - set(known)):
            raise InputError(
                name,
                f'given beside kind = "{self.kind}"',
                allowed=", ".join(known),
                fix="leave it out",
            )
        pairs = {"crack": (("depth",), ("share",)), "wear": (("depth",), _WORN)}
        for name in needed:
            self._require(name)
        if self.kind in pairs:
            first, second = pairs[self.kind]
            if bool(given & set(first)) == bool(given & set(second)):
                ways = f"{first[0]}, or {' and '.join(second)}"
                got = "both" if given & set(first) else "no size"
                raise InputError("", got, allowed=ways, fix="write one of the two")
            for name in second if given & set(second) else ():
                self._require(name)
        if self.kind == "crack":
            bounds.CRACK_ANGLE.require("angle", self.slope)
        if self.kind == "eccentricity":
            bounds.ECCENTRICITY.require("amount", self.amount or 0.0)
        return self

    def _require(self, name: str) -> None:
        if getattr(self, name) is None:
            raise InputError(
                name, "nothing", why=f'needed with kind = "{self.kind}"', fix=f"write {name} = ..."
            )

    @property
    def acts(self) -> bool:
        """Whether none of its sizes is 0: a fault of no size is none."""
        return all(getattr(self, name) != 0.0 for name in _SIZES)

    @property
    def slope(self) -> float:
        """Angle [rad] of a crack to the tooth's axis."""
        return math.radians(45.0) if self.angle is None else self.angle

    @property
    def place(self) -> int:
        """Number of the tooth, from 0."""
        return (self.tooth or 1) - 1


_WORN = ("coefficient", "revolutions")
_SIZES = ("depth", "share", "width_share", "height", "length", "amount", *_WORN)
