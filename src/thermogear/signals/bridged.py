"""Samples that others put in place of missing ones: gaps bridged by straight lines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

_FLAT = 1e-3  # of the usual bend: straight
_LEVEL = 0.75  # of a converter's level: how far rounding bends a straight line
_LEAST, _CHANCE = 4, 1e-4  # samples of a bridge, and the chance of one in an undamaged record
_DIGITS = 1e-5  # of the rms: rounding of five digits
_COARSE = 0.1  # of that bend: a level too coarse to tell
_RISE = 20.0  # levels over a bridge
_BESIDE, _MORE = 8, 30.0  # samples on either side, which bend as many times as much


def bridges(x: Floats, free: Mask) -> Mask:
    """Samples ``x`` inside straight lines of four samples or more, where the record bends beside.

    The bend is x_i - (x_(i-1) + x_(i+1))/2. On a line it is a thousandth of its median, or no more
    than a level's rounding, at sample after sample: so often that noise shows it once in ten
    thousand records. At the line's ends and beside, it is thirty times as large: a record that is
    quiet or smooth there bends little on both sides. ``free``: samples that count.

    >>> x = np.sin(2.0 * np.arange(400.0))
    >>> x[100:121] = np.linspace(x[100], x[120], 21)
    >>> inside = np.flatnonzero(bridges(x, x < 9.0))
    >>> int(inside[0]), int(inside[-1]), inside.size
    (101, 119, 19)
    """
    bend = bends(x, free)
    inside = np.zeros(x.size, dtype=bool)
    known = bend[np.isfinite(bend)]
    usual = float(np.median(known)) if known.size else 0.0
    level = smallest_step(x[free])
    if not usual > 0.0 or level > _COARSE * usual:
        return inside
    rounding = _LEVEL * level
    digits = max(rounding, _DIGITS * float(np.std(x[free])))
    chance = max(_FLAT, 2.0 * rounding / usual)
    least = max(_LEAST, int(np.ceil(np.log(_CHANCE / x.size) / np.log(chance))))
    straight = bend <= max(_FLAT * usual, rounding)  # NaN is not
    edges = np.flatnonzero(np.diff(np.concatenate([[0], straight.astype(np.int8), [0]])))
    starts, stops = edges[::2], edges[1::2]
    for start, stop in zip(starts, stops, strict=True):
        line = np.linspace(x[start - 1], x[stop], stop - start + 2)
        rise = abs(float(line[-1] - line[0]))
        off = float(np.max(np.abs(x[start - 1 : stop + 1] - line)))
        before, after = bend[max(0, start - _BESIDE) : start], bend[stop : stop + _BESIDE]
        beside = [part[np.isfinite(part)] for part in (before, after)]
        if stop - start < least or min(part.size for part in beside) < _BESIDE // 2:
            continue
        ends = max(float(beside[0][-1]), float(beside[1][0]))
        bent = min(ends, *(float(np.median(part)) for part in beside))
        straight_on = rise > _RISE * level and off <= max(2.0 * rounding, _FLAT * rise)
        inside[start:stop] = straight_on and bent > _MORE * max(off, digits)
    return inside


def bends(x: Floats, free: Mask) -> Floats:
    """How far each sample is off the line between its neighbours, NaN at the ends and where one
    of the three does not count.

    >>> bends(np.array([0.0, 1.0, 4.0, 9.0]), np.ones(4, dtype=bool)).tolist()
    [nan, 1.0, 1.0, nan]
    """
    known = np.where(free, x, np.nan)
    bend = np.full(x.size, np.nan)
    bend[1:-1] = np.abs(known[1:-1] - 0.5 * (known[:-2] + known[2:]))
    return bend


def smallest_step(kept: Floats) -> float:
    """The smallest step between values that occur, 0 of a single one; of numbers with all their
    digits next to 0.

    >>> smallest_step(np.array([2.0, 0.5, 1.0, 2.0]))
    0.5
    """
    levels = np.unique(kept)
    return float(np.min(np.diff(levels))) if levels.size > 1 else 0.0
