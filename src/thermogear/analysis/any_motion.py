"""What a model of any dimension settles on from one start, by its return map alone.

A motion of one mass is labelled by :mod:`~thermogear.analysis.labels`, which knows more of it. Here
a motion is periodic, with its orbit and Floquet multipliers as proof, chaotic by its largest
Lyapunov exponent, quasi-periodic on a proven torus, or undecided.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.orbits import Orbit, shoot
from thermogear.analysis.torus import LONGEST, Torus, torus
from thermogear.base.errors import ConvergenceError
from thermogear.base.plan import Alive, keep_going
from thermogear.dynamics.return_map import ReturnMap

Floats = NDArray[np.float64]

CLOSE = 0.05
"""Distance of a return, in units of the map, from which an orbit is looked for."""
NEAR_BORDER = 0.998
"""A largest multiplier above it leaves the label undecided."""
BATCHES = 10
BATCH = 50
"""Batches of periods, and their length, for the Lyapunov exponent."""
ROUND = 2048
ROUNDS = 3
"""Sections that a torus is looked for in, and how often: it may be reached slowly."""
LONG_CLOSE = 1e-6
"""Distance of a return after many periods, in units of the map, that is believed."""
LONG_BATCHES = 16
"""Batches in so many periods, for the exponent on a torus."""


@dataclass(frozen=True, kw_only=True)
class Search:
    """How long a motion is followed: rounds of ``first`` periods, doubling, to ``cap`` in all.

    ``max_period`` of an orbit. ``polish``: with Newton and multipliers; without, a motion that
    comes nearer to itself by ``approach`` from one period to the next, to ``closed`` units of the
    map, is periodic. A largest multiplier above ``near_border`` leaves it undecided. ``exponent``:
    whether chaos is asked for.
    """

    first: int = 64
    cap: int = 4096
    max_period: int = 16
    polish: bool = True
    closed: float = 1e-6
    approach: float = 0.9
    exponent: bool = True
    near_border: float = NEAR_BORDER


@dataclass(frozen=True, eq=False, kw_only=True)
class Motion:
    """What a start settles on: "period-n", "quasi-periodic", "chaotic", "undecided", "diverged".

    ``period`` n (0: none), ``reason`` in words, the last ``state`` (d,), on the ``orbit`` where
    there is one; ``multiplier``, the largest by modulus (nan: not known); ``lyapunov`` [1/time]
    with its ``lyapunov_error`` and the means of its ``batches``; ``exponents``: as much of the
    spectrum as the label needs, the largest first: all of a periodic orbit, two on a torus; the
    ``torus`` it is on; ``used`` periods run; ``away`` how far the motion itself still was from its
    orbit, in units of the map.
    """

    name: str
    period: int
    reason: str
    state: Floats
    used: int
    orbit: Orbit | None = None
    multiplier: complex = complex("nan")
    lyapunov: float = float("nan")
    lyapunov_error: float = float("nan")
    batches: Floats = field(default_factory=lambda: np.empty(0))
    exponents: Floats = field(default_factory=lambda: np.empty(0))
    torus: Torus | None = None
    away: float = float("nan")


def settle(
    section: ReturnMap, start: Floats, search: Search | None = None, *, alive: Alive = keep_going
) -> Motion:
    """Follow ``start`` (d,) until it is proven what it settles on, or the search ends.

    Periodic: the motion returns to itself, Newton's rule finds an orbit there whose multipliers all
    stay below 0.998, and the motion comes nearer to it from one round to the next. Chaotic: it does
    not return, and the largest Lyapunov exponent exceeds four standard errors in both halves of its
    record. Quasi-periodic: that exponent is zero within four standard errors, the second one
    negative beyond its own, and the sections lie on a closed curve with a second base frequency
    (:class:`~thermogear.analysis.torus.Torus`). A motion that closes after more periods than are
    looked for at first, up to 512, is periodic with a long period: the second frequency is rational
    to the first. ``alive`` raises to end the work.
    """
    how = search or Search()
    state = np.asarray(start, dtype=float)
    used, length = 0, how.first
    orbit, near = None, np.inf
    while used < how.cap:
        alive()
        length = min(length, how.cap - used)
        try:
            path = section.carry(state, length)
        except ConvergenceError as told:
            return Motion(name="diverged", period=0, reason=str(told), state=state, used=used)
        used += length
        window = np.vstack([state[None], path])[-(2 * how.max_period + 1) :]
        state = path[-1]
        if not how.polish:
            found = _closing(section, window, used, how)
            if found is not None:
                return found
        else:
            if orbit is None:
                orbit = _orbit(section, window, how.max_period)
                near = np.inf
            if orbit is not None:
                away = float(section.distance(orbit.points, state).min())
                if away < 1e-9 or (away < CLOSE and away < 0.7 * near):
                    if np.isfinite(near) or away < 1e-9:
                        return _proven(orbit, away, used, how.near_border)
                    near = away
                elif away > CLOSE:
                    orbit = None
                length = min(length, how.first)
                continue
        length *= 2
    try:
        return _open(section, state, used, how, alive)
    except ConvergenceError as told:
        return Motion(name="diverged", period=0, reason=str(told), state=state, used=used)


def _lag(section: ReturnMap, window: Floats, max_period: int) -> int:
    """The least lag after which the last state returns; 0: none."""
    for lag in range(1, min(max_period, len(window) - 1) + 1):
        if float(section.distance(window[-1 - lag], window[-1])) < CLOSE:
            return lag
    return 0


def _orbit(section: ReturnMap, window: Floats, max_period: int) -> Orbit | None:
    lag = _lag(section, window, max_period)
    if lag == 0:
        return None
    try:
        orbit = shoot(section, window[-1], lag, tolerance=1e-11, most=12)
        if orbit is not None and orbit.minimal_period != orbit.period:
            orbit = shoot(section, orbit.state, orbit.minimal_period, tolerance=1e-11, most=12)
    except ConvergenceError:
        return None
    return orbit if orbit is not None and orbit.stable else None


def _proven(orbit: Orbit, away: float, used: int, near_border: float, words: str = "") -> Motion:
    mu = complex(orbit.multipliers[0])
    plural = "s" * (orbit.period > 1)
    shown = f"{words}largest Floquet multiplier |{abs(mu):.6f}| over {orbit.period} period{plural}"
    sure = abs(mu) <= near_border
    return Motion(
        name=f"period-{orbit.period}" if sure else "undecided",
        period=orbit.period,
        reason=shown if sure else f"{shown}: within {1.0 - near_border:.2g} of a bifurcation",
        state=orbit.state,
        used=used,
        orbit=orbit,
        multiplier=mu,
        lyapunov=float(np.log(abs(mu)) / (orbit.period * orbit.section.period)),
        lyapunov_error=0.0,
        exponents=np.log(np.maximum(np.abs(orbit.multipliers), 1e-300))
        / (orbit.period * orbit.section.period),
        away=away,
    )


def _long(section: ReturnMap, motion: Motion, how: Search) -> Motion | None:
    """The orbit of many periods that a motion has closed to, up to the longest; else None."""
    try:
        path = section.carry(motion.state, ROUND)
    except ConvergenceError:
        return None
    lags = np.arange(1, LONGEST + 1)
    gaps = section.distance(path[-1 - lags], path[-1])
    closed = np.flatnonzero(gaps < LONG_CLOSE)
    if closed.size == 0:
        return None
    period = int(lags[closed[0]])
    try:
        orbit = shoot(section, path[-1], period, tolerance=1e-11, most=4)
    except ConvergenceError:
        return None
    if orbit is None or not orbit.stable:
        return None
    away = float(section.distance(orbit.points, path[-1]).min())
    words = "" if period <= how.max_period else "periodic with a long period: "
    used = motion.used + ROUND
    return _proven(orbit, away, used, how.near_border, words) if away < CLOSE else None


def _closing(section: ReturnMap, window: Floats, used: int, how: Search) -> Motion | None:
    """A motion that nears itself, without an orbit polished."""
    for lag in range(1, min(how.max_period, len(window) // 3) + 1):
        now = float(section.distance(window[-1 - lag], window[-1]))
        before = float(section.distance(window[-1 - 2 * lag], window[-1 - lag]))
        if now < how.closed and (now < how.approach * before or now < 1e-3 * how.closed):
            plural = "s" * (lag > 1)
            return Motion(
                name=f"period-{lag}",
                period=lag,
                reason=f"returns within {now:.1e} after {lag} period{plural} and comes nearer",
                state=window[-1],
                used=used,
                away=now,
            )
    return None


def _open(section: ReturnMap, state: Floats, used: int, how: Search, alive: Alive) -> Motion:
    """No lag closes: chaotic by the exponent, on a torus, or undecided."""
    if not how.exponent:
        reason = f"does not return within {used} periods"
        return Motion(name="undecided", period=0, reason=reason, state=state, used=used)
    direction = np.zeros(section.dimension)
    direction[0] = section.unit[0]
    lead = section.stretch(state, direction=direction, periods=BATCH)
    path = section.stretch(lead.state, direction=lead.direction, periods=BATCHES * BATCH)
    means = path.growth.reshape(BATCHES, BATCH).mean(axis=1) / section.period
    value, error = float(means.mean()), float(means.std(ddof=1) / np.sqrt(BATCHES))
    halves = means[: BATCHES // 2].mean(), means[BATCHES // 2 :].mean()
    sure = value > 4.0 * error and min(halves) > 0.0
    told = f"largest Lyapunov exponent {value:.4g} +- {error:.2g}"
    found = Motion(
        name="chaotic" if sure else "undecided",
        period=0,
        reason=f"{told} > 0" if sure else f"does not return within {used} periods; {told}",
        state=path.state,
        used=used + (BATCHES + 1) * BATCH,
        lyapunov=value,
        lyapunov_error=error,
        batches=means,
        exponents=np.array([value]),
    )
    if sure:
        return found
    long = _long(section, found, how) if how.polish and value <= 4.0 * error else None
    if long is not None or abs(value) > 4.0 * error:
        return long or found
    return _turning(section, found, alive)


def _turning(section: ReturnMap, motion: Motion, alive: Alive) -> Motion:
    """The torus of a motion whose exponent is zero within its error, where one is proven."""
    if section.dimension == 2 and section.determinant(1) < 1.0:
        return motion  # areas shrink at one rate: no closed curve maps onto itself
    state, used = motion.state, motion.used
    for _ in range(ROUNDS):
        alive()
        try:
            path = section.carry(state, ROUND)
        except ConvergenceError:
            return motion
        state, used = path[-1], used + ROUND
        found = torus(path, unit=section.unit)
        if found is not None and found.proven:
            return _proven_torus(section, replace(motion, state=state, used=used), found)
    return replace(motion, state=state, used=used)


def _proven_torus(section: ReturnMap, motion: Motion, found: Torus) -> Motion:
    """A motion on a closed curve, if its exponent is zero over a longer run, too."""
    state, growth = leading(section, motion.state, count=2, periods=BATCH + ROUND)
    means = growth[BATCH:].reshape(LONG_BATCHES, -1, 2).mean(axis=1) / section.period
    values, errors = means.mean(axis=0), means.std(axis=0, ddof=1) / np.sqrt(LONG_BATCHES)
    value, error = float(values[0]), float(errors[0])
    alone = bool(values[1] < -4.0 * errors[1])
    shown = (
        f"largest Lyapunov exponent {value:.4g} +- {error:.2g}, second {values[1]:.4g} +- "
        f"{errors[1]:.2g}; sections on a closed curve, second base frequency "
        f"{found.frequency:.9g} +- {found.error:.1g} cycles a period, foretold to "
        f"{found.foretold:.1g}"
    )
    if not alone:
        shown += "; the second exponent is not surely negative: a third frequency may be there"
    return replace(
        motion,
        name="quasi-periodic" if alone and abs(value) <= 4.0 * error else "undecided",
        reason=shown,
        state=state,
        used=motion.used + BATCH + ROUND,
        lyapunov=value,
        lyapunov_error=error,
        batches=means[:, 0],
        exponents=values,
        torus=found,
    )


def leading(
    section: ReturnMap, start: Floats, *, count: int, periods: int
) -> tuple[Floats, Floats]:
    """The last state (d,) and ln of the growth (periods, count) in the directions that grow most.

    Tangent vectors are made orthonormal after every period (Benettin's way), in units of the map:
    the means of the columns over the period's duration are the leading Lyapunov exponents.
    """
    run = getattr(section, "spread", None)
    state, frame = np.asarray(start, dtype=float), np.eye(section.dimension, count)
    growth = np.zeros((periods, count))
    unit = section.unit[:, None]
    for number in range(periods):
        if run is None:
            visit = section.visit(state)
            state, turned = visit.points[-1], visit.jacobian @ (frame * unit)
        else:
            state, turned = run(state, directions=frame * unit)
        frame, upper = np.linalg.qr(turned / unit)
        growth[number] = np.log(np.maximum(np.abs(np.diag(upper)), 1e-300))
    return state, growth
