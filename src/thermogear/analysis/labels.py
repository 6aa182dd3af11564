"""Labels of the settled motion, each with its proof: period n, chaotic, or undecided.

The equation has det D P^n = exp(-2 zeta n T) < 1 everywhere, so no torus can exist: a motion
that never closes is chaotic or has not settled.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.agreement import (
    APART,
    FOLLOW,
    PARTED,
    PATIENCE,
    STARTS,
    End,
    agreed,
    directions,
    judged,
    most,
)
from thermogear.analysis.any_motion import settle
from thermogear.analysis.lyapunov import Lyapunov, lyapunov_exponents, of_any_dimension
from thermogear.analysis.proof import NEAR_BORDER, Label, closing, periodic, proves_chaos, returned
from thermogear.analysis.section import lanes_of, starts_of
from thermogear.analysis.walk import Search
from thermogear.base.arrays import Floats
from thermogear.base.bounds import whole
from thermogear.base.errors import InputError
from thermogear.base.period import turns
from thermogear.dynamics.blocks import Progress
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.return_map import return_map

LEAST_OF_TURN = 8
"""Turns after which an orbit may close are searched for at least."""


def label(
    model: object,
    *,
    initial_state: ArrayLike = (0.0, 0.0),
    max_period: int = 64,
    discard: int = 500,
    cap: int = 32_000,
    near_border: float = NEAR_BORDER,
    batches: int = 20,
    batch_periods: int = 500,
    starts: int = STARTS,
    follow: int = FOLLOW,
    threads: int | None = None,
) -> Label:
    """Label of the motion a model of one lane settles on from ``initial_state``.

    ``model``: a clearance oscillator (:class:`TorsionalModel`, :class:`DeadZoneModel`,
    :class:`PairModel`), whose proof rests on its event-exact return map and is told below. For any
    other model with a return map see :func:`~thermogear.analysis.any_motion.settle`; a proven torus
    is "quasi-periodic" there, and the rule of the starts is the same. Where its periods are dear,
    fewer ``starts`` (1: this one alone) or a shorter ``follow`` give a weaker label that says so.
    A model of a derivative and a period alone can be simulated and is refused here.
    ``initial_state`` (x, x') is in the units of the model: pure numbers for
    :class:`TorsionalModel`, SI for a model in SI.
    The transient runs in rounds, ``discard`` periods first, then doubling to at most ``cap``.
    Periodic: the section returns after n periods, Newton shooting on the event-exact map finds
    the closed orbit there, the trajectory has come within 1e-7 half backlashes of it and still
    approaches, every shorter lag differs by more than a thousand closure tolerances, and the
    largest Floquet multiplier stays below ``near_border`` in modulus. Chaotic: no lag up to
    ``max_period`` closes and the largest Lyapunov exponent is positive by more than four
    standard errors, in both halves of its record.

    The label is given only when the same motion on twice as many sub-steps of the event-exact maps
    (of a turn on a quarter more) ends there too. Where a difference of 1e-13 half backlashes grows
    a millionfold on the way, ``starts`` starts that differ by so much are followed, to where each
    closes, for ``follow`` periods (``cap`` if that is more): all must end on one orbit, or, for
    "chaotic", none may close and all must still part in the last round. Everything else is
    undecided. Chaos is therefore an estimate, "chaotic for N periods, k starts": no exponent says
    how long it lasts.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> str(label(model, initial_state=(1.166, 0.002)))
    'period-1'
    """
    if of_any_dimension(model):
        search = Search(
            first=min(discard, cap),
            cap=cap,
            max_period=max_period,
            near_border=near_border,
            starts=starts,
            follow=follow,
        )
        return _any(model, initial_state, search)
    lanes = lanes_of(model)
    if len(lanes) != 1:
        raise InputError("model", f"{len(lanes)} lanes", allowed="one lane; labels() takes many")
    found = labels(
        lanes,
        initial_state=initial_state,
        max_period=max_period,
        discard=discard,
        cap=cap,
        near_border=near_border,
        batches=batches,
        batch_periods=batch_periods,
        starts=starts,
        follow=follow,
        threads=threads,
    )[0]
    if found.orbit is None:
        return found
    # with its model the orbit can be continued
    return replace(found, orbit=replace(found.orbit, model=model))


def _any(model: object, initial_state: ArrayLike, search: Search) -> Label:
    """The label of a model of any dimension by its return map alone."""
    section = return_map(model)
    start = starts_of(initial_state, 1, dimension=section.dimension)[0]
    motion = settle(section, start, search)
    exponent = None
    if np.isfinite(motion.lyapunov) and motion.batches.size:
        exponent = Lyapunov(
            value=motion.lyapunov,
            error=motion.lyapunov_error,
            sum=float(np.log(abs(section.determinant(1))) / section.period),
            batches=motion.batches,
            state=motion.state,
        )
    orbit = None if motion.orbit is None else replace(motion.orbit, model=model)
    return Label(
        motion.name, motion.period, motion.reason, motion.discarded, orbit, exponent,
        followed=motion.followed, starts=motion.starts,
    )  # fmt: skip


def labels(
    model: object,
    *,
    initial_state: ArrayLike = (0.0, 0.0),
    max_period: int = 64,
    discard: int = 500,
    cap: int = 32_000,
    near_border: float = NEAR_BORDER,
    batches: int = 20,
    batch_periods: int = 500,
    starts: int = STARTS,
    follow: int = FOLLOW,
    threads: int | None = None,
    progress: Progress | None = None,
) -> list[Label]:
    """:func:`label` for every lane of ``model``; ``progress`` counts finished lanes.

    Of lanes whose period is a turn ``discard``, ``cap``, ``follow`` and ``batch_periods`` count
    mesh periods and are rounded up to turns; ``max_period`` counts turns: no more than fit four
    times into ``cap``, or :data:`LEAST_OF_TURN`.
    """
    for name, value, least in (
        ("max_period", max_period, 1), ("discard", discard, 1), ("starts", starts, 2),
        ("follow", follow, 1),
    ):  # fmt: skip
        whole(name, value, least=least)
    lanes = lanes_of(model)
    start = starts_of(initial_state, len(lanes))
    of = lanes.mesh_periods
    if of > 1:
        max_period = min(max_period, max(cap // (4 * of), LEAST_OF_TURN))
    search = _Search(
        max_period, discard, cap, near_border, batches, batch_periods, starts, follow, threads, of
    )
    found, top = _settle(lanes, start, search, progress)
    return [
        replace(one, mesh_periods=of)
        for one in _confirmed(lanes, start, found, top, search, progress)
    ]


@dataclass(frozen=True)
class _Search:
    max_period: int
    discard: int
    cap: int
    near_border: float
    batches: int
    batch_periods: int
    starts: int
    follow: int
    threads: int | None
    mesh_periods: int

    def judge(self, lane: Lanes, window: Floats, elapsed: int) -> tuple[Label | None, bool]:
        """:func:`periodic` within the bounds of this search."""
        return periodic(
            lane,
            window,
            max_period=self.max_period,
            elapsed=elapsed,
            near_border=self.near_border,
        )

    def rounds(self, most: int) -> Iterator[int]:
        """Lengths of the rounds: ``discard`` mesh periods and a window, then doubling.

        In periods of the lanes; ``most`` in mesh periods.
        """
        elapsed, length = 0, self.discard
        while elapsed < most:
            count = turns(length, of=self.mesh_periods) + 2 * self.max_period
            yield count
            elapsed += count * self.mesh_periods
            length *= 2


def _settle(
    lanes: Lanes, start: Floats, search: _Search, progress: Progress | None
) -> tuple[list[Label], Floats]:
    """What the starts themselves settle on, and ln of how far neighbours parted on the way."""
    state = start.copy()
    found: list[Label | None] = [None] * len(lanes)
    waiting = np.arange(len(lanes))
    level, top = np.zeros(len(lanes)), np.zeros(len(lanes))
    elapsed = 0
    for length in search.rounds(search.cap):
        group = lanes.take(waiting).ensemble(state[waiting], threads=search.threads, parting=True)
        window = group.run(length, keep=2 * search.max_period)
        elapsed += length * search.mesh_periods
        state[waiting] = group.state
        top[waiting] = np.fmax(top[waiting], level[waiting] + group.top)
        level[waiting] += group.level
        silent: list[int] = []
        for row, lane in enumerate(waiting.tolist()):
            verdict, quiet = search.judge(lanes.take(lane), window[row], elapsed)
            found[lane] = verdict
            if quiet:
                silent.append(lane)
        # no lag closes: chaos is asked once the transient had a fair chance
        asked = [lane for lane in silent if found[lane] is None]
        if asked and (elapsed >= 4 * search.discard or elapsed >= search.cap):
            proofs = lyapunov_exponents(
                lanes.take(np.array(asked)),
                initial_state=state[asked],
                discard=0,
                batches=search.batches,
                batch_periods=search.batch_periods,
                threads=search.threads,
            )
            for lane, proof in zip(asked, proofs, strict=True):
                state[lane] = proof.state
                if proves_chaos(proof):
                    found[lane] = Label(
                        "chaotic",
                        0,
                        f"largest Lyapunov exponent {proof.value:.4f} +- {proof.error:.4f} > 0",
                        elapsed,
                        lyapunov=proof,
                    )
        waiting = np.array([i for i in waiting if found[i] is None], dtype=int)
        if progress is not None:
            progress(len(lanes) - waiting.size, 2 * len(lanes))
        if waiting.size == 0:
            break
    for lane in waiting.tolist():
        found[lane] = Label(
            "undecided",
            0,
            f"neither closed nor chaotic by its exponent after {elapsed} periods",
            elapsed,
        )
    return [one for one in found if one is not None], top


def _confirmed(
    lanes: Lanes,
    start: Floats,
    found: Sequence[Label],
    top: Floats,
    search: _Search,
    progress: Progress | None,
) -> list[Label]:
    """The labels that hold for starts that differ by rounding; the others are undecided.

    A neighbour within :data:`APART` of a start stays near it where the linearised motion never
    parts them by more than :data:`PARTED`; then the same start on twice as many sub-steps is
    enough. Elsewhere rounding decides where a motion ends, and all of ``starts`` are followed.
    """
    chaotic = np.array([one.name == "chaotic" for one in found], dtype=bool)
    asked = np.array([i for i, one in enumerate(found) if one.name != "undecided"], dtype=int)
    parted, own = asked[(top > np.log(PARTED))[asked] | chaotic[asked]], np.flatnonzero(chaotic)
    unit = lanes.unit
    owner = np.repeat(parted, search.starts - 2)
    beside = np.tile(directions(count=search.starts - 2, dimension=2), (parted.size, 1))
    near = start[owner] + APART * np.maximum(unit, np.abs(start))[owner] * beside
    ends: list[list[End[Label]]] = [[] for _ in found]
    groups = (
        (1, np.concatenate([own, owner]), np.concatenate([start[own], near])),
        (2, asked, start[asked]),
    )
    total, done = max(1, sum(mine.size for _, mine, _ in groups)), 0
    for refine, mine, begin in groups:
        for over in _follow(lanes, begin, mine, found, search, refine, ends):
            done += over
            if progress is not None:
                progress(len(lanes) + done * len(lanes) // total, 2 * len(lanes))
    if progress is not None:
        progress(2 * len(lanes), 2 * len(lanes))
    return [judged(one, theirs) if theirs else one for one, theirs in zip(found, ends, strict=True)]


def _follow(
    lanes: Lanes,
    start: Floats,
    owner: NDArray[np.int64],
    found: Sequence[Label],
    search: _Search,
    refine: int,
    ends: list[list[End[Label]]],
) -> Iterator[int]:
    """Follow every start to where it closes, at most to ``follow``; adds to the owners' ends.

    Yields how many starts each round was the last for.

    Where most starts of a motion have closed by then, and on one orbit, the others get
    :data:`PATIENCE` times as long. Where two ended apart, nothing is left to ask.
    """
    state = start.copy()
    waiting = np.arange(owner.size)
    elapsed = 0
    last = max(search.cap, search.follow)
    lively = np.zeros(owner.size, bool)
    for length in search.rounds(PATIENCE * last):
        if waiting.size == 0:
            break
        mine = owner[waiting]
        elapsed += length * search.mesh_periods
        parting = elapsed >= last
        group = lanes.take(mine).ensemble(
            state[waiting], threads=search.threads, refine=refine, parting=parting
        )
        window = group.run(length, keep=2 * search.max_period)
        state[waiting] = group.state
        open_ = []
        for row, lane in enumerate(mine.tolist()):
            one = lanes.take(lane)
            verdict = returned(one, window[row], found[lane], elapsed)
            if verdict is None:
                verdict, _ = search.judge(one, window[row], elapsed)
            if verdict is None:
                open_.append(waiting[row])
                lively[waiting[row]] = group.level[row] > 0.0 and not closing(
                    window[row] / one.unit[0], search.max_period
                )
            else:
                ends[lane].append(End(verdict, elapsed))
        left = Counter(owner[open_].tolist())
        going = {lane for lane, many in left.items() if agreed(found[lane], ends[lane])}
        if parting:
            going &= {lane for lane, many in left.items() if most(found[lane], ends[lane], many)}
        over = [row for row in open_ if owner[row] not in going]
        waiting = np.array([row for row in open_ if owner[row] in going], dtype=int)
        for row in over:
            ends[owner[row]].append(End(None, elapsed, bool(lively[row])))
        yield mine.size - waiting.size
    for row in waiting.tolist():
        ends[owner[row]].append(End(None, elapsed, bool(lively[row])))
