"""Where samples are lost inside a record: a line's phase jumps there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_JUMP = 0.06  # cycles
_SHARP = 0.75  # of a step, between the pieces beside it
_PARTS = 8  # pieces of a turn
_SHORT = 4.0  # cycles of the line, the shortest piece
_HIDDEN = 6.0  # times the noise of a piece: a step that is lost in it
_RANKS = (1, 2, 3)  # of a shaft


def phase_jumps(x: Floats, frequency: float, *, cycles: float = 24.0) -> list[int]:
    """Samples at which the line of ``frequency`` [cycles/sample] jumps in phase: samples lost.

    The phase of pieces of ``cycles``, each half over the next, less its smooth course: a jump
    is between two that are each steady, and is far larger than their scatter. It is one in pieces
    of a twenty-fourth, too, where noise lets that be seen: a slower shaft, not known, turns the
    phase as far, but smoothly. Fewer than 16 pieces tell nothing. Of a mesh line take three turns
    of the shaft, so that its sidebands do not turn the phase.

    >>> n = np.arange(4000)
    >>> phase_jumps(np.cos(2 * np.pi * 0.1 * n), 0.1)
    []
    >>> jumped = np.cos(2 * np.pi * 0.1 * np.where(n < 2000, n, n + 104))
    >>> [abs(place - 2000) < 300 for place in phase_jumps(jumped, 0.1)]
    [True]
    """
    length = int(np.ceil(cycles / frequency))
    hop = length // 2
    count = (x.size - length) // hop + 1
    if count < 16:
        return []
    starts = np.arange(count) * hop
    phase, size = _pieces(x, frequency, starts, length=length)
    # from two pieces before to two behind, less what the pace of both sides would make of it
    step = phase[3:-2] - phase[2:-3]
    left, right = phase[1:-4] - phase[:-5], phase[5:] - phase[4:-1]
    wide = phase[4:-1] - phase[1:-4] - 1.5 * (left + right)
    wide = wide - np.rint(wide)
    scatter = 1.4826 * float(np.median(np.abs(wide - np.median(wide))))
    # where the speed changes so does the pace: that makes up to its whole change between hops
    bent = np.abs(right - left)
    bent = np.max(np.lib.stride_tricks.sliding_window_view(np.pad(bent, 2), 5), axis=-1)
    calm = size[2:-3] > 0.3 * np.median(size)
    found: list[int] = []
    threshold = max(_JUMP, 8.0 * scatter)
    order = np.argsort(-np.abs(wide))
    for place in order:
        if abs(wide[place]) <= threshold:
            break
        if abs(wide[place]) <= threshold + bent[place]:
            continue
        at = int(starts[place + 2] + (length + hop) // 2)
        if (calm[place] or abs(step[place]) > _JUMP) and all(
            abs(at - other) > 4 * length for other in found
        ):
            found.append(at)
    return [at for at in sorted(found) if _sharp(x, frequency, at, cycles)]


def _sharp(x: Floats, frequency: float, at: int, cycles: float) -> bool:
    """Whether the phase steps near ``at`` from one short piece to the next but one, too.

    On each side of it a straight line and waves of the shaft, of which ``cycles`` hold three turns,
    are fitted. True where noise hides a step.
    """
    length = int(np.ceil(max(cycles / (3 * _PARTS), _SHORT) / frequency))
    reach = int(np.ceil(3.0 * cycles / frequency))
    starts = np.arange(max(0, at - reach), min(x.size, at + reach) - length + 1, length)
    phase, _ = _pieces(x, frequency, starts, length=length)
    angle = 6.0 * np.pi * frequency / cycles * (starts - at)
    waves = [wave(n * angle) for n in _RANKS for wave in (np.cos, np.sin)]
    columns = np.column_stack([np.ones(starts.size), angle, *waves])
    near = np.flatnonzero(np.abs(starts + 0.5 * length - at) < 0.5 * reach)
    best, step, beside, noise = np.inf, 0.0, 0.0, np.inf
    for cut in near[(near >= columns.shape[1]) & (near < starts.size - columns.shape[1])]:
        sides = slice(0, cut), slice(cut + 1, None)
        fits = [np.linalg.lstsq(columns[one], phase[one], rcond=None)[0] for one in sides]
        left = [phase - columns @ fit for fit in fits]
        rest = [one[side] for one, side in zip(left, sides, strict=True)]
        power = float(sum(one @ one for one in rest))
        if power < best:
            best, step = power, float(left[0][cut] - left[1][cut])
            beside = step + float(left[1][cut + 1] - left[0][cut - 1])
            bends = np.abs(np.concatenate([np.diff(one, 2) for one in rest]))
            noise = 1.4826 * float(np.median(bends)) / np.sqrt(6.0)
    step, beside = (one - np.rint(one) for one in (step, beside))
    least = max(_SHARP * abs(step), _JUMP)
    return bool(abs(beside) > least or _HIDDEN * noise > least)


def _pieces(
    x: Floats, frequency: float, starts: NDArray[np.int64], *, length: int
) -> tuple[Floats, Floats]:
    """Unwrapped phase [cycles] and size of the line in pieces of ``length`` samples."""
    weights = np.hanning(length) * np.exp(-2j * np.pi * frequency * np.arange(length))
    base = np.array([np.dot(weights, x[s : s + length]) for s in starts])
    turned = np.angle(base * np.exp(-2j * np.pi * frequency * starts))
    return np.unwrap(turned) / (2.0 * np.pi), np.abs(base)
