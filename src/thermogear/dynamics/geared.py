"""A drive train in motion: its equation, and the return map of it."""

from __future__ import annotations

from dataclasses import dataclass

from thermogear.dynamics.geared_equation import GearedEquation
from thermogear.dynamics.geared_equation import LocalBearing as LocalBearing
from thermogear.dynamics.geared_equation import OuterForce as OuterForce
from thermogear.dynamics.geared_equation import Wobble as Wobble
from thermogear.dynamics.geared_map import GearedMap


@dataclass(frozen=True, eq=False, kw_only=True)
class GearedModel(GearedEquation):
    """The equation of motion of a drive train in SI [kg, m, s, rad], with its return map.

    Fields and units are its own: see :class:`~thermogear.dynamics.geared_equation.GearedEquation`.
    """

    def return_map(self, samples: int = 0) -> GearedMap:
        """The return map, with ``samples`` a mesh period of what its visits record."""
        return GearedMap(model=self, samples=samples)
