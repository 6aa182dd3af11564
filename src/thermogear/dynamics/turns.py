"""Motions of a pair over its turn at many speeds: fixed steps, until one turn repeats another.

A turn of many mesh periods is long against the time in which a vibration dies out, so that a run
which begins that time ahead of the turn repeats it at once, wherever one motion exists. No orbit
is proven: two turns, or groups of them, agree at their ends.
Checked by ``tests/dynamics/test_turns.py``: event-exact orbits of the same tables, and the closed
form of a pair that never parts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Complexes, Floats
from thermogear.dynamics.kernels.turns import advance_turn

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
        error = self.sampled(STEPS)[2][::STEPS]
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
