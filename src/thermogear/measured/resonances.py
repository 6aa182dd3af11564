"""Orders over the speed of a run, and resonances in hertz told from peaks of several orders at one
frequency or speed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from thermogear.base.arrays import Floats

_ABOVE = 1.4  # times the valleys beside it a peak must be
_SAME = 0.03  # peaks nearer than this, relative, are of one frequency, or of one speed
_VAGUE = 0.1  # of its frequency: a peak no surer than this is none
_SHOULDER = 0.6  # of a peak: what is fitted


@dataclass(frozen=True, kw_only=True)
class Resonance:
    """A place where orders peak.

    ``kind``: "resonance" where two orders or more peak at one ``frequency`` [Hz] at different
    speeds; "speed" where they peak at one ``speed`` [rad/s] and not at one frequency; "one
    order" where a single order peaks, which cannot tell. ``half_width`` [Hz] of the 95 % interval,
    with the scatter between orders; ``damping`` ratio (nan where no shape could be fitted);
    ``seen``: names of the orders.
    """

    kind: str
    frequency: float
    half_width: float
    damping: float
    speed: float
    seen: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class OrderMap:
    """``amplitude`` (row, order), peak in the file's unit, of the first channel, Hann window over
    ``turns``; of each run of orders the highest. ``order`` of the first shaft (of the mesh line
    where no shaft is known), ``speed`` (row) [rad/s], ``time`` (row) [s] in the stretch."""

    order: Floats
    speed: Floats
    time: Floats
    amplitude: Floats
    turns: int


@dataclass(frozen=True, kw_only=True)
class OrderSlices:
    """Amplitudes of orders over speed, of a run whose speed changes.

    ``channels``, ``names`` of the lines and their ``orders`` of the first shaft (of the mesh line
    where ``of_mesh``); over steps ``time`` [s], ``speed`` [rad/s] of what ``orders`` count and
    ``acceleration`` [rad/s^2] of it, ``frequency`` (order, step) [Hz]; ``reading`` (channel,
    order, step) peak amplitude in the file's unit, ``half_width`` of its 95 % interval, ``phase``
    [rad] against the angle, ``block`` the turns it is read over. ``si``: SI units in one of a
    channel's, nan where unknown; ``kinds`` of quantity, "" where unknown.
    """

    channels: tuple[str, ...]
    names: tuple[str, ...]
    orders: Floats
    of_mesh: bool
    time: Floats
    speed: Floats
    acceleration: Floats
    frequency: Floats
    reading: Floats
    half_width: Floats
    phase: Floats
    block: Floats
    si: Floats
    kinds: tuple[str, ...]
    map: OrderMap
    resonances: tuple[Resonance, ...] = ()


@dataclass(frozen=True, kw_only=True)
class _Peak:
    name: str
    frequency: float
    error: float
    damping: float
    speed: float
    height: float


def resonances_of(slices: OrderSlices, rate_share: float = 0.0) -> tuple[Resonance, ...]:
    """Peaks of all orders and channels, sorted into resonances, speeds and single peaks.

    A peak is 1.4 times the valleys on both sides, intervals counted off. Around it, down
    to 0.6 of its height, the shape of one mass on a spring is fitted:

        1/a^2 = c_2 f^4 + c_1 f^2 + c_0,  f_n^4 = c_0/c_2,  2 zeta^2 = 1 + c_1/(2 f_n^2 c_2),

    which holds where the excitation does not change with frequency there. A passage at f' [Hz/s]
    moves a peak, and a frequency read from a phase, by up to about f'/(2 pi zeta f_n): that is in
    the interval, and so is ``rate_share``, by how much the sampling rate may be off. Fewer than
    three steps show no peak.
    """
    if slices.time.size < 3:
        return ()
    peaks: list[_Peak] = []
    for c in range(len(slices.channels)):
        for k, name in enumerate(slices.names):
            peaks += _peaks(
                name,
                slices.frequency[k],
                slices.speed,
                slices.reading[c, k],
                slices.half_width[c, k],
                np.gradient(slices.frequency[k], slices.time),
            )
    peaks.sort(key=lambda one: -one.height)
    found: list[Resonance] = []
    left = peaks
    for kind, key in (("resonance", "frequency"), ("speed", "speed")):
        rest: list[_Peak] = []
        while left:
            first, *others = left
            same = [p for p in others if abs(getattr(p, key) / getattr(first, key) - 1) < _SAME]
            group = [first, *same]
            if _told_apart(group, kind):
                found.append(_of(kind, group))
                left = [p for p in others if p not in same]
            else:
                rest.append(first)
                left = others
        left = rest
    by_name: dict[tuple[str, int], list[_Peak]] = {}
    for one in left:
        by_name.setdefault((one.name, round(np.log(one.frequency) / _SAME)), []).append(one)
    found += [_of("one order", group) for group in by_name.values()]
    return tuple(
        replace(one, half_width=one.half_width + rate_share * one.frequency) for one in found
    )


def _told_apart(group: list[_Peak], kind: str) -> bool:
    """Whether orders differ enough: in speed at one frequency, in frequency at one speed."""
    other = "speed" if kind == "resonance" else "frequency"
    values = [getattr(p, other) for p in group]
    return len({p.name for p in group}) > 1 and max(values) > (1.0 + 3.0 * _SAME) * min(values)


def _of(kind: str, group: list[_Peak]) -> Resonance:
    places = np.array([p.frequency for p in group])
    errors = np.array([p.error for p in group])
    weight = 1.0 / np.maximum(errors, 1e-3 * places) ** 2
    centre = float(np.average(places, weights=weight))
    scatter = float(np.std(places, ddof=1)) if len(group) > 1 and kind == "resonance" else 0.0
    damping = [p.damping for p in group if np.isfinite(p.damping)]
    return Resonance(
        kind=kind,
        frequency=centre,
        half_width=1.96 * float(np.hypot(errors.min(), scatter)),
        damping=float(np.median(damping)) if damping else float("nan"),
        speed=float(group[0].speed) if kind != "resonance" else float("nan"),
        seen=tuple(dict.fromkeys(p.name for p in group)),
    )


def _peaks(
    name: str, f: Floats, speed: Floats, a: Floats, half: Floats, rate: Floats
) -> list[_Peak]:
    """Peaks of one order over its frequency, which changes by ``rate`` [Hz/s]."""
    good = np.flatnonzero(np.isfinite(a) & np.isfinite(half))
    if good.size < 9:
        return []
    order = good[np.argsort(f[good], kind="stable")]
    x, y, h, s = f[order], a[order], half[order], speed[order]
    found: list[_Peak] = []
    tops = np.flatnonzero((y[1:-1] >= y[:-2]) & (y[1:-1] > y[2:])) + 1
    for top in tops:
        higher = np.flatnonzero(y > y[top])
        left = higher[higher < top].max(initial=-1)
        right = higher[higher > top].min(initial=y.size)
        upper = y + h  # of a valley its upper end counts
        valley = [
            part.min() for part in (upper[left + 1 : top], upper[top + 1 : right]) if part.size
        ]
        if len(valley) < 2 or y[top] - h[top] < _ABOVE * max(valley):
            continue
        low = high = int(top)
        while low > 0 and y[low - 1] > _SHOULDER * y[top]:
            low -= 1
        while high < y.size - 1 and y[high + 1] > _SHOULDER * y[top]:
            high += 1
        place, error, damping = _shape(x[low : high + 1], y[low : high + 1], h[low : high + 1])
        if not x[max(low - 1, 0)] <= place <= x[min(high + 1, x.size - 1)]:
            place, error, damping = float(x[top]), float(x[high] - x[low]) / 4.0, float("nan")
        half_band = damping * place if np.isfinite(damping) else float(x[high] - x[low]) / 2.0
        swept = abs(float(np.interp(place, x, rate[order]))) / (2.0 * np.pi * max(half_band, 1e-9))
        error = float(np.hypot(np.nan_to_num(error), swept / 1.96))
        if error > _VAGUE * place:  # a single step of noise: it is anywhere
            continue
        found.append(
            _Peak(
                name=name,
                frequency=place,
                error=error,
                damping=damping,
                speed=float(np.interp(place, x, s)),
                height=float(y[top] / max(valley)),
            )
        )
    return found


def _shape(f: Floats, a: Floats, half: Floats) -> tuple[float, float, float]:
    """Natural frequency, its standard error and damping of one mass on a spring; nan: no fit."""
    if f.size < 5:
        return float("nan"), float("nan"), float("nan")
    centre = float(f[np.argmax(a)])
    y = (f / centre) ** 2
    inverse = (a.max() / a) ** 2
    sigma = inverse * 2.0 * np.maximum(half / 1.96 / a, 1e-3)
    matrix = np.stack([y**2, y, np.ones_like(y)], axis=1)

    def solved(values: Floats) -> tuple[float, float]:
        c2, c1, c0 = np.linalg.lstsq(matrix / sigma[:, None], values / sigma)[0]
        if c2 <= 0.0 or c0 <= 0.0:
            return float("nan"), float("nan")
        square = float(np.sqrt(c0 / c2))
        zeta = 0.5 * (1.0 + c1 / (2.0 * square * c2))
        return centre * float(np.sqrt(square)), float(np.sqrt(zeta)) if zeta > 0 else float("nan")

    place, damping = solved(inverse)
    # jackknife over the points: neighbours overlap, so that it is a floor of the error
    left = np.array([_solved_without(matrix, inverse, sigma, i) * centre for i in range(f.size)])
    solvable = left[np.isfinite(left)]
    spread = np.std(solvable) * np.sqrt(f.size - 1.0) if solvable.size > 1 else np.nan
    return place, float(spread), damping


def _solved_without(matrix: Floats, values: Floats, sigma: Floats, gone: int) -> float:
    """Natural frequency over the peak's, one of the points left out; nan: no fit."""
    kept = np.arange(values.size) != gone
    scaled = matrix[kept] / sigma[kept, None]
    c2, _, c0 = np.linalg.lstsq(scaled, values[kept] / sigma[kept])[0]
    return float((c0 / c2) ** 0.25) if c2 > 0.0 and c0 > 0.0 else float("nan")
