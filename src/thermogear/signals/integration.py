"""From acceleration to displacement: in the frequency domain, and the two ways that lose."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft, integrate

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals.spectra import finite_record, positive_rate


def trapezoid_factor(frequency: ArrayLike, *, rate: float) -> Floats:
    """Amplitude of a line after two trapezoidal integrations over its true amplitude.

    (u/tan u)^2,  u = pi f/rate.

    ``frequency`` [Hz], any shape; ``rate`` [samples/s]. 1 at f = 0, 0 at half the rate. Exact for
    a cosine of any length: sum of the trapezoids of cos(2 u n) is sin(2 u n)/(2 tan u).

    Raises InputError above half the rate.

    >>> f"{trapezoid_factor(250.0, rate=1000.0):.4f}"
    '0.6169'
    """
    u = np.pi * np.asarray(frequency, dtype=float) / positive_rate(rate)
    if np.any(~np.isfinite(u)) or np.any(np.abs(u) > np.pi / 2 * (1 + 1e-12)):
        raise InputError("frequency", frequency, allowed=f"0..{rate / 2:g} Hz (half the rate)")
    safe = np.where(u == 0.0, 1.0, u)
    return np.asarray(np.where(u == 0.0, 1.0, (safe / np.tan(safe)) ** 2))


def integrate_twice_trapezoid(x: ArrayLike, rate: float) -> Floats:
    """Two running trapezoidal sums from zero, as in the thesis: an offset grows with t^2.

    ``x`` [any unit], time last; ``rate`` [samples/s]. Every line is read ``trapezoid_factor``
    times too small. Not the default; kept to show what it does.

    >>> integrate_twice_trapezoid([2.0, 2.0, 2.0], 1.0)
    array([0., 1., 4.])
    """
    values, step = finite_record(x), 1.0 / positive_rate(rate)
    once = integrate.cumulative_trapezoid(values, dx=step, axis=-1, initial=0.0)
    return np.asarray(integrate.cumulative_trapezoid(once, dx=step, axis=-1, initial=0.0))


def integrate_twice(x: ArrayLike, rate: float, *, low_cut: float) -> Floats:
    """Displacement from acceleration by division by -omega^2, nothing below ``low_cut``.

    X(f) = -A(f)/(2 pi f)^2 for f >= low_cut, else 0; the mean of the result is zero.

    ``x`` [unit/s^2 times s^2 = unit], time last; ``rate`` [samples/s]; ``low_cut`` [Hz] > 0: what
    lies below (offset, drift, leakage of the record's ends) is not displacement and would be
    multiplied by up to (rate/low_cut)^2. Amplitudes of lines above are exact; the first and last
    few periods of a record that does not close on itself carry the ends' leakage.

    Raises InputError for a low cut of zero or above half the rate.

    >>> t = np.arange(1000) / 1000.0
    >>> a = -((2 * np.pi * 50.0) ** 2) * 3.0 * np.cos(2 * np.pi * 50.0 * t)
    >>> f"{integrate_twice(a, 1000.0, low_cut=10.0).max():.3f}"
    '3.000'
    """
    values, per_second = finite_record(x), positive_rate(rate)
    if not 0 < low_cut < per_second / 2:
        raise InputError(
            "low_cut", low_cut, allowed=f"0 < low cut < {per_second / 2:g} Hz (half the rate)"
        )
    count = values.shape[-1]
    lines = fft.rfft(values, axis=-1)
    omega = 2.0 * np.pi * per_second / count * np.arange(count // 2 + 1)
    keep = omega >= 2.0 * np.pi * low_cut
    factor = np.zeros_like(omega)
    factor[keep] = -1.0 / omega[keep] ** 2
    return np.asarray(fft.irfft(lines * factor, n=count, axis=-1))
