"""The independent reference: scipy's DOP853 restarted at every edge of the backlash."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import ConvergenceError
from thermogear.dynamics.tables import Lanes

Floats = NDArray[np.float64]
Rate = Callable[[float, Floats, int], Floats]
Component = Callable[[float, Floats], float]

MOST_EVENTS = 10_000


def _in_region(rate: Rate, region: int, t: float, y: Floats) -> Floats:
    return rate(t, y, region)


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
    from scipy.integrate import solve_ivp  # a third of a second that most runs never need

    y = np.array(start, dtype=float)
    region = 0
    rising, behind = True, np.nan
    ways: list[tuple[float, int]] = []
    if gap is not None:
        x, b, speed = gap.value(0.0, y), gap.half_backlash, gap.speed(0.0, y)
        up = speed >= 0.0
        region = int(x > b or (x == b and up)) - int(x < -b or (x == -b and not up))
        later = y + 1e-6 * period * rate(0.0, y, region)
        rising = speed > 0.0 or (speed == 0.0 and gap.speed(1e-6 * period, later) > 0.0)
    sections = np.empty((periods + 1, y.size))
    sections[0] = y
    path = np.empty((periods * samples, y.size))
    crossings: list[float] = []
    stops = np.unique([0.0, *jumps, 1.0]) * period
    wanted = np.arange(samples) / samples * period if samples else np.empty(0)
    for turn in range(periods):
        for left, right in pairwise(stops.tolist()):
            t, end = left, right
            for _ in range(MOST_EVENTS):
                events: list[Component] = []
                if gap is not None:
                    # an edge just crossed cannot be crossed back before the path turns
                    ways = [(edge, way) for edge, way in gap.edges(region) if edge != behind]
                    events = [_event(gap.value, edge, way) for edge, way in ways]
                    if end == right:
                        events.append(_event(gap.speed, 0.0, -1 if rising else 1))
                if not np.all(np.isfinite(rate(t, y, region))):
                    # the stepper would look for a first step for ever
                    raise ConvergenceError(
                        f"adaptive reference: the derivative at t = {t:g} of period {turn} is no "
                        f"number at the state {y.tolist()}"
                    )
                solution = solve_ivp(
                    partial(_in_region, rate, region),
                    (t, end),
                    y,
                    method="DOP853",
                    rtol=rtol,
                    atol=atol,
                    max_step=period / 64.0,
                    dense_output=samples > 0,
                    events=events or None,
                )
                if solution.status < 0:
                    raise ConvergenceError(f"adaptive reference: {solution.message}")
                hit = -1
                if solution.status == 1:
                    hit = next(i for i, times in enumerate(solution.t_events) if len(times))
                reached = float(solution.t[-1])
                turned = gap is not None and end == right and hit == len(events) - 1
                if turned and gap is not None:
                    if gap.outside(reached, solution.y[:, -1], region):
                        # an edge was passed on the way to the turn: go there by its event
                        end = reached
                        continue
                    rising, behind = not rising, np.nan
                inside = (wanted >= t) & (wanted < reached)
                if np.any(inside):
                    path[turn * samples + np.flatnonzero(inside)] = solution.sol(wanted[inside]).T
                y = solution.y[:, -1]
                if hit < 0 and end < right:
                    # the edge was touched by rounding only: this is the turn
                    rising, behind = not rising, np.nan
                t, end = reached, right
                if hit < 0 and t >= right:
                    break
                if hit >= 0 and not turned:
                    behind = ways[hit][0]
                    region += ways[hit][1]
                    crossings.append(turn * period + t)
            else:
                raise ConvergenceError(
                    f"adaptive reference: more than {MOST_EVENTS} events in a period"
                )
        sections[turn + 1] = y
    return sections, path, np.array(crossings)


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
