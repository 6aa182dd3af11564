"""Motions of a pair over its turn at many speeds: fixed steps, until one turn repeats another.

A turn of many mesh periods is long against the time in which a vibration dies out, so that a run
which begins that time ahead of the turn repeats it at once, wherever one motion exists. No orbit
is proven: two turns, or groups of them, agree at their ends.
Checked by ``tests/dynamics/test_turns.py``: event-exact orbits of the same tables, and the closed
form of a pair that never parts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Complexes, Floats
from thermogear.dynamics.kernels.turns import advance_parts, advance_turn

STEPS = 192
"""Least steps in a mesh period: eight in a period of its 24th harmonic; an edge of the backlash is
met within one."""
LONGEST_STEP = 0.25
"""Of a step, in radians of the natural frequency: Runge and Kutta lose 1e-5 of an amplitude in a
cycle of it."""
DIED_OUT = 1e-7
"""Part of a vibration that is left when the turn begins."""
SAME = 1e-6
"""Half backlashes between the ends of two turns in a row that repeat each other."""
CLOSE = 1e-4
"""Half backlashes between the ends of cycles that repeat each other, and come no farther apart:
several turns return so near by chance in about one of a thousand."""
LONGEST_CYCLE = 8
"""Turns after which a motion may repeat itself."""
MOST_MESH_PERIODS = 4096
"""Followed at most, but :data:`LEAST_TURNS` turns at least."""
LEAST_TURNS = 4


@dataclass(frozen=True, eq=False, kw_only=True)
class TurnTables:
    """What all speeds of a pair share: Fourier coefficients over the turn, the mean first.

    ``stiffness`` k over its mean, ``error`` e in half backlashes; ``mesh_periods`` in a turn, of
    which the tables begin at the one of number ``first``.
    """

    stiffness: Complexes
    error: Complexes
    mesh_periods: int
    first: int = 0
    _sampled: dict[int, tuple[Floats, Floats, Floats]] = field(default_factory=dict, init=False)

    def from_greatest(self) -> TurnTables:
        """The same turn begun at the mesh period whose error is greatest at its phase 0.

        So a run begins at the same teeth however they are numbered.
        """
        error = _series(self.error, STEPS * self.mesh_periods)[::STEPS]
        first = int(np.argmax(error))
        stiffness, error = (
            row * np.exp(2j * np.pi * first / self.mesh_periods * np.arange(row.size))
            for row in (self.stiffness, self.error)
        )
        return TurnTables(
            stiffness=stiffness, error=error, mesh_periods=self.mesh_periods, first=first
        )

    def sampled(self, steps: int) -> tuple[Floats, Floats, Floats]:
        """k and e'' (phase in turns) at half steps, e at the ``steps`` of every mesh period."""
        if steps not in self._sampled:
            count = steps * self.mesh_periods
            ranks = np.arange(self.error.size)
            bend = self.error * (2j * np.pi * ranks) ** 2
            self._sampled[steps] = (
                _series(self.stiffness, 2 * count), _series(bend, 2 * count),
                _series(self.error, count),
            )  # fmt: skip
        return self._sampled[steps]


def longest(mesh_periods: int) -> int:
    """How many mesh periods a motion over a turn of so many is followed.

    >>> longest(40), longest(1890)
    (4080, 7560)
    """
    return max(LEAST_TURNS, MOST_MESH_PERIODS // mesh_periods) * mesh_periods


def _series(coefficients: Complexes, count: int) -> Floats:
    """A Fourier series at ``count`` uniform phases, more than twice its harmonics."""
    half = 0.5 * coefficients
    half[0] = coefficients[0].real
    return np.asarray(np.fft.irfft(half, count) * count)


@dataclass(frozen=True, eq=False, kw_only=True)
class TurnMotions:
    """One entry per run: ``period`` in turns (0: none was seen), ``state`` (run, 2) at phase 0,
    ``followed`` mesh periods, and over its cycle, or the later half of what was followed where
    none was seen: greatest and least force k f over the mean stiffness, greatest and least x + e,
    share of time out of drive-side contact.
    """

    period: NDArray[np.int32]
    state: Floats
    followed: NDArray[np.int32]
    force: Floats
    travel: Floats
    lost: Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class TurnLanes:
    """Speeds of one pair, (lane,): x'' + ``damping`` x' + k f(x; ``backlash``) = ``mean`` - e''.

    Time in 1/omega_n, lengths in half backlashes of the cold pair; ``period`` of a turn.
    """

    mean: Floats
    damping: Floats
    backlash: Floats
    period: Floats

    def take(self, index: NDArray[np.intp]) -> TurnLanes:
        """Some of the lanes."""
        return TurnLanes(**{name: values[index] for name, values in vars(self).items()})


def follow_turns(
    tables: TurnTables, lanes: TurnLanes, start: Floats, *, carried: bool = False
) -> TurnMotions:
    """What each lane settles on from ``start`` (lane, 2), held ahead of the turn.

    The run begins as long ahead of phase 0 as a vibration takes to fall to :data:`DIED_OUT`; where
    it is ``carried`` on from another motion, at phase 0 with that motion's state there. It ends
    where two turns in a row end within :data:`SAME`, or where the states at phase 0 are those of up
    to :data:`LONGEST_CYCLE` turns before, a cycle long.
    """
    count, mesh = lanes.mean.size, tables.mesh_periods
    out = TurnMotions(
        period=np.zeros(count, np.int32),
        followed=np.zeros(count, np.int32),
        state=np.array(start, dtype=float),
        force=np.full((count, 2), np.nan),
        travel=np.full((count, 2), np.nan),
        lost=np.full(count, np.nan),
    )
    doublings = _doublings(lanes, mesh)
    for power in np.unique(doublings):
        index = np.flatnonzero(doublings == power)
        _follow(tables, STEPS * 2 ** int(power), lanes.take(index), index, out, carried=carried)
    return out


def _doublings(lanes: TurnLanes, mesh_periods: int) -> NDArray[np.int64]:
    """Steps of a mesh period are :data:`STEPS` doubled so often, so that few tables are made."""
    needed = lanes.period / (LONGEST_STEP * mesh_periods * STEPS)
    return np.asarray(np.ceil(np.log2(np.maximum(needed, 1.0))).astype(int))


def _follow(
    tables: TurnTables, steps: int, lanes: TurnLanes, index: NDArray[np.intp], out: TurnMotions,
    *, carried: bool,
) -> None:  # fmt: skip
    """``lanes``, with so many steps a mesh period, into the entries ``index`` of ``out``."""
    mesh = tables.mesh_periods
    turn = steps * mesh
    decay = 2.0 * math.log(1.0 / DIED_OUT) / np.maximum(lanes.damping, 1e-9)
    ahead = float((decay / lanes.period).max()) * mesh
    first = 0 if carried else math.ceil(min(max(ahead, 1.0), MOST_MESH_PERIODS)) * steps
    most = longest(mesh) // mesh
    state = out.state[index].T.copy()
    ends, felt = np.empty((most + 1, 2, index.size)), np.empty((most, 5, index.size))
    active = np.arange(index.size)

    def run(begin: int, count: int) -> Floats:
        moved = state[:, active]
        seen = _advance(tables.sampled(steps), lanes.take(active), moved, begin, count)
        state[:, active] = moved
        return seen

    run(-first % turn, first)
    ends[0] = state
    for number in range(most):
        felt[number][:, active] = run(0, turn)
        ends[number + 1][:, active] = state[:, active]
        cycle = _cycle(ends[: number + 2][:, :, active] / lanes.backlash[active])
        seen = cycle > 0 if number + 1 < most else np.ones(active.size, bool)
        for length in np.unique(cycle[seen]):
            rows = active[seen & (cycle == length)]
            span = length or most // 2
            _keep(out, index[rows], felt[number + 1 - span : number + 1][:, :, rows], turn)
            out.period[index[rows]] = length
        out.state[index[active]] = state[:, active].T
        out.followed[index[active]] = first // steps + (number + 1) * mesh
        active = active[cycle == 0]
        if not active.size:
            return


def _advance(
    sampled: tuple[Floats, Floats, Floats], lanes: TurnLanes, state: Floats, begin: int,
    count: int, path: Floats | None = None,
) -> Floats:  # fmt: skip
    """What lanes of ``state`` (2, lane), moved in place, feel in ``count`` steps from ``begin``."""
    seen = np.tile([[-np.inf], [np.inf], [-np.inf], [np.inf], [0.0]], lanes.mean.size)
    advance_turn(
        *sampled, lanes.mean, -1.0 / lanes.period**2, lanes.damping, lanes.backlash,
        lanes.period / sampled[2].size, begin, count, state[0], state[1], seen,
        np.empty((0, lanes.mean.size)) if path is None else path,
    )  # fmt: skip
    return seen


def record_turns(
    tables: TurnTables, lane: TurnLanes, state: Floats, *, turns: int, samples: int
) -> tuple[Floats, Floats, Floats]:
    """One motion over so many turns from mesh period 0 of the gears on, which it meets first.

    ``state`` (2,) where the ``tables`` begin; ``samples`` of a mesh period divide :data:`STEPS`.
    The state there, x (sample,), and figures (5,): greatest and least k f, greatest and least
    x + e, share of time out of drive-side contact.
    """
    steps = STEPS * 2 ** int(_doublings(lane, tables.mesh_periods)[0])
    moved, sampled = state[:, None].copy(), tables.sampled(steps)
    begin = -tables.first % tables.mesh_periods * steps
    _advance(sampled, lane, moved, 0, begin)
    met = moved[:, 0].copy()
    count = turns * sampled[2].size
    path = np.empty((count // steps * samples, 1))
    seen = _advance(sampled, lane, moved, begin, count, path)
    seen[4] /= count
    return met, path[:, 0], seen[:, 0]


def _cycle(ends: Floats) -> NDArray[np.int32]:
    """After how many turns each lane repeats itself, 0: not yet; ``ends`` (turn, 2, lane)."""
    cycle = np.zeros(ends.shape[2], np.int32)
    for length in range(min((len(ends) - 1) // 2, LONGEST_CYCLE), 0, -1):
        gap = np.abs(ends[-length - 1 :] - ends[-2 * length - 1 : -length]).max(axis=1)
        cycle[(gap.max(axis=0) < CLOSE) & (gap[-1] <= gap[0])] = length
    cycle[np.abs(ends[-1] - ends[-2]).max(axis=0) < SAME] = 1
    return cycle


def _keep(out: TurnMotions, rows: NDArray[np.intp], felt: Floats, turn: int) -> None:
    """Figures over turns ``felt`` (turn, figure, lane)."""
    out.force[rows] = np.stack([felt[:, 0].max(axis=0), felt[:, 1].min(axis=0)], axis=1)
    out.travel[rows] = np.stack([felt[:, 2].max(axis=0), felt[:, 3].min(axis=0)], axis=1)
    out.lost[rows] = felt[:, 4].mean(axis=0) / turn


PART_STEPS = 96
"""Steps in a mesh period of a part of a series: four in a period of its 24th harmonic."""
SLOWEST_PART = 0.05
"""Mesh over natural frequency below which no part is followed: a step is there 1.3 radians of the
natural frequency, and from 2.7 on it is unstable."""
PART_DIED_OUT = 1e-4
"""Part of a vibration that is left when figures of parts begin."""
REPEATED = 1e-3
"""Static deflections between the ends of turns of a part that repeat each other: so much of the
dynamic factor."""
MOST_PART_PERIODS = 192
"""Mesh periods of a part that does not repeat itself, up to :data:`LONGEST_CYCLE` turns and two at
least."""
ALIKE = 0.01
"""Relative difference of greatest forces up to which the motions of two starts are one (chosen: ten
times what :data:`REPEATED` leaves; a second motion differs by tens of percent)."""
UNBOUNDED = 100.0
"""Force over its mean from which a motion that does not repeat itself counts as growing without end
(chosen: flanks that hammer stay below some tens)."""
FAR_THROW = 3.0
"""Static deflections from which the second run of a part begins, the first from one."""
_WIDTH = 32  # parts are filled up to a multiple of it: the same code, and digits, for each


@dataclass(frozen=True, eq=False, kw_only=True)
class PartTables:
    """What each part of a series makes of the mesh, one part beside another.

    ``table`` [half step, 3, part]: k over its mean, e and its slope a mesh period, in any length,
    of ``ahead`` and then ``mesh_periods`` mesh periods, their last end included; ``periodic``:
    whether those are a turn, which comes again (with none ahead).
    """

    table: Floats
    mesh_periods: int
    ahead: int = 0
    periodic: bool = True

    @classmethod
    def of(
        cls, *, stiffness: Floats, error: Floats, mesh_periods: int, harmonics: int, ahead: int = 0,
        periodic: bool = True,
    ) -> PartTables:  # fmt: skip
        """Of uniform samples (part, phase) over all mesh periods, so many ``harmonics`` of each.

        Where they are no turn the error is straightened by a line through the ends of its
        periods, so that its series has no step there.
        """
        every = mesh_periods + ahead
        size, steps = stiffness.shape[1] // every, 2 * PART_STEPS * every
        rise = np.zeros((len(error), 1)) if periodic else error[:, -size:].mean(axis=1)[:, None]
        if not periodic:
            rise = (rise - error[:, :size].mean(axis=1)[:, None]) / max(every - 1, 1)
        straight = error - rise * np.arange(error.shape[1]) / size
        orders = np.arange(1 + min(harmonics * every, (stiffness.shape[1] - 1) // 2))
        table = np.empty((steps + 1, 3, len(error)))
        for row, samples, slope in ((0, stiffness, 0), (1, straight, 0), (2, straight, 1)):
            kept = np.fft.rfft(samples, axis=1)[:, : orders.size] / samples.shape[1]
            kept *= (2j * np.pi * orders / every) ** slope
            table[:-1, row] = (np.fft.irfft(kept, steps, axis=1) * steps).T
        table[:-1, 1] += (rise * np.arange(steps) / (2 * PART_STEPS)).T
        table[:-1, 2] += rise.T
        table[-1] = table[0] if periodic else table[-2]
        return cls(table=table, mesh_periods=mesh_periods, ahead=ahead, periodic=periodic)

    def take(self, index: slice | NDArray[np.intp]) -> PartTables:
        """Some of the parts."""
        whole = np.arange(self.table.shape[2])
        if np.array_equal(whole[index], whole):
            return self
        return replace(self, table=np.ascontiguousarray(self.table[:, :, index]))


@dataclass(frozen=True, eq=False, kw_only=True)
class PartMotions:
    """(part, speed) each: greatest and least force k f over the mean stiffness [length], share of
    time out of drive-side contact, and whether the motion repeats itself.

    The worse of what two starts lead to: static contact, and :data:`FAR_THROW` times as deep.
    ``alike``: both end on one motion, which repeats itself.
    """

    greatest: Floats
    least: Floats
    lost: Floats
    repeats: NDArray[np.bool_]
    alike: NDArray[np.bool_]


def follow_parts(
    tables: PartTables, *, rate: Floats, damping_ratio: Floats, backlash: Floats, load: Floats
) -> PartMotions:
    """Motions of each part, by fixed steps, at several speeds.

    x'' + 2 g x' + s k f(x; b) = s ``load`` - e'', in mesh periods: s = ``rate``^2, g =
    ``damping_ratio`` ``rate``; ``rate`` (part, speed) 2 pi times the natural over the mesh
    frequency; ``damping_ratio``, ``backlash`` b and ``load``
    (part,) [length]. Each run begins so far ahead that
    :data:`PART_DIED_OUT` of a vibration is left. A turn is followed until its end is that of one
    of up to :data:`LONGEST_CYCLE` turns before; figures are of that cycle, or of the later half of
    all turns. Of mesh periods that are no turn figures are of what is left behind the time ahead,
    and a motion repeats itself where both starts end alike.
    """
    parts = len(rate)
    fill = np.resize(np.arange(parts), -(-parts // _WIDTH) * _WIDTH)
    tables = tables.take(fill)
    each = np.tile(rate.T[:, fill], (2, 1))
    damping = damping_ratio[fill] * each
    ahead = np.ceil(math.log(1.0 / PART_DIED_OUT) / damping.min(axis=1)).astype(int)
    order = np.argsort(-ahead, kind="stable")
    throw = np.repeat([1.0, FAR_THROW], len(each) // 2)
    s, g = each**2, damping
    grown = np.exp(0.5 * g / PART_STEPS)
    edge, deep = (np.broadcast_to(values[fill], s.shape) for values in (backlash, load))
    lanes = np.stack([s, 2.0 * g, g * g, grown, 1.0 / grown, edge, deep], axis=1)
    run = _PartRun(tables, lanes[order], throw[order], ahead[order])
    felt, repeats = run.settled()
    back = np.argsort(order)
    if not tables.periodic:
        shallow, far = np.split(run.state[back], 2)
        alike = _apart(shallow, far, lanes[: len(lanes) // 2]) < REPEATED
        repeats = np.tile(alike, (2, 1))[order]
    from_shallow, from_far = np.split(felt[back][..., :parts], 2)
    worst, least = np.maximum(from_shallow, from_far), np.minimum(from_shallow, from_far)[:, 1]
    both = np.logical_and(*np.split(repeats[back][..., :parts], 2))
    alike = both & np.isclose(from_shallow[:, 0], from_far[:, 0], rtol=ALIKE, atol=0.0)
    return PartMotions(
        greatest=worst[:, 0].T, least=least.T, lost=worst[:, 2].T, repeats=both.T, alike=alike.T
    )


def _apart(state: Floats, another: Floats, lanes: Floats) -> Floats:
    """How far two states are apart, in static deflections, (row, part)."""
    gap = np.abs(state - another)
    gap = np.maximum(gap[:, 0], gap[:, 1] / np.sqrt(lanes[:, 0]))
    return np.asarray(gap / lanes[:, 6])


def _together(felt: Sequence[Floats]) -> Floats:
    """The greatest, the least and the mean share of several turns."""
    every = np.stack(felt)
    return np.stack(
        [every[:, :, 0].max(axis=0), every[:, :, 1].min(axis=0), every[:, :, 2].mean(axis=0)],
        axis=1,
    )


class _PartRun:
    """The rows of :func:`follow_parts`, a start and a speed each, the longest ahead first."""

    def __init__(
        self, tables: PartTables, lanes: Floats, throw: Floats, ahead: NDArray[np.int64]
    ) -> None:
        self.tables, self.lanes = tables, lanes
        mesh = tables.mesh_periods
        most = MOST_MESH_PERIODS if tables.periodic else tables.ahead + mesh // 2
        ahead = np.clip(ahead, 1, most)
        begin = -ahead if tables.periodic else np.maximum(-ahead, -tables.ahead)
        seen_from = begin + ahead
        self.state = np.zeros((len(lanes), 3, lanes.shape[2]))
        felt = self._nothing()
        self.ends = []
        for number in range(begin[0], mesh):
            new = np.flatnonzero(begin == number)
            self._place(number, new, throw[new])
            if number == 0:
                self.ends.append(self.state.copy())
            active = int(np.count_nonzero(begin <= number))
            quiet = int(np.count_nonzero(seen_from[:active] > number))
            self._over(number, np.arange(quiet), None)
            self._over(number, np.arange(quiet, active), felt)
        self.ends.append(self.state.copy())
        self.felt = [self._shares(felt, mesh - seen_from)]

    def settled(self) -> tuple[Floats, NDArray[np.bool_]]:
        """What each row feels, (row, 3, part), and whether it repeats itself, (row, part)."""
        mesh = self.tables.mesh_periods
        most = min(max(2, MOST_PART_PERIODS // mesh), LONGEST_CYCLE) if self.tables.periodic else 1
        repeats = np.zeros(self.state[:, 0].shape, bool)
        known = self.felt[0]
        while True:
            for length in range(1, len(self.ends)):
                apart = _apart(self.ends[-1], self.ends[-1 - length], self.lanes)
                new = ~repeats & (apart < REPEATED)
                known = np.where(new[:, None], _together(self.felt[-length:]), known)
                repeats |= new
            rows = np.flatnonzero(~repeats.all(axis=1))
            if len(self.felt) >= most or not rows.size:
                later = _together(self.felt[len(self.felt) // 2 :])
                return np.where(repeats[:, None], known, later), repeats
            felt = self._nothing()
            for number in range(mesh):
                self._over(number, rows, felt)
            self.ends.append(self.state.copy())
            self.felt.append(self._shares(felt, mesh))

    def _nothing(self) -> Floats:
        """Greatest and least force and loss (row, 3, part) before anything is felt."""
        felt = np.zeros_like(self.state)
        felt[:, 0], felt[:, 1] = -np.inf, np.inf
        return felt

    def _shares(self, felt: Floats, periods: ArrayLike) -> Floats:
        """``felt`` with a share of the time of so many mesh periods."""
        felt[:, 2] /= 2.0 * PART_STEPS * np.reshape(periods, (-1, 1))
        return felt

    def _table(self, number: int) -> Floats:
        """Of the mesh period of that ``number``, both ends included."""
        place = number % self.tables.mesh_periods if self.tables.periodic else number
        first = 2 * PART_STEPS * (place + self.tables.ahead)
        return self.tables.table[first : first + 2 * PART_STEPS + 1]

    def _place(self, number: int, rows: NDArray[np.intp], throw: Floats) -> None:
        """``rows`` in contact, ``throw`` static deflections deep, at rest against the flanks."""
        stiffness, error, slope = self._table(number)[0]
        scale, double, _, _, _, edge, load = np.moveaxis(self.lanes[rows], 1, 0)
        deep = throw[:, None] * load
        x = error + edge + deep
        force = scale * (load - stiffness * deep)
        self.state[rows] = np.stack([x, slope + 0.5 * double * x, force + double * slope], axis=1)

    def _over(self, number: int, rows: NDArray[np.intp], felt: Floats | None) -> None:
        """``rows`` through the mesh period of that ``number``, what they feel into ``felt``."""
        if rows.size:
            state = self.state[rows]
            kept = np.empty_like(state) if felt is None else felt[rows]
            advance_parts(self._table(number), self.lanes[rows], state, kept, felt is not None)
            self.state[rows] = state
            if felt is not None:
                felt[rows] = kept
