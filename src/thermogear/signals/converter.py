"""What a converter of few levels does to the lines of a record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.signals.lines import line_spectrum
from thermogear.signals.strong import strong_lines

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
    floor = float(np.median(np.abs(spectrum.windowed("hann")) ** 2)) / (6.0 * float(np.log(2.0)))
    noise = max(0.0, floor * x.size / step**2 - _OWN)
    height = abs(lines[0].amplitude) / step
    return _FOLDED * float(height**-1.5 * np.exp(-2.0 * np.pi**2 * noise))
