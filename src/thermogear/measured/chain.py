"""The processing chain as one object: the same for a record and for a computed motion."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, nearest
from thermogear.signals.filters import BandPass, taps_for, without_trend
from thermogear.signals.integration import trapezoid_factor
from thermogear.signals.lines import Line, LineSpectrum, line_in, line_spectrum
from thermogear.signals.orders import resample_by_angle
from thermogear.signals.windows import Window

METHODS = {
    "frequency": "acceleration line over omega^2",
    "line": "acceleration line over omega^2",
    "trapezoid": "FIR band pass, then two running trapezoidal sums",
}


@dataclass(frozen=True)
class Chain:
    """Line reading and double integration.

    ``band`` [Hz, or cycles/sample at rate 1] and ``taps`` of the "trapezoid" None: chosen from the
    mesh line, from half of it to 0.45 of the rate, with a transition of 0.4 of it. ``window`` of
    the spectrum that lines are looked for in.

    >>> Chain(method="trapezoid").method
    'trapezoid'
    """

    method: str = "frequency"
    band: tuple[float, float] | None = None
    _: KW_ONLY
    taps: int | None = None
    window: str = "flattop"

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise InputError("method", repr(self.method), fix=nearest(self.method, METHODS))
        Window(self.window)

    def settled(self, *, rate: float, samples: int, mesh: float) -> Chain:
        """The chain with every number it leaves open chosen for this rate, length and line."""
        if self.method != "trapezoid":
            return self
        low, high = 0.5 * mesh, 0.45 * rate
        band = self.band or ((low, high) if low < 0.9 * high else (0.5 * low, 0.49 * rate))
        most = max(3, (samples // 4 - 1) // 2 * 2 + 1)
        return replace(
            self, band=band, taps=self.taps or min(most, taps_for(rate, transition=0.4 * mesh))
        )

    def filter(self, rate: float) -> BandPass | None:
        """The band pass of a settled chain, None without one."""
        if self.method != "trapezoid" or self.band is None or self.taps is None:
            return None
        return BandPass(rate, self.band, self.taps)

    def displacement(self, acceleration: float, *, frequency: float, rate: float) -> float:
        """Displacement of an ``acceleration`` line [m/s^2] at ``frequency`` [Hz]: over omega^2.

        By the "trapezoid" it is that times the gain of the filter and what two trapezoidal sums
        leave of a line (:func:`~thermogear.signals.integration.trapezoid_factor`), both exact.

        >>> f"{Chain().displacement(1.0, frequency=100.0, rate=1000.0):.4e}"
        '2.5330e-06'
        """
        size = acceleration / (2.0 * np.pi * frequency) ** 2
        band = self.filter(rate)
        if band is None:
            return size
        lost = float(trapezoid_factor(frequency, rate=rate))
        return size * lost * abs(float(band.gain(frequency)))


@dataclass(frozen=True, kw_only=True)
class Turning:
    """The angle of each sample, by which a record is resampled before lines are read.

    ``cycles`` at the samples from ``dropped`` on; ``per_cycle`` samples per cycle wanted. In the
    resampled record a line stays at its order at any speed; its mean frequency is its order
    times ``mean`` [cycles/sample].
    """

    cycles: Floats
    dropped: int
    per_cycle: int

    @property
    def mean(self) -> float:
        """Mean cycles per sample."""
        return float((self.cycles[-1] - self.cycles[0]) / (self.cycles.size - 1))

    def resampled(self, values: Floats) -> Floats:
        """``values`` of the record in equal angles."""
        inside = values[self.dropped : self.dropped + self.cycles.size]
        return resample_by_angle(inside, self.cycles, samples_per_turn=self.per_cycle)


@dataclass(frozen=True, kw_only=True)
class Reduced:
    """One channel through the chain: what lines are read from. ``axis`` is the frequency [Hz or
    cycles/sample] of one unit of the spectrum's own frequency."""

    spectrum: LineSpectrum
    axis: float = 1.0

    def read(self, near: float, *, half_width: float, window: str) -> Line:
        """The strongest line near a frequency, in the unit of the spectrum."""
        return line_in(
            self.spectrum,
            near=near / self.axis,
            half_width=half_width / self.axis,
            window=window,
        )


def reduced(values: Floats, rate: float, turning: Turning | None = None) -> Reduced:
    """One channel (SI, or the file's unit), mean and straight line off, as a spectrum.

    With ``turning`` the record is resampled in angle before.
    """
    centred = without_trend(values)
    if turning is None:
        return Reduced(spectrum=line_spectrum(centred, rate))
    spectrum = line_spectrum(turning.resampled(centred), float(turning.per_cycle))
    return Reduced(spectrum=spectrum, axis=turning.mean * rate)
