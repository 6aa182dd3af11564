"""What every case has, of gears or of plain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import Any, ClassVar

from thermogear.case.assumptions import Assumption

SHOWN = 12
"""Figures that a case shows of itself in a line each."""


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
        changes = "".join(f"\n  {path} = {text}" for path, text in self.overrides)
        rows = [f"\n  {name}: {value:.100}" for name, value in self._figures()[:SHOWN]]
        return f"{type(self).__name__}: {self.title}{changes}{''.join(rows)}"

    def _repr_html_(self) -> str:
        """What a notebook shows: title, what replaced values of the file, its figures."""
        rows = "".join(
            f"<tr><td>{escape(name)}</td><td>{escape(value)}</td></tr>"
            for name, value in (*self.overrides, *self._figures())
        )
        return f"<div><p><b>{escape(self.title)}</b></p><table>{rows}</table></div>"

    def _figures(self) -> list[tuple[str, str]]:
        """The derived figures by their names, as `thermogear check` lists them."""
        from thermogear.case.derived import facts

        return [(f"{fact.group}, {fact.name}", fact.words) for fact in facts(self)]
