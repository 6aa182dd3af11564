"""A case that is computed again with some of its fields changed by factors."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from thermogear.base.errors import InputError
from thermogear.base.toml import entries_of, held, literal, overridden, pairs
from thermogear.base.units import RPM
from thermogear.case.allowed import gear_parameter
from thermogear.case.base import Case
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.mesh.series import WHOLE_TURN
from thermogear.results.result import Notice

AMPLITUDE = "transmission_error.amplitude"
"""What is no field of the case: the amplitudes of all harmonics."""
DRAWINGS = 8
"""Drawings of flanks of a class, seeds 1 to 8, that say how far another pair of gears may be."""
PARTS = 16
"""Parts of a series that are followed at the measured speeds, about half a second each (chosen)."""


@dataclass(frozen=True)
class CaseRuns:
    """A case that is run again with some of its fields changed."""

    text: str
    kept: Mapping[str, str]

    @classmethod
    def of(cls, case: Case | str | Path) -> CaseRuns:
        """The case, or that of a file or a text, as it is stated."""
        given = load_case(case) if isinstance(case, str | Path) else case
        return cls(given.text, dict(given.overrides))

    def case(self, changes: Mapping[str, str]) -> GearCase:
        """The case with these overrides."""
        return gear_case(load_case(self.text, {**self.kept, **changes}))

    def at_speeds(self, speeds: Sequence[float]) -> CaseRuns:
        """The case at these speeds of the pinion [rad/s], each once, in place of its own."""
        told = dict.fromkeys(f"{speed / RPM!r} rpm" for speed in map(float, speeds))
        return replace(self, kept={**self.kept, "operating.speed": literal(list(told))})

    def changes(self, factors: Mapping[str, float]) -> dict[str, str]:
        """The overrides that multiply every named field by its factor."""
        changes: dict[str, str] = {}
        for name, factor in factors.items():
            changes |= overrides_of(self.text, self.kept, name, factor)
        return changes

    def sampled(
        self, tolerances: Mapping[str, float], *, count: int, seed: int
    ) -> Iterator[dict[str, str]]:
        """Overrides of ``count`` cases within relative standard ``tolerances`` of fields."""
        rng = np.random.default_rng(seed)
        for _ in range(max(2, count) if tolerances else 0):
            yield self.changes(
                {
                    name: float(1.0 + sigma * rng.standard_normal())
                    for name, sigma in tolerances.items()
                }
            )

    def drawings(self) -> list[dict[str, str]]:
        """The overrides of drawings of the flanks; none where no class draws them.

        Of a series its first :data:`PARTS` parts, each over its turn; of a turn of more than
        :data:`~thermogear.mesh.series.WHOLE_TURN` mesh periods by its mean tooth, whose mesh lines
        were 5 to 10 % below those of the turn (the median of 16 parts, three pairs of class 6).
        Else :data:`DRAWINGS` seeds.
        """
        case = self.case({})
        if case.series == 1:
            count = 0 if case.accuracy is None else DRAWINGS
            return [{"flanks.seed": str(number + 1)} for number in range(count)]
        part = {"flanks.parts": "1", "flanks.teeth": "drawn"}
        if math.lcm(case.pair.pinion.teeth, case.pair.wheel.teeth) > WHOLE_TURN:
            part["gears.period"] = "mesh"
        return [{**part, "flanks.drawing": str(number)} for number in range(PARTS)]

    def told(self, tolerances: Mapping[str, float], drawings: int) -> Iterator[Notice]:
        """What u_input holds of the case, so many ``drawings`` among it, and what it lacks."""
        if drawings:
            accuracy = self.case({}).accuracy
            yield Notice.of("u_input_of_drawings", drawings=drawings, accuracy=accuracy)
        if not tolerances:
            yield Notice.of("tolerances_not_stated")


def _stated(data: Mapping[str, Any], name: str) -> str:
    """A field as the case states it, as text."""
    depth, value = held(data, name)
    if depth < len(name.split(".")):
        raise InputError(
            "tolerances",
            repr(name),
            why="the case states no such field",
            fix=f"state {name} in the case, or leave its tolerance out",
        )
    if not isinstance(value, (str, int, float)) or isinstance(value, bool):
        raise InputError(
            "tolerances",
            repr(name),
            why="it is no single number with a unit",
            fix="name a field with one number, as operating.torque",
        )
    return str(value)


def scaled(value: str, factor: float) -> str:
    """A number with its unit times a factor: "100 N m" by 1.1 is "110 N m"."""
    found = re.match(r"^\s*([-+]?\d*\.?\d+(?:[eE][-+]?\d+)?)\s*(.*)$", value)
    if not found:
        raise InputError("tolerances", repr(value), why="it is no number with a unit")
    number = float(found.group(1)) * factor
    return f"{number!r} {found.group(2)}".strip()


def overrides_of(text: str, changes: Mapping[str, str], name: str, factor: float) -> dict[str, str]:
    """The overrides that multiply a parameter by a factor, in every field it stands for.

    ``name``: a gear parameter by any of its names, or a dotted field;
    "transmission_error.amplitude" means the amplitudes of all its harmonics.
    """
    data = overridden(tomllib.loads(text), pairs(changes))
    if name == AMPLITUDE and not data.get("transmission_error", {}).get("harmonics"):
        raise InputError("parameters", repr(name), why="the case states no transmission error")
    meant = "transmission_error.harmonics.all.amplitude" if name == AMPLITUDE else name
    places = [
        place
        for field in gear_parameter(meant, "tolerances").fields
        for place in entries_of(data, field)
    ]
    return {place: scaled(_stated(data, place), factor) for place in places}
