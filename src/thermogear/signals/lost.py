"""Where samples are lost inside a record: a line's phase jumps there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_JUMP = 0.06  # cycles
_PIECES = 12  # at least, to tell one step in
_SHARP = 0.75  # of a step, between the pieces beside it
_PARTS = 8  # pieces of a turn
_MOST_PIECES = 512
_SHORT = 4.0  # cycles of the line, the shortest piece
_HIDDEN = 6.0  # times the noise of a piece: a step that is lost in it
_RANKS = (1, 2, 3)  # of a shaft
_STEPS = 12.0  # standard errors of a step; fewer are made by a speed that walks


def phase_jumps(x: Floats, frequency: float, *, cycles: float = 24.0) -> list[int]:
    """Samples at which the line of ``frequency`` [cycles/sample] jumps in phase: samples lost.

    The phase of pieces of ``cycles``, each half over the next, less its smooth course: a jump
    is between two that are each steady, and is far larger than their scatter; or the only one, in a
    phase that is straight on both sides of it. It is one in pieces of a twenty-fourth, too, where
    noise lets that be seen: a slower shaft, not known, turns the phase as far, but smoothly. Fewer
    than 16 pieces tell nothing. Of a mesh line take three turns of the shaft, so that its sidebands
    do not turn the phase.

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
    found = [at for at in sorted(found) if _sharp(x, frequency, at, cycles)]
    if found:
        return found
    place = _one_step(phase[::2])
    return [] if place is None else [int(starts[2 * place]) + length // 2]


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


def phase_step(x: Floats, frequency: float, turns: Sequence[float]) -> tuple[int, int] | None:
    """The one sample at which the line of ``frequency`` [cycles/sample] steps in phase, and within
    how many samples; None: nowhere.

    ``turns``: cycles of the line in a turn of each shaft, whose sidebands turn the phase three
    times a turn and slower: that is fitted with the step, so that a few turns are enough. Range:
    sidebands are small beside the line, the speed is steady on both sides.

    >>> n = np.arange(4000)
    >>> lost = np.where(n < 2300, n, n + 104)
    >>> x = (1 + 0.2 * np.cos(2 * np.pi * 0.1 / 40 * lost)) * np.cos(2 * np.pi * 0.1 * lost)
    >>> phase_step(x, 0.1, [40.0])
    (2275, 50)
    """
    length = int(np.ceil(min(turns) / _PARTS / frequency))
    starts = np.arange(x.size // length) * length
    if length < 3 or starts.size > _MOST_PIECES:
        return None
    phase, _ = _pieces(x, frequency, starts, length=length)
    middles = starts + length // 2
    angles = [
        2.0 * np.pi * n * frequency / turn * middles
        for turn in dict.fromkeys(turns)
        for n in _RANKS
    ]
    place = _one_step(phase, [wave(angle) for angle in angles for wave in (np.cos, np.sin)])
    return None if place is None else (int(middles[place]), length)


def _pieces(
    x: Floats, frequency: float, starts: NDArray[np.int64], *, length: int
) -> tuple[Floats, Floats]:
    """Unwrapped phase [cycles] and size of the line in pieces of ``length`` samples."""
    weights = np.hanning(length) * np.exp(-2j * np.pi * frequency * np.arange(length))
    base = np.array([np.dot(weights, x[s : s + length]) for s in starts])
    turned = np.angle(base * np.exp(-2j * np.pi * frequency * starts))
    return np.unwrap(turned) / (2.0 * np.pi), np.abs(base)


def _one_step(phase: Floats, waves: Sequence[Floats] = ()) -> int | None:
    """The piece at which the phase [cycles] of pieces that share nothing steps, if there is one.

    Least squares by a straight line, ``waves`` and a step of any height, its piece left out:
    a step of twelve standard errors or more, from the piece before to the one behind three
    quarters of it, and what is left as good as white (its neighbours' correlation below two
    standard errors) or a twelfth of the step, so that a speed that wanders is none.
    """
    count = phase.size
    if count < _PIECES + 2 * len(waves):
        return None
    place = np.arange(count, dtype=float)
    best: tuple[float, int] | None = None
    clear = False
    for cut in range(3, count - 3):
        kept = place != cut
        columns = np.column_stack([np.ones(count), place - cut, place > cut, *waves])[kept]
        # of shafts in whole ratios some waves are the same
        fit, _, rank, _ = np.linalg.lstsq(columns, phase[kept])
        rest = phase[kept] - columns @ fit
        power = float(rest @ rest)
        if power <= 0.0 or (best is not None and power >= best[0]):
            continue
        best = power, cut
        spread = np.linalg.pinv(columns.T @ columns, hermitian=True)[2, 2]
        error = np.sqrt(power / (rest.size - rank) * spread)
        step = float(fit[2] - np.rint(fit[2]))
        alike = float(rest[1:] @ rest[:-1]) / power
        # of the pieces beside it; the one at the step is not there
        beside = float(rest[cut] - rest[cut - 1]) * np.sign(fit[2])
        sharp = beside > (_SHARP - 1.0) * abs(fit[2])
        white = alike < 2.0 / np.sqrt(rest.size) or abs(step) > _STEPS * np.sqrt(power / rest.size)
        clear = sharp and white and abs(step) > _STEPS * float(error)
    return best[1] if best is not None and clear else None
