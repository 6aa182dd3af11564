"""What a fitted line leaves in the bins beside it: powers of I and Q, and their noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

NEAR = 6
"""Bins on each side in which a neighbour is looked for."""

_CLEARLY = 2.5
_INNER = 6
"""Bins nearest to a line, in which a change stands out first."""
_ROUNDS = 8
_NOISE = 25.0


@dataclass(frozen=True, kw_only=True)
class Left:
    """What the fit leaves beside the line, m = 1.. bins off: powers of I and Q, of each side."""

    even: Floats
    odd: Floats
    shares: tuple[Floats, Floats]  # of noise of power 1 in a bin, what the fit leaves in I and Q
    noise: float  # power in one bin, typical of those beside
    here: float  # power in one bin at the line
    degrees: float  # of freedom behind ``here``
    crowded: bool  # by a much higher line, whose skirts fill I and Q alike
    others: float  # power of I and Q next to known lines, taken for what others have there
    places: Floats  # of the finer grid on which a neighbour is looked for [bins from the line]
    finer: Floats  # power there

    @property
    def near(self) -> float:
        """Power beyond noise within the bins in which a neighbour is looked for."""
        reach = min(NEAR, self.even.size)
        total = np.sum(self.even[:reach]) + np.sum(self.odd[:reach])
        own = sum(float(np.sum(share[:reach])) for share in self.shares)
        return float(max(total - own * self.noise, 0.0))

    @property
    def shared(self) -> float:
        """Power near the line that I and Q have in the same bins, as a further line's would be."""
        quiet = np.minimum(self.even, self.odd)[:NEAR] - 4.0 * self.noise
        return float(2.0 * np.sum(np.maximum(quiet, 0.0)))

    @property
    def change(self) -> float:
        """Power of I beyond noise, of either sign; of a crowded line beyond that of Q as well."""
        even, odd = self._beyond()
        return even - max(odd, 0.0) if self.crowded else even

    @property
    def changed(self) -> float:
        """Power of I beyond noise, 0 where it is within four of its standard deviations."""
        return self._clearly(self.change, self.even.size)

    @property
    def turned(self) -> float:
        """Power of Q beyond noise, 0 where it is within four of its standard deviations."""
        even, odd = self._beyond()
        return self._clearly(odd - max(even, 0.0) if self.crowded else odd, self.odd.size)

    def _beyond(self) -> tuple[float, float]:
        return (
            float(np.sum(self.even) - np.sum(self.shares[0]) * self.noise),
            float(np.sum(self.odd) - np.sum(self.shares[1]) * self.noise),
        )

    def _clearly(self, extra: float, size: int) -> float:
        return extra if extra > 4.0 * self.noise * np.sqrt(size) else 0.0


def without_others(powers: Floats, known: NDArray[np.bool_], noise: float) -> tuple[Floats, float]:
    """``powers`` of I or Q without what rises next to ``known`` lines, and how much that is.

    A change has as much there as in the bins about; another line next to a known one shows there
    alone. It counts where in all it is above 25 times the ``noise`` of a bin, hardly by chance.

    >>> powers, known = np.ones(9), np.zeros(9, dtype=bool)
    >>> powers[3:6], known[3:6] = (5.0, 60.0, 5.0), True
    >>> level, others = without_others(powers, known, 1.0)
    >>> level.tolist() == [1.0] * 9, others
    (True, 67.0)
    """
    if known.all() or not known.any():
        return powers, 0.0
    place = np.arange(powers.size)
    about = np.interp(place, place[~known], powers[~known])
    level = np.where(known, np.minimum(powers, np.maximum(about, noise)), powers)
    others = float(np.sum(powers - level))
    return (level, others) if others > _NOISE * noise else (powers, 0.0)


def noise_beside(
    powers: tuple[Floats, Floats], *, shares: tuple[Floats, Floats], followed: float
) -> tuple[float, float, float]:
    """Power of noise in one bin beside a line, in one at the line, and the latter's degrees of
    freedom, from ``powers`` of I and Q.

    Each is divided by the share of noise that the fit leaves there; where that is less than half
    it is left aside. Medians over bins, so that single lines count little: ln 2 of the
    mean where it is noise. Q of bins nearer than ``followed`` has been taken away with the phase.
    Both together, unless one is 2.5 times the other: then the quieter, because a change fills one
    alone; likewise the outer half of its bins, because a change fills the inner ones first. What
    shows in the inner bins alone are skirts: the record's ends cut a change, which leaves power
    that falls with the square of the distance. They are fitted and taken away.

    Noise of a resonance is not level. I and Q hold both sides alike, so a slope cancels and
    a + c m^2 is left: of the inner and the outer half of the bins, mean m^2 (r/2)^2/3 and 7 times
    that, the median powers p and q give a = (7 p - q)/6.

    >>> quiet, whole = np.full(40, np.log(2.0)), np.ones(40)
    >>> level, at_line, degrees = noise_beside((quiet, quiet), shares=(whole, whole), followed=0.0)
    >>> round(level, 9), round(at_line, 9), round(degrees)
    (1.0, 1.0, 27)
    """
    first = 1 if powers[0].size > 3 else 0  # a slow change is in the first
    starts = first, max(first, int(np.ceil(followed)))
    (one, steps), (two, others) = (
        _whole(power, share, start)
        for power, share, start in zip(powers, shares, starts, strict=True)
    )
    if two.size < 4:
        return _level(_outer(one))
    count = one.size + two.size
    one, two = _without_skirts(one, steps, two), _without_skirts(two, others, one)
    if max(_median(one), _median(two)) > _CLEARLY * min(_median(one), _median(two)):
        return _level(min(_outer(one), _outer(two)))
    joined = np.concatenate([one, two])
    fitted = count - joined.size
    far = np.concatenate([one[one.size // 2 :], two[two.size // 2 :]])
    if far.size >= 16 and _median(joined) > 2.0 * _median(far):
        return _level((_median(far), float(far.size)))
    if far.size < 16:
        return _level((_median(joined), float(joined.size)))
    near = np.concatenate([one[: one.size // 2], two[: two.size // 2]])
    here = (7.0 * _median(near) - _median(far)) / 6.0
    # skirts fitted to some bins scatter as if twice as many were lost (seen in drawn noise)
    degrees = 36.0 / (49.0 / max(near.size - 2 * fitted, 1) + 1.0 / far.size)
    return _median(joined), max(here, 0.5 * _median(joined)), degrees


def _level(found: tuple[float, float]) -> tuple[float, float, float]:
    noise, degrees = found
    return noise, noise, degrees


def _whole(powers: Floats, shares: Floats, start: int) -> tuple[Floats, Floats]:
    """Powers of noise that the fit leaves whole, from bin ``start`` on, and their distances."""
    kept = shares[start:] >= 0.5
    if np.count_nonzero(kept) < min(4, kept.size):
        kept[:] = True
    distances = np.arange(1.0, powers.size + 1.0)[start:][kept]
    return powers[start:][kept] / np.maximum(shares[start:][kept], 0.1), distances


def _without_skirts(powers: Floats, distances: Floats, other: Floats) -> Floats:
    """``powers`` of I or Q, noise n alone, where a change has skirts a/m^2 in the inner bins.

    That is where the inner bins have 2.5 times the power of the ``other``'s. In turn a, by which
    the inner ones would be p/(1/m^2 + n/a), and n, by the outer half p/(1 + a/(n m^2)) and
    the other; the inner ones, which tell of the skirts, are left out.
    """
    if min(powers.size, other.size) < 2 * _INNER:
        return powers
    inner = powers[:_INNER]
    if _median(inner) <= _CLEARLY * _median(other[:_INNER]):
        return powers
    square = distances**2
    noise = _median(np.concatenate([other, powers[powers.size // 2 :]]))
    skirts = _median(inner * square[:_INNER])
    for _ in range(_ROUNDS):
        skirts = _median(inner / (1.0 / square[:_INNER] + noise / skirts))
        level = powers / (1.0 + skirts / (noise * square))
        noise = _median(np.concatenate([other, level]))
    return level[_INNER:]


def _outer(powers: Floats) -> tuple[float, float]:
    """Noise from all bins or, where it is clearly less, from the outer half; degrees of freedom."""
    outer = powers[powers.size // 2 :]
    if outer.size >= 8 and _median(powers) > _CLEARLY * _median(outer):
        return _median(outer), float(outer.size)
    return _median(powers), float(powers.size)


def _median(powers: Floats) -> float:
    return float(max(np.median(powers) / np.log(2.0), 1e-300)) if powers.size else 1e-300
