"""Single lines of a noisy record: position from an interpolated Hann peak, amplitude, floor.

Interpolated DFT with the three-point estimate of Agrez: closed form, one transform for all lines,
no start value, and exact for one line in a long record. It is wrong where two lines share a main
lobe (four bins of the Hann window) or where the frequency changes during the record. The
errors take the floor beside the line for Gaussian noise.
Checked by ``tests/signals/test_interval.py`` and ``tests/signals/test_amplitude_ways.py``: lines of
known frequency and amplitude, alone and in noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals import windows
from thermogear.signals.spectra import finite_record, positive_rate
from thermogear.signals.windows import Window


@dataclass(frozen=True, kw_only=True)
class Line:
    """One line: ``frequency`` (unit of the rate), peak ``amplitude``.

    ``bin_offset``: distance from the nearest bin's centre, -0.5..0.5. ``floor``: median amplitude
    of the spectrum near the line (same window).

    >>> t = np.arange(1000) / 1000.0
    >>> spectrum = line_spectrum(2.0 * np.cos(2 * np.pi * 50.3 * t), 1000.0)
    >>> line = line_in(spectrum, near=50.0, half_width=5.0)
    >>> f"{line.amplitude:.3f} at {line.frequency:.1f} Hz"
    '2.000 at 50.3 Hz'
    """

    frequency: float
    amplitude: float
    bin_offset: float
    floor: float

    @property
    def prominence(self) -> float:
        """Amplitude over the floor near it."""
        return self.amplitude / self.floor if self.floor > 0 else float("inf")


def hann_offset(around: Floats) -> float:
    """Offset of a line from its highest Hann bin [bins], by the amplitudes ``around`` it.

    ``around``: left neighbour, highest bin, right neighbour, any unit.

    d = 2 (right - left)/(left + 2 peak + right). Exact for one line in a long record: the main
    lobe of the Hann window is sin(pi d)/(pi d (1 - d^2)). Returns 0 where there is no line.
    Source: Agrez 2002, IEEE Trans. Instrum. Meas. 51, 287-292, the three-point estimate.

    >>> hann_offset(np.array([0.5, 1.0, 0.5]))
    0.0
    """
    left, peak, right = (float(a) for a in around)
    total = left + 2.0 * peak + right
    return float(np.clip(2.0 * (right - left) / total, -0.5, 0.5)) if total > 0.0 else 0.0


def floor_around(amplitudes: Floats, index: int, *, lobe: int, reach: int = 60) -> float:
    """Median amplitude of ``reach`` bins on each side, without the main lobe and without bin 0.

    >>> floor_around(np.full(200, 0.2), 100, lobe=4)
    0.2
    """
    low, high = max(1, index - lobe - reach), min(amplitudes.size, index + lobe + reach + 1)
    beside = np.concatenate(
        [amplitudes[low : max(low, index - lobe)], amplitudes[index + lobe + 1 : high]]
    )
    return float(np.median(beside)) if beside.size else 0.0


@dataclass(frozen=True)
class LineSpectrum:
    """The DFT of one mean-free channel, from which every cosine window's bins follow at once.

    A cosine-sum window multiplies in time, so it mixes few neighbours in frequency:
    X_w(k) = [a_0 X(k) + sum_q (-1)^q a_q (X(k - q) + X(k + q))/2]/a_0.
    ``lines``: 2/N times the DFT, 0..N/2.

    >>> spectrum = line_spectrum(np.sin(np.arange(100)), 200.0)
    >>> spectrum.bin_width
    2.0
    """

    rate: float
    samples: int
    lines: NDArray[np.complex128]

    @property
    def bin_width(self) -> float:
        """Distance of two bins, in the unit of the rate."""
        return self.rate / self.samples

    @cached_property
    def hann(self) -> Floats:
        """Peak amplitudes with the Hann window."""
        return np.abs(self.in_hann())

    def in_hann(self) -> NDArray[np.complex128]:
        """Complex peak amplitudes at the bins, with the Hann window."""
        middle, beside = windows.window("hann").coefficients
        # below 0 and above N/2 the DFT of a real record continues as its conjugate
        top = self.lines.size - 1 if self.samples % 2 == 0 else self.lines.size
        below, above = np.conj(self.lines[1:2]), np.conj(self.lines[top - 1 : top])
        padded = np.concatenate([below, self.lines, above])
        pair = padded[:-2] + padded[2:]
        return np.asarray((middle * self.lines - 0.5 * beside * pair) / middle)

    def windowed_at(self, window: str | Window, place: int) -> complex:
        """Complex peak amplitude at the bin ``place``, with a window."""
        coefficients = windows.window(window).coefficients
        count = self.lines.size
        top = count - 1 if self.samples % 2 == 0 else count

        def line(k: int) -> complex:
            if 0 <= k < count:
                return complex(self.lines[k])
            return complex(np.conj(self.lines[-k if k < 0 else top - 1 - (k - count)]))

        total = coefficients[0] * line(place)
        for q, a in enumerate(coefficients[1:], start=1):
            total += (-1.0) ** q * 0.5 * a * (line(place - q) + line(place + q))
        return complex(total / coefficients[0])


def line_spectrum(x: ArrayLike, rate: float) -> LineSpectrum:
    """The spectrum of one channel that ``line_in`` reads lines from; the mean is taken away.

    ``x`` [any unit], ``rate`` [samples per unit of time].

    >>> t = np.arange(1000) / 1000.0
    >>> spectrum = line_spectrum(2.0 * np.cos(2 * np.pi * 50.0 * t), 1000.0)
    >>> f"{abs(spectrum.lines[50]):.3f}"
    '2.000'
    """
    values, per_second = finite_record(x), positive_rate(rate)
    if values.ndim != 1 or values.size < 32:
        raise InputError("record", f"shape {values.shape}", allowed="one channel, >= 32 samples")
    lines = np.fft.rfft(values - values.mean()) * (2.0 / values.size)
    return LineSpectrum(per_second, int(values.size), lines)


def line_in(
    spectrum: LineSpectrum, *, near: float, half_width: float, window: str | Window = "flattop"
) -> Line:
    """The strongest line within ``near`` +- ``half_width``.

    Position by ``hann_offset``; amplitude with ``window`` at the nearest bin, over what that
    window passes at the offset found (``Window.response``; the flat top hardly needs it).
    Raises InputError when the band holds no bin.

    >>> t = np.arange(1000) / 1000.0
    >>> spectrum = line_spectrum(2.0 * np.cos(2 * np.pi * 50.3 * t), 1000.0)
    >>> f"{line_in(spectrum, near=50.0, half_width=5.0).frequency:.1f} Hz"
    '50.3 Hz'
    """
    chosen = windows.window(window)
    width, top = spectrum.bin_width, spectrum.hann.size - 2
    low = max(1, int(np.ceil((near - half_width) / width)))
    high = min(top, int(np.floor((near + half_width) / width)))
    if low > high:
        low = high = int(np.rint(near / width))
    if not 1 <= low <= high <= top:
        raise InputError(
            "near",
            f"{near:g} +- {half_width:g}",
            allowed=f"{width:g}..{top * width:g}",
            why="no bin of the spectrum lies there",
        )
    amplitudes = spectrum.hann
    peak = low + int(np.argmax(amplitudes[low : high + 1]))
    offset = hann_offset(amplitudes[peak - 1 : peak + 2])
    value = spectrum.windowed_at(chosen, peak) / float(chosen.response(offset))
    hann_floor = floor_around(amplitudes, peak, lobe=4)
    # noise of a line grows with the root of the window's noise bandwidth
    floor = hann_floor * float(np.sqrt(chosen.noise_bandwidth / 1.5))
    return Line(
        frequency=(peak + offset) * width,
        amplitude=abs(value),
        bin_offset=float(offset),
        floor=floor,
    )
