"""Tooth pairs as one spring each, over the mesh phase: what crosses from gears to dynamics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PairSprings:
    """The tooth pairs of one flank side, each a spring that pushes only.

    F = sum_j k_j(psi) <delta + S_j(psi)>_+,   psi = frac(offset + direction phi)

    ``stiffness`` k_j [N/m] >= 0 and ``added`` S_j [m] (added material: a pair touches at
    delta = -S_j), arrays (pair, samples + 1) at uniform psi from 0 to 1; pair j at psi = 1 is
    pair j + 1 at psi = 0, so that the sum is periodic. Between samples both are linear.
    ``direction`` +1 for drive flanks; -1 for back flanks, which run along the path backwards.
    """

    stiffness: Floats
    added: Floats
    offset: float = 0.0
    direction: int = 1

    def __post_init__(self) -> None:
        k = np.array(self.stiffness, dtype=float)
        s = np.array(self.added, dtype=float)
        if k.ndim != 2 or k.shape != s.shape or k.shape[1] < 2:
            raise InputError(
                "pair_springs", f"{k.shape} and {s.shape}", allowed="two arrays (pair, samples + 1)"
            )
        if not (np.all(np.isfinite(k)) and np.all(np.isfinite(s)) and np.all(k >= 0.0)):
            raise InputError("pair_springs", "a value", allowed="finite, stiffness >= 0")
        if self.direction not in (-1, 1):
            raise InputError("pair_springs.direction", self.direction, allowed="1 | -1")
        k.setflags(write=False)
        s.setflags(write=False)
        object.__setattr__(self, "stiffness", k)
        object.__setattr__(self, "added", s)

    @classmethod
    def from_samples(
        cls, stiffness: ArrayLike, added: ArrayLike, *, offset: float = 0.0, direction: int = 1
    ) -> PairSprings:
        """From arrays (pair, samples) over one period; the closing column is the next pair's.

        The last pair leaves: its stiffness ends at 0.
        """
        k, s = (np.asarray(values, dtype=float) for values in (stiffness, added))
        closing = np.append(k[1:, 0], 0.0)
        closing_added = np.append(s[1:, 0], s[-1, -1])
        return cls(
            np.column_stack([k, closing]), np.column_stack([s, closing_added]), offset, direction
        )

    @property
    def pairs(self) -> int:
        """Number of tooth pairs that may carry at once."""
        return int(self.stiffness.shape[0])

    def at(self, phase: ArrayLike) -> tuple[Floats, Floats]:
        """k_j and S_j at ``phase`` (mesh periods, any shape): arrays (pair, phase...)."""
        psi = np.mod(self.offset + self.direction * np.asarray(phase, dtype=float), 1.0)
        place = psi * (self.stiffness.shape[1] - 1)
        left = np.minimum(place.astype(np.int64), self.stiffness.shape[1] - 2)
        weight = place - left
        k, s = self.stiffness, self.added
        return (
            k[:, left] + weight * (k[:, left + 1] - k[:, left]),
            s[:, left] + weight * (s[:, left + 1] - s[:, left]),
        )

    def force(self, deflection: ArrayLike, phase: ArrayLike) -> Floats:
        """F [N] >= 0 at ``deflection`` delta [m] and ``phase``, which broadcast."""
        delta, phi = np.broadcast_arrays(
            np.asarray(deflection, dtype=float), np.asarray(phase, dtype=float)
        )
        k, s = self.at(phi)
        return np.asarray(np.sum(k * np.maximum(delta + s, 0.0), axis=0))

    def stiffness_at(self, deflection: ArrayLike, phase: ArrayLike) -> Floats:
        """dF/d delta [N/m]: the sum over the pairs that carry."""
        delta, phi = np.broadcast_arrays(
            np.asarray(deflection, dtype=float), np.asarray(phase, dtype=float)
        )
        k, s = self.at(phi)
        return np.asarray(np.sum(np.where(delta + s > 0.0, k, 0.0), axis=0))

    def deflection(self, force: ArrayLike, phase: ArrayLike) -> Floats:
        """delta [m] at which the pairs carry ``force`` > 0 [N]: the inverse of :meth:`force`.

        Between the touches the force is straight, so the answer is exact; nan where no pair has
        any stiffness.
        """
        load, phi = np.broadcast_arrays(
            np.asarray(force, dtype=float), np.asarray(phase, dtype=float)
        )
        k, s = self.at(phi)
        order = np.argsort(-np.where(k > 0.0, s, -np.inf), axis=0, kind="stable")
        k, s = np.take_along_axis(k, order, axis=0), np.take_along_axis(s, order, axis=0)
        total = np.cumsum(k, axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            delta = (load - np.cumsum(k * s, axis=0)) / total
        # as many pairs carry as touch before the load is reached
        later = np.concatenate(
            [np.where(k[1:] > 0.0, s[1:], -np.inf), np.full_like(s[:1], -np.inf)]
        )
        enough = (total > 0.0) & (delta + later <= 0.0)
        place = np.argmax(enough, axis=0)[None]
        found = np.take_along_axis(delta, place, axis=0)[0]
        return np.asarray(np.where(enough.any(axis=0), found, np.nan))
