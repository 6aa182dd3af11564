"""Labels of the settled motion, each with its proof: period n, chaotic, or undecided.

The equation has det D P^n = exp(-2 zeta n T) < 1 everywhere, so no torus can exist: a motion
that never closes is chaotic or has not settled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.lyapunov import Lyapunov, lyapunov_exponents
from thermogear.analysis.orbits import Orbit, shoot
from thermogear.analysis.section import Ensemble, ReturnMap, lanes_of, scales, starts_of
from thermogear.base.errors import InputError
from thermogear.dynamics.blocks import Progress
from thermogear.dynamics.tables import Lanes

Floats = NDArray[np.float64]

NEAR_BORDER = 0.998
SETTLED = 1e-7
CLOSE = 1e-5


@dataclass(frozen=True)
class Label:
    """What a trajectory settles on.

    ``name`` is "period-n", "chaotic", "diverged" or "undecided"; ``period`` n (0: none found;
    also given for an undecided motion that seems to close). The proof: ``orbit`` with its
    Floquet multipliers, or ``lyapunov`` with its error. ``reason`` says it in words,
    ``discarded`` how many periods went by before.
    """

    name: str
    period: int
    reason: str
    discarded: int
    orbit: Orbit | None = None
    lyapunov: Lyapunov | None = None

    @property
    def multipliers(self) -> NDArray[np.complex128] | None:
        """Floquet multipliers of the orbit, when there is one."""
        return None if self.orbit is None else self.orbit.multipliers

    def __str__(self) -> str:
        return self.name


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
    threads: int | None = None,
) -> Label:
    """Label of the motion a model of one lane settles on from ``initial_state``.

    ``initial_state`` (x, x') is in the units of the model: pure numbers for
    :class:`TorsionalModel`, SI for a model in SI.
    The transient runs in rounds, ``discard`` periods first, then doubling to at most ``cap``.
    Periodic: the section returns after n periods, Newton shooting on the event-exact map finds
    the closed orbit there, the trajectory has come within 1e-7 half backlashes of it and still
    approaches, every shorter lag differs by more than a thousand closure tolerances, and the
    largest Floquet multiplier stays below ``near_border`` in modulus. Chaotic: no lag up to
    ``max_period`` closes and the largest Lyapunov exponent is positive by more than four
    standard errors, in both halves of its record. The label stands only when the same motion
    on twice as many sub-steps of the event-exact maps earns it too; everything else is
    undecided.
    """
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
        threads=threads,
    )[0]
    if found.orbit is None:
        return found
    # with its model the orbit can be continued
    return replace(found, orbit=replace(found.orbit, model=model))


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
    threads: int | None = None,
    progress: Progress | None = None,
) -> list[Label]:
    """:func:`label` for every lane of ``model``; ``progress`` counts finished lanes."""
    for name, value, least in (("max_period", max_period, 1), ("discard", discard, 1)):
        if not (least <= value < np.inf and int(value) == value):
            raise InputError(name, value, allowed=f"a whole number >= {least}")
    lanes = lanes_of(model)
    start = starts_of(initial_state, len(lanes))
    search = _Search(max_period, discard, cap, near_border, batches, batch_periods, threads)
    total = 2 * len(lanes)
    first = _settle(
        lanes, start, search, 1, None if progress is None else partial(_tell, progress, 0, total)
    )
    again = _settle(
        lanes,
        start,
        search,
        2,
        None if progress is None else partial(_tell, progress, len(lanes), total),
    )
    return [_agreed(one, other) for one, other in zip(first, again, strict=True)]


@dataclass(frozen=True)
class _Search:
    max_period: int
    discard: int
    cap: int
    near_border: float
    batches: int
    batch_periods: int
    threads: int | None


def _tell(progress: Progress, before: int, total: int, done: int) -> None:
    progress(before + done, total)


def _agreed(one: Label, other: Label) -> Label:
    """A label stands when another rounding of the same motion leads there too."""
    if str(one) == str(other):
        return one
    if "undecided" in (one.name, other.name):
        return one if one.name == "undecided" else other
    reason = f"where the transient ends depends on rounding: {one} or {other}"
    return Label("undecided", 0, reason, max(one.discarded, other.discarded))


def _settle(
    lanes: Lanes,
    start: Floats,
    search: _Search,
    refine: int,
    progress: Callable[[int], None] | None,
) -> list[Label]:
    """Labels from one run with ``refine`` times the sub-steps."""
    state = start.copy()
    found: list[Label | None] = [None] * len(lanes)
    waiting = np.arange(len(lanes))
    elapsed = 0
    length = search.discard
    keep = 2 * search.max_period
    while waiting.size and elapsed < search.cap:
        group = Ensemble(lanes.take(waiting), state[waiting], threads=search.threads, refine=refine)
        window = group.run(length + keep, keep=keep)
        elapsed += length + keep
        state[waiting] = group.state
        silent: list[int] = []
        for row, lane in enumerate(waiting.tolist()):
            verdict, quiet = _periodic(
                lanes.take(lane), window[row], search.max_period, elapsed, search.near_border
            )
            found[lane] = verdict
            if quiet:
                silent.append(lane)
        # no lag closes: chaos is asked once the transient had a fair chance
        last = elapsed >= search.cap
        asked = [lane for lane in silent if found[lane] is None]
        if asked and (elapsed >= 4 * search.discard or last):
            proofs = lyapunov_exponents(
                lanes.take(np.array(asked)),
                initial_state=state[asked],
                discard=0,
                batches=search.batches,
                batch_periods=search.batch_periods,
                threads=search.threads,
                refine=refine,
            )
            for lane, proof in zip(asked, proofs, strict=True):
                state[lane] = proof.state
                if _positive(proof):
                    found[lane] = Label(
                        "chaotic",
                        0,
                        f"largest Lyapunov exponent {proof.value:.4f} +- {proof.error:.4f} > 0",
                        elapsed,
                        lyapunov=proof,
                    )
        waiting = np.array([i for i in waiting if found[i] is None], dtype=int)
        length *= 2
        if progress is not None:
            progress(len(lanes) - waiting.size)
    for lane in waiting.tolist():
        found[lane] = Label(
            "undecided",
            0,
            f"neither closed nor provably chaotic after {elapsed} periods",
            elapsed,
        )
    return [one for one in found if one is not None]


def _positive(proof: Lyapunov) -> bool:
    half = proof.batches.size // 2
    return (
        bool(np.all(np.isfinite(proof.batches)))
        and proof.value > 4.0 * proof.error
        and bool(proof.batches[:half].mean() > 0.0)
        and bool(proof.batches[half:].mean() > 0.0)
    )


def _periodic(
    lane: Lanes, window: Floats, max_period: int, elapsed: int, near_border: float
) -> tuple[Label | None, bool]:
    """The label the last sections support, and whether no lag comes near closing."""
    if not np.all(np.isfinite(window)):
        return Label("diverged", 0, "|x| > 1e6 half backlashes or not finite", elapsed), False
    unit = scales(lane)
    scaled = window / unit
    gaps = [
        float(np.max(np.abs(scaled[-lag:] - scaled[-2 * lag : len(scaled) - lag])))
        for lag in range(1, max_period + 1)
    ]
    close = np.flatnonzero(np.array(gaps) < CLOSE)
    if close.size == 0:
        return None, min(gaps) > 10.0 * CLOSE
    lag = int(close[0]) + 1
    section = ReturnMap(lane)
    orbit = shoot(section, window[-1], lag)
    if orbit is None or not orbit.stable:
        return None, False
    period = orbit.minimal_period
    if period != lag:
        # a spiral returns close after several of its periods
        shorter = shoot(section, orbit.state, period)
        if shorter is None:
            return None, False
        orbit = shorter
    points = orbit.points / unit
    # the window against the orbit, in step: its last state is the orbit's first point
    turned = points[(np.arange(len(scaled)) - (len(scaled) - 1)) % period]
    away = np.max(np.abs(scaled - turned), axis=1)
    early, late = float(away[: len(away) // 2].max()), float(away[len(away) // 2 :].max())
    largest = float(np.max(np.abs(orbit.multipliers)))
    shown = f"largest Floquet multiplier {_shown(orbit)} over {period} period{'s' * (period > 1)}"
    if not (late <= SETTLED and (late <= 1e-10 or late < early)):
        return None, False
    if period > 1:
        others = [np.max(np.abs(points[k] - points[0])) for k in range(1, period)]
        closure = max(orbit.residual, 1e-12)
        if not np.min(others) > 1e3 * closure:
            return Label("undecided", period, "shorter lags nearly close", elapsed, orbit), False
    if not largest <= near_border:
        reason = f"{shown}: within {1.0 - near_border:.2g} of a bifurcation"
        return Label("undecided", period, reason, elapsed, orbit), False
    return Label(f"period-{period}", period, shown, elapsed, orbit), False


def _shown(orbit: Orbit) -> str:
    mu = orbit.multipliers[0]
    return f"{mu.real:.6f}" if mu.imag == 0.0 else f"|{abs(mu):.6f}|"


def counts(found: Sequence[Label]) -> dict[str, int]:
    """How many lanes carry each name, in descending number."""
    names, numbers = np.unique([str(one) for one in found], return_counts=True)
    order = np.argsort(-numbers, kind="stable")
    return {str(names[i]): int(numbers[i]) for i in order}
