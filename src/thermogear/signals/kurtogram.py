"""Spectral kurtosis, the band that is most impulsive, squared envelopes and cepstra."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft, ndimage, special

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals.spectra import finite_record, running_median

FEWEST = 128
"""Complex samples of a band at least: fewer have a kurtosis of more noise than 0.18 (chosen, as the
levels of Antoni's fast kurtogram end, log2 N - 7)."""
_BESIDE = 101  # bins over which the floor of an envelope spectrum is taken
_LINE = 12.0  # times the floor's power: a line, which one bin of noise in 160 000 is (chosen)
_LOBE = 3  # bins to each side that a line fills


def spectral_kurtosis(coefficients: ArrayLike) -> Floats:
    """E|X|^4/(E|X|^2)^2 - 2 of complex samples of a band, last axis: (...).

    0 for Gaussian noise, with standard deviation 2/sqrt(K) of K independent samples; -1 for a
    steady line; 2/p - 2 for noise on a share p of the time. nan where nothing is there.
    Source: Antoni 2006, Mech. Syst. Signal Process. 20, 282-307.

    >>> float(spectral_kurtosis(np.exp(0.3j * np.arange(100))).round(6))
    -1.0
    """
    power = np.abs(np.asarray(coefficients)) ** 2
    mean = power.mean(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.mean(power**2, axis=-1) / mean**2 - 2.0)


@dataclass(frozen=True, kw_only=True)
class Band:
    """Between ``low`` and ``high`` [cycles/sample], with its spectral ``kurtosis``.

    >>> Band(low=0.1, high=0.2, kurtosis=3.0).kurtosis
    3.0
    """

    low: float
    high: float
    kurtosis: float


def kurtogram(x: ArrayLike) -> tuple[Band, ...]:
    """Bands of a record at every level, in the order of the levels.

    Half the rate is cut into 1, 2, 3, 4, 6, 8, 12, ... bands of one width, as long as a band has
    128 complex samples; a band's coefficients are the inverse DFT of its bins. The levels are those
    of the fast kurtogram, the bands ideal ones in place of its tree of filters.
    ``x`` [any unit] without the lines of gears and shafts, which hide what is impulsive.
    Source: Antoni 2007, Mech. Syst. Signal Process. 21, 108-124.

    >>> len(kurtogram(np.random.default_rng(1).normal(size=1024)))
    10
    """
    values = finite_record(x)
    lines = fft.rfft(values - values.mean())[1:]
    counts = sorted(first * 2**level for first in (1, 3) for level in range(24))
    bands: list[Band] = []
    for count in counts:
        width = lines.size // count
        if width < FEWEST:
            break
        parts = lines[: count * width].reshape(count, width)
        edges = np.arange(count + 1) * width / values.size
        bands += [
            Band(low=float(low), high=float(high), kurtosis=float(kurtosis))
            for low, high, kurtosis in zip(
                edges[:-1], edges[1:], spectral_kurtosis(fft.ifft(parts, axis=-1)), strict=True
            )
        ]
    return tuple(bands)


def impulsive_band(bands: Sequence[Band], *, samples: int, chance: float = 0.01) -> Band | None:
    """The band of the highest spectral kurtosis, None where noise alone may have it.

    Noise of K = ``samples`` (high - low) complex samples has 0 +- 2/sqrt(K): a band counts beyond
    (2/sqrt(K)) z (1 + z/sqrt(K)), z the normal quantile of ``chance`` over the number of bands. The
    second factor is chosen, for the tail of few samples; the tests hold it by drawings.

    >>> quiet = kurtogram(np.random.default_rng(1).normal(size=4096))
    >>> impulsive_band(quiet, samples=4096) is None
    True
    """
    known = [band for band in bands if np.isfinite(band.kurtosis)]
    z = float(special.ndtri(1.0 - chance / max(len(known), 1)))

    def beyond(band: Band) -> float:
        root = np.sqrt(samples * (band.high - band.low))
        return float(band.kurtosis / (2.0 / root * z * (1.0 + z / root)))

    clear = [band for band in known if beyond(band) > 1.0]
    return max(clear, key=lambda band: band.kurtosis, default=None)


def without_lines(x: ArrayLike, *, spacings: Sequence[float] = ()) -> Floats:
    """``x`` without its lines: bins of its DFT set to 0 at all multiples of each of ``spacings``
    [bins] and one beside, and where power is 12 times the floor's and three beside.

    The floor is the median over 301 bins over ln 2, the mean power of Gaussian noise. A line in no
    bin of its own leaves its ends, which are below 12 times the floor.

    >>> line = np.cos(0.125 * np.pi * np.arange(4096))
    >>> noise = np.random.default_rng(1).normal(size=4096)
    >>> round(float(np.std(without_lines(20.0 * line + noise))), 1)
    1.0
    """
    values = finite_record(x)
    lines = fft.rfft(values)
    power = np.abs(lines) ** 2
    floor = running_median(power[None])[0] / np.log(2.0)
    high = (power > _LINE * floor).astype(float)
    lines[np.convolve(high, np.ones(2 * _LOBE + 1), mode="same") > 0.0] = 0.0
    for spacing in spacings:
        places = np.rint(np.arange(0.0, lines.size - 1.0, spacing)).astype(int)
        for offset in (-1, 0, 1):
            lines[np.clip(places + offset, 0, lines.size - 1)] = 0.0
    return np.asarray(fft.irfft(lines, n=values.size))


@dataclass(frozen=True, kw_only=True)
class EnvelopeSpectrum:
    """Lines of a squared envelope over its mean: ``amplitude`` at ``position`` [cycles/sample], and
    the ``floor`` of noise about each, as an amplitude.

    >>> place, ones = np.array([0.1, 0.2]), np.ones(2)
    >>> EnvelopeSpectrum(position=place, amplitude=2 * ones, floor=ones).level(low=0.15, high=0.3)
    (0.2, 4.0)
    """

    position: Floats
    amplitude: Floats
    floor: Floats

    def level(self, *, low: float, high: float) -> tuple[float, float]:
        """Position of the highest line between two positions, and its power over the floor's; nan
        and 0 where no line is there."""
        inside = np.flatnonzero((self.position >= low) & (self.position <= high))
        if not inside.size:
            return float("nan"), 0.0
        over = (self.amplitude[inside] / self.floor[inside]) ** 2
        best = int(np.argmax(over))
        return float(self.position[inside[best]]), float(over[best])


def envelope_spectrum(x: ArrayLike, *, low: float, high: float) -> EnvelopeSpectrum:
    """The spectrum of the squared envelope of ``x`` between ``low`` and ``high`` [cycles/sample].

    |c|^2/mean of the band's complex samples c, its DFT as peak amplitudes. Noise that swells as
    1 + m cos has 2m/(1 + m^2/2) at its rate and (m^2/2)/(1 + m^2/2) at twice that. White noise of K
    samples has lines whose square is exponential with mean 4/K: the highest of n lines is beyond
    (4/K) ln(n/p) with chance p. The floor is that, or the median of 101 lines around over ln 2
    where it is more.
    Raises InputError for a band without 16 bins. Source: Randall and Antoni 2011, section 4.

    >>> turned = envelope_spectrum(np.random.default_rng(1).normal(size=4096), low=0.0, high=0.5)
    >>> bool(np.max(turned.amplitude) ** 2 < 4 / 2048 * np.log(1024 / 1e-3))
    True
    """
    values = finite_record(x)
    first, stop = round(low * values.size), round(high * values.size)
    stop = min(stop, values.size // 2)
    if stop - first < 16:
        raise InputError("band", f"{low:g}..{high:g}", allowed="16 bins of the record or more")
    band = fft.rfft(values - values.mean())[first:stop]
    squared = np.abs(fft.ifft(band)) ** 2
    amplitude = 2.0 * np.abs(fft.rfft(squared))[1 : band.size // 2] / max(squared.sum(), 1e-300)
    reach = min(_BESIDE, amplitude.size)
    around = ndimage.median_filter(amplitude**2, reach, mode="nearest") / np.log(2.0)
    return EnvelopeSpectrum(
        position=np.arange(1, band.size // 2) / values.size,
        amplitude=amplitude,
        floor=np.sqrt(np.maximum(around, 4.0 / band.size)),
    )


def real_cepstrum(x: ArrayLike) -> Floats:
    """IFFT of ln|DFT x|: (..., quefrency in samples), as long as ``x``.

    An echo of a times x after T samples shows as a/2 at T and -a^2/4 at 2T; a family of lines at
    equal distances f as a peak at the quefrency 1/f. Bins without any power count as the least
    number above zero.
    Source: Randall 2017, Mech. Syst. Signal Process. 97, 3-19.

    >>> x = np.zeros(64)
    >>> x[[0, 8]] = 1.0, 0.2
    >>> real_cepstrum(x)[[8, 16]].round(3)
    array([ 0.1 , -0.01])
    """
    lines = np.abs(fft.rfft(finite_record(x), axis=-1))
    return np.asarray(fft.irfft(np.log(np.maximum(lines, 1e-300)), n=np.shape(x)[-1], axis=-1))
