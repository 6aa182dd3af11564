"""The independent reference: scipy's DOP853 restarted at every edge of the backlash."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import ConvergenceError
from thermogear.dynamics.tables import Lanes

Floats = NDArray[np.float64]
Rate = Callable[[float, Floats, int], Floats]
Gap = Callable[[float, Floats], float]

MOST_EVENTS = 10_000


def _in_region(rate: Rate, region: int, t: float, y: Floats) -> Floats:
    return rate(t, y, region)


def _event(gap: Gap, edge: float, direction: float) -> Callable[[float, Floats], float]:
    def distance(t: float, y: Floats) -> float:
        return gap(t, y) - edge

    distance.terminal = True  # type: ignore[attr-defined]
    distance.direction = direction  # type: ignore[attr-defined]
    return distance


def follow(
    rate: Rate,
    gap: Gap | None,
    half_backlash: float,
    period: float,
    start: Floats,
    periods: int,
    samples: int,
    *,
    jumps: tuple[float, ...] = (),
    rtol: float = 1e-12,
    atol: float = 1e-14,
) -> tuple[Floats, Floats, Floats]:
    """Sections (periods + 1, component), samples and the times of the edges.

    ``rate(t, y, region)`` with t in [0, period); the region is -1, 0 or 1 and changes only at
    the events; ``gap(t, y)`` is the displacement measured against +-``half_backlash`` (None:
    no events). ``samples`` per period (0: none) are taken at uniform phases, the first at 0.
    The step never exceeds a 64th of the period, so that a graze is not stepped over.
    """
    from scipy.integrate import solve_ivp  # a third of a second that most runs never need

    y = np.array(start, dtype=float)
    region = 0
    if gap is not None:
        x = gap(0.0, y)
        region = int(x > half_backlash) - int(x < -half_backlash)
    edges: dict[int, tuple[tuple[float, float], ...]] = {
        1: ((half_backlash, -1.0),),
        0: ((-half_backlash, -1.0), (half_backlash, 1.0)),
        -1: ((-half_backlash, 1.0),),
    }
    sections = np.empty((periods + 1, y.size))
    sections[0] = y
    path = np.empty((periods * samples, y.size))
    crossings: list[float] = []
    stops = np.unique([0.0, *jumps, 1.0]) * period
    for turn in range(periods):
        wanted = np.arange(samples) / samples * period if samples else np.empty(0)
        for left, right in pairwise(stops):
            t = float(left)
            for _ in range(MOST_EVENTS):
                events = [] if gap is None else [_event(gap, e, d) for e, d in edges[region]]
                solution = solve_ivp(
                    partial(_in_region, rate, region),
                    (t, float(right)),
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
                end = float(solution.t[-1])
                inside = (wanted >= t) & (wanted < end)
                if np.any(inside):
                    path[turn * samples + np.flatnonzero(inside)] = solution.sol(wanted[inside]).T
                y = solution.y[:, -1]
                t = end
                if solution.status == 0:
                    break
                hit = next(i for i, times in enumerate(solution.t_events) if len(times))
                region += int(edges[region][hit][1])
                crossings.append(turn * period + t)
            else:
                raise ConvergenceError(
                    f"adaptive reference: more than {MOST_EVENTS} contact changes in a period"
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
