"""Thermal networks in time: implicit steps with error control, heat counted in and out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.bounds import BODY
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.progress import Progress, silent
from thermogear.heat.network import ThermalNetwork

if TYPE_CHECKING:
    from scipy.integrate import OdeSolution

Floats = NDArray[np.float64]
State = Mapping[str, Floats]
"""Temperatures [K] of the free nodes by name, arrays of one shape."""

HOTTEST = 700.0
"""A node [K] that gets there ends the course: no gear lives there, and no law was made for it."""
_RELATIVE = 0.1
"""Relative tolerance over the absolute one, per kelvin."""
_SLOWEST = 40.0
"""Time constants after which a course that does not settle is given up."""


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """A stretch of time up to ``end`` [s] in which one law holds; inf: until it is steady.

    ``network``: temperatures of the free nodes, arrays (count,), to the network at them. The free
    nodes and their capacities are the same throughout; given temperatures may differ.

    >>> from thermogear.heat.network import Link
    >>> network = ThermalNetwork(
    ...     (Link("oil", "ambient", 10.0),), sources={"oil": 200.0}, fixed={"ambient": 293.15},
    ...     capacities={"oil": 6000.0},
    ... )
    >>> course = follow([Stretch(end=600.0, network=lambda state: network)], {"oil": 293.15})
    >>> f"{course.temperatures['oil'][-1] - 293.15:.1f} K"
    '12.6 K'
    """

    end: float
    network: Callable[[State], ThermalNetwork]


@dataclass(frozen=True, eq=False, kw_only=True)
class Course:
    """Temperatures and heat over ``time`` [s], arrays (time,); a jump of the law is there twice.

    ``stretch``: place of the stretch each moment belongs to; ``temperatures`` [K] of the free
    nodes; ``heat_in`` set free by the sources, ``heat_out`` left through the given nodes and
    ``kept`` in the capacities, since the start [J]; ``imbalance`` = |kept - in + out| over the
    heat turned over; ``events`` [s]: when each watched quantity falls through 0; ``settled``:
    whether a last stretch without end came to rest; ``too_hot``: a node reached 700 K, which ends
    the course; ``evaluations`` of the network.
    """

    time: Floats
    stretch: NDArray[np.int64]
    temperatures: dict[str, Floats]
    heat_in: Floats
    heat_out: Floats
    kept: Floats
    imbalance: Floats
    events: dict[str, Floats]
    settled: bool
    too_hot: bool
    evaluations: int
    _solutions: tuple[OdeSolution, ...] = field(repr=False)
    _nodes: tuple[str, ...] = field(repr=False)
    _datum: float = field(repr=False)

    def at(self, times: ArrayLike) -> dict[str, Floats]:
        """Temperatures [K] of the free nodes at any ``times`` [s] of the course, their shape."""
        t = np.asarray(times, dtype=float)
        if not np.all((t >= 0.0) & (t <= self.time[-1])):
            raise InputError("times", f"{t} s", allowed=f"0..{self.time[-1]:g} s")
        ends = np.array([one.t_max for one in self._solutions])
        place = np.minimum(np.searchsorted(ends, t, side="left"), ends.size - 1)
        y = np.empty((len(self._nodes), *t.shape))
        for k, solution in enumerate(self._solutions):
            here = place == k
            if np.any(here):
                y[:, here] = solution(t[here])[: len(self._nodes)]
        return {name: y[i] + self._datum for i, name in enumerate(self._nodes)}


@dataclass
class _Law:
    """Rates of the free nodes over ``datum`` [K], then of heat in and out over all capacity."""

    stretch: Stretch
    nodes: tuple[str, ...]
    capacity: Floats
    datum: float
    calls: int = 0

    def temperatures(self, y: Floats) -> dict[str, Floats]:
        return {name: y[i] + self.datum for i, name in enumerate(self.nodes)}

    def network(self, y: Floats) -> ThermalNetwork:
        self.calls += 1
        held = {n: np.clip(t, BODY.least, BODY.most) for n, t in self.temperatures(y).items()}
        return self.stretch.network(held)

    def __call__(self, t: float, y: Floats) -> Floats:
        flat = y.reshape(y.shape[0], -1)
        kept, source, out = self.network(flat).flows(self.temperatures(flat))
        whole = self.capacity.sum()
        rates = np.vstack([(kept / self.capacity).T, source / whole, out / whole])
        return rates.reshape(y.shape)


def follow(
    stretches: Sequence[Stretch],
    start: Mapping[str, float],
    *,
    times: ArrayLike = (),
    moments: int = 60,
    tolerance: float = 1e-3,
    settled_within: float = 0.01,
    events: Mapping[str, Callable[[State, int], float]] | None = None,
    progress: Progress = silent,
) -> Course:
    """Temperatures of a network whose conductances and sources depend on them, over time.

    C dT/dt = q(T) - G(T) T by backward differences of variable order and step (scipy's BDF), begun
    anew at every jump of the law. Heat in and out are states of their own: dE_in/dt = sum q,
    dE_out/dt = what leaves through the given nodes. The method is linear, so the balance closes
    to rounding if every flow is counted.

    ``stretches`` one after the other from time 0; ``start`` [K] of every free node; ``times`` [s]
    to be stored with some ``moments`` of each stretch; ``tolerance`` [K] of one step's error, a
    tenth of it relative (the course may err by ten times as much); a stretch without end runs
    until its slowest mode has no more than ``settled_within`` [K] to go; ``events`` [K or m, any]
    of the state and the place of its stretch that are located where they fall through 0. Raises
    InputError for stretches that do not follow each other, and ConvergenceError where the steps
    fail.
    """
    ends = np.array([one.end for one in stretches])
    if not ends.size or not np.all(np.diff(np.concatenate([[0.0], ends])) > 0.0):
        raise InputError("stretches", f"ends {ends} s", allowed="one or more, rising from 0 s")
    if not tolerance > 0.0:
        raise InputError("tolerance", f"{tolerance} K", allowed="> 0 K")
    known = {name: np.atleast_1d(np.asarray(t, dtype=float)) for name, t in start.items()}
    first = stretches[0].network(known)
    from scipy.integrate import solve_ivp

    nodes, capacity = first.free, _capacities(first)
    datum = min(float(start[name]) for name in nodes)
    whole = float(capacity.sum())
    y = np.array([*(float(start[name]) - datum for name in nodes), 0.0, 0.0])
    wanted = np.unique(np.asarray(times, dtype=float))
    watched = dict(events or {})
    happened: dict[str, list[float]] = {name: [] for name in watched}
    solutions: list[OdeSolution] = []
    stored: list[tuple[int, Floats, Floats]] = []
    begun, calls, settled, too_hot = 0.0, 1, False, False
    for place, stretch in enumerate(stretches):
        law = _Law(stretch, nodes, capacity, datum)
        endless, end, rests = not np.isfinite(stretch.end), stretch.end, False
        rest = _coming_to_rest(law, capacity, settled_within)
        if endless:
            rests = rest(begun, y) <= 0.0
            slowest = _slowest(law.network(y[:, None]), capacity)
            end = begun + (1.0 if rests else _SLOWEST) * slowest
        crossings = _crossings(law, watched, place, progress, begun, end)
        if endless and not rests:
            crossings.append(rest)
        solved = solve_ivp(
            law,
            (begun, end),
            y,
            method="BDF",
            vectorized=True,
            dense_output=True,
            rtol=_RELATIVE * tolerance,
            atol=tolerance,
            events=crossings,
        )
        calls += law.calls
        if solved.status < 0:
            raise ConvergenceError(f"thermal network at {solved.t[-1]:.6g} s: {solved.message}")
        for name, at in zip(watched, solved.t_events[1:], strict=False):
            happened[name] += [float(t) for t in at]
        too_hot = solved.t_events[0].size > 0
        settled = endless and not too_hot and (rests or solved.status == 1)
        last = float(solved.t[-1])
        t = _moments(begun, last, moments, wanted)
        stored.append((place, t, solved.sol(t)))
        solutions.append(solved.sol)
        begun, y = last, solved.y[:, -1]
        if too_hot:
            break
    time = np.concatenate([t for _, t, _ in stored])
    states = np.concatenate([s for _, _, s in stored], axis=1)
    heat_in, heat_out = whole * states[-2], whole * states[-1]
    kept = capacity @ (states[: len(nodes)] - states[: len(nodes), :1])
    turned = heat_in + np.abs(heat_out) + np.abs(kept)
    left = np.abs(kept - heat_in + heat_out)
    return Course(
        time=time,
        stretch=np.concatenate([np.full(t.size, place) for place, t, _ in stored]),
        temperatures={name: states[i] + datum for i, name in enumerate(nodes)},
        heat_in=heat_in,
        heat_out=heat_out,
        kept=kept,
        imbalance=np.divide(left, turned, out=np.zeros_like(left), where=turned > 0.0),
        events={name: np.asarray(found) for name, found in happened.items()},
        settled=settled,
        too_hot=too_hot,
        evaluations=calls,
        _solutions=tuple(solutions),
        _nodes=nodes,
        _datum=datum,
    )


def _capacities(network: ThermalNetwork) -> Floats:
    missing = [name for name in network.free if name not in network.capacities]
    if missing:
        raise InputError("capacity of", ", ".join(missing), why="the course in time needs it")
    return np.array([network.capacities[name] for name in network.free], dtype=float)


def _slowest(network: ThermalNetwork, capacity: Floats) -> float:
    """The slowest time constant [s] of the network as it is."""
    names = network.nodes
    free = [i for i, name in enumerate(names) if name not in network.fixed]
    matrix = network.laplacian().reshape(-1, len(names), len(names))[0]
    inner = matrix[np.ix_(free, free)]
    root = np.sqrt(capacity)
    return float(1.0 / np.linalg.eigvalsh(inner / np.outer(root, root))[0])


def _crossings(
    law: _Law,
    watched: Mapping[str, Callable[[State, int], float]],
    place: int,
    progress: Progress,
    begun: float,
    end: float,
) -> list[Callable[[float, Floats], float]]:
    """Events of a stretch: a node too hot, which ends it, then what is watched."""

    def heat(t: float, y: Floats) -> float:
        progress("course in time", int(1000.0 * (t - begun) / (end - begun)), 1000)
        return HOTTEST - float(np.max(y[: len(law.nodes)])) - law.datum

    heat.terminal = True  # type: ignore[attr-defined]
    found: list[Callable[[float, Floats], float]] = [heat]
    for one in watched.values():

        def falling(t: float, y: Floats, one: Callable[[State, int], float] = one) -> float:
            return one(law.temperatures(y[:, None]), place)

        falling.direction = -1.0  # type: ignore[attr-defined]
        found.append(falling)
    return found


def _coming_to_rest(law: _Law, capacity: Floats, within: float) -> Callable[[float, Floats], float]:
    """Positive until the slowest mode has at most ``within`` [K] to go; ends the stretch."""

    def rest(t: float, y: Floats) -> float:
        network = law.network(y[:, None])
        kept = network.flows(law.temperatures(y[:, None]))[0][0]
        ahead = float(np.max(np.abs(kept / capacity))) * _slowest(network, capacity)
        return ahead - within

    rest.terminal = True  # type: ignore[attr-defined]
    rest.direction = -1.0  # type: ignore[attr-defined]
    return rest


def _moments(begun: float, end: float, count: int, wanted: Floats) -> Floats:
    """Times to store of one stretch: both ends, evenly and more closely after the jump."""
    length = end - begun
    half = max(count // 2, 1)
    even = begun + length * np.linspace(0.0, 1.0, half + 1)
    early = begun + length * np.geomspace(min(1e-3, 1.0 / length), 1.0, count - half + 1)[:-1]
    inside = wanted[(wanted > begun) & (wanted < end)]
    return np.unique(np.concatenate([[begun, end], even[1:-1], early, inside]))
