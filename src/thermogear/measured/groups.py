"""How likely lines at foretold places are, against lines that stand there by chance.

Model. Lines that nothing foretells are scattered along the frequency axis (Poisson, by the density
counted around each), their heights over the threshold exponential. Lines of one group share a
level: their logarithms of amplitude are normal about it with a stated spread, and what is below the
threshold is not seen (probability of the normal law below it). The level is unknown, uniform from 3
nepers below the threshold to 10 above. A place is normal about the foretold one, by its own error
and for a fifth of them by an eighth of a bin more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special

from thermogear.base.arrays import Flags, Floats
from thermogear.measured.peaks import Peaks

_LEVELS = np.arange(-3.0, 10.01, 0.5)  # over the threshold [nepers]
_SHARES = np.array([0.02, 0.1, 0.3, 0.6, 0.9])  # of groups that are there at all
_REACH = 4.0  # standard deviations of a place
_FEW, _ASTRAY = 0.2, 0.12  # share of places that are less sure than they look, by as many bins
_LOG_MOST, _LOG_FEW = float(np.log(1.0 - _FEW)), float(np.log(_FEW))
_OUTLIER = 3.0
_LOG_ROOT = 0.5 * float(np.log(2.0 * np.pi))

HIGHEST = 0.47
"""Lines are looked for up to here [cycles/sample]."""
ONE_MORE = -float(np.log(2.0))
"""Log prior of a mesh, a comb or its sidebands: there, or not there."""
BLOCK = 6
"""Neighbours in a comb that share a level."""
COMB_SPREADS = (0.5, 1.0, 1.6)
"""Scatter [nepers] of neighbours in a comb about the resonances' envelope: one of these."""
LONGEST_COMB = 400

_COMB_BELOW = special.log_ndtr(-_LEVELS[:, None] / np.array(COMB_SPREADS))  # (level, spread)


@dataclass(frozen=True, kw_only=True)
class Seen:
    """Log evidence of each group over chance, and the lines each holds (index, -1: none)."""

    evidence: Floats
    lines: NDArray[np.int64]


def seen(
    peaks: Peaks,
    used: Flags,
    position: Floats,
    *,
    error: Floats | float,
    spread: float,
    trend: Floats | float = 0.0,
    top: Floats | float = np.inf,
) -> Seen:
    """Evidence of groups of lines foretold at ``position`` (group, member) [cycles/sample].

    ``error`` [cycles/sample]: standard deviation of the foretelling; ``spread`` [nepers] of the
    members about the group's level; ``trend`` [nepers] of members beside the group's level
    (member,); ``top`` [nepers]: the group's level is not above it (group,). ``used`` lines are
    explained already: members there say nothing. Members hidden beside another line say nothing.
    """
    looked = _Looked.at(peaks, used, position, error)
    total = looked.totals(spread, np.broadcast_to(trend, position.shape[-1:]))
    return Seen(evidence=_over_levels(total, peaks, top), lines=looked.lines)


def falling(
    peaks: Peaks,
    used: Flags,
    *,
    position: Floats,
    order: NDArray[np.int64],
    error: Floats | float,
    spread: float,
    trend: Floats,
    top: Floats | float,
) -> tuple[Seen, ...]:
    """``seen`` for groups of members up to each order: ``order`` (member,) from 1 on, in turn.

    ``position`` (..., group, member): cases at once, as many as its first axes have.
    """
    looked = _Looked.at(peaks, used, position, error)
    last = np.arange(1, int(order.max()) + 1).reshape(-1, *np.ones(position.ndim, dtype=int))
    upto = looked.only(order <= last)
    evidence = _over_levels(upto.totals(spread, trend), peaks, top)
    return tuple(Seen(evidence=e, lines=n) for e, n in zip(evidence, upto.lines, strict=True))


@dataclass(frozen=True, kw_only=True)
class _Looked:
    """What is at foretold places (group, member): a line that is there, or none that would be
    seen; the line's ``height`` [nepers over the threshold], and log ``gain`` of its place over
    chance; its index (-1: none)."""

    there: Floats
    missing: Floats
    height: Floats
    gain: Floats
    lines: NDArray[np.int64]

    @classmethod
    def at(cls, peaks: Peaks, used: Flags, position: Floats, error: Floats | float) -> _Looked:
        index, off = peaks.nearest(position)
        close = np.hypot(peaks.error[index], error) / peaks.bin_width
        deviation = np.hypot(close, _ASTRAY)
        inside = (position >= 3.0 * peaks.bin_width) & (position <= HIGHEST)
        far = np.abs(off)
        there = (far < _REACH * deviation) & ~used[index] & inside
        missing = ~there & inside & (far >= 3.0)
        mean = max(0.3, peaks.mean_height)
        height = peaks.level[index] - peaks.least
        place = np.logaddexp(
            _LOG_MOST - np.log(close) - 0.5 * (off / close) ** 2,
            _LOG_FEW - np.log(deviation) - 0.5 * (off / deviation) ** 2,
        )
        chance = np.log(peaks.density[index]) - height / mean - float(np.log(mean))
        return cls(
            there=there.astype(float),
            missing=missing.astype(float),
            height=np.where(there, height, 0.0),
            gain=np.where(there, place - 2.0 * _LOG_ROOT - chance, 0.0),
            lines=np.where(there, index, -1),
        )

    def only(self, members: Flags) -> _Looked:
        """The same of some members alone: nothing is known of the others."""
        return _Looked(
            there=self.there * members,
            missing=self.missing * members,
            height=self.height * members,
            gain=self.gain * members,
            lines=np.where(members, self.lines, -1),
        )

    def totals(self, spread: float, trend: Floats) -> Floats:
        """Log likelihood over chance (level, ..., group): sum over members of log normal or
        missing."""
        height = self.height - trend * self.there
        each = np.stack([self.there, height, height**2, self.gain])
        number, first, second, gain = np.add.reduce(each, axis=-1)
        below = special.log_ndtr(-(_LEVELS[:, None] + trend) / spread)
        level = _LEVELS.reshape(-1, *np.ones(number.ndim, dtype=int))
        hidden = np.moveaxis(self.missing @ below.T, -1, 0)
        return np.asarray(_normal(level, number, first, second, spread) + gain + hidden)


def _normal(
    level: Floats, number: Floats, first: Floats, second: Floats, spread: Floats | float
) -> Floats:
    """Log likelihood of ``number`` normal values about ``level`` with these sums of powers, but
    for the root of 2 pi."""
    square = second - 2.0 * level * first + level**2 * number
    return np.asarray(-number * np.log(spread) - 0.5 * square / np.square(spread))


def _over_levels(total: Floats, peaks: Peaks, top: Floats | float) -> Floats:
    """Log of the mean over levels up to ``top`` (group,) of exp(total) (level, ..., group)."""
    highest = np.maximum(np.asarray(top) - peaks.least, _LEVELS[0])
    if np.all(highest >= _LEVELS[-1]):
        return log_sum(total) - float(np.log(_LEVELS.size))
    level = _LEVELS.reshape(-1, *np.ones(total.ndim - 1, dtype=int))
    below = level <= highest
    return np.asarray(log_sum(np.where(below, total, -np.inf)) - np.log(np.sum(below, axis=0)))


def log_sum(values: Floats) -> Floats:
    """Log of the sum of exponentials over the first axis."""
    highest = np.maximum.reduce(values)
    return np.asarray(highest + np.log(np.add.reduce(np.exp(values - highest))))


def some_of(evidence: Floats) -> Floats:
    """Log evidence of groups (..., group) of which a share w is there: sum over groups of
    log(1 - w + w e), mean in w."""
    shares = _SHARES.reshape(-1, *np.ones(evidence.ndim, dtype=int))
    each = np.logaddexp(np.log1p(-shares), np.log(shares) + evidence)
    return log_sum(np.add.reduce(each, axis=-1)) - float(np.log(_SHARES.size))


def taken_by(found: Seen) -> NDArray[np.int64]:
    """The lines of groups that are rather there than not: they are explained."""
    lines = found.lines[found.evidence > 0.0].ravel()
    return np.asarray(lines[lines >= 0])


def refined(
    peaks: Peaks, step: float, ranks: NDArray[np.int64], reach: float = 1.5
) -> tuple[float, float]:
    """The step whose multiples ``ranks`` fit the lines beside them best, and its error.

    Lines within ``reach`` bins, weighted by their errors, a straight line through 0; one that is
    more than three errors off is left out, the worst first. No line: the
    step itself with half a bin at the highest rank.
    """
    index, off = peaks.nearest(np.asarray(ranks * step, float))
    near = np.abs(off) < reach
    if not np.any(near):
        return step, 0.5 * peaks.bin_width / float(ranks.max())
    rank, line = ranks[near].astype(float), index[near]
    while True:
        weight = 1.0 / peaks.error[line] ** 2
        bottom = float(np.sum(weight * rank**2))
        fitted = float(np.sum(weight * rank * peaks.place[line])) / bottom
        away = np.abs(peaks.place[line] - rank * fitted) / peaks.error[line]
        if rank.size < 3 or away.max() < _OUTLIER:
            misfit = float(np.sum(away**2)) / max(1, rank.size - 1)
            return fitted, float((max(1.0, misfit) / bottom) ** 0.5)
        kept = np.arange(rank.size) != int(np.argmax(away))
        rank, line = rank[kept], line[kept]


def comb_of(peaks: Peaks, *, step: float, error: float) -> tuple[float, float]:
    """The step +- ``error`` and its error, refined by as many multiples as it foretells to half a
    bin, then by as many as that one does, and so on to the last."""
    highest = min(LONGEST_COMB, int(HIGHEST / step))
    last = 0
    while last < highest:
        reach = int(min(highest, max(2 * last, 3, 0.5 * peaks.bin_width / error)))
        ranks = np.arange(1, reach + 1)
        found, own = refined(peaks, step, ranks, 1.0)
        if abs(found - step) < _REACH * np.hypot(error, own):
            step, error = found, min(error, own)
        last = reach
    return step, error


def comb(peaks: Peaks, used: Flags, *, step: float, error: float) -> tuple[float, Flags, Seen]:
    """Log evidence of a comb of lines every ``step``, lines explained with it, its blocks.

    Blocks of six neighbours share a level; open are the scatter about it, how many blocks are
    there, and whether the first one starts at the first line or in the middle. The prior of the
    step is uniform up to 0.1 cycles/sample: log(error sqrt(2 pi)/0.1) is added.
    """
    highest = min(LONGEST_COMB, int(HIGHEST / step))
    half = BLOCK // 2
    blocks = -(-highest // BLOCK), -(-(highest + half) // BLOCK)
    ranks = np.arange(1.0 - half, BLOCK * max(blocks) + 1.0)
    looked = _Looked.at(peaks, used, ranks * step, np.abs(ranks) * error)
    values = np.stack([looked.there, looked.height, looked.height**2, looked.gain, looked.missing])
    sums = [
        values[:, start : start + BLOCK * size].reshape(5, size, BLOCK).sum(axis=-1)
        for start, size in zip((half, 0), blocks, strict=True)
    ]
    number, first, second, gain, missing = np.concatenate(sums, axis=-1)
    spread = np.array(COMB_SPREADS)[:, None]
    total = (
        _normal(_LEVELS[:, None, None], number, first, second, spread)
        + gain
        + _COMB_BELOW[..., None] * missing
    )
    evidence = log_sum(total) - float(np.log(_LEVELS.size))
    parts = np.split(evidence, blocks[:1], axis=-1)
    each = np.stack([some_of(part) for part in parts], axis=-1).ravel()
    best = int(np.argmax(each))
    own = parts[best % 2][best // 2]
    start, size = ((half, 0)[best % 2], blocks[best % 2])
    lines = looked.lines[start : start + BLOCK * size].reshape(size, BLOCK)
    found = Seen(evidence=own, lines=lines)
    after = used.copy()
    after[taken_by(found)] = True
    return mean_exp(each) + narrow(error, width=0.1), after, found


def narrow(error: float, *, width: float) -> float:
    """Log of the share that a value known to +-error takes of a prior of that width."""
    return min(0.0, float(np.log(error / width)) + _LOG_ROOT)


def mean_exp(values: Sequence[float] | Floats) -> float:
    """Log of the mean of exponentials."""
    return float(log_sum(np.asarray(values, dtype=float))) - float(np.log(len(values)))
