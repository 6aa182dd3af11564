"""What a converter does to samples: codes that stick, values that wrap around, coarse levels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.signals.bridged import bends, smallest_step
from thermogear.signals.lines import line_spectrum
from thermogear.signals.strong import strong_lines

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Whole = NDArray[np.int64]

_PILE = 8.0  # times as many samples at a code as at each level beside
_BESIDE = 5  # levels on either side
_NEAR = 200  # samples next in value
_BENDS = 0.4  # of what those next in value bend
_CODES = 2  # values that stick: where part of a record is not rounded, all levels seem to
_IN_STEP = 0.2  # of the distances from one to the next that are equal
_WRAPPED, _MOST_WRAPPED = 10, 0.25  # samples, and their largest share
_BINS, _EVERYWHERE = 64, 0.7  # of the range; those that hold samples
_REACH = 8  # samples on either side that a sample is foretold by
_FITTED = 40_000  # samples at most
_ROUNDS = 5
_CLEAR, _CLEAR_ENDS = 9.0, 6.0  # times the usual error of that: the range; where it ends hard
_HARD, _HELD = 0.03, 6  # share of what a bin holds, and samples, in each outermost one: a hard end
_USUAL, _AT_ALL, _AT_MOST = 3.0, 0.05, 0.2  # error of those put back: times the usual; of the range
_USUAL_ENDS, _AT_MOST_ENDS = 3.5, 0.36  # the same where the range ends hard
_DENSE, _NO_DOUBT, _MANY_BACK = 0.25, 8.0, 0.01  # of a bin, times the error, of all: not put back
_PUT = 0.42  # of the range: error of those put back, half of it of those that need not be
_MANY = 10.0  # levels in a standard deviation: fine
_FOLDED = 0.53  # 2 zeta(3/2)/pi^2: see coarse
_STATES, _OCCUR, _REGULAR = 8, 0.8, 0.75  # levels between; that occur; of the empty ones, in runs
_LEAST_GAP, _EMPTY = 2, 32  # levels of a run of empty ones, and such runs; levels in all of them
_OWN = 1.0 / 12.0  # of a squared level: the rounding's own noise
_WHOLE = 0.75  # of the samples count


def stuck(x: Floats, free: Mask) -> list[tuple[Mask, float]]:
    """Samples at one exact value inside the range, eight times as many as at levels beside.

    So are samples set to 0.0 one by one, or a code that sticks. Levels are those that occur, up to
    five on either side. The record bends there at least 0.4 times as much as at samples next in
    value, and less than a fifth of the distances from one to the next are equal: a record that
    rests has samples there one after the other, lines in step with the rate at even distances. Of
    more than two such values none sticks: they are the levels of a record a part of which is not
    rounded. ``free``: samples that count.

    >>> x = np.sin(0.1 * np.arange(4000.0) ** 1.1)
    >>> stuck(x, x < 9.0)
    []
    >>> x[np.arange(3, 60) ** 2] = 0.25
    >>> [(value, int(where.sum())) for where, value in stuck(x, x < 9.0)]
    [(0.25, 57)]
    """
    levels, counts = np.unique(x[free], return_counts=True)
    until = np.concatenate([[0], np.cumsum(counts)])
    places = np.flatnonzero(counts > _PILE)
    places = places[(places > 0) & (places < levels.size - 1)]
    lowest = np.maximum(places - _BESIDE, 0)
    highest = np.minimum(places + _BESIDE, levels.size - 1)
    below = (until[places] - until[lowest]) / (places - lowest)
    above = (until[highest + 1] - until[places + 1]) / (highest - places)
    places = places[counts[places] > _PILE * np.maximum(below, above)]
    if not places.size:
        return []
    bend = bends(x, free)
    found = []
    for place in places:
        at = free & (x == levels[place])
        first = int(np.searchsorted(until, until[place] - _NEAR, side="left"))
        last = int(np.searchsorted(until, until[place + 1] + _NEAR, side="left"))
        low, high = levels[max(0, first)], levels[min(last, levels.size - 1)]
        near = free & ~at & (x >= low) & (x <= high)
        apart = np.bincount(np.diff(np.flatnonzero(at)))
        if np.max(apart) >= _IN_STEP * np.sum(apart):
            continue
        if _median(bend[at]) >= _BENDS * _median(bend[near]) > 0.0:
            found.append((at, float(levels[place])))
    return found if len(found) <= _CODES else []


def _median(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else 0.0


def wrapped(x: Floats, free: Mask) -> list[tuple[Mask, float]]:
    """Samples beyond one end of the range that came back at the other, and what puts them right.

    So does a whole number that overflows: it lacks the range, 2^n levels. A sample is foretold by
    the sums of its neighbours, eight on either side, weighed by least squares. Ten samples or
    more are nearer to that with the range added or taken, up to a quarter of all; the range is nine
    times the usual error. Where a run of them begins or ends, the error is then three times the
    usual at most, or a twentieth of the range, and a fifth of it at the very most. Half of all
    samples are between the range's outer tenths: those of two states are not. Where the outermost
    of 64 bins both hold six samples, and 3 % of what a bin holds, the record ends hard on both
    sides, as what overflows does: a range of six times the usual error then does, and an error of
    3.5 times or 0.36 of the range; where bins there hold a quarter, the range is eight times that
    error and 1 % of the samples are off, they are told with NaN: which came back is unsure. Where
    most have one value they were set to it. A saw tooth is a ramp that wraps around, and is told.
    ``free``: samples that count.

    >>> x = np.cos(0.37 * np.arange(2000.0)) + 0.3 * np.cos(0.1 * np.arange(2000.0))
    >>> wrapped(x, x < 9.0)
    []
    >>> over = (x + 1.2) % 2.4 - 1.2
    >>> whole = over.copy()
    >>> for where, put in wrapped(over, x < 9.0):
    ...     whole[where] += put
    >>> bool(np.abs(whole - x).max() < 0.01), int(np.count_nonzero(whole != over))
    (True, 122)
    """
    kept = x[free]
    low, high = float(np.min(kept)), float(np.max(kept))
    if not 0.0 < high - low < np.inf:
        return []
    place = np.arange(x.size)
    values = x if free.all() else np.interp(place, place[free], kept)
    jumps = np.abs(np.diff(values)) > 0.5 * (high - low)
    number = int(np.count_nonzero(jumps))
    if not _WRAPPED <= number <= 2 * _MOST_WRAPPED * x.size:
        return []
    held = np.histogram(kept, _BINS, (low, high))[0]
    outer = _BINS // 10
    if np.mean(held > 0) < _EVERYWHERE or 2 * np.sum(held[outer:-outer]) < kept.size:
        return []
    span = high - low + smallest_step(kept)
    turns, error = _turns(values, span, jumps)
    off = turns != 0
    count = int(np.count_nonzero(off))
    if count < _WRAPPED or _most_alike(values[off]) > 0.5 * count:
        return []
    ends = float(_BINS * min(held[0], held[-1])) / kept.size
    hard = ends >= max(_HARD, _HELD * _BINS / kept.size)
    if not _put_right(off, error, span, hard):
        usual, wrong = _median(error[~off]), _median(error[off])
        sure = ends >= _DENSE and span >= _NO_DOUBT * usual and wrong < span
        sure = sure and count >= _MANY_BACK * x.size
        return [(off & free, np.nan)] if sure else []
    sides = [(free & (turns == side), side * span) for side in (1, -1)]
    return [(where, put) for where, put in sides if where.any()]


def _put_right(off: Mask, error: Floats, span: float, hard: bool) -> bool:
    """Whether samples put back, ``off``, are then near to what their neighbours foretell."""
    if np.count_nonzero(off) > _MOST_WRAPPED * off.size:
        return False
    edges = np.flatnonzero(np.diff(off))
    usual, right = _median(error[~off]), _median(error[np.concatenate([edges, edges + 1])])
    times, most = (_USUAL_ENDS, _AT_MOST_ENDS) if hard else (_USUAL, _AT_MOST)
    allowed = min(max(times * usual, _AT_ALL * span), most * span)
    clear = span >= (_CLEAR_ENDS if hard else _CLEAR) * usual
    return clear and right <= allowed and _median(error[off]) <= _PUT * span


def _most_alike(values: Floats) -> int:
    """How many of the values are one and the same."""
    return int(np.max(np.unique(values, return_counts=True)[1]))


def _turns(values: Floats, span: float, jumps: Mask) -> tuple[Whole, Floats]:
    """Ranges to add to each sample, and how far each is then off what is foretold.

    From none; and from the jumps of half the range or more, where these alone lead out and back,
    if the samples are less off in the end.
    """
    none = np.zeros(values.size, dtype=np.int64)
    best = _settled(values, span, none)
    led = none.copy()
    led[1:] = -np.cumsum(np.where(jumps, np.sign(np.diff(values)), 0.0)).astype(np.int64)
    led -= int(np.median(led))  # the first sample may be beyond
    if np.max(np.abs(led)) > 1 or np.mean(led != 0) > _MOST_WRAPPED:
        return best
    return min(best, _settled(values, span, led), key=lambda one: float(np.mean(one[1])))


def _settled(values: Floats, span: float, turns: Whole) -> tuple[Whole, Floats]:
    """Ranges to add by what the neighbours foretell, again and again, and what is then left."""
    lower = values < float(np.median(values))
    for _ in range(_ROUNDS):
        whole = values + span * turns
        calm = np.ones(values.size, dtype=bool)
        at = np.flatnonzero(np.abs(np.diff(whole)) > 0.5 * span)
        for away in range(-_REACH, _REACH + 2):
            calm[np.clip(at + away, 0, values.size - 1)] = False
        foretold = _foretold(whole, calm)
        put = np.rint((foretold - values) / span).astype(np.int64)
        put = np.where(lower, np.clip(put, 0, 1), np.clip(put, -1, 0))
        if np.array_equal(put, turns):
            break
        turns = put
    return turns, np.abs(values + span * turns - foretold)


def _foretold(whole: Floats, calm: Mask) -> Floats:
    """Each sample by the sums of its neighbours, weighed by least squares over ``calm`` ones."""
    middle = float(np.mean(whole))
    centred = np.concatenate([np.zeros(_REACH), whole - middle, np.zeros(_REACH)])
    count = whole.size
    sums = np.stack(
        [
            centred[_REACH - k : _REACH - k + count] + centred[_REACH + k : _REACH + k + count]
            for k in range(1, _REACH + 1)
        ]
    )
    rows = np.flatnonzero(calm)
    rows = rows[:: max(1, rows.size // _FITTED)]
    if rows.size < 16 * _REACH:
        rows = np.arange(0, count, 1 + count // _FITTED)
    weights = np.linalg.lstsq(sums[:, rows].T, whole[rows] - middle, rcond=1e-8)[0]
    return np.asarray(middle + weights @ sums)


def missing_codes(x: Floats, free: Mask) -> int:
    """The number of levels in each run of levels that never occur, where a bit is stuck; 0: none.

    With the bit of weight 2^b stuck, runs of 2^b levels that occur and runs of 2^b that do not
    follow each other. Between the 5th and the 95th percentile three of four empty levels are in
    runs of one length, a power of two from 2 on, two of them or more (32 over their length); three
    of four of these begin whole periods of 2^(b+1) apart, and eight of ten other levels occur. Of
    the topmost bit there is one run of 64 levels or more, and of 32 on either side as many occur.
    ``free``: samples that count.

    >>> x = np.round(500.0 * np.sin(np.arange(20_000.0)))
    >>> missing_codes(x, x < 1e9), missing_codes((x.astype(int) | 64).astype(float), x < 1e9)
    (0, 64)
    """
    kept = x[free]
    low, high = map(float, np.quantile(kept, [0.05, 0.95], method="nearest"))
    step = smallest_step(kept)
    if not _STATES * step < high - low < kept.size * step:
        return 0
    codes = np.rint((kept[(kept >= low) & (kept <= high)] - low) / step).astype(np.int64)
    there = np.flatnonzero(np.bincount(codes))
    gaps = np.diff(there) - 1
    length = 1 << int(np.log2(max(1, int(np.max(gaps)))))
    starts = there[:-1][gaps == length]
    if starts.size == 1 and length >= 2 * _EMPTY:  # of the topmost bit there is one run
        beside = np.abs(there - float(starts[0]) - 0.5 * length) <= 0.5 * length + _EMPTY
        return length if np.count_nonzero(beside) >= 2.0 * _OCCUR * _EMPTY else 0
    if length < _LEAST_GAP or starts.size < max(_LEAST_GAP, _EMPTY // length):
        return 0
    places = np.bincount(starts % (2 * length))
    empty = length * starts.size
    occur = there.size / (codes.max() + 1 - empty)
    regular = min(empty / np.sum(gaps), np.max(places) / starts.size)
    return length if regular >= _REGULAR and occur >= _OCCUR else 0


def coarse(x: Floats, free: Mask) -> float:
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
    floor = float(np.median(np.abs(spectrum.windowed("hann")) ** 2)) / (6.0 * float(np.log(2.0)))
    noise = max(0.0, floor * x.size / step**2 - _OWN)
    height = abs(lines[0].amplitude) / step
    return _FOLDED * float(height**-1.5 * np.exp(-2.0 * np.pi**2 * noise))
