"""Linear-phase FIR band passes: their taps, and their gain at a line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals.spectra import finite_record, positive_rate


@dataclass(frozen=True)
class BandPass:
    """A windowed-sinc band pass (Hamming), an odd number of taps, so a whole delay.

    ``band`` = (low, high) [same unit as ``rate``], 0 < low < high < rate/2; the response is -6 dB
    at both and 1 in the middle of the band. Too few taps blur the edges: read ``gain`` at the
    line of interest before trusting its amplitude.

    >>> band = BandPass(rate=1000.0, band=(50.0, 150.0), taps=331)
    >>> [f"{gain:.2f}" for gain in band.gain([50.0, 100.0])]
    ['0.50', '1.00']
    """

    rate: float
    band: tuple[float, float]
    taps: int

    def __post_init__(self) -> None:
        positive_rate(self.rate)
        low, high = self.band
        if not 0 < low < high < self.rate / 2:
            raise InputError(
                "band",
                f"{low:g}..{high:g}",
                allowed=f"0 < low < high < {self.rate / 2:g} (half the rate)",
            )
        if self.taps < 3 or self.taps % 2 == 0:
            raise InputError(
                "taps", self.taps, allowed="an odd number >= 3", why="the delay must be whole"
            )

    @property
    def coefficients(self) -> Floats:
        """The impulse response, symmetric."""
        return np.asarray(
            scipy.signal.firwin(
                self.taps, self.band, pass_zero=False, fs=self.rate, window="hamming"
            )
        )

    @property
    def delay(self) -> int:
        """Samples of delay: (taps - 1)/2."""
        return (self.taps - 1) // 2

    def gain(self, frequency: ArrayLike) -> Floats:
        """Amplitude gain at ``frequency`` (real: the delay is removed; any shape)."""
        f = np.asarray(frequency, dtype=float)
        shift = np.arange(self.taps) - self.delay
        angle = 2.0 * np.pi * np.multiply.outer(f, shift) / self.rate
        return np.asarray(np.cos(angle) @ self.coefficients)


def taps_for(rate: float, *, transition: float) -> int:
    """Odd number of taps of a Hamming design for a ``transition`` band: 3.3 rate/transition.

    Source: Oppenheim and Schafer, Discrete-Time Signal Processing, window design, table of
    transition widths (Hamming: 3.3/N of the rate).

    >>> taps_for(1000.0, transition=10.0)
    331
    """
    return int(np.ceil(3.3 * rate / transition)) // 2 * 2 + 1


def without_trend(x: ArrayLike) -> Floats:
    """The record less its mean and its straight line (least squares).

    >>> without_trend([1.0, 3.0, 5.0]).round(9) + 0.0
    array([0., 0., 0.])
    """
    values = finite_record(x)
    ramp = np.arange(values.shape[-1]) - 0.5 * (values.shape[-1] - 1)
    moved = values - values.mean(axis=-1, keepdims=True)
    slope = moved @ ramp / float(ramp @ ramp)
    return np.asarray(moved - slope[..., None] * ramp)


def thinned(x: ArrayLike, every: int) -> Floats:
    """Each ``every``-th sample of one channel, behind a filter that keeps its rate's half free.

    ``x`` [any unit]; zeros stand beyond its ends. A windowed sinc of 20 ``every`` + 1 taps (Kaiser,
    beta 10): even to 1.1e-5 up to 0.6 of half the new rate. Source: Oppenheim and Schafer,
    Discrete-Time Signal Processing, window design and decimation.

    >>> x = np.cos(2 * np.pi * 0.02 * np.arange(4000))
    >>> bool(np.abs(thinned(x, 4) - x[::4])[20:-20].max() < 1e-4)
    True
    """
    values, reach = finite_record(x), 10 * every
    if every == 1:
        return values
    taps = np.sinc(np.arange(-reach, reach + 1) / every) * np.kaiser(2 * reach + 1, 10.0)
    count = -(-values.size // every)
    rows = np.pad(values, (reach, count * every - values.size + reach)).reshape(-1, every)
    parts = np.pad(taps / taps.sum(), (0, every - 1)).reshape(-1, every)
    return np.asarray(sum(rows[k : k + count] @ part for k, part in enumerate(parts)))
