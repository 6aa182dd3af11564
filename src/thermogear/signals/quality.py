"""Damage in one channel's samples: where it is, told from what undamaged records show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.signals.lines import line_spectrum
from thermogear.signals.strong import Strong, strong_lines

Mask = NDArray[np.bool_]

SENTINELS = (-9999.0, 9999.0, -999.0, 999.0, -99999.0, 99999.0, -999.25, -32768.0, 32767.0)
"""Numbers that loggers write for "no value"."""

_CHANCE = 1e-4  # of a run that long in an undamaged record
_SHORTEST = 8  # samples of a run of one value
_PILE = 8.0  # times as many samples at a limit as at the levels beside
_FAR = 12.0  # robust standard deviations of a spike's second difference


@dataclass(frozen=True, kw_only=True)
class Damage:
    """``kind`` of damage, ``samples`` where it is, the ``value`` there where it is one."""

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
    for one in (_sentinels, _clipped, _held, _spikes):
        for damage in one(values, free):
            found.append(damage)
            free = free & ~damage.samples
    return found


def _sentinels(x: Floats, free: Mask) -> list[Damage]:
    """Numbers of loggers for "no value", where they are far outside all others."""
    known = free & np.isin(x, SENTINELS)
    others = x[free & ~known]
    if not known.any() or others.size < 16:
        return []
    low, high = float(others.min()), float(others.max())
    outside = known & ((x < 2.0 * low - high) | (x > 2.0 * high - low)) & (high > low)
    return [
        Damage(kind="sentinel", samples=outside & (x == value), value=float(value))
        for value in np.unique(x[outside])
    ]


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
    return found


def _held(x: Floats, free: Mask) -> list[Damage]:
    """Runs of one value longer than chance makes them."""
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
    zeros, held = np.zeros(x.size, dtype=bool), np.zeros(x.size, dtype=bool)
    for start, stop in zip(starts[lengths >= least], stops[lengths >= least], strict=True):
        (zeros if x[start] == 0.0 else held)[start:stop] = True
    held[starts[lengths >= least]] = False  # the first of a held run is a true sample
    return [
        Damage(kind=kind, samples=where)
        for kind, where in (("zeros", zeros), ("held", held))
        if where.any()
    ]


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
