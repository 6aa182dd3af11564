"""A shaft's angle from tacho pulses, lost and extra ones repaired, or from its speed over time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals.spectra import finite_record

Ints = NDArray[np.int64]

_BACK = 4  # pulses among which the one before is looked for
_MOST = 12  # whole periods between two pulses
_STEP = 0.03  # standard deviation of the change of ln(period) from pulse to pulse
_LOST, _EXTRA = 2.3, 3.5  # what a lost pulse and an extra one cost: -ln of their shares, 10 and 3 %
_GOES_ON = 1.0  # what it costs at least that a period goes on changing as it did
_JUMP = 60.0  # what any change costs at most: a period that jumps ends the count
_BROKEN = 12.0  # standard deviations of a change that no shaft makes
_STEEP = 2.0  # standard deviations of a change beside a rest: a lost pulse still shows
_AFTER = 40  # pulses beside a rest that are looked at
_FIVE_EDGES = (
    1.4  # grains: half of one times 1 + 1/6 + 2/3 + 2/3 + 1/6, a cubic's weights, rounded up
)
_MOST_KNOTS = 4096
_LEAST = 8


@dataclass(frozen=True, kw_only=True)
class Pulses:
    """Pulses with their numbers: ``times`` [s] of those kept, ``numbers`` from the first on.

    ``lost`` and ``extra``: how many were missing between them and how many were left aside;
    ``aside``: pulses before and after a stretch over which they could not be counted.
    """

    times: Floats
    numbers: Ints
    lost: int
    extra: int
    aside: int


@dataclass(frozen=True, kw_only=True)
class Turns:
    """``turns`` of a shaft at samples ``first`` on; ``noise``: rms of what is wrong with them in a
    few turns [turns]."""

    turns: Floats
    first: int
    noise: float


def numbered(times: ArrayLike, *, grain: float = 0.0) -> Pulses:
    """The pulses that a shaft's turning makes, each with its number.

    ``times`` [s], rising, each known to half of ``grain`` [s]: a sampled square edge lies anywhere
    between two samples. Of all ways to leave pulses aside and to put whole numbers of periods k
    between the others, the likeliest (Viterbi): minus log likelihood

        sum 2.3 (k_i - 1) + 3.5 e_i + min(L(c_i/d_i), 1 + L((c_i - s_i m_i)/d_i)),

    e_i pulses left aside before pulse i, c_i = ln(p_i/p_(i-1)), p_i = (t_i - t_(i-1))/k_i, m_i the
    mean of k_i and k_(i-1), s_i half of c/m and half of s of the pulse before, L(x) = x^2/2 and
    from 2 on 2|x| - 2, and with the grain g, a = 1/k_i and b = 1/k_(i-1)

        d_i^2 = (0.03 m_i)^2 + (g/p_i)^2 (a^2 + (a + b)^2 + b^2)/12,

    which is 0.71 g/p beside 0.03 where no pulse is lost: a lost pulse doubles an interval, an extra
    one splits it, and the speed changes little from pulse to pulse or goes on changing. Then pulses
    that lie off the curve through their neighbours are left aside as well. Up to 11 pulses in a row
    may be lost; where the period jumps all the same, or the shaft may have stood still, the count
    ends, and the longest stretch is taken. Speeds that change by up to a tenth a pulse are counted
    (a twentieth where pulses are lost); at twice as much numbers may be wrong. Below four grains a
    period lost pulses drown in the scatter of the edges: where a twentieth was lost, the turns were
    up to .5 % wrong at 3.6 grains and 2 % at 2.7.

    Raises InputError where fewer than 8 pulses are left.
    Source: Viterbi 1967, IEEE Trans. Inf. Theory 13, 260-269.

    >>> found = numbered([0.0, 0.1, 0.2, 0.25, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9])
    >>> found.numbers, found.lost, found.extra
    (array([0, 1, 2, 3, 5, 6, 7, 8, 9]), 1, 1)
    """
    edges = np.asarray(times, dtype=float)
    if edges.size < _LEAST or np.any(np.diff(edges) <= 0.0):
        got = f"{edges.size} pulse{'' if edges.size == 1 else 's'}"
        raise InputError("tacho", got, allowed=f">= {_LEAST} pulses in rising order")
    finite_record(edges, "tacho")
    places, steps = _likeliest(edges, grain)
    kept = _longest(edges[places], steps, grain)
    places = places[kept]
    numbers = np.concatenate([[0], np.cumsum(steps[kept.start : kept.stop - 1])])
    good = _on_the_curve(edges[places], numbers, grain)
    places, numbers = places[good], numbers[good]
    if places.size < _LEAST:
        raise InputError("tacho", f"{edges.size} pulses", why="they come at no steady distance")
    inside = int(places[-1] - places[0]) + 1
    return Pulses(
        times=edges[places],
        numbers=numbers - numbers[0],
        lost=int(numbers[-1] - numbers[0]) + 1 - places.size,
        extra=inside - places.size,
        aside=edges.size - inside,
    )


def _spread(grain: Floats, *, now: Floats | Ints, before: Floats | Ints) -> Floats:
    """Standard deviation of the change of ln(period) between two intervals of ``now`` and
    ``before`` whole periods, edges known to half of a ``grain`` [periods]."""
    own, last = 1.0 / now, 1.0 / before
    edges = (own**2 + (own + last) ** 2 + last**2) / 12.0
    return np.asarray(np.hypot(_STEP * 0.5 * (now + before), grain * np.sqrt(edges)))


def _likeliest(edges: Floats, grain: float) -> tuple[Ints, Ints]:
    """Places of the pulses counted, and the whole periods between one and the next."""
    gaps = np.diff(edges)
    even = 3.0 * _STEP * np.minimum(gaps[1:], gaps[:-1]) + 1.01 * grain
    if np.all(np.abs(np.diff(gaps)) < even):  # nothing to repair
        return np.arange(edges.size), np.ones(edges.size - 1, dtype=np.int64)
    whole = np.arange(1, _MOST + 1, dtype=float)
    count = edges.size
    back = np.arange(1, _BACK + 1)
    # states of pulse j: which pulse came before it and whole periods since: (back, whole)
    own = _EXTRA * (back[:, None] - 1) + _LOST * (whole[None, :] - 1.0)
    cost = np.full((count, _BACK, _MOST), np.inf)
    origin = np.zeros((count, _BACK, _MOST), dtype=np.int16)
    logs = np.zeros((count, _BACK, _MOST))
    slopes = np.zeros((count, _BACK, _MOST))  # change of ln(period) a period, on the likeliest way
    apart = 0.5 * (whole[:, None] + whole[None, :])
    for j in range(1, count):
        most = min(_BACK, j)
        before = j - back[:most]
        log = np.log((edges[j] - edges[before])[:, None] / whole[None, :])
        logs[j, :most] = log
        change = log[:, :, None, None] - logs[before][:, None]
        goes_on = change - slopes[before][:, None] * apart[:, None, :]
        own_spread = _spread(
            grain / np.exp(log)[:, :, None, None], now=whole[:, None, None], before=whole
        )
        changes = np.minimum(_rare(change / own_spread), _GOES_ON + _rare(goes_on / own_spread))
        total = cost[before][:, None] + np.minimum(changes, _JUMP)
        flat = total.reshape(most, _MOST, -1)
        best = np.argmin(flat, axis=-1)
        slope = 0.5 * (slopes[before][:, None] + change / apart[:, None, :])
        slope = np.take_along_axis(slope.reshape(flat.shape), best[..., None], axis=-1)[..., 0]
        least = np.take_along_axis(flat, best[..., None], axis=-1)[..., 0] + own[:most]
        free = own[:most] + _EXTRA * before[:, None]  # the first pair: all before it are extra
        slopes[j, :most] = np.where(free < least, 0.0, slope)
        cost[j, :most] = np.minimum(free, least)
        origin[j, :most] = np.where(free < least, -1, best)
    left = _EXTRA * np.arange(count - 1, -1, -1.0)
    last = int(np.argmin(cost + left[:, None, None]))
    place, b, k = (int(one) for one in np.unravel_index(last, cost.shape))
    return _traced(origin, place, b, k)


def _traced(origin: NDArray[np.int16], place: int, back: int, periods: int) -> tuple[Ints, Ints]:
    """Places and whole periods of the way that ends at a pulse with a state, from its begin on."""
    places, steps = [place], []
    while True:
        steps.append(periods + 1)
        came = int(origin[place, back, periods])
        place -= back + 1
        places.append(place)
        if came < 0:
            return np.asarray(places[::-1]), np.asarray(steps[::-1])
        back, periods = divmod(came, _MOST)


def _rare(off: Floats) -> Floats:
    """Minus log likelihood of a value so many standard deviations off: normal, beyond two of them
    exponential."""
    size = np.abs(off)
    return np.asarray(np.where(size < 2.0, 0.5 * size**2, 2.0 * size - 2.0))


def _longest(times: Floats, steps: Ints, grain: float) -> slice:
    """The longest stretch of pulses that could be counted.

    It ends where the period jumps and where the shaft may have stood still. Beside a rest the
    period changes so much from pulse to pulse that a lost one does not show: those are left out.
    """
    periods = np.diff(times) / steps
    spread = _spread(grain / periods[1:], now=steps[1:], before=steps[:-1])
    change = np.abs(np.diff(np.log(periods))) / spread
    rest = np.flatnonzero(_rests(times, steps, change))
    broken = np.flatnonzero(change > _BROKEN) + 1
    cuts = np.unique(np.concatenate([[0], broken, rest, rest + 1, [times.size - 1]]))
    longest = int(np.argmax(np.diff(cuts)))
    first, last = int(cuts[longest]), int(cuts[longest + 1])
    steep = np.flatnonzero(change > _STEEP) + 1  # the pulse between both periods
    if first in rest + 1:
        near = steep[(steep > first) & (steep <= first + _AFTER)]
        first = min(int(near[-1]), last) if near.size else first
    if last in rest:
        near = steep[(steep < last) & (steep >= max(first, last - _AFTER))]
        last = max(int(near[0]), first) if near.size else last
    return slice(first, last + 1)


def _rests(times: Floats, steps: Ints, change: Floats) -> NDArray[np.bool_]:
    """Between which pulses and the next the shaft may have stood still.

    Where the speed of one side, its slope by the two intervals there whose ``change`` [standard
    deviations] is no scatter, comes to nothing before the other pulse is reached; and where eight
    pulses or more are missing within six intervals, in three of them or more (8 in a million times
    where a tenth is lost at random): false pulses at rest, which lost ones were put between.
    """
    found = np.zeros(steps.size, dtype=np.bool_)
    gaps = np.diff(times)
    rates, middles = steps / gaps, times[:-1] + 0.5 * gaps
    slopes = np.diff(rates) / np.diff(middles)
    before = rates[1:-1] + slopes[:-1] * (times[3:] - middles[1:-1])
    after = rates[1:-1] + slopes[1:] * (times[:-3] - middles[1:-1])
    found[2:] |= (before <= 0.0) & (change[:-1] > _STEEP)
    found[:-2] |= (after <= 0.0) & (change[1:] > _STEEP)
    views = np.lib.stride_tricks.sliding_window_view(np.pad(steps, 5, constant_values=1), 6)
    crowded = (views.sum(axis=-1) >= 14) & (np.count_nonzero(views > 1, axis=-1) >= 3)
    # an interval is in six windows
    crowded = np.any(np.lib.stride_tricks.sliding_window_view(crowded, 6), axis=-1)
    return np.asarray(found | (crowded & (steps > 1)))


def _on_the_curve(times: Floats, numbers: Ints, grain: float) -> NDArray[np.bool_]:
    """Which pulses lie on the cubic through the two before and the two after them, or on that
    through four on one side: where a run-up begins, the speed has a corner."""
    kept = np.arange(times.size)
    edges = _FIVE_EDGES * grain / float(np.median(np.diff(times) / np.diff(numbers)))
    while kept.size > _LEAST:
        t, n = times[kept], numbers[kept].astype(float)
        off = _off_the_curve(t, n, (-2, -1, 1, 2))
        for side in ((-4, -3, -2, -1), (1, 2, 3, 4)):
            off = np.fmin(off, _off_the_curve(t, n, side))
        off = off[2:-2]
        around = scipy.ndimage.median_filter(off, size=17, mode="nearest")
        limit = np.maximum(max(0.01, edges), 8.0 * np.maximum(around, float(np.median(off))))
        # an outlier pulls its neighbours' curves by up to two thirds of what it is off itself
        highest = off >= np.max([np.pad(off, 2)[s : s + off.size] for s in (0, 1, 3, 4)], axis=0)
        bad = np.flatnonzero((off > limit) & highest)
        if bad.size == 0:
            break
        kept = np.delete(kept, bad + 2)
    found = np.zeros(times.size, dtype=np.bool_)
    found[kept] = True
    return found


def _off_the_curve(t: Floats, n: Floats, places: tuple[int, ...]) -> Floats:
    """How far each pulse is off the polynomial through those at ``places`` beside it; NaN where
    there are none."""
    off = np.full(t.size, np.nan)
    inside = slice(max(0, -places[0]), t.size - max(0, places[-1]))
    at = np.arange(t.size)[inside]
    expected = np.zeros(at.size)
    for one in places:
        others = [t[at + other] for other in places if other != one]
        expected += n[at + one] * np.prod(
            [(t[at] - other) / (t[at + one] - other) for other in others], axis=0
        )
    off[inside] = np.abs(n[inside] - expected)
    return off


def pulse_turns(
    pulses: Pulses, pulses_per_turn: float, *, rate: float, samples: int, start: float = 0.0
) -> Turns:
    """Turns of the shaft at samples of a record, 0 at the first pulse, from counted ``pulses``.

    ``rate`` [samples/s] and ``samples`` of the record, whose first is at ``start`` [s] of the
    pulses' time. A smoothing spline through (time, number/pulses per turn), its smoothness by
    generalised cross-validation: what the edges' places scatter is taken away. Marks that are not
    evenly spaced on the shaft, the same every turn, are moved to where they are. Samples before
    the first and after the last pulse are left out: no angle is extrapolated.

    >>> found = pulse_turns(numbered(np.arange(20) * 0.1), 2.0, rate=100.0, samples=150)
    >>> found.first, found.turns[[0, 20, 100]].round(3)
    (0, array([0., 1., 5.]))
    """
    times, numbers = pulses.times, pulses.numbers.astype(float)
    number_of, left = _smooth(times, numbers)
    marks = round(pulses_per_turn)
    if 1 < marks == pulses_per_turn and times.size >= 8 * marks:
        mark = pulses.numbers % marks
        count = np.maximum(np.bincount(mark, minlength=marks), 1)
        places = np.bincount(mark, weights=left, minlength=marks) / count
        places -= places.mean()
        if np.var(left - places[mark]) < 0.5 * np.var(left):
            numbers = numbers - places[mark]
            number_of, left = _smooth(times, numbers)
    at = start + np.arange(samples) / rate
    inside = np.flatnonzero((at >= times[0]) & (at <= times[-1]))
    if inside.size < 2:
        raise InputError("tacho", "its pulses", why="none lie within the record's time")
    grid = at[inside]
    return Turns(
        turns=np.asarray(number_of(grid) / pulses_per_turn),
        first=int(inside[0]),
        noise=_curve_noise(times, numbers, left) / pulses_per_turn,
    )


def _curve_noise(times: Floats, numbers: Floats, left: Floats) -> float:
    """Rms error of the smoothed curve [pulses]: half what curves by every second pulse differ.

    Each of both has twice the variance of the whole, and their errors are independent. Of fewer
    than 32 pulses that of a cubic through three, the scatter over root 3.
    """
    if times.size < 32:
        return float(np.std(left)) / float(np.sqrt(3.0))
    one, two = (_smooth(times[k::2], numbers[k::2])[0] for k in (0, 1))
    at = np.linspace(times[1], times[-2], 4 * times.size)
    return 0.5 * float(np.sqrt(np.mean((one(at) - two(at)) ** 2)))


def _smooth(times: Floats, numbers: Floats) -> tuple[Callable[[Floats], Floats], Floats]:
    """A smoothing spline of number over time, and what each pulse is off it [pulses].

    More than 4096 pulses are averaged in groups first.
    """
    group = -(-times.size // _MOST_KNOTS)
    x, y = times, numbers
    if group > 1:
        cuts = np.arange(0, times.size - group + 1, group)
        x = np.add.reduceat(times, cuts)[:-1] / group
        y = np.add.reduceat(numbers, cuts)[:-1] / group
        x = np.concatenate([times[:1], x[1:], times[-1:]])
        y = np.concatenate([numbers[:1], y[1:], numbers[-1:]])
    # about a straight line, in units of the mean step: the solver likes numbers near 1
    step = (x[-1] - x[0]) / (x.size - 1)
    slope = (y[-1] - y[0]) / (x[-1] - x[0])
    rest = y - y[0] - slope * (x - x[0])
    try:
        spline = scipy.interpolate.make_smoothing_spline((x - x[0]) / step, rest)
    except (ValueError, np.linalg.LinAlgError):  # exactly straight
        spline = scipy.interpolate.make_interp_spline((x - x[0]) / step, rest, k=3)

    def number_of(at: Floats) -> Floats:
        return np.asarray(y[0] + slope * (at - x[0]) + spline((at - x[0]) / step))

    return number_of, numbers - number_of(times)


def speed_turns(
    speed: ArrayLike, *, rate: float, samples: int, sample_rate: float, start: float = 0.0
) -> Turns:
    """Turns of the shaft at samples of a record, 0 at the first, from its ``speed`` [turns/s].

    ``rate`` [1/s] of the speed's samples, ``sample_rate`` [1/s] and ``samples`` of the record,
    whose first is at ``start`` [s] of the speed's time. Noise is taken away by a Hann kernel of a
    hundredth of the record, cut at its ends; then the speed is summed by trapezoids.
    Raises InputError where the shaft is still or turns back.

    >>> found = speed_turns(np.full(100, 20.0), rate=100.0, samples=1000, sample_rate=1000.0)
    >>> round(float(found.turns[-1]), 3)
    19.8
    """
    values = finite_record(speed, "speed")
    length = max(3, values.size // 100 // 2 * 2 + 1)
    kernel = np.hanning(length + 2)[1:-1]
    weight = np.convolve(np.ones(values.size), kernel, mode="same")
    centre = np.arange(values.size, dtype=float)
    smooth = np.convolve(values, kernel, mode="same") / weight
    place = np.convolve(centre, kernel, mode="same") / weight  # a cut kernel looks elsewhere
    smooth = np.interp(centre, place, smooth)
    if np.any(smooth <= 0.0):
        raise InputError("speed", f"{smooth.min():.4g} turns/s", allowed="> 0 in the whole record")
    total = np.concatenate([[0.0], np.cumsum(0.5 * (smooth[1:] + smooth[:-1]))]) / rate
    at = (start + np.arange(samples) / sample_rate) * rate
    inside = np.flatnonzero((at >= 0.0) & (at <= values.size - 1))
    if inside.size < 2:
        raise InputError("speed", "its samples", why="none lie within the record's time")
    turned = scipy.interpolate.CubicSpline(centre, total)(at[inside])
    return Turns(turns=np.asarray(turned - turned[0]), first=int(inside[0]), noise=0.0)
