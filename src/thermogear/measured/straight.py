"""The lines of a record whose speed wanders: told in the clock of one of its own lines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import fft, interpolate

from thermogear.measured.peaks import Peaks, peaks_of

Floats = NDArray[np.float64]

_REFERENCES = 4
_WIDTHS = ((0.004, 0.015), (0.001, 0.004))
"""Half widths of the filter over a reference, of its frequency, in the first and second pass."""
_LEAST = 12.0  # bins of that half width
_STEADY = 0.03  # cycles of wander at the highest frequency
_HIGHEST = 0.3
_FINER = 4
_NEAR, _AROUND = 20, 300  # bins: to each side of a line, and of its floor


def sharp_peaks(channels: Floats) -> Peaks:
    """Lines of ``channels`` (channel, sample), where the speed wanders in the clock of the line
    that makes the spectrum sharpest, the steady clock of the record among them. In the new clock it
    is tried once more, with narrower filters.
    """
    best = peaks_of(channels)
    for widths in _WIDTHS:
        found = _straighter(channels, best, widths)
        if found is None:
            break
        channels, best = found
    return best


def _straighter(
    channels: Floats, peaks: Peaks, widths: tuple[float, ...]
) -> tuple[Floats, Peaks] | None:
    """The record in a better clock and its lines; None: there is none."""
    best, score = None, peaks.sharpness
    spectra = np.fft.rfft(channels - channels.mean(axis=-1, keepdims=True), axis=-1)
    count = channels.shape[-1]
    fine: Floats | None = None
    for reference in _references(peaks):
        lines = spectra[_clearest(np.abs(spectra), reference * count)]
        for width in widths:
            half_width = max(width * reference, _LEAST / count)
            if half_width > 0.2 * reference:
                continue
            cycles, start = _cycles(lines, count, reference, half_width)
            if np.any(np.diff(cycles) <= 0.0):
                continue
            steady = np.linspace(cycles[0], cycles[-1], cycles.size)
            if float(np.std(cycles - steady)) * _HIGHEST / reference < _STEADY:
                return best
            fine = _finer(channels) if fine is None else fine
            turned = _warped(fine, cycles, start)
            found = peaks_of(turned)
            if found.sharpness > score:
                best, score = (turned, found), found.sharpness
    return best


def _clearest(size: Floats, place: float) -> int:
    """The channel in which a line at ``place`` [bins] is highest over what is around it."""
    middle = round(place)
    line = size[:, max(0, middle - _NEAR) : middle + _NEAR + 1].max(axis=-1)
    around = np.median(size[:, max(0, middle - _AROUND) : middle + _AROUND + 1], axis=-1)
    return int(np.argmax(line / np.maximum(around, 1e-300)))


def _references(peaks: Peaks) -> list[float]:
    """High and clear lines: their phase tells time best."""
    found: list[float] = []
    if peaks.size == 0:
        return found
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
