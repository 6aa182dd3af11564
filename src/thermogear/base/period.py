"""After how many mesh periods a pair of gears repeats itself, and the orders that follow."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from thermogear.base.errors import InputError


@dataclass(frozen=True)
class Period:
    """A pair of gears repeats itself after ``mesh_periods`` L mesh periods.

    1 where all teeth of a gear are alike; the teeth of a gear, z1 or z2, where those of that gear
    alone differ; the least common multiple of ``teeth`` (z1, z2) where those of both do: the turn
    of the pair, the hunting tooth period. ``teeth`` None: nothing is known of shafts.

    >>> Period.of((20, 30), pinion=True, wheel=True).orders
    {'pinion': 3, 'wheel': 2, 'mesh': 60, 'hunting_tooth': 1}
    """

    mesh_periods: int = 1
    teeth: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        if not (isinstance(self.mesh_periods, int) and self.mesh_periods >= 1):
            raise InputError("mesh_periods", repr(self.mesh_periods), allowed="1, 2, 3, ...")

    @classmethod
    def of(cls, teeth: tuple[int, int], *, pinion: bool = False, wheel: bool = False) -> Period:
        """The period of gears with ``teeth``, where the teeth of the named gears differ."""
        differing = [z for z, differs in zip(teeth, (pinion, wheel), strict=True) if differs]
        return cls(math.lcm(*differing), teeth)

    @property
    def orders(self) -> dict[str, int]:
        """Orders of the period at which a shaft, the mesh and the hunting tooth repeat.

        A shaft is given only where a whole number of its turns fills the period; the hunting
        tooth only where the same two teeth meet once in a period.
        """
        orders = {}
        if self.teeth is not None:
            for name, z in zip(("pinion", "wheel"), self.teeth, strict=True):
                if self.mesh_periods % z == 0:
                    orders[name] = self.mesh_periods // z
        orders["mesh"] = self.mesh_periods
        if self.teeth is not None and self.mesh_periods == math.lcm(*self.teeth):
            orders["hunting_tooth"] = 1
        return orders

    def line(self, order: int) -> str:
        """The name of an ``order`` of the period: of a harmonic of the mesh, or of what lies by it.

        The nearest harmonic of the mesh, and how many orders of a shaft beside it: of the one that
        takes fewer; of the hunting tooth where it is of neither.

        >>> period = Period.of((20, 30), pinion=True, wheel=True)
        >>> [period.line(order) for order in (3, 4, 1, 60, 126)]
        ['pinion', '2 wheel', 'hunting tooth', 'mesh', '2 mesh + 2 pinion']
        """
        harmonic = (2 * order + self.mesh_periods) // (2 * self.mesh_periods)
        beside = order - harmonic * self.mesh_periods
        parts = [_times(harmonic, "mesh")] * (harmonic > 0)
        if beside:
            orders = self.orders
            shafts = [(abs(beside) // orders[name], name) for name in ("pinion", "wheel")
                      if name in orders and beside % orders[name] == 0]  # fmt: skip
            count, name = min(shafts, default=(abs(beside), "hunting tooth"))
            if len({many for many, _ in shafts}) < len(shafts):
                name = "both shafts"
            parts += [("−" if beside < 0 else "+") * bool(parts), _times(count, name)]
        return " ".join(part for part in parts if part)

    def frequency(self, mesh_frequency: float) -> float:
        """How often the period repeats [the unit of ``mesh_frequency``]."""
        return mesh_frequency / self.mesh_periods


def line_names(about: Mapping[str, Any], orders: Iterable[float]) -> list[str]:
    """Names of lines at ``orders`` of the mesh, of a turn that ``mesh_periods`` and ``teeth`` tell.

    >>> line_names({"mesh_periods": 60, "teeth": [20, 30]}, [0.05, 1.0, 2.1])
    ['pinion', 'mesh', '2 mesh + 2 pinion']
    """
    pinion, wheel = (int(z) for z in about["teeth"])
    period = Period(int(about["mesh_periods"]), (pinion, wheel))
    return [period.line(round(float(order) * period.mesh_periods)) for order in orders]


def _times(count: int, name: str) -> str:
    return name if count == 1 else f"{count} {name}"


def turns(mesh_periods: int, *, of: int) -> int:
    """How many turns ``of`` so many mesh periods hold ``mesh_periods``, the last one whole.

    >>> turns(500, of=1), turns(500, of=945), turns(0, of=35)
    (500, 1, 0)
    """
    return -(-mesh_periods // of)
