"""The dimensionless case as pydantic models, and how the motion of either kind is followed."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, model_validator

from thermogear.base.errors import InputError
from thermogear.base.parameters import NUMBERS
from thermogear.case.fields import Choice, Count, Number, NumberOrTemperature, Several, Words
from thermogear.case.table import Table


class SimulationTable(Table):
    """How long and how finely the motion is followed."""

    periods: Annotated[int, Count(low=8, high=1_000_000, example="256")] = Field(
        default=256, description="mesh periods kept for section and spectrum"
    )
    discard: Annotated[int, Count(low=0, high=10_000_000, example="400")] = Field(
        default=400, description="mesh periods thrown away first, at least"
    )
    most_discarded: Annotated[int, Count(low=0, high=10_000_000, example="4000")] = Field(
        default=4000, description="mesh periods thrown away at most while a transient dies out"
    )
    steps_per_period: Annotated[int, Count(low=16, high=65536, example="512")] = Field(
        default=512, description="Runge-Kutta steps per mesh period"
    )
    samples: Annotated[int, Count(low=8, high=4096, example="128")] = Field(
        default=128, description="stored samples per mesh period"
    )
    sample_periods: Annotated[int, Count(low=1, high=10_000, example="8")] = Field(
        default=8, description="mesh periods of stored time history"
    )
    initial_state: Annotated[
        tuple[float, ...], Several(Number(low=-1e6, high=1e6, example="0.0"), least=2, most=2)
    ] = Field(default=(0.0, 0.0), description="start in the middle of the gap, at rest")

    @model_validator(mode="after")
    def _ordered(self) -> SimulationTable:
        if self.most_discarded < self.discard:
            raise InputError(
                "most_discarded",
                self.most_discarded,
                allowed=f">= discard = {self.discard}",
                fix=f"use {self.discard} or more",
            )
        if self.sample_periods > self.periods:
            raise InputError(
                "sample_periods",
                self.sample_periods,
                allowed=f"1..periods = {self.periods}",
                fix=f"use {self.periods} or less",
            )
        return self


_Plain = Annotated[tuple[float, ...], Several(Number(low=-1e6, high=1e6))]
_Positive = Annotated[tuple[float, ...], Several(Number(low=1e-9, high=1e6))]
_NotNegative = Annotated[tuple[float, ...], Several(Number(low=0.0, high=1e3, example="0.15"))]
_Amplitude = Annotated[
    tuple[float, ...],
    Several(
        Number(
            low=0.0,
            high=0.999,
            example="0.335",
            why="the mesh stiffness 1 + eps cos would reach zero",
        )
    ),
]
_Stiffening = Annotated[tuple[float, ...], Several(Number(low=-0.999, high=1e3, example="0.02"))]


class BaseTable(Table):
    """The base set that every row starts from."""

    damping_ratio: _NotNegative
    frequency: _Positive
    stiffness_amplitude: _Amplitude
    mean_force: _Plain
    force_amplitude: _Plain
    half_backlash: _Positive = Field(
        default=(1.0,), description="the cold half backlash is the unit"
    )
    thermal_stiffness: _Stiffening = Field(default=(0.0,), description="no thermal term")


class RowTable(Table):
    """A row: one parameter runs through its values; others may be set, one for all or a list."""

    parameter: Annotated[str, Choice(*NUMBERS, "temperature")]
    values: Annotated[tuple[tuple[float, str], ...], Several(NumberOrTemperature())]
    expected: Annotated[tuple[str, ...], Several(Words('"period-1"'), least=0)] = Field(
        default=(), description="no label is expected"
    )
    damping_ratio: _NotNegative | None = None
    frequency: _Positive | None = None
    stiffness_amplitude: _Amplitude | None = None
    mean_force: _Plain | None = None
    force_amplitude: _Plain | None = None
    half_backlash: _Positive | None = None
    thermal_stiffness: _Stiffening | None = None


class DimensionlessFile(Table):
    """The dimensionless equation of motion alone, in rows of one parameter each."""

    title: Annotated[str, Words('"table 4.2"')]
    kind: Annotated[str, Choice("dimensionless", "gear")]
    base: BaseTable
    rows: Annotated[dict[str, RowTable], Field(min_length=1)]
    simulation: SimulationTable = SimulationTable()
    ours: dict[str, Any] = Field(default={}, description="no value is declared as ours")
