"""Order slices: amplitudes of orders turn by turn, with intervals, from a record in angle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft, special

from thermogear.base.arrays import Complexes, Floats
from thermogear.base.errors import InputError
from thermogear.signals.filters import thinned
from thermogear.signals.interval import student
from thermogear.signals.spectra import finite_record

BLOCKS = (3, 5, 8, 13, 21, 34, 55)
"""Turns of the blocks that are tried, shortest first."""

STEPS = 200
"""Places at which an order is read, at most; they are a turn or more apart."""

_APART = 4.0  # lines of a block: orders this far apart are told apart by the fit
_POWERS = 3
_BIAS = 1.25  # the bias b goes with T^4: blocks of length 1.6 to 1 differ by b - b/6 or so
_DIFFERS = 0.55  # variance of that difference by noise, of the longer block's times T/T' - 1
_CIRCLE = 1.5616  # -2 ln 0.05/1.96^2
_NORMAL, _ONE = 1.959964, 1.644854  # standard deviations that hold 95 % on both sides, on one
_FAR = 3.5 + np.arange(30.0)  # lines beside an order at which its noise may be judged
_JUDGED = 12
_PER_BIN = 1.4  # real numbers in a Hann bin that is a line apart from the next
_DEGREES = _PER_BIN * _JUDGED
_FREE = 3.0  # lines from every order that is fitted
_SLIPS, _AROUND, _MOST_AROUND = 0.03, 6, 40  # a wrong angle moves a line by 3 %; lines beside it
_SPILL = 0.02  # of the power of other orders there, that their own change leaves
_MORE = 4.0  # times what is usually left
_RESAMPLED = (
    1e-3  # of an amplitude, that the resampling loses at 0.4 of its rate; below, as a spline
)
_FINEST = 3.4  # samples per turn over the highest order


@dataclass(frozen=True, kw_only=True)
class Slices:
    """``amplitude`` (order, step), peak, with the ``half_width`` of its 95 % interval, both in the
    record's unit, and ``phase`` [rad] against the angle; ``turns`` (step) at which they are read
    and ``block`` (order, step) the turns they are read over. nan where no block reaches."""

    turns: Floats
    amplitude: Floats
    phase: Floats
    half_width: Floats
    block: Floats


def order_slices(
    x: ArrayLike,
    *,
    samples_per_turn: int,
    first: float,
    orders: Sequence[float],
    beside: Sequence[float] = (),
    angle_noise: float = 0.0,
) -> Slices:
    """Amplitudes of ``orders`` along a record at equal steps of angle.

    ``x`` [any unit] one channel, its first sample at ``first`` [turns]; ``beside``: orders of
    other lines; ``angle_noise`` [turns, rms] of the angle that the record was resampled by.

    Over a block of T turns about its centre all orders o are fitted at once, each with a complex
    amplitude of second degree in the angle, weighted by Hann's window:

        x = Re sum_o (a_o + b_o u + c_o u^2) exp(2 pi i o theta),  u = 2 (theta - theta_c)/T.

    Noise: mean square of what is left 3.5 lines (1/T) beside the order and more, at the 12 nearest
    places that are free, mean of three steps. Bias: what the
    amplitude changes when the block is made 1.6 times shorter, less what noise changes, times 1.25
    (it goes with T^4), root of the mean square within half a block. Of the blocks whose intervals
    all meet those of the shorter ones the one of the smallest interval is taken (Lepski's rule).
    The half width holds 95 % of noise about that bias (``half_width_of``)
    + a (2 pi o s)^2/2 for the angle's noise s
    + a 0.1 % (o/0.4 samples per turn)^4 for the resampling; and where far more than usual is left
    within 3 % of the order, as a wrong angle leaves it, that power counts as the order's own.
    Orders nearer than 4/T to each other ask for longer blocks. No interval, no amplitude.

    Raises InputError where the record is shorter than the shortest block that tells them apart.
    Source: Lepski 1990, Theory Probab. Appl. 35, 454-466, for the choice.

    >>> turns = np.arange(100 * 64) / 64
    >>> x = (1 + turns / 100) * np.cos(2 * np.pi * 5 * turns)
    >>> found = order_slices(x, samples_per_turn=64, first=0.0, orders=[5.0])
    >>> bool(np.nanmax(np.abs(found.amplitude[0] - 1 - found.turns / 100)) < 1e-4)
    True
    """
    values, wanted = finite_record(x), np.asarray(orders, dtype=float)
    highest = float(np.max(wanted)) if wanted.size else 0.0
    if not 0.0 < highest < 0.45 * samples_per_turn or np.any(wanted <= 0.0):
        raise InputError("orders", f"{highest:g}", allowed=f"0..{0.45 * samples_per_turn:g}")
    coarser = 1
    while samples_per_turn % (2 * coarser) == 0 and (
        samples_per_turn / (2 * coarser) >= max(_FINEST * highest, 16.0)
    ):
        coarser *= 2
    values = thinned(values, coarser)  # a steep filter
    per_turn = samples_per_turn // coarser
    whole = values.size // per_turn
    others = _others(np.asarray(beside, dtype=float), wanted, 0.5 * per_turn)
    least = _least_block(np.concatenate([wanted, others]), wanted)
    blocks = [block for block in BLOCKS if least <= block <= whole]
    if not blocks:
        why = f"to tell these orders apart takes {min(least, BLOCKS[-1]):.3g} turns"
        raise InputError("record", f"{whole} turns", why=why)
    step = max(1, -(-whole // STEPS))
    centres = np.arange(blocks[0] // 2 + 1, whole - blocks[0] // 2, step)
    if centres.size == 0:
        centres = np.array([whole // 2])
    read = [_Block(block, per_turn, wanted, others).read(values, centres) for block in blocks]
    return _chosen(
        read,
        blocks,
        wanted,
        np.asarray(centres + first, dtype=np.float64),
        step,
        angle_noise,
        samples_per_turn,
    )


def _others(beside: Floats, wanted: Floats, top: float) -> Floats:
    """The orders beside that are none of the wanted ones and not each other's."""
    kept: list[float] = []
    for one in beside:
        if 0.0 < one < top and all(abs(one - o) > 0.05 for o in [*wanted, *kept]):
            kept.append(float(one))
    return np.asarray(kept)


def _least_block(every: Floats, wanted: Floats) -> float:
    """Turns that tell the wanted orders from the nearest others, and from their own images."""
    gaps = np.abs(every[:, None] - wanted[None, :])
    gaps[gaps < 1e-9] = np.inf
    return _APART / min(float(np.min(gaps)), 2.0 * float(np.min(wanted))) - 1e-9


class _Block:
    """The fit over one length of block: everything that does not depend on the samples."""

    def __init__(self, turns: int, per_turn: int, wanted: Floats, others: Floats) -> None:
        count = turns * per_turn
        theta = (np.arange(count) - count // 2) / per_turn
        u = 2.0 * theta / turns
        weight = 0.5 + 0.5 * np.cos(np.pi * u)
        every = np.concatenate([wanted, others])
        # of low orders the images at negative ones reach in
        near = np.concatenate([every, -every[2.0 * every * turns < 24.0]])
        turn = np.exp(2j * np.pi * theta[:, None] * near[None, :])
        basis = np.concatenate([turn * (u**k)[:, None] for k in range(_POWERS)], axis=1)
        weighted = basis * weight[:, None]
        self._inverse = np.linalg.pinv(basis.conj().T @ weighted, rcond=1e-10, hermitian=True)
        self._project = np.concatenate([weighted.real.T, -weighted.imag.T])
        own = np.arange(wanted.size)
        rows = self._inverse[own]
        square = np.real(np.einsum("ij,jk,ik->i", rows, weighted.conj().T @ weighted, rows.conj()))
        self._gain = square * weight.sum() ** 2 / np.sum(weight**2)
        self._fit = np.concatenate([np.arange(every.size) + k * near.size for k in range(_POWERS)])
        self._bins, self._clear = self._beside(turns, wanted, every, count)
        judged = self._bins.shape[1]
        around, self._near = self._around(turns, wanted, count)
        self._bins, self._judged = np.concatenate([self._bins, around], axis=1), judged
        reach = np.maximum(_AROUND / turns, _SLIPS * wanted)[:, None]
        self._others = (np.abs(wanted[:, None] - every[None, :]) < reach) & (
            wanted[:, None] != every[None, :]
        )
        # what the fitted lines and their conjugates show in those bins
        flat = self._bins.ravel()
        self._shown = fft.fft(weighted[:, self._fit], axis=0)[flat]
        self._mirror = np.conj(fft.fft(weighted[:, self._fit], axis=0)[-flat])
        self._weight, self._count, self._per_turn, self._own = weight, count, per_turn, own

    @staticmethod
    def _beside(
        turns: int, wanted: Floats, every: Floats, count: int
    ) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Bins beside each wanted order where noise is judged, and which of them are free."""
        far = np.stack([-_FAR, _FAR], axis=1).ravel()
        places = np.rint(wanted[:, None] * turns + far[None, :]).astype(np.int64)
        gaps = np.min(np.abs(places[:, :, None] - turns * every[None, None, :]), axis=-1)
        inside = (places > 1) & (places < count // 2)
        clear = (gaps >= _FREE) & inside
        clear |= ~np.any(clear, axis=1)[:, None] & inside
        # the nearest of them
        nearest = np.argsort(~clear, axis=1, kind="stable")[:, :_JUDGED]
        places = np.clip(np.take_along_axis(places, nearest, axis=1), 0, count // 2)
        return places, np.take_along_axis(clear, nearest, axis=1)

    @staticmethod
    def _around(
        turns: int, wanted: Floats, count: int
    ) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Bins around each wanted order where it would stand with a wrong angle; which count."""
        reach = np.clip(np.ceil(_SLIPS * wanted * turns), _AROUND, _MOST_AROUND)
        most = int(np.max(reach))
        steps = np.arange(-most, most + 1)
        places = np.rint(wanted[:, None] * turns).astype(np.int64) + steps[None, :]
        inside = (np.abs(steps)[None, :] <= reach[:, None]) & (places > 1) & (places < count // 2)
        return np.clip(places, 0, count // 2), inside

    def read(
        self, values: Floats, centres: NDArray[np.int64]
    ) -> tuple[Complexes, Floats, Floats, Floats]:
        """Complex amplitude (order, step), variance of its size, what is left around it (order,
        step) as squared amplitude, beyond 2 % of what others have there; degrees of freedom."""
        starts = centres * self._per_turn - self._count // 2
        inside = np.flatnonzero((starts >= 0) & (starts + self._count <= values.size))
        shape = (self._own.size, centres.size)
        amplitude = np.full(shape, np.nan, dtype=complex)
        variance, around = np.full(shape, np.nan), np.full(shape, np.nan)
        views = np.lib.stride_tricks.sliding_window_view(values, self._count)
        for part in np.array_split(inside, max(1, inside.size // 32)):
            if part.size == 0:
                continue
            blocks = views[starts[part]]
            seen = self._project @ blocks.T
            half = seen.shape[0] // 2
            found = 2.0 * (self._inverse @ (seen[:half] + 1j * seen[half:]))
            own = found[self._fit]
            shown = fft.rfft(blocks * self._weight, axis=-1).T[self._bins.ravel()]
            left = shown - 0.5 * (self._shown @ own + self._mirror @ own.conj())
            power = np.abs(2.0 * left / self._weight.sum()) ** 2
            power = power.reshape(*self._bins.shape, part.size)
            other = self._others @ np.abs(found[: self._others.shape[1]]) ** 2
            near = np.sum(power[:, self._judged :] * self._near[..., None], axis=1)
            around[:, part] = near / 1.5 - _SPILL * other  # a line's power in its Hann bins
            power = power[:, : self._judged]
            noise = np.sum(power * self._clear[..., None], axis=1)
            noise /= np.maximum(np.sum(self._clear, axis=1), 1)[:, None]
            amplitude[:, part] = found[self._own]
            variance[:, part] = 0.5 * noise * self._gain[:, None]
        variance = _three(variance)
        # Hann bins a line apart are correlated by 2/3: about one and a half real numbers each
        degrees = np.maximum(_PER_BIN * np.sum(self._clear, axis=1), 2.0)
        return amplitude, variance, around, degrees


def _chosen(
    read: list[tuple[Complexes, Floats, Floats, Floats]],
    blocks: list[int],
    wanted: Floats,
    turns: Floats,
    step: int,
    angle_noise: float,
    samples_per_turn: int,
) -> Slices:
    """Of every order at every step the block that Lepski's rule takes, and its interval."""
    size = np.stack([np.abs(a) for a, *_ in read])
    angle = np.stack([np.angle(a) for a, *_ in read])
    variance = np.stack([one[1] for one in read])
    sure = np.stack([[student(d) for d in one[3]] for one in read])[..., None]
    # of a line that noise hides, its size is that of a circle: 95 % within 2.45
    hidden = size**2 <= 12.0 * variance
    width = sure * np.sqrt(variance * np.where(hidden, _CIRCLE, 1.0)) / _NORMAL
    bias = np.full(size.shape, np.nan)
    for place in range(1, len(blocks)):
        ratio = blocks[place] / blocks[place - 1]
        least = np.fmin(variance[place], variance[place - 1] / ratio)  # a change raises the longer
        square = _differences(read[place][0], read[place - 1][0])
        square -= _DIFFERS * (ratio - 1.0) * least
        reach = max(1, round(blocks[place] / (2 * step)))
        bias[place] = _BIAS * np.sqrt(np.maximum(_mean(square, reach), 0.0))
    # the shortest has none below it: a fifth of what the next longer one is off, doubled
    bias[0] = 0.5 * bias[1] if len(blocks) > 1 else width[0]
    # where the angle is wrong a line stands beside its order: what is left there may be its own
    around = np.stack([one[2] for one in read])
    usual = np.maximum(_middle(around), 0.0)
    lost = np.maximum(around - _MORE * usual, 0.0)
    total = half_width_of(noise=width, bias=bias) + np.sqrt(size**2 + lost) - size
    low, high = np.full(size.shape[1:], -np.inf), np.full(size.shape[1:], np.inf)
    best = np.zeros(size.shape[1:], dtype=int)
    open_to = np.isfinite(total[0])
    for place in range(len(blocks)):
        here = total[place]
        known = np.isfinite(here)
        low_here = np.maximum(low, np.where(known, size[place] - here, -np.inf))
        high_here = np.minimum(high, np.where(known, size[place] + here, np.inf))
        open_to &= known & (low_here <= high_here)
        low, high = np.where(open_to, low_here, low), np.where(open_to, high_here, high)
        least = np.take_along_axis(total, best[None], axis=0)[0]
        best = np.where(open_to & (here < least), place, best)
    kept = [np.where(np.isfinite(total), table, np.nan) for table in (size, angle, total)]
    taken = [np.take_along_axis(table, best[None], axis=0)[0] for table in kept]
    spline = _RESAMPLED * (wanted / (0.4 * samples_per_turn)) ** 4
    smear = 0.5 * (2.0 * np.pi * wanted * angle_noise) ** 2
    return Slices(
        turns=turns,
        amplitude=taken[0],
        phase=taken[1],
        half_width=taken[2] + (smear + spline)[:, None] * taken[0],
        block=np.where(np.isfinite(taken[0]), np.asarray(blocks, float)[best], np.nan),
    )


def _middle(values: Floats) -> Floats:
    """The median over the steps that are known, 0 where none is."""
    known = np.any(np.isfinite(values), axis=-1, keepdims=True)
    return np.asarray(np.nanmedian(np.where(known, values, 0.0), axis=-1, keepdims=True))


def _differences(longer: Complexes, shorter: Complexes) -> Floats:
    """Squared change of the size; of the complex amplitude where that is no longer small."""
    whole = np.abs(longer - shorter) ** 2
    size = (np.abs(longer) - np.abs(shorter)) ** 2
    return np.asarray(np.where(whole > 0.25 * np.abs(longer) ** 2, whole, size))


def half_width_of(*, noise: ArrayLike, bias: ArrayLike) -> Floats:
    """Half width h about a value of normal ``noise`` (standard) and ``bias`` that holds 95 %.

    P(|z + b/s| <= h/s) = 0.95: 1.96 s without bias, b + 1.645 s with much.

    >>> half_width_of(noise=[1.0, 1.0], bias=[0.0, 10.0]).round(3)
    array([ 1.96 , 11.645])
    """
    scale = np.maximum(np.asarray(noise, dtype=float), 1e-300)
    share = np.asarray(bias, dtype=float) / scale
    grid = np.linspace(0.0, 6.0, 241)
    known = np.sqrt(special.chndtrix(0.95, 1.0, np.maximum(grid, 1e-6) ** 2))
    return np.asarray(scale * np.where(share < 6.0, np.interp(share, grid, known), share + _ONE))


def _mean(values: Floats, reach: int) -> Floats:
    """The mean of the known steps within ``reach`` of each one that is known."""
    known = np.isfinite(values)
    padded = np.pad(np.where(known, values, 0.0), ((0, 0), (reach, reach)))
    counted = np.pad(known.astype(float), ((0, 0), (reach, reach)))
    total, count = (
        np.lib.stride_tricks.sliding_window_view(one, 2 * reach + 1, axis=-1).sum(axis=-1)
        for one in (padded, counted)
    )
    return np.where(known, total / np.maximum(count, 1.0), np.nan)


def _three(values: Floats) -> Floats:
    """The mean of each step and its neighbours, of those that are known."""
    padded = np.pad(values, ((0, 0), (1, 1)), constant_values=np.nan)
    three = np.stack([padded[:, :-2], padded[:, 1:-1], padded[:, 2:]])
    known = np.isfinite(three)
    count = np.maximum(known.sum(axis=0), 1)
    return np.where(np.isfinite(values), np.where(known, three, 0.0).sum(axis=0) / count, np.nan)


@dataclass(frozen=True, kw_only=True)
class Greatest:
    """The greatest of ``steps`` amplitudes: the ``step`` at which it was read, the ``amplitude``
    read there, and ``low`` and ``high``, the 95 % interval of the greatest true one."""

    step: int
    steps: int
    amplitude: float
    low: float
    high: float


def greatest(amplitude: ArrayLike, *, half_width: ArrayLike) -> Greatest | None:
    """The greatest amplitude (step,) of an order over a run, by all steps; None where none is read.

    The greatest of n readings is too large by noise alone: its own interval h, which holds 95 % of
    the readings at one step that is chosen before, does not hold it. The half widths of all steps
    are made wider so that together they hold with 95 % or more, whatever steps share (Bonferroni's
    inequality); where they do the greatest true amplitude is

        max(a - c h) .. max(a + c h),  c = t(1 - 0.025/n)/t(0.975),

    with Student's t of as many degrees as the noise beside an order is judged by (16.8).
    ``half_width`` (step,) in the amplitude's unit, nan where nothing is read. Source: Miller 1981,
    Simultaneous Statistical Inference, section 1.1.

    >>> found = greatest([1.0, 1.2, 1.1], half_width=[0.1, 0.1, 0.1])
    >>> found.step, f"{found.low:.3f} {found.high:.3f}"
    (1, '1.074 1.326')
    """
    a, h = np.asarray(amplitude, dtype=float), np.asarray(half_width, dtype=float)
    good = np.isfinite(a) & np.isfinite(h)
    count = int(np.count_nonzero(good))
    if count == 0:
        return None
    wider = -float(special.stdtrit(_DEGREES, 0.025 / count)) / student(_DEGREES)
    a, h = np.where(good, a, -np.inf), np.where(good, h, 0.0)
    step = int(np.argmax(a))
    return Greatest(
        step=step,
        steps=count,
        amplitude=float(a[step]),
        low=max(0.0, float(np.max(a - wider * h))),
        high=float(np.max(a + wider * h)),
    )
