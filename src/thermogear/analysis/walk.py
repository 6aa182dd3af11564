"""One start followed by its return map alone, until it is proven which orbit it nears.

What neither closes nor runs away is left to :mod:`~thermogear.analysis.any_motion`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.agreement import APART, FOLLOW, PARTED, SAME, STARTS, Told, beside
from thermogear.analysis.orbits import Orbit, by_finer_steps, shoot
from thermogear.analysis.torus import LONGEST, Torus
from thermogear.base.arrays import Floats
from thermogear.base.display import shared
from thermogear.base.errors import ConvergenceError
from thermogear.dynamics.return_map import ReturnMap

CLOSE = 0.05
"""Distance of a return, in units of the map, from which an orbit is looked for."""
FAR = 1.0
"""An orbit further away than this is not the one that is neared."""
FORETOLD = 0.2
"""Share of its size to which a deviation must go as the multipliers say."""
NEAR_BORDER = 0.998
"""A largest multiplier above it leaves the label undecided, see :func:`settle`."""
BESIDE_DAMPING = 0.1
"""Share of its own slowest decay at rest by which a model must still decay on an orbit."""
TRIES = 2
"""Lags at most from which an orbit is looked for after one round."""
BESIDE = 16
"""Returns at both ends of a record by which it is told whether they become closer."""
RETURNED = 1e-3
"""Distance of a return, in units of the map, from which a long orbit is looked for."""
BATCH = 50
"""Periods of a batch for the Lyapunov exponent."""
ROUND = 2048
"""Sections that a torus is looked for in."""


@dataclass(frozen=True, kw_only=True)
class Search:
    """How long a motion is followed: rounds of ``first`` periods, doubling, to ``cap`` in all.

    ``max_period`` of an orbit. ``polish``: with Newton and multipliers; without, a motion that
    comes nearer to itself by ``approach`` from one period to the next, to ``closed`` units of the
    map, is periodic. A largest multiplier above ``near_border`` leaves it undecided, see
    :func:`settle`. ``exponent``: whether chaos is asked for, in batches of ``batch`` periods, and
    what closes or turns in ``sections`` of them (0: no orbit of up to 512 periods, no torus).
    Where rounding decides, ``starts`` are followed for ``follow`` periods
    (:mod:`~thermogear.analysis.agreement`); 1: one start and its word alone.
    """

    first: int = 64
    cap: int = 4096
    max_period: int = 16
    polish: bool = True
    closed: float = 1e-6
    approach: float = 0.9
    exponent: bool = True
    near_border: float = NEAR_BORDER
    batch: int = BATCH
    sections: int = ROUND
    starts: int = STARTS
    follow: int = FOLLOW


@dataclass(frozen=True, eq=False, kw_only=True)
class Motion(Told):
    """What a start settles on: "period-n", "quasi-periodic", "chaotic", "undecided", "diverged".

    ``period`` n (0: none), ``reason`` in words, the last ``state`` (d,), on the ``orbit`` where
    there is one; ``multiplier``, the largest by modulus (nan: not known), by finer steps, which
    change its modulus by ``multiplier_error``; ``lyapunov`` [1/time]
    with its ``lyapunov_error`` and the means of its ``batches``; ``exponents``: as much of the
    spectrum as the label needs, the largest first: all of a periodic orbit, two on a torus; the
    ``torus`` it is on; ``discarded`` periods run; ``away`` how far the motion itself still was from
    its orbit, in units of the map.
    """

    state: Floats
    multiplier: complex = complex("nan")
    multiplier_error: float = float("nan")
    lyapunov: float = float("nan")
    lyapunov_error: float = float("nan")
    batches: Floats = field(default_factory=lambda: np.empty(0))
    exponents: Floats = field(default_factory=lambda: np.empty(0))
    torus: Torus | None = None
    away: float = float("nan")

    def alike(self, other: Told) -> bool:
        """Whether both are the same orbit, or tori whose second frequencies are one."""
        if not isinstance(other, Motion) or self.torus is None or other.torus is None:
            return super().alike(other)
        apart = abs(self.torus.frequency - other.torus.frequency)
        return apart <= SAME + 4.0 * (self.torus.error + other.torus.error)


class Walk:
    """One start on its way, round by round, until it is proven what it settles on.

    ``state`` now, after ``discarded`` periods; ``path`` of the last round (periods, d).
    ``watched``: beside it goes a start that differs by rounding, and ``parted`` tells whether both
    came apart by a million times as much.
    """

    def __init__(
        self, section: ReturnMap, start: Floats, how: Search, *, discarded: int = 0,
        watched: bool = False,
    ) -> None:  # fmt: skip
        self.section, self.how = section, how
        self.state = np.asarray(start, dtype=float)
        self.path = np.empty((0, self.state.size))
        self.discarded = discarded
        self.parted = False
        self._twin = beside(self.state, unit=section.unit, count=1)[0] if watched else None
        self._length = how.first
        self._known: _Approach | None = None
        self._failed: dict[int, float] = {}

    def go(self, limit: int) -> Motion | None:
        """One round more, to ``limit`` periods in all at most: what it proves, if anything."""
        how, section = self.how, self.section
        self._length = min(self._length, limit - self.discarded)
        before = self.state
        try:
            self.path = section.carry(before, self._length)
        except ConvergenceError as why:
            return Motion(
                name="diverged", period=0, reason=str(why), state=before, discarded=self.discarded
            )
        self._watch()
        self.discarded += self._length
        self.state = self.path[-1]
        window = np.vstack([before[None], self.path])[-(2 * how.max_period + 1) :]
        if not how.polish:
            self._length *= 2
            return _closing(section, window, self.discarded, how)
        if self._known is None:
            orbit = _orbit(section, window, how.max_period, self._failed)
            self._known = None if orbit is None else _Approach(orbit)
        known = self._known
        if known is None:
            self._length *= 2
            return None
        if known.reached(self.state, self.discarded):
            return _proven(section, known.orbit, known.away, self.discarded, how)
        period = known.orbit.period
        self._length = period * -(-how.first // period)
        if known.lost:
            self._known = None
        return None

    def _watch(self) -> None:
        """Carry the start beside this one as far, until both have parted."""
        if self._twin is None or self.parted:
            return
        try:
            twin = self.section.carry(self._twin, len(self.path))
        except ConvergenceError:
            self.parted = True
            return
        self._twin = twin[-1]
        self.parted = bool(self.section.distance(self.path, twin).max() > PARTED * APART)


class _Approach:
    """How a motion nears a stable ``orbit``, told after every round of whole orbits.

    Its deviation in the eigenvectors of the orbit's Jacobian, each of which shrinks by its
    multiplier. ``away``: the distance from the orbit in units of the map; ``lost``: too far, or not
    as the multipliers say.
    """

    def __init__(self, orbit: Orbit) -> None:
        self.orbit = orbit
        self.away, self.near = np.inf, np.inf
        self.lost = False
        self._right = 0
        self._before: tuple[int, NDArray[np.complex128]] | None = None
        self._bases: dict[int, tuple[NDArray[np.complex128], NDArray[np.complex128]]] = {}

    def reached(self, state: Floats, used: int) -> bool:
        """Whether the motion, in ``state`` after ``used`` periods, comes to the orbit."""
        orbit = self.orbit
        distance = orbit.section.distance(orbit.points, state)
        place = int(distance.argmin())
        self.away = float(distance[place])
        if self.away < 1e-9:
            return True
        foretold = self._as_foretold(state, place, used)
        self._right = self._right + 1 if foretold else 0
        if self.away >= CLOSE:
            self.lost = self.away > FAR or not foretold
            return self._right >= 2
        if self.away < 0.7 * self.near and np.isfinite(self.near):
            return True
        self.near = min(self.near, self.away) if np.isfinite(self.near) else self.away
        return self._right >= 2

    def _as_foretold(self, state: Floats, place: int, used: int) -> bool:
        values, into = self._basis(place)
        now = into @ ((state - self.orbit.points[place]) / self.orbit.section.unit)
        before, self._before = self._before, (used, now)
        if before is None or (used - before[0]) % self.orbit.period:
            return before is None
        shrunk = values ** ((used - before[0]) // self.orbit.period)
        size, told = float(np.linalg.norm(before[1])), shrunk * before[1]
        slowest = float(np.abs(shrunk).max())
        nearer = float(np.linalg.norm(now)) <= size * (1.0 - 0.5 * (1.0 - slowest))
        return nearer and float(np.linalg.norm(now - told)) <= FORETOLD * size

    def _basis(self, place: int) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Multipliers, and what takes a deviation at a point of the orbit to its eigenvectors."""
        if place not in self._bases:
            orbit, unit = self.orbit, self.orbit.section.unit
            jacobian = (
                orbit.section.visit(orbit.points[place], orbit.period).jacobian
                if place
                else orbit.jacobian
            )
            values, vectors = np.linalg.eig(jacobian * unit / unit[:, None])
            self._bases[place] = (values.astype(complex), np.linalg.pinv(vectors.astype(complex)))
        return self._bases[place]


def _orbit(
    section: ReturnMap, window: Floats, max_period: int, failed: dict[int, float]
) -> Orbit | None:
    """The stable orbit at the end of ``window``, by the least lag of those that return that is one.

    A motion of small size returns near itself after any lag: the next lag tried comes five times
    as near. ``failed``: distances of the returns from which a lag was tried in vain so far; it is
    tried again from half of it.
    """
    bound, tries = CLOSE, 0
    for lag in range(1, min(max_period, len(window) - 1) + 1):
        away = float(section.distance(window[-1 - lag], window[-1]))
        if away >= bound:
            continue
        bound = 0.2 * away
        if away > 0.5 * failed.get(lag, np.inf):
            continue
        orbit = _closed(section, window[-1], lag)
        tries += 1
        if orbit is not None:
            return orbit
        failed[lag] = away
        if tries == TRIES:
            break
    return None


def _closed(section: ReturnMap, state: Floats, lag: int) -> Orbit | None:
    """The stable orbit of least period that Newton's rule finds from ``state``."""
    try:
        orbit = shoot(section, state, lag, tolerance=1e-11, most=12)
        if orbit is not None and orbit.minimal_period != orbit.period:
            orbit = shoot(section, orbit.state, orbit.minimal_period, tolerance=1e-11, most=12)
    except ConvergenceError:
        return None
    return orbit if orbit is not None and orbit.stable else None


def _border(section: ReturnMap, near_border: float, periods: int) -> float:
    """Largest multiplier that is told from 1: closer only where the model decays so slowly."""
    slowest = float(getattr(section, "slowest", 0.0))
    if not 0.0 < slowest < 1.0:
        return near_border
    return max(near_border, float(slowest ** (BESIDE_DAMPING * periods)))


def _proven(section: ReturnMap, orbit: Orbit, away: float, used: int, how: Search) -> Motion:
    """The label of ``orbit``, whose largest multiplier finer steps must find below the border.

    Beyond ``near_border`` both may differ by a quarter of what is left to 1 at most.
    """
    again = by_finer_steps(orbit)
    border = _border(section, how.near_border, orbit.period)
    every, largest, error = orbit.multipliers, abs(complex(orbit.multipliers[0])), np.inf
    if again is not None:
        every = again.multipliers
        error = abs(largest - abs(complex(every[0])))
    size = abs(complex(every[0]))
    plural = "s" * (orbit.period > 1)
    words = "periodic with a long period: " if orbit.period > how.max_period else ""
    shown = f"{words}largest Floquet multiplier |{shared(size, error=error)}|"
    shown += f" over {orbit.period} period{plural}"
    below = max(largest, size) <= border
    allowed = np.inf if largest <= how.near_border else 0.25 * (1.0 - size)
    sure = below and error <= allowed and again is not None
    if not below:
        shown += f": within {1.0 - border:.2g} of a bifurcation"
    elif not sure:
        shown += ": finer steps do not confirm it"
    duration = orbit.period * orbit.section.period
    exponents = np.log(np.maximum(np.abs(every), 1e-300)) / duration
    return Motion(
        name=f"period-{orbit.period}" if sure else "undecided",
        period=orbit.period,
        reason=shown,
        state=orbit.state,
        discarded=used,
        orbit=orbit,
        multiplier=complex(every[0]),
        multiplier_error=error,
        lyapunov=float(exponents[0]),
        lyapunov_error=0.0,
        exponents=exponents,
        away=away,
    )


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
                discarded=used,
                away=now,
            )
    return None


def long_orbit(section: ReturnMap, path: Floats, used: int, how: Search) -> Motion | None:
    """A motion on a stable orbit of up to :data:`LONGEST` periods, shorter ones among them.

    On a torus some return is close, too, but does not become closer.
    """
    tries = 0
    for lag in range(1, min(LONGEST, (len(path) - BESIDE) // 2) + 1):
        first = float(section.distance(path[lag : lag + BESIDE], path[:BESIDE]).max())
        last = float(section.distance(path[-BESIDE:], path[-BESIDE - lag : -lag]).max())
        if last >= RETURNED or (last >= 1e-9 and last >= 0.3 * first):
            continue
        orbit = _closed(section, path[-1], lag)
        if orbit is not None:
            off = float(section.distance(orbit.points, path[-1]).min())
            before = float(section.distance(orbit.points, path[0]).min())
            if off < 1e-7 or off < 0.7 * before < 0.7 * CLOSE:
                return _proven(section, orbit, off, used, how)
        tries += 1
        if tries == TRIES:
            break
    return None
