"""Which lines of a channel are looked for, and what is read there with its uncertainty."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base.units import STANDARD_GRAVITY
from thermogear.measured.chain import Chain, Turning, reduced
from thermogear.measured.gearing import Gearing
from thermogear.measured.record import Channel, Record
from thermogear.measured.units import kind_of
from thermogear.signals.lines import LineSpectrum, line_spectrum
from thermogear.signals.spectra import amplitude_spectrum

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class MeasuredLine:
    """One line of one channel. What the record does not allow is nan, never guessed.

    ``kind``: "mesh" (harmonic of the mesh line), "sideband", "second mesh" or "line". ``order``
    of the first shaft, ``position`` [cycles/sample], ``frequency`` [Hz]; ``reading`` peak
    amplitude in the file's unit, ``acceleration`` [m/s^2], ``displacement`` [m];
    ``uncertainty``: relative standard uncertainty u_D (noise, scatter between quarters of the
    record, sensor); ``bin_offset`` [bins]; ``prominence`` over the floor beside.
    """

    channel: str
    kind: str
    name: str
    order: float
    position: float
    frequency: float
    reading: float
    acceleration: float
    displacement: float
    uncertainty: float
    bin_offset: float
    prominence: float
    shaft_speed: float

    @property
    def acceleration_g(self) -> float:
        """The acceleration in standard gravities."""
        return self.acceleration / STANDARD_GRAVITY


@dataclass(frozen=True)
class Wanted:
    """A line to look for, at ``position`` +- ``half_width`` [cycles/sample]."""

    kind: str
    name: str
    _: KW_ONLY
    position: float
    half_width: float


def wanted_lines(
    gearing: Gearing | None, values: Floats, *, harmonics: int, sidebands: int
) -> list[Wanted]:
    """Harmonics of the mesh line with their sidebands and further meshes, below rate/2.56.

    Without a gearing the highest lines of ``values`` (sample,).
    """
    count = values.size
    bins = 3.0 / count
    if gearing is None:
        spectrum = amplitude_spectrum(values - values.mean(), 1.0, "hann")
        tops = np.argsort(-spectrum.amplitudes[3:-3])[: 8 * harmonics] + 3
        found: list[Wanted] = []
        for top in tops:
            place = float(top) / count
            if all(abs(place - other.position) > 2 * bins for other in found):
                found.append(
                    Wanted("line", f"line {len(found) + 1}", position=place, half_width=bins)
                )
        return found[:harmonics]
    mesh = gearing.mesh_frequency
    found = []
    for rank in range(1, harmonics + 1):
        if 2.56 * rank * mesh > 1.0:  # not above rate/2.56
            break
        # speed wander spreads a harmonic in proportion to its rank
        reach = max(bins, 2e-4 * rank * mesh)
        found.append(Wanted("mesh", f"mesh x {rank}", position=rank * mesh, half_width=reach))
        for shaft in gearing.shafts:
            for n in range(1, sidebands + 1):
                for sign in (-1, 1):
                    place = rank * mesh + sign * n * mesh / shaft.teeth
                    label = f"mesh x {rank} {'+' if sign > 0 else '-'} {n} shaft/{shaft.teeth}"
                    found.append(Wanted("sideband", label, position=place, half_width=reach))
    for number, other in enumerate(gearing.meshes, start=2):
        place = other.order * mesh / gearing.shafts[0].teeth
        label = f"mesh {number} (weak)" if other.weak else f"mesh {number}"
        found.append(
            Wanted("second mesh", label, position=place, half_width=max(bins, 2e-4 * place))
        )
    if not found:
        found.append(Wanted("mesh", "mesh x 1", position=mesh, half_width=max(bins, 2e-4 * mesh)))
    return [w for w in found if bins < w.position < 0.5 - bins]


def channel_lines(
    record: Record,
    channel: Channel,
    values: Floats,
    gearing: Gearing | None,
    teeth: int | None,
    chain: Chain,
    wanted: list[Wanted],
    sensor_tolerance: float | None,
    turning: Turning | None,
) -> list[MeasuredLine]:
    """The ``wanted`` lines of one channel, ``values`` (sample,) in the file's unit."""
    rate = record.rate or 1.0
    known = channel.unit is not None and not channel.needs_scale
    factor = channel.si_factor if known else 1.0
    accelerates = known and channel.unit is not None and kind_of(channel.unit) == "acceleration"
    moves = known and channel.unit is not None and kind_of(channel.unit) == "displacement"
    through = reduced(
        values * factor, rate, chain, accelerates and record.rate is not None, turning
    )
    quarters = [
        line_spectrum(part, through.spectrum.rate)
        for part in np.array_split(through.acceleration, 4)
    ]
    found = []
    for want in wanted:
        line, displacement = through.read(want.position * rate, half_width=want.half_width * rate)
        scatter = _scatter(quarters, through.axis, line.frequency, want.half_width * rate)
        parts = [line.amplitude_error / line.amplitude, scatter, sensor_tolerance or 0.0]
        position = line.frequency / rate
        shaft = gearing.mesh_frequency / teeth if gearing and teeth else float("nan")
        speed = 2 * np.pi * rate * shaft if record.rate is not None else float("nan")
        in_hertz = record.rate is not None
        found.append(
            MeasuredLine(
                channel=channel.name,
                kind=want.kind,
                name=want.name,
                order=position / shaft,
                position=position,
                frequency=line.frequency if in_hertz else float("nan"),
                reading=line.amplitude / factor,
                acceleration=line.amplitude if accelerates else float("nan"),
                displacement=line.amplitude
                if moves
                else displacement
                if accelerates and in_hertz
                else float("nan"),
                uncertainty=float(np.sqrt(sum(p**2 for p in parts))),
                bin_offset=line.bin_offset,
                prominence=line.prominence,
                shaft_speed=speed,
            )
        )
    return found


def _scatter(quarters: list[LineSpectrum], axis: float, frequency: float, reach: float) -> float:
    """Relative standard error of the mean amplitude over four quarters of the record."""
    amplitudes = []
    for quarter in quarters:
        width = max(reach / axis, quarter.bin_width)
        low = max(1, int((frequency / axis - width) / quarter.bin_width))
        high = min(quarter.hann.size, int((frequency / axis + width) / quarter.bin_width) + 2)
        if low < high:
            amplitudes.append(float(np.sqrt(np.sum(quarter.hann[low:high] ** 2))))
    mean = float(np.mean(amplitudes)) if amplitudes else 0.0
    if mean <= 0.0 or len(amplitudes) < 2:
        return 0.0
    return float(np.std(amplitudes, ddof=1) / mean / np.sqrt(len(amplitudes)))
