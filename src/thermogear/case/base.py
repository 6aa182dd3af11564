"""What every case has, of gears or of plain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from thermogear.case.assumptions import Assumption


@dataclass(frozen=True, kw_only=True)
class Simulation:
    """How long and how finely the motion is followed; periods are mesh periods.

    ``initial_state`` is (X, X'), the displacement over the cold half backlash and its derivative
    by omega_n t.
    """

    periods: int
    discard: int
    most_discarded: int
    steps_per_period: int
    samples: int
    sample_periods: int
    initial_state: tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Case:
    """What every case has.

    ``text`` is the file as it was read, with the files it names, without the ``overrides``.
    ``kind``: "gear" or "dimensionless".
    """

    kind: ClassVar[str] = ""
    title: str
    text: str
    simulation: Simulation
    assumptions: tuple[Assumption, ...] = ()
    overrides: tuple[tuple[str, str], ...] = ()

    @property
    def provenance(self) -> dict[str, Any]:
        """What a result keeps of this case: the file as read, and what replaced its values."""
        return {"case": self.text, "overrides": [list(pair) for pair in self.overrides]}
