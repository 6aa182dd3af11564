"""The processing chain as one object: the same for a record and for a computed motion."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, nearest
from thermogear.signals.filters import BandPass, taps_for, without_trend
from thermogear.signals.integration import integrate_twice, integrate_twice_trapezoid
from thermogear.signals.lines import Line, LineSpectrum, line_in, line_spectrum
from thermogear.signals.orders import resample_by_angle
from thermogear.signals.windows import Window

METHODS = {
    "frequency": "FIR band pass, then division by omega^2 in the frequency domain",
    "line": "acceleration line over omega^2, no filter",
    "trapezoid": "FIR band pass, then two running trapezoidal sums",
}


@dataclass(frozen=True)
class Chain:
    """Mean and trend off, band pass, double integration, line reading.

    ``band`` [Hz, or cycles/sample at rate 1] and ``taps`` None: chosen from the mesh line, from
    half of it to 0.45 of the rate, with a transition of 0.4 of it. ``low_cut`` None: 0.4 of the
    mesh line. ``window`` reads the amplitude. ``kind`` is what the record is: acceleration,
    velocity is refused, displacement is not integrated.

    >>> Chain(method="trapezoid").method
    'trapezoid'
    """

    method: str = "frequency"
    band: tuple[float, float] | None = None
    _: KW_ONLY
    taps: int | None = None
    low_cut: float | None = None
    window: str = "flattop"

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise InputError("method", repr(self.method), fix=nearest(self.method, METHODS))
        Window(self.window)

    def settled(self, *, rate: float, samples: int, mesh: float) -> Chain:
        """The chain with every number it leaves open chosen for this rate, length and line."""
        if self.method == "line":
            return self
        low, high = 0.5 * mesh, 0.45 * rate
        band = self.band or ((low, high) if low < 0.9 * high else (0.5 * low, 0.49 * rate))
        most = max(3, (samples // 4 - 1) // 2 * 2 + 1)
        taps = self.taps or min(most, taps_for(rate, transition=0.4 * mesh))
        return replace(self, band=band, taps=taps, low_cut=self.low_cut or 0.4 * mesh)

    def filter(self, rate: float) -> BandPass | None:
        """The band pass of a settled chain, None for the line method."""
        if self.method == "line" or self.band is None or self.taps is None:
            return None
        return BandPass(rate, self.band, self.taps)


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

    def resampled(self, values: Floats, offset: int) -> Floats:
        """``values``, whose first is at sample ``offset`` of the record, in equal angles."""
        first = max(self.dropped, offset)
        last = min(self.dropped + self.cycles.size, offset + values.shape[-1])
        angle = self.cycles[first - self.dropped : last - self.dropped]
        return resample_by_angle(
            values[first - offset : last - offset], angle, samples_per_turn=self.per_cycle
        )


@dataclass(frozen=True, kw_only=True)
class Reduced:
    """One channel through the chain: what lines are read from.

    ``displacement_spectrum`` is None where the record is no acceleration or no rate is known.
    ``axis`` is the frequency [Hz or cycles/sample] of one unit of the spectra's own frequency.
    """

    rate: float
    chain: Chain
    spectrum: LineSpectrum
    displacement_spectrum: LineSpectrum | None
    axis: float = 1.0

    def read(self, near: float, *, half_width: float) -> tuple[Line, float]:
        """The line near a frequency in the unfiltered record, and its displacement (nan: none).

        The filter's gain at the line is divided out of the displacement, except in the thesis's
        own way.
        """
        line = line_in(
            self.spectrum,
            near=near / self.axis,
            half_width=half_width / self.axis,
            window=self.chain.window,
        )
        frequency = line.frequency * self.axis
        real = replace(line, frequency=frequency)
        if self.chain.method == "line":
            return real, line.amplitude / (2.0 * np.pi * frequency) ** 2
        if self.displacement_spectrum is None:
            return real, float("nan")
        found = line_in(
            self.displacement_spectrum,
            near=line.frequency,
            half_width=1.5 * self.displacement_spectrum.bin_width,
            window=self.chain.window,
        ).amplitude
        band = self.chain.filter(self.rate)
        gain = float(band.gain(frequency)) if band else 1.0
        if self.chain.method == "trapezoid" or gain < 0.5:
            return real, found
        return real, found / gain


def reduced(
    values: Floats, rate: float, chain: Chain, integrate: bool, turning: Turning | None = None
) -> Reduced:
    """One channel (SI, or the file's unit with ``integrate`` False) through a settled chain.

    With ``turning`` the filtered and the unfiltered record are resampled in angle at the end.
    """
    centred = without_trend(values)
    displacement: Floats | None = None
    offset = 0
    band = chain.filter(rate)
    if integrate and band is not None and chain.low_cut is not None:
        filtered, offset = band.apply(centred), band.delay
        displacement = (
            without_trend(integrate_twice_trapezoid(filtered, rate))
            if chain.method == "trapezoid"
            else integrate_twice(filtered, rate, low_cut=chain.low_cut)
        )
    own, axis = rate, 1.0
    if turning is not None:
        centred = turning.resampled(centred, 0)
        if displacement is not None:
            displacement = turning.resampled(displacement, offset)
        own, axis = float(turning.per_cycle), turning.mean * rate
    return Reduced(
        rate=rate,
        chain=chain,
        spectrum=line_spectrum(centred, own),
        displacement_spectrum=None if displacement is None else line_spectrum(displacement, own),
        axis=axis,
    )
