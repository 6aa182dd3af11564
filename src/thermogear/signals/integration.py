"""From acceleration to displacement: what two running sums lose of a line."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals.spectra import positive_rate


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
