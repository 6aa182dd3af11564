"""One label from many starts that differ by rounding: the same rule for a motion of any model.

Where a small difference grows on the way, rounding decides where a motion ends, and the order in
which a library adds numbers decides rounding. A label is given where all starts end alike.

The method is an ensemble: starts that differ by rounding's size are followed, and the label is what
they agree on. It costs as many runs as starts, and only where a tangent along the way has grown
above PARTED. It cannot prove chaos: starts that all part for so many periods may still close later.
Checked by ``tests/analysis/test_labels.py`` on published rows, and by ``trials/labels.py``,
which follows every chaotic motion of random draws to 200 000 periods.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, MISSING, dataclass, fields, replace
from typing import Generic, TypeVar

import numpy as np

from thermogear.analysis.orbits import Orbit
from thermogear.base.arrays import Floats
from thermogear.base.vocabulary import label_words

APART = 1e-13
"""Starts that differ by rounding: in units of the map (of one mass half backlashes), or of the
start where that is larger."""
PARTED = 1e6
"""Growth of such a difference on the way above which rounding may decide where a motion ends."""
STARTS = 16
"""Starts that are followed where rounding decides."""
FOLLOW = 32_000
"""Periods that each of them is followed for at most."""
PATIENCE = 4
"""Times as long for the others, where most starts have ended alike by then: chaos that ends has no
fixed length."""
SAME = 1e-6
"""Distance in units of the map below which two orbits are one."""


@dataclass(frozen=True)
class Told:
    """What a start settles on: its ``name`` and ``period`` n (0: none), the ``reason`` in words.

    ``discarded`` mesh periods went by before; ``orbit`` where one proves it. ``starts`` that differ
    by rounding share the label; of a chaotic motion all of them were ``followed`` so many periods
    and none closed: an estimate, for chaos may end later. ``mesh_periods`` are one period: 1, or
    those of a turn, of which n is then a count.
    """

    name: str
    period: int
    reason: str
    discarded: int
    orbit: Orbit | None = None
    _: KW_ONLY
    followed: int = 0
    starts: int = 1
    mesh_periods: int = 1

    @property
    def words(self) -> str:
        """The name, and for chaos how long and from how many starts it was seen."""
        return label_words(
            self.name,
            followed=self.followed,
            starts=self.starts,
            mesh_periods=self.mesh_periods,
        )

    def alike(self, other: Told) -> bool:
        """Whether two labels are of one motion: the same name and, with orbits, the same orbit.

        In any of its phases, within :data:`SAME`.
        """
        if (self.name, self.period) != (other.name, other.period):
            return False
        if self.orbit is None or other.orbit is None:
            return self.orbit is other.orbit
        away = self.orbit.section.distance(self.orbit.points, other.orbit.state)
        return float(np.min(away)) < SAME


_Label = TypeVar("_Label", bound=Told)


@dataclass(frozen=True)
class End(Generic[_Label]):
    """Where one start ended: its label, None where it moves on; ``lively``: chaotic to the end."""

    label: _Label | None
    periods: int
    lively: bool = False


def directions(*, count: int, dimension: int) -> Floats:
    """Where starts beside another one lie, (count, dimension): no two the same way from it."""
    turn = np.pi * (np.sqrt(5.0) - 1.0) * np.arange(1, count + 1)
    place = np.arange(dimension)
    angle = np.multiply.outer(turn, 1 + place // 2) - 0.5 * np.pi * (place % 2)
    return np.asarray(np.cos(angle))


def beside(start: Floats, *, unit: Floats, count: int) -> Floats:
    """``count`` starts (count, d) that differ from ``start`` (d,) by rounding, :data:`APART`."""
    return start + APART * np.maximum(unit, np.abs(start)) * directions(
        count=count, dimension=start.size
    )


def _kinds(first: _Label, ends: Sequence[End[_Label]]) -> list[_Label]:
    """The labels of all starts that have ended, the first one's too unless it is chaotic."""
    own = [] if first.name == "chaotic" else [first]
    return own + [end.label for end in ends if end.label is not None]


def agreed(first: _Label, ends: Sequence[End[_Label]]) -> bool:
    """Whether all starts that have ended did so on one motion."""
    kinds = _kinds(first, ends)
    return all(kinds[0].alike(kind) for kind in kinds[1:])


def most(first: _Label, ends: Sequence[End[_Label]], waiting: int) -> bool:
    """Whether more starts have ended than go on, the ``waiting`` ones and those given up."""
    return len(_kinds(first, ends)) > waiting + sum(end.label is None for end in ends)


def judged(first: _Label, ends: Sequence[End[_Label]]) -> _Label:
    """The label of a start when the starts near it ended so."""
    kinds = _kinds(first, ends)
    still = [end for end in ends if end.label is None]
    longest = max([first.discarded, *(end.periods for end in ends)])
    of = len(ends) + (first.name != "chaotic")
    if not kinds:
        shortest = min(end.periods for end in still)
        if all(end.lively for end in still):
            reason = f"{first.reason}; none of {of} starts closed in {shortest} periods"
            return replace(first, reason=reason, followed=shortest, starts=of)
        reason = f"neither closed nor chaotic to the end by the exponent after {longest} periods"
        return replace(first, name="undecided", reason=reason, discarded=longest, followed=0)
    different = [kinds[0]]
    for kind in kinds[1:]:
        if not any(kind.alike(other) for other in different):
            different.append(kind)
    if len(different) > 1:
        names = sorted({kind.name for kind in different})
        words = " or ".join(names) if len(names) > 1 else f"{len(different)} {names[0]} orbits"
        reason = f"where the transient ends depends on rounding: {words} from {of} starts"
        # what one motion proved is no proof of another: all that has a default is left to it
        needed = [
            one.name for one in fields(first) if one.default is MISSING is one.default_factory
        ]
        kept = {name: getattr(first, name) for name in needed}
        told = {"name": "undecided", "period": 0, "reason": reason, "discarded": longest}
        return type(first)(**kept | told)
    if still:
        reason = (
            f"{len(kinds)} of {of} starts end as {kinds[0].name}, the others not in {longest} "
            "periods"
        )
        return replace(kinds[0], name="undecided", reason=reason, discarded=longest)
    return replace(kinds[0], discarded=longest, starts=of)
