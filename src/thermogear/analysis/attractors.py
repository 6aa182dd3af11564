"""Attractors as things: found from starts, distinguished, recognised from near, matched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from thermogear.analysis.settle import (
    CHAOTIC,
    DIVERGED,
    Rule,
    Settled,
    settle,
)
from thermogear.base.arrays import Floats, Whole
from thermogear.base.plan import Alive, keep_going
from thermogear.dynamics.bundle import WIDTH, Bundle, bundles
from thermogear.dynamics.lanes import Lanes

SAME = 1e-6
CLOUD = 4096
WIDEST_TRAP = 0.05
NARROWEST_TRAP = 1e-5


@dataclass(frozen=True, eq=False, kw_only=True)
class Attractor:
    """A periodic orbit (``points`` its section, (period, d)) or a chaotic set (a cloud of it).

    ``multiplier`` the largest one (NaN for chaos), ``lyapunov`` the largest exponent, ``trap``
    the radius, in half backlashes, inside which a trajectory is taken to stay for good (0: no
    such radius was found, or chaos).
    """

    period: int
    points: Floats
    multiplier: complex
    lyapunov: float
    trap: float

    @property
    def chaotic(self) -> bool:
        """No period."""
        return self.period == 0


class Field:
    """One parameter point with its maps ready for many states at once.

    ``lanes`` one lane, or a sequence of one model that has a return map.
    """

    def __init__(self, lanes: Lanes | Sequence[object], width: int = WIDTH) -> None:
        ((_, prepared),) = bundles(lanes)
        self.one = prepared()
        self.maps = self.one.take(np.zeros(width, int))
        self.unit = self.one.unit[0]
        self.period = float(self.one.period[0])
        self.width = width

    def of(self, count: int) -> Bundle:
        """The maps for ``count`` lanes side by side."""
        return self.maps if count == self.width else self.one.take(np.zeros(count, int))


def attractors_from(
    lanes: Lanes | Sequence[object],
    starts: Floats,
    rule: Rule,
    *,
    known: Sequence[Attractor] = (),
    alive: Alive = keep_going,
) -> tuple[list[Attractor], Whole]:
    """The attractors reached from ``starts`` (start, d) of one lane, and which start goes where.

    The starts are settled side by side; -1 where a start stays undecided, -2 where it
    diverges. Behind those that are ``known`` attractors come in the order of the starts that reach
    them first.
    """
    none = np.zeros(len(starts), int)
    many = lanes.take(none) if isinstance(lanes, Lanes) else [lanes[0]] * len(starts)
    return told_apart(settle(many, starts, rule, alive=alive), Field(lanes), known)


def told_apart(
    settled: Settled, field: Field, known: Sequence[Attractor]
) -> tuple[list[Attractor], Whole]:
    """The ``known`` attractors and those that motions have ``settled`` on beside them.

    With the place of each motion's among them, -1 and -2 as of :func:`attractors_from`.
    """
    found = list(known)
    where = np.full(len(settled.label), -1, np.int64)
    for i in range(len(where)):
        code, period = int(settled.label[i]), int(settled.period[i])
        if code == DIVERGED:
            where[i] = -2
        elif code == CHAOTIC:
            where[i] = chaotic_index(found, field, settled.state[i])
            if where[i] < 0:
                cloud = field.one.visit(settled.state[i][None], CLOUD).points[0]
                where[i] = len(found)
                found.append(
                    Attractor(
                        period=0,
                        points=cloud,
                        multiplier=complex(np.nan, np.nan),
                        lyapunov=float(settled.lyapunov[i]),
                        trap=0.0,
                    )
                )
        elif period > 0:
            where[i] = periodic_index(found, settled.point[i], period, field.unit)
            if where[i] < 0:
                where[i] = len(found)
                found.append(_orbit(field, settled.point[i], period, settled.multiplier[i, 0]))
    return found, where


def periodic_index(known: Sequence[Attractor], point: Floats, period: int, unit: Floats) -> int:
    """Which of the ``known`` the orbit through ``point`` is; -1: none."""
    for number, one in enumerate(known):
        if one.period == period:
            away = np.max(np.abs(one.points - point) / unit, axis=1)
            if float(away.min()) < SAME:
                return number
    return -1


def chaotic_index(known: Sequence[Attractor], field: Field, state: Floats) -> int:
    """Which of the known chaotic sets a trajectory runs on; -1: none.

    The same set, when of 256 sections from ``state`` nine tenths lie as near to the cloud as
    the cloud's own points lie to each other (their 99th percentile, doubled).
    """
    clouds = [(number, one) for number, one in enumerate(known) if one.chaotic]
    if not clouds:
        return -1
    path = field.one.visit(state[None], 256).points[0, 1:] / field.unit
    for number, one in clouds:
        tree = cKDTree(one.points / field.unit)
        own = np.percentile(tree.query(one.points / field.unit, k=2)[0][:, 1], 99.0)
        if float(np.mean(tree.query(path)[0] <= 2.0 * own)) >= 0.9:
            return number
    return -1


def _orbit(field: Field, point: Floats, period: int, multiplier: complex) -> Attractor:
    run = field.one.visit(point[None], period)
    points = run.points[0, :-1]
    exponent = float(np.log(abs(multiplier)) / (period * field.period))
    trap = _trap(field, points, multiplier, period)
    return Attractor(
        period=period, points=points, multiplier=complex(multiplier), lyapunov=exponent, trap=trap
    )


def _trap(field: Field, points: Floats, multiplier: complex, period: int) -> float:
    """The largest tried radius from which every start on squares about the orbit comes home.

    Starts are on the edges of squares of that half width and of a half and a quarter of it;
    home means within a tenth of the radius of its own point of the orbit. Only of states (x, x'):
    the corners about a longer one are too many to try, and it has none.
    """
    if points.shape[1] != 2:
        return 0.0
    turns = int(np.clip(np.ceil(np.log(1e-3) / np.log(max(abs(multiplier), 1e-3))), 4, 2000))
    edge = np.linspace(-1.0, 1.0, 5)
    ring = np.array([(a, b) for a in edge for b in edge if max(abs(a), abs(b)) == 1.0])
    shape = np.concatenate([ring, 0.5 * ring, 0.25 * ring])
    radius = WIDEST_TRAP
    while radius > NARROWEST_TRAP:
        starts = (points[:, None, :] + radius * shape[None] * field.unit).reshape(-1, 2)
        crowd = field.of(len(starts)).crowd(starts)
        crowd.run(turns * period)
        ends = crowd.state.reshape(len(points), -1, points.shape[1])
        away = np.max(np.abs(ends - points[:, None]) / field.unit, axis=2)
        if bool(np.all(away < 0.1 * radius)):
            return radius
        radius *= 0.5
    return 0.0


def trapped(
    field: Field,
    starts: Floats,
    attractors: Sequence[Attractor],
    *,
    stride: int = 4,
    cap: int = 2000,
    alive: Alive = keep_going,
) -> tuple[Whole, Whole, Floats]:
    """Which attractor's trap each start falls into (-1: none before ``cap``, -2: diverged).

    Also the periods run and the last state. Starts enter as lanes fall free; each is looked at
    after every ``stride`` of its own periods, so that company changes nothing.
    """
    count = len(starts)
    where = np.full(count, -1, np.int64)
    used = np.zeros(count, np.int64)
    last = starts.copy()
    safe = [n for n, one in enumerate(attractors) if one.trap > 0.0]
    if not safe:
        return where, used, last
    targets = np.concatenate([attractors[n].points for n in safe]) / field.unit
    owner = np.concatenate([np.full(len(attractors[n].points), n) for n in safe])
    reach = np.array([attractors[n].trap for n in owner])
    lane = np.arange(min(field.width, count))
    crowd = field.of(lane.size).crowd(starts[lane])
    fresh = lane.size
    while lane.size:
        alive()
        crowd.run(stride)
        used[lane] += stride
        here = crowd.state
        last[lane] = here
        scaled = here / field.unit
        away = np.abs(scaled[:, :1] - targets[:, 0])
        for k in range(1, targets.shape[1]):
            away = np.maximum(away, np.abs(scaled[:, k : k + 1] - targets[:, k]))
        inside = away < reach
        hit = inside.any(axis=1)
        gone = ~np.all(np.isfinite(here), axis=1)
        where[lane[hit]] = owner[inside[hit].argmax(axis=1)]
        where[lane[gone]] = -2
        done = np.flatnonzero(hit | gone | (used[lane] >= cap))
        if not done.size:
            continue
        enter = np.arange(fresh, min(fresh + done.size, count))
        fresh += enter.size
        seats = done[: enter.size]
        crowd.seat(seats, starts[enter])
        lane[seats] = enter
        empty = done[enter.size :]
        if empty.size:
            left = np.setdiff1d(np.arange(lane.size), empty)
            lane = lane[left]
            crowd = crowd.take(left)
    return where, used, last
