"""Lanes of one mass with clearance: their tables, and the event-exact maps made of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
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


def mixed(one: Lanes, other: Lanes, share: float) -> Lanes:
    """Lanes with every coefficient at a ``share`` of its way from ``one`` to ``other``.

    Raises InputError where their tables jump otherwise than each other's, or differ in length.

    >>> from thermogear.dynamics.models import TorsionalModel
    >>> slow, fast = (
    ...     TorsionalModel(
    ...         damping_ratio=0.1,
    ...         frequency=w,
    ...         stiffness_amplitude=0.0,
    ...         mean_force=0.1,
    ...         force_amplitude=0.0,
    ...     ).lanes()
    ...     for w in (1.0, 2.0)
    ... )
    >>> bool(mixed(slow, fast, 0.5).period[0] == 0.75 * slow.period[0])
    True
    """
    alike = one.stiffness_pieces == other.stiffness_pieces, one.force_pieces == other.force_pieces
    names = ("period", "damping", "half_backlash", "stiffness", "force")
    if not all((*alike, *(getattr(one, n).shape == getattr(other, n).shape for n in names))):
        raise InputError("lanes", "tables that differ", allowed="as many harmonics, the same jumps")
    rows = {n: (1.0 - share) * getattr(one, n) + share * getattr(other, n) for n in names}
    pieces = {n: getattr(one, n) for n in ("stiffness_pieces", "force_pieces")}
    return Lanes(**rows, **pieces, mesh_periods=one.mesh_periods)
