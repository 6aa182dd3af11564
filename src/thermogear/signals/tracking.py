"""A line whose frequency runs through the spectrum: its path in time and frequency, its turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals.following import follow_line
from thermogear.signals.lines import line_spectrum
from thermogear.signals.orders import resample_by_angle
from thermogear.signals.spectra import finite_record

HARMONICS = (1.0, 0.5, 1.0 / 3.0)
"""Weights of a line and its harmonics in a path's height."""

_STEP = 0.005  # of the grid in ln(frequency)
_JUMP = 10  # grid steps from frame to frame
_STRAIGHT = 0.02  # what a step costs beside one unit of ln(amplitude/floor)
_HIGHEST = 4.0  # ln(amplitude/floor) that counts at most
_TOP = 0.47  # cycles/sample
_LONGEST = 1 << 21
_WIDE, _NARROW = 0.025, 0.006  # half widths of the filters over a line, relative to it
_AS_SHARP = 0.8


@dataclass(frozen=True, kw_only=True)
class Path:
    """A line's ``frequency`` [cycles/sample] at frames whose middles are ``at`` [samples];
    ``height``: mean ln(amplitude/floor) of the line itself along it."""

    at: Floats
    frequency: Floats
    height: float

    @property
    def span(self) -> float:
        """Highest over lowest frequency, each the mean of a tenth of the frames."""
        ordered = np.sort(self.frequency)
        part = max(1, ordered.size // 10)
        return float(np.mean(ordered[-part:]) / np.mean(ordered[:part]))

    def cycles(self, samples: int) -> Floats:
        """Cycles of the line at each of ``samples``, 0 at the first."""
        knots = self.at / samples
        spline = (
            scipy.interpolate.make_smoothing_spline(knots, np.log(self.frequency))
            if knots.size >= 5
            else scipy.interpolate.make_interp_spline(knots, np.log(self.frequency), k=1)
        )
        grid = np.clip(np.arange(samples) / samples, knots[0], knots[-1])
        local = np.exp(spline(grid))
        return np.asarray(np.concatenate([[0.0], np.cumsum(0.5 * (local[1:] + local[:-1]))]))


@dataclass(frozen=True, kw_only=True)
class Tracked:
    """``cycles`` of a line at each sample, 0 at the first; ``noise``: rms of what is wrong with
    them [cycles]; ``sharp`` and ``blunt``: share of the power that the ``LINES`` strongest lines
    hold in angle and in time; ``span``: highest over lowest frequency."""

    cycles: Floats
    noise: float
    sharp: float
    blunt: float
    span: float


LINES = 30
"""Lines (three bins each) whose share of the power says how sharp a spectrum is."""


def paths(x: ArrayLike, *, most: int = 3) -> list[Path]:
    """The highest paths of a line with harmonics through time and frequency, highest first.

    ``x`` [any unit], one channel or (channel, sample). Frames of about sqrt(20 N) samples, half
    of each in the next. A path maximises the sum over frames of

        sum_h w_h min(ln(amplitude/floor at h f), 4) - 0.02 |step|/0.5 %

    with w = 1, 1/2, 1/3 for h = 1, 2, 3 and at most ten steps of 0.5 % from frame to frame
    (Viterbi). Each path found is masked before the next is looked for. Empty where the record is
    too short.

    >>> turns = 0.02 * np.arange(20_000) + 1e-6 * np.arange(20_000.0) ** 2
    >>> noise = 0.1 * np.random.default_rng(1).standard_normal(turns.size)
    >>> found = paths(np.cos(2 * np.pi * turns) + noise, most=1)[0]
    >>> f"{found.frequency[0]:.3f} to {found.frequency[-1]:.3f}"
    '0.022 to 0.057'
    """
    table = np.atleast_2d(finite_record(x))
    count = table.shape[-1]
    size = 1 << int(np.clip(np.rint(np.log2(np.sqrt(20.0 * count))), 6, 14))
    if count < 8 * size:
        return []
    levels, at = _levels(table, size)
    grid = np.exp(np.arange(np.log(6.0 / size), np.log(_TOP), _STEP))
    parts = [_at(levels, grid * rank * size) for rank in (1, 2, 3)]
    score = sum(
        (weight * part for weight, part in zip(HARMONICS, parts, strict=True)),
        np.zeros((at.size, grid.size)),
    )
    found = []
    for _ in range(most):
        places = _best(score)
        rows = np.arange(at.size)
        height = float(np.mean(parts[0][rows, places]))
        if height <= 0.5:
            break
        found.append(Path(at=at, frequency=grid[places], height=height))
        for row, place in enumerate(places):
            score[row, max(0, place - 8) : place + 9] = -_HIGHEST
    return found


def _levels(table: Floats, size: int) -> tuple[Floats, Floats]:
    """ln(amplitude/floor) of frames (frame, bin), mean over channels, and their middles."""
    window = np.hanning(size + 1)[:-1]
    starts = np.arange(0, table.shape[-1] - size + 1, size // 2)
    total = np.zeros((starts.size, size // 2 + 1))
    for channel in table:
        frames = np.lib.stride_tricks.sliding_window_view(channel, size)[starts]
        frames = frames - frames.mean(axis=-1, keepdims=True)
        logs = np.log(np.abs(np.fft.rfft(frames * window, axis=-1)) + 1e-300)
        # the floor over a band of bins, of all frames near in time
        floor = _floor(logs)
        total += np.clip(logs - floor, 0.0, _HIGHEST)
    return total / table.shape[0], starts + 0.5 * (size - 1)


def _floor(logs: Floats) -> Floats:
    """Running median over bins of each frame, on a grid, straight between."""
    bins = logs.shape[-1]
    width = max(9, min(101, bins // 4))
    starts = np.unique(np.append(np.arange(0, bins - width + 1, width // 3), bins - width))
    medians = np.stack([np.median(logs[:, s : s + width], axis=-1) for s in starts], axis=-1)
    middles = starts + 0.5 * (width - 1)
    grid = np.arange(bins)
    return np.stack([np.interp(grid, middles, row) for row in medians])


def _at(levels: Floats, place: Floats) -> Floats:
    """The higher of the two bins beside each place; 0 outside."""
    low = np.floor(place).astype(int)
    inside = (low >= 1) & (low + 1 < levels.shape[-1])
    low = np.where(inside, low, 1)
    return np.where(inside, np.maximum(levels[:, low], levels[:, low + 1]), 0.0)


def _best(score: Floats) -> NDArray[np.int64]:
    """The path of the highest sum, steps of at most _JUMP places."""
    frames, places = score.shape
    came = np.zeros((frames, places), dtype=np.int8)
    total = score[0].copy()
    steps = np.arange(-_JUMP, _JUMP + 1)
    for row in range(1, frames):
        padded = np.pad(total, _JUMP, constant_values=-np.inf)
        moved = np.lib.stride_tricks.sliding_window_view(padded, 2 * _JUMP + 1)
        moved = moved - _STRAIGHT * np.abs(steps)[None, :]
        best = np.argmax(moved, axis=-1)
        came[row] = steps[best]
        total = score[row] + np.take_along_axis(moved, best[:, None], axis=-1)[:, 0]
    found = np.zeros(frames, dtype=np.int64)
    found[-1] = int(np.argmax(total))
    for row in range(frames - 1, 0, -1):
        found[row - 1] = found[row] + came[row, found[row]]
    return found


def track(x: ArrayLike, *, cycles: ArrayLike) -> Tracked | None:
    """The line that turns about once per cycle of ``cycles``, followed by its phase in angle.

    ``x`` [any unit] one channel, ``cycles`` at each sample, rising: a first guess within a few
    per cent of the line's frequency. The record is resampled at equal steps of the guess, where
    the line wanders little; there its phase is followed (``follow_line``), first in a filter of
    2.5 % on each side, then in one of 0.6 %, which lets no sideband in. None where it cannot
    be followed.

    >>> n = np.arange(4000)
    >>> cycles = 0.02 * n + 3e-7 * n**2
    >>> found = track(np.cos(2 * np.pi * cycles), cycles=0.0205 * n + 3e-7 * n**2)
    >>> bool(abs(found.cycles[-1] - cycles[-1]) < 0.05)
    True
    """
    values, guess = finite_record(x), np.asarray(cycles, dtype=float)
    first = _followed(values, guess, _WIDE)
    if first is None:
        return None
    # sidebands that a wide filter lets in turn the phase to and fro: slowly, then narrowly
    slow = _followed(values, _quiet(first[0]), _NARROW)
    wide = _judged(values, *first)
    if slow is None:
        return wide
    narrow = _judged(values, *slow)
    return narrow if narrow.sharp >= _AS_SHARP * wide.sharp else wide


def _followed(values: Floats, guess: Floats, half_width: float) -> tuple[Floats, float] | None:
    """Cycles at each sample of the line at about one cycle of ``guess``, and the half width of the
    filter that followed it, relative to the line."""
    per_cycle = samples_per_turn(guess)
    straight = resample_by_angle(values, guess, samples_per_turn=per_cycle)
    spectrum = line_spectrum(straight, float(per_cycle))
    near = _line_near_one(spectrum.hann, spectrum.bin_width)
    width = max(half_width * near, 12.0 * spectrum.bin_width)
    if width > 0.2 * near:
        return None
    found = follow_line(straight, float(per_cycle), frequency=near, half_width=width, cut=False)
    if np.any(np.diff(found.cycles) <= 0.0):
        return None
    grid = float(np.ceil(guess[0])) + np.arange(found.cycles.size) / per_cycle
    # beyond the whole cycles at the ends the guess goes on at the rate found there
    refined = np.interp(guess, grid, found.cycles)
    low, high = guess < grid[0], guess > grid[-1]
    refined[low] = found.cycles[0] + (guess[low] - grid[0]) * near
    refined[high] = found.cycles[-1] + (guess[high] - grid[-1]) * near
    return refined - refined[0], found.last / found.frequency


def _quiet(cycles: Floats) -> Floats:
    """The cycles, what is quicker than the narrow filter's kernel taken away."""
    knots = np.arange(0.0, cycles[-1], 0.5 / _NARROW)
    if knots.size < 8:
        return cycles
    samples = np.interp(knots, cycles, np.arange(cycles.size))
    # a smooth rate between the knots: each a mean over the cycles around it
    spline = scipy.interpolate.make_lsq_spline(
        np.arange(cycles.size)[:: max(1, cycles.size // 20_000)],
        cycles[:: max(1, cycles.size // 20_000)],
        np.concatenate([[0.0] * 4, samples[2:-2], [cycles.size - 1.0] * 4]),
        k=3,
    )
    smooth = np.asarray(spline(np.arange(cycles.size)))
    return cycles if np.any(np.diff(smooth) <= 0.0) else smooth


def _judged(values: Floats, cycles: Floats, last: float) -> Tracked:
    per_cycle = samples_per_turn(cycles)
    better = resample_by_angle(values, cycles, samples_per_turn=per_cycle)
    steps = np.diff(cycles)
    return Tracked(
        cycles=cycles,
        noise=_phase_noise(better, per_cycle, last),
        sharp=sharpness(better),
        blunt=sharpness(values),
        span=float(np.percentile(steps, 97.0) / np.percentile(steps, 3.0)),
    )


def _line_near_one(amplitudes: Floats, width: float) -> float:
    """Centre of the power above the floor within 5 % of one cycle, where there is any."""
    low, high = max(1, int(0.95 / width)), min(amplitudes.size, int(1.05 / width) + 2)
    power = amplitudes[low:high] ** 2
    power = np.maximum(power - 4.0 * np.median(power), 0.0)
    total = float(power.sum())
    place = low + np.arange(power.size)
    return float(np.dot(power, place) / total * width) if total > 0.0 else 1.0


def _phase_noise(straight: Floats, per_cycle: int, last: float) -> float:
    """Noise within the filter that followed a line at one cycle, as rms of its phase [cycles]."""
    spectrum = line_spectrum(straight, float(per_cycle))
    power, width = spectrum.hann**2, spectrum.bin_width
    centre = round(1.0 / width)
    near = slice(max(1, int((1.0 - last) / width)), int((1.0 + last) / width) + 2)
    total = float(np.sum(power[near])) / 1.5  # a line's power is 1.5 times in its Hann bins
    reach = max(int(last / width), 20)
    beside = np.concatenate(
        [
            power[max(1, centre - 3 * reach) : max(1, centre - reach)],
            power[centre + reach + 1 : centre + 3 * reach],
        ]
    )
    floor = float(np.median(beside)) / float(np.log(2.0)) / 1.5 if beside.size else 0.0
    noise = 1.2 * last / width * floor  # power of noise within the filter, both sides
    return float(np.sqrt(0.5 * noise / max(total - noise, noise, 1e-300))) / (2.0 * np.pi)


def samples_per_turn(turns: Floats) -> int:
    """Samples per turn, a power of 2, that lose nothing where the shaft is slowest.

    >>> samples_per_turn(np.linspace(0.0, 10.0, 641))
    64
    """
    steps = np.diff(turns)
    slowest = float(np.percentile(steps, 1.0))
    if slowest <= 0.0:
        raise InputError("angle", f"{slowest:.3g} turns/sample", allowed="rising")
    wanted = int(2 ** np.ceil(np.log2(1.0 / slowest)))
    # not more than memory holds: then the finest of it is lost at the slow end
    while wanted > 4 and wanted * float(turns[-1] - turns[0]) > 2 * _LONGEST:
        wanted //= 2
    return wanted


def sharpness(x: ArrayLike) -> float:
    """Share of a record's power in the three bins around each of its 30 strongest lines.

    >>> round(sharpness(np.cos(0.3 * np.arange(4096))), 2)
    1.0
    """
    values = finite_record(x)
    window = np.hanning(values.size + 1)[:-1]
    power = np.abs(np.fft.rfft((values - values.mean()) * window)) ** 2
    total, held = float(power.sum()), 0.0
    for _ in range(LINES):
        top = int(np.argmax(power))
        part = slice(max(0, top - 1), top + 2)
        held += float(power[part].sum())
        power[part] = 0.0
    return held / total if total > 0.0 else 0.0
