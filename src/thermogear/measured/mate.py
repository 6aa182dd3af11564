"""A gear that meshes with the known one and is not known: what it may change of the mesh line."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.gearing import Gearing
from thermogear.measured.record import Notice

Floats = NDArray[np.float64]

SLOW = 12.0
"""Turns of a gear over the record: four of a mate three times as large."""
_RATIO = 3.0  # teeth of the mate over those of the known gear
_LARGEST = 8.0  # of that ratio
_FASTER = 4.0 / 3.0
_FEW = 4.0  # turns over the record, below which nothing tells a wave from what is slower
_STEP = 0.25  # turns over the record, between waves tried
_PER_TURN = 16.0  # points of the phase, of the known gear
_LINE = 5.0  # times the level beside it: so sharp is some wave of most walks, of hardly any power
_RING = 2.0, 6.0  # turns to each side
_MOST = 0.1  # of a line's power: sidebands of a fifth of it on both sides, and a little more


def known_teeth(gearing: Gearing, teeth: int | None) -> list[int]:
    """Teeth of the shafts that are decided, and those given."""
    given = [teeth] if teeth else []
    return list(dict.fromkeys([*(shaft.teeth for shaft in gearing.shafts), *given]))


def sides_of(gearing: Gearing, *, teeth: int | None, rank: int, mesh: float) -> tuple[float, ...]:
    """Where the shafts' sidebands of a mesh harmonic stand, ``mesh`` in any unit."""
    return tuple(
        mesh * (rank + sign * n / z)
        for z in known_teeth(gearing, teeth)
        for n in (1, 2, 3)
        for sign in (-1, 1)
    )


def may_be_slow(gearing: Gearing, *, teeth: int | None, samples: int) -> bool:
    """Whether one gear alone is known, and a mate of up to three times its teeth would turn fewer
    than four times in the record."""
    known = known_teeth(gearing, teeth)
    return len(known) == 1 and gearing.mesh_frequency * samples < SLOW * known[0]


def told_of_mate(gearing: Gearing, *, teeth: int | None, samples: int) -> list[Notice]:
    """What a slower mate that is not known would change."""
    known = known_teeth(gearing, teeth)
    if len(known) != 1:
        return []
    (own,) = known
    turns = gearing.mesh_frequency * samples / own
    if turns >= _LARGEST * _FEW:
        return []
    if turns >= SLOW:
        least = gearing.mesh_frequency * samples / _FEW
        text = (
            f"the record holds {turns:.3g} turns of the gear of {own} teeth; what a mate that is "
            f"not known, of more than {least:.0f} teeth, changes of the mesh line counts as the "
            "line's own: it turned fewer than four times"
        )
        return [Notice("info", text)]
    return [
        Notice(
            "warning",
            f"the record holds {turns:.3g} turns of the gear of {own} teeth, and fewer of a larger "
            "mate, which is not known: below four of them its sidebands are no lines of their own. "
            "The mesh lines' half widths hold what those of a fifth may bring, of a mate of up to "
            "three times as many teeth; a sideband's do not "
            "where one of the mate stands beside it (a record "
            f"{SLOW / turns:.2g} times as long tells them apart)",
        )
    ]


class Wave(NamedTuple):
    """What of a line's phase a gear may be that is not known: ``power`` of its sidebands, over the
    line's; its ``turns`` over the record; whether it is ``sharp``, well above what is beside it."""

    power: float
    turns: float
    sharp: bool

    def words(self, cycles: float) -> str:
        """What is said of a sharp one, after what is said of the phase of so many ``cycles``."""
        if not self.sharp:
            return ""
        return (
            f"; the phase oscillates {self.turns:.3g} times over the record, as a gear of about "
            f"{cycles / self.turns:.0f} teeth would turn it: the intervals hold both"
        )


def wave_of_mate(cycles: Floats, nearest: float) -> Wave:
    """The wave in a line's phase that a gear may make which is not known.

    ``cycles`` of the line at each sample, ``nearest`` turns of the known gear over them. The other
    has up to three times its teeth, or up to a fourth fewer. A phase of variance v has sidebands of
    power v. What a wave and its double hold of the phase counts: where the mate would turn four
    times or more, if it is sharp; else that of the best wave. At most 0.1 counts: sidebands of a
    fifth of the line. What the phase turns beyond is a speed that wanders.

    >>> turn = np.linspace(0.0, 40.0, 4000)
    >>> wave = wave_of_mate(20.0 * turn + 0.02 * np.sin(np.pi * turn), 40.0)
    >>> round(wave.power, 4), wave.turns, wave.sharp
    (0.0079, 20.0, True)
    """
    first, last = max(nearest / _RATIO, 1.0), _FASTER * nearest
    along = np.linspace(-0.5, 0.5, int(np.ceil(_PER_TURN * nearest)), endpoint=False)
    place = (along + 0.5) * (cycles.size - 1)
    phase = 2.0 * np.pi * np.interp(place, np.arange(cycles.size), cycles)
    if first <= _FEW:
        tried = np.arange(first, last, _STEP)
        held = _held(phase, along, tried)
        best = int(np.argmax(held))
        return Wave(min(float(held[best]), _MOST), float(tried[best]), False)
    power = _of_waves(phase, along, nearest)
    steps = np.arange(int(last / _STEP) + 1)
    held = power[steps] + power[2 * steps]
    sharp = (held > _LINE * _beside(held)) & (steps >= int(first / _STEP))
    if not np.any(sharp):
        return Wave(0.0, 0.0, False)
    best = int(np.argmax(np.where(sharp, held, 0.0)))
    itself = best if power[best] > power[2 * best] or 2 * best >= steps.size else 2 * best
    return Wave(min(float(held[best]), _MOST), _STEP * itself, True)


def _held(phase: Floats, along: Floats, tried: Floats) -> Floats:
    """Mean square of ``phase`` that each wave and its double explain, a straight line besides."""
    straight = np.stack([np.ones(along.size), along], axis=1)

    def left(columns: Floats) -> float:
        found = np.linalg.lstsq(columns, phase)[0]
        return float(np.mean((phase - columns @ found) ** 2))

    gains = []
    for turn in tried:
        angle = 2.0 * np.pi * turn * along[:, None] * np.array([1.0, 2.0])
        gains.append(left(np.concatenate([straight, np.cos(angle), np.sin(angle)], axis=1)))
    return left(straight) - np.asarray(gains)


def _of_waves(phase: Floats, along: Floats, nearest: float) -> Floats:
    """Mean square of waves of 0, 1, 2 .. steps, Hann's window; those of the known gear left out."""
    own = 2.0 * np.pi * nearest * along[:, None] * np.array([1.0, 2.0, 3.0])
    known = np.concatenate(
        [np.ones((along.size, 1)), along[:, None], np.cos(own), np.sin(own)], axis=1
    )
    weight = np.cos(np.pi * along)
    rest = phase - known @ np.linalg.lstsq(known * weight[:, None], phase * weight)[0]
    steps = np.fft.rfft(weight**2 * rest, n=round(along.size / _STEP))
    return np.asarray(2.0 * np.abs(steps / np.sum(weight**2)) ** 2)


def _beside(held: Floats) -> Floats:
    """Level of what waves hold that are two to six turns slower or faster than each.

    The mean of the logarithm follows the steep spectrum of a speed that walks, whose doubles are
    low; of noise in one wave it is e^-0.58 of the mean.
    """
    near, far = (round(one / _STEP) for one in _RING)
    ring = np.ones(2 * far + 1)
    ring[far - near + 1 : far + near] = 0.0
    logs = np.log(np.maximum(held, 1e-300))
    sums, counts = (
        np.convolve(one, ring)[far : far + held.size] for one in (logs, np.ones(held.size))
    )
    return np.asarray(np.exp(sums / np.maximum(counts, 1.0) + 0.577))
