"""How likely lines at foretold places are, against lines that stand there by chance.

Model. Lines that nothing foretells are scattered along the frequency axis (Poisson, by the density
counted around each), their heights over the threshold exponential. Lines of one group share a
level: their logarithms of amplitude are normal about it with a stated spread, and what is below the
threshold is not seen (probability of the normal law below it). The level is unknown, uniform from 3
nepers below the threshold to 10 above. A place is normal about the foretold one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special

from thermogear.measured.peaks import Peaks

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

_LEVELS = np.arange(-3.0, 10.01, 0.5)  # over the threshold [nepers]
_SHARES = np.array([0.02, 0.1, 0.3, 0.6, 0.9])  # of groups that are there at all
_REACH = 4.0  # standard deviations of a place
_OUTLIER = 3.0
_LOG_ROOT = 0.5 * float(np.log(2.0 * np.pi))

BLOCK = 6
"""Neighbours in a comb that share a level."""
COMB_SPREAD = 0.8
"""Scatter [nepers] of neighbours in a comb of impacts about the resonances' envelope."""
LONGEST_COMB = 600


@dataclass(frozen=True)
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
    members about the group's level; ``trend`` [nepers] of members beside the group's level;
    ``top`` [nepers]: the group's level is not above it (group,). ``used`` lines are explained
    already: members there say nothing. Members hidden beside another line say nothing.
    """
    shape = position.shape
    if peaks.size == 0:
        return Seen(np.zeros(shape[0]), np.full(shape, -1))
    index, off = peaks.nearest(position)
    deviation = np.hypot(peaks.error[index], np.broadcast_to(error, shape)) / peaks.bin_width
    outside = (position < 3.0 * peaks.bin_width) | (position > 0.47)
    hit = (np.abs(off) < _REACH * deviation) & ~used[index] & ~outside
    missing = ~hit & ~peaks.hidden(position)
    mean = max(0.3, float(np.mean(peaks.level - peaks.least)))
    height = peaks.level[index] - peaks.least
    gain = -_LOG_ROOT - np.log(deviation) - 0.5 * (off / deviation) ** 2
    gain = gain - np.log(peaks.density[index]) + np.log(mean) + height / mean
    level = _LEVELS[:, None, None] + np.broadcast_to(trend, shape)
    log_hit = gain - _LOG_ROOT - np.log(spread) - 0.5 * ((height - level) / spread) ** 2
    log_missing = special.log_ndtr(-level / spread)
    total = np.sum(np.where(hit, log_hit, np.where(missing, log_missing, 0.0)), axis=-1)
    below = _LEVELS[:, None] <= np.maximum(np.broadcast_to(top, shape[:1]) - peaks.least, -3.0)
    total = np.where(below, total, -np.inf)
    evidence = special.logsumexp(total, axis=0) - np.log(np.sum(below, axis=0))
    return Seen(np.asarray(evidence), np.where(hit, index, -1))


def some_of(evidence: Floats) -> float:
    """Log evidence of groups of which an unknown share is there: sum log(1 - w + w e), mean in w."""
    if evidence.size == 0:
        return 0.0
    each = np.logaddexp(np.log1p(-_SHARES)[:, None], np.log(_SHARES)[:, None] + evidence)
    return float(special.logsumexp(np.sum(each, axis=-1)) - np.log(_SHARES.size))


def take(used: Flags, found: Seen) -> None:
    """Mark the lines of groups that are rather there than not as explained."""
    lines = found.lines[found.evidence > 0.0].ravel()
    used[lines[lines >= 0]] = True


def refined(
    peaks: Peaks, step: float, ranks: NDArray[np.int64], reach: float = 1.5
) -> tuple[float, float]:
    """The step whose multiples ``ranks`` fit the lines beside them best, and its error.

    Lines within ``reach`` bins, weighted by their errors, a straight line through 0; one that is
    more than three errors off is left out, the worst first. No line: the
    step itself with half a bin at the highest rank.
    """
    index, off = peaks.nearest(ranks * step)
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
            return fitted, float(bottom**-0.5)
        kept = np.arange(rank.size) != int(np.argmax(away))
        rank, line = rank[kept], line[kept]


def comb_of(peaks: Peaks, step: float) -> tuple[float, float]:
    """``refined`` from the first multiples on to the last."""
    highest = min(LONGEST_COMB, int(0.47 / step))
    error, last = 0.0, 1
    for last in (3, 6, 12, 25, 50, 100, 200, LONGEST_COMB):
        step, error = refined(peaks, step, np.arange(1, min(last, highest) + 1), 1.0)
        if last >= highest:
            break
    return step, error


def comb(peaks: Peaks, used: Flags, step: float, error: float) -> tuple[float, Flags, Seen]:
    """Log evidence of a comb of impacts every ``step``, lines explained with it, its blocks.

    Blocks of six neighbours share a level; how many blocks are there is open, and whether the first
    one starts at the first line or in the middle. The prior of the step is uniform up to 0.1
    cycles/sample: log(error sqrt(2 pi)/0.1) is added.
    """
    highest = min(LONGEST_COMB, int(0.47 / step))
    after = used.copy()
    parts: list[tuple[float, Seen]] = []
    for start in (1, 1 - BLOCK // 2):
        blocks = -(-(highest + 1 - start) // BLOCK)
        ranks = (start + np.arange(blocks * BLOCK)).reshape(-1, BLOCK).astype(float)
        found = seen(peaks, used, ranks * step, error=np.abs(ranks) * error, spread=COMB_SPREAD)
        parts.append((some_of(found.evidence), found))
        take(after, found)
    best = max(parts, key=lambda part: part[0])[1]
    return mean_exp([part[0] for part in parts]) + narrow(error, 0.1), after, best


def narrow(error: float, width: float) -> float:
    """Log of the share that a value known to +-error takes of a prior of that width."""
    return min(0.0, float(np.log(error / width)) + _LOG_ROOT)


def mean_exp(values: Sequence[float]) -> float:
    """Log of the mean of exponentials."""
    return float(special.logsumexp(np.asarray(values)) - np.log(len(values)))
