"""The strongest lines of a spectrum, and what a line shows in the bins about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermogear.base.arrays import Complexes, Floats
from thermogear.signals.lines import LineSpectrum, floor_around, hann_offset

MOST = 60
"""Strong lines of a spectrum whose leakage is taken away."""
UNEVEN = 10.0
"""Of the powers of two lines that one change may make."""
_EVEN = 0.3  # bins, by which two distances may differ


@dataclass(frozen=True)
class Strong:
    """A line whose leakage is taken away: ``place`` [bins], complex peak ``amplitude``."""

    place: float
    amplitude: complex


def dirichlet(offset: Floats, samples: int) -> Complexes:
    """What a line of amplitude 1 shows ``offset`` bins below it, no window, N ``samples``.

    D(u) = (1/N) sum_n exp(2 pi i u n/N) = exp(i pi u (N-1)/N) sin(pi u)/(N sin(pi u/N)).

    >>> np.abs(dirichlet(np.array([0.0, 0.5, 1.0]), 1000)).round(3)
    array([1.   , 0.637, 0.   ])
    """
    u = np.asarray(offset, dtype=float)
    low = samples * np.sin(np.pi * u / samples)
    near = np.abs(low) < 1e-9
    size = np.where(near, 1.0, np.sin(np.pi * u) / np.where(near, 1.0, low))
    return np.asarray(np.exp(1j * np.pi * u * (samples - 1) / samples) * size)


def shown(places: Floats, *, bins: Floats, samples: int) -> Complexes:
    """What lines of amplitude 1 at ``places`` [bins] show at whole ``bins``: (bin, place).

    :func:`dirichlet` of place - bin, where f, the place beyond its nearest bin, is one of all bins:
    D(u) = exp(i pi f) sin(pi f)/N (cot(pi u/N) - i).

    >>> seen = shown(np.array([7.0, 7.5]), bins=np.array([6.0, 7.0]), samples=1000)
    >>> np.abs(seen).round(3).tolist()
    [[0.0, 0.212], [1.0, 0.637]]
    """
    beyond = places - np.rint(places)
    factor = np.exp(1j * np.pi * beyond) * np.sin(np.pi * beyond) / samples
    offset = places[None, :] - bins[:, None]
    own = np.abs(offset) < 1e-9
    tangent = np.tan(np.pi / samples * np.where(own, 1.0, offset))
    return np.asarray(np.where(own, 1.0, factor * (1.0 / tangent - 1j)))


def hann_at(offset: Floats, samples: int) -> Complexes:
    """What a line of amplitude 1 shows ``offset`` bins below it, Hann's window.

    D(u) - (D(u - 1) + D(u + 1))/2.

    >>> np.abs(hann_at(np.array([0.0, 0.5, 1.0, 2.0]), 1000)).round(3)
    array([1.   , 0.849, 0.5  , 0.   ])
    """
    u = np.asarray(offset, dtype=float)
    below, above = dirichlet(u - 1.0, samples), dirichlet(u + 1.0, samples)
    return np.asarray(dirichlet(u, samples) - 0.5 * (below + above))


def strong_lines(spectrum: LineSpectrum, most: int = MOST) -> tuple[Strong, ...]:
    """The strongest lines, four bins or more apart, each six times over its floor (Hann window).

    Each is taken away with its skirts before the next is looked for.

    >>> t = np.arange(1000) / 1000.0
    >>> from thermogear.signals.lines import line_spectrum
    >>> x = np.cos(2 * np.pi * 50.3 * t) + 0.1 * np.cos(2 * np.pi * 80 * t)
    >>> [f"{one.place:.1f}" for one in strong_lines(line_spectrum(x, 1000.0), 2)]
    ['50.3', '80.0']
    """
    left = spectrum.in_hann().copy()
    size, count = np.abs(left), left.size
    open_to = size > 3.0 * _rough_floor(size)
    open_to[:3] = open_to[-3:] = False
    tops = np.flatnonzero(open_to)
    found: list[Strong] = []
    for _ in range(3 * most if tops.size else 0):
        peak = int(tops[np.argmax(np.where(open_to[tops], size[tops], 0.0))])
        if len(found) == most or not open_to[peak] or size[peak] <= 0.0:
            break
        open_to[max(0, peak - 3) : peak + 4] = False
        if size[peak] <= 6.0 * floor_around(size, peak, lobe=4):
            continue  # a peak of noise: weaker lines may be clear elsewhere
        offset = hann_offset(size[peak - 1 : peak + 2])
        value = complex(left[peak]) / complex(hann_at(np.array([offset]), spectrum.samples)[0])
        low, high = max(0, peak - 60), min(count, peak + 61)
        bins = np.arange(low, high, dtype=np.float64)
        left[low:high] -= value * hann_at((peak + offset) - bins, spectrum.samples)
        size[low:high] = np.abs(left[low:high])
        found.append(Strong(peak + offset, value))
    return tuple(found)


def twins(lines: Sequence[Strong], place: float) -> list[tuple[Strong, Strong]]:
    """Pairs of lines at equal distances above and below ``place`` [bins], of like height: the
    greater has at most ten times the power.

    >>> lines = [Strong(40.0, 1.0), Strong(43.1, 0.1j), Strong(36.9, 0.1)]
    >>> [(above.place, below.place) for above, below in twins(lines, 40.0)]
    [(43.1, 36.9)]
    """
    found = []
    for one in lines:
        for other in lines:
            powers = abs(one.amplitude) ** 2, abs(other.amplitude) ** 2
            even = place < one.place and abs(one.place + other.place - 2.0 * place) < _EVEN
            if even and max(powers) < UNEVEN * min(powers):
                found.append((one, other))
    return found


def _rough_floor(size: Floats, block: int = 128) -> Floats:
    """Medians of blocks, at each bin."""
    whole = max(1, size.size // block) * block
    floors = np.median(size[:whole].reshape(-1, min(block, size.size)), axis=1)
    return np.asarray(np.append(np.repeat(floors, block), np.full(block, floors[-1]))[: size.size])
