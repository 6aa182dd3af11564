"""Whether lines of two records are one line: by speed, by teeth, by frequency; never by name alone.

The mesh line of a record is the one that shows best, of another stage perhaps than in the next.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermogear.measured.gearing import NEAR
from thermogear.measured.record import Notice
from thermogear.measured.reduction import Measurement
from thermogear.measured.shaft import given_shaft

ALIKE = 0.02
"""Relative distance of two frequencies up to which a drift of speed explains it."""


@dataclass(frozen=True, kw_only=True)
class Turns:
    """What a record tells of its speed: the ``mesh`` line [cycles/sample], the ``rate`` [samples/s]
    (None: unknown or doubtful) and what it is ``said`` to be, teeth and speed [rad/s] ``given``,
    whether the line has the sidebands of these teeth (``confirmed``), the ``shaft``'s speed [rad/s]
    or nan; of a tacho its name and turns per sample."""

    mesh: float = float("nan")
    rate: float | None = None
    said: float | None = None
    given: tuple[int | None, float | None] = (None, None)
    confirmed: bool = False
    shaft: float = float("nan")
    tacho: tuple[str, float] | None = None

    @property
    def hertz(self) -> float:
        """Frequency of the mesh line [Hz]; nan: not known."""
        return self.mesh * (self.rate or float("nan"))

    def figures(self, prefix: str) -> dict[str, Any]:
        """Place of the mesh line [Hz], or [cycles/sample] where no rate is known, and the shaft's
        speed [rad/s], by names with the ``prefix``."""
        return {
            f"{prefix}frequency": self.hertz,
            f"{prefix}position": self.mesh if self.rate is None else None,
            f"{prefix}speed": self.shaft,
        }

    def scale(self, base: Turns) -> float:
        """How many times as high as ``base``'s a place of this record is, both in cycles/sample
        alike; nan where no rate tells."""
        if self.said == base.said:
            return 1.0
        return float("nan") if self.rate is None or base.rate is None else self.rate / base.rate

    def is_stated(self) -> bool:
        """Whether teeth and speed given put the mesh line where it is."""
        teeth, speed = self.given
        if teeth is None or speed is None:
            return False
        return abs(2.0 * np.pi * self.hertz / (teeth * speed) - 1.0) <= NEAR


def turns_of(found: Measurement) -> Turns:
    """What a measurement tells of the speed."""
    record, gearing = found.record, found.gearing
    sure = any(np.isfinite(line.frequency) for line in found.lines)
    return Turns(
        mesh=float("nan") if gearing is None else gearing.mesh_frequency,
        rate=record.rate if sure else None,
        said=record.rate,
        given=found.given,
        confirmed=gearing is not None and gearing.confirmed,
        shaft=next((line.shaft_speed for line in found.lines), float("nan")),
        tacho=_tacho(found),
    )


def _tacho(found: Measurement) -> tuple[str, float] | None:
    """Name of a tacho in the record and its mean turns, or pulses, per sample."""
    given = given_shaft(
        found.record, samples=found.samples, start=found.start, pulses_per_turn=None
    )
    if given is None or given.turns.size < 2:
        return None
    return given.origin, float((given.turns[-1] - given.turns[0]) / (given.turns.size - 1))


def speed_ratio(own: Turns, base: Turns) -> tuple[float, dict[str, Any] | None]:
    """How many times as fast a record turns as the baseline, and what tells that the mesh lines of
    the two are not one line, or may not be, empty where nothing does; then the ratio is nan.

    A tacho in both decides; else frequencies within 2 % of each other; else teeth and speed given
    that fit both lines; else the sidebands of the teeth given in both.

    >>> from dataclasses import replace
    >>> slow, fast = (
    ...     Turns(mesh=m, rate=1e3, said=1e3, given=(20, None), confirmed=True) for m in (0.1, 0.2)
    ... )
    >>> speed_ratio(fast, slow)
    (2.0, None)
    >>> speed_ratio(replace(fast, confirmed=False), slow)
    (nan, {})
    """
    scale = own.scale(base)
    tachos = own.tacho is not None and base.tacho is not None and own.tacho[0] == base.tacho[0]
    by_tacho = (
        own.tacho[1] / base.tacho[1] * scale
        if tachos and own.tacho is not None and base.tacho is not None
        else float("nan")
    )
    ratio = own.mesh / base.mesh * scale
    if np.isnan(own.mesh) or np.isnan(base.mesh):
        return (1.0 if np.isnan(by_tacho) else by_tacho), None
    if np.isnan(ratio):
        return ratio, {}
    if not np.isnan(by_tacho):
        if abs(ratio / by_tacho - 1.0) <= ALIKE:
            return by_tacho, None
        return float("nan"), {"by_tacho": by_tacho}
    by_teeth = own.confirmed and base.confirmed and own.given[0] == base.given[0]
    if abs(ratio - 1.0) <= ALIKE or by_teeth or (own.is_stated() and base.is_stated()):
        return ratio, None
    return float("nan"), {}


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a line of a record is: its ``kind``, ``position`` +- ``half_width`` [cycles/sample],
    and the record's ``turns``."""

    kind: str
    position: float
    half_width: float
    turns: Turns

    def is_at(self, base: Place, ratio: float) -> bool:
        """Whether a line ``ratio`` times as fast as the baseline's is at its place, within 2 % and
        the half widths; a line that no gear explains may have a fixed frequency instead.

        >>> turns = Turns(rate=1e3, said=1e3)
        >>> at = [Place(kind="mesh", position=p, half_width=0.0, turns=turns) for p in (0.1, 0.15)]
        >>> at[1].is_at(at[0], 1.5), at[1].is_at(at[0], 1.0)
        (True, False)
        """
        found = self.position / base.position * self.turns.scale(base.turns)
        wide = sum(one.half_width / one.position for one in (self, base))
        expected = [ratio, 1.0] if self.kind == base.kind == "line" else [ratio]
        return any(abs(found / one - 1.0) <= ALIKE + wide for one in expected)


Places = Mapping[tuple[str, str], Place]
"""Of each line, by channel and name."""


def places_of(found: Measurement) -> dict[tuple[str, str], Place]:
    """Where the lines of a measurement are."""
    turns = turns_of(found)
    return {
        (line.channel, line.name): Place(
            kind=line.kind,
            position=line.position,
            half_width=float(np.nan_to_num(line.position_half_width, posinf=0.0)),
            turns=turns,
        )
        for line in found.lines
    }


@dataclass(frozen=True, kw_only=True)
class Compared:
    """Of a record beside the baseline: which lines are the ``same``, how many times as fast it
    turns (``ratio``, nan: not known) and what tells that its mesh line is another (``why``),
    ``turns`` of it and of the ``base``, and the lines that ``moved`` though the mesh line is one.
    """

    same: tuple[bool, ...]
    ratio: float
    why: dict[str, Any] | None
    turns: Turns
    base: Turns
    moved: tuple[str, ...] = ()

    def told(self, record: str, baseline: str) -> Notice | None:
        """Which changes of the ``record`` are withheld, and why; None where none are."""
        if self.why is not None:
            return Notice.of(
                "mesh_line_may_be_another",
                record=record,
                baseline=baseline,
                **self.turns.figures(""),
                **self.base.figures("base_"),
                by_tacho=self.why.get("by_tacho"),
            )
        if not self.moved:
            return None
        return Notice.of("lines_moved", record=record, baseline=baseline, lines=self.moved)


def compare(here: Places, there: Places, keys: Sequence[tuple[str, str]]) -> Compared:
    """Which of the lines ``keys`` (channel, name) of a record are the baseline's."""
    turns, first = (next((place.turns for place in one.values()), Turns()) for one in (here, there))
    if here is there:
        return Compared(same=(True,) * len(keys), ratio=1.0, why=None, turns=turns, base=first)
    ratio, why = speed_ratio(turns, first)
    both = [key for key in keys if key in here and key in there]
    moved = [key for key in both if not here[key].is_at(there[key], ratio)]
    return Compared(
        same=tuple(key not in moved for key in keys),
        ratio=ratio if _is_known(turns, first) else float("nan"),
        why=why if moved else None,
        turns=turns,
        base=first,
        moved=tuple(f"{key[1]} of {key[0]}" for key in moved),
    )


def _is_known(own: Turns, base: Turns) -> bool:
    """Whether anything tells how fast both turn."""
    meshes = np.isfinite(own.mesh) and np.isfinite(base.mesh)
    return bool(meshes) or (own.tacho is not None and base.tacho is not None)
