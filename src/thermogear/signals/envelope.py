"""The squared envelope of what is no line: impacts that slip show there, at the rate they come.

Impacts that do not come at equal times, as of a rolling bearing whose cage slips, leave no lines at
high frequencies, but the power of the bands that they ring in swells with each of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft, special

from thermogear.base.arrays import Floats
from thermogear.signals.spectra import finite_record

HARMONICS = 3
"""Harmonics of a rate whose powers are added."""

_SHARES = (4, 8, 16)  # of the spectrum that the bands are
_LOWEST = 20  # bins: below, noise that swells slowly
_FLOOR = 301  # bins over which the floor is taken
_BESIDE = 101  # bins over which the envelope's own floor is taken
_LINE = 12.0  # times the floor's power: a line
_LOBE = 3  # bins to each side that a line fills
_NEIGHBOURS = 1.0 + 2.0 * ((2.0 / 3.0) ** 2 + (1.0 / 6.0) ** 2)
"""What the Hann window's correlation of neighbouring bins makes of the mean power."""
_TOPS = 20  # highest bins of a band that are tried
_FIRST = 0.2  # least power of a rate over that of its harmonics


@dataclass(frozen=True, kw_only=True)
class Envelope:
    """A rate [cycles/sample] at which the power in ``band`` [cycles/sample] swells.

    ``powers``: of its harmonics in the squared envelope's spectrum over those of noise, whose mean
    is 1; ``chance``: how often noise alone has one as high anywhere in a record.
    """

    rate: float
    band: tuple[float, float]
    powers: tuple[float, ...]
    chance: float


def envelope_rates(x: ArrayLike, most: int = 5) -> tuple[Envelope, ...]:
    """The clearest rates in the squared envelope of one channel without its lines, the least likely
    by chance first, no harmonic of one before; none where it is too short.

    The Hann-windowed DFT is set to 0 where a bin's power is 12 times over the median of 301 around
    it, and three bins beside; the rest is divided by that floor. Of a band of M bins the
    inverse DFT is the complex envelope a; of Gaussian noise the DFT of |a|^2 has at bin k the
    mean power sum_i w_i w_(i+k), w the bins kept. P_k is the power over that, and over the median
    of 101 bins around it where that is more: exponential of mean 1.

    A rate is scored by P of its first three harmonics: their sum is beyond s by chance with
    Q(3, s) (incomplete gamma), times the number of bins of all bands, which is ``chance``.
    ``x`` [any unit]. Raises InputError for non-finite samples.
    Range: rates from 20 bins (20 turns in the record) to a twelfth of a band, known to about a bin,
    one turn in the record. Impacts that do not slip make lines: of these nothing is left here.
    Source: Randall and Antoni 2011, Mech. Syst. Signal Process. 25, 485-520, section 4, for the
    envelope of the random part; the law under noise is derived here.

    >>> noise = np.random.default_rng(1).normal(size=20_000)
    >>> swell = 1.0 + 0.9 * np.cos(2 * np.pi * 0.0031 * np.arange(20_000))
    >>> f"{envelope_rates(noise * swell)[0].rate:.4f}"
    '0.0031'
    """
    values = finite_record(x)
    count = values.size
    if count < 64 * _LOWEST:
        return ()
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    whitened, kept = _whitened(fft.rfft((values - values.mean()) * window))
    seen: list[Envelope] = []
    tests = float(len(_SHARES) * whitened.size)
    for share in _SHARES:
        width = whitened.size // share
        # bands of each width overlap by half
        for start in range(0, whitened.size - width + 1, width // 2):
            part = slice(start, start + width)
            for place, powers in _clearest(whitened[part], kept[part], most):
                chance = tests * float(special.gammaincc(HARMONICS, sum(powers)))
                band = start / count, (start + width) / count
                seen.append(Envelope(rate=place / count, band=band, powers=powers, chance=chance))
    rates: list[Envelope] = []
    for clear in sorted(seen, key=lambda rate: (rate.chance, -sum(rate.powers))):
        if not any(_is_harmonic(clear.rate * count, other.rate * count) for other in rates):
            rates.append(clear)
    return tuple(rates[:most])


def _is_harmonic(place: float, other: float) -> bool:
    """Whether a place [bins] is another or a multiple of it, within their widths: two bins, or the
    1 % that impacts which slip spread over."""
    rank = max(1, round(place / other))
    return abs(place - rank * other) < rank * max(2.0, 0.01 * other)


def _whitened(spectrum: NDArray[np.complex128]) -> tuple[NDArray[np.complex128], Floats]:
    """The spectrum over its floor, 0 at lines, and 1 where it is kept, 0 where not."""
    power = np.abs(spectrum) ** 2
    floor = np.maximum(_around(power, _FLOOR), 1e-300)
    line = np.convolve(power > _LINE * floor, np.ones(2 * _LOBE + 1), mode="same") > 0
    kept = np.where(line, 0.0, 1.0)
    return spectrum / np.sqrt(floor) * kept, kept


def _around(power: Floats, reach: int) -> Floats:
    """Mean power of noise from medians over ``reach`` bins, straight between their middles."""
    reach = min(reach, power.size)
    whole = power[: power.size // reach * reach].reshape(-1, reach)
    middle = np.append(np.median(whole, axis=1), np.median(power[-reach:])) / np.log(2.0)
    places = np.append(np.arange(len(whole)) * reach, power.size - reach) + 0.5 * reach
    return np.asarray(np.interp(np.arange(power.size), places, middle))


def _clearest(
    band: NDArray[np.complex128], kept: Floats, most: int
) -> list[tuple[float, tuple[float, ...]]]:
    """Bins (with their fractions) of the clearest rates in a band, and their harmonics' powers."""
    size = fft.next_fast_len(2 * band.size)
    squared = np.abs(fft.ifft(band, size)) ** 2
    power = np.abs(fft.rfft(squared)[: band.size]) ** 2
    mean = np.maximum(fft.irfft(np.abs(fft.rfft(kept, size)) ** 2, size)[: band.size], 1.0)
    over = power / (mean * _NEIGHBOURS) * size**2
    # impacts that slip make noise of their own in the envelope: a rate must stand out of it
    over = over / np.maximum(1.0, _around(over, _BESIDE))
    last = band.size // (4 * HARMONICS)
    if last <= _LOWEST + 2:
        return []
    tops = _LOWEST + np.argsort(-over[_LOWEST:last])[:_TOPS]
    rank = np.arange(1, HARMONICS + 1)
    parts = over[rank * tops[:, None]]
    # a rate whose double alone stands out is not the rate
    sums = np.where(parts[:, 0] >= _FIRST * parts.max(axis=-1), parts.sum(axis=-1), 0.0)
    clear: list[tuple[float, tuple[float, ...]]] = []
    while len(clear) < most and sums.max() > 0.0:  # else the band holds lines alone
        # where a rate stands out, so do its multiples: the lowest of those that do
        top = int(np.min(tops[sums >= 0.5 * sums.max()]))
        left, middle, right = np.sqrt(over[top - 1 : top + 2])
        shift = 2.0 * (right - left) / (left + 2.0 * middle + right)
        powers = tuple(float(over[r * top]) for r in rank)
        clear.append((top + float(np.clip(shift, -0.5, 0.5)), powers))
        sums[[_is_harmonic(float(other), float(top)) for other in tops]] = 0.0
    return clear
