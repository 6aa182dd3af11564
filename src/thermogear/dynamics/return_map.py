"""The return map of any model: the state at phase 0 to the state n periods later.

What analysis knows of a model. One mass with clearance has its event-exact map
(:mod:`~thermogear.dynamics.exact_map`), a drive train its own
(:mod:`~thermogear.dynamics.geared_map`); any other model brings one with these methods, most
shortly as an :class:`IteratedMap`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeGuard, runtime_checkable

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError


@dataclass(frozen=True, kw_only=True)
class Visit:
    """Where ``n`` periods of one state lead.

    ``points`` (n + 1, d) on the section, ``jacobian`` D P^n (d, d), ``contact_losses`` and
    ``back_impacts`` counted, ``shares`` of time in back contact, free flight, drive contact (nan of
    a model without teeth), ``samples`` (n * samples a period, d) when asked for.
    """

    points: Floats
    jacobian: Floats
    contact_losses: int = 0
    back_impacts: int = 0
    shares: Floats = field(default_factory=lambda: np.full(3, np.nan))
    samples: Floats = field(default_factory=lambda: np.empty((0, 0)))


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """A tangent vector along a trajectory: the last ``state`` and unit ``direction``, (d,).

    ``growth`` (periods,): ln of how much each period stretched it. Lengths are measured in units of
    the map.
    """

    state: Floats
    direction: Floats
    growth: Floats


@runtime_checkable
class ReturnMap(Protocol):
    """P: a state (d,) at phase 0 to the state one ``period`` [model's unit of time] later.

    ``dimension`` d; ``unit`` (d,) the scales of a state, in which distances and residuals are
    measured.
    """

    @property
    def dimension(self) -> int:
        """Length d of a state."""

    @property
    def period(self) -> float:
        """Time of one return [model's unit of time]."""

    @property
    def unit(self) -> Floats:
        """Scales of a state (d,)."""

    def determinant(self, periods: int) -> float:
        """det D P^n where every trajectory has the same, else nan."""

    def distance(self, one: Floats, other: Floats) -> Floats:
        """Largest component of the difference in units of ``unit``, over leading axes."""

    def carry(self, start: Floats, periods: int) -> Floats:
        """The states (periods, d) after 1, 2, ... periods from ``start``, nothing else."""

    def stretch(self, start: Floats, *, direction: Floats, periods: int) -> Stretch:
        """Carry ``start`` and a tangent vector ``direction``, made unit after every period."""

    def visit(self, start: Floats, periods: int = 1, *, sampled: bool = False) -> Visit:
        """Run ``periods`` periods from ``start`` with the variational equations."""


@runtime_checkable
class MovedMap(ReturnMap, Protocol):
    """A return map that can be followed by half periods and differentiated in a parameter.

    Of one mass with clearance; a branch of any other map is followed by differences.
    """

    def flow(self, start: Floats, halves: int) -> tuple[Floats, Floats]:
        """State (d,) and Jacobian (d, d) ``halves`` half periods later."""

    def rates(self, around: Sequence[tuple[float, object]]) -> object:
        """How the maps change at the rate sum(weight * model) over ``around``."""

    def moved(self, start: Floats, halves: int, rates: Any) -> tuple[Floats, float]:
        """How the end (d,) moves with the parameter, and the margin [units] of the contacts."""


_KNOWN: dict[str, set[type]] = {"visit": set(), "moved": set()}
"""Classes that were found to be return maps: asking a protocol member by member is dear."""


def _is(thing: object, kind: type, member: str) -> bool:
    """Whether it is of that protocol ``kind``, which has such a ``member``."""
    known = _KNOWN[member]
    if type(thing) not in known and hasattr(thing, member) and isinstance(thing, kind):
        known.add(type(thing))
    return type(thing) in known


def is_map(thing: object) -> TypeGuard[ReturnMap]:
    """Whether it is a return map by itself."""
    return _is(thing, ReturnMap, "visit")


def is_moved(thing: object) -> TypeGuard[MovedMap]:
    """Whether it is one that can be differentiated in a parameter."""
    return _is(thing, MovedMap, "moved")


def return_map(model: object, samples: int = 0) -> ReturnMap:
    """The return map of ``model``, or ``model`` itself where it is one; else InputError."""
    if samples == 0 and is_map(model):
        return model
    lanes = getattr(model, "lanes", None)
    made = getattr(lanes() if callable(lanes) else model, "return_map", None)
    if made is None:
        raise InputError(
            "model",
            type(model).__name__,
            why="it has no return map",
            allowed="a clearance oscillator, a GearedModel, a SmoothModel or an IteratedMap",
        )
    found: ReturnMap = made(samples)
    return found


def stretched(section: Any, start: Floats, *, direction: Floats, periods: int) -> Stretch:
    """:meth:`ReturnMap.stretch` by the whole Jacobian of every period."""
    state = np.asarray(start, dtype=float)
    along = np.asarray(direction, dtype=float) / section.unit
    along = along / np.linalg.norm(along)
    growth = np.zeros(periods)
    for number in range(periods):
        visit = section.visit(state)
        along = visit.jacobian @ (along * section.unit) / section.unit
        size = float(np.linalg.norm(along))
        growth[number], along, state = np.log(size), along / size, visit.points[-1]
    return Stretch(state=state, direction=along * section.unit, growth=growth)


class StateMap:
    """What return maps have in common: distances of their states in ``unit`` (d,), tangents."""

    unit: Floats

    @property
    def dimension(self) -> int:
        """Length d of a state."""
        return len(self.unit)

    def distance(self, one: Floats, other: Floats) -> Floats:
        """Largest component of the difference in units of ``unit``, over leading axes."""
        return np.asarray(np.max(np.abs(one - other) / self.unit, axis=-1))

    def stretch(self, start: Floats, *, direction: Floats, periods: int) -> Stretch:
        """Carry ``start`` and a tangent vector ``direction``, made unit after every period."""
        return stretched(self, start, direction=direction, periods=periods)


class IteratedMap(StateMap, ABC):
    """A return map that is known by one step: what a model of one's own has to say.

    A subclass has ``unit`` (d,), the scales of a state, and ``iterate``; ``period`` [model's unit
    of time] where a step does not take 1, and ``determinant`` where det D P is the same everywhere.
    A subclass that is a frozen dataclass may be varied in each of its fields that is a float.
    Where a state has no image, ``iterate`` returns nan or raises ConvergenceError: the motion has
    diverged.

    >>> class Halving(IteratedMap):
    ...     unit = np.ones(1)
    ...     def iterate(self, state):
    ...         return 0.5 * state, np.array([[0.5]])
    >>> Halving().visit(np.ones(1), 2).points.ravel()
    array([1.  , 0.5 , 0.25])
    """

    period: float = 1.0

    @abstractmethod
    def iterate(self, state: Floats) -> tuple[Floats, Floats]:
        """P(state) (d,) and its Jacobian (d, d)."""

    def determinant(self, periods: int) -> float:
        """det D P^n: not known to be the same everywhere."""
        return float("nan")

    def carry(self, start: Floats, periods: int) -> Floats:
        """The states (periods, d) after 1, 2, ... periods from ``start``."""
        states = np.empty((periods, self.dimension))
        for number in range(periods):
            start = states[number] = self._step(start)[0]
        return states

    def visit(self, start: Floats, periods: int = 1, *, sampled: bool = False) -> Visit:
        """Run ``periods`` periods from ``start`` with the variational equations."""
        points, jacobian = [np.asarray(start, dtype=float)], np.eye(self.dimension)
        for _ in range(periods):
            state, step = self._step(points[-1])
            points.append(state)
            with np.errstate(over="ignore", invalid="ignore"):  # long chaos has no bound
                jacobian = step @ jacobian
        return Visit(points=np.array(points), jacobian=jacobian)

    def _step(self, state: Floats) -> tuple[Floats, Floats]:
        """What ``iterate`` gives, its shapes held; ConvergenceError where there is no image."""
        with np.errstate(over="ignore", invalid="ignore"):
            image, jacobian = (np.asarray(part, dtype=float) for part in self.iterate(state))
        if image.shape != (self.dimension,) or jacobian.shape != (self.dimension, self.dimension):
            raise InputError(
                "iterate",
                f"shapes {image.shape} and {jacobian.shape}",
                allowed=f"({self.dimension},) and ({self.dimension}, {self.dimension})",
                why="the next state and its Jacobian, by the length of unit",
            )
        if not np.all(np.isfinite(image)):
            raise ConvergenceError(f"the state {state.tolist()} has no finite image")
        return image, jacobian
