"""The turns of a line whose frequency wanders, over the whole record, and their mean rate."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Complexes, Floats
from thermogear.base.errors import InputError
from thermogear.signals.interval import student
from thermogear.signals.lines import LineSpectrum
from thermogear.signals.spectra import finite_record, positive_rate
from thermogear.signals.strong import hann_at

WIDTHS = (0.006, 0.012, 0.025, 0.05, 0.1)
"""Half widths of the filter over a line, relative to its frequency, the narrowest first."""

_GAIN = 1.1  # a wider filter must bring a tenth more power
_FINER = 32  # samples of the envelope in a kernel
_PASSES = 3
_CUTS = 8
_PIECE = 4  # kernels on one side of a cut
_HALF = 0.5  # of a turn
_NEAR = 8.0  # turns over the record: a sideband nearer than this turns the path that is found
_SAME = 0.5  # turns
_ROUNDS = 40
_FEWER = 5
_ALIKE = 1e-4  # cycles
_EQUAL = 1e-8  # turns
_BLOCK = 65536  # samples, of which all waves are held at once
_HELD = 1 << 18  # samples of kernels that are held at once
_LEAST = 1e-3  # of the largest: lines too near to each other share what they hold


@dataclass(frozen=True, kw_only=True)
class Followed:
    """``cycles`` of a line at each sample, 0 at none; ``frequency``: its turns over the record's
    length, with standard error and ``degrees`` of freedom; ``half_width`` of the filter that caught
    it and ``last`` of the one that followed it; ``whole``: whether the line stayed in the first.
    Units of the rate."""

    cycles: Floats
    frequency: float
    frequency_error: float
    degrees: float
    half_width: float
    last: float
    whole: bool

    @property
    def frequency_half_width(self) -> float:
        """Half width of the frequency's 95 % interval."""
        return student(self.degrees) * self.frequency_error


def band_power(spectrum: LineSpectrum, frequency: float, half_width: float) -> float:
    """Sum of squared amplitudes within ``frequency`` +- ``half_width``, less the noise beside.

    >>> from thermogear.signals.lines import line_spectrum
    >>> x = 2.0 * np.cos(2 * np.pi * 0.1 * np.arange(2000))
    >>> round(band_power(line_spectrum(x, 1.0), 0.1, 0.01), 6)
    4.0
    """
    low, high = _bins(spectrum, frequency, half_width)
    power = float(np.sum(np.abs(spectrum.lines[low:high]) ** 2))
    return max(0.0, power - power_beyond(spectrum, frequency, half_width) * (high - low))


def power_beyond(spectrum: LineSpectrum, frequency: float, half_width: float) -> float:
    """Power of noise in a bin, by the median beyond ``frequency`` +- ``half_width``: up to twice
    that, or 60 bins. The median of noise is ln 2 of its mean.

    >>> level = LineSpectrum(rate=1.0, samples=200, lines=np.full(101, 0.1 + 0j))
    >>> f"{power_beyond(level, 0.2, 0.05):.4f}"
    '0.0144'
    """
    low, high = _bins(spectrum, frequency, half_width)
    more = max(half_width, 60.0 * spectrum.bin_width)
    first, last = _bins(spectrum, frequency, half_width + more)
    beside = np.abs(np.concatenate([spectrum.lines[first:low], spectrum.lines[high:last]])) ** 2
    return float(np.median(beside)) / float(np.log(2.0)) if beside.size else 0.0


def _bins(spectrum: LineSpectrum, frequency: float, half_width: float) -> tuple[int, int]:
    width = spectrum.bin_width
    low = max(1, int(np.floor((frequency - half_width) / width)))
    return low, min(spectrum.lines.size, int(np.ceil((frequency + half_width) / width)) + 1)


def filter_widths(
    spectrum: LineSpectrum,
    frequency: float,
    widths: Sequence[float] = WIDTHS,
    *,
    every: bool = False,
) -> tuple[float, ...]:
    """Half widths to try on a wandering line, the narrowest that may hold it first.

    Twelve bins at least; a wider one than the first brings less than a tenth more power. With
    ``every`` it is all of them, however little the narrowest holds. None where twelve bins are
    more than a fifth of ``frequency``.

    >>> from thermogear.signals.lines import line_spectrum
    >>> x = 2.0 * np.cos(2 * np.pi * 0.1 * np.arange(2000))
    >>> filter_widths(line_spectrum(x, 1.0), 0.1)
    (0.006, 0.01)
    """
    least = 12.0 * spectrum.bin_width
    if least > 0.2 * frequency:
        return ()
    steps = [*dict.fromkeys(max(least, round(w * frequency, 15)) for w in widths)]
    if every:
        return tuple(steps)
    powers = [band_power(spectrum, frequency, one) for one in steps]
    first = next(i for i in range(len(steps)) if max(powers[i:]) <= _GAIN * powers[i])
    return tuple(steps[first:])


def follow_line(
    x: ArrayLike,
    rate: float,
    *,
    frequency: float,
    half_width: float,
    beside: Sequence[float] = (),
    cut: bool = True,
) -> Followed:
    """The phase of the line near ``frequency`` in a filter of +-``half_width``, unwrapped.

    The record, shifted by -``frequency``, is smoothed by a Hann kernel of 2/half_width, which is
    cut at the record's ends, where nothing is dropped; the phase found is taken away and what is
    left is smoothed again, so that neither a ramp nor a cut kernel shifts the phase. Once it is
    caught a filter of half the width follows it (not narrower than the first of WIDTHS). Lines
    ``beside`` that turn with it, sidebands, are taken away by the cycles found, and it is followed
    anew, until the path stays or forty times (sidebands eight turns off over the record and more do
    not turn it again); that filter is at most as wide as the nearest is off, so that its zeros are
    where sidebands are. The mean frequency is (cycles at the last sample - cycles at the
    first)/(time between). Its error is seen where the record is cut inside, by the phase there from
    each side.
    With ``cut`` False this is left out, the error is that of half a turn, and it is followed anew
    five times at most.

    ``x`` [any unit] one channel; ``rate`` and all frequencies in one unit. Range: the
    line outweighs the noise within the filter, and no line of half its height is there; where
    the envelope all but vanishes, ``whole`` is False. Raises InputError for a filter that the
    record is too short for.

    >>> x = np.cos(2 * np.pi * 0.1 * np.arange(2000))
    >>> f"{follow_line(x, 1.0, frequency=0.101, half_width=0.01).frequency:.5f}"
    '0.10000'
    """
    record, per_second = finite_record(x), positive_rate(rate)
    values, count = record, record.size
    if not 0 < half_width <= frequency < 0.5 * per_second:
        raise InputError("half_width", half_width, allowed=f"0..{frequency:g}")
    length = 2.0 * per_second / half_width  # of the kernel, samples
    if count < 2.0 * length:
        least = 4.0 * per_second / count
        raise InputError("half_width", half_width, allowed=f"above {least:.3g} for {count} samples")
    last = min(length * 2.0, max(length, 2.0 / (WIDTHS[0] * frequency) * per_second))
    widest = min((abs(one - frequency) for one in beside), default=np.inf)
    last = min(max(last, 2.0 / widest * per_second), 0.25 * count)
    path, whole = _path(values, frequency / per_second, length, last=last)
    grid = np.arange(float(count))
    cycles = path(grid)
    if beside:
        ratios = [one / frequency for one in beside if 0.0 < one < 0.5 * per_second]
        near = widest / per_second * count < _NEAR
        for _ in range((_ROUNDS if cut else _FEWER) if near else 1):
            before = cycles
            values = record - _turning_with(record, cycles, ratios)
            path, whole = _path(values, frequency / per_second, length, last=last)
            cycles = path(grid)
            if np.max(np.abs(cycles - before)) < _ALIKE:
                break
    edge, degrees = _HALF, 1.0
    if cut:
        edge, degrees = _edge(values, frequency / per_second, length, last)
    edge = edge if whole else max(edge, _HALF)  # a turn may be lost
    return Followed(
        cycles=cycles,
        frequency=float(cycles[-1] - cycles[0]) / (count - 1) * per_second,
        frequency_error=float(np.sqrt(2.0)) * edge / (count - 1) * per_second,
        degrees=degrees,
        half_width=half_width,
        last=half_width * length / last,
        whole=whole,
    )


def _hann_kernel(length: float) -> Floats:
    odd = max(3, int(np.ceil(length)) // 2 * 2 + 1)
    return np.asarray(np.hanning(odd + 2)[1:-1])


def _envelope(
    values: Floats, frequency: float, length: float
) -> tuple[Complexes, NDArray[np.int64], Floats]:
    """The record turned back by ``frequency`` [cycles/sample], behind a filter eight times wider
    than the kernel, which samples of it are kept, and how far from each is the centre of weight of
    its kernel, which the record's ends cut [samples]."""
    count = values.size
    kernel = _hann_kernel(length / 8.0)
    reach = kernel.size // 2
    size = max(64, int(np.ceil(count / length * _FINER)))
    place = np.rint(np.linspace(0, count - 1, min(size, count))).astype(np.int64)
    # at the kept samples alone, in blocks that memory holds
    away = reach - np.arange(kernel.size)
    wave = (kernel * np.exp(2j * np.pi * frequency * away)).view(float).reshape(-1, 2)
    around = np.lib.stride_tricks.sliding_window_view(
        np.pad(values - values.mean(), reach), kernel.size
    )
    pieces = np.array_split(place, place.size * kernel.size // _HELD + 1)
    base = np.concatenate([around[piece] @ wave for piece in pieces]).view(complex)[:, 0]
    base *= np.exp(-2j * np.pi * frequency * place)
    # of the kernel what is inside the record
    sums = np.cumsum(np.insert([kernel, away * kernel], 0, 0.0, axis=1), axis=1)
    last = place + reach + 1
    ends = np.minimum(last, kernel.size), np.maximum(last - count, 0)
    weight, moment = sums[:, ends[0]] - sums[:, ends[1]]
    return base / weight, place, moment / weight


@dataclass(frozen=True)
class _Smoother:
    """A kernel over a record of ``count`` samples, cut at its ends.

    There its centre of weight is inside: what it finds, value and slope, is carried to the place.
    """

    kernel: Floats
    count: int

    @functools.cached_property
    def _moments(self) -> tuple[Floats, Floats, Floats]:
        """Weight, its centre from the place, and its variance [samples], at each place."""
        weight, first, second = (self._sum(np.ones(self.count), power) for power in (0, 1, 2))
        centre = first / weight
        return weight, centre, second / weight - centre**2

    def _sum(self, x: NDArray[Any], power: int) -> NDArray[Any]:
        reach = self.kernel.size // 2
        away = -np.arange(-reach, reach + 1.0)  # a convolution turns the kernel round
        return np.convolve(x, away**power * self.kernel)[reach : reach + x.size]

    def means(self, x: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        """Weighted mean and slope [1/sample] of ``x`` at each place."""
        weight, centre, spread = self._moments
        mean = self._sum(x, 0) / weight
        return mean, (self._sum(x, 1) / weight - centre * mean) / spread

    def phase(self, envelope: Complexes) -> tuple[Floats, Floats]:
        """Unwrapped phase of the mean [rad], and its size."""
        mean, slope = self.means(envelope)
        size = np.abs(mean)
        turning = np.imag(slope * np.conj(mean)) / np.maximum(size, 1e-150) ** 2
        return np.unwrap(np.angle(mean)) - turning * self._moments[1], size

    def values(self, x: Floats) -> Floats:
        """A real curve, smoothed."""
        mean, slope = self.means(x)
        return np.asarray(mean - slope * self._moments[1])


def _smoothed(envelope: Complexes, kernel: Floats, passes: int) -> tuple[Floats, Floats]:
    """Unwrapped phase of the smoothed envelope [rad], and the envelope's size at first."""
    smoother = _Smoother(kernel, envelope.size)
    phase, size = smoother.phase(envelope)
    for _ in range(1, passes):
        phase = phase + smoother.phase(envelope * np.exp(-1j * phase))[0]
    return phase, size


def _path(
    values: Floats, frequency: float, length: float, *, last: float
) -> tuple[Callable[[Floats], Floats], bool]:
    """Cycles of the line at any samples, and whether it stayed within the filter.

    Caught by a kernel of ``length``, then followed by the longer ``last``, which the line no longer
    leaves and which lets less of other lines in. Sidebands that a filter takes unevenly, because
    the line is not in its middle, turn the phase: it is smoothed and followed once more.
    """
    envelope, place, centre = _envelope(values, frequency, length)
    finer = (place.size - 1) / (values.size - 1)
    longer = _hann_kernel(last * finer)
    phase, size = _smoothed(envelope, _hann_kernel(length * finer), 1)
    quiet = _Smoother(longer, place.size)
    for _ in range(2):
        phase = quiet.values(quiet.values(phase))
        phase = phase + _smoothed(envelope * np.exp(-1j * phase), longer, _PASSES)[0]
    phase -= (phase[-1] - phase[0]) / (values.size - 1) * centre  # by their mean turning
    turned = scipy.interpolate.CubicSpline(place, phase / (2.0 * np.pi))
    return lambda at: frequency * at + turned(at), bool(np.min(size) > 0.5 * np.median(size))


def _turning_with(values: Floats, cycles: Floats, ratios: Sequence[float]) -> Floats:
    """Sum of the lines that turn ``ratios`` times as fast as ``cycles``, the line itself left out.

    Together with it by Hann's window: each transform holds its neighbours' as well, by the window's
    at their distance. A line less than half a turn off over the record is taken for the line.
    """
    count, turned = values.size, float(cycles[-1] - cycles[0])
    apart = np.array([0.0, *(round((one - 1.0) * turned, 9) for one in ratios)])
    apart = apart[(apart == 0.0) | (np.abs(apart) > _SAME)]
    window = np.hanning(count)
    window *= 2.0 / np.sum(window)
    sums = np.zeros(apart.size, dtype=complex)
    for part in _blocks(count):
        still = window[part] * values[part] * np.exp(-2j * np.pi * cycles[part])
        waves = _waves(apart, cycles[part] / turned)
        sums += [np.dot(waves[-away], still) for away in apart]
    shared = hann_at(apart[None, :] - apart[:, None], count)
    found = np.linalg.lstsq(shared, sums, rcond=_LEAST)[0]
    total = np.zeros(count)
    for part in _blocks(count):
        waves = _waves(apart, cycles[part] / turned)
        beside = sum(size * waves[away] for away, size in zip(apart[1:], found[1:], strict=True))
        total[part] = np.real(beside * np.exp(2j * np.pi * cycles[part]))
    return total


def _blocks(count: int) -> list[slice]:
    return [slice(first, first + _BLOCK) for first in range(0, count, _BLOCK)]


def _waves(apart: Floats, turned: Floats) -> dict[float, Complexes]:
    """exp(2 pi i away turned) by ``away``, those of ``apart`` and their negatives: one that is the
    sum of two before is the product of theirs."""
    waves: dict[float, Complexes] = {0.0: np.ones(turned.size, dtype=complex)}
    for away in map(float, np.unique(np.abs(apart))):
        if away == 0.0:
            continue
        sums = ((one, two) for one in waves for two in waves if 0.0 < one <= two < away)
        pair = next((pair for pair in sums if abs(sum(pair) - away) < _EQUAL), None)
        waves[away] = (
            waves[pair[0]] * waves[pair[1]] if pair else np.exp(2j * np.pi * away * turned)
        )
    return waves | {-away: np.conj(wave) for away, wave in waves.items()}


def _edge(values: Floats, frequency: float, length: float, last: float) -> tuple[float, float]:
    """Standard error of a path's cycles at an end of the record, without turns, and its degrees.

    At cuts inside, e and f: cycles from one side of the record and from the other, less those of
    both through a filter twice as wide. Of noise and of a speed that walks e and f are independent:
    half of e^2 + f^2 is seen in (e - f)^2/4, and as much in their mean. A speed that bends smoothly
    moves both alike, and shows in the mean alone. The larger counts. A side is a kernel long at
    least; without a cut it is half a turn.
    """
    finer, _ = _path(values, frequency, length, last=0.5 * last)
    found = []
    piece = int(np.ceil(_PIECE * last))
    for number in range(1, _CUTS):
        cut = values.size * number // _CUTS
        if min(cut, values.size - cut) < last:
            continue
        before, after = slice(max(0, cut - piece), cut), slice(cut, cut + piece)
        ended, _ = _path(values[before], frequency, length, last=last)
        begun, _ = _path(values[after], frequency, length, last=last)
        back = float(min(cut, piece)) - 1.0
        ends = np.array([cut - 1.0, cut])
        found.append(np.array([ended(np.array(back)), begun(np.array(0.0))]) - finer(ends))
    if not found:
        return _HALF, 1.0
    errors = np.asarray(found) - np.rint(found)
    apart = 0.25 * float(np.mean((errors[:, 0] - errors[:, 1]) ** 2))
    both = float(np.mean(np.mean(errors, axis=1) ** 2))
    return float(np.sqrt(apart + max(apart, both))), float(len(found))
