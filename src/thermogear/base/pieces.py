"""Periodic functions with jumps: polynomials between borders of the mesh phase."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Pieces:
    """A periodic function given by polynomials between jumps.

    p(phi) = sum_m coefficients[i][m] (phi - starts[i])^m for starts[i] <= phi < starts[i+1],
    phi in periods; the first start is 0, the last piece ends at 1. At a start the value is the
    right-hand limit.

    >>> Pieces.constant(starts=[0.0, 0.25], values=[1.0, 2.0]).mean
    1.75
    """

    starts: tuple[float, ...]
    coefficients: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        starts = tuple(float(s) for s in self.starts)
        rows = tuple(tuple(float(c) for c in row) for row in self.coefficients)
        object.__setattr__(self, "starts", starts)
        object.__setattr__(self, "coefficients", rows)
        if not starts or starts[0] != 0.0 or any(np.diff([*starts, 1.0]) <= 0.0):
            raise InputError("pieces.starts", starts, allowed="0 = s_0 < s_1 < ... < 1")
        if len(rows) != len(starts) or not all(rows):
            raise InputError("pieces.coefficients", len(rows), allowed=f"{len(starts)} rows")
        if not np.all(np.isfinite([c for row in rows for c in row])):
            raise InputError("pieces.coefficients", "a non-finite number", allowed="finite")

    @classmethod
    def constant(cls, *, starts: Sequence[float], values: Sequence[float]) -> Pieces:
        """A staircase: ``values[i]`` from ``starts[i]`` on (the rectangular mesh stiffness)."""
        return cls(starts=tuple(starts), coefficients=tuple((float(v),) for v in values))

    @property
    def mean(self) -> float:
        """Mean over a period."""
        ends = [*self.starts[1:], 1.0]
        return float(
            sum(
                sum(c * (e - s) ** (m + 1) / (m + 1) for m, c in enumerate(row))
                for s, e, row in zip(self.starts, ends, self.coefficients, strict=True)
            )
        )

    def __call__(self, phase: ArrayLike) -> NDArray[np.float64]:
        """Values at ``phase`` (in periods, any shape)."""
        phi = np.mod(np.asarray(phase, dtype=float), 1.0)
        index = np.searchsorted(self.starts, phi, side="right") - 1
        width = max(len(row) for row in self.coefficients)
        table = np.array([[*row, *([0.0] * (width - len(row)))] for row in self.coefficients])
        local = phi - np.asarray(self.starts)[index]
        total = np.zeros(phi.shape)
        for m in range(width - 1, -1, -1):
            total = total * local + table[index, m]
        return np.asarray(total)

    def taylor(self, *, centre: float, half: float, order: int) -> NDArray[np.float64]:
        """Coefficients in u of p(centre + half u), for an interval inside one piece."""
        index = int(np.searchsorted(self.starts, centre, side="right")) - 1
        poly = np.polynomial.Polynomial(self.coefficients[index])
        inner = np.polynomial.Polynomial([centre - self.starts[index], half])
        out = np.zeros(order + 1)
        shifted = poly(inner).coef
        out[: shifted.size] = shifted[: order + 1]
        return out

    def derivative(self) -> Pieces:
        """dp/dphi between the jumps.

        >>> Pieces(starts=(0.0,), coefficients=((1.0, 2.0, 3.0),)).derivative().coefficients
        ((2.0, 6.0),)
        """
        rows = (tuple(m * c for m, c in enumerate(row))[1:] or (0.0,) for row in self.coefficients)
        return Pieces(starts=self.starts, coefficients=tuple(rows))
