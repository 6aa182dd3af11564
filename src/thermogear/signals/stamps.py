"""The pace of time stamps that are rounded, and of stamps that jitter: how well it is known.

A stamp of sample p is a + h p + e_p: e_p is within half of a rounding step r where the clock is
even and its stamps are rounded (or cut) to r. The slopes h that such errors allow are an interval
with ends, and no errors of that kind lead out of it; a standard error would be none here, as
rounding errors repeat. Where no line is that near to all stamps they jitter: then the slope is that
of least squares, and its error is taken from what is left, in blocks of every length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError

_LOOKED_AT = 1 << 14  # stamps whose digits are counted
_MOST_DIGITS = 1e14  # beyond, a float holds no decimal
_SINGLE = 1e30  # a float of 32 bits holds it
_NORMAL = 1.959964
_ROUNDS = 60  # of Newton's method; a few are needed
_BLOCKS = 16  # least number of blocks whose means are compared
_TILT = 1.5  # errors within +-A tilt the line of least squares of N samples by 3 A/N at most
_OUTLIES = 4.5  # standard deviations
_ALIKE = 0.9  # of the steps, from which stamps are even
_RULE = 3  # jumps that rounding can make: that many lost samples would not lie so
_AWAY = 0.25  # of a step
_NO_LOSS = 0.8  # of a step: rounding that no lost sample looks like
_FINE = 0.01  # of a step: rounding or jitter that a single stamp may be read with
_NARROW = 1e-3  # relative width of an interval in which a usual rate is no coincidence

_DECIMAL = (1.0, 1.2, 1.25, 1.5, 1.6, 2.0, 2.4, 2.5, 3.0, 3.2, 4.0, 5.0, 6.0, 6.4, 8.0)
_ANALYSER = (1.024, 1.28, 2.048, 2.56, 5.12)
_AUDIO = (5512.5, 11025.0, 22050.0, 44100.0, 88200.0, 48000.0, 96000.0, 192000.0)
USUAL_RATES: Floats = np.unique(
    [m * 10.0**k for m in (*_DECIMAL, *_ANALYSER) for k in range(2, 7)]
    + [2.0**k for k in range(7, 23)]
    + list(_AUDIO)
)
"""Sampling rates that converters are set to [1/s]: round numbers, powers of 2, analysers', audio's;
about eleven in a factor of e."""


@dataclass(frozen=True, kw_only=True)
class Pace:
    """The line of stamps: one step lasts ``step``, between ``low`` and ``high`` (95 %, or all that
    rounding allows where ``even``); ``begin``: the line at the first sample, from its stamp on;
    ``grain`` the largest rounding step, all in the stamps' unit.

    ``jitter``: rms of what is off the line beyond rounding, ``farthest`` the farthest stamp beyond
    half a rounding step, and ``place`` its number; both in steps.
    """

    step: float
    low: float
    high: float
    grain: float
    begin: float = 0.0
    even: bool = True
    jitter: float = 0.0
    farthest: float = 0.0
    place: int = 0


def grain_of(stamps: Floats) -> Floats:
    """The rounding step of each of the ``stamps`` (sample,), in their unit.

    Stamps are written with a number of decimals or of significant digits: the larger step of the
    two that all stamps together need counts, and never less than what a float can hold.

    >>> [float(f"{g:.3g}") for g in grain_of(np.array([0.0, 0.125, 0.25, 3.375]))]
    [0.001, 0.001, 0.001, 0.001]
    """
    size = np.abs(np.asarray(stamps, dtype=float))
    chosen = size[:: max(1, size.size // _LOOKED_AT)]
    scale = np.floor(np.log10(np.where(chosen > 0.0, chosen, 1.0)))
    decimals = np.full(chosen.size, -1)
    for k in range(18):
        shifted = chosen * 10.0**k
        exact = np.abs(shifted - np.rint(shifted)) <= 4.0 * np.finfo(float).eps * shifted
        decimals[(decimals < 0) & exact & (shifted < _MOST_DIGITS)] = k
    least = 2.0 * np.spacing(size)
    if chosen.max(initial=0.0) < _SINGLE and np.array_equal(chosen.astype(np.float32), chosen):
        least = np.maximum(least, np.spacing(size.astype(np.float32)).astype(float))
    if np.any(decimals < 0):
        return np.asarray(least)
    digits = float(np.max(np.where(chosen > 0.0, decimals + scale + 1.0, 1.0)))
    of_digits = np.floor(np.log10(np.where(size > 0.0, size, 1.0))) + 1.0 - digits
    fixed = 10.0 ** -float(decimals.max())
    return np.asarray(np.maximum(least, np.where(size > 0.0, 10.0**of_digits, 0.0).clip(fixed)))


def pace_of(stamps: Floats, *, grain: Floats, place: Floats | None = None) -> Pace:
    """The pace of ``stamps`` (sample,) that are rounded to ``grain`` (sample,), in one unit.

    ``place``: numbers of the samples, rising, where some between are lost; default 0, 1, 2, ...

    1. All lines that pass within grain/2 of every stamp, by Newton's method from outside: g(h) =
       min(t + r/2 - h p) - max(t - r/2 - h p) is concave and is >= 0 for them alone. Where stamps
       repeat, jitter could go unseen: the interval holds that of 2. without its last part as well.
    2. Where there is none: least squares, 1.96 standard errors with the noise's power by the means
       of blocks of 1, 2, 4, ... samples, the largest; and 1.5 r/N, what rounding that does not
       change from sample to sample can tilt the line by. Of stamps that repeat the first of each
       tick count, which are sure to a step.

    >>> pace = pace_of(np.round(np.arange(4000) / 2048, 4), grain=np.full(4000, 1e-4))
    >>> pace.even, bool(1 / pace.high < 2048 < 1 / pace.low), f"{1 / pace.step:.4f}"
    (True, True, '2048.0000')

    Raises InputError for fewer than three stamps.
    """
    t = np.asarray(stamps, dtype=float)
    if t.size < 3:
        raise InputError("stamps", f"{t.size} of them", allowed=">= 3")
    p = np.arange(t.size, dtype=float) if place is None else np.asarray(place, dtype=float)
    held = grain * (1.0 + 1e-9) + 4.0 * float(np.spacing(np.abs(t).max()))  # ties, and floats
    t = t - t[0]
    step, left = _line(t, p)
    ends = _allowed(left, p, held)
    allowed = None if ends is None else (step + ends[0], step + ends[1])
    largest, begin = float(grain.max()), float(t.mean() - step * (p.mean() - p[0]))
    if allowed is not None and largest <= step:
        low, high = allowed
        return Pace(step=0.5 * (low + high), low=low, high=high, grain=largest, begin=begin)
    ticks = np.flatnonzero(np.diff(t) > 0.0) + 1
    if largest <= step or ticks.size < 3:
        ticks = np.arange(t.size)
    else:
        # the first sample of each tick lies within one step of the tick's begin
        p, grain = p[ticks], np.minimum(grain[ticks], step)
        step, left = _line(t[ticks], p)
    middle = p - p.mean()
    half = _NORMAL * float(np.sqrt(_power(left) / float(np.dot(middle, middle))))
    if allowed is not None:  # jitter could go unseen: both are held
        low, high = min(allowed[0], step - half), max(allowed[1], step + half)
        return Pace(step=0.5 * (low + high), low=low, high=high, grain=largest, begin=begin)
    beyond = np.abs(left - 0.5 * (left.max() + left.min())) - 0.5 * grain
    half += _TILT * float(grain.max()) / float(p[-1] - p[0])
    power = float(np.mean(left**2) - np.mean(grain**2) / 12.0)
    farthest = max(float(beyond.max()), 0.0) / step if step > 0.0 else np.inf
    return Pace(
        step=step,
        low=step - half,
        high=step + half,
        grain=largest,
        begin=begin,
        even=False,
        jitter=min(float(np.sqrt(max(power, 0.0))) / step, farthest) if step > 0.0 else np.inf,
        farthest=farthest,
        place=int(ticks[np.argmax(beyond)]),
    )


def _line(t: Floats, p: Floats) -> tuple[float, Floats]:
    """Slope of least squares, and what is left."""
    middle = p - p.mean()
    step = float(np.dot(middle, t) / np.dot(middle, middle))
    left = t - t.mean() - step * middle
    more = float(np.dot(middle, left) / np.dot(middle, middle))  # what rounding left
    return step + more, left - more * middle


def _allowed(off: Floats, p: Floats, grain: Floats) -> tuple[float, float] | None:
    """Least and greatest slope of lines within half a ``grain`` of all of ``off``; None: no line
    is."""
    below, above = off - 0.5 * grain, off + 0.5 * grain
    far = 2.0 * float(above.max() - below.min()) / float(p[-1] - p[0])
    ends: list[float] = []
    for sign in (-1.0, 1.0):
        slope = sign * far
        for _ in range(_ROUNDS):
            high, low = above - slope * p, below - slope * p
            i, j = int(np.argmin(high)), int(np.argmax(low))
            gap = float(high[i] - low[j])
            if gap >= -1e-15 * float(np.abs(off).max() + grain.max()):
                break
            if sign * (p[i] - p[j]) <= 0.0:
                return None  # at its highest, and below 0
            slope += gap / float(p[i] - p[j])
        ends.append(slope)
    return (ends[0], ends[1]) if ends[0] <= ends[1] else None


def _power(left: Floats) -> float:
    """Power that noise has in a mean: of means of blocks their square times the block's length, the
    largest of all lengths, so that errors that stay for a while count."""
    best, length = 0.0, 1
    while left.size // length >= _BLOCKS or length == 1:
        count = left.size // length
        means = left[: count * length].reshape(count, length).mean(axis=1)
        best = max(best, length * float(np.mean(means**2)))
        length *= 2
    return best


def jumps_of(stamps: Floats, *, grain: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Where stamps (sample,) rounded to ``grain`` (sample,) jump: number of the sample after it,
    and how many steps more than one they jump by (less than 0: they stand), no whole number where
    rounding hides it.

    A jump is a step that differs from the others by more than half of one, beside rounding where
    that shows, and by more than 4.5 of their standard deviations. Three
    jumps and more that rounding alone can make are none.

    >>> t = np.delete(np.arange(100.0), [50, 51])
    >>> [found.tolist() for found in jumps_of(t, grain=np.full(98, 1e-9))]
    [[50], [2.0]]
    """
    t = np.asarray(stamps, dtype=float)
    steps = np.diff(t)
    coarse = float(np.median(grain))
    mean = float(t[-1] - t[0]) / steps.size
    lag = int(min(max(1.0, np.ceil(4.0 * coarse / max(mean, 1e-300))), max(1, t.size // 8)))
    step = float(np.median(t[lag:] - t[:-lag])) / lag
    far = np.abs(steps - step)
    even = np.mean(np.abs(steps - np.median(steps)) <= _FINE * step) >= _ALIKE
    spread, own = 0.0, coarse if coarse > _AWAY * step else 0.0
    if not even and coarse < step:
        spread = 0.5 * float(np.subtract(*np.percentile(steps, (84.1, 15.9))))
    bound = 0.5 * step if even else max(0.5 * step + own, _OUTLIES * spread)
    if coarse < _NO_LOSS * step:  # one rounding step more or less is none
        bound = max(bound, 1.2 * coarse)
    rows = np.flatnonzero(far > bound) + 1
    if rows.size >= _RULE and pace_of(t, grain=grain).even:
        rows = rows[:0]
    others = np.delete(steps, rows - 1)
    step = float(others.mean()) if others.size else step
    ahead = steps[rows - 1] / max(step, 1e-300) - 1.0
    # rounding to more than a quarter of a step hides how many samples were lost
    return rows, ahead if even or coarse <= _AWAY * step else np.floor(ahead) + 0.5


def usual_rate(low: float, *, high: float) -> float | None:
    """The one usual rate between ``low`` and ``high`` [1/s]; None where there is none, there are
    several, or the interval is so wide (0.1 %) that any might lie in it by chance.

    >>> usual_rate(2047.99, high=2048.02), usual_rate(2048.01, high=2048.02)
    (2048.0, None)
    """
    if not 0.0 < high - low <= _NARROW * low:
        inside = USUAL_RATES[low == USUAL_RATES] if high == low else USUAL_RATES[:0]
    else:
        inside = USUAL_RATES[(low <= USUAL_RATES) & (high >= USUAL_RATES)]
    return float(inside[0]) if inside.size == 1 else None
