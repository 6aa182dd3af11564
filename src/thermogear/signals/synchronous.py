"""The synchronous average of a shaft, and its parts: regular, residual and difference signal.

Everything takes samples over a shaft's angle: a record that was resampled (``resample_by_angle``)
or a computed motion over whole turns. No gear is known here; a shaft has a ``mesh_order``, the mesh
cycles in one of its turns, and its mate has another.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import gcd

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.signals.spectra import finite_record

SHAFT_ORDERS = (1, 2)
"""Orders of the shaft itself that residual and difference lack: unbalance, misalignment."""
LEAST_STEP = 3
"""From every third order on, orders that both shafts have are taken out of a residual: chosen. Of
every second one a local change would leave two images of one height, of every one nothing."""


def repeating_turns(*, mesh_order: int, mate_order: int) -> int:
    """Turns of a shaft after which its mate has made whole turns, too: z_mate/gcd(z, z_mate).

    An average over a multiple of so many turns holds nothing of the mate but what both share.

    >>> repeating_turns(mesh_order=19, mate_order=48), repeating_turns(mesh_order=20, mate_order=60)
    (48, 3)
    """
    return mate_order // gcd(mesh_order, mate_order)


def shared_step(*, mesh_order: int, mate_order: int) -> int:
    """Distance of the orders of a shaft that are orders of its mate, too: z/gcd(z, z_mate).

    z where only the mesh harmonics are (hunting teeth). No average tells whose such an order is.

    >>> [shared_step(mesh_order=a, mate_order=b) for a, b in ((20, 60), (60, 20), (19, 48))]
    [1, 3, 19]
    """
    return mesh_order // gcd(mesh_order, mate_order)


def comb_gain(order: ArrayLike, *, turns: int) -> Floats:
    """What an average over N ``turns`` leaves of a line: |sin(pi N x)/(N sin(pi x))|.

    ``order`` x of the averaged shaft, any shape. 1 at whole orders, 0 at j/N, -3 dB at 0.443/N.
    Source: Braun 1975, Acustica 32, 69-77; it is the sum of a geometric series.

    >>> comb_gain([1.0, 19 / 48], turns=50).round(3)
    array([1.   , 0.013])
    """
    x = np.asarray(order, dtype=float)
    off = np.pi * (x - np.rint(x))
    whole = np.abs(off) < 1e-12
    safe = np.where(whole, 1.0, off)
    return np.where(whole, 1.0, np.abs(np.sin(turns * safe) / (turns * np.sin(safe))))


def synchronous_averages(x: ArrayLike, *, samples_per_turn: int, turns: int) -> Floats:
    """Means over ``turns`` turns each, one after the other: (..., average, sample of the turn).

    ``x`` [any unit] over the shaft's angle, the turn's samples last; what is left of the record is
    not used. Noise falls as 1/sqrt(turns), other shafts' lines by :func:`comb_gain`.
    Raises InputError where the record holds fewer turns.

    >>> x = np.cos(2 * np.pi * np.arange(60) / 10) + np.repeat(np.arange(6.0), 10)
    >>> synchronous_averages(x, samples_per_turn=10, turns=3)[:, 0]
    array([2., 5.])
    """
    values = finite_record(x)
    count = values.shape[-1] // (samples_per_turn * turns) if turns > 0 else 0
    if count < 1:
        held = values.shape[-1] / samples_per_turn
        raise InputError("turns", turns, allowed=f"1..{int(held)}, as many as the record holds")
    used = values[..., : count * turns * samples_per_turn]
    blocks = used.reshape(*values.shape[:-1], count, turns, samples_per_turn)
    return np.asarray(blocks.mean(axis=-2))


@dataclass(frozen=True, kw_only=True)
class Parts:
    """An average taken apart over one turn (..., sample): ``residual`` lacks mean, shaft orders and
    mesh harmonics, ``difference`` the first sidebands as well; ``regular`` is the rest.

    ``removed`` and ``removed_sidebands``: the orders that were taken out; ``kept``: how many orders
    are left in the difference. Of Gaussian noise it has 2 ``kept`` independent samples.

    >>> separated(np.cos(np.pi * np.arange(64) / 4), mesh_order=8).kept
    19
    """

    residual: Floats
    difference: Floats
    regular: Floats
    removed: tuple[int, ...]
    removed_sidebands: tuple[int, ...]
    kept: int


def separated(
    average: ArrayLike, *, mesh_order: int, highest: int | None = None, step: int | None = None
) -> Parts:
    """Residual, difference and regular signal of averages by zeroing bins of their DFT.

    Over one turn every line of the shaft is in a bin of its own, so nothing rings or leaks.
    residual = average - mean - orders 1, 2 - orders k z; difference = residual - orders k z +- 1;
    regular = average - difference. ``average`` (..., sample) [any unit]; z = ``mesh_order``;
    ``highest`` order kept [all]; ``step``: multiples of it are orders of the mate, too: from 3
    on (:data:`LEAST_STEP`) these are taken out with the mesh harmonics. Raises InputError for fewer
    than two samples a mesh cycle.
    Source: Vecer, Kreidl and Smid 2005, Acta Polytechnica 45(6), 35-43.

    >>> angle = 2 * np.pi * np.arange(256) / 256
    >>> parts = separated(np.cos(8 * angle) + 0.3 * np.cos(21 * angle), mesh_order=8)
    >>> f"{np.ptp(parts.difference):.2f}, {parts.removed[:4]}"
    '0.60, (0, 1, 2, 8)'
    """
    values = finite_record(average)
    count = values.shape[-1]
    if not 3 <= mesh_order <= count // 2:
        why = "a mesh cycle needs two samples or more"
        raise InputError("mesh_order", mesh_order, allowed=f"3..{count // 2}", why=why)
    lines = fft.rfft(values, axis=-1)
    order = np.arange(lines.shape[-1])
    inside = order <= (order[-1] if highest is None else highest)
    mesh = (order % mesh_order == 0) | np.isin(order, SHAFT_ORDERS)
    if step is not None and step >= LEAST_STEP:
        mesh |= order % step == 0
    near = (order % mesh_order == 1) | (order % mesh_order == mesh_order - 1)
    kept = inside & ~mesh & ~near
    residual, difference = (
        fft.irfft(np.where(some, lines, 0.0), n=count, axis=-1) for some in (inside & ~mesh, kept)
    )
    return Parts(
        residual=residual,
        difference=difference,
        regular=values - difference,
        removed=_orders(mesh & inside),
        removed_sidebands=_orders(near & ~mesh & inside),
        kept=int(np.count_nonzero(kept)),
    )


def _orders(which: NDArray[np.bool_]) -> tuple[int, ...]:
    return tuple(np.flatnonzero(which).tolist())


def demodulated(average: ArrayLike, *, mesh_order: int, harmonic: int) -> NDArray[np.complex128]:
    """Complex amplitude of a mesh harmonic over one turn, (..., sample).

    a(th) = 2 sum_b X(k z + b) exp(i b th), |b| < z/2, so that the average near order k z is
    Re a exp(i k z th): |a| its amplitude [unit of ``average``], the angle of a its phase [rad]. It
    resolves one tooth. z = ``mesh_order``, k = ``harmonic``. Raises InputError where the band
    reaches beyond half the samples.
    Source: McFadden 1986, J. Vib. Acoust. Stress Reliab. 108, 165-170.

    >>> angle = 2 * np.pi * np.arange(256) / 256
    >>> a = demodulated((1 + 0.2 * np.cos(angle)) * np.cos(10 * angle), mesh_order=10, harmonic=1)
    >>> f"{abs(a).max():.3f} {abs(a).min():.3f}"
    '1.200 0.800'
    """
    values = finite_record(average)
    count, half = values.shape[-1], (mesh_order - 1) // 2
    if harmonic < 1 or harmonic * mesh_order + half >= count / 2:
        most = (count - 1 - 2 * half) // (2 * mesh_order)
        raise InputError("harmonic", harmonic, allowed=f"1..{most} at {count} samples a turn")
    lines = fft.rfft(values, axis=-1)
    band = np.zeros(values.shape, dtype=complex)
    side = np.arange(-half, half + 1)
    band[..., side] = 2.0 * lines[..., harmonic * mesh_order + side]
    return np.asarray(fft.ifft(band, axis=-1))


def tooth_means(x: ArrayLike, *, teeth: int) -> Floats:
    """Means of samples over one turn, tooth by tooth: tooth j holds floor(z th/2 pi) = j.

    ``x`` (..., sample), as many samples a turn as ``teeth`` or more. Returns (..., tooth).

    >>> tooth_means([1.0, 1.0, 5.0, 7.0], teeth=2)
    array([1., 6.])
    """
    values = finite_record(x)
    count = values.shape[-1]
    if not 1 <= teeth <= count:
        raise InputError("teeth", teeth, allowed=f"1..{count}, one sample a tooth or more")
    first = -(-np.arange(teeth + 1) * count // teeth)
    return np.asarray(np.add.reduceat(values, first[:-1], axis=-1) / np.diff(first))
