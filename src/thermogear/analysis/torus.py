"""Whether a motion that does not return lies on a torus: two base frequencies, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

HARMONICS = 24
"""Harmonics of the second base frequency of which a section is made."""
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
    ratio p/q, q up to :data:`LONGEST`, and the ``distance`` to it.
    """

    frequency: float
    error: float
    foretold: float
    ratio: tuple[int, int]
    distance: float

    @property
    def proven(self) -> bool:
        """The section is a closed curve, and no orbit of up to :data:`LONGEST` periods."""
        return self.foretold < FORETOLD and self.distance > 4.0 * self.error

    def curve(self, sections: Floats, *, angle: Floats) -> Floats:
        """The closed curve on which ``sections`` (period, d) lie, at ``angle`` -> (angle, d).

        ``angle`` nu k [cycles], 0 at the first section; the harmonics are fitted to them.
        """
        model, _, _, _ = np.linalg.lstsq(
            _lines(self.frequency, np.arange(len(sections))), sections, rcond=None
        )
        return np.asarray(_lines(1.0, angle) @ model)


def torus(sections: Floats, *, unit: Floats) -> Torus | None:
    """The torus that ``sections`` (period, d) may lie on; None where they hardly move.

    nu is where the windowed sum |sum w_k z_k exp(-2 pi i nu k)| over the component that moves most,
    in its ``unit``, is greatest; a smooth window makes its error fall faster than any power of the
    length (Laskar's frequency analysis; weighted Birkhoff averages, Das and others, Nonlinearity 30
    (2017) 4111). Its error is what both halves differ by. A chaotic or a decaying motion is not
    foretold by such a sum.
    """
    scaled = (sections - sections.mean(axis=0)) / unit
    most = int(scaled.std(axis=0).argmax())
    if scaled[:, most].std() < 1e-9:
        return None
    half = len(scaled) // 2
    whole, first, second = (
        _frequency(part[:, most]) for part in (scaled, scaled[:half], scaled[half : 2 * half])
    )
    error = max(abs(first - second), abs(whole - first), LEAST)
    own = scaled[:, most] / scaled[:, most].std()
    # the strongest line may be a harmonic of the base frequency
    away, parts = np.inf, 1
    for share in range(1, PARTS + 1):
        for turn in range(share):
            found = _foretold(own, (whole + turn) / share)
            if found < 0.1 * away:
                away, parts, base = found, share, (whole + turn) / share
    whole = min(base % 1.0, 1.0 - base % 1.0)
    error /= parts
    q = np.arange(1, LONGEST + 1)
    gaps = np.abs(whole - np.round(whole * q) / q)
    place = int(gaps.argmin())
    return Torus(
        frequency=whole,
        error=error,
        foretold=away,
        ratio=(round(whole * int(q[place])), int(q[place])),
        distance=float(gaps[place]),
    )


def _foretold(own: Floats, nu: float) -> float:
    """How far the second half of ``own`` is from what the first half says, at ``nu``."""
    half = own.size // 2
    model, _, _, _ = np.linalg.lstsq(_lines(nu, np.arange(half)), own[:half], rcond=None)
    told = _lines(nu, np.arange(half, 2 * half)) @ model
    return float(np.std(told - own[half : 2 * half]))


def _lines(nu: float, k: NDArray[np.int64] | Floats) -> Floats:
    """cos and sin (period, 2 harmonics + 1) of the harmonics of ``nu``."""
    turn = 2.0 * np.pi * nu * np.multiply.outer(k, np.arange(1, HARMONICS + 1))
    return np.hstack([np.ones((k.size, 1)), np.cos(turn), np.sin(turn)])


def _frequency(values: Floats) -> float:
    """Cycles a step of the strongest line of ``values``."""
    from scipy.optimize import minimize_scalar  # slow to import, seldom needed

    count = values.size
    t = (np.arange(count) + 0.5) / count
    window = np.exp(-1.0 / (t * (1.0 - t)))
    window /= window.sum()
    own = window * (values - float(window @ values))
    size = np.abs(np.fft.rfft(own, 4 * count))
    # beside the line at zero, which the window makes some bins wide
    size[:12] = 0.0
    coarse = float(size.argmax()) / (4 * count)

    def less(nu: float) -> float:
        wave: Complexes = np.exp(-2j * np.pi * nu * np.arange(count))
        return -float(np.abs(own @ wave))

    found = minimize_scalar(
        less, bounds=(coarse - 0.5 / count, coarse + 0.5 / count), method="bounded",
        options={"xatol": 1e-13},
    )  # fmt: skip
    return float(found.x)
