"""Condition indicators of gears: each with the signal that it is computed from.

x is the synchronous average, r the residual, d the difference and g the regular signal of one turn
(:mod:`~thermogear.signals.synchronous`), time or angle last; leading axes are kept. A signal
without any power has no ratio: nan. None of them has a limit that holds for every machine.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from thermogear.base.arrays import Floats
from thermogear.signals.spectra import finite_record
from thermogear.signals.synchronous import demodulated, separated

SIDES = 6
"""Sidebands on each side in the sideband ratio, as in the public code of KAU's gear rig."""
MESH_HARMONICS = 5
"""Mesh harmonics in FM0 at most: beyond, a housing's resonances decide (chosen)."""
DEMODULATED = 3
"""Mesh harmonics that are demodulated at most (chosen)."""
RARE = 0.05
"""Share of turns that leave a 95 % interval."""
GAUSS = {4: (3.0, 24.0), 6: (15.0, 6120.0), 8: (105.0, 1663200.0)}
"""Power -> normalised moment of Gaussian noise and its variance times the samples."""


def normalised_moment(x: ArrayLike, *, power: int) -> Floats:
    """N^(p/2 - 1) sum (x - mean)^p/(sum (x - mean)^2)^(p/2), p = ``power``: (...).

    p = 4: kurtosis (not excess); of the difference signal p = 4, 6, 8 are FM4, M6A, M8A.
    Gaussian noise: 3, 15, 105; a sine 1.5, 2.5, 4.375; a square wave 1.
    Sources: Stewart 1977 (FM4); Martin 1989, Int. Conf. Cond. Monit. (M6A, M8A).

    >>> [round(float(normalised_moment(np.cos(0.02 * np.pi * np.arange(100)), power=p)), 3)
    ...  for p in (4, 6, 8)]
    [1.5, 2.5, 4.375]
    """
    values = finite_record(x)
    centred = values - values.mean(axis=-1, keepdims=True)
    square = centred**2
    # numpy raises to a power a tenth as fast as it multiplies
    raised = math.prod([square] * (power // 2))
    return _ratio(np.mean(raised, axis=-1), np.mean(square, axis=-1) ** (power // 2))


def moment_scatter(power: int, *, count: int) -> float:
    """Standard deviation of :func:`normalised_moment` of ``count`` independent Gaussian samples.

    sqrt(24/n), sqrt(6120/n), sqrt(1663200/n) for p = 4, 6, 8, to first order in 1/n: the last is
    a quarter too wide at n = 400. A difference signal has n = 2 x orders kept.

    >>> f"{moment_scatter(4, count=600):.2f}"
    '0.20'
    """
    return float(np.sqrt(GAUSS[power][1] / count))


def crest_factor(x: ArrayLike) -> Floats:
    """max|x|/rms(x), mean included: (...). sqrt(2) for a sine.

    >>> round(float(crest_factor([0.0, 1.0, 0.0, -1.0])), 4)
    1.4142
    """
    values = finite_record(x)
    return _ratio(np.max(np.abs(values), axis=-1), np.sqrt(np.mean(values**2, axis=-1)))


def order_amplitudes(average: ArrayLike) -> Floats:
    """Peak amplitudes of orders 0, 1, ... of averages over one turn, (..., order).

    >>> order_amplitudes(3.0 * np.cos(np.pi * np.arange(8) / 4)).round(6)[:3]
    array([0., 3., 0.])
    """
    values = finite_record(average)
    lines = np.abs(fft.rfft(values, axis=-1)) * 2.0 / values.shape[-1]
    lines[..., 0] *= 0.5
    return np.asarray(lines)


def fm0(average: ArrayLike, *, mesh_order: int, harmonics: int) -> Floats:
    """FM0 of x: (max x - min x)/sum_k A(k z), k = 1 .. ``harmonics``; z = ``mesh_order``.

    2 for one cosine alone; of 2, 3, 4 equal cosines 1.5625, 1.438, 1.379.
    Source: Stewart 1977, Some useful data analysis techniques for gearbox diagnostics.

    >>> float(fm0(np.cos(2 * np.pi * np.arange(64) / 8), mesh_order=8, harmonics=2).round(6))
    2.0
    """
    values = finite_record(average)
    lines = order_amplitudes(values)[..., mesh_order : harmonics * mesh_order + 1 : mesh_order]
    return _ratio(np.ptp(values, axis=-1), lines.sum(axis=-1))


def na4_of_moments(
    *, fourth: ArrayLike, variance: ArrayLike, healthy: float | None = None
) -> Floats:
    """NA4 of runs by the ``fourth`` central moment and the ``variance`` of each residual: (run,).

    mean (r - mean r)^4/M^2, M the mean of the variances of runs 1 .. this one. A single run has the
    kurtosis of r. It keeps growing where a fault spreads, which FM4 does not. ``healthy``: the mean
    variance of healthy runs in place of M; it does not grow with the fault.
    Sources: Zakrajsek, Townsend and Decker 1993, NASA TM-105950; Decker and Zakrajsek 1999, NASA
    TM-209046, for the healthy form.

    >>> na4_of_moments(fourth=[1.5, 24.0], variance=[1.0, 4.0], healthy=1.0)
    array([ 1.5, 24. ])
    """
    spread = np.asarray(variance, dtype=float)
    mean = np.cumsum(spread) / np.arange(1.0, spread.size + 1.0)
    return _ratio(fourth, (mean if healthy is None else np.full_like(mean, healthy)) ** 2)


def energy_ratio(*, difference: ArrayLike, regular: ArrayLike) -> Floats:
    """std(d)/std(g): (...). What wears the whole gear moves power from g to d.

    Source: Swansson 1980; as MATLAB's gearConditionMetrics documents it. Of d and g of orders of
    their own it is the root of the ratio of powers, which the tests hold.

    >>> turn = 2 * np.pi * np.arange(64) / 64
    >>> float(energy_ratio(difference=0.1 * np.cos(5 * turn), regular=np.cos(8 * turn)).round(6))
    0.1
    """
    return _ratio(
        np.std(finite_record(difference), axis=-1), np.std(finite_record(regular), axis=-1)
    )


def energy_operator(residual: ArrayLike) -> Floats:
    """EOP of r: the kurtosis of psi_i = r_i^2 - r_(i-1) r_(i+1), over the closed turn.

    psi of A sin(w i) is A^2 sin^2 w; EOP of white Gaussian noise is 9, not 3.
    Source: Teager and Kaiser 1990 for psi; the mean 9 is derived in the tests.

    >>> noise = np.random.default_rng(1).normal(size=200_000)
    >>> 8.5 < float(energy_operator(noise)) < 9.5
    True
    """
    r = finite_record(residual)
    psi = r**2 - np.roll(r, 1, axis=-1) * np.roll(r, -1, axis=-1)
    return normalised_moment(psi, power=4)


def sideband_index(average: ArrayLike, *, mesh_order: int) -> Floats:
    """Mean amplitude of orders z - 1 and z + 1 of x [its unit]: m A/2 for 1 + m cos(th).

    >>> turn = 2 * np.pi * np.arange(64) / 64
    >>> x = (1 + 0.4 * np.cos(turn)) * np.cos(8 * turn)
    >>> round(float(sideband_index(x, mesh_order=8)), 6)
    0.2
    """
    lines = order_amplitudes(average)
    return np.asarray(0.5 * (lines[..., mesh_order - 1] + lines[..., mesh_order + 1]))


def sideband_ratio(average: ArrayLike, *, mesh_order: int) -> Floats:
    """SER of x: the six sidebands on each side of order z over A(z), fewer where z/2 is nearer.

    m for an amplitude modulation 1 + m cos(j th), j = 1 .. 6.
    Source: the public code of KAU's gear rig.

    >>> turn = 2 * np.pi * np.arange(64) / 64
    >>> x = (1 + 0.4 * np.cos(3 * turn)) * np.cos(16 * turn)
    >>> round(float(sideband_ratio(x, mesh_order=16)), 6)
    0.4
    """
    lines = order_amplitudes(average)
    reach = min(SIDES, (mesh_order - 1) // 2)
    near = lines[..., mesh_order - reach : mesh_order + reach + 1].sum(axis=-1)
    return _ratio(near - lines[..., mesh_order], lines[..., mesh_order])


def modulation_depths(amplitude: ArrayLike) -> tuple[Floats, Floats]:
    """Depth of amplitude [-] and of phase [rad] of a complex ``amplitude`` over one turn.

    (max|a| - min|a|)/(max|a| + min|a|), half the range of the phase about its mean direction: m
    and b of (1 + m cos th) exp(i b cos th).

    >>> turn = 2 * np.pi * np.arange(64) / 64
    >>> [round(float(d), 6) for d in
    ...  modulation_depths((1 + 0.3 * np.cos(turn)) * np.exp(0.1j * np.cos(turn)))]
    [0.3, 0.1]
    """
    a = np.asarray(amplitude)
    size = np.abs(a)
    high, low = size.max(axis=-1), size.min(axis=-1)
    turned = np.angle(a * np.conj(a.mean(axis=-1, keepdims=True)))
    return _ratio(high - low, high + low), np.asarray(0.5 * np.ptp(turned, axis=-1))


def amplitude_half_width(bands: ArrayLike, *, mesh_order: int, share: float) -> Floats:
    """How far noise moves the amplitude of the mean of demodulated ``bands`` anywhere, 95 %: (...).

    u s, s the standard deviation of what is in phase with the mean: the root of ``share``/2 times
    the variance of ``bands`` (..., block, sample), each of ``share`` of the turns. u is the root of
    2 ln(z/(0.05 sqrt(3))): Gaussian noise in a band of z orders goes through +-u 0.05 times a turn.
    The greatest and the least amplitude of a turn are off by no more, nor is a tooth chosen by it.
    Source: Rice 1945, Bell Syst. Tech. J. 24, 46-156, section 3.3.

    >>> noise = np.random.default_rng(1).normal(size=(8, 512, 2)) @ [1.0, 1j]
    >>> f"{float(amplitude_half_width(noise, mesh_order=19, share=1 / 8)):.2f}"
    '1.15'
    """
    variance = np.var(np.asarray(bands), axis=-2, ddof=1).mean(axis=-1)
    level = np.sqrt(2.0 * np.log(mesh_order / (RARE * np.sqrt(3.0))))
    return np.asarray(level * np.sqrt(0.5 * share * variance))


def tooth_deviations(values: ArrayLike) -> Floats:
    """How far each tooth's value is off their median, in robust standard deviations: (..., tooth).

    (v - median)/(1.4826 median|v - median|), which is 1 for one standard deviation of Gaussian
    values; 0 where all are alike.

    >>> tooth_deviations([1.0, 2.0, 1.5, 1.2, 9.0]).round(1)
    array([-0.7,  0.7,  0. , -0.4, 10.1])
    """
    v = finite_record(values)
    off = v - np.median(v, axis=-1, keepdims=True)
    spread = 1.4826 * np.median(np.abs(off), axis=-1, keepdims=True)
    return np.asarray(np.nan_to_num(_ratio(off, spread)))


def demodulated_harmonics(*, mesh_order: int, highest: int) -> range:
    """Mesh harmonics whose band of z/2 on each side is below the ``highest`` order, at most three.

    >>> demodulated_harmonics(mesh_order=20, highest=64)
    range(1, 3)
    """
    most = (highest - (mesh_order - 1) // 2) // mesh_order
    return range(1, min(DEMODULATED, most) + 1)


def gear_indicators(
    average: ArrayLike, *, mesh_order: int, highest: int, step: int | None = None
) -> dict[str, Floats]:
    """Every indicator of averages over one turn (..., sample), by name: (...); of NA4 the moments.

    ``mesh_order`` z; ``highest`` order that counts, below half the samples; ``step`` as of
    :func:`~thermogear.signals.synchronous.separated`. Depths of modulation are means over the
    demodulated mesh harmonics k, weighted by their amplitudes; the phase's is divided by k, so that
    it is that of the mesh order: an error of timing has the same at every k.

    >>> turn = 2 * np.pi * np.arange(256) / 256
    >>> x = (1 + 0.2 * np.cos(turn)) * np.cos(20 * turn)
    >>> values = gear_indicators(x, mesh_order=20, highest=100)
    >>> [round(float(values[name]), 3) for name in ("amplitude_depth", "sideband_ratio")]
    [0.2, 0.2]
    """
    x = finite_record(average)
    parts = separated(x, mesh_order=mesh_order, highest=highest, step=step)
    centred = parts.residual - parts.residual.mean(axis=-1, keepdims=True)
    harmonics = demodulated_harmonics(mesh_order=mesh_order, highest=highest)
    bands = [demodulated(x, mesh_order=mesh_order, harmonic=k) for k in harmonics]
    depths = [modulation_depths(band) for band in bands]
    weights = np.array([np.abs(band.mean(axis=-1)) for band in bands])
    amplitude = np.array([depth for depth, _ in depths])
    phase = np.array([depth / k for k, (_, depth) in zip(harmonics, depths, strict=True)])
    # without a band the total is 0, and so a depth is nan
    total = weights.sum(axis=0) if bands else np.zeros(x.shape[:-1])
    return {
        "rms": np.std(x, axis=-1),
        "residual_rms": np.std(parts.residual, axis=-1),
        "residual_fourth": np.mean((centred**2) ** 2, axis=-1),
        "fm0": fm0(x, mesh_order=mesh_order, harmonics=min(MESH_HARMONICS, highest // mesh_order)),
        "fm4": normalised_moment(parts.difference, power=4),
        "m6a": normalised_moment(parts.difference, power=6),
        "m8a": normalised_moment(parts.difference, power=8),
        "kurtosis": normalised_moment(x, power=4),
        "crest": crest_factor(x - x.mean(axis=-1, keepdims=True)),
        "energy_ratio": energy_ratio(difference=parts.difference, regular=parts.regular),
        "energy_operator": energy_operator(parts.residual),
        "sideband_index": sideband_index(x, mesh_order=mesh_order),
        "sideband_ratio": sideband_ratio(x, mesh_order=mesh_order),
        "amplitude_depth": _ratio((weights * amplitude).sum(axis=0), total),
        "phase_depth": _ratio((weights * phase).sum(axis=0), total),
    }


def _ratio(over: ArrayLike, under: ArrayLike) -> NDArray[np.float64]:
    """A quotient; nan where nothing is below the line."""
    top, bottom = np.asarray(over, dtype=float), np.asarray(under, dtype=float)
    whole = np.broadcast_to(bottom > 0.0, np.broadcast_shapes(top.shape, bottom.shape))
    return np.asarray(np.divide(top, bottom, out=np.full(whole.shape, np.nan), where=whole))
