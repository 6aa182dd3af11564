"""What a model of any dimension settles on from one start, by its return map alone.

A motion of one mass is labelled by :mod:`~thermogear.analysis.labels`, which knows more of it. Here
a motion is periodic, with its orbit and Floquet multipliers as proof, chaotic by its largest
Lyapunov exponent, quasi-periodic on a proven torus, or undecided.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from typing import TypeVar

import numpy as np

from thermogear.analysis.agreement import PATIENCE, End, agreed, beside, judged, most
from thermogear.analysis.torus import Torus, smooth_window, torus
from thermogear.analysis.walk import BATCH, ROUND, Motion, Search, Walk, long_orbit
from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError
from thermogear.base.plan import Alive, keep_going
from thermogear.dynamics.return_map import ReturnMap

_Made = TypeVar("_Made")

BATCHES = 10
"""Batches of periods for the Lyapunov exponent."""
ROUNDS = 4
"""Times that a torus is looked for, in twice as many sections each."""
HOPELESS = 0.3
"""What a record foretells this badly, a longer one will not: it lies on no closed curve."""
MORE_BATCHES = 40
"""Batches for an exponent that the first ones leave open."""
LONG_BATCHES = 16
"""Batches in so many periods, for the exponents on a torus."""
ROUNDED = 1e-7
"""Growth over a whole record that the integration may add or take by itself."""


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
    (:class:`~thermogear.analysis.torus.Torus`).

    A chaotic motion, and one that a start 1e-13 beside it leaves on its way, is followed from
    ``search.starts`` starts so far apart: all must end alike, or none may close in
    ``search.follow`` periods (:mod:`~thermogear.analysis.agreement`). ``alive`` raises to end the
    work.
    """
    how = search or Search()
    walk = Walk(section, start, how, watched=how.starts > 1)
    found: Motion | None = None
    while found is None and walk.discarded < how.cap:
        alive()
        found = walk.go(how.cap)
    if found is None:
        found = _open(section, walk.state, walk.discarded, how, alive)
    if how.starts < 2 or found.name == "undecided" or not (walk.parted or found.name == "chaotic"):
        return found
    return _confirmed(section, np.asarray(start, dtype=float), found, how, alive)


def _confirmed(
    section: ReturnMap, start: Floats, first: Motion, how: Search, alive: Alive
) -> Motion:
    """The label ``first`` of a start if it holds for starts that differ by rounding, too.

    Each is followed until it closes, at most for ``follow`` periods, and then asked for chaos or a
    torus. They take their rounds together, so that the first two that end apart end the work.
    """
    walks = [
        Walk(section, near, how) for near in beside(start, unit=section.unit, count=how.starts - 1)
    ]
    if first.name == "chaotic":
        walks.append(Walk(section, first.state, how, discarded=first.discarded))
    ends: list[End[Motion]] = []
    longest = how.cap if first.name == "quasi-periodic" else max(how.cap, how.follow)
    for limit in (longest, PATIENCE * longest):
        while agreed(first, ends) and any(walk.discarded < limit for walk in walks):
            alive()
            found = _together(section, partial(_closes, limit=limit), walks)
            ends += [End(m, w.discarded) for m, w in zip(found, walks, strict=True) if m]
            walks = [w for m, w in zip(found, walks, strict=True) if not m]
        if not most(first, ends, len(walks)):
            break
    if agreed(first, ends):
        left = partial(_left, alive=alive)
        ends += _together(section, left, walks)
    else:
        ends += [End(None, walk.discarded) for walk in walks]
    return judged(first, ends)


def _closes(walk: Walk, limit: int) -> Motion | None:
    """One round more of a start: what it ends on, on a long orbit, too."""
    if walk.discarded >= limit:
        return None
    found = walk.go(limit)
    if found is None and walk.how.sections and len(walk.path) >= walk.how.sections:
        found = long_orbit(walk.section, walk.path, walk.discarded, walk.how)
    return found


def _left(walk: Walk, alive: Alive) -> End[Motion]:
    """Where a start is that has not closed."""
    found = _open(walk.section, walk.state, walk.discarded, walk.how, alive)
    if found.name in ("chaotic", "undecided"):
        return End(None, walk.discarded, found.name == "chaotic")
    return End(found, found.discarded)


def _together(
    section: ReturnMap, make: Callable[[Walk], _Made], walks: Sequence[Walk]
) -> list[_Made]:
    """What ``make`` gives of every start, on threads where the map allows it."""
    threads = (os.cpu_count() or 1) if getattr(section, "concurrent", False) else 1
    with ThreadPoolExecutor(min(threads, max(1, len(walks)))) as pool:
        return list(pool.map(make, walks))


def _open(section: ReturnMap, state: Floats, used: int, how: Search, alive: Alive) -> Motion:
    """No lag closes: chaotic by the exponent, on a torus, undecided, or it runs away."""
    try:
        return _opened(section, state, used, how, alive)
    except ConvergenceError as why:
        return Motion(name="diverged", period=0, reason=str(why), state=state, discarded=used)


def _opened(section: ReturnMap, state: Floats, used: int, how: Search, alive: Alive) -> Motion:
    """No lag closes: chaotic by the exponent, on a torus, or undecided."""
    if not how.exponent:
        reason = f"does not return within {used} periods"
        return Motion(name="undecided", period=0, reason=reason, state=state, discarded=used)
    found = _exponent(section, state, used, BATCHES, how.batch)
    if found.name == "chaotic":
        return found
    if how.sections:
        alive()
        path = section.carry(found.state, how.sections)
        found = replace(found, state=path[-1], discarded=found.discarded + len(path))
        closed = long_orbit(section, path, found.discarded, how)
        if closed is not None:
            return closed
        if abs(found.lyapunov) <= 4.0 * found.lyapunov_error:
            found = _turning(section, found, path, alive)
            if found.torus is not None:
                return found
    alive()
    # the other way round: what neither closes nor turns may part slowly
    again = _exponent(section, found.state, found.discarded, MORE_BATCHES, how.batch)
    return (
        again
        if again.name == "chaotic"
        else replace(found, discarded=again.discarded, state=again.state)
    )


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
        discarded=used + (batches + 1) * batch,
        lyapunov=value,
        lyapunov_error=error,
        batches=means,
        exponents=np.array([value]),
        followed=(used + (batches + 1) * batch) * sure,
    )


def _turning(section: ReturnMap, motion: Motion, path: Floats, alive: Alive) -> Motion:
    """The torus of a motion whose exponent is zero within its error, where one is proven."""
    if section.dimension == 2 and abs(section.determinant(1)) < 1.0:
        return motion  # areas shrink at one rate: no closed curve maps onto itself
    state, used = motion.state, motion.discarded
    for number in range(ROUNDS):
        found = torus(path, unit=section.unit)
        if found is not None and found.proven:
            return _proven_torus(section, replace(motion, state=state, discarded=used), found)
        if number == ROUNDS - 1 or found is None or found.foretold > HOPELESS:
            break
        alive()
        # a longer record: a second frequency near a ratio is told from it
        try:
            path = section.carry(state, 2 * len(path))
        except ConvergenceError:
            break
        state, used = path[-1], used + len(path)
    return replace(motion, state=state, discarded=used)


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
        discarded=motion.discarded + BATCH + len(growth),
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
