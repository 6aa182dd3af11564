"""What is beside a line that was not followed and may be its own: pairs at equal distances."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from thermogear.signals.interval import APART, REACH, SIDE, Reading
from thermogear.signals.lines import LineSpectrum
from thermogear.signals.strong import UNEVEN, Strong, dirichlet, twins

AS_FAR = 3.0
"""Times the distance of the first sidebands, up to which is looked."""
CLEAR = 3
"""Bins of a line's own lobe, Hann's window."""
_HANN = 1.5  # bins, noise bandwidth
_SUM = 50  # bins of the sum that is the transform at a line's own place
_SEEN = 2.0  # times the noise of a lobe in Q: three of its standard deviations
_FAR = 0.3  # of the line's power
_NOISE = 25.0  # times that of a bin, in the five of a lobe: hardly by chance


def unfollowed(
    spectrum: LineSpectrum, reading: Reading, beside: Sequence[float], strong: Sequence[Strong]
) -> tuple[float, float]:
    """Power beside a line that its reading lacks and that may be its own, of its power; and by how
    much its turns over time may differ from its place.

    A phase or an amplitude that oscillates makes lines at equal distances to both sides: they count
    where both stand out of the noise, the one at most ten times the other. Where all power beside
    is more than the line's, the line may be one of those, and all counts. Without a known shaft
    (``beside``) sidebands are not told from it. Looked for up to three times the distance of the
    first.
    """
    own, width = reading.amplitude**2, spectrum.bin_width
    middle = round(reading.frequency / width)
    apart = np.abs(np.asarray(beside) - reading.frequency) / width
    first = float(apart.min(initial=np.inf))
    reach = min(AS_FAR * first, middle - 1, spectrum.hann.size - 1 - middle)
    away = np.arange(CLEAR, max(int(reach), CLEAR) + 1)
    if own <= 0.0 or not beside or away.size < CLEAR:
        return 0.0, 0.0
    above, below, steady = _beside_place(spectrum, reading.frequency / width, int(away[-1]))
    sides = np.abs(above[CLEAR - 1 :]), np.abs(below[CLEAR - 1 :])
    level = float(np.median(np.concatenate(sides) ** 2)) / float(np.log(2.0))
    level = max(level, reading.noise**2)
    # own sidebands at both sides are left out
    steps = np.arange(1, above.size + 1)
    off = np.abs(steps - np.rint(steps / first) * first)
    off = np.minimum(off, np.abs(steps[:, None] - apart).min(axis=-1))
    lobe = np.ones(2 * CLEAR - 1)
    up, down, odd = (
        np.convolve(np.where(off < CLEAR, 0.0, np.abs(one) ** 2), lobe, mode="same")
        for one in (above, below, (above - below) / np.sqrt(2.0))
    )
    up, down = up[away - 1], down[away - 1]
    least, most, noise = np.minimum(up, down), np.maximum(up, down), _NOISE * level
    each = _highest(np.where(least > np.maximum(noise, most / UNEVEN), up + down, 0.0), away)
    everything = _highest(np.where(most > noise, up + down, 0.0), away)
    hidden, unread = _next_to_sides(strong, reading.frequency / width, first)
    total = sum(each.values()) + hidden
    if total == 0.0 and reading.pairs == 0.0 and sum(everything.values()) < own:
        return 0.0, 0.0
    # amplitude is in I, phase in Q; one that turns far is in both
    turned = sum(float(odd[place - 1]) - lobe.size * level for place in each)
    if turned < _SEEN * lobe.size * level * np.sqrt(len(each)):
        turned = 0.0
    turned += hidden
    if total > _FAR * own:
        turned = total
    # a phase that oscillates by sqrt(2 turned/steady) [rad] may be at any place at both ends
    spread = float(np.sqrt(2.0 * turned / max(steady, 1e-300)) / np.pi)  # bins
    if total < own < sum(everything.values()):
        total = sum(everything.values())
        square = sum(one * place**2 for place, one in everything.items())
        spread = float(np.sqrt(square / (steady + total)))
        return max(0.0, (steady + total) / own - 1.0), spread * width
    total = reading.pairs + unread + sum(one for place, one in each.items() if place > REACH)
    return max(total / own, -_FAR), spread * width


def around(
    values: NDArray[np.float64], *, place: float, most: int, strong: Sequence[Strong], noise: float
) -> tuple[float, float, float]:
    """Power of a line at ``place`` [bins], and beyond ``noise`` of a bin what up to ``most`` bins
    beside it changes its amplitude (I), and what turns it (Q). ``strong`` lines farther off are
    taken away."""
    count = values.size
    at = np.asarray(place + np.arange(-most, most + 1), dtype=float)
    steps = np.arange(count) / count
    found = np.array([np.vdot(np.exp(2j * np.pi * one * steps), values) for one in at])
    found *= 2.0 / count
    for one in strong:
        if abs(one.place - place) > most + CLEAR:
            found -= one.amplitude * dirichlet(np.asarray(one.place - at), count)
            found -= np.conj(one.amplitude) * dirichlet(np.asarray(-one.place - at), count)
    found *= np.exp(-1j * np.angle(found[most]))
    above, below = found[most + 1 :], np.conj(found[:most][::-1])
    even, odd = (float(np.sum(np.abs(above + sign * below) ** 2)) / 2.0 for sign in (1, -1))
    level = most * noise**2
    own = max(float(np.abs(found[most])) ** 2, 1e-300)
    return own, max(even - level, 0.0), max(odd - level, 0.0)


def _next_to_sides(strong: Sequence[Strong], place: float, first: float) -> tuple[float, float]:
    """Power of pairs of lines next to sidebands of a line at ``place``, each ``first`` [bins] from
    the last: at equal distances, but no whole number of ``first``. And what of it a reading has
    not among its pairs."""
    power = unread = 0.0
    for one, other in twins(strong, place):
        away = one.place - place
        off = abs(away - np.rint(away / first) * first)
        if away > 0.5 * first and APART < off < CLEAR:
            both = abs(one.amplitude) ** 2 + abs(other.amplitude) ** 2
            power += both
            unread += both if off < SIDE or away > REACH else 0.0
    return power, unread


def _beside_place(
    spectrum: LineSpectrum, place: float, most: int
) -> tuple[NDArray[np.complex128], NDArray[np.complex128], float]:
    """A line at ``place`` [bins] and what is 1 .. ``most`` and half a lobe beside it.

    Above it and, conjugate, below, turned by the line's phase: Hann's window, powers that of noise
    in a bin. And the power of the line itself, without a window.
    """
    reach = most + CLEAR  # one more for the window
    middle = round(place)
    bins = np.arange(middle - reach - _SUM, middle + reach + _SUM + 1)
    inside = (bins >= 0) & (bins < spectrum.lines.size)
    lines = np.zeros(bins.size, dtype=complex)
    lines[inside] = spectrum.lines[bins[inside]]
    beyond = np.arange(-_SUM, _SUM + 1) - (place - middle)
    kernel = np.exp(1j * np.pi * beyond) * np.sinc(beyond)
    plain = np.convolve(lines, kernel[::-1], mode="valid")
    hann = plain[1:-1] - 0.5 * (plain[2:] + plain[:-2])
    own = plain.size // 2
    turned = hann * np.exp(-1j * np.angle(plain[own])) / np.sqrt(_HANN)
    own -= 1
    above, below = turned[own + 1 :], np.conj(turned[:own][::-1])
    return above, below, float(np.abs(plain[own + 1]) ** 2)


def _highest(power: NDArray[np.float64], away: NDArray[np.int64]) -> dict[int, float]:
    """Power of lines ``away`` [bins], the highest first, none beside another."""
    found: dict[int, float] = {}
    for place in np.argsort(-power):
        if power[place] <= 0.0:
            break
        if all(abs(away[place] - other) >= 2 * CLEAR - 1 for other in found):
            found[int(away[place])] = float(power[place])
    return found
