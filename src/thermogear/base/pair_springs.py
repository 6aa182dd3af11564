"""Tooth pairs as one spring each, over the mesh phase: what crosses from gears to dynamics."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError


@dataclass(frozen=True, eq=False)
class PairSprings:
    """The tooth pairs of one flank side, each a spring that pushes only.

    F = sum_j k_j(psi) <w + S_j(psi)>_+,   psi = frac(offset + direction phi)

    ``stiffness`` k_j [N/m] >= 0 and ``added`` S_j [m] (added material: a pair touches at
    w = -S_j), arrays (pair, samples + 1) at uniform psi from 0 to 1; pair j at psi = 1 is
    pair j + 1 at psi = 0, so that the sum is periodic. Between samples both are linear.
    ``direction`` +1 for drive flanks; -1 for back flanks, which run along the path backwards.

    w is the deflection delta itself, unless ``foot`` says where the mesh truly touches first:
    an array (2, samples) of touch e and knee kappa > e [m] over the mesh phase phi. Springs that
    are right about one load miss the touch by the hardening of the contact and by what its
    neighbours bend a tooth; below the knee delta is stretched so that the force begins at e:
    w = kappa - (kappa - delta) (kappa + max_j S_j)/(kappa - e).
    """

    stiffness: Floats
    added: Floats
    _: KW_ONLY
    offset: float = 0.0
    direction: int = 1
    foot: Floats | None = None

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
        if self.foot is not None:
            foot = np.array(self.foot, dtype=float)
            if foot.ndim != 2 or foot.shape[0] != 2 or not np.all(foot[0] < foot[1]):
                raise InputError(
                    "pair_springs.foot", f"shape {foot.shape}", allowed="(2, samples), touch < knee"
                )
            foot.setflags(write=False)
            object.__setattr__(self, "foot", foot)

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
            np.column_stack([k, closing]),
            np.column_stack([s, closing_added]),
            offset=offset,
            direction=direction,
        )

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

    def stretch_at(self, phase: ArrayLike) -> tuple[Floats, Floats]:
        """(knee, slope dw/d delta below it) at ``phase``; (-inf, 1) where there is no foot."""
        phi = np.asarray(phase, dtype=float)
        if self.foot is None:
            return np.full(phi.shape, -np.inf), np.ones(phi.shape)
        touch, knee = self._foot_at(phi)
        k, s = self.at(phi)
        return knee, np.asarray((knee - _own_touch(k, s)) / (knee - touch))

    def touch(self, phase: ArrayLike) -> Floats:
        """delta [m] at which the first pair touches at ``phase``."""
        phi = np.asarray(phase, dtype=float)
        return _own_touch(*self.at(phi)) if self.foot is None else np.asarray(self._foot_at(phi)[0])

    def _foot_at(self, phase: Floats) -> Floats:
        """Touch and knee [m] at ``phase``, (2, phase...), linear between the samples."""
        assert self.foot is not None
        count = self.foot.shape[1]
        place = np.mod(phase, 1.0) * count
        left = place.astype(np.int64) % count
        weight = place - np.floor(place)
        here, after = self.foot[:, left], self.foot[:, (left + 1) % count]
        return np.asarray(here + weight * (after - here))

    def _stretched(self, deflection: Floats, phase: Floats) -> tuple[Floats, Floats]:
        """w [m] and dw/d delta at ``deflection`` delta and ``phase`` of one shape."""
        if self.foot is None:
            return deflection, np.ones_like(deflection)
        knee, slope = self.stretch_at(phase)
        below = deflection < knee
        stretched = np.where(below, knee - (knee - deflection) * slope, deflection)
        return stretched, np.where(below, slope, 1.0)

    def force(self, deflection: ArrayLike, phase: ArrayLike) -> Floats:
        """F [N] >= 0 at ``deflection`` delta [m] and ``phase``, which broadcast."""
        delta, phi = np.broadcast_arrays(
            np.asarray(deflection, dtype=float), np.asarray(phase, dtype=float)
        )
        k, s = self.at(phi)
        w, _ = self._stretched(delta, phi)
        return np.asarray(np.sum(k * np.maximum(w + s, 0.0), axis=0))

    def stiffness_at(self, deflection: ArrayLike, phase: ArrayLike) -> Floats:
        """dF/d delta [N/m]: the sum over the pairs that carry."""
        delta, phi = np.broadcast_arrays(
            np.asarray(deflection, dtype=float), np.asarray(phase, dtype=float)
        )
        k, s = self.at(phi)
        w, slope = self._stretched(delta, phi)
        return np.asarray(np.sum(np.where(w + s > 0.0, k, 0.0), axis=0) * slope)

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
        if self.foot is not None:
            knee, slope = self.stretch_at(phi)
            found = np.where(found < knee, knee - (knee - found) / slope, found)
        return np.asarray(np.where(enough.any(axis=0), found, np.nan))


def _own_touch(stiffness: Floats, added: Floats) -> Floats:
    """-max_j S_j [m] over the pairs that have a stiffness; first axis the pair."""
    return np.asarray(-np.max(np.where(stiffness > 0.0, added, -np.inf), axis=0))
