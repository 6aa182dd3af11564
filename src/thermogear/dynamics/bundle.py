"""Many return maps side by side, each with a state of its own: what analysis knows of them.

Lanes of one mass with clearance run in compiled blocks
(:mod:`~thermogear.dynamics.exact_map`); any other return maps run one after the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np

from thermogear.base.arrays import Floats, Whole
from thermogear.base.errors import ConvergenceError
from thermogear.dynamics.return_map import ReturnMap, return_map

WIDTH = 128
"""Lanes of a block that run best together."""


@dataclass(frozen=True, kw_only=True)
class Visits:
    """Where ``n`` periods of many states lead.

    ``points`` (lane, n + 1, d), ``jacobian`` D P^n (lane, d, d), ``losses`` of drive contact and
    ``impacts`` on the back side counted, ``spent`` (lane, 3) the time [model's unit] in back
    contact, free flight and drive contact.
    """

    points: Floats
    jacobian: Floats
    losses: Whole
    impacts: Whole
    spent: Floats

    @property
    def residual(self) -> Floats:
        """P^n z - z (lane, d)."""
        return np.asarray(self.points[:, -1] - self.points[:, 0])


class Crowd(Protocol):
    """States on their way, one for every lane of a bundle; advanced in place."""

    @property
    def bundle(self) -> Bundle:
        """The maps they are on."""

    @property
    def state(self) -> Floats:
        """Where they are: (lane, d); nan where a state has left every bound."""

    def run(self, periods: int) -> Floats:
        """Advance; the sections (period, d, lane)."""

    def aim(self, direction: Floats | None = None) -> None:
        """Give every lane a tangent ``direction`` (lane, d), else one of the bundle's own."""

    def stretch(self, periods: int) -> tuple[Floats, Floats]:
        """Advance with the tangents, made unit after every period.

        The sections (period, d, lane), and ln of how much each period stretched (period, lane).
        """

    def take(self, index: Whole) -> Crowd:
        """Go on with some lanes only."""

    def seat(self, seats: Whole, start: Floats) -> None:
        """Put new states ``start`` (seat, d) in the place of some."""


class Bundle(Protocol):
    """Return maps side by side: ``period`` (lane,) and ``unit`` (lane, d) as of each of them."""

    def __len__(self) -> int:
        """How many lanes."""

    @property
    def period(self) -> Floats:
        """Time of one return of every lane (lane,)."""

    @property
    def unit(self) -> Floats:
        """Scales of every lane's states (lane, d)."""

    def determinant(self, periods: int) -> Floats:
        """det D P^n of every lane, nan where it is not known: (lane,)."""

    def take(self, index: Whole) -> Bundle:
        """The maps of some lanes, in the order of ``index``; a lane may be taken many times."""

    def crowd(self, start: Floats) -> Crowd:
        """States at ``start`` (lane, d), phase 0."""

    def visit(self, start: Floats, periods: int) -> Visits:
        """Run ``periods`` periods from ``start`` (lane, d) with the variational equations."""


Prepared = tuple[Whole, Callable[[], Bundle]]


def bundles(models: object, *, refine: int = 1) -> Iterator[Prepared]:
    """Blocks of ``models`` that run together: the indices of each, and how its bundle is made.

    ``models`` are lanes, or a sequence of what :func:`return_map` takes, states of one length.
    ``refine`` asks for so many times the sub-steps where a map has such: another rounding.
    What a lane does depends on that lane alone, to the last bit.
    """
    made = getattr(models, "bundles", None)
    if made is not None:
        yield from made(refine)
        return
    many: Sequence[object] = list(models)  # type: ignore[call-overload]
    for first in range(0, len(many), WIDTH):
        part = many[first : first + WIDTH]
        yield np.arange(first, first + len(part)), partial(_in_turn, part)


def _in_turn(models: Sequence[object]) -> InTurn:
    # a model taken many times has one map
    maps = {id(one): one for one in models}
    made = {key: return_map(one) for key, one in maps.items()}
    return InTurn([made[id(one)] for one in models])


class InTurn:
    """A bundle of any return maps, one run after the other."""

    def __init__(self, maps: Sequence[ReturnMap]) -> None:
        self.maps = list(maps)
        self.period = np.array([one.period for one in maps])
        self.unit = np.array([one.unit for one in maps])

    def __len__(self) -> int:
        return len(self.maps)

    def determinant(self, periods: int) -> Floats:
        """det D P^n of every lane, nan where it is not known: (lane,)."""
        return np.array([one.determinant(periods) for one in self.maps])

    def take(self, index: Whole) -> InTurn:
        """The maps of some lanes, in the order of ``index``."""
        return InTurn([self.maps[i] for i in np.asarray(index).tolist()])

    def crowd(self, start: Floats) -> InTurnCrowd:
        """States at ``start`` (lane, d), phase 0."""
        return InTurnCrowd(self, start)

    def visit(self, start: Floats, periods: int) -> Visits:
        """Run ``periods`` periods from ``start`` (lane, d); nan where a state leaves all bounds."""
        lanes, d = start.shape
        points = np.full((lanes, periods + 1, d), np.nan)
        jacobian = np.full((lanes, d, d), np.nan)
        losses, impacts = np.zeros(lanes, np.int64), np.zeros(lanes, np.int64)
        spent = np.full((lanes, 3), np.nan)
        points[:, 0] = start
        for lane, one in enumerate(self.maps):
            try:
                found = one.visit(start[lane], periods)
            except ConvergenceError:
                continue
            points[lane], jacobian[lane] = found.points, found.jacobian
            losses[lane], impacts[lane] = found.contact_losses, found.back_impacts
            spent[lane] = found.shares * (periods * one.period)
        return Visits(points=points, jacobian=jacobian, losses=losses, impacts=impacts, spent=spent)


class InTurnCrowd:
    """States on their way on an :class:`InTurn` bundle."""

    def __init__(self, bundle: InTurn, start: Floats) -> None:
        self.bundle = bundle
        self.state = np.array(start, dtype=float)
        self.tangent = np.array(bundle.unit)

    def run(self, periods: int) -> Floats:
        """Advance; the sections (period, d, lane)."""
        sections = np.full((periods, *self.state.T.shape), np.nan)
        for lane, one in enumerate(self.bundle.maps):
            if np.all(np.isfinite(self.state[lane])):
                with suppress(ConvergenceError):
                    sections[:, :, lane] = one.carry(self.state[lane], periods)
        if periods:
            self.state = sections[-1].T.copy()
        return sections

    def aim(self, direction: Floats | None = None) -> None:
        """Give every lane a tangent ``direction`` (lane, d), else along the first coordinate."""
        if direction is None:
            direction = np.zeros_like(self.bundle.unit)
            direction[:, 0] = self.bundle.unit[:, 0]
        self.tangent = np.array(direction, dtype=float)

    def stretch(self, periods: int) -> tuple[Floats, Floats]:
        """Advance with the tangents: the sections (period, d, lane), growths (period, lane)."""
        sections = np.full((periods, *self.state.T.shape), np.nan)
        growth = np.full((periods, len(self.state)), np.nan)
        for lane, one in enumerate(self.bundle.maps):
            state, along = self.state[lane], self.tangent[lane]
            for number in range(periods):
                if not np.all(np.isfinite(state)):
                    break
                try:
                    path = one.stretch(state, direction=along, periods=1)
                except ConvergenceError:
                    state = np.full_like(state, np.nan)
                    break
                state, along = path.state, path.direction
                sections[number, :, lane], growth[number, lane] = state, path.growth[0]
            self.state[lane], self.tangent[lane] = state, along
        return sections, growth

    def take(self, index: Whole) -> InTurnCrowd:
        """Go on with some lanes only."""
        left = InTurnCrowd(self.bundle.take(index), self.state[index])
        left.tangent = self.tangent[index]
        return left

    def seat(self, seats: Whole, start: Floats) -> None:
        """Put new states ``start`` (seat, d) in the place of some."""
        self.state[seats] = start
