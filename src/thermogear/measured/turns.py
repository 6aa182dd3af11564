"""The mesh line's mean frequency with its 95 % interval, and the angle where the speed wanders."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.chain import Turning
from thermogear.measured.gearing import Gearing
from thermogear.measured.record import Record
from thermogear.signals.following import WIDTHS, Followed, band_power, best_followed
from thermogear.signals.interval import Reading, read_line, strong_lines
from thermogear.signals.lines import LineSpectrum, line_in, line_spectrum
from thermogear.signals.orders import tacho_angle, tacho_times

Floats = NDArray[np.float64]

_STEADY = 0.02  # cycles of wander at the highest line: 0.8 % of its amplitude
_KEPT = 0.8  # of the power near the mesh line that a steady line must explain
_HELD = 0.7  # of the filter's half width: there its phase has taken the noise away
_EDGE = 0.5  # samples by which a tacho's edge may be placed wrongly


@dataclass(frozen=True, kw_only=True)
class MeshTurns:
    """The mesh line over the stretch: its turns over the time they take.

    ``frequency`` +- ``half_width`` (95 %) [cycles/sample]; ``turning``: the angle to read lines in,
    None where the speed is steady enough; ``said`` how it was found; ``phase_noise`` [rad]: what
    noise brings to that angle, in the mesh line's own phase.
    """

    frequency: float
    half_width: float
    turning: Turning | None = None
    said: str = ""
    phase_noise: float = 0.0
    followed: float = 0.0


def mesh_turns(
    record: Record,
    table: Floats,
    gearing: Gearing,
    *,
    teeth: int | None,
    harmonics: int,
    pulses_per_turn: float | None,
    start: int,
) -> MeshTurns:
    """The mesh line's mean frequency: by the tacho, as a steady line, or followed by its phase.

    ``table`` (channel, sample) from sample ``start`` of ``record`` on. A steady line is taken for
    one where its phase, noise taken away, wanders by less than a fiftieth of a turn at the
    highest of ``harmonics``, and where it explains the power near it.
    """
    per_cycle = int(2 ** np.ceil(np.log2(1.0 / gearing.mesh_frequency)))
    if record.tacho is not None and pulses_per_turn and teeth and record.rate is not None:
        pulses = record.channel(record.tacho).values(start, stop=start + table.shape[-1])
        times = tacho_times(pulses, record.rate)
        angle = teeth * tacho_angle(
            times, pulses_per_turn, np.arange(table.shape[-1]) / record.rate
        )
        inside = np.flatnonzero(np.isfinite(angle))
        turning = Turning(cycles=angle[inside], dropped=int(inside[0]), per_cycle=per_cycle)
        return MeshTurns(
            frequency=turning.mean,
            half_width=turning.mean * 2.0 * _EDGE / inside.size,
            turning=turning,
            said=f"lines are read in angle, by the tacho {record.tacho!r}",
        )
    values, spectrum = clearest(table, gearing.mesh_frequency)
    line = line_in(spectrum, near=gearing.mesh_frequency, half_width=_reach(spectrum, gearing))
    beside = sides_of(gearing, teeth=teeth, rank=1, mesh=line.frequency)
    strong = strong_lines(spectrum)
    reading = read_line(spectrum, line.frequency, beside=beside, strong=strong)
    if _wanders(spectrum, reading, line.frequency, harmonics):
        found = best_followed(values, spectrum, line.frequency)
        if found is not None and np.all(np.diff(found.cycles) > 0.0):
            return _followed(found, values, per_cycle, spectrum)
    best = reading.frequency, reading.frequency_half_width
    for rank in range(2, harmonics + 1):
        if 2.56 * rank * reading.frequency > 1.0:
            break
        other = read_line(
            spectrum,
            rank * reading.frequency,
            beside=sides_of(gearing, teeth=teeth, rank=rank, mesh=reading.frequency),
            strong=strong,
        )
        if other.frequency_half_width / rank < 0.5 * best[1]:  # not the luckier estimate: clearly
            best = other.frequency / rank, other.frequency_half_width / rank
    return MeshTurns(frequency=best[0], half_width=best[1])


def sides_of(gearing: Gearing, *, teeth: int | None, rank: int, mesh: float) -> tuple[float, ...]:
    """Where the shafts' sidebands of a mesh harmonic stand, ``mesh`` in any unit."""
    known = {shaft.teeth for shaft in gearing.shafts} | ({teeth} if teeth else set())
    return tuple(
        mesh * (rank + sign * n / z) for z in sorted(known) for n in (1, 2, 3) for sign in (-1, 1)
    )


def _reach(spectrum: LineSpectrum, gearing: Gearing) -> float:
    return max(3.0 * spectrum.bin_width, 2e-4 * gearing.mesh_frequency)


def clearest(table: Floats, mesh: float) -> tuple[Floats, LineSpectrum]:
    """The channel in which the mesh line is highest over all else, and its spectrum."""
    spectra = [line_spectrum(values, 1.0) for values in table]
    place = int(np.rint(mesh * table.shape[-1]))
    heights = [
        float(np.max(one.hann[max(1, place - 2) : place + 3], initial=0.0))
        / max(float(np.std(values)), 1e-300)
        for one, values in zip(spectra, table, strict=True)
    ]
    best = int(np.argmax(heights))
    return table[best], spectra[best]


def _wanders(spectrum: LineSpectrum, reading: Reading, frequency: float, harmonics: int) -> bool:
    # noise that peaks beside the line changes amplitude and phase alike
    turns = reading.turning > min(1.5 * reading.changing, 0.5)
    if turns and reading.turning * harmonics > 2.0 * np.pi * _STEADY:
        return True
    half_width = max(12.0 * spectrum.bin_width, WIDTHS[0] * frequency)
    if half_width > 0.2 * frequency:
        return False
    power = band_power(spectrum, frequency, half_width)
    return reading.amplitude**2 + reading.beside < _KEPT * power


def _followed(found: Followed, values: Floats, per_cycle: int, spectrum: LineSpectrum) -> MeshTurns:
    turning = Turning(cycles=found.cycles, dropped=0, per_cycle=per_cycle)
    steady = np.linspace(found.cycles[0], found.cycles[-1], found.cycles.size)
    wander = float(np.std(found.cycles - steady))
    straight = line_spectrum(turning.resampled(values, 0), float(per_cycle))
    reading = read_line(straight, 1.0, followed=_HELD * found.last / found.frequency)
    bins = 1.2 * found.last / spectrum.bin_width  # in the filter, its noise bandwidth
    noise = reading.noise / max(reading.amplitude, 1e-300) * float(np.sqrt(0.5 * bins))
    return MeshTurns(
        frequency=found.frequency,
        half_width=found.frequency_half_width,
        turning=turning,
        said=f"the mesh line's phase wanders by {wander:.3g} cycles: lines are read in angle, by "
        "that phase",
        phase_noise=noise,
        followed=_HELD * found.last,
    )
