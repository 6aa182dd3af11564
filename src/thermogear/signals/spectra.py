"""Amplitude spectra of computed and measured records, and the lines of exactly periodic ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals import windows
from thermogear.signals.windows import Window


@dataclass(frozen=True, kw_only=True)
class Spectrum:
    """One-sided amplitude spectrum (peak, not rms); unpacks into frequencies, amplitudes.

    ``amplitudes`` has the record's leading axes and the frequency axis last; the lines at 0 and
    at the Nyquist limit are not doubled. ``bin_width`` = rate/samples; ``noise_bandwidth`` in
    bins (ENBW).

    >>> spectrum = amplitude_spectrum(np.ones(100), 1000.0)
    >>> f"{spectrum.bin_width:.0f} Hz"
    '10 Hz'
    """

    frequencies: Floats
    amplitudes: Floats
    rate: float
    samples: int
    window: Window
    noise_bandwidth: float

    def __iter__(self) -> Iterator[Floats]:
        yield self.frequencies
        yield self.amplitudes

    @property
    def bin_width(self) -> float:
        """Distance of two lines, in the unit of ``rate``."""
        return self.rate / self.samples


def finite_record(x: ArrayLike, field: str = "record") -> Floats:
    """The record as floats, time on the last axis; empty or non-finite records are refused.

    >>> finite_record([1, 2])
    array([1., 2.])
    """
    values = np.asarray(x, dtype=float)
    if values.ndim == 0 or values.shape[-1] < 2:
        raise InputError(field, f"shape {values.shape}", allowed="2 samples or more, time last")
    if not np.all(np.isfinite(values)):
        bad = int(values.size - np.count_nonzero(np.isfinite(values)))
        raise InputError(field, f"{bad} non-finite of {values.size} samples", allowed="finite")
    return values


def positive_rate(rate: float) -> float:
    """The sampling rate, refused when it is not a positive finite number.

    >>> positive_rate(1000)
    1000.0
    """
    if not (np.isfinite(rate) and rate > 0):
        raise InputError("rate", rate, allowed="> 0 samples per second (or per period)")
    return float(rate)


def amplitude_spectrum(
    x: ArrayLike, rate: float = 1.0, window: str | Window = "rectangular"
) -> Spectrum:
    """One-sided, amplitude-correct spectrum of a record (peak amplitudes).

    A_k = c_k |sum_j w_j x_j exp(-2 pi i j k/N)| / sum_j w_j,  c = 1 at k = 0 and N/2, else 2.

    ``x`` [any unit], time on the last axis, uniform steps; ``rate`` [samples per unit of time];
    ``window`` a name of ``WINDOWS``. A line at the centre of a bin is read exactly by every
    window; between two bins it loses up to ``Window.scalloping`` (flat top: 0.1 %). No mean
    is taken away.

    Raises InputError for an unknown window, a rate that is not positive, non-finite samples.
    Source: Heinzel, Ruediger, Schilling 2002, "Spectrum and spectral density estimation by the
    DFT", eqs. (21)-(24) for the sums and the noise bandwidth, scaled to peak instead of rms.

    >>> t = np.arange(1000) / 1000.0
    >>> x = 3.0 * np.cos(2 * np.pi * 50.0 * t)
    >>> spectrum = amplitude_spectrum(x, 1000.0)
    >>> f"{spectrum.amplitudes[50]:.3f} at {spectrum.frequencies[50]:.0f} Hz"
    '3.000 at 50 Hz'
    """
    values, per_second = finite_record(x), positive_rate(rate)
    chosen = windows.window(window)
    count = values.shape[-1]
    weights = chosen.samples(count)
    total = float(weights.sum())
    if total <= 0.0:
        raise InputError("record", f"{count} samples", why=f"too few for the {chosen.name} window")
    lines = np.abs(np.fft.rfft(values * weights, axis=-1)) / total
    lines[..., 1:] *= 2.0
    if count % 2 == 0:
        lines[..., -1] *= 0.5
    return Spectrum(
        frequencies=np.arange(count // 2 + 1) * (per_second / count),
        amplitudes=lines,
        rate=per_second,
        samples=count,
        window=chosen,
        noise_bandwidth=float(count * np.sum(weights**2) / total**2),
    )


def order_lines(
    x: ArrayLike, *, samples_per_period: int, periods: int, orders: ArrayLike
) -> NDArray[np.complex128]:
    """Complex lines of an exactly periodic record at given orders (cycles per period).

    c(q) = (2/N) sum_j x_j exp(-2 pi i q j/S),  N = S P samples, S a period's samples, P periods,

    so that x holds Re c exp(2 pi i q t) with t in periods; orders 0 and S/2 are not doubled.
    Every q must be a multiple of 1/P: then it is a line of the DFT and nothing leaks (the half
    order needs an even P). ``x`` has time last and exactly N samples; the first is phase 0.

    Returns the leading axes of ``x`` with the orders last. Raises InputError for another length,
    for orders between two lines, negative, or above S/2.

    >>> phase = np.arange(64) / 32
    >>> lines = order_lines(
    ...     2.0 * np.cos(2 * np.pi * phase), samples_per_period=32, periods=2, orders=[1, 2]
    ... )
    >>> abs(lines).round(3)
    array([2., 0.])
    """
    values = finite_record(x)
    if samples_per_period < 2 or periods < 1:
        raise InputError(
            "samples_per_period, periods",
            f"{samples_per_period}, {periods}",
            allowed=">= 2 samples and >= 1 period",
        )
    count = int(samples_per_period) * int(periods)
    if values.shape[-1] != count:
        raise InputError(
            "record",
            f"{values.shape[-1]} samples",
            allowed=f"{samples_per_period} x {periods} = {count} samples",
            why="the lines are exact for whole periods alone",
        )
    wanted = np.atleast_1d(np.asarray(orders, dtype=float))
    ranks = np.rint(wanted * periods).astype(np.int64)
    off = np.abs(wanted * periods - ranks) > 1e-9 * np.maximum(1.0, np.abs(ranks))
    if np.any(off):
        raise InputError(
            "orders",
            float(wanted[off][0]),
            allowed=f"multiples of 1/{periods} over {periods} periods",
            fix="take a number of periods that makes order x periods whole",
        )
    if np.any(ranks < 0) or np.any(2 * ranks > count):
        raise InputError("orders", wanted.tolist(), allowed=f"0..{samples_per_period / 2:g}")
    lines = np.fft.rfft(values, axis=-1)[..., ranks] * (2.0 / count)
    single = (ranks == 0) | (2 * ranks == count)
    return np.asarray(np.where(single, 0.5 * lines, lines))


def order_amplitudes(
    x: ArrayLike, *, samples_per_period: int, periods: int, orders: ArrayLike
) -> Floats:
    """Peak amplitudes of an exactly periodic record at given orders: |``order_lines``|.

    >>> phase = np.arange(64) / 32
    >>> order_amplitudes(
    ...     2.0 * np.cos(2 * np.pi * phase), samples_per_period=32, periods=2, orders=[0.5, 1]
    ... ).round(3)
    array([0., 2.])
    """
    return np.asarray(
        np.abs(
            order_lines(x, samples_per_period=samples_per_period, periods=periods, orders=orders)
        )
    )


def running_median(values: Floats, width: int = 301) -> Floats:
    """Median over about ``width`` bins, on a grid of half widths, straight between: (row, bin).

    >>> running_median(np.arange(40.0)[None], 9)[0, [10, 20]]
    array([10., 20.])
    """
    count = values.shape[-1]
    width = min(width, max(9, count // 8))
    starts = np.arange(0, max(1, count - width + 1), max(1, width // 2))
    middles = starts + 0.5 * (width - 1)
    windows = np.lib.stride_tricks.sliding_window_view(values, width, axis=-1)
    medians = np.median(windows[:, starts], axis=-1)
    grid = np.arange(count)
    return np.stack([np.interp(grid, middles, row) for row in medians])
