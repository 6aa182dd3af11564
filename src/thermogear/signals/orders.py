"""Orders: the angle of a shaft from a tacho or a mesh line, resampling in angle."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import ArrayLike
from scipy import fft

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals.spectra import finite_record, positive_rate


def rising_edges(pulses: ArrayLike, *, rate: float, level: float | None = None) -> Floats:
    """Times [s] of the rising edges of a tacho signal, interpolated between samples.

    ``pulses`` [any unit], ``rate`` [samples/s], ``level`` [unit of the pulses].
    An edge counts when the signal rises through ``level`` (default: midway between its 2nd and
    98th percentile) after it has been below the lower quarter of its range: the hysteresis keeps
    noise at the level from counting twice.

    >>> rising_edges(np.arange(400) % 100 >= 50, rate=1000.0).round(4)
    array([0.0495, 0.1495, 0.2495, 0.3495])
    """
    values, per_second = finite_record(pulses), positive_rate(rate)
    bottom, top = np.percentile(values, [2.0, 98.0])
    middle = 0.5 * (bottom + top) if level is None else float(level)
    guard = middle - 0.25 * (top - bottom)
    above = values > middle
    edges = np.flatnonzero(above[1:] & ~above[:-1])
    lows = np.flatnonzero(values < guard)
    kept: list[float] = []
    last = -1
    for edge in edges:
        # the newest sample under the guard must be younger than the edge counted last
        place = int(np.searchsorted(lows, edge, side="right")) - 1
        if place >= 0 and lows[place] > last:
            rise = values[edge + 1] - values[edge]
            kept.append((edge + (middle - values[edge]) / rise) / per_second)
            last = int(edge)
    return np.asarray(kept, dtype=float)


_MANY = 1000  # turns


def samples_per_cycle(frequency: float) -> int:
    """Samples in a cycle of its angle, of a line at ``frequency`` [cycles/sample]: the power of two
    that is no fewer than there.

    >>> samples_per_cycle(0.1)
    16
    """
    return int(2 ** np.ceil(np.log2(1.0 / frequency)))


def resample_by_angle(
    x: ArrayLike, angle: ArrayLike, *, samples_per_turn: int, turns: int | None = None
) -> Floats:
    """The record at equal steps of angle, whole turns only, from the first whole turn on.

    ``x`` [any unit] time last, ``angle`` [turns] of each sample, rising. The record is first made
    twice as fine by its Fourier series, so that the spline of fifth order through it loses less
    than 0.1 % up to 0.8 of half the rate. Returns (..., turns x samples_per_turn).

    >>> angle = np.linspace(0.0, 4.0, 401)
    >>> turned = resample_by_angle(np.cos(2 * np.pi * angle), angle, samples_per_turn=32)
    >>> turned.shape
    (128,)
    """
    values = finite_record(x)
    turned = finite_record(angle, "angle")
    if turned.shape != (values.shape[-1],) or np.any(np.diff(turned) <= 0):
        raise InputError("angle", f"shape {turned.shape}", allowed="rising, one per sample")
    first = float(np.ceil(turned[0]))
    whole = int(np.floor(turned[-1] - first))
    count = min(int(turns or whole), whole)
    if turns is None and count > _MANY:  # a few turns fewer make a length that the transform likes
        count = int(fft.prev_fast_len(count, real=True))
    if count < 1 or samples_per_turn < 2:
        raise InputError("turns", count, allowed=">= 1 whole turn and >= 2 samples per turn")
    wanted = first + np.arange(count * samples_per_turn) / samples_per_turn
    place = np.interp(wanted, turned, np.arange(turned.size))
    fine = _finer(values, 2)
    rows = [
        scipy.ndimage.map_coordinates(row, 2.0 * place[None], order=5, mode="mirror")
        for row in fine.reshape(-1, fine.shape[-1])
    ]
    return np.reshape(rows, (*values.shape[:-1], place.size))


def _finer(values: Floats, factor: int) -> Floats:
    """The record on a grid ``factor`` times finer: zero-padded DFT of the record and its mirror.

    The mirror image closes the record on itself, so no step at its ends rings.
    """
    count = values.shape[-1]
    # a few mirrored samples more make a length that the transform likes
    half = int(fft.next_fast_len(count - 1, real=True))
    pad = [(0, 0)] * (values.ndim - 1) + [(0, min(half - (count - 1), count - 1))]
    longer = np.pad(values, pad, mode="reflect")
    closed = np.concatenate([longer, longer[..., -2:0:-1]], axis=-1)
    lines = factor * fft.rfft(closed, axis=-1)
    fine = fft.irfft(lines, n=factor * closed.shape[-1], axis=-1)
    return np.asarray(fine[..., : factor * (count - 1) + 1])
