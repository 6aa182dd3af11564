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
from thermogear.analysis.torus import LONGEST, Torus, smooth_window, torus
from thermogear.base.errors import ConvergenceError
from thermogear.base.plan import Alive, keep_going
from thermogear.dynamics.return_map import ReturnMap

Floats = NDArray[np.float64]

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
BATCHES = 10
BATCH = 50
"""Batches of periods, and their length, for the Lyapunov exponent."""
ROUND = 2048
ROUNDS = 4
"""Sections that a torus is looked for in, twice as many each of so many times."""
HOPELESS = 0.3
"""What a record foretells this badly, a longer one will not: it lies on no closed curve."""
MORE_BATCHES = 40
"""Batches for an exponent that the first ones leave open."""
LONG_BATCHES = 16
"""Batches in so many periods, for the exponents on a torus."""
ROUNDED = 1e-7
"""Growth over a whole record that the integration may add or take by itself."""


@dataclass(frozen=True, kw_only=True)
class Search:
    """How long a motion is followed: rounds of ``first`` periods, doubling, to ``cap`` in all.

    ``max_period`` of an orbit. ``polish``: with Newton and multipliers; without, a motion that
    comes nearer to itself by ``approach`` from one period to the next, to ``closed`` units of the
    map, is periodic. A largest multiplier above ``near_border`` leaves it undecided, see
    :func:`settle`. ``exponent``: whether chaos is asked for, in batches of ``batch`` periods, and
    what closes or turns in ``sections`` of them (0: no orbit of up to 512 periods, no torus).
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
    stay below 0.998, and the motion comes nearer to it from round to round: to 0.7 of its distance,
    or twice as its multipliers say. Where the model by itself decays as slowly as that (a map that
    knows its ``slowest`` multiplier at rest), a tenth of this decay is enough, if the multiplier is
    the same with ``finer`` steps of the map. A motion that does
    not close so soon is looked at for orbits of up to 512 periods: such a one is periodic with a
    long period, its second frequency rational to the first. Chaotic: it does not return, and the
    largest Lyapunov exponent exceeds four standard errors in both halves of its record.
    Quasi-periodic: that exponent is zero within four standard errors, the second one negative
    beyond its own, and the sections lie on a closed curve, or on a few in turn, with a second base
    frequency
    (:class:`~thermogear.analysis.torus.Torus`). ``alive`` raises to end the work.
    """
    how = search or Search()
    state = np.asarray(start, dtype=float)
    used, length = 0, how.first
    known: _Approach | None = None
    failed: dict[int, float] = {}
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
            if known is None:
                orbit = _orbit(section, window, how.max_period, failed)
                known = None if orbit is None else _Approach(orbit)
            if known is not None:
                if known.reached(state, used):
                    return _proven(section, known.orbit, known.away, used, how)
                length = known.next_round(how.first)
                if known.lost:
                    known = None
                continue
        length *= 2
    try:
        return _open(section, state, used, how, alive)
    except ConvergenceError as told:
        return Motion(name="diverged", period=0, reason=str(told), state=state, used=used)


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

    def next_round(self, first: int) -> int:
        """Periods of the next round: about ``first``, whole orbits."""
        return self.orbit.period * -(-first // self.orbit.period)

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
            jacobian = orbit.jacobian
            if place:
                jacobian = orbit.section.visit(orbit.points[place], orbit.period).jacobian
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


def _sure_of(section: ReturnMap, orbit: Orbit, border: float) -> bool:
    """Whether a multiplier this near 1 stays below ``border`` with finer steps, too.

    What both differ by is its error: a quarter of what is left to 1 at most.
    """
    finer: ReturnMap | None = getattr(section, "finer", None)
    if finer is None:
        return True
    again = shoot(finer, orbit.state, orbit.period, tolerance=1e-11, most=12)
    if again is None:
        return False
    mu, other = abs(complex(orbit.multipliers[0])), abs(complex(again.multipliers[0]))
    return other <= border and abs(mu - other) <= 0.25 * (1.0 - other)


def _proven(section: ReturnMap, orbit: Orbit, away: float, used: int, how: Search) -> Motion:
    mu = complex(orbit.multipliers[0])
    plural = "s" * (orbit.period > 1)
    words = "periodic with a long period: " if orbit.period > how.max_period else ""
    shown = f"{words}largest Floquet multiplier |{abs(mu):.6f}| over {orbit.period} period{plural}"
    border = _border(section, how.near_border, orbit.period)
    duration = orbit.period * orbit.section.period
    sure = abs(mu) <= border and (abs(mu) <= how.near_border or _sure_of(section, orbit, border))
    return Motion(
        name=f"period-{orbit.period}" if sure else "undecided",
        period=orbit.period,
        reason=shown if sure else f"{shown}: within {1.0 - border:.2g} of a bifurcation",
        state=orbit.state,
        used=used,
        orbit=orbit,
        multiplier=mu,
        lyapunov=float(np.log(abs(mu)) / duration),
        lyapunov_error=0.0,
        exponents=np.log(np.maximum(np.abs(orbit.multipliers), 1e-300)) / duration,
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
                used=used,
                away=now,
            )
    return None


def _open(section: ReturnMap, state: Floats, used: int, how: Search, alive: Alive) -> Motion:
    """No lag closes: chaotic by the exponent, on a torus, or undecided."""
    if not how.exponent:
        reason = f"does not return within {used} periods"
        return Motion(name="undecided", period=0, reason=reason, state=state, used=used)
    found = _exponent(section, state, used, BATCHES, how.batch)
    if found.name == "chaotic":
        return found
    if how.sections:
        alive()
        path = section.carry(found.state, how.sections)
        found = replace(found, state=path[-1], used=found.used + len(path))
        closed = _long(section, path, found.used, how)
        if closed is not None:
            return closed
        if abs(found.lyapunov) <= 4.0 * found.lyapunov_error:
            found = _turning(section, found, path, alive)
            if found.torus is not None:
                return found
    alive()
    # the other way round: what neither closes nor turns may part slowly
    again = _exponent(section, found.state, found.used, MORE_BATCHES, how.batch)
    return again if again.name == "chaotic" else replace(found, used=again.used, state=again.state)


def _exponent(section: ReturnMap, state: Floats, used: int, batches: int, batch: int) -> Motion:
    """Chaotic by the exponent over so many batches, or undecided."""
    direction = np.zeros(section.dimension)
    direction[0] = section.unit[0]
    lead = section.stretch(state, direction=direction, periods=batch)
    path = section.stretch(lead.state, direction=lead.direction, periods=batches * batch)
    means = path.growth.reshape(batches, batch).mean(axis=1) / section.period
    value, error = float(means.mean()), float(means.std(ddof=1) / np.sqrt(batches))
    error = max(error, ROUNDED / (batches * batch * section.period))
    halves = means[: batches // 2].mean(), means[batches // 2 :].mean()
    sure = value > 4.0 * error and min(halves) > 0.0
    told = f"largest Lyapunov exponent {value:.4g} +- {error:.2g}"
    return Motion(
        name="chaotic" if sure else "undecided",
        period=0,
        reason=f"{told} > 0" if sure else f"does not return within {used} periods; {told}",
        state=path.state,
        used=used + (batches + 1) * batch,
        lyapunov=value,
        lyapunov_error=error,
        batches=means,
        exponents=np.array([value]),
    )


def _long(section: ReturnMap, path: Floats, used: int, how: Search) -> Motion | None:
    """A motion on a stable orbit of up to :data:`LONGEST` periods, shorter ones among them.

    On a torus some return is close, too, but does not become closer.
    """
    tries = 0
    for lag in range(1, min(LONGEST, (len(path) - BESIDE) // 2) + 1):
        back = section.distance(path[lag:], path[:-lag])
        first, last = float(back[:BESIDE].max()), float(back[-BESIDE:].max())
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


def _turning(section: ReturnMap, motion: Motion, path: Floats, alive: Alive) -> Motion:
    """The torus of a motion whose exponent is zero within its error, where one is proven."""
    if section.dimension == 2 and section.determinant(1) < 1.0:
        return motion  # areas shrink at one rate: no closed curve maps onto itself
    state, used = motion.state, motion.used
    for number in range(ROUNDS):
        found = torus(path, unit=section.unit)
        if found is not None and found.proven:
            return _proven_torus(section, replace(motion, state=state, used=used), found)
        if number == ROUNDS - 1 or found is None or found.foretold > HOPELESS:
            break
        alive()
        # a longer record: a second frequency near a ratio is told from it
        try:
            path = section.carry(state, 2 * len(path))
        except ConvergenceError:
            break
        state, used = path[-1], used + len(path)
    return replace(motion, state=state, used=used)


def _proven_torus(section: ReturnMap, motion: Motion, found: Torus) -> Motion:
    """A motion on a closed curve, if its exponent is zero over a longer run, too.

    A second exponent that is negative, and not yet surely so, is followed eight times as long.
    """
    frame = np.eye(section.dimension, 2)
    state, frame, _ = leading(section, motion.state, frame=frame, periods=BATCH)
    growth = np.empty((0, 2))
    for periods in (ROUND, 7 * ROUND):
        state, frame, more = leading(section, state, frame=frame, periods=periods)
        growth = np.vstack([growth, more])
        means = growth.reshape(LONG_BATCHES, -1, 2).mean(axis=1) / section.period
        value, error = _mean(section, means[:, 0], len(growth))
        # what growth does once around the torus falls out of a smooth mean
        smooth = _smooth(growth) / section.period
        second, second_error = _mean(section, smooth[:, 1], len(growth))
        # the first exponent of a torus is zero: so much the integration adds or takes
        added = abs(float(smooth[:, 0].mean()))
        alone = second + added < -4.0 * second_error
        if alone or second > 4.0 * second_error or abs(value) > 4.0 * error:
            break
    where = "a closed curve" if found.curves == 1 else f"{found.curves} closed curves in turn"
    shown = (
        f"largest Lyapunov exponent {value:.4g} +- {error:.2g}, second {second:.4g} +- "
        f"{second_error:.2g}; sections on {where}, second base frequency "
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
        used=motion.used + BATCH + len(growth),
        lyapunov=value,
        lyapunov_error=error,
        batches=means[:, 0],
        exponents=np.array([value, second]),
        torus=found,
    )


def _mean(section: ReturnMap, means: Floats, periods: int) -> tuple[float, float]:
    """The mean of batches and its error, not below what rounding does."""
    error = float(means.std(ddof=1) / np.sqrt(means.size))
    return float(means.mean()), max(error, ROUNDED / (periods * section.period))


def _smooth(growth: Floats) -> Floats:
    """Means of ``growth`` (period, k) over each batch under a smooth window (batch, k)."""
    batches = growth.reshape(LONG_BATCHES, -1, growth.shape[1])
    window = smooth_window(batches.shape[1])
    return np.asarray(np.einsum("bpk,p->bk", batches, window))


def leading(
    section: ReturnMap, start: Floats, *, frame: Floats, periods: int
) -> tuple[Floats, Floats, Floats]:
    """The last state (d,), the last frame and ln of the growth (periods, count) of its directions.

    ``frame`` (d, count): tangent vectors, made orthonormal after every period (Benettin's way), in
    units of the map; they turn to the directions that grow most, and the means of the columns over
    the period's duration are the leading Lyapunov exponents.
    """
    run = getattr(section, "spread", None)
    state = np.asarray(start, dtype=float)
    growth = np.zeros((periods, frame.shape[1]))
    unit = section.unit[:, None]
    for number in range(periods):
        if run is None:
            visit = section.visit(state)
            state, turned = visit.points[-1], visit.jacobian @ (frame * unit)
        else:
            state, turned = run(state, directions=frame * unit)
        frame, upper = np.linalg.qr(turned / unit)
        growth[number] = np.log(np.maximum(np.abs(np.diag(upper)), 1e-300))
    return state, frame, growth
