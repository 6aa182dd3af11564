"""Tables of the case file that say the backlash: a value, or the tolerances it follows from."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from thermogear.base.errors import InputError
from thermogear.case.fields import Choice, Measure, Several
from thermogear.case.table import Body, Table, not_both

Allowance = Annotated[
    tuple[float, ...],
    Several(Measure("length", "-10 mm", "10 mm", example="-0.08 mm"), least=1, most=2),
]


class TolerancesTable(Table):
    """Backlash out of the drawing: tooth-thickness allowances and centre-distance tolerance."""

    pinion_tooth_thickness: Allowance
    wheel_tooth_thickness: Allowance
    centre_distance: Allowance


class BacklashTable(Table):
    """The backlash, with its kind named: a value, or the tolerances it follows from."""

    value: Annotated[
        float | None,
        Measure(
            "length",
            "1e-5 mm",
            "50 mm",
            "a pair without backlash jams as soon as it warms up",
            example="0.25 mm",
        ),
    ] = Field(
        default=None,
        description="the least normal backlash that ISO/TR 10064-2 recommends, 2/3 (0.06 mm + "
        "0.0005 a + 0.03 m). The unit of length of the vibration; decides when the pair jams",
    )
    direction: Annotated[str | None, Choice("normal", "circumferential")] = None
    extent: Annotated[str | None, Choice("total", "half")] = None
    temperature: Body | None = Field(
        default=None,
        description="holds at temperatures.reference. Decides how much growth it has seen",
    )
    tolerances: TolerancesTable | None = None

    @model_validator(mode="after")
    def _complete(self) -> BacklashTable:
        not_both(self, "value", "tolerances")
        kinds = {"direction": '"normal" or "circumferential"', "extent": '"total" or "half"'}
        for name, allowed in kinds.items():
            given = getattr(self, name) is not None
            if self.value is not None and not given:
                raise InputError(
                    name,
                    "nothing",
                    allowed=allowed,
                    why="a backlash means nothing without its kind",
                    fix=f"write {name} = {allowed.split(' or ')[0]}",
                )
            if self.value is None and given:
                raise InputError(name, "a kind", why="tolerances need none", fix="leave it out")
        return self
