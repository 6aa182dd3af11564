"""What a bearing does to its journal: force and tangent stiffness over the displacement.

The displacement u = (x, y) [m] is that of the journal against the outer ring; the force is the one
the bearing exerts on the journal, so that it opposes u. Shapes: u (..., 2), force (..., 2) [N],
stiffness -dF/du (..., 2, 2) [N/m]. A law's clearance c_r is *half* of the play G_r that
catalogues give.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError


class BearingLaw(Protocol):
    """Force of a bearing over the displacement of its journal."""

    @property
    def linear(self) -> bool:
        """Whether the stiffness is the same at every displacement."""

    def force(self, displacement: ArrayLike) -> Floats:
        """Force on the journal [N], (..., 2)."""

    def stiffness(self, displacement: ArrayLike) -> Floats:
        """Tangent stiffness -dF/du [N/m], (..., 2, 2)."""


@dataclass(frozen=True, kw_only=True)
class LinearLaw:
    """F = -K u with K = ((k_xx, k_xy), (k_yx, k_yy)) [N/m].

    >>> law = LinearLaw(stiffness_matrix=((2e8, 0.0), (0.0, 1e8)))
    >>> law.force([1e-6, 1e-6]).tolist()
    [-200.0, -100.0]
    """

    stiffness_matrix: tuple[tuple[float, float], tuple[float, float]]

    def __post_init__(self) -> None:
        values = np.asarray(self.stiffness_matrix, dtype=float)
        if values.shape != (2, 2) or not np.all(np.isfinite(values)):
            raise InputError("stiffness", values.tolist(), allowed="2 x 2 finite numbers [N/m]")
        if np.linalg.eigvalsh(0.5 * (values + values.T)).min() < 0.0:
            raise InputError(
                "stiffness",
                f"{values.tolist()} N/m",
                allowed="k_xx, k_yy >= 0 and k_xx k_yy >= k_xy^2",
                why="such a bearing would push its shaft away",
            )

    @property
    def linear(self) -> bool:
        return True

    def force(self, displacement: ArrayLike) -> Floats:
        u = np.asarray(displacement, dtype=float)
        return np.asarray(-u @ np.asarray(self.stiffness_matrix, dtype=float).T)

    def stiffness(self, displacement: ArrayLike) -> Floats:
        u = np.asarray(displacement, dtype=float)
        return np.broadcast_to(np.asarray(self.stiffness_matrix, float), (*u.shape[:-1], 2, 2))


@dataclass(frozen=True, kw_only=True)
class RingLaw:
    """F = -k <|u| - c_r>^n u/|u|: a round clearance, then a power law.

    ``coefficient`` k [N/m^n], ``exponent`` n (1 linear, 1.5 balls, 10/9 rollers), ``clearance``
    c_r >= 0 [m], half of the play. A preload (c_r < 0) is refused: the law would jump at u = 0; use
    :class:`ElementLaw`.

    >>> law = RingLaw(coefficient=1.5e8, clearance=8e-6)
    >>> f"{law.force([10e-6, 0.0])[0]:.0f} N"
    '-300 N'
    """

    coefficient: float
    exponent: float = 1.0
    clearance: float = 0.0

    def __post_init__(self) -> None:
        _positive("coefficient", self.coefficient)
        _exponent(self.exponent)
        if not (np.isfinite(self.clearance) and self.clearance >= 0.0):
            raise InputError(
                "clearance",
                f"{1e6 * self.clearance:.6g} um",
                allowed=">= 0 um",
                why="a ring with preload would jump at its centre",
                fix="describe the rolling elements: they carry a preload",
            )

    @property
    def linear(self) -> bool:
        return self.clearance == 0.0 and self.exponent == 1.0

    def force(self, displacement: ArrayLike) -> Floats:
        u = np.asarray(displacement, dtype=float)
        r = np.linalg.norm(u, axis=-1)[..., None]
        deep = np.maximum(r - self.clearance, 0.0)
        towards = np.divide(u, r, out=np.zeros_like(u), where=r > 0.0)
        return np.asarray(-self.coefficient * deep**self.exponent * towards)

    def stiffness(self, displacement: ArrayLike) -> Floats:
        u = np.asarray(displacement, dtype=float)
        r = np.linalg.norm(u, axis=-1)[..., None, None]
        if self.linear:
            return np.broadcast_to(self.coefficient * np.eye(2), (*u.shape[:-1], 2, 2))
        deep = np.maximum(r - self.clearance, 0.0)
        towards = np.divide(u[..., None, :], r, out=np.zeros_like(u[..., None, :]), where=r > 0.0)
        along = np.swapaxes(towards, -1, -2) @ towards
        force = self.coefficient * deep**self.exponent
        slope = np.zeros_like(r)
        touching = deep > 0.0
        slope[touching] = self.exponent * self.coefficient * deep[touching] ** (self.exponent - 1.0)
        secant = np.divide(force, r, out=np.zeros_like(r), where=r > 0.0)
        return np.asarray(slope * along + secant * (np.eye(2) - along))


@dataclass(frozen=True, kw_only=True)
class ElementLaw:
    """Sum over the rolling elements: Q_i = K <x cos psi_i + y sin psi_i - c_r>^n.

    psi_i = ``cage_angle`` + 2 pi i/Z. ``coefficient`` K [N/m^n] of one element between both races,
    ``elements`` Z, ``exponent`` n (1.5 balls, 10/9 rollers), ``clearance`` c_r [m], half of the
    play; below zero it is a preload, and every element is loaded at u = 0. Truth: shafts without a
    cage angle in the load direction bend a little to its side.

    >>> law = ElementLaw(elements=9, coefficient=8e9, exponent=1.5, clearance=6e-6)
    >>> f"{-law.force([2.737013689e-5, 0.0])[0]:.3f} N"
    '1500.000 N'
    """

    elements: int
    coefficient: float
    exponent: float = 1.5
    clearance: float = 0.0
    cage_angle: float = 0.0

    def __post_init__(self) -> None:
        if self.elements < 3:
            raise InputError("elements", self.elements, allowed=">= 3 rolling elements")
        _positive("coefficient", self.coefficient)
        _exponent(self.exponent)
        if not np.isfinite(self.clearance):
            raise InputError("clearance", self.clearance, allowed="a finite length [m]")

    @property
    def linear(self) -> bool:
        return False

    @property
    def directions(self) -> Floats:
        """Unit vectors from the centre to every element, (Z, 2)."""
        psi = self.cage_angle + 2.0 * np.pi * np.arange(self.elements) / self.elements
        return np.stack([np.cos(psi), np.sin(psi)], axis=-1)

    def loads(self, displacement: ArrayLike) -> Floats:
        """Load Q_i of every element [N], (..., Z)."""
        deep = np.asarray(displacement, dtype=float) @ self.directions.T - self.clearance
        return np.asarray(self.coefficient * np.maximum(deep, 0.0) ** self.exponent)

    def force(self, displacement: ArrayLike) -> Floats:
        return np.asarray(-self.loads(displacement) @ self.directions)

    def stiffness(self, displacement: ArrayLike) -> Floats:
        deep = np.asarray(displacement, dtype=float) @ self.directions.T - self.clearance
        slope = np.zeros_like(deep)
        loaded = deep > 0.0
        slope[loaded] = self.exponent * self.coefficient * deep[loaded] ** (self.exponent - 1.0)
        return np.asarray(np.einsum("...i,ia,ib->...ab", slope, self.directions, self.directions))


def _positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise InputError(name, value, allowed="> 0, finite")


def _exponent(value: float) -> None:
    if not 1.0 <= value <= 2.0:
        raise InputError("exponent", value, allowed="1..2 (1.5 balls, 10/9 rollers)")
