"""The mesh line's mean frequency with its 95 % interval, and the angle where the speed wanders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.chain import Turning
from thermogear.measured.gearing import Gearing
from thermogear.signals.following import Followed, band_power, best_followed, filter_widths
from thermogear.signals.interval import Reading, Strong, read_line, strong_lines
from thermogear.signals.lines import LineSpectrum, line_in, line_spectrum

Floats = NDArray[np.float64]

_STEADY = 0.02  # cycles of wander at the highest line: 0.8 % of its amplitude
_KEPT = 0.8  # of the power near the mesh line that a steady line must explain
_STILL = 0.1  # of a line, that no steady one explains
_NEIGHBOURS = 5
_HELD = 0.7  # of the filter's half width: there its phase has taken the noise away


@dataclass(frozen=True, kw_only=True)
class MeshTurns:
    """The mesh line over the stretch: its turns over the time they take.

    ``frequency`` +- ``half_width`` (95 %) [cycles/sample]; ``turning``: the angle to read lines in,
    None where the speed is steady enough; ``said`` how it was found; ``phase_noise`` [rad]: what
    noise brings to that angle and what of the turning it misses, in the mesh line's own phase.
    """

    frequency: float
    half_width: float
    turning: Turning | None = None
    said: str = ""
    phase_noise: float = 0.0
    followed: float = 0.0


def mesh_turns(
    table: Floats,
    gearing: Gearing,
    *,
    teeth: int | None,
    harmonics: int,
) -> MeshTurns:
    """The mesh line's mean frequency: as a steady line, or followed by its phase.

    ``table`` (channel, sample). A steady line is taken for
    one where its phase, noise taken away, wanders by less than a fiftieth of a turn at the
    highest of ``harmonics``, and where it explains the power near it.
    """
    per_cycle = int(2 ** np.ceil(np.log2(1.0 / gearing.mesh_frequency)))
    values, spectrum = clearest(table, gearing.mesh_frequency)
    line = line_in(spectrum, near=gearing.mesh_frequency, half_width=_reach(spectrum, gearing))
    beside = sides_of(gearing, teeth=teeth, rank=1, mesh=line.frequency)
    strong = strong_lines(spectrum)
    reading = read_line(spectrum, line.frequency, beside=beside, strong=strong)
    if _wanders(spectrum, reading, beside, strong, harmonics):
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


def _wanders(
    spectrum: LineSpectrum,
    reading: Reading,
    beside: Sequence[float],
    strong: Sequence[Strong],
    harmonics: int,
) -> bool:
    """Whether the phase turns, or most of the power near the line is no steady line's.

    The power is that within the narrowest filter that may hold a wandering line, less that of the
    sidebands at ``beside``, of ``strong`` lines that are steady as well, and four standard
    deviations of the noise there.
    """
    # noise that peaks beside the line changes amplitude and phase alike
    turns = reading.turning > min(1.5 * reading.changing, 0.5)
    if turns and reading.turning * harmonics > 2.0 * np.pi * _STEADY:
        return True
    frequency, width = reading.frequency, spectrum.bin_width
    widths = filter_widths(spectrum, frequency)
    if not widths:
        return False
    near = [one for one in beside if 3.0 * width < abs(one - frequency) < widths[0]]
    power = band_power(spectrum, frequency, widths[0])
    power -= sum(band_power(spectrum, one, 2.0 * width) for one in near)
    others = [
        one.place * width
        for one in strong
        if all(abs(one.place * width - b) > 2.0 * width for b in near)
    ]
    for one in [o for o in others if 3.0 * width < abs(o - frequency) < widths[0]][:_NEIGHBOURS]:
        other = read_line(spectrum, one, strong=strong)
        if max(other.turning, other.changing) < _STILL:
            power -= other.amplitude**2
    scatter = reading.noise**2 * float(np.sqrt(4.0 * widths[0] / width))
    return reading.amplitude**2 + reading.beside < _KEPT * (power - 4.0 * scatter)


def _followed(found: Followed, values: Floats, per_cycle: int, spectrum: LineSpectrum) -> MeshTurns:
    turning = Turning(cycles=found.cycles, dropped=0, per_cycle=per_cycle)
    steady = np.linspace(found.cycles[0], found.cycles[-1], found.cycles.size)
    wander = float(np.std(found.cycles - steady))
    straight = line_spectrum(turning.resampled(values, 0), float(per_cycle))
    reading = read_line(straight, 1.0, followed=_HELD * found.last / found.frequency)
    bins = 1.2 * found.last / spectrum.bin_width  # in the filter, its noise bandwidth
    # what the filter misses is seen beyond it; farther off it is taken to be as much again
    noise = reading.noise / max(reading.amplitude, 1e-300) * float(np.sqrt(0.5 * bins))
    return MeshTurns(
        frequency=found.frequency,
        half_width=found.frequency_half_width,
        turning=turning,
        said=f"the mesh line's phase wanders by {wander:.3g} cycles: lines are read in angle, by "
        "that phase",
        phase_noise=float(np.hypot(noise, reading.turning)),
        followed=_HELD * found.last,
    )
