"""Tables of the case file that say how the flanks of a gear deviate from the involute."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from thermogear.base import bounds
from thermogear.base.errors import InputError, short
from thermogear.case.fields import Choice, Count, Measure, Number, Reader, Several, Words, measure
from thermogear.case.table import Table, one_of
from thermogear.gears.population import Population

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


Turned = Measure("angle", "-360 deg", "360 deg", example="90 deg")


class EccentricityTable(Table):
    """Teeth about another centre than the bore: the amount, or the radial run-out of twice that."""

    amount: Annotated[float | None, measure("length", bounds.ECCENTRICITY, example="10 um")] = (
        Field(default=None, title="half the run-out")
    )
    run_out: Annotated[float | None, Measure("length", "0 um", "2000 um", example="20 um")] = Field(
        default=None, title="F_r of ISO 1328-2, about the bore: twice the amount"
    )
    angle: Annotated[float, Turned] = Field(
        default=0.0,
        description="tooth 1 is farthest out. From its axis towards tooth 2; decides what the "
        "eccentricities of both gears, and the errors of single teeth, add up to",
    )

    @model_validator(mode="after")
    def _once(self) -> EccentricityTable:
        one_of(self, "amount", "run_out")
        return self


Slope = measure("length", bounds.ADDED, "f_Halpha, > 0 outside at the tip", "3 um")
Form = measure("length", bounds.RELIEF_AMOUNT, "f_falpha, peak to peak of a wave", "2 um")
Waves = Annotated[float, Number(low=1.0, high=20.0, example="2.5")]


class ToothProfilesTable(Table):
    """Slope and form of every tooth: one value for each, or one for all; several tables add up."""

    slope: Annotated[tuple[float, ...] | None, Several(Slope, most=bounds.MOST_TEETH)] = Field(
        default=None, title="none"
    )
    form: Annotated[tuple[float, ...] | None, Several(Form, most=bounds.MOST_TEETH)] = Field(
        default=None, title="none"
    )
    phase: Annotated[tuple[float, ...] | None, Several(Turned, most=bounds.MOST_TEETH)] = Field(
        default=None, title="of the wave at the start of the active profile; 0"
    )
    waves: Waves = Field(default=2.5, title="waves of the form over the active profile; 2.5")
    flank: Flank = Field(default="both", description="drive and back flanks alike")


class ToothTable(ToothProfilesTable):
    """One tooth that differs: what it has besides all that the gear's other fields say."""

    tooth: Annotated[int, Count(low=1, high=bounds.MOST_TEETH, example="7")]
    index: Annotated[
        float,
        measure(
            "length",
            bounds.PITCH_ERROR,
            "along the line of action, > 0 towards the drive flank",
            "8 um",
        ),
    ] = Field(default=0.0, title="none: the whole tooth stays where it is")


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


_DRAWN = Population()
_Share = Annotated[float, Number(low=0.0, high=5.0, example="0.25")]


class PopulationTable(Table):
    """How the gears of a class differ, as shares of its tolerances: assumed, no public numbers."""

    eccentricity: _Share = Field(
        default=_DRAWN.eccentricity, description="mean of 2 e/cos(alpha) over F_pT, e Rayleigh"
    )
    index: _Share = Field(
        default=_DRAWN.index, description="standard deviation of each tooth's index over f_pT"
    )
    orders: Annotated[
        tuple[int, ...], Several(Count(low=1, high=20, example="2"), least=0, most=20)
    ] = Field(default=_DRAWN.orders, description="waves of the index around the gear")
    order: _Share = Field(
        default=_DRAWN.order, description="mean amplitude of a wave of order q over f_pT/q"
    )
    slope: _Share = Field(
        default=_DRAWN.slope, description="standard deviation of all teeth's slope over f_HalphaT"
    )
    slope_scatter: _Share = Field(
        default=_DRAWN.slope_scatter, description="the same of each tooth's own"
    )
    barrel: Annotated[
        tuple[float, ...],
        Several(Number(low=0.0, high=5.0, example="0.25"), least=2, most=2, single=False),
    ] = Field(
        default=_DRAWN.barrel,
        description="mean and standard deviation of its height over f_falphaT",
    )
    wave: _Share = Field(
        default=_DRAWN.wave, description="mean amplitude of the form's wave over f_falphaT"
    )
    waves: Annotated[
        tuple[float, ...],
        Several(Number(low=0.0, high=20.0, example="2.0"), least=2, most=2, single=False),
    ] = Field(default=_DRAWN.waves, description="from least to most over the active profile")
    form_scatter: _Share = Field(
        default=_DRAWN.form_scatter, description="scatter of barrel and wave from tooth to tooth"
    )
    phase_scatter: Annotated[float, Measure("angle", "0 deg", "360 deg", example="43 deg")] = Field(
        default=_DRAWN.phase_scatter, description="the same of the wave's phase"
    )
    least: Annotated[float, Number(low=0.0, high=1.0, example="0.7")] = Field(
        default=_DRAWN.least,
        description="the worst deviation of a gear is from this share of its tolerance to 1: "
        "below 1/sqrt(2) it would be of a better class",
    )


LEAST_PARTS, PARTS = 16, 64
"""Parts of a series: at least, and where none are stated. The greatest of 64 bounds 95 % of all
parts with a confidence of 96 %."""


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
    teeth: Annotated[str, Choice("alike", "drawn", "measured")] = Field(
        default="alike",
        title="alike. drawn: whole gears of the class, eccentric, each tooth its own; measured: "
        "each tooth as its chart has it",
    )
    drawing: Annotated[int, Count(low=0, high=10**6, example="0")] = Field(
        default=0, title="which of the drawings of one seed, with teeth = drawn; 0"
    )
    seed: Annotated[int, Count(low=0, high=2**31 - 1, example="1")] = Field(
        default=1,
        description="of the drawing of the class that all studies but the answers take, and of the "
        "series; another seed decides for other flanks of the same class",
    )
    parts: Annotated[int | None, Count(low=1, high=1024, example="64")] = Field(
        default=None,
        description="pairs of the class that the answers are of: the greatest of 64 bounds 95 % of "
        "all with 96 % confidence; a stated seed, or measured flanks, are one. Decides the band",
    )
    population: PopulationTable | None = Field(
        default=None,
        description="how gears of a class differ is assumed: no public numbers say how much of "
        "their tolerances real gears use. Decides the band of the answers",
    )

    @model_validator(mode="after")
    def _enough(self) -> FlanksTable:
        if self.parts is not None and 1 < self.parts < LEAST_PARTS:
            raise InputError(
                "parts",
                self.parts,
                allowed=f"1, or {LEAST_PARTS}..1024",
                why="fewer say little of a series",
            )
        return self
