"""Whether a motion that does not return lies on a torus: two base frequencies, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats

HARMONICS = 96
"""Harmonics of the second base frequency of which a section is made, at most."""
TOLD_BY = 4
"""Sections at least for every number that is fitted to them."""
CURVES = 8
"""Closed curves at most that the sections visit in turn."""
FORETOLD = 1e-2
"""Share of its size to which a torus foretells itself."""
PARTS = 4
"""The base frequency is looked for down to this part of the strongest line's."""
LEAST = 1e-9
"""An error of the frequency below this is not claimed."""
LONGEST = 512
"""A second frequency p/q with q up to this is none: the motion is periodic with a long period."""


@dataclass(frozen=True, kw_only=True)
class Torus:
    """Sections z_k = sum_m c_m exp(2 pi i m nu k) of a motion with two base frequencies.

    ``frequency`` nu in cycles per period, 0 < nu <= 1/2, with its ``error``; ``foretold``: how far
    the second half of the sections is from what the first half says, over its size; the nearest
    ratio p/q, q up to :data:`LONGEST`, and the ``distance`` to it. ``curves``: a torus that began
    at an orbit of n periods meets the section in n closed curves, one after the other; then c_m is
    another one for every k mod n.
    """

    frequency: float
    error: float
    foretold: float
    ratio: tuple[int, int]
    distance: float
    curves: int = 1

    @property
    def proven(self) -> bool:
        """The section is a closed curve, and no orbit of up to :data:`LONGEST` periods."""
        return self.foretold < FORETOLD and self.distance > 4.0 * self.error

    def curve(self, sections: Floats, *, angle: Floats, which: int = 0) -> Floats:
        """The closed curve on which ``sections`` (period, d) lie, at ``angle`` -> (angle, d).

        ``angle`` nu k [cycles], 0 at the first section; the harmonics are fitted to them. Of more
        ``curves`` ``which`` is that of the section of this number, and every n-th from it.
        """
        own = sections[which :: self.curves]
        nu = self.curves * self.frequency
        count = _harmonics(nu, len(own))
        model = _fit(_lines(nu, np.arange(len(own)), count), own)
        return np.asarray(_lines(1.0, angle - which * self.frequency, count) @ model)


def torus(sections: Floats, *, unit: Floats) -> Torus | None:
    """The torus that ``sections`` (period, d) may lie on; None where they hardly move.

    nu is where the windowed sum |sum w_k z_k exp(-2 pi i nu k)| over the component that moves most,
    in its ``unit``, is greatest; a smooth window makes its error fall faster than any power of the
    length (Laskar's frequency analysis; weighted Birkhoff averages, Das and others, Nonlinearity 30
    (2017) 4111). Its error is what both halves differ by. A chaotic or a decaying motion is not
    foretold by such a sum. The fewest closed curves that foretell the sections count; each is
    measured from its own middle.
    """
    scaled = (sections - sections.mean(axis=0)) / unit
    own = scaled[:, int(scaled.std(axis=0).argmax())]
    best: Torus | None = None
    for curves in range(1, CURVES + 1):
        found = _curves(own, curves)
        if found is not None and (best is None or found.foretold < best.foretold):
            best = found
        if best is not None and best.foretold < FORETOLD:
            break
    return best


def _curves(values: Floats, curves: int) -> Torus | None:
    """The best torus that meets the section in so many ``curves``."""
    turns = values[: len(values) // (2 * curves) * 2 * curves].reshape(-1, curves)
    turns = turns - turns.mean(axis=0)
    size = turns.std()
    if size < 1e-9:
        return None
    turns = turns / size
    row = turns.ravel()
    half = len(row) // 2
    whole, first, second = (_frequency(part) for part in (row, row[:half], row[half:]))
    error = max(abs(first - second), abs(whole - first), LEAST)
    # the strongest line may be a harmonic of the base frequency
    away, parts, base = np.inf, 1, curves * whole
    for share in range(1, PARTS + 1):
        for turn in range(share):
            found = _foretold(turns, (curves * whole + turn) / share)
            if found < 0.1 * away:
                away, parts, base = found, share, (curves * whole + turn) / share
    # of the frequencies that are one on each of the curves, that of the strongest line
    among = np.mod((base + np.arange(curves)) / curves, 1.0)
    among = np.minimum(among, 1.0 - among)
    nu = float(among[int(np.abs(among - whole).argmin())])
    q = np.arange(1, LONGEST + 1)
    gaps = np.abs(nu - np.round(nu * q) / q)
    place = int(gaps.argmin())
    return Torus(
        frequency=nu,
        error=error / parts,
        foretold=away,
        ratio=(round(nu * int(q[place])), int(q[place])),
        distance=float(gaps[place]),
        curves=curves,
    )


def _foretold(turns: Floats, nu: float) -> float:
    """How far the second half of ``turns`` (k, curve) is from what the first half says."""
    half = len(turns) // 2
    lines = _lines(nu, np.arange(len(turns)), _harmonics(nu, half))
    return float(np.std(lines[half:] @ _fit(lines[:half], turns[:half]) - turns[half:]))


def _fit(lines: Floats, values: Floats) -> Floats:
    """Least squares by the normal equations: the lines are all but orthogonal."""
    model, _, _, _ = np.linalg.lstsq(lines.T @ lines, lines.T @ values, rcond=1e-10)
    return np.asarray(model)


def _harmonics(nu: float, count: int) -> int:
    """As many as ``count`` sections of a curve determine well, and tell from each other.

    Near a ratio p/q harmonics that are q apart fold to nearly one frequency: together they would
    follow a motion that fades.
    """
    most = min(HARMONICS, (count // TOLD_BY - 1) // 2)
    turns = nu * np.arange(1, 2 * max(most, 1) + 1)
    near = np.flatnonzero(np.abs(turns - np.round(turns)) < 1.0 / count)
    if near.size:
        most = min(most, int(near[0]) // 2)
    return max(most, 1)


def _lines(nu: float, k: NDArray[np.int64] | Floats, count: int) -> Floats:
    """cos and sin (period, 2 count + 1) of the harmonics of ``nu``."""
    turn = 2.0 * np.pi * nu * np.multiply.outer(k, np.arange(1, count + 1))
    return np.hstack([np.ones((len(k), 1)), np.cos(turn), np.sin(turn)])


def _frequency(values: Floats) -> float:
    """Cycles a step of the strongest line of ``values``."""
    from scipy.optimize import minimize_scalar  # slow to import, seldom needed

    count = values.size
    window = smooth_window(count)
    own = window * (values - float(window @ values))
    size = np.abs(np.fft.rfft(own, 4 * count))
    # beside the line at zero, which the window makes some bins wide
    size[:12] = 0.0
    coarse = float(size.argmax()) / (4 * count)

    def less(nu: float) -> float:
        wave: NDArray[np.complex128] = np.exp(-2j * np.pi * nu * np.arange(count))
        return -float(np.abs(own @ wave))

    found = minimize_scalar(
        less, bounds=(coarse - 0.5 / count, coarse + 0.5 / count), method="bounded",
        options={"xatol": 1e-13},
    )  # fmt: skip
    return float(found.x)


def smooth_window(count: int) -> Floats:
    """Weights w of a mean over a record that falls to nothing, and smoothly, at both ends.

    w(t) ~ exp(-1/(t (1 - t))), 0 < t < 1: the mean of what turns with fixed frequencies comes to
    its limit faster than any power of the length (Das and others, see :func:`torus`).
    """
    t = (np.arange(count) + 0.5) / count
    window = np.exp(-1.0 / (t * (1.0 - t)))
    return np.asarray(window / window.sum())
