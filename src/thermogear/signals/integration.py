"""From acceleration to velocity in a band; what two running sums to displacement lose of a line."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

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


def velocity_rms(
    x: ArrayLike, *, rate: float, low: float, high: float, integrations: int = 1
) -> float:
    """Root mean square of velocity between ``low`` and ``high`` [Hz], of an acceleration ``x``.

    sqrt(sum_k 2 |X_k|^2/omega_k^(2n)/(N sum w^2)) over the bins in the band, X the DFT of N
    samples under a Hann window w, n = ``integrations`` (0: ``x`` is a velocity, -1: displacement).
    ``x`` in SI, one channel; ``rate`` [samples/s]. A line near an edge counts by the part of its
    lobe inside. Raises InputError for a band that ends beyond half the rate or holds no bin.

    >>> a = 9.80665 * np.cos(2 * np.pi * 100.0 * np.arange(10_000) / 5000.0)
    >>> f"{1e3 * velocity_rms(a, rate=5000.0, low=10.0, high=1000.0):.2f} mm/s"
    '11.04 mm/s'
    """
    values = finite_record(x)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(values.size) / values.size)
    frequency = np.fft.rfftfreq(values.size, 1.0 / positive_rate(rate))
    band = (frequency >= low) & (frequency <= high) & (frequency > 0.0)
    if not band.any() or high > rate / 2.0:
        raise InputError("band", f"{low:g}..{high:g} Hz", allowed=f"within 0..{rate / 2.0:g} Hz")
    power = np.abs(np.fft.rfft((values - values.mean()) * window)[band]) ** 2
    power *= (2.0 * np.pi * frequency[band]) ** (-2 * integrations)
    return float(np.sqrt(2.0 * power.sum() / (values.size * np.sum(window**2))))
