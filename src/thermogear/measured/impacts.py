"""What is no line of a gear, over a shaft's angle: its band, its envelope, rates of bearings.

``diagnose`` and ``measure`` alike take it from here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy import fft

from thermogear.base.arrays import Floats
from thermogear.signals.kurtogram import (
    Band,
    EnvelopeSpectrum,
    envelope_spectrum,
    impulsive_band,
    kurtogram,
    without_lines,
)
from thermogear.signals.tracking import samples_per_turn

HEARD = 0.01
"""Chance of a line of noise up to which it is told (chosen)."""
SLIP = 0.02
"""By how much a bearing's rates may be off those of rolling alone: 1 to 2 % are usual (Randall and
Antoni 2011, Mech. Syst. Signal Process. 25, 485-520)."""
BAND_SAMPLES = 1 << 18
"""Samples that a band is chosen by."""
HIGHEST = 1.0 / 2.56
"""Of the sampling rate: the highest frequency that counts."""
NARROWEST = 16.0
"""Orders of the shaft that a band of the kurtogram is at least wide: an envelope reaches as far as
its band, and rates of bearings up to some 12 (chosen)."""
PARTS = ("outer race", "inner race", "rolling element", "cage")
_FULL_BAND = 0.8  # of half the samples a turn, where no band stands out
_WHOLE = 1.5  # bins about a shaft's order that are its own
_SLOWEST = 20  # bins: below, noise that swells slowly
_SIDEBANDS = 3  # on each side of a line, that are its own


@dataclass(frozen=True, kw_only=True)
class BearingRates:
    """Rates of a rolling bearing's defects in orders of its shaft, without slip: elements over the
    ``outer`` race and the ``inner`` race, twice the spin of an ``element``, ``cage``.

    >>> BearingRates.of("6205", elements=9, ratio=7.938 / 38.5).outer.__round__(3)
    3.572
    """

    name: str
    outer: float
    inner: float
    element: float
    cage: float

    @classmethod
    def of(
        cls, name: str, *, elements: int, ratio: float, contact_angle: float = 0.0
    ) -> BearingRates:
        """Of Z ``elements`` and g = D_w cos a/d_m (``ratio``), a the ``contact_angle`` [rad].

        Z (1 - g)/2, Z (1 + g)/2, cos a (1 - g^2)/g, (1 - g)/2; the outer ring is at rest.
        """
        return cls(
            name=name,
            outer=0.5 * elements * (1.0 - ratio),
            inner=0.5 * elements * (1.0 + ratio),
            element=float(np.cos(contact_angle)) * (1.0 - ratio**2) / ratio,
            cage=0.5 * (1.0 - ratio),
        )

    def order(self, part: str) -> float:
        """The order of a part's defect, of those in ``PARTS``."""
        orders = self.outer, self.inner, self.element, self.cage
        return dict(zip(PARTS, orders, strict=True))[part]


@dataclass(frozen=True, kw_only=True)
class BearingLine:
    """The highest line of a channel's envelope spectrum within 2 % of a bearing's rate.

    ``expected`` and ``order`` count turns of its ``shaft``; ``level``: power over that of noise,
    ``chance`` that noise has one as high in any of the windows that were looked at.
    """

    channel: str
    bearing: str
    shaft: str
    part: str
    expected: float
    order: float
    level: float
    chance: float

    @property
    def words(self) -> str:
        """In words."""
        return (
            f"the envelope has a line of the {self.bearing}'s {self.part} ({self.shaft}): "
            f"{self.order:.3f} a turn, {self.expected:.3f} without slip, {self.level:.0f} times "
            "noise"
        )


@dataclass(frozen=True, kw_only=True)
class Impacts:
    """What is no line of a gear, channel by channel, over a shaft's angle.

    ``bands`` [orders of the shaft] that were demodulated, with their kurtosis; ``chosen``: by the
    kurtogram or given, or all (False); ``spectra`` of the squared envelopes, positions in orders;
    ``lines`` of bearings, the least likely by chance first.
    """

    bands: tuple[Band, ...]
    chosen: tuple[bool, ...]
    spectra: tuple[EnvelopeSpectrum, ...]
    lines: tuple[BearingLine, ...]


def impacts(
    straight: Floats,
    *,
    angle: Floats,
    channels: Sequence[str],
    ratios: Mapping[str, float],
    bearings: Sequence[tuple[str, BearingRates]] = (),
    band: tuple[float, float] | None = None,
) -> Impacts:
    """Kurtogram and squared envelope spectrum of what gears and shafts leave.

    ``straight`` (channel, sample) over whole turns of a shaft, of a record whose samples have the
    ``angle`` [turns]; ``ratios``: turns of each shaft in one of that angle. Orders of these shafts
    and all else that is a line are set to 0. ``bearings``: (shaft, rates); ``band`` [orders] to
    demodulate in place of the kurtogram's.
    Raises InputError for a record that is too short for a band.
    """
    bands, chosen, spectra = [], [], []
    per_turn = samples_per_turn(angle)
    # a band's edges are where the converter's filter ends, not the resampled record
    top = min(0.5, HIGHEST / float(np.percentile(np.diff(angle), 99.0)) / per_turn)
    # a few turns fewer make a length that the transform likes
    turns = int(fft.prev_fast_len(straight.shape[-1] // per_turn, real=True))
    for values in straight[:, : turns * per_turn]:
        random = without_lines(values, spacings=[turns * ratio for ratio in ratios.values()])
        part = random[:BAND_SAMPLES]
        wide = [
            b for b in kurtogram(part)
            if b.high <= top and (b.high - b.low) * per_turn >= NARROWEST
        ]  # fmt: skip
        best = impulsive_band(wide, samples=part.size)
        if band is not None:
            low, high = (edge / per_turn for edge in band)
            best = Band(low=low, high=high, kurtosis=float("nan"))
        used = best or Band(low=0.0, high=_FULL_BAND * top, kurtosis=float("nan"))
        spectrum = envelope_spectrum(random, low=used.low, high=used.high)
        bands.append(
            Band(low=used.low * per_turn, high=used.high * per_turn, kurtosis=used.kurtosis)
        )
        chosen.append(best is not None)
        spectra.append(replace(spectrum, position=spectrum.position * per_turn))
    return Impacts(
        bands=tuple(bands),
        chosen=tuple(chosen),
        spectra=tuple(spectra),
        lines=_bearing_lines(channels, spectra, bearings, ratios),
    )


def _bearing_lines(
    channels: Sequence[str],
    spectra: Sequence[EnvelopeSpectrum],
    bearings: Sequence[tuple[str, BearingRates]],
    ratios: Mapping[str, float],
) -> tuple[BearingLine, ...]:
    """The highest line near every rate, the least likely by chance first.

    A line at an order of a shaft is that shaft's: a knock a turn, noise that swells with it. One
    beside a clearer line, turns of the shaft off an inner race's or turns of the cage off an
    element's, is its sideband, as the load goes round; so is the cage's own beside an element's.
    """
    lines: list[BearingLine] = []
    steps: dict[tuple[str, str], float] = {}
    windows = 0.0
    heard = zip(channels, (_of_no_shaft(spectrum, ratios) for spectrum in spectra), strict=True)
    for (channel, spectrum), (shaft, bearing), part in product(heard, bearings, PARTS):
        rate = bearing.order(part) * ratios[shaft]
        place, level = spectrum.level(low=(1.0 - SLIP) * rate, high=(1.0 + SLIP) * rate)
        steps[bearing.name, part] = {PARTS[1]: 1.0, PARTS[2]: bearing.cage}.get(part, np.inf)
        windows += max(1.0, 2.0 * SLIP * rate / spectrum.position[0])
        lines.append(
            BearingLine(
                channel=channel,
                bearing=bearing.name,
                shaft=shaft,
                part=part,
                expected=bearing.order(part),
                order=place / ratios[shaft],
                level=level,
                chance=float(np.exp(-level)),
            )
        )
    corrected = [replace(line, chance=min(1.0, windows * line.chance)) for line in lines]
    lines_alone = [
        line
        for line in corrected
        if not any(
            _is_sideband(line, other, steps[other.bearing, other.part])
            for other in corrected
            if other.chance <= HEARD and other.channel == line.channel and other.shaft == line.shaft
        )
    ]
    return tuple(sorted(lines_alone, key=lambda line: line.chance))


def _is_sideband(line: BearingLine, other: BearingLine, step: float) -> bool:
    """Whether a line is up to three ``step`` [turns of the shaft] off a clearer one, or the cage's
    where the element of its bearing is heard."""
    if (other.part, line.part, other.bearing) == (*PARTS[2:], line.bearing):
        return True
    distance = abs(line.order - other.order)
    times = round(distance / step)
    near = abs(distance - times * step) <= SLIP * distance if times else False
    return other.level > line.level and times <= _SIDEBANDS and near


def _of_no_shaft(spectrum: EnvelopeSpectrum, ratios: Mapping[str, float]) -> EnvelopeSpectrum:
    """The spectrum without the lines at whole orders of shafts."""
    amplitude = spectrum.amplitude
    for ratio in ratios.values():
        order = np.rint(spectrum.position / ratio)
        near = np.abs(spectrum.position - order * ratio) < _WHOLE * spectrum.position[0]
        amplitude = np.where(near & (order > 0), 0.0, amplitude)
    return replace(spectrum, amplitude=amplitude)


@dataclass(frozen=True, kw_only=True)
class Swelling:
    """The clearest line of an envelope: ``order`` of the first shaft, ``position`` [cycles/sample],
    ``frequency`` [Hz] (None: no rate), the band from ``low`` to ``high`` [cycles/sample], ``level``
    over noise and the ``chance`` that noise has one as high anywhere."""

    channel: str
    order: float
    position: float
    frequency: float | None
    low: float
    high: float
    level: float
    chance: float

    @property
    def words(self) -> str:
        """In words."""
        hertz = "" if self.frequency is None else f", {self.frequency:.5g} Hz"
        return (
            f"the envelope of {self.channel} has a line at {self.order:.3f} of the first shaft"
            f"{hertz}, {self.level:.0f} times noise: impacts, or a load that swings"
        )


def clearest_line(
    found: Impacts, channels: Sequence[str], *, shaft: float, rate: float | None
) -> Swelling | None:
    """The clearest line of all channels, or the lowest of which it is a harmonic; None where noise
    may have one as high by more than 1 %. ``shaft`` [turns/sample], ``rate`` [samples/s]."""
    best: Swelling | None = None
    for channel, band, spectrum in zip(channels, found.bands, found.spectra, strict=True):
        place = spectrum.position[_SLOWEST:]
        level = (spectrum.amplitude[_SLOWEST:] / spectrum.floor[_SLOWEST:]) ** 2
        chance = spectrum.position.size * len(channels) * np.exp(-level)
        clear = np.flatnonzero(chance <= HEARD)
        if not clear.size or (best is not None and level.max() < best.level):
            continue
        # of a train of impacts a harmonic may be clearer than the rate
        highest = place[np.argmax(level)]
        times = np.rint(highest / place[clear])
        whole = np.abs(times * place[clear] - highest) < _WHOLE * spectrum.position[0]
        harmonics = clear[whole & (times == times[whole].max())]
        top = harmonics[np.argmax(level[harmonics])]
        best = Swelling(
            channel=channel,
            order=float(place[top]),
            position=float(place[top]) * shaft,
            frequency=None if rate is None else float(place[top]) * shaft * rate,
            low=band.low * shaft,
            high=band.high * shaft,
            level=float(level[top]),
            chance=float(chance[top]),
        )
    return best
