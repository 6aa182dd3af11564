"""What is found on the way from a stage to a case."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from thermogear.base.errors import InputError
from thermogear.case.rexs.attributes import Read
from thermogear.case.rexs.gearbox import Stage
from thermogear.case.rexs.lines import READ, Line
from thermogear.case.rexs.model import Component
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import tight_distance


@dataclass(frozen=True, kw_only=True)
class Operating:
    """One load of the pinion: ``speed`` [rpm], ``torque`` [N m], both positive."""

    name: str
    speed: float
    torque: float
    duration: float | None = None
    share: float | None = None


@dataclass
class Draft:
    """What is found on the way to a case: lines, loads, and what could not be used.

    ``train``: the sections of shafts and the bearings that lines came from; ``seats``: the sections
    that gave bores.
    """

    stage: Stage
    pinion: Component
    wheel: Component
    lines: list[Line] = field(default_factory=list)
    loads: list[Operating] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)
    train: list[Component] = field(default_factory=list)
    seats: list[Component] = field(default_factory=list)

    def put(self, path: str, value: object, origin: str, note: str = "") -> None:
        """One more line."""
        self.lines.append(Line(path, value, origin, note))

    def read(self, path: str, found: Read, source: str) -> None:
        """One more line as the file has it."""
        value = found.number if not found.unit else found.text
        self.lines.append(Line(path, value, READ, source))

    @property
    def both(self) -> tuple[tuple[str, Component], ...]:
        """Pinion and wheel with their names in a case."""
        return (("pinion", self.pinion), ("wheel", self.wheel))


def tightest(made: Draft, *, module: float, angle: float) -> float:
    """Centre distance [m] without backlash by the lines found so far; nan where it has none."""
    values = {one.path: one.value for one in made.lines}
    teeth = [values[f"gears.{name}.teeth"] for name, _ in made.both]
    shift = sum(float(values.get(f"gears.{name}.profile_shift", 0.0)) for name, _ in made.both)
    try:
        pinion, wheel = (Gear(z, module, pressure_angle=angle) for z in teeth)
        return tight_distance(pinion, wheel, shift)
    except InputError:
        return math.nan
