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

from thermogear.analysis.bifurcations import BIRTH, FLIP, FOLD, SUBCRITICAL, TORUS, Bifurcation
from thermogear.analysis.continuation import (
    REACHED,
    SHRUNK,
    Branch,
    Doubled,
    continuation,
    switch_branch,
)
from thermogear.analysis.curve import Curve, Family, Point
from thermogear.analysis.orbits import closed, shoot
from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError
from thermogear.dynamics.return_map import ReturnMap, return_map

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
SPAN = 0.25
"""Share of the parameter that counts as one half backlash where the branch is walked."""
SHORTEST = 1.0 / 64.0
SAME = 1e-8
"""Half backlashes between two points that are one."""

Settle = Callable[[float, Floats], tuple[Floats, int]]
"""(value, start) -> the state a motion settles on, and the periods of its orbit (0: none)."""


@dataclass(frozen=True, kw_only=True)
class Leap:
    """A motion leaves its branch at ``value``: at a fold, or a subcritical period doubling.

    ``kind`` of bifurcation, ``period`` and ``state`` (d,) there; ``landed`` the parameter just
    behind, where the new motion of ``found_period`` periods (0: no orbit) is at ``found`` (d,).
    """

    kind: str
    period: int
    value: float
    state: Floats
    landed: float
    found: Floats
    found_period: int


@dataclass(frozen=True)
class Followed:
    """Where a slow change from one value of the parameter to another leads.

    ``state`` (d,) and ``period`` at ``value``, which is the end; or ``period`` 0 where no orbit
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
    most_leaps: int = MOST_EVENTS,
    maps: dict[float, ReturnMap] | None = None,
) -> Followed:
    """Follow the stable orbit of ``period`` periods at ``state`` from ``start`` to ``to``.

    ``family`` value -> model of one lane; ``settle`` finds a motion behind a jump. It ends behind
    ``most_leaps`` jumps. ``maps`` keep what was prepared last, for the next call of one family.
    """
    leaps: list[Leap] = []
    stand = _Stand(start, np.asarray(state, dtype=float), period)
    for _ in range(MOST_EVENTS):
        if stand.value == to or stand.period == 0:
            return Followed(stand.value, stand.state, stand.period, tuple(leaps))
        if stand.beside is None:
            quick = _straight(family, parameter, to, stand, maps)
            if quick is not None:
                stand = quick
                continue
        try:
            branch = _walked(family, parameter, start, to, stand)
        except ConvergenceError:
            break
        event = next((b for b in branch.bifurcations if b.kind in (FOLD, FLIP, TORUS)), None)
        if event is None and branch.ended == REACHED:
            return Followed(to, branch.states[-1], stand.period, tuple(leaps))
        if event is None:
            stand = _shrunk(branch, start, to)
        elif event.kind == FLIP and event.note != SUBCRITICAL:
            stand = _doubled(event, family, start, to)
        else:
            leaps.append(_leap(event, settle, start, to))
            landed = leaps[-1]
            stand = _Stand(landed.landed, landed.found, landed.found_period)
            if len(leaps) == most_leaps:
                return Followed(stand.value, stand.state, stand.period, tuple(leaps))
    return Followed(stand.value, stand.state, 0, tuple(leaps))


@dataclass(frozen=True)
class _Stand:
    """A motion on the way: ``state`` (d,) and ``period`` (0: it is followed no further) at
    ``value``; ``beside``: the flip that it has just gone through by."""

    value: float
    state: Floats
    period: int
    beside: Doubled | None = None


def _shrunk(branch: Branch, start: float, to: float) -> _Stand:
    """Onto the orbit of half the period into which the branch shrank, stable from there on."""
    here, at = branch.states[-1], float(branch.values[-1])
    if branch.ended != SHRUNK[BIRTH]:
        return _Stand(at, here, 0)
    at = _behind(at, start=start, to=to)
    mother = shoot(return_map(branch.family(at)), here, branch.period // 2)
    if mother is None or not mother.stable:
        return _Stand(at, here, 0)
    return _Stand(at, mother.state, mother.minimal_period)


def _doubled(event: Bifurcation, family: Family, start: float, to: float) -> _Stand:
    """Through a supercritical flip onto the orbit of twice the period, where that lies ahead."""
    lost = _Stand(event.value, _pushed(event), 0)
    if 2 * event.period > LONGEST_PERIOD:
        return lost
    try:
        doubled = switch_branch(event, family)
    except ConvergenceError:
        return lost
    if (to - doubled.value) * (to - start) <= 0.0:
        return lost
    return _Stand(doubled.value, doubled.orbit.state, doubled.orbit.period, doubled)


def _leap(event: Bifurcation, settle: Settle, start: float, to: float) -> Leap:
    """Off the branch, to what the state at its end settles on."""
    landed = _behind(event.value, start=start, to=to)
    found, period = settle(landed, _pushed(event))
    return Leap(
        kind=event.kind,
        period=event.period,
        value=event.value,
        state=event.state,
        landed=landed,
        found=found,
        found_period=period,
    )


def _behind(value: float, *, start: float, to: float) -> float:
    """A little further on the way to ``to``, not beyond it."""
    there = value + float(np.sign(to - start)) * BEYOND * abs(value)
    return to if (there - to) * (to - start) > 0.0 else there


def _pushed(event: Bifurcation) -> Floats:
    """The state at a bifurcation, of a flip a little off the orbit that has become unstable."""
    if event.kind != FLIP:
        return event.state
    two = event.orbit.section.unit
    matrix = event.orbit.jacobian / two[:, None] * two
    return np.asarray(event.state + 0.05 * two * np.linalg.svd(matrix + np.eye(two.size))[2][-1])


def _straight(
    family: Family,
    parameter: str,
    to: float,
    stand: _Stand,
    maps: dict[float, ReturnMap] | None,
) -> _Stand | None:
    """Where steps whose straight prediction holds lead: to ``to``.

    As far as the orbit has shrunk into one of fewer periods, where it does; None where the
    prediction does not hold.
    """
    start, period = stand.value, stand.period
    curve = Curve(family, parameter, period, start=start, span=abs(to - start), maps=maps)
    upright = curve.upright
    end = to / curve.span
    point = curve.correct(np.append(stand.state, start) / curve.unit, normal=upright)
    if point is None:
        return None
    while True:
        least = _least_period(point, curve)
        if point.scaled[-1] == end or least < period:
            value = to if point.scaled[-1] == end else float(point.scaled[-1] * curve.span)
            return _Stand(value, np.asarray(point.scaled[:-1] * curve.unit[:-1]), least)
        ahead = end - point.scaled[-1]
        if abs(point.tangent[-1]) < 1e-6:
            return None
        rate = point.tangent / point.tangent[-1]
        most = float(np.max(np.abs(rate[:-1])))
        step = float(np.sign(ahead)) * min(abs(ahead), REACH / max(most, 1e-12))
        while True:
            if abs(step) < SHORTEST and abs(step) < abs(ahead):
                return None
            guess = point.scaled + step * rate
            if abs(step) == abs(ahead):
                guess[-1] = end
            there = curve.correct(guess, normal=upright, reach=4.0 * BEND)
            if there is not None and there.contacts != point.contacts:
                return None  # folds come close to where contact changes
            if (
                there is not None
                and _even(point, there)
                and float(np.max(np.abs(there.scaled - guess))) <= BEND
                and there.tests.fold > 0.0
                and there.tests.flip > 0.0
                and there.tests.fold > 0.2 * point.tests.fold
            ):
                break
            step *= 0.5
        point = there


def _least_period(point: Point, curve: Curve) -> int:
    """The smallest number of periods after which the orbit closes."""
    points = point.visit.points / curve.unit[:-1]
    apart = np.max(np.abs(points[1:] - points[0]), axis=1)
    n = curve.period
    return next(k for k in range(1, n + 1) if n % k == 0 and (k == n or apart[k - 1] < SAME))


def _even(a: Point, b: Point) -> bool:
    """Whether the way between two orbits is that of the mean rate at both, but for little."""
    if abs(b.tangent[-1]) < 1e-6:
        return False
    step = b.scaled[-1] - a.scaled[-1]
    moved = b.scaled[:-1] - a.scaled[:-1]
    mean = 0.5 * step * (a.tangent[:-1] / a.tangent[-1] + b.tangent[:-1] / b.tangent[-1])
    return float(np.max(np.abs(moved - mean))) <= CLOSE * float(np.max(np.abs(mean))) + 1e-5


def _walked(family: Family, parameter: str, start: float, to: float, stand: _Stand) -> Branch:
    """The branch by arclength, as far as the motion can stay on it."""
    at, beside = stand.value, stand.beside
    if beside is None:
        model = family(at)
        orbit = closed(return_map(model), stand.state, stand.period, model=model)
    else:
        orbit = beside.orbit
    return continuation(
        orbit,
        parameter,
        to,
        family=family,
        start=at,
        back_to=at if beside is None else start,
        span=max(abs(to - at), SPAN * abs(at)),
        stop_at=(FOLD, FLIP, TORUS),
        direction=None if beside is None else beside.direction,
        most_points=600,
    )
