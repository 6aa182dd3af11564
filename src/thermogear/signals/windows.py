"""Named windows with what must be reported about them: gain, noise bandwidth, main lobe."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError, nearest

# Cosine sums w_j = sum_q (-1)^q a_q cos(2 pi q j/N), j = 0..N-1 (DFT-even: the period is N).
_COSINES: dict[str, tuple[float, ...]] = {
    "rectangular": (1.0,),
    "hann": (0.5, 0.5),
    "hamming": (0.54, 0.46),
    "blackman": (0.42, 0.5, 0.08),
    "blackman-harris": (0.35875, 0.48829, 0.14128, 0.01168),
    "flattop": (0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368),
}

WINDOWS = tuple(_COSINES)
"""Names of the known windows."""


@dataclass(frozen=True)
class Window:
    """A cosine-sum window; a line at a bin's centre keeps its amplitude.

    The coefficients are those of Harris (1978), flat top as in D'Antona and Ferrero (2006) and
    ``scipy.signal.windows.flattop``.

    >>> f"{Window('hann').noise_bandwidth:.2f} bins"
    '1.50 bins'
    """

    name: str

    def __post_init__(self) -> None:
        if self.name not in _COSINES:
            raise InputError("window", repr(self.name), fix=nearest(str(self.name), WINDOWS))

    def samples(self, count: int) -> NDArray[np.float64]:
        """The ``count`` weights over one DFT period, first one at phase 0."""
        if count < 1:
            raise InputError("count", count, allowed=">= 1 sample")
        angle = 2.0 * np.pi * np.arange(count) / count
        total = np.zeros(count)
        for rank, coefficient in enumerate(_COSINES[self.name]):
            total += (-1.0) ** rank * coefficient * np.cos(rank * angle)
        return total

    def response(self, offset: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Amplitude read at a bin ``offset`` bins from a line, over the line's amplitude.

        |a_0 S(d) + sum_q a_q [S(d - q) + S(d + q)]/2| / a_0, S(d) = sin(pi d)/(pi d): the
        limit of a long record. Half a bin off it is at its lowest inside the bin.
        """
        d = np.asarray(offset, dtype=float)
        coefficients = _COSINES[self.name]
        total = coefficients[0] * np.sinc(d)
        for rank, coefficient in enumerate(coefficients[1:], start=1):
            total = total + 0.5 * coefficient * (np.sinc(d - rank) + np.sinc(d + rank))
        return np.asarray(np.abs(total) / coefficients[0])

    @property
    def coefficients(self) -> tuple[float, ...]:
        """a_0, a_1, ... of the cosine sum."""
        return _COSINES[self.name]

    @property
    def noise_bandwidth(self) -> float:
        """Equivalent noise bandwidth N sum w^2/(sum w)^2 [bins], for more samples than terms."""
        a = _COSINES[self.name]
        return (a[0] ** 2 + 0.5 * sum(c**2 for c in a[1:])) / a[0] ** 2

    @property
    def scalloping(self) -> float:
        """Largest relative loss of a line's amplitude, for a line midway between two bins."""
        return float(1.0 - self.response(0.5))


def window(name: str | Window) -> Window:
    """The window of that name; an unknown one is refused with the nearest name.

    >>> f"{1.0 - window('flattop').scalloping:.3f}"
    '0.999'
    """
    return name if isinstance(name, Window) else Window(name)
