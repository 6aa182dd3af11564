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

    ``stiffness`` k over its mean, ``error`` e in half backlashes; ``mesh_periods`` in a turn.
    """

    stiffness: Complexes
    error: Complexes
    mesh_periods: int
    _sampled: dict[int, tuple[Floats, Floats, Floats]] = field(default_factory=dict, init=False)

    def from_greatest(self) -> TurnTables:
        """The same turn begun at the mesh period whose error is greatest at its phase 0.

        So a run begins at the same teeth however they are numbered.
        """
        error = self.sampled(STEPS)[2][::STEPS]
        shift = int(np.argmax(error)) / self.mesh_periods
        stiffness, error = (
            row * np.exp(2j * np.pi * shift * np.arange(row.size))
            for row in (self.stiffness, self.error)
        )
        return TurnTables(stiffness=stiffness, error=error, mesh_periods=self.mesh_periods)

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
    """One entry per run: ``period`` in turns (0: none was seen), ``state`` (run, 2) at phase 0, and
    over its cycle, or the later half of what was followed where none was seen: greatest and least
    force k f over the mean stiffness, greatest and least x + e, share of time out of drive-side
    contact.
    """

    period: NDArray[np.int32]
    state: Floats
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


def follow_turns(tables: TurnTables, lanes: TurnLanes, start: Floats) -> TurnMotions:
    """What each lane settles on from ``start`` (lane, 2), held ahead of the turn.

    The run begins as long ahead of phase 0 as a vibration takes to fall to :data:`DIED_OUT`. It
    ends where two turns in a row end within :data:`SAME`, or where the states at phase 0 are those
    of up to :data:`LONGEST_CYCLE` turns before, a cycle long.
    """
    count, mesh = lanes.mean.size, tables.mesh_periods
    out = TurnMotions(
        period=np.zeros(count, np.int32),
        state=np.array(start, dtype=float),
        force=np.full((count, 2), np.nan),
        travel=np.full((count, 2), np.nan),
        lost=np.full(count, np.nan),
    )
    # steps of a mesh period: a power of two of the least, so that few tables are made
    needed = lanes.period / (LONGEST_STEP * mesh * STEPS)
    doublings = np.ceil(np.log2(np.maximum(needed, 1.0))).astype(int)
    for power in np.unique(doublings):
        index = np.flatnonzero(doublings == power)
        _follow(tables, STEPS * 2 ** int(power), lanes, index, out)
    return out


def _follow(
    tables: TurnTables, steps: int, lanes: TurnLanes, index: NDArray[np.intp], out: TurnMotions
) -> None:
    """Lanes ``index`` with so many steps a mesh period, into ``out``."""
    stiffness, bend, error = tables.sampled(steps)
    turn, mesh = error.size, tables.mesh_periods
    decay = 2.0 * math.log(1.0 / DIED_OUT) / np.maximum(lanes.damping[index], 1e-9)
    ahead = float((decay / lanes.period[index]).max()) * mesh
    first = math.ceil(min(max(ahead, 1.0), MOST_MESH_PERIODS)) * steps
    most = longest(mesh) // mesh
    x, v = out.state[index].T.copy()
    ends, felt = np.empty((most + 1, 2, index.size)), np.empty((most, 5, index.size))
    active = np.arange(index.size)

    def run(begin: int, count: int) -> Floats:
        here = index[active]
        seen = np.tile([[-np.inf], [np.inf], [-np.inf], [np.inf], [0.0]], active.size)
        states = x[active], v[active]
        advance_turn(
            stiffness, bend, error, lanes.mean[here], -1.0 / lanes.period[here] ** 2,
            lanes.damping[here], lanes.backlash[here], lanes.period[here] / turn,
            begin, count, *states, seen,
        )  # fmt: skip
        x[active], v[active] = states
        return seen

    run(-first % turn, first)
    ends[0] = x, v
    for number in range(most):
        felt[number][:, active] = run(0, turn)
        ends[number + 1][:, active] = x[active], v[active]
        cycle = _cycle(ends[: number + 2][:, :, active] / lanes.backlash[index[active]])
        seen = cycle > 0 if number + 1 < most else np.ones(active.size, bool)
        for length in np.unique(cycle[seen]):
            rows = active[seen & (cycle == length)]
            span = length or most // 2
            _keep(out, index[rows], felt[number + 1 - span : number + 1][:, :, rows], turn)
            out.period[index[rows]] = length
        out.state[index[active]] = ends[number + 1][:, active].T
        active = active[cycle == 0]
        if not active.size:
            return


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
