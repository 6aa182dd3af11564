"""The independent reference: scipy's DOP853 restarted at every edge of the backlash."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError
from thermogear.dynamics.lanes import Lanes

Rate = Callable[[float, Floats, int], Floats]
Component = Callable[[float, Floats], float]

MOST_EVENTS = 10_000


def _event(value: Component, edge: float, direction: int) -> Callable[[float, Floats], float]:
    def distance(t: float, y: Floats) -> float:
        return value(t, y) - edge

    distance.terminal = True  # type: ignore[attr-defined]
    distance.direction = direction  # type: ignore[attr-defined]
    return distance


@dataclass(frozen=True)
class Gap:
    """The displacement measured against +-``half_backlash``, and its rate."""

    value: Component
    speed: Component
    half_backlash: float

    def edges(self, region: int) -> list[tuple[float, int]]:
        """Edges of a region and the direction in which they are left."""
        b = self.half_backlash
        return {1: [(b, -1)], 0: [(-b, -1), (b, 1)], -1: [(-b, 1)]}[region]

    def outside(self, t: float, y: Floats, region: int) -> bool:
        """Whether the state lies beyond an edge of its region."""
        x = self.value(t, y)
        return any((x - edge) * way > 0.0 for edge, way in self.edges(region))


def follow(
    rate: Rate,
    gap: Gap | None,
    period: float,
    start: Floats,
    *,
    periods: int,
    samples: int,
    jumps: tuple[float, ...] = (),
    rtol: float = 1e-12,
    atol: float = 1e-14,
) -> tuple[Floats, Floats, Floats]:
    """Sections (periods + 1, component), samples and the times of the edges.

    ``rate(t, y, region)`` with t in [0, period); the region is -1, 0 or 1 and changes only at
    the events; ``gap`` None: no events. ``samples`` per period (0: none) are taken at uniform
    phases, the first at 0. The integration also stops where the displacement turns, so that a
    graze inside a step cannot be overlooked.
    """
    y = np.array(start, dtype=float)
    way = _Way(rate, gap, period, {"rtol": rtol, "atol": atol, "dense_output": samples > 0}, y)
    sections = np.empty((periods + 1, y.size))
    sections[0] = y
    path = np.empty((periods * samples, y.size))
    stops = np.unique([0.0, *jumps, 1.0]) * period
    wanted = np.arange(samples) / samples * period if samples else np.empty(0)
    for turn in range(periods):
        for left, right in pairwise(stops.tolist()):
            for begin, end, solution in way.pieces(turn, left, right):
                inside = (wanted >= begin) & (wanted < end)
                if np.any(inside):
                    path[turn * samples + np.flatnonzero(inside)] = solution(wanted[inside]).T
        sections[turn + 1] = way.y
    return sections, path, np.array(way.crossings)


class _Way:
    """A motion on its way: its state ``y`` and the region it is in, the times of its edges.

    ``rising``: whether the displacement grows; ``behind``: the edge just crossed (nan: none),
    which cannot be crossed back before the path turns.
    """

    def __init__(
        self, rate: Rate, gap: Gap | None, period: float, settings: dict[str, Any], y: Floats
    ) -> None:
        self.rate, self.gap, self.period, self.settings = rate, gap, period, settings
        self.y = y
        self.region, self.rising, self.behind = 0, True, np.nan
        self.crossings: list[float] = []
        if gap is not None:
            x, b, speed = gap.value(0.0, y), gap.half_backlash, gap.speed(0.0, y)
            up = speed >= 0.0
            self.region = int(x > b or (x == b and up)) - int(x < -b or (x == -b and not up))
            later = y + 1e-6 * period * rate(0.0, y, self.region)
            self.rising = speed > 0.0 or (speed == 0.0 and gap.speed(1e-6 * period, later) > 0.0)

    def pieces(self, turn: int, left: float, right: float) -> Iterator[tuple[float, float, Any]]:
        """From ``left`` to ``right`` of period ``turn``: times between edges, and the solution."""
        t, end = left, right
        for _ in range(MOST_EVENTS):
            ways = [] if self.gap is None else self.gap.edges(self.region)
            ways = [(edge, way) for edge, way in ways if edge != self.behind]
            solution, hit = self._solved(turn, t, end, ways, turns=end == right)
            reached = float(solution.t[-1])
            turned = hit == len(ways)
            if turned and self.gap and self.gap.outside(reached, solution.y[:, -1], self.region):
                # an edge was passed on the way to the turn: go there by its event
                end = reached
                continue
            yield t, reached, solution.sol
            self.y = solution.y[:, -1]
            if turned or (hit < 0 and end < right):
                # an edge touched by rounding only is the turn as well
                self.rising, self.behind = not self.rising, np.nan
            elif hit >= 0:
                self.behind = ways[hit][0]
                self.region += ways[hit][1]
                self.crossings.append(turn * self.period + reached)
            t, end = reached, right
            if hit < 0 and t >= right:
                return
        raise ConvergenceError(f"adaptive reference: more than {MOST_EVENTS} events in a period")

    def _solved(
        self, turn: int, t: float, end: float, ways: list[tuple[float, int]], *, turns: bool
    ) -> tuple[Any, int]:
        """scipy's solution up to the first event, and which: an edge of ``ways``, then the turn.

        -1: none before ``end``. The turn ends it only with ``turns``.
        """
        from scipy.integrate import solve_ivp  # a third of a second that most runs never need

        events: list[Component] = []
        if self.gap is not None:
            events = [_event(self.gap.value, edge, way) for edge, way in ways]
            if turns:
                events.append(_event(self.gap.speed, 0.0, -1 if self.rising else 1))
        region = self.region
        if not np.all(np.isfinite(self.rate(t, self.y, region))):
            # the stepper would look for a first step for ever
            raise ConvergenceError(
                f"adaptive reference: the derivative at t = {t:g} of period {turn} is no "
                f"number at the state {self.y.tolist()}"
            )
        solution = solve_ivp(
            lambda t, y: self.rate(t, y, region),
            (t, end),
            self.y,
            method="DOP853",
            max_step=self.period / 64.0,
            events=events or None,
            **self.settings,
        )
        if solution.status < 0:
            raise ConvergenceError(f"adaptive reference: {solution.message}")
        if solution.status != 1:
            return solution, -1
        return solution, next(i for i, times in enumerate(solution.t_events) if len(times))


def lane_rate(lanes: Lanes) -> Rate:
    """The equation of the single lane of ``lanes`` with the region's own straight force."""
    period = float(lanes.period[0])
    damping = float(lanes.damping[0])
    backlash = float(lanes.half_backlash[0])

    def rate(t: float, y: Floats, region: int) -> Floats:
        force = float(lanes.values("force", t / period)[0])
        spring = 0.0
        if region != 0:
            k = float(lanes.values("stiffness", t / period)[0])
            spring = k * (y[0] - region * backlash)
        return np.array([y[1], force - damping * y[1] - spring])

    return rate
