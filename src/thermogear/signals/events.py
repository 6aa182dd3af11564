"""A short event in a record that is steady otherwise: a burst, a blow, an offset that settles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_PIECES, _SHORTEST = 200, 32  # of the record, and samples of one
_TIMES = 5.0  # the usual range of a piece
_CALM = 0.8  # of the pieces hold no event
_MOST, _PLACES = 0.1, 2  # of the pieces, and runs of them


class Event(NamedTuple):
    """Samples ``first``..``last`` of it, and its size: ``times`` the usual range of a piece."""

    first: int
    last: int
    times: float


def short_event(x: Floats) -> Event | None:
    """The highest event of a record ``x`` (sample,) without gaps; None: there is none.

    The record is parted in 200 pieces, of 32 samples at least. In a tenth of them at most, in one
    or two places, the range (highest less lowest) is five times its median, or the mean as far off
    its own median, and five times what four of five pieces have: impacts that come back, a run-up,
    a load that wanders or a line slower than a piece are in more of them.

    >>> x = np.sin(np.arange(20_000.0))
    >>> short_event(x)
    >>> x[4_000:4_100] *= 8.0
    >>> short_event(x)
    Event(first=4000, last=4099, times=8.0)
    """
    size = max(_SHORTEST, x.size // _PIECES)
    count = x.size // size
    if count < 2 * _SHORTEST:
        return None
    pieces = x[: count * size].reshape(count, size)
    spans, means = np.ptp(pieces, axis=1), np.mean(pieces, axis=1)
    usual = float(np.median(spans))
    if not usual > 0.0:
        return None
    times = np.maximum(spans, np.abs(means - np.median(means))) / usual
    high = times > _TIMES * max(1.0, float(np.quantile(times, _CALM)))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], high.astype(np.int8), [0]])))
    starts, stops = edges[::2], edges[1::2]
    if not 0 < starts.size <= _PLACES or np.mean(high) > _MOST:
        return None
    best = int(np.argmax([np.max(times[a:b]) for a, b in zip(starts, stops, strict=True)]))
    first, stop = int(starts[best]), int(stops[best])
    return Event(first * size, stop * size - 1, round(float(np.max(times[first:stop])), 1))
