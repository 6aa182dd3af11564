"""What changes in a record that is steady otherwise: a short event, a sensor that dies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats

Mask = NDArray[np.bool_]

_PIECES, _SHORTEST = 200, 32  # of the record, and samples of one
_TIMES = 5.0  # the usual range of a piece
_CALM = 0.8  # of the pieces hold no event
_MOST, _PLACES = 0.1, 2  # of the pieces, and runs of them
_USUALLY = 0.9  # of the pieces have less than the usual rms: most may be without vibration
_QUIET, _LIVELY = 0.03, 0.3  # of the usual rms: no vibration, and vibration beside it
_STILL, _STRAY = 0.05, 1  # of the record, a stretch without any; quiet pieces elsewhere


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
    pieces = _parted(x)
    count, size = pieces.shape
    if count < 2 * _SHORTEST:
        return None
    spans, means = np.ptp(pieces, axis=1), np.mean(pieces, axis=1)
    usual = float(np.median(spans))
    if not usual > 0.0:
        return None
    times = np.maximum(spans, np.abs(means - np.median(means))) / usual
    high = times > _TIMES * max(1.0, float(np.quantile(times, _CALM)))
    runs = _runs(high)
    if not 0 < len(runs) <= _PLACES or np.mean(high) > _MOST:
        return None
    first, stop = max(runs, key=lambda run: float(np.max(times[slice(*run)])))
    return Event(first * size, stop * size - 1, round(float(np.max(times[first:stop])), 1))


def quiet(x: Floats, free: Mask) -> Mask:
    """Samples of ``x`` in stretches where nothing vibrates, as of a sensor that dies: at once.

    Of 200 pieces, the rms about its mean is below 3 % of what a tenth of them exceeds, over 5 % of
    the record or more, in one or two stretches, and in one piece elsewhere at most: between impacts
    it is so again and again. Next to the stretch it is above 30 % within two pieces: a machine that
    starts takes longer. ``free``: samples that count.

    >>> x = np.sin(np.arange(20_000.0))
    >>> x[15_000:] *= 1e-3
    >>> np.flatnonzero(quiet(x, x < 9.0))[[0, -1]]
    array([15000, 19999])
    """
    still = np.zeros(x.size, dtype=bool)
    values = _parted(np.where(free, x, np.nan))
    count, size = values.shape
    if count < 2 * _SHORTEST or np.mean(free) < 0.5:
        return still
    held = np.count_nonzero(np.isfinite(values), axis=1) >= _SHORTEST // 2
    rms = np.full(count, np.nan)
    rms[held] = np.nanstd(values[held], axis=1)
    usual = float(np.nanquantile(rms, _USUALLY))
    low = held & (rms < _QUIET * usual)
    runs = _runs(low)
    long = [(a, b) for a, b in runs if b - a >= max(2.0, _STILL * count)]
    if not 0 < len(long) <= _PLACES or sum(b - a for a, b in runs) > _STRAY + sum(
        b - a for a, b in long
    ):
        return still
    for a, b in long:
        beside = [rms[max(0, a - 2) : a], rms[b : b + 2]]
        known = [part[np.isfinite(part)] for part in beside]
        if all(part.size == 0 or np.max(part) > _LIVELY * usual for part in known):
            still[a * size : x.size if b == count else b * size] = True
    return still


def _parted(x: Floats) -> Floats:
    """The record in 200 pieces of equal length, of 32 samples at least (piece, sample)."""
    size = max(_SHORTEST, x.size // _PIECES)
    return x[: x.size // size * size].reshape(x.size // size, size)


def _runs(where: Mask) -> list[tuple[int, int]]:
    """First and one past the last of each run of true ones."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], where.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
