"""What every case has, of gears or of plain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
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


@dataclass(frozen=True, kw_only=True, repr=False)
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

    def __repr__(self) -> str:
        rows = (f"\n  {name}: {text:.100}" for name, text in self._rows())
        return f"{type(self).__name__}: {self.title}{''.join(rows)}"

    def _repr_html_(self) -> str:
        """What a notebook shows: title, what replaced values of the file, its figures."""
        rows = "".join(
            f"<tr><td>{escape(name)}</td><td>{escape(value)}</td></tr>"
            for name, value in self._rows()
        )
        return f"<div><p><b>{escape(self.title)}</b></p><table>{rows}</table></div>"

    def _rows(self) -> list[tuple[str, str]]:
        return [*self.figures.items(), *self.overrides]

    @property
    def figures(self) -> dict[str, str]:
        """What the case is, in a few values with their units by name."""
        return {}
