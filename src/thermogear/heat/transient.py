"""Thermal networks in time: collocation over the whole course, heat counted in and out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.bounds import BODY
from thermogear.base.errors import ConvergenceError, InputError, ThermogearError
from thermogear.base.progress import Progress, silent
from thermogear.heat.network import ThermalNetwork

State = Mapping[str, Floats]
"""Temperatures [K] of the free nodes by name, arrays (count,), and what else a law finds there."""

HOTTEST = 700.0
"""A node [K] that gets there ends the course: no gear lives there, and no law was made for it."""
_STAGES = np.array([1.0 / 3.0, 1.0])
_RADAU = np.array([[5.0 / 12.0, -1.0 / 12.0], [3.0 / 4.0, 1.0 / 4.0]])
"""Radau IIA with two stages: places in a step and weights of the rates there, order 3."""
_SLOWEST = 40.0
"""Time constants after which a course that does not settle is given up."""
_WINDOW = 12.0
"""Time constants that a stretch without end is first solved over: exp(-12) of 700 K is 4 mK."""
_LEAP = 60.0
"""Newton's corrections [K] are held below it."""
_TURNS, _ROUNDS = 20, 6
"""Newton's corrections at most, and meshes at most, before a window is made smaller."""
_SOLVED = 0.01
"""Part of the tolerance that Newton's next correction would have."""
_LAGS = 10.0
"""So much more may be left by what lags."""
_BEND = 5.0
"""Part of a step [K] that is cubic: a step that leaps to another steady state has more."""
_PROBED = 7
"""Moments of a stretch at which the law's own slopes are found."""
_SLOW = 0.1
"""Share of the last correction above which the slopes are found anew."""
_SHORTEST = 1e-4
"""Part of a stretch below which no window is made smaller."""
_ROUGH = 0.01
"""What Newton's next correction [K] may be where only the steps are to be drawn."""
_PROBE = 0.01
"""Change of a node [K] by which the law's own slopes are found."""


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """A stretch of time up to ``end`` [s] in which one law holds; inf: until it is steady.

    ``network``: temperatures of the free nodes, arrays (count,), to the network at them. The free
    nodes and their capacities are the same throughout; given temperatures may differ. ``lagging``:
    quantities of the state (count, any) that cost much and are smooth; they are asked for at the
    ends of every second step, and between them the network finds under "lagging" what they and
    their slopes say. ``given``: numbers by name that both laws find beside the temperatures.

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
    lagging: Callable[[State], Floats] | None = None
    given: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class _Window:
    """Steps between ``time`` (steps + 1,) that are solved together.

    ``ends`` (steps + 1, nodes + 2) and ``first`` (steps, nodes + 2): temperatures [K] of the free
    nodes, heat in and out [J] at the ends and at the first stages; ``slopes`` (steps + 1,
    nodes + 2) their rates at the ends; ``ahead`` (steps + 1,) how far [K] the steady state is;
    ``left`` [K]: Newton's correction that was left.
    """

    time: Floats
    ends: Floats
    first: Floats
    slopes: Floats
    ahead: Floats
    left: float

    def at(self, t: Floats) -> Floats:
        """The states at any times: cubics through both stages with the slope at the begin."""
        place = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, self.first.shape[0] - 1)
        h = np.diff(self.time)[place][:, None]
        s = (t - self.time[place])[:, None] / h
        begin = self.ends[place]
        middle, end = self.first[place] - begin, self.ends[place + 1] - begin
        slope = 4.5 * middle - 0.5 * end
        cubic = 3.0 * (h * self.slopes[place] - slope)
        parabola = slope + s * (end - slope)
        return np.asarray(begin + s * (parabola + cubic * (s - 1.0 / 3.0) * (s - 1.0)))

    def bend(self) -> Floats:
        """h^3 T'''/6 [K] of every step, (steps,): the cubic part of its course."""
        h, begin = np.diff(self.time)[:, None], self.ends[:-1]
        each = h * self.slopes[:-1] - 4.5 * (self.first - begin) + 0.5 * (self.ends[1:] - begin)
        return np.asarray(3.0 * np.abs(each[:, :-2]).max(axis=1))


@dataclass(frozen=True, eq=False, kw_only=True)
class Course:
    """Temperatures and heat over ``time`` [s], arrays (time,); a jump of the law is there twice.

    ``stretch``: place of the stretch each moment belongs to; ``temperatures`` [K] of the free
    nodes; ``heat_in`` set free by the sources, ``heat_out`` left through the given nodes and
    ``kept`` in the capacities, since the start [J]; ``imbalance`` = |kept - in + out| over the
    heat turned over; ``settled``: whether a last stretch without end came to rest; ``too_hot``: a
    node reached 700 K, which ends the course; ``evaluations`` of the laws, each at many moments
    together; ``error`` [K]: greatest one of a temperature, as estimated.
    """

    time: Floats
    stretch: NDArray[np.int64]
    temperatures: dict[str, Floats]
    heat_in: Floats
    heat_out: Floats
    kept: Floats
    imbalance: Floats
    settled: bool
    too_hot: bool
    evaluations: int
    error: float
    _windows: Sequence[tuple[int, _Window]] = field(repr=False)

    def falls(self, value: Callable[[State, int], Floats]) -> Floats:
        """When [s] a ``value`` of states (count,) and their stretch falls through 0."""
        found: list[float] = []
        for place, window in self._windows:

            def over(t: Floats, window: _Window = window, place: int = place) -> Floats:
                return value(dict(zip(self.temperatures, window.at(t).T, strict=False)), place)

            found += _falls(window.time, over)
        return np.array([t for t in found if t <= self.time[-1]])

    def at(self, times: ArrayLike) -> dict[str, Floats]:
        """Temperatures [K] of the free nodes at any ``times`` [s] of the course, their shape."""
        t = np.asarray(times, dtype=float)
        if not np.all((t >= 0.0) & (t <= self.time[-1])):
            raise InputError("times", f"{t} s", allowed=f"0..{self.time[-1]:g} s")
        y = _states([window for _, window in self._windows], t.ravel())
        return {name: y[:, i].reshape(t.shape) for i, name in enumerate(self.temperatures)}


def _states(windows: Sequence[_Window], t: Floats) -> Floats:
    """The states at any times of consecutive windows, (count, nodes + 2)."""
    place = np.searchsorted([window.time[-1] for window in windows[:-1]], t, side="left")
    y = np.empty((t.size, windows[0].ends.shape[1]))
    for k in np.unique(place):
        y[place == k] = windows[k].at(t[place == k])
    return y


def _flows(network: Callable[[State], ThermalNetwork], state: State) -> tuple[Floats, ...]:
    """Heat that free nodes keep, in and out [W], (count, nodes + 2); G [W/K] among the nodes."""
    found, y = network(state), state["as computed"]
    kept, source, out = found.flows(dict(zip(found.free, y.T, strict=True)))
    free = [found.nodes.index(name) for name in found.free]
    inner = found.laplacian()[..., free, :][..., :, free]
    return np.column_stack([kept, source, out]), np.broadcast_to(inner, (*y.shape, y.shape[1]))


@dataclass
class _Law:
    """Rates of the free nodes [K/s], then of heat in and out [W], and how they change.

    ``bent``: places [s], and there (places, nodes, nodes) [1/s] what the law's dependence on the
    temperatures adds to -G/C, kept from one solution to the next; ``steep``: places, and there
    (places, quantities, nodes) the slopes of what lags. ``seen``: times, the way [K] that the
    temperatures had gone by then, the ways at which it was asked for last, and the states and
    values there (asked, nodes + quantities); empty before.
    """

    stretch: Stretch
    nodes: tuple[str, ...]
    capacity: Floats
    calls: int = 0
    seen: tuple[Floats, ...] = field(init=False)

    def __post_init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """No slopes but those of the network."""
        count = self.capacity.size
        self.probed, self.seen = False, ()
        self.bent = np.zeros(1), np.zeros((1, count, count))
        self.steep = np.zeros(1), np.zeros((1, 1, count))

    def _state(self, y: Floats) -> dict[str, Floats]:
        """What the laws find: temperatures in which bodies can be, and what is given."""
        self.calls += 1
        held = np.clip(y, BODY.least, BODY.most)
        given = {name: np.full(len(y), value) for name, value in self.stretch.given.items()}
        return dict(zip(self.nodes, held.T, strict=True)) | given | {"as computed": y}

    def renew(self, t: Floats, y: Floats) -> None:
        """See what lags at every fourth and the last of the states ``y`` (count, nodes)."""
        if self.stretch.lagging is None:
            return
        some = np.unique(np.append(np.arange(0, len(t), 4), len(t) - 1))
        self._see(t, y, some, self.stretch.lagging(self._state(y[some])))

    def _see(self, t: Floats, y: Floats, some: NDArray[np.int64], values: Floats) -> None:
        """Keep ``values`` (some, quantities) over the way [K] that the temperatures have gone."""
        moved = np.abs(np.diff(y, axis=0)).max(axis=1).cumsum()
        # rising where nothing changes, too
        way = np.append(0.0, moved) + 1e-6 * (t - t[0])
        self.seen = t, way, way[some], np.hstack([y[some], values])

    def _lagging(self, t: Floats, y: Floats) -> Floats:
        """What lags at the states ``y`` of the times ``t``, from the values seen before.

        Cubic in the way that the temperatures went then, and by its slopes off that way.
        """
        when, way, at, seen = self.seen
        place, weight = _cubic(at, np.interp(t, when, way))
        along = np.einsum("ik,ikj->ij", weight, seen[place])
        beside = y - along[:, : self.capacity.size]
        off = np.einsum("ijk,ik->ij", _between(*self.steep, t), beside)
        return np.asarray(along[:, self.capacity.size :] + off)

    def rates(self, t: Floats, y: Floats, lagging: Floats | None = None) -> tuple[Floats, Floats]:
        """(rates, (count, nodes + 2); G/C [1/s], (count, nodes, nodes)) at ``y`` (count, nodes)."""
        state = self._state(y)
        if self.seen:
            state["lagging"] = self._lagging(t, y) if lagging is None else lagging
        flows, inner = _flows(self.stretch.network, state)
        return flows / np.append(self.capacity, [1.0, 1.0]), inner / self.capacity[:, None]

    def probe(self, t: Floats, y: Floats) -> None:
        """Find the slopes at the states ``y`` (count, nodes) of the times ``t``.

        Those of what lags once: what differs from them is asked for anew.
        """
        count, found = self.capacity.size, None
        steps = _PROBE * np.vstack([np.zeros(count), np.eye(count)])
        moved = (y[:, None] + steps).reshape(-1, count)
        if self.stretch.lagging is not None and not self.probed:
            found = self.stretch.lagging(self._state(moved))
            self.steep = t, _slopes(found, count)
            self._see(t, y, np.arange(t.size), found[:: count + 1])
        elif self.seen:
            beside = np.einsum("ijk,lk->ilj", _between(*self.steep, t), steps)
            found = (self._lagging(t, y)[:, None] + beside).reshape(len(moved), -1)
        rates, relaxing = self.rates(t, moved, found)
        self.probed = True
        self.bent = t, _slopes(rates[:, :count], count) + relaxing[:: count + 1]

    def slopes(self, t: Floats, relaxing: Floats) -> Floats:
        """d(rates)/dT [1/s] at the times ``t``, (count, nodes, nodes)."""
        return np.asarray(_between(*self.bent, t) - relaxing)


def _slopes(values: Floats, nodes: int) -> Floats:
    """Slopes (places, values, nodes) of ``values`` (places (nodes + 1), any) found by probing."""
    each = values.reshape(-1, nodes + 1, values.shape[1])
    return np.asarray(np.swapaxes(each[:, 1:] - each[:, :1], 1, 2) / _PROBE)


def _between(at: Floats, values: Floats, t: Floats) -> Floats:
    """``values`` (places, ...) at the times ``at``, straight between them and level outside."""
    if at.size == 1:
        return np.broadcast_to(values, (t.size, *values.shape[1:]))
    place = np.clip(np.searchsorted(at, t) - 1, 0, at.size - 2)
    part = np.clip((t - at[place]) / np.diff(at)[place], 0.0, 1.0)
    part = part.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray((1.0 - part) * values[place] + part * values[place + 1])


def _cubic(at: Floats, x: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Places among ``at`` and their weights for a cubic at each ``x``, (count, 4) at most."""
    width = min(4, at.size)
    first = np.clip(np.searchsorted(at, x) - width // 2, 0, at.size - width)
    place, own = first[:, None] + np.arange(width), np.eye(width, dtype=np.bool_)
    apart = np.where(own, 1.0, at[place][:, :, None] - at[place][:, None])
    reach = np.where(own, 1.0, np.clip(x, at[0], at[-1])[:, None, None] - at[place][:, None])
    return place, (reach / apart).prod(axis=2)


def _solved(
    law: _Law, begin: Floats, time: Floats, guess: Floats, *, goal: float, most: float
) -> _Window:
    """The steps between ``time`` from the state ``begin`` (nodes + 2,), all at once.

    Unknown are the temperatures at both stages of every step, ``guess`` (2 steps, nodes). Ended
    where Newton's next correction would be below ``goal`` [K], and the next one by what lags too,
    or after all turns where the last was below ``most`` [K]: a law that jumps lets it get no
    nearer.
    """
    count, h = law.capacity.size, np.diff(time)
    when, known = _stages(time), begin[None, :count]
    lags = law.stretch.lagging is not None
    first = 2 if lags else 0
    y, seen, size, left, probed, by_lag = guess, guess, np.inf, np.inf, 0, np.inf if lags else 0.0
    for turn in range(_TURNS):
        fresh = lags and (not law.seen or not law.probed or left <= goal)
        if fresh:
            size, seen = float(np.abs(y - seen).max()), y
            law.renew(np.append(time[0], when), np.concatenate([known, y]))
        rates, relaxing = law.rates(np.append(time[0], when), np.concatenate([known, y]))
        gains = np.einsum("k,ij,kjn->kin", h, _RADAU, rates[1:].reshape(h.size, 2, -1))
        starts = np.concatenate([known, y[1:-1:2]])
        residual = (starts[:, None] + gains[..., :count]).reshape(y.shape) - y
        move = _correction(h, residual, law.slopes(when, relaxing[1:]))
        last, size = size, float(np.abs(move).max())
        y = y + np.clip(move, -_LEAP, _LEAP)
        left = size * (size / last if turn and size < last else 1.0)
        by_lag = left if fresh else by_lag
        if max(left, by_lag / _LAGS) <= goal or (turn == _TURNS - 1 and size <= most):
            heat = np.vstack([begin[count:], gains[:, 1, count:]]).cumsum(axis=0)
            # a rate slower than any course: the system has a solution where nothing leads back, too
            slopes = law.slopes(time, relaxing[::2]) - 1e-15 * np.eye(count)
            ahead = np.linalg.solve(slopes, rates[::2, :count, None])
            return _Window(
                time=time,
                ends=np.hstack([np.concatenate([known, y[1::2]]), heat]),
                first=np.hstack([y[::2], heat[:-1] + gains[:, 0, count:]]),
                slopes=rates[::2],
                ahead=np.abs(ahead).max(axis=(1, 2)),
                left=max(left if left <= goal else size, by_lag),
            )
        slow = not fresh and turn - probed > 1 and size > _SLOW * last
        if slow or (turn >= first and not law.probed):
            probed = turn
            places = h.size if lags and law.probed else _PROBED
            chosen = np.unique(np.linspace(0, h.size - 1, places).round().astype(int))
            law.probe(when[1::2][chosen], y[1::2][chosen])
    raise ConvergenceError(
        f"thermal network at {time[0]:.6g} s: Newton's last correction was {size:.3g} K"
    )


def _stages(time: Floats) -> Floats:
    """Times of both stages of every step, (2 steps,)."""
    return np.asarray((time[:-1, None] + np.diff(time)[:, None] * _STAGES).ravel())


def _correction(h: Floats, residual: Floats, slopes: Floats) -> Floats:
    """Newton's correction of all stages, (2 steps, nodes), from their ``residual``.

    The linear system is bidiagonal in blocks of one step: each block is solved by itself, for its
    own residual and for a change of its begin, then they are joined one after the other.
    """
    steps, count = h.size, residual.shape[1]
    whole = 2 * count
    each = slopes.reshape(steps, 2, count, count)
    blocks = np.einsum("k,ij,kjmn->kimjn", h, _RADAU, each).reshape(steps, whole, whole)
    carried = np.broadcast_to(np.tile(np.eye(count), (2, 1)), (steps, whole, count))
    right = np.concatenate([residual.reshape(steps, whole, 1), carried], axis=-1)
    apart = np.linalg.solve(np.eye(whole) - blocks, right)
    step, before = apart[..., 0].copy(), np.zeros(count)
    for k in range(steps):
        step[k] += apart[k, :, 1:] @ before
        before = step[k, count:]
    return step.reshape(residual.shape)


def _window(law: _Law, begin: Floats, time: Floats, tolerance: float) -> tuple[_Window, float]:
    """The steps from ``begin`` on a mesh that keeps the ``tolerance`` [K], and the error [K].

    Every mesh is halved: for a method of order 3 the finer solution errs by a seventh of the
    difference at the ends of its steps. A third is taken, as between them the cubic errs more, and
    what Newton left is added. Where
    that is too much a mesh is drawn anew, on which all steps have the same cubic part.
    """
    error, steps, count = np.inf, time.size - 1, law.capacity.size
    solved = partial(_solved, law, begin, goal=_SOLVED * tolerance, most=tolerance)
    guess = np.broadcast_to(begin[:count], (2 * steps, count))
    found = solved(time, guess, goal=max(_ROUGH, _SOLVED * tolerance))
    for _ in range(_ROUNDS):
        coarse_time = _drawn(found.time, found.bend(), steps)
        time = np.sort(np.append(coarse_time, 0.5 * (coarse_time[1:] + coarse_time[:-1])))
        coarse = solved(coarse_time, found.at(_stages(coarse_time))[:, :count])
        found = solved(time, coarse.at(_stages(time))[:, :count])
        error = float(np.abs(coarse.at(time) - found.ends)[:, :count].max()) / 3.0 + found.left
        if error <= tolerance and found.bend().max() <= _BEND:
            return found, error
        steps = int(np.ceil(steps * np.clip(1.2 * np.cbrt(error / tolerance), 1.3, 4.0)))
    raise ConvergenceError(
        f"thermal network at {time[0]:.6g} s: the error stays at {error:.3g} K in "
        f"{time.size - 1} steps; allowed {tolerance:g} K"
    )


def _drawn(time: Floats, bend: Floats, steps: int) -> Floats:
    """As many ``steps`` over the same ``time``, each of about the same cubic part."""
    weight = np.cbrt(bend)
    weight = np.maximum(weight, 0.2 * weight.mean() + 1e-12)
    # a step may not be much longer than its neighbours
    beside = np.maximum(np.append(weight[1:], 0.0), np.append(0.0, weight[:-1]))
    along = np.append(0.0, np.cumsum(np.maximum(weight, 0.5 * beside)))
    return np.interp(np.linspace(0.0, along[-1], steps + 1), along, time)


def _first_mesh(begun: float, end: float, relaxing: Floats) -> Floats:
    """Steps [s] that double, from half the shortest time constant or an eighth of all."""
    first = min((end - begun) / 8.0, 0.5 / np.diagonal(relaxing[0]).max())
    count = int(np.ceil(np.log2(1.0 + (end - begun) / first)))
    grown = (2.0 ** np.arange(count + 1) - 1.0) / (2.0**count - 1.0)
    # both ends to the last bit
    return np.asarray(begun * (1.0 - grown) + end * grown)


_Followed = tuple[list[_Window], float, float, bool, bool]
"""Windows of a stretch, when [s] it is left, greatest error [K], whether settled, or too hot."""


def _stretch(
    law: _Law, y: Floats, begun: float, tolerance: float, within: float, progress: Progress
) -> _Followed:
    """The windows of a stretch one after the other, from the state ``y``.

    The whole stretch first; a quarter of it where that fails.
    """
    end = law.stretch.end
    law.renew(np.array([begun]), y[None, :-2])
    _, relaxing = law.rates(np.array([begun]), y[None, :-2])
    length = end - begun
    if not np.isfinite(end):
        # similar to a symmetric matrix
        slowest = 1.0 / float(np.linalg.eigvals(relaxing).real.min())
        end, length = begun + _SLOWEST * slowest, _WINDOW * slowest
    windows: list[_Window] = []
    first, shortest, worst = begun, _SHORTEST * length, 0.0
    settled = too_hot = False
    while begun < end and not (settled or too_hot):
        progress("course in time", int(1000.0 * (begun - first) / (end - first)), 1000)
        stop = begun + length if begun + (1.0 + 1e-9) * length < end else end
        try:
            mesh = _first_mesh(begun, stop, relaxing)
            law.forget()
            window, error = _window(law, y, mesh, tolerance)
        except ThermogearError:
            if length <= shortest:
                raise
            length = 0.25 * length
            continue
        windows.append(window)
        begun, settled, too_hot = _stop(window, law.stretch.end, within)
        y, length, worst = window.ends[-1], 4.0 * length, max(worst, error)
    progress("course in time", 1000, 1000)
    return windows, begun, worst, settled, too_hot


def follow(
    stretches: Sequence[Stretch],
    start: Mapping[str, float],
    *,
    times: ArrayLike = (),
    moments: int = 60,
    tolerance: float = 1e-3,
    settled_within: float = 0.01,
    progress: Progress = silent,
) -> Course:
    """Temperatures of a network whose conductances and sources depend on them, over time.

    C dT/dt = q(T) - G(T) T by collocation at the two Radau points of every step (order 3): all
    steps of a stretch are one system, which Newton's method solves with the network asked at all
    of them together. Steps are halved until the error, a third of what that changes, is below
    ``tolerance`` [K] everywhere. Where that fails the stretch is solved in shorter windows. Heat in
    and out are integrated by the same rule, so that the balance closes if every flow is counted.

    ``stretches`` one after the other from time 0; ``start`` [K] of every free node; ``times`` [s]
    to be stored with some ``moments`` of each stretch; a stretch without end runs until its steady
    state is no more than ``settled_within`` [K] away. Raises InputError for stretches that do not
    follow each other, and ConvergenceError where the steps fail.

    >>> from thermogear.heat.network import Link
    >>> network = ThermalNetwork(
    ...     (Link("oil", "ambient", 10.0),), sources={"oil": 200.0}, fixed={"ambient": 293.15},
    ...     capacities={"oil": 6000.0},
    ... )
    >>> course = follow([Stretch(end=600.0, network=lambda state: network)], {"oil": 293.15})
    >>> f"{course.temperatures['oil'][-1] - 293.15:.1f} K"
    '12.6 K'
    """
    if not tolerance > 0.0:
        raise InputError("tolerance", f"{tolerance} K", allowed="> 0 K")
    ends = np.array([one.end for one in stretches])
    if not ends.size or not np.all(np.diff(np.concatenate([[0.0], ends])) > 0.0):
        raise InputError("stretches", f"ends {ends} s", allowed="one or more, rising from 0 s")
    at = {name: np.array([float(t)]) for name, t in start.items()}
    at |= {name: np.array([value]) for name, value in stretches[0].given.items()}
    if stretches[0].lagging is not None:
        at["lagging"] = stretches[0].lagging(at)
    first = stretches[0].network(at)
    wanted = np.unique(np.asarray(times, dtype=float))
    return _course(
        stretches,
        np.array([*(float(start[name]) for name in first.free), 0.0, 0.0]),
        first.free,
        _capacities(first),
        moments=lambda begun, end: _moments(begun, end, moments, wanted),
        followed=partial(_stretch, tolerance=tolerance, within=settled_within, progress=progress),
    )


def _course(
    stretches: Sequence[Stretch],
    y: Floats,
    nodes: tuple[str, ...],
    capacity: Floats,
    *,
    moments: Callable[[float, float], Floats],
    followed: Callable[..., _Followed],
) -> Course:
    """One course from the state ``y`` (nodes + 2,)."""
    windows: list[tuple[int, _Window]] = []
    stored: list[tuple[int, Floats]] = []
    stop, calls, error = 0.0, 1, 0.0
    for place, stretch in enumerate(stretches):
        law, begun = _Law(stretch, nodes, capacity), stop
        parts, stop, worst, settled, too_hot = followed(law, y, begun)
        windows += [(place, window) for window in parts]
        y, error = parts[-1].ends[-1], max(error, worst)
        calls += law.calls
        stored.append((place, moments(begun, stop)))
        if too_hot:
            break
    time = np.concatenate([t for _, t in stored])
    states = _states([window for _, window in windows], time)
    heat_in, heat_out = states[:, -2], states[:, -1]
    kept = (states[:, :-2] - states[0, :-2]) @ capacity
    turned = heat_in + np.abs(heat_out) + np.abs(kept)
    left = np.abs(kept - heat_in + heat_out)
    return Course(
        time=time,
        stretch=np.concatenate([np.full(t.size, place) for place, t in stored]),
        temperatures={name: states[:, i] for i, name in enumerate(nodes)},
        heat_in=heat_in,
        heat_out=heat_out,
        kept=kept,
        imbalance=np.divide(left, turned, out=np.zeros_like(left), where=turned > 0.0),
        settled=settled,
        too_hot=too_hot,
        evaluations=calls,
        error=error,
        _windows=windows,
    )


def _stop(window: _Window, end: float, within: float) -> tuple[float, bool, bool]:
    """(When [s] a window is left, whether it came to rest before, whether it got too hot)."""
    t = window.time
    hot = _falls(t, lambda when: HOTTEST - window.at(when)[:, :-2].max(axis=1))
    stop = min([float(t[-1]), *hot])
    if not np.isfinite(end):
        ahead = np.log(np.maximum(window.ahead / within, 1e-300))
        # at rest from the start: about one time constant of it
        still = [float(t[0] + (t[-1] - t[0]) / _WINDOW)] * int(ahead[0] <= 0.0)
        rest = still + _falls(t, lambda when: np.interp(when, t, ahead))
        if rest and rest[0] <= stop:
            return rest[0], True, False
    return stop, False, bool(hot)


def _falls(time: Floats, value: Callable[[Floats], Floats]) -> list[float]:
    """When [s] a ``value`` over time falls through 0, looked for between the ends of steps."""
    found, seen = [], value(time)
    for k in np.flatnonzero((seen[:-1] > 0.0) & (seen[1:] <= 0.0)):
        t, v = time[k : k + 2], seen[k : k + 2]
        for _ in range(3):
            t = np.linspace(t[0], t[1], 9)
            v = value(t)
            place = max(int(np.argmax(v <= 0.0)), 1)
            t, v = t[place - 1 : place + 1], v[place - 1 : place + 1]
        found.append(float(t[0] + (t[1] - t[0]) * v[0] / (v[0] - v[1])))
    return found


def _capacities(network: ThermalNetwork) -> Floats:
    missing = [name for name in network.free if name not in network.capacities]
    if missing:
        raise InputError("capacity of", ", ".join(missing), why="the course in time needs it")
    return np.array([network.capacities[name] for name in network.free], dtype=float)


def _moments(begun: float, end: float, count: int, wanted: Floats) -> Floats:
    """Times to store of one stretch: both ends, evenly and more closely after the jump."""
    length = end - begun
    half = max(count // 2, 1)
    even = begun + length * np.linspace(0.0, 1.0, half + 1)
    early = begun + length * np.geomspace(min(1e-3, 1.0 / length), 1.0, count - half + 1)[:-1]
    inside = wanted[(wanted > begun) & (wanted < end)]
    return np.unique(np.concatenate([[begun, end], even[1:-1], early, inside]))
