"""Lanes of one mass with clearance: their tables, and the event-exact maps made of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from thermogear.base.arrays import Floats
from thermogear.dynamics.bundle import Prepared
from thermogear.dynamics.exact_map import Ensemble, ExactMap, exact_bundles
from thermogear.dynamics.tables import LaneTables


@dataclass(frozen=True, kw_only=True)
class Lanes(LaneTables):
    """Parameter points side by side with their return maps; the fields are the tables'."""

    def return_map(self, samples: int = 0) -> ExactMap:
        """The event-exact return map of one lane; ``samples`` a period of what it records."""
        return ExactMap(self, samples)

    def bundles(self, refine: int = 1) -> Iterator[Prepared]:
        """The return maps of all lanes in blocks that run together: indices, how each is made."""
        return exact_bundles(self, refine)

    def ensemble(
        self,
        start: Floats,
        *,
        threads: int | None = None,
        refine: int = 1,
        parting: bool = False,
    ) -> Ensemble:
        """All lanes from ``start`` (lane, 2) on their way, on ``threads``; see its class."""
        return Ensemble(self, start, threads=threads, refine=refine, parting=parting)
