"""How far every line of a spectrum is above the floor around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.signals.lines import hann_offset
from thermogear.signals.spectra import amplitude_spectrum, running_median


@dataclass(frozen=True, kw_only=True)
class Prominence:
    """Mean over channels of log(amplitude/floor), its median taken away, per bin."""

    level: Floats
    amplitude: Floats  # geometric mean over channels, for the interpolation of peaks
    per_unit: float  # bins per unit of frequency (or order)
    spread: float

    def at(self, place: Floats | float) -> Floats:
        """The higher of the two bins beside each place (0 outside)."""
        bins = np.asarray(place, dtype=float) * self.per_unit
        low = np.floor(bins).astype(int)
        inside = (low >= 1) & (low + 1 < self.level.size)
        low = np.where(inside, low, 1)
        return np.where(inside, np.maximum(self.level[low], self.level[low + 1]), 0.0)

    def peak(self, place: float, *, reach: int) -> tuple[float, float]:
        """Interpolated position of the highest bin within ``reach`` bins, and its level."""
        centre = int(np.rint(place * self.per_unit))
        low, high = max(1, centre - reach), min(self.level.size - 1, centre + reach + 1)
        if low >= high:
            return place, 0.0
        top = low + int(np.argmax(self.level[low:high]))
        if top + 1 >= self.level.size:
            return place, 0.0
        shift = hann_offset(self.amplitude[top - 1 : top + 2])
        return (top + shift) / self.per_unit, float(self.level[top])


def prominence(channels: Floats, rate: float) -> Prominence:
    """How far a bin of ``channels`` (channel, sample) is over its floor; ``rate`` [1/unit]."""
    spectrum = amplitude_spectrum(channels - channels.mean(axis=-1, keepdims=True), rate, "hann")
    amplitudes = np.maximum(spectrum.amplitudes, 1e-300)
    logs = np.log(amplitudes)
    level = np.mean(logs - running_median(logs), axis=0)
    level = level - np.median(level)
    pairs = np.maximum(level[:-1], level[1:])
    spread = float(np.diff(np.percentile(pairs, [15.87, 50.0]))[0])
    level = level - float(np.median(pairs))
    return Prominence(
        level=level,
        amplitude=np.exp(logs.mean(axis=0)),
        per_unit=1.0 / spectrum.bin_width,
        spread=max(spread, 1e-12),
    )
