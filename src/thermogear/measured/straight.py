"""The lines of a record whose speed wanders: told in the clock of one of its own lines."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import fft, interpolate

from thermogear.base.arrays import Floats
from thermogear.measured.peaks import Peaks, floor_of, least_seen, peaks_of, resolution_of

_REFERENCES = 4
_WIDTHS = ((0.004, 0.015, 0.045, 0.12), (0.001, 0.004))
"""Half widths of the filter over a reference, of its frequency, in the first and second pass."""
_LEAST = 12.0  # bins of that half width
_STEADY = 0.03  # cycles of wander at the highest frequency
_HIGHEST = 0.3
_FINER = 4
_NEAR, _AROUND = 20, 300  # bins: to each side of a line, and of its floor
_GAIN = 5.0, 0.1  # of the sum of logarithms, and a share of it: less is chance
_NEARLY = 0.9  # of the best gain
_FLOOR = np.log(4.0)  # change of the floor: a clock takes half of the noise beside its own line


def sharp_peaks(channels: Floats) -> Peaks:
    """Lines of ``channels`` (channel, sample), where the speed wanders in the clock of a line.

    It is the clock that leaves the least of lines and noise, that of the record among them. In the
    new clock it is tried once more, with narrower filters.
    """
    resolution = resolution_of(channels)
    best = peaks_of(channels, resolution=resolution)
    for widths in _WIDTHS:
        straight = _straighter(channels, best, widths)
        if straight is None:
            break
        channels = straight
        best = replace(peaks_of(straight, resolution=resolution), steady=False)
    return best


def _straighter(channels: Floats, peaks: Peaks, widths: tuple[float, ...]) -> Floats | None:
    """The record in a better clock; None: there is none."""
    spectra = np.fft.rfft(channels - channels.mean(axis=-1, keepdims=True), axis=-1)
    count = channels.shape[-1]
    fine: Floats | None = None
    floor, before = _Floor.of(channels), dict[int, Floats]()
    tried: list[tuple[float, float, float]] = []  # gain, reference, half width

    def turned(reference: float, half_width: float) -> tuple[Floats, int] | None:
        nonlocal fine
        lines = spectra[_clearest(np.abs(spectra), reference * count)]
        cycles, start = _cycles(lines, count, reference, half_width)
        if np.any(np.diff(cycles) <= 0.0):
            return None
        steady = np.linspace(cycles[0], cycles[-1], cycles.size)
        if float(np.std(cycles - steady)) * _HIGHEST / reference < _STEADY:
            return None
        fine = _finer(channels) if fine is None else fine
        return _warped(fine, cycles, start), start

    for reference in _references(peaks):
        for half_width in sorted({max(width * reference, _LEAST / count) for width in widths}):
            if half_width > 0.2 * reference:
                continue
            found = turned(reference, half_width)
            if found is None:
                continue
            straight, start = found
            if start not in before:  # a shorter record has less of both
                before[start] = floor.cost(channels[:, start : count - start])
            gains = before[start] - floor.cost(straight)
            gain, cost = float(np.sum(gains)), float(np.sum(before[start]))
            # what is in the filter turns the clock, and is gone whatever it was
            outside = np.abs(np.linspace(0.0, 0.5, gains.size) - reference) > half_width
            least = max(_GAIN[0], _GAIN[1] * abs(cost))
            if gain > least and float(np.sum(gains[outside])) > _GAIN[0]:
                tried.append((gain, reference, half_width))
    if not tried:
        return None
    most, chosen, _ = max(tried)
    # a wider filter takes sidebands of its line for wander: to all other lines it adds the like
    narrow = min(w for gain, line, w in tried if line == chosen and gain > _NEARLY * most)
    best = turned(chosen, narrow)
    return None if best is None else best[0]


@dataclass(frozen=True)
class _Floor:
    """Level of noise of a record (channel, bin), of Hann's spectrum: logarithm of power."""

    logs: Floats
    samples: int

    @classmethod
    def of(cls, channels: Floats) -> _Floor:
        return cls(floor_of(np.log(np.maximum(_power(channels), 1e-300))), channels.shape[-1])

    def cost(self, channels: Floats) -> Floats:
        """How much a bin has of lines and, against this floor, of noise: logarithms.

        Of each line the power over the least seen, of the floor what changed fourfold or
        more. In the right clock the lines are few, and what a line smeared over the floor is gone
        from it. A wrong clock, which turns with the sidebands of its own reference, makes new ones.
        """
        power = _power(channels)
        bins = np.linspace(0.0, self.logs.shape[-1] - 1.0, power.shape[-1])
        grid = np.arange(self.logs.shape[-1])
        scale = np.log(self.samples / channels.shape[-1])
        floor = np.stack([np.interp(bins, grid, row) for row in self.logs]) - scale
        total = np.sum(power * np.exp(-floor), axis=0) * np.log(2.0)
        over = total / least_seen(total.size, channels=channels.shape[0])
        own = np.mean(floor_of(np.log(np.maximum(power, 1e-300))) - floor, axis=0)
        changed = np.where(np.abs(own) > _FLOOR, own, 0.0)
        return np.asarray(np.log(np.maximum(over, 1.0)) + changed)


def _power(channels: Floats) -> Floats:
    centred = channels - channels.mean(axis=-1, keepdims=True)
    hann = np.hanning(centred.shape[-1])
    return np.asarray(np.abs(fft.rfft(centred * hann, axis=-1)) ** 2)


def _clearest(size: Floats, place: float) -> int:
    """The channel in which a line at ``place`` [bins] is highest over what is around it."""
    middle = round(place)
    line = size[:, max(0, middle - _NEAR) : middle + _NEAR + 1].max(axis=-1)
    around = np.median(size[:, max(0, middle - _AROUND) : middle + _AROUND + 1], axis=-1)
    return int(np.argmax(line / np.maximum(around, 1e-300)))


def _references(peaks: Peaks) -> list[float]:
    """High and clear lines: their phase tells time best."""
    found: list[float] = []
    for place in peaks.place[np.argsort(-(peaks.level + np.log(peaks.place)))]:
        if place < 0.45 and all(abs(place / other - 1.0) > 0.01 for other in found):
            found.append(float(place))
        if len(found) == _REFERENCES:
            break
    return found


def _cycles(
    lines: NDArray[np.complex128], count: int, frequency: float, half_width: float
) -> tuple[Floats, int]:
    """Cycles of the line near ``frequency`` at each sample from ``start`` on, and ``start``.

    From the phase of the band around it (Hann in frequency). The record is taken for periodic, so
    one and a half lengths of the filter are dropped at each end.
    """
    centre, reach = round(frequency * count), max(2, int(half_width * count))
    place = np.arange(-reach, reach + 1)
    inside = (centre + place > 0) & (centre + place < lines.size)
    band = np.zeros(8 * reach, dtype=complex)
    weight = 0.5 + 0.5 * np.cos(np.pi * place / (reach + 1))
    band[place[inside]] = lines[centre + place[inside]] * weight[inside]
    phase = np.unwrap(np.angle(fft.ifft(band))) / (2.0 * np.pi)
    coarse = np.arange(band.size) * (count / band.size)
    curve = interpolate.make_interp_spline(coarse, phase, k=3)
    start = int(1.5 * count / reach)
    grid = np.arange(start, count - start, dtype=float)
    return np.asarray(centre / count * grid + curve(grid), dtype=float), start


def _finer(channels: Floats) -> Floats:
    """The record on a grid four times finer, by zeros behind its DFT."""
    centred = channels - channels.mean(axis=-1, keepdims=True)
    count = _FINER * channels.shape[-1]
    return np.asarray(_FINER * fft.irfft(fft.rfft(centred, axis=-1), n=count, axis=-1))


def _warped(fine: Floats, cycles: Floats, start: int) -> Floats:
    """The record at equal steps of ``cycles``, one mean sample each: cubic through four samples."""
    count = cycles.size
    grid = np.linspace(cycles[0], cycles[-1], count)
    place = (start + np.interp(grid, cycles, np.arange(count))) * _FINER
    low = np.clip(place.astype(int), 1, fine.shape[-1] - 3)
    t = place - low
    return np.asarray(
        fine[:, low - 1] * (-t * (t - 1) * (t - 2) / 6)
        + fine[:, low] * ((t + 1) * (t - 1) * (t - 2) / 2)
        + fine[:, low + 1] * (-(t + 1) * t * (t - 2) / 2)
        + fine[:, low + 2] * ((t + 1) * t * (t - 1) / 6)
    )
