"""Damage in one channel's samples: where it is, told from what undamaged records show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.signals.events import quiet
from thermogear.signals.lines import line_spectrum
from thermogear.signals.strong import Strong, strong_lines

_EVERYWHERE = 0.7  # of the levels between the extremes occur
_MANY = 10.0  # levels in a standard deviation: fine
_FOLDED = 0.53  # 2 zeta(3/2)/pi^2: see coarse
_OWN = 1.0 / 12.0  # of a squared level: the rounding's own noise
_WHOLE = 0.75  # of the samples count


def smallest_step(kept: NDArray[np.float64]) -> float:
    """The smallest step between values that occur, 0 of a single one; of numbers with all their
    digits next to 0.

    >>> smallest_step(np.array([2.0, 0.5, 1.0, 2.0]))
    0.5
    """
    levels = np.unique(kept)
    return float(np.min(np.diff(levels))) if levels.size > 1 else 0.0


def coarse(x: NDArray[np.float64], free: NDArray[np.bool_]) -> float:
    """How far levels may falsify a line, as a share of the strongest line's amplitude.

    Rounding to levels of step q adds sum_m (-1)^m q/(pi m) sin(2 pi m x/q). Of a line of amplitude
    A and noise of rms s, that has lines of 2 q/(pi m) J(2 pi m A/q) exp(-2 (pi m s/q)^2), together
    0.53 q sqrt(q/A) exp(-2 (pi s/q)^2) at most: with noise of a level, none. s^2 is by the median
    of the spectrum's powers, less the rounding's own q^2/12. 0 where a standard deviation holds ten
    levels, of which a line alone is false by 1 %, where most levels between the extremes are
    empty, or no line is clear of noise. ``free``: samples that count.

    >>> x = np.cos(0.37 * np.arange(4000.0))
    >>> round(coarse(np.round(x), x < 9.0), 2), coarse(np.round(x * 400.0), x < 9.0)
    (0.46, 0.0)
    """
    kept = x[free]
    spread = float(np.std(kept))
    if (
        kept.size < _WHOLE * x.size
        or _MANY * smallest_step(kept[:: 1 + kept.size // 4096]) < spread
    ):
        return 0.0
    levels = np.unique(kept)
    step = smallest_step(levels)
    codes = np.ptp(levels) / step + 1.0 if step > 0.0 else np.inf
    if levels.size < _EVERYWHERE * codes:
        return 0.0
    place = np.arange(x.size)
    values = x if free.all() else np.interp(place, place[free], kept)
    spectrum = line_spectrum(values, 1.0)
    lines = strong_lines(spectrum, 1)
    if not lines or not _MANY * step >= spread > 0.0:
        return 0.0
    # a Hann window shows noise of rms s by powers of mean 6 s^2/N, and of 0.69 times that median
    floor = float(np.median(np.abs(spectrum.in_hann()) ** 2)) / (6.0 * float(np.log(2.0)))
    noise = max(0.0, floor * x.size / step**2 - _OWN)
    height = abs(lines[0].amplitude) / step
    return _FOLDED * float(height**-1.5 * np.exp(-2.0 * np.pi**2 * noise))


Mask = NDArray[np.bool_]

SENTINELS = (-9999.0, 9999.0, -999.0, 999.0, -99999.0, 99999.0, -999.25, -32768.0, 32767.0)
"""Numbers that loggers write for "no value"; any number that repeats far outside counts as well."""

_CHANCE = 1e-4  # of a run that long in an undamaged record
_SHORTEST = 8  # samples of a run of one value
_PILE = 8.0  # times as many samples at a limit as at the levels beside
_VISITS = 10  # to a limit
_BANDS, _DOUBLED = 10_000, 8  # of the range; how often they are made twice as wide
_BANDS_HELD = 0.7  # of the widest bands hold samples
_SATURATED, _HIGHER = 30, 10.0  # samples at a limit, and times those of another band
_FAR = 12.0  # robust standard deviations of a spike's second difference
_OUTSIDE = 8.0  # spans of all other samples
_FALSIFIED = 0.01  # of the strongest line: what levels may do untold


@dataclass(frozen=True, kw_only=True)
class Damage:
    """``kind`` of damage, ``samples`` where it is, the ``value`` there where it is one.

    Of coarse levels the value is how far they may falsify a line, as a share of the strongest.
    """

    kind: str
    samples: Mask
    value: float | None = None

    @property
    def count(self) -> int:
        """Samples damaged."""
        return int(np.count_nonzero(self.samples))

    @property
    def first(self) -> int:
        """The first damaged sample."""
        return int(np.argmax(self.samples))

    @property
    def last(self) -> int:
        """The last damaged sample."""
        return int(self.samples.size - 1 - np.argmax(self.samples[::-1]))


def damages(x: ArrayLike) -> list[Damage]:
    """Every damage of one channel: missing, sentinels, zeros, held samples, spikes, clipping,
    stretches without vibration, and coarse levels, of which all samples are.

    ``x`` [any unit], NaN where a value is missing. No sample is in two others of them.

    >>> x = np.sin(np.arange(1000.0)) + 0.01 * np.cos(7.0 * np.arange(1000.0) ** 1.5)
    >>> damages(x)
    []
    >>> x[100:150] = 0.0
    >>> [(one.kind, one.first, one.count) for one in damages(x)]
    [('zeros', 100, 50)]
    """
    values = np.asarray(x, dtype=float)
    free = np.isfinite(values)
    found = [Damage(kind="missing", samples=~free)] if not free.all() else []
    for one in (_sentinels, _clipped, _held, _quiet, _spikes):
        for damage in one(values, free):
            found.append(damage)
            free = free & ~damage.samples
    if np.count_nonzero(free) < 64:
        return found
    share = coarse(values, free)
    if share > _FALSIFIED:
        found.append(Damage(kind="coarse", samples=free, value=share))
    return found


def _sentinels(x: Floats, free: Mask) -> list[Damage]:
    """Numbers far outside all others: known ones, or any that repeats exactly."""
    found = []
    left = free.copy()
    for _ in range(4):
        kept = x[left]
        if kept.size < 16:
            break
        for value in (float(kept.min()), float(kept.max())):
            others = kept[kept != value]
            count = kept.size - others.size
            known = value in SENTINELS
            if others.size < 16 or (count < 3 and not known):
                continue
            low, high = float(others.min()), float(others.max())
            away = max(low - value, value - high)
            if away > (1.0 if known else _OUTSIDE) * (high - low) > 0.0:
                where = left & (x == value)
                found.append(Damage(kind="sentinel", samples=where, value=value))
                left = left & ~where
                break
        else:
            break
    return found


def _quiet(x: Floats, free: Mask) -> list[Damage]:
    """Stretches in which nothing vibrates."""
    still = quiet(x, free) & free
    return [Damage(kind="quiet", samples=still)] if still.any() else []


def _clipped(x: Floats, free: Mask) -> list[Damage]:
    """Samples piled up at a limit: the highest or the lowest value.

    A line alone piles up at its own extremes, three times as high as at the levels beside; a limit
    far higher. Levels are those that occur, so that a coarse converter is no limit.
    """
    kept = x[free]
    if kept.size < 64:
        return []
    found = []
    for limit, order in ((float(kept.max()), -1.0), (float(kept.min()), 1.0)):
        at = free & (x == limit)
        count = int(np.count_nonzero(at))
        if count < 5:
            continue
        near = np.sort(order * kept)[count : count + 64 * max(count, 1)]
        levels, sizes = np.unique(near, return_counts=True)
        beside = float(np.mean(sizes[:5])) if levels.size >= 5 else 0.0
        if levels.size >= 5 and count > _PILE * beside:
            found.append(Damage(kind="clipping", samples=at, value=limit))
    return found or _saturated(x, free)


def _saturated(x: Floats, free: Mask) -> list[Damage]:
    """Samples piled up in a narrow band at an extreme, where noise is added behind the limit.

    In bands of 1e-4 to 1/78 of the range: the one at the extreme holds ten times as many samples
    as any other. Of a sine it holds 2.4 times as many, of a peak as flat as x^4 5.3 times; a
    line in step with the rate has few values, and most bands are empty.
    """
    kept = x[free]
    low, high = float(kept.min()), float(kept.max())
    if not 0.0 < high - low < np.inf:
        return []
    place = ((kept - low) / (high - low) * _BANDS).astype(np.int64)
    fine = np.bincount(np.minimum(place, _BANDS - 1), minlength=_BANDS)
    coarse = np.add.reduceat(fine, np.arange(0, _BANDS, 2 ** (_DOUBLED - 1)))
    if np.mean(coarse > 0) < _BANDS_HELD:
        return []
    found = []
    for order in (-1, 1):
        best = 0.0, 0
        for doubled in range(_DOUBLED):
            width = 2**doubled
            counts = np.add.reduceat(fine[::order], np.arange(0, _BANDS, width))
            if counts[0] >= _SATURATED:
                # the last may be the other limit, and is no whole band
                best = max(best, (counts[0] / max(1, int(counts[1:-2].max())), width))
        if best[0] < _HIGHER:
            continue
        reach = best[1] * (high - low) / _BANDS
        limit = high - reach if order < 0 else low + reach
        at = free & ((x > limit) if order < 0 else (x < limit))
        visits = np.count_nonzero(np.diff(at.astype(np.int8)) == 1)
        if visits >= _VISITS:
            found.append(Damage(kind="clipping", samples=at, value=limit))
    return found


def _held(x: Floats, free: Mask) -> list[Damage]:
    """Runs of one value longer than chance makes them, and values repeated throughout."""
    same = np.zeros(x.size, dtype=bool)
    same[1:] = (x[1:] == x[:-1]) & free[1:] & free[:-1]
    repeated = int(np.count_nonzero(same))
    if not repeated:
        return []
    edges = np.flatnonzero(np.diff(np.concatenate([[0], same.astype(np.int8), [0]])))
    starts, stops = edges[::2] - 1, edges[1::2]  # of each run, its first sample included
    lengths = stops - starts
    typical = lengths[lengths < _SHORTEST]
    chance = max(float(np.sum(typical - 1)) / x.size, 1e-6)
    least = max(_SHORTEST, int(np.ceil(np.log(_CHANCE / x.size) / np.log(min(chance, 0.9)))))
    found: list[Damage] = []
    zeros, held = np.zeros(x.size, dtype=bool), np.zeros(x.size, dtype=bool)
    for start, stop in zip(starts[lengths >= least], stops[lengths >= least], strict=True):
        (zeros if x[start] == 0.0 else held)[start:stop] = True
    held[starts[lengths >= least]] = False  # the first of a held run is a true sample
    short = same & ~zeros & ~held
    # a coarse converter repeats values by chance: neighbours are equal as often as at random
    if np.count_nonzero(short) > 1e-3 * x.size and _not_by_chance(x, free, short):
        held |= short
    return found + [
        Damage(kind=kind, samples=where)
        for kind, where in (("zeros", zeros), ("held", held))
        if where.any()
    ]


def _not_by_chance(x: Floats, free: Mask, short: Mask) -> bool:
    """Whether neighbours are equal 16 times as often as they are one level apart, up or down, of
    many levels."""
    kept = x[free]
    levels = np.unique(kept)
    if levels.size <= 512:
        return False
    step = float(np.min(np.diff(levels)))
    moves = np.abs(np.diff(kept))
    beside = int(np.count_nonzero((moves > 0.0) & (moves < 4.5 * step)))
    return int(np.count_nonzero(short)) > 2.0 * max(beside, 1)  # 16 of 8 levels


def _spikes(x: Floats, free: Mask) -> list[Damage]:
    """Up to three samples far off the line between those around, alone.

    Impacts of teeth ring: many large second differences follow each other, and these stay.
    """
    if np.count_nonzero(free) < 64:
        return []
    filled = np.where(free, x, np.nan)
    bend = np.full(x.size, np.nan)
    bend[1:-1] = filled[1:-1] - 0.5 * (filled[:-2] + filled[2:])
    good = np.isfinite(bend)
    scale = 1.4826 * float(np.median(np.abs(bend[good]))) if good.any() else 0.0
    spread = 1.4826 * float(np.median(np.abs(x[free] - np.median(x[free]))))
    if scale <= 0.0:
        return []
    large = good & (np.abs(bend) > _FAR * scale)
    places = np.flatnonzero(large)
    if places.size == 0:
        return []
    where = np.zeros(x.size, dtype=bool)
    middle = float(np.median(x[free]))
    groups = np.split(places, np.flatnonzero(np.diff(places) > 3) + 1)
    for group in groups:
        low, high = int(group[0]), int(group[-1])
        if high - low > 4:
            continue
        inside = np.arange(low, high + 1)
        top = inside[np.abs(x[inside] - middle) > 6.0 * spread]
        # a spike bends the line at its neighbours half as much: those beyond tell
        around = np.r_[max(0, low - 13) : max(0, low - 1), high + 2 : min(x.size, high + 14)]
        calm = around[good[around]]
        # what rings is no spike: its surroundings bend as well
        rings = calm.size and float(np.max(np.abs(bend[calm]))) > 0.4 * float(
            np.max(np.abs(bend[group]))
        )
        if top.size and not rings:
            where[top] = True
    return [Damage(kind="spikes", samples=where)] if where.any() else []


def filled(
    x: Floats, missing: Mask, limits: Sequence[tuple[Mask, float]] = (), rounds: int = 6
) -> tuple[Floats, float]:
    """The channel with its ``missing`` samples filled by its own strong lines; share explained.

    Straight lines first; then the strong lines of the filled record, found by their Hann peaks,
    are put there, again and again: each round leaves the missing share of the error before.
    Noise is not filled in. The share is that of the mean square of the other samples. ``limits``:
    samples at a limit, among the missing, and the limit: what is filled in lies at it or beyond.

    >>> n = np.arange(2000)
    >>> x, gap = np.cos(2 * np.pi * 0.1 * n), (n > 900) & (n < 950)
    >>> whole, share = filled(np.where(gap, 0.0, x), gap)
    >>> bool(np.abs(whole - x).max() < 1e-3)
    True
    """
    place = np.arange(x.size)
    good = ~missing
    values = x.copy()
    values[missing] = np.interp(place[missing], place[good], x[good])
    if not missing.any() or x.size < 64:
        return values, 1.0
    holes = place[missing]
    middle = float(np.median(x[good]))
    beyond = [(where[missing], limit, np.sign(limit - middle)) for where, limit in limits]
    checked = place[good][:: max(1, int(np.count_nonzero(good)) // 4096)]
    middle = float(np.mean(x[good]))
    explained = 0.0
    for number in range(rounds):
        spectrum = line_spectrum(values, 1.0)
        lines = strong_lines(spectrum)
        if not lines:
            break
        put = middle + _sum(lines, x.size, holes)
        for where, limit, side in beyond:
            put = np.where(where & (side * (put - limit) < 0.0), limit, put)
        values[holes] = put
        if number == rounds - 1:
            left = x[checked] - middle - _sum(lines, x.size, checked)
            whole = float(np.mean((x[checked] - middle) ** 2))
            explained = max(0.0, 1.0 - float(np.mean(left**2)) / whole) if whole > 0.0 else 0.0
    return values, explained


def _sum(lines: Sequence[Strong], samples: int, at: NDArray[np.int64]) -> Floats:
    total = np.zeros(at.size)
    for one in lines:
        total += np.real(one.amplitude * np.exp(2j * np.pi * one.place / samples * at))
    return total
