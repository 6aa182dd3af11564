"""Welch's averaged power density, in one go or block by block for records larger than memory."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.signals import windows
from thermogear.signals.spectra import line_shares, positive_rate
from thermogear.signals.windows import Window

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Density:
    """One-sided power density [unit^2 per unit of rate] averaged over ``averages`` segments.

    >>> density = welch([np.sin(np.arange(1024))], 1024.0, 256)
    >>> density.averages, density.bin_width
    (7, 4.0)
    """

    frequencies: Floats
    density: Floats
    rate: float
    segment: int
    averages: int
    window: Window
    noise_bandwidth: float

    @property
    def bin_width(self) -> float:
        """Distance of two bins, in the unit of the rate."""
        return self.rate / self.segment

    @property
    def amplitudes(self) -> Floats:
        """Peak amplitude of a line that fills one bin: sqrt(2 density ENBW bin width)."""
        return np.sqrt(2.0 * self.density * self.noise_bandwidth * self.bin_width)


def welch(
    blocks: Iterable[Floats], rate: float, segment: int, window: str | Window = "hann"
) -> Density:
    """Power density of one channel given in consecutive blocks (any lengths), overlap one half.

    P(f) = mean over segments of 2 |sum w x exp|^2 / (rate sum w^2); 0 Hz and Nyquist single; the
    mean of each segment is taken away.

    Raises InputError when all blocks together are shorter than one segment, and for a sample
    that is not finite.
    Source: Welch 1967, IEEE Trans. Audio Electroacoust. 15, 70-73.

    >>> x = np.random.default_rng(1).normal(size=20000)
    >>> f"{welch([x], 1000.0, 256).density.mean():.4f}"
    '0.0020'
    """
    per_second, chosen = positive_rate(rate), windows.window(window)
    if segment < 8:
        raise InputError("segment", segment, allowed=">= 8 samples")
    weights = chosen.samples(segment)
    total = np.zeros(segment // 2 + 1)
    averages, rest, hop = 0, np.empty(0), segment - segment // 2
    for block in blocks:
        values = np.asarray(block, dtype=float)
        if not np.all(np.isfinite(values)):
            raise InputError("record", "a non-finite sample", allowed="finite")
        rest = np.concatenate([rest, values])
        start = 0
        while rest.size - start >= segment:
            piece = rest[start : start + segment]
            total += np.abs(np.fft.rfft((piece - piece.mean()) * weights)) ** 2
            averages += 1
            start += hop
        rest = rest[start:]
    if averages == 0:
        raise InputError("segment", segment, allowed=f"at most the record's {rest.size} samples")
    energy = float(np.sum(weights**2))
    sides = 1.0 / line_shares(segment)  # one-sided: 1 at 0 Hz and Nyquist, else 2
    return Density(
        frequencies=np.asarray(np.arange(segment // 2 + 1) * (per_second / segment), float),
        density=total * sides / (averages * per_second * energy),
        rate=per_second,
        segment=segment,
        averages=averages,
        window=chosen,
        noise_bandwidth=float(segment * energy / weights.sum() ** 2),
    )
