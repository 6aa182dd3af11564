"""The lines of a record as points on the frequency axis: where, how high, how dense, how sure.

Everything is in cycles per sample. Noise model: in every channel the power of a bin over the floor
around it is exponential (Gaussian noise), channels independent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import fft, ndimage, stats

from thermogear.base.arrays import Floats
from thermogear.measured.prominence import running_median
from thermogear.signals.windows import Window

MOST = 600
"""Lines kept, the highest."""

_FALSE = 0.1  # peaks of noise alone expected in a whole spectrum
_NEAR = 200  # bins to each side in which the density of lines is counted
_LOBE = 3  # bins beside a line in which a lower one cannot be told
_ITSELF = 1.0  # bins
_PLACE = 0.01  # bins: what is left of a place's error
_SAME_NUMBER = 1e-9  # of the range: two values that a unit's factor has made of one
_LOBE_BINS = np.arange(-2, 3)


@dataclass(frozen=True, kw_only=True, eq=False)
class Peaks:
    """Lines that stand out of the floor, by position, and what is not seen between them.

    ``place`` [cycles/sample] with standard deviation ``error``; ``level``: natural logarithm of
    amplitude over the floor's rms; ``density``: other lines per bin around each; ``least``: the
    level that a line must have to be seen; ``bin_width`` [cycles/sample]; ``steady``: the clock is
    the record's own, no line had to be followed.
    """

    place: Floats
    error: Floats
    level: Floats
    density: Floats
    least: float
    bin_width: float
    bins: int
    steady: bool = True

    @property
    def size(self) -> int:
        """How many there are."""
        return int(self.place.size)

    @cached_property
    def mean_height(self) -> float:
        """Mean height of the lines over the threshold [nepers]."""
        return float(np.mean(self.level - self.least))

    def nearest(self, position: Floats) -> tuple[NDArray[np.int64], Floats]:
        """Index of the line nearest to each position, and how far it is off [bins]."""
        after = np.searchsorted(self.place, position)
        after = np.minimum(np.maximum(after, 1), max(1, self.size - 1))
        before = after - 1
        after = np.minimum(after, self.size - 1)
        first = np.abs(self.place[before] - position) <= np.abs(self.place[after] - position)
        index = np.where(first, before, after)
        return index, np.asarray((self.place[index] - position) / self.bin_width)

    def without_skirts(self, line: float, width: float) -> Peaks:
        """The lines but those within ``width`` (relative) of a multiple of ``line``
        [cycles/sample], itself kept: what is left there of a line that was followed by its phase,
        through a filter of that half width, is no sideband."""
        rank = np.maximum(np.rint(self.place / line), 1.0)
        off = np.abs(self.place - rank * line)
        kept = (off > width * rank * line) | (off < _ITSELF * self.bin_width)
        parts = {name: getattr(self, name)[kept] for name in ("place", "error", "level", "density")}
        return replace(self, **parts)


def peaks_of(channels: Floats, rate: float = 1.0, *, resolution: Floats | None = None) -> Peaks:
    """The lines of ``channels`` (channel, sample), ``rate`` samples for each unit of frequency.

    ``rate`` is 1 for a record in time; for one resampled in angle, samples per sample of the
    mean clock. ``resolution``: the step of each channel's numbers (0: none), whose noise is the
    least floor: in a record that repeats itself there may be nothing else. A peak counts where the
    sum of normalised powers is one that noise alone would pass in a tenth of a bin of the whole
    spectrum.
    """
    count, samples = channels.shape
    hann = Window("hann")
    centred = channels - channels.mean(axis=-1, keepdims=True)
    spectrum = fft.rfft(centred * hann.samples(samples), axis=-1)
    bin_width = rate / samples
    power = np.maximum(np.abs(spectrum), 1e-300) ** 2
    logs = np.log(power)
    floor = floor_of(logs)
    if resolution is not None:
        rounding = np.sum(hann.samples(samples) ** 2) * np.square(resolution) / 12.0
        floor = np.maximum(floor, np.log(np.maximum(rounding * np.log(2.0), 1e-300))[:, None])
    total = np.sum(power / np.exp(floor) * np.log(2.0), axis=0)
    number = total.size
    least = least_seen(number, channels=count)
    highest = ndimage.maximum_filter1d(total, 3)
    inside = np.arange(number)
    clear = (total == highest) & (total > least)
    top = np.flatnonzero(clear & (inside > 2) & (inside < number - 3))
    if top.size > MOST:
        top = np.sort(top[np.argsort(-total[top])[:MOST]])
        least = float(np.min(total[top]))
    beside = top[:, None] + _LOBE_BINS
    # signs: neighbours in a line's main lobe alternate, the record starts at its left end
    lobes = spectrum[:, beside] * (-1.0) ** _LOBE_BINS / np.exp(0.5 * floor[:, top])[..., None]
    shift, noise = _in_lobe(lobes * np.sqrt(np.log(2.0)), hann)
    place = (top + shift) * bin_width
    around = np.searchsorted(top, top + _NEAR) - np.searchsorted(top, top - _NEAR) - 1
    density = (around + 0.5) / (2.0 * _NEAR)
    # of a Hann peak's place: (2/3) sqrt(5/3) noise over amplitude
    scatter = 0.86 * np.sqrt(np.maximum(1.0, noise) / (2.0 * total[top]))
    return Peaks(
        place=place,
        error=np.hypot(scatter, _PLACE) * bin_width,
        level=0.5 * np.log(total[top] / count),
        density=np.asarray(density, dtype=float),
        least=0.5 * float(np.log(least / count)),
        bin_width=bin_width,
        bins=number,
    )


def resolution_of(channels: Floats) -> Floats:
    """Smallest step between the numbers of each channel: that of its digits or of its converter.

    >>> float(resolution_of(np.array([[0.3, 0.1, 0.1, 0.2]]))[0].round(12))
    0.1
    """
    steps = np.zeros(len(channels))
    for number, values in enumerate(channels):
        apart = np.diff(np.unique(values))
        apart = apart[apart > _SAME_NUMBER * np.ptp(values)]
        steps[number] = apart.min() if apart.size else 0.0
    return steps


def floor_of(logs: Floats) -> Floats:
    """Running median of the logarithm of power (channel, bin), lines left out."""
    # a sharp resonance needs a short window, lines that stand close a long one
    return np.maximum(running_median(logs, 301), running_median(logs, 61))


def least_seen(bins: int, *, channels: int) -> float:
    """Sum of normalised powers that noise passes in a tenth of a bin of the whole spectrum."""
    return float(stats.gamma.isf(_FALSE / bins, channels))


def _in_lobe(lobes: NDArray[np.complex128], window: Window) -> tuple[Floats, Floats]:
    """Offsets [bins] of lines from their highest bins, and the power a bin has beside the line's.

    ``lobes`` (channel, line, bin -2..2), a bin's power over the floor. The offset is that of three
    Hann bins, of each the part in phase with the highest. What the shape of a line
    does not explain of the five bins is noise, a neighbour, or a line that wanders.
    """
    phased = np.sum((lobes * np.conj(lobes[..., 2:3])).real, axis=0)
    left, peak, right = phased[:, 1], phased[:, 2], phased[:, 3]
    bottom = left + 2.0 * peak + right
    shift = 2.0 * (right - left) / np.where(bottom > 0.0, bottom, 1.0)
    shift = np.clip(np.where(bottom > 0.0, shift, 0.0), -0.5, 0.5)
    shape = window.response(_LOBE_BINS - shift[:, None])
    size = np.sum(lobes * shape, axis=-1) / np.sum(shape**2, axis=-1)
    left_over = np.sum(np.abs(lobes - size[..., None] * shape) ** 2, axis=(0, -1))
    channels = lobes.shape[0]
    return np.asarray(shift), np.asarray(2.0 * left_over / (8.0 * channels - 1.0))
