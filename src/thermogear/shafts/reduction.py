"""Fewer coordinates for a drive train whose contacts open and close (Craig-Bampton).

q = Psi q_b + Phi p: the interface q_b - gears, bearings, seats and housing - is kept, Psi are the
static shapes of the shafts between, Phi the lowest modes with the interface held. Statics and free
flight stay exact, with any contact open. Modes of the train with its contacts closed must not be
cut off instead: where a contact opens, the missing ones leave a false spring behind.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.shafts.assembly import Assembly, across
from thermogear.shafts.linear import LinearTrain
from thermogear.shafts.train import SHAFTS

DROPPED = 1e-12
"""Share of the length of a vector below which it is none."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Reduction:
    """Coordinates p of a train, q = ``basis`` p with ``basis`` (n, size), its rotation left out."""

    assembly: Assembly
    basis: Floats

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.basis.shape[1])

    def matrix(self, full: ArrayLike) -> Floats:
        """``full`` (n, n) in these coordinates."""
        return np.asarray(self.basis.T @ np.asarray(full, dtype=float) @ self.basis)

    def vector(self, full: ArrayLike) -> Floats:
        """Forces ``full`` (n, ...) in these coordinates."""
        return np.asarray(self.basis.T @ np.asarray(full, dtype=float))

    @cached_property
    def _to_coordinates(self) -> Floats:
        mass = self.assembly.mass
        return np.asarray(np.linalg.solve(self.matrix(mass), self.basis.T @ mass))

    def coordinates(self, displacement: ArrayLike) -> Floats:
        """p (..., size) of displacements q (..., n), by least mass-weighted squares."""
        return np.asarray(np.asarray(displacement, dtype=float) @ self._to_coordinates.T)

    def frequencies(self, linear: LinearTrain, count: int) -> Floats:
        """The ``count`` lowest natural frequencies at rest [rad/s] of the reduced linear train."""
        square = scipy.linalg.eigvalsh(
            self.matrix(linear.stiffness),
            self.matrix(self.assembly.mass),
            subset_by_index=(0, min(count, self.size) - 1),
        )
        return np.asarray(np.sqrt(square))

    def frequency_errors(self, linear: LinearTrain, count: int = 12) -> Floats:
        """(w reduced - w)/w [-] of the ``count`` lowest modes at rest; not below zero."""
        true = linear.modes(0.0, count=count).frequency
        own = self.frequencies(linear, count)
        return np.asarray(own / true[: own.size] - 1.0)


def interface_of(assembly: Assembly) -> tuple[str, ...]:
    """Coordinates that contacts act on: gears, bearings that are not linear, seats, housing."""
    felt = [assembly.at_gear(shaft)[:, [0, 1, 4]] for shaft in SHAFTS]
    felt += [one.directions for one in assembly.bearings if not one.bearing.law.linear]
    touched = np.any(np.hstack(felt) != 0.0, axis=1)
    return tuple(
        name
        for name, here in zip(assembly.coordinates, touched, strict=True)
        if here or " seat." in name or name.startswith("casing.")
    )


def usual(assembly: Assembly, modes: int) -> int:
    """So many coordinates: the interface and ``modes``, or all where a train has fewer."""
    return min(len(interface_of(assembly)) - 1 + modes, assembly.size - 1)


def reduced(assembly: Assembly, coordinates: int | None = None) -> Reduction:
    """The train in ``coordinates`` of them; left out: all, with the rigid rotation dropped.

    At least the interface is kept, less one for the rotation. Raises InputError for a number below
    that or above all, or where a motion is free with the interface held.
    """
    names = interface_of(assembly)
    kept = np.array([assembly.index[name] for name in names], dtype=int)
    rest = np.setdiff1d(np.arange(assembly.size), kept)
    least, most = kept.size - 1, assembly.size - 1
    wanted = most if coordinates is None else coordinates
    if not least <= wanted <= most:
        raise InputError(
            "coordinates",
            coordinates,
            allowed=f"{least}..{most}",
            why="gears and bearings with clearance are kept"
            if wanted < least
            else "the whole train has no more",
        )
    stiff = assembly.stiffness.copy()
    for place in assembly.bearings:
        if place.bearing.law.linear:
            k = place.bearing.law.stiffness(np.zeros(2))
            stiff += place.directions @ k @ place.directions.T
    inner, mass = stiff[np.ix_(rest, rest)], assembly.mass[np.ix_(rest, rest)]
    whole = np.zeros((assembly.size, wanted + 1))
    whole[kept, np.arange(kept.size)] = 1.0
    if rest.size:
        symmetric = 0.5 * (inner + inner.T)
        square, shapes = scipy.linalg.eigh(symmetric, mass)
        if square[0] <= DROPPED * square[-1]:
            raise InputError(
                "shafts",
                "a free motion with gears and bearings held",
                allowed="none",
                why="nothing holds a part of a shaft",
            )
        count = wanted + 1 - kept.size
        whole[np.ix_(rest, np.arange(kept.size))] = -np.linalg.solve(
            inner, stiff[np.ix_(rest, kept)]
        )
        whole[np.ix_(rest, np.arange(kept.size, wanted + 1))] = shapes[:, :count]
    small = whole.T @ assembly.mass @ whole
    turn = np.linalg.lstsq(whole, assembly.rotation, rcond=None)[0]
    # of like scale, so that the reflection below mixes nothing large into what is small
    scale = 1.0 / np.sqrt(np.diag(small))
    basis = whole @ (scale[:, None] * across((small @ turn) * scale))
    return Reduction(assembly=assembly, basis=np.asarray(basis))
