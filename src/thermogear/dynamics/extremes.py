"""Where the contacts of a closed orbit are pressed deepest and gape widest.

A contact's depth is positive where it is closed and negative where it is open [half backlashes].
It changes its state at zeros of the depth, and their number changes only where an extreme of the
depth passes zero: at a grazing. Between its samples a motion is the quintic through displacement,
velocity and acceleration at both of them, of sixth order in the step; an extreme is looked for on
it in finer and finer grids, which a kink does not disturb (the deepest of several elements).
Checked by ``tests/dynamics/test_extremes.py`` against closed forms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Flags, Floats

WATCHED = 256
"""Samples a mesh period [1], chosen: an error of 6e-12 of a line of three times the mesh."""
GRIDS, PLACES = 13, np.linspace(-1.0, 1.0, 9)
"""Grids, each a quarter as wide as the last [1], chosen: the place to 1e-8 of a step."""


class Touch(NamedTuple):
    """The extreme of an orbit that touches: of which contact, its phase, whether a maximum."""

    contact: int
    phase: float
    deepest: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Extremes:
    """Extremes of every contact's depth along a closed orbit, in order of contact and phase.

    ``periods`` of the map that it takes, ``contact`` (m,) of ``contacts`` in all, ``phase`` (m,)
    [periods], ``depth`` (m,) [half backlashes], ``deepest`` (m,): a maximum, else a minimum.
    """

    periods: int
    contacts: int
    contact: NDArray[np.int64]
    phase: Floats
    depth: Floats
    deepest: Flags

    @property
    def margin(self) -> float:
        """How near an extreme comes to a change of contact [half backlashes]; inf without one."""
        return float(np.abs(self.depth).min(initial=np.inf))

    @property
    def losses(self) -> tuple[int, ...]:
        """How often every contact opens along the orbit."""
        closed = [self.depth[self.contact == contact] > 0.0 for contact in range(self.contacts)]
        return tuple(int(np.sum(contact & ~np.roll(contact, -1))) for contact in closed)

    def touch(self, place: int | None = None) -> Touch:
        """The extreme at ``place``, else the one nearest to a change of contact."""
        here = int(np.argmin(np.abs(self.depth))) if place is None else place
        return Touch(int(self.contact[here]), float(self.phase[here]), bool(self.deepest[here]))

    def place(self, touch: Touch, *, within: float) -> int | None:
        """Index of the extreme nearest to ``touch``; None without one ``within`` a phase."""
        away = np.abs((self.phase - touch.phase) / self.periods % 1.0)
        away = np.minimum(away, 1.0 - away) * self.periods
        alike = (self.contact == touch.contact) & (self.deepest == touch.deepest)
        away = np.where(alike, away, np.inf)
        return int(away.argmin()) if away.min(initial=np.inf) < within else None

    def without(self, place: int) -> Extremes:
        """The same where the extreme at ``place`` does not reach over zero."""
        depth = self.depth.copy()
        depth[place] = -1.0 if self.deepest[place] else 1.0
        return replace(self, depth=depth)


def extremes_of(
    motion: Floats, depths: Callable[[Floats, Floats], Floats], *, periods: int
) -> Extremes:
    """Extremes along a closed orbit of ``periods`` periods of its map.

    ``motion`` (3, S, k): displacements and their first and second derivatives, at S equal steps and
    by the step. ``depths`` (displacements (..., k), phase (...) [periods]) -> (..., contacts).
    """
    count = motion.shape[1]
    phases = np.arange(count) * (periods / count)
    at_samples = depths(motion[0], phases)
    before, after = np.roll(at_samples, 1, axis=0), np.roll(at_samples, -1, axis=0)
    deepest = (at_samples > before) & (at_samples >= after)
    contact, place = np.nonzero((deepest | ((at_samples < before) & (at_samples <= after))).T)
    top = deepest[place, contact]
    sign = np.where(top, 1.0, -1.0)

    def depth(steps: Floats) -> Floats:
        at = place + steps
        cell = np.floor(at).astype(int)
        ends = motion[:, cell % count], motion[:, (cell + 1) % count]
        here = depths(_quintic(*ends, share=(at - cell)[..., None]), at * (periods / count))
        return np.asarray(np.take_along_axis(here, mine[: len(at)], axis=-1)[..., 0])

    mine = np.broadcast_to(contact[None, :, None], (PLACES.size, place.size, 1))
    steps, width = np.zeros(place.size), 1.0
    for _ in range(GRIDS):
        tried = np.clip(steps + width * PLACES[:, None], -1.0, 1.0)
        best = np.argmax(sign * depth(tried), axis=0)
        steps, width = tried[best, np.arange(place.size)], 0.25 * width
    return Extremes(
        periods=periods,
        contacts=at_samples.shape[1],
        contact=contact,
        phase=(place + steps) * (periods / count) % periods,
        depth=depth(steps[None])[0],
        deepest=top,
    )


def _quintic(first: Floats, second: Floats, *, share: Floats) -> Floats:
    """The quintic between two samples (3, m, k) of value, slope and bend, at ``share`` (m, 1)."""
    t, square, cube = share, share**2, share**3
    return np.asarray(
        first[0]
        + t * first[1]
        + 0.5 * square * first[2]
        + cube
        * (
            (10.0 - 15.0 * t + 6.0 * square) * (second[0] - first[0])
            - (6.0 - 8.0 * t + 3.0 * square) * first[1]
            - (4.0 - 7.0 * t + 3.0 * square) * second[1]
            - 0.5 * (3.0 - 3.0 * t + square) * first[2]
            + 0.5 * (1.0 - 2.0 * t + square) * second[2]
        )
    )
