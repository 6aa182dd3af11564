"""What very many lanes settle on: an estimate by a faster rule than that of :mod:`labels`.

One start, one rounding, left as soon as it closes or its exponent is positive: chaos may end
later, and a start on the border of two basins may end elsewhere.

Lanes of one layout run side by side. After every round those whose section closes are polished
by Newton together; a lane leaves as soon as it is proven, so that most of a map costs a
hundredth of the longest transient in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.orbits import multipliers
from thermogear.base.arrays import Flags, Floats, Whole
from thermogear.base.bounds import require_share, whole
from thermogear.base.errors import InputError
from thermogear.base.period import turns
from thermogear.base.plan import Alive, keep_going
from thermogear.base.vocabulary import STILL
from thermogear.dynamics.bundle import Bundle, bundles
from thermogear.dynamics.lanes import Lanes

LABELS = ("undecided", "periodic", "chaotic", "diverged", *STILL)
"""Meaning of the label codes 0, 1, 2, ...; the last ones have no motion."""
UNDECIDED, PERIODIC, CHAOTIC, DIVERGED, JAMMED = range(5)
TRIES = 4
ALIGN = 50
"""Mesh periods in which a tangent turns into its own direction."""
WATCHED = 128
"""Mesh periods after its label over which the contact of a chaotic motion is told."""


@dataclass(frozen=True, kw_only=True)
class Rule:
    """How long a motion is followed, and what counts as proof.

    Rounds of ``first`` periods, then doubling, ``cap`` in all; one single round of ``cap`` where
    ``early`` is False. Periodic: the section returns within ``close`` half backlashes after at
    most ``max_period`` periods, the polished orbit is stable with its largest multiplier below
    ``near_border``, and the trajectory is within ``settled`` of it and comes nearer. Chaotic: no
    lag closes and the largest Lyapunov exponent over at least ``chaos_periods`` periods is
    positive by four standard errors of its ``batches``, in both halves of its record.
    """

    max_period: int = 32
    first: int = 64
    cap: int = 4096
    early: bool = True
    near_border: float = 0.998
    close: float = 1e-2
    settled: float = 1e-4
    chaos_periods: int = 500
    batches: int = 20

    def __post_init__(self) -> None:
        for name, least in (
            ("max_period", 1), ("first", 8), ("cap", 8), ("chaos_periods", 40), ("batches", 4)
        ):  # fmt: skip
            whole(f"rule.{name}", getattr(self, name), least=least)
        for name in ("near_border", "close", "settled"):
            require_share(f"rule.{name}", getattr(self, name))
        if self.cap < self.first:
            raise InputError("rule.cap", self.cap, allowed=f">= first = {self.first}")

    def turned(self, mesh_periods: int) -> Rule:
        """The same rule, its counts of mesh periods as turns of ``mesh_periods``.

        At least three turns before a proof is tried, eight for an exponent.
        """
        if mesh_periods == 1:
            return self
        counts = {
            name: max(turns(getattr(self, name), of=mesh_periods), least)
            for name, least in (("first", 3), ("cap", 24), ("chaos_periods", 8))
        }
        counts["batches"] = min(self.batches, counts["chaos_periods"])
        return _OfTurn(**(vars(self) | counts))

    def full(self) -> Rule:
        """The same proofs after one long run, nothing given up early."""
        return replace(self, early=False)

    def rounds(self) -> list[int]:
        """Lengths of the rounds; they add up to ``cap``."""
        if not self.early:
            return [self.cap]
        lengths = [self.first]
        while sum(lengths) < self.cap:
            lengths.append(min(sum(lengths), self.cap - sum(lengths)))
        return lengths


class _OfTurn(Rule):
    """A rule that counts turns; few of them prove as much as many mesh periods."""

    def __post_init__(self) -> None:
        """The rule it is made of is checked already."""


@dataclass(frozen=True, kw_only=True)
class Settled:
    """One entry per lane.

    ``label`` codes into :data:`LABELS`, ``period`` n (0: none), ``point`` (lane, d) of the
    orbit where the trajectory is, ``multiplier`` (lane, d) complex, ``lyapunov`` per unit
    time with its ``lyapunov_error`` (exact, error 0, for periodic lanes), ``losses`` and
    ``impacts`` per orbit (NaN without one), ``shares`` of time in back, free and drive (in chaos
    those of :data:`WATCHED` periods, of one mass alone), ``used`` mesh periods run,
    ``state`` (lane, d) at the end, ``sections`` (lane, keep, d) the last ones, on the orbit
    itself for periodic lanes.
    """

    label: NDArray[np.int8]
    period: NDArray[np.int32]
    point: Floats
    multiplier: NDArray[np.complex128]
    lyapunov: Floats
    lyapunov_error: Floats
    losses: Floats
    impacts: Floats
    shares: Floats
    used: NDArray[np.int32]
    state: Floats
    sections: Floats

    @classmethod
    def empty(cls, lanes: int, *, keep: int = 0, dimension: int = 2) -> Settled:
        """Nothing known yet of ``lanes`` motions with states of length ``dimension``."""
        nan = np.nan
        return cls(
            label=np.zeros(lanes, np.int8),
            period=np.zeros(lanes, np.int32),
            point=np.full((lanes, dimension), nan),
            multiplier=np.full((lanes, dimension), complex(nan, nan)),
            lyapunov=np.full(lanes, nan),
            lyapunov_error=np.full(lanes, nan),
            losses=np.full(lanes, nan),
            impacts=np.full(lanes, nan),
            shares=np.full((lanes, 3), nan),
            used=np.zeros(lanes, np.int32),
            state=np.full((lanes, dimension), nan),
            sections=np.full((lanes, keep, dimension), nan),
        )

    def put(self, index: Whole | Flags, other: Settled) -> None:
        """Write the lanes of ``other`` to the places ``index``."""
        for field in fields(self):
            getattr(self, field.name)[index] = getattr(other, field.name)


def polish(
    maps: Bundle, guess: Floats, n: int, unit: Floats, most: int = 10
) -> tuple[Floats, Floats]:
    """Newton to fixed points of P^n, lane by lane: states (lane, d) and residuals (lane).

    Residuals in half backlashes; a lane that does not settle has one above 1e-9.
    """
    z = guess.copy()
    best = guess.copy()
    least = np.full(len(z), np.inf)
    stalled = np.zeros(len(z), np.int64)
    working = np.arange(len(z))
    here = maps
    for _ in range(most):
        run = here.visit(z[working], n)
        gap = run.residual
        size = np.max(np.abs(gap) / unit[working], axis=1)
        better = size < least[working]
        chosen = working[better]
        best[chosen], least[chosen] = z[chosen], size[better]
        stalled[working] = np.where(better, 0, stalled[working] + 1)
        with np.errstate(all="ignore"):
            step = _newton(run.jacobian, gap)
            length = np.max(np.abs(step) / unit[working], axis=1)
        go = np.isfinite(length) & np.isfinite(size) & (size >= 1e-13)
        go &= ~((stalled[working] >= 2) & (least[working] < 1e-9))
        far = np.isfinite(length) & (length > 1.0)
        step[far] /= length[far, None]
        z[working[go]] += step[go]
        if not np.any(go):
            break
        if not np.all(go):
            working = working[go]
            here = maps.take(working)
    return best, least


def _newton(jacobian: Floats, gap: Floats) -> Floats:
    """-(D P^n - 1)^-1 of the residuals, lane by lane: (lane, d); not finite where singular."""
    if gap.shape[1] == 2:
        a, b = jacobian[:, 0, 0] - 1.0, jacobian[:, 0, 1]
        c, d = jacobian[:, 1, 0], jacobian[:, 1, 1] - 1.0
        det = a * d - b * c
        return np.stack(
            [(b * gap[:, 1] - d * gap[:, 0]) / det, (c * gap[:, 0] - a * gap[:, 1]) / det], axis=1
        )
    step = np.full_like(gap, np.nan)
    for lane in np.flatnonzero(np.all(np.isfinite(jacobian), axis=(1, 2))):
        with suppress(np.linalg.LinAlgError):
            step[lane] = np.linalg.solve(jacobian[lane] - np.eye(gap.shape[1]), -gap[lane])
    return step


def multipliers_of(jacobian: Floats, *, determinant: Floats) -> NDArray[np.complex128]:
    """Floquet multipliers (lane, d) of Jacobians with known determinants, the larger first."""
    if jacobian.shape[1:] != (2, 2) or not np.all(np.isfinite(determinant)):
        return np.array([multipliers(*one) for one in zip(jacobian, determinant, strict=True)])
    half = 0.5 * (jacobian[:, 0, 0] + jacobian[:, 1, 1])
    square = half * half - determinant
    root = np.sqrt(np.abs(square))
    large = half + np.copysign(root, half)
    out = np.empty((half.size, 2), complex)
    turning = square < 0.0
    with np.errstate(all="ignore"):
        out[:, 0] = np.where(turning, half + 1j * root, large)
        out[:, 1] = np.where(turning, half - 1j * root, determinant / large)
    # both below the least number, over a long turn
    out[large == 0.0] = 0.0
    return out


def settle(
    lanes: Lanes | Sequence[object],
    start: Floats,
    rule: Rule,
    keep: int = 0,
    alive: Alive = keep_going,
) -> Settled:
    """What every lane settles on from ``start`` (lane, d); ``keep`` last sections are returned.

    ``lanes`` are those of one mass, or models of any dimension d that have a return map.
    Each lane's result depends on that lane alone, to the last bit. ``alive`` is called between
    rounds; it raises to end the work. Where a lane's period is a turn, ``rule`` counts mesh
    periods, rounded up to turns, and the result turns.
    """
    mesh_periods = lanes.mesh_periods if isinstance(lanes, Lanes) else 1
    rule = rule.turned(mesh_periods)
    result = Settled.empty(len(lanes), keep=keep, dimension=start.shape[1])
    for index, prepared in bundles(lanes):
        block = _Block(prepared(), start[index], rule, keep, mesh_periods)
        result.put(index, _settled(block, alive))
    return result


class _Block:
    """Lanes of one layout on their way to a label."""

    def __init__(
        self, maps: Bundle, start: Floats, rule: Rule, keep: int, mesh_periods: int
    ) -> None:
        self.maps = maps
        self.mesh_periods = mesh_periods
        # periods in which a tangent turns into its own direction, and over which chaos is watched
        self.align, self.watched = (turns(n, of=mesh_periods) for n in (ALIGN, WATCHED))
        self.rule = rule
        self.keep = keep
        self.unit = maps.unit
        self.period = maps.period
        self.crowd = maps.crowd(start)
        self.active = np.arange(len(maps))
        self.result = Settled.empty(len(maps), keep=keep, dimension=start.shape[1])

    def drop(self, out: Flags) -> None:
        """Go on without the lanes that are done."""
        left = np.flatnonzero(~out)
        self.active = self.active[left]
        self.crowd = self.crowd.take(left)
        self.maps = self.crowd.bundle

    def window(self, length: int, measured: int) -> tuple[Floats, Floats]:
        """Run ``length`` periods: the last sections (lane, window, d), stretches (period, lane).

        The stretches cover the last ``measured`` periods.
        """
        want = min(length, max(2 * self.rule.max_period, self.keep))
        silent = length - max(measured, want)
        if silent > 0:
            self.crowd.run(silent)
        if measured:
            self.crowd.aim(self.unit[self.active] / self.unit[self.active, :1])
            sections, stretch = self.crowd.stretch(length - max(silent, 0))
        else:
            sections = self.crowd.run(length - max(silent, 0))
            stretch = np.empty((0, self.active.size))
        return sections[-want:].transpose(2, 0, 1), stretch


def _settled(block: _Block, alive: Alive) -> Settled:
    """:func:`settle` for lanes that run together."""
    rule, align = block.rule, block.align
    elapsed = 0
    rounds = rule.rounds()
    for number, length in enumerate(rounds):
        alive()
        measured = 0
        if length >= rule.chaos_periods + align:
            measured = length if rule.early else max(rule.chaos_periods, length // 3) + align
        window, stretch = block.window(length, measured)
        elapsed += length
        active = block.active
        block.result.used[active] = elapsed * block.mesh_periods
        block.result.state[active] = block.crowd.state
        last = number == len(rounds) - 1
        done = _verdicts(block, window, stretch[align:] if measured else stretch, last)
        if last or np.all(done):
            break
        if np.any(done):
            block.drop(done)
    return block.result


def _verdicts(block: _Block, window: Floats, stretch: Floats, last: bool) -> Flags:
    """Write what the last round proves; which of the active lanes are done."""
    active, rule, result = block.active, block.rule, block.result
    done = ~np.all(np.isfinite(window), axis=(1, 2))
    result.label[active[done]] = DIVERGED
    scaled = window / block.unit[active, None, :]
    most = min(rule.max_period, window.shape[1] // 2)
    gaps = np.stack(
        [np.max(np.abs(scaled[:, -1] - scaled[:, -1 - n]), axis=1) for n in range(1, most + 1)],
        axis=1,
    )
    level = np.full(active.size, rule.close)
    level[done] = 0.0
    # an orbit just past a flip nearly closes after half its period, on an unstable one: when
    # the first lag that closes proves nothing, the next that closes ten times better is tried
    for _ in range(TRIES):
        near = gaps < level[:, None]
        lag = np.where(near.any(axis=1), near.argmax(axis=1) + 1, 0)
        if not np.any(lag):
            break
        for n in np.unique(lag[lag > 0]):
            rows = np.flatnonzero(lag == n)
            done[rows] = _periodic(block, rows, int(n), window, scaled)
        level = np.where(done | (lag == 0), 0.0, 0.1 * gaps[np.arange(active.size), lag - 1])
    open_ = ~done
    if stretch.shape[0]:
        _lyapunov(block, stretch, open_)
        quiet = np.all(gaps > 1e-5, axis=1)
        proof = result.lyapunov_error[active]
        half = stretch.shape[0] // 2
        chaotic = (
            open_
            & quiet
            & (result.lyapunov[active] > 4.0 * proof)
            & (np.cumsum(stretch[:half], axis=0)[-1] > 0.0)
            & (np.cumsum(stretch[half:], axis=0)[-1] > 0.0)
        )
        result.label[active[chaotic]] = CHAOTIC
        done |= chaotic
        rows = np.flatnonzero(chaotic)
        # more masses take too long with their variational equations: their families watch them
        if rows.size and window.shape[2] == 2:
            run = block.maps.take(rows).visit(window[rows, -1], block.watched)
            lanes = active[rows]
            result.shares[lanes] = run.spent / (block.watched * block.period[lanes])[:, None]
    if block.keep:
        rows = np.flatnonzero((done | last) & (result.label[active] != PERIODIC))
        count = min(block.keep, window.shape[1])
        result.sections[active[rows], -count:] = window[rows, -count:]
    return np.asarray(done)


def _lyapunov(block: _Block, stretch: Floats, rows: Flags) -> None:
    """Largest exponent and batch-means error from the stretches of a round."""
    count = block.rule.batches
    length = stretch.shape[0] // count
    used = stretch[stretch.shape[0] - count * length :]
    # running sums, one period after the other: company changes no bit
    sums = np.cumsum(used, axis=0)[length - 1 :: length]
    means = np.diff(sums, axis=0, prepend=0.0) / (length * block.period[block.active])
    mean = np.cumsum(means, axis=0)[-1] / count
    spread = np.sqrt(np.cumsum((means - mean) ** 2, axis=0)[-1] / (count - 1))
    lanes = block.active[rows]
    block.result.lyapunov[lanes] = mean[rows]
    block.result.lyapunov_error[lanes] = (spread / np.sqrt(count))[rows]


def _periodic(block: _Block, rows: Whole, n: int, window: Floats, scaled: Floats) -> Flags:
    """Polish the ``rows`` of the active lanes that return after ``n`` periods; which are done."""
    active, rule, result = block.active, block.rule, block.result
    done = np.zeros(rows.size, bool)
    maps = block.maps.take(rows)
    unit = block.unit[active[rows]]
    point, residual = polish(maps, window[rows, -1], n, unit)
    good = np.flatnonzero(residual < 1e-9)
    if good.size == 0:
        return done
    run = maps.take(good).visit(point[good], n)
    minimal = np.full(good.size, n)
    for shorter in range(n - 1, 0, -1):
        if n % shorter == 0:
            away = np.max(np.abs(run.points[:, shorter] - run.points[:, 0]) / unit[good], axis=1)
            minimal[away <= np.maximum(1e-8, 1e3 * residual[good])] = shorter
    for period in np.unique(minimal):
        some = good[minimal == period]
        done[some] = _accept(block, rows[some], point[some], int(period), scaled, rule, result)
    return done


def _accept(
    block: _Block,
    rows: Whole,
    point: Floats,
    n: int,
    scaled: Floats,
    rule: Rule,
    result: Settled,
) -> Flags:
    """Whether the lanes ``rows`` converge to their stable orbits of ``n`` periods; stores them."""
    maps = block.maps.take(rows)
    run = maps.visit(point, n)
    lanes = block.active[rows]
    mu = multipliers_of(run.jacobian, determinant=maps.determinant(n))
    size = np.abs(mu[:, 0])
    orbit = run.points[:, :-1] / block.unit[lanes, None, :]
    width = scaled.shape[1]
    turned = orbit[:, (np.arange(width) - (width - 1)) % n]
    away = np.max(np.abs(scaled[rows] - turned), axis=2)
    early = np.max(away[:, : width // 2], axis=1)
    late = np.max(away[:, width // 2 :], axis=1)
    ok = np.isfinite(size) & (size < 1.0) & (late <= rule.settled)
    ok &= (late < early) | (late <= 1e-10)
    chosen = lanes[ok]
    near = size > rule.near_border
    result.label[chosen] = np.where(near[ok], UNDECIDED, PERIODIC)
    result.period[chosen] = n
    result.point[chosen] = run.points[ok, 0]
    result.multiplier[chosen] = mu[ok]
    # over a long turn the modulus may lie below the least number: the exponent is then a bound
    size = np.maximum(size, np.finfo(float).smallest_subnormal)
    result.lyapunov[chosen] = (np.log(size) / (n * block.period[lanes]))[ok]
    result.lyapunov_error[chosen] = 0.0
    total = n * block.period[chosen]
    result.shares[chosen] = run.spent[ok] / total[:, None]
    # a model without teeth has no time in contact, and no losses of it to count
    toothed = np.where(np.isnan(result.shares[chosen, 2]), np.nan, 1.0)
    result.losses[chosen] = toothed * run.losses[ok]
    result.impacts[chosen] = toothed * run.impacts[ok]
    if block.keep:
        places = (np.arange(block.keep) - (block.keep - 1)) % n
        result.sections[chosen] = run.points[ok][:, places]
    return np.asarray(ok)
