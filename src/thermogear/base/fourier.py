"""Fourier series of very many harmonics by FFT: values, bounds and Taylor tables.

p(phi) = c_0 + Re sum_{q=1..Q} c_q exp(2 pi i q phi), phi in periods. A turn of both gears has some
twenty harmonics in each of up to 2000 mesh periods; term by term a table of N phases costs Q N, by
FFT (Q + N) log (Q + N). Coefficients are (row, 1 + harmonic), the mean first.
"""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Complexes, Floats

MANY = 2000
"""Harmonics above which a table goes by FFT; one mesh period has no more, and goes term by term."""
MOST = 2**22
"""Phases of a uniform grid at most."""


def sampled(coefficients: Complexes, count: int) -> Floats:
    """p at n/``count``, n = 0, 1, ...: (row, count), for any count."""
    # a finer grid holds all harmonics; its every so many-th point is wanted
    dense = -(-2 * coefficients.shape[-1] // count)
    spectrum = 0.5 * coefficients
    spectrum[..., 0] = coefficients[..., 0].real
    return np.fft.irfft(spectrum, n=dense * count, norm="forward")[..., ::dense]


def bound(coefficients: Complexes, order: int = 0) -> Floats:
    """A bound of |d^order p/d phi^order| over the period, (row,), at most 1.09 of the greatest.

    A trigonometric polynomial of degree Q stays below the greatest of its values at N > 2 Q uniform
    phases over cos(pi Q/N) (Ehlich and Zeller 1964, Mathematische Zeitschrift 86); here N = 8 Q.
    """
    derived = coefficients * (2j * np.pi * np.arange(coefficients.shape[-1])) ** order
    greatest = np.abs(sampled(derived, 8 * max(coefficients.shape[-1] - 1, 1))).max(axis=-1)
    return np.asarray(greatest / np.cos(np.pi / 8.0))


def taylor(coefficients: Complexes, *, count: int, order: int) -> Floats:
    """Taylor coefficients on ``count`` equal parts of the period: (part, row, order + 1).

    p = sum_m t_m u^m with u from -1 to 1 over a part: t_m is the series of
    c_q exp(pi i q/count) (pi i q/count)^m/m! at the starts of the parts.
    """
    reach = 1j * np.pi / count * np.arange(coefficients.shape[-1])
    spectrum = coefficients * np.exp(reach)
    table = np.empty((count, len(coefficients), order + 1))
    for m in range(order + 1):
        spectrum = spectrum * (reach / m) if m else spectrum
        table[:, :, m] = sampled(spectrum, count).T
    return table


def values(coefficients: Complexes, phase: Floats) -> Floats:
    """p at any ``phase`` [periods]: (row, *phase.shape).

    Phases of a uniform grid from 0 on, in any order, take one FFT; others go term by term.
    """
    flat = np.mod(phase, 1.0).ravel()
    step = flat[1] - flat[0] if flat.size > 1 else 0.0
    count = round(1.0 / step) if 1.0 / MOST < step <= 0.5 else 1
    place = np.rint(flat * count)
    if np.all(np.abs(flat - place / count) <= 1e-13):
        rows = sampled(coefficients, count)[:, place.astype(np.int64) % count]
    else:
        waves = 2j * np.pi * np.arange(coefficients.shape[-1])
        rows = np.stack([(coefficients @ np.exp(waves * at)).real for at in flat], axis=-1)
    return np.asarray(rows.reshape(len(coefficients), *np.shape(phase)))
