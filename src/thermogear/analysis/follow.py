"""A motion that is followed while its parameter moves slowly: where it runs on, where it jumps.

A slow enough change keeps a motion on its branch: through supercritical period doublings onto the
doubled branch, and off the branch at a fold or a subcritical doubling only. There it settles anew,
on whatever its last state leads to. No step of a sweep enters, so that coarse and fine sweeps
follow the same motion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.bifurcations import (
    FLIP,
    FOLD,
    SUBCRITICAL,
    Bifurcation,
    Curve,
    Family,
    Point,
)
from thermogear.analysis.continuation import (
    BIRTH,
    REACHED,
    SHRUNK,
    Branch,
    Doubled,
    continuation,
    switch_branch,
)
from thermogear.analysis.orbits import Orbit, closed, shoot
from thermogear.analysis.section import ReturnMap, lanes_of
from thermogear.base.errors import ConvergenceError

Floats = NDArray[np.float64]

BEYOND = 2e-4
"""A motion that left its branch settles this share of the parameter behind the fold."""
LONGEST_PERIOD = 16
"""A cascade is followed up to orbits of so many periods; behind it lies chaos."""
MOST_EVENTS = 24
BEND = 0.03
"""Half backlashes by which a straight prediction may miss the orbit it predicts."""
CLOSE = 0.05
"""Share of a step by which it may miss the mean of the rates at its ends: else a fold and its
return may lie between."""
REACH = 0.25
"""Half backlashes an orbit may move in one predicted step."""
SHORTEST = 1.0 / 64.0
SAME = 1e-8
"""Half backlashes between two points that are one."""

Settle = Callable[[float, Floats], tuple[Floats, int]]
"""(value, start) -> the state a motion settles on, and the periods of its orbit (0: none)."""


@dataclass(frozen=True, kw_only=True)
class Leap:
    """A motion leaves its branch at ``value``: at a fold, or a subcritical period doubling.

    ``kind`` of bifurcation, ``period`` and ``state`` (2,) there; ``landed`` the parameter just
    behind, where the new motion stands at ``found`` (2,).
    """

    kind: str
    period: int
    value: float
    state: Floats
    landed: float
    found: Floats


@dataclass(frozen=True)
class Followed:
    """Where a slow change from one value of the parameter to another leads.

    ``state`` (2,) and ``period`` at ``value``, which is the end; or ``period`` 0 where no orbit
    could be followed further (chaos, or none found). ``leaps`` on the way.
    """

    value: float
    state: Floats
    period: int
    leaps: tuple[Leap, ...]


def follow(
    family: Family,
    parameter: str,
    *,
    start: float,
    to: float,
    state: Floats,
    period: int,
    settle: Settle,
) -> Followed:
    """Follow the stable orbit of ``period`` periods at ``state`` from ``start`` to ``to``.

    ``family`` value -> model of one lane; ``settle`` finds a motion behind a jump.
    """
    leaps: list[Leap] = []
    here, at, n = np.asarray(state, dtype=float), start, period
    doubled: Doubled | None = None
    for _ in range(MOST_EVENTS):
        if at == to:
            return Followed(at, here, n, tuple(leaps))
        if doubled is None:
            quick = _straight(family, parameter, at, to, here, n)
            if quick is not None:
                at, here, n = quick
                continue
        try:
            branch = _walked(family, parameter, (start, at, to), here, n, doubled)
        except ConvergenceError:
            break
        event = _end_of_life(branch)
        doubled = None
        if event is None:
            here, at = branch.states[-1], float(branch.values[-1])
            if branch.ended == REACHED:
                return Followed(to, here, n, tuple(leaps))
            if branch.ended != SHRUNK[BIRTH]:
                break
            # onto the orbit of half its period, stable from here on
            at = _behind(at, start=start, to=to)
            mother = shoot(ReturnMap(lanes_of(family(at))), here, n // 2)
            if mother is None or not mother.stable:
                break
            here, n = mother.state, mother.minimal_period
            continue
        if event.kind == FLIP and event.note != SUBCRITICAL:
            here, at = _pushed(event), event.value
            if 2 * n > LONGEST_PERIOD:
                break
            try:
                doubled = switch_branch(event, family)
            except ConvergenceError:
                break
            if (to - doubled.value) * (to - start) <= 0.0:
                break
            here, at, n = doubled.orbit.state, doubled.value, doubled.orbit.period
            continue
        landed = _behind(event.value, start=start, to=to)
        found, n_new = settle(landed, _pushed(event))
        leaps.append(
            Leap(
                kind=event.kind,
                period=n,
                value=event.value,
                state=event.state,
                landed=landed,
                found=found,
            )
        )
        here, at = found, landed
        if n_new == 0:
            break
        n = n_new
    return Followed(at, here, 0, tuple(leaps))


def _end_of_life(branch: Branch) -> Bifurcation | None:
    """Where the motion leaves the branch, if it does."""
    return next((b for b in branch.bifurcations if b.kind in (FOLD, FLIP)), None)


def _behind(value: float, *, start: float, to: float) -> float:
    """A little further on the way to ``to``, not beyond it."""
    there = value + float(np.sign(to - start)) * BEYOND * abs(value)
    return to if (there - to) * (to - start) > 0.0 else there


def _pushed(event: Bifurcation) -> Floats:
    """The state at a bifurcation, of a flip a little off the orbit that has become unstable."""
    if event.kind != FLIP:
        return event.state
    section = ReturnMap(event.orbit.lanes)
    two = section.unit
    matrix = event.orbit.jacobian / two[:, None] * two
    return np.asarray(event.state + 0.05 * two * np.linalg.svd(matrix + np.eye(2))[2][1])


def _straight(
    family: Family, parameter: str, start: float, to: float, state: Floats, period: int
) -> tuple[float, Floats, int] | None:
    """``to``, the state there and its periods by steps whose straight prediction holds.

    As far as the orbit has shrunk into one of fewer periods, where it does; None where the
    prediction does not hold.
    """
    curve = Curve(family, parameter, period, start=start, span=abs(to - start))
    upright = np.array([0.0, 0.0, 1.0])
    end = to / curve.span
    point = curve.correct(np.append(state, start) / curve.unit, normal=upright)
    if point is None:
        return None
    while True:
        least = _least_period(point, curve)
        if point.scaled[2] == end or least < period:
            value = to if point.scaled[2] == end else float(point.scaled[2] * curve.span)
            return value, np.asarray(point.scaled[:2] * curve.unit[:2]), least
        ahead = end - point.scaled[2]
        if abs(point.tangent[2]) < 1e-6:
            return None
        rate = point.tangent / point.tangent[2]
        most = float(np.max(np.abs(rate[:2])))
        step = float(np.sign(ahead)) * min(abs(ahead), REACH / max(most, 1e-12))
        while True:
            if abs(step) < SHORTEST and abs(step) < abs(ahead):
                return None
            guess = point.scaled + step * rate
            if abs(step) == abs(ahead):
                guess[2] = end
            there = curve.correct(guess, normal=upright, reach=4.0 * BEND)
            if there is not None and there.contacts != point.contacts:
                return None  # folds come close to where contact changes
            if (
                there is not None
                and _even(point, there)
                and float(np.max(np.abs(there.scaled - guess))) <= BEND
                and there.fold > 0.0
                and there.flip > 0.0
                and there.fold > 0.2 * point.fold
            ):
                break
            step *= 0.5
        point = there


def _least_period(point: Point, curve: Curve) -> int:
    """The smallest number of periods after which the orbit closes."""
    points = point.visit.points / curve.unit[:2]
    apart = np.max(np.abs(points[1:] - points[0]), axis=1)
    n = curve.period
    return next(k for k in range(1, n + 1) if n % k == 0 and (k == n or apart[k - 1] < SAME))


def _even(a: Point, b: Point) -> bool:
    """Whether the way between two orbits is that of the mean rate at both, but for little."""
    if abs(b.tangent[2]) < 1e-6:
        return False
    step = b.scaled[2] - a.scaled[2]
    moved = b.scaled[:2] - a.scaled[:2]
    mean = 0.5 * step * (a.tangent[:2] / a.tangent[2] + b.tangent[:2] / b.tangent[2])
    return float(np.max(np.abs(moved - mean))) <= CLOSE * float(np.max(np.abs(mean))) + 1e-5


def _walked(
    family: Family,
    parameter: str,
    way: tuple[float, float, float],
    state: Floats,
    period: int,
    doubled: Doubled | None,
) -> Branch:
    """The branch by arclength, as far as the motion can stay on it."""
    orbit: Orbit
    behind, start, to = way
    if doubled is None:
        model = family(start)
        orbit = closed(ReturnMap(lanes_of(model)), state, period, model=model)
    else:
        orbit = doubled.orbit
    return continuation(
        orbit,
        parameter,
        to,
        family=family,
        start=start,
        back_to=start if doubled is None else behind,
        stop_at=(FOLD, FLIP),
        direction=None if doubled is None else doubled.direction,
        most_points=600,
    )
