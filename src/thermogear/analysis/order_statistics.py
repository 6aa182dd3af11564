"""What a few drawn values say of the population they come from, whatever its distribution.

A quantile of the population lies between two of the ordered values with a probability that is
binomial: X_(l) <= x_q <= X_(u) where at least l and fewer than u of the n values lie below it. So
nothing is assumed of the distribution, which may jump; a value may be infinite (an onset that never
comes). Checked by ``tests/analysis/test_order_statistics.py``: closed forms, scipy's own, drawings
of known distributions.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import bdtr, betainc, betaincinv

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError

CONFIDENCE = 0.95
"""Of an interval, where none is named: at least so much of all samples have one that holds."""


class Estimate(NamedTuple):
    """A number estimated from a sample, with the ends of its interval."""

    value: float
    low: float
    high: float


@lru_cache(maxsize=256)
def interval_ranks(count: int, *, share: float, confidence: float = CONFIDENCE) -> tuple[int, int]:
    """Ranks (l, u), from 1, of ``count`` ordered values that hold the quantile of ``share``.

    The two nearest to each other with P(l <= B < u) >= ``confidence``, B binomial of ``count`` and
    ``share``; of several those with the greater. Where no ranks do, one is 0, minus infinity, or
    ``count`` + 1, infinity: few values do not bound a far quantile.

    >>> interval_ranks(64, share=0.5), interval_ranks(64, share=0.9)
    ((24, 40), (53, 63))
    """
    if count < 1 or not 0.0 < share < 1.0:
        raise InputError("sample", f"{count} values, share {share:g}", allowed="1.., 0..1 between")
    below = np.append(0.0, bdtr(np.arange(count + 1), count, share))  # P(B < k), k = 0..count + 1
    low = np.arange(count + 2)
    high = np.searchsorted(below, below[low] + confidence)
    width = high - low + count * (1 * (low == 0) + (high == count + 1) + 4 * (high > count + 1))
    held = below[np.minimum(high, count + 1)] - below[low]
    best = int(np.lexsort((-held, width))[0])
    return best, int(high[best])


def quantile(values: ArrayLike, *, share: float, confidence: float = CONFIDENCE) -> Estimate:
    """The quantile of ``share`` of the population that ``values`` are drawn from.

    Its point after Harrell and Davis, Biometrika 69 (1982) 635: the mean of the ordered values
    with the weights of a beta distribution of (n + 1) share and (n + 1)(1 - share); the ordered
    value of rank ceil(n share) where some are infinite, which no mean bears. Its interval by
    :func:`interval_ranks`, whatever the distribution. Raises InputError for nan or no values.

    >>> quantile([1.0, 2.0, 3.0, 4.0, np.inf, np.inf, np.inf], share=0.5)
    Estimate(value=4.0, low=1.0, high=inf)
    """
    ordered = np.sort(np.ravel(np.asarray(values, dtype=float)))
    if not ordered.size or np.isnan(ordered).any():
        raise InputError("sample", f"{ordered.size} values", allowed="one value or more, no nan")
    count = ordered.size
    low, high = interval_ranks(count, share=share, confidence=confidence)
    ends = np.concatenate([[-np.inf], ordered, [np.inf]])
    if np.isfinite(ordered).all():
        value = float(_weights(count, share) @ ordered)
    else:
        value = float(ordered[math.ceil(count * share - 1e-9) - 1])
    return Estimate(value, float(ends[low]), float(ends[high]))


@lru_cache(maxsize=256)
def _weights(count: int, share: float) -> Floats:
    """Of the ordered values: steps of the beta distribution function at i/n."""
    steps = np.arange(count + 1) / count
    return np.diff(betainc((count + 1) * share, (count + 1) * (1.0 - share), steps))


def proportion(hits: int, *, of: int, confidence: float = CONFIDENCE) -> Estimate:
    """The share of a population of which ``hits`` of so many drawn ones are.

    Its interval after Clopper and Pearson, Biometrika 26 (1934) 404: the shares under which so
    many hits or more, so many or fewer, have half of 1 - ``confidence``; where none or all are hit
    the interval has one side, with the whole of it.

    >>> none = proportion(0, of=64)
    >>> f"{none.value:.0%}, less than {none.high:.1%}"
    '0%, less than 4.6%'
    """
    if not 0 <= hits <= of or of < 1:
        raise InputError("sample", f"{hits} of {of}", allowed="0 <= hits <= of, from 1 on")
    tail = (1.0 - confidence) * (1.0 if hits in (0, of) else 0.5)
    low = float(betaincinv(hits, of - hits + 1, tail)) if hits else 0.0
    high = float(betaincinv(hits + 1, of - hits, 1.0 - tail)) if hits < of else 1.0
    return Estimate(hits / of, low, high)
