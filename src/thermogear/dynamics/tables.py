"""Periodic coefficient tables as the kernels read them: Fourier series and pieces with jumps.

Everything is held per lane (one lane = one parameter point) in flat arrays; the phase is
counted in periods, 0 at the Poincare section.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError
from thermogear.base.excitation import Periodic

if TYPE_CHECKING:
    from thermogear.dynamics.exact_map import ExactMap

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


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

    def __call__(self, phase: ArrayLike) -> Floats:
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

    def taylor(self, *, centre: float, half: float, order: int) -> Floats:
        """Coefficients in u of p(centre + half u), for an interval inside one piece."""
        index = int(np.searchsorted(self.starts, centre, side="right")) - 1
        poly = np.polynomial.Polynomial(self.coefficients[index])
        inner = np.polynomial.Polynomial([centre - self.starts[index], half])
        out = np.zeros(order + 1)
        shifted = poly(inner).coef
        out[: shifted.size] = shifted[: order + 1]
        return out

    def scaled(self, factor: float) -> Pieces:
        """The same function times ``factor``."""
        return Pieces(
            starts=self.starts,
            coefficients=tuple(tuple(c * factor for c in row) for row in self.coefficients),
        )


Table = Periodic | Pieces


@dataclass(frozen=True, kw_only=True)
class Lanes:
    """Parameter points side by side: x'' + c x' + k(t) f(x; b) = F(t), one entry per lane.

    ``stiffness`` and ``force`` are Fourier coefficients of shape (lane, harmonic), column 0 the
    mean; ``stiffness_pieces`` and ``force_pieces`` add jumps, lane by lane (None: none).
    """

    period: Floats
    damping: Floats
    half_backlash: Floats
    stiffness: Complexes
    force: Complexes
    stiffness_pieces: tuple[Pieces | None, ...]
    force_pieces: tuple[Pieces | None, ...]

    def __len__(self) -> int:
        return int(self.period.size)

    def take(self, index: ArrayLike) -> Lanes:
        """The lanes of ``index``, in that order."""
        chosen = np.atleast_1d(np.asarray(index))
        return Lanes(
            period=self.period[chosen],
            damping=self.damping[chosen],
            half_backlash=self.half_backlash[chosen],
            stiffness=self.stiffness[chosen],
            force=self.force[chosen],
            stiffness_pieces=tuple(self.stiffness_pieces[i] for i in chosen),
            force_pieces=tuple(self.force_pieces[i] for i in chosen),
        )

    def return_map(self, samples: int = 0) -> ExactMap:
        """The event-exact return map of one lane; ``samples`` a period of what it records."""
        from thermogear.dynamics.exact_map import ExactMap

        return ExactMap(self, samples)

    def jumps(self, lane: int) -> tuple[float, ...]:
        """Phases in (0, 1) where a table of this lane may jump."""
        found: set[float] = set()
        for piece in (self.stiffness_pieces[lane], self.force_pieces[lane]):
            if piece is not None:
                found.update(piece.starts[1:])
        return tuple(sorted(found))

    def values(self, name: str, phase: ArrayLike) -> Floats:
        """Stiffness or force of every lane at ``phase``: shape (phase..., lane)."""
        coefficients: Complexes = getattr(self, name)
        pieces: tuple[Pieces | None, ...] = getattr(self, name + "_pieces")
        phi = np.asarray(phase, dtype=float)
        total = np.empty((*phi.shape, len(self)))
        total[...] = coefficients[:, 0].real
        for order in range(1, coefficients.shape[1]):
            turned = np.mod(order * phi, 1.0)[..., None]
            row = coefficients[:, order]
            # real arithmetic: the mirror and scaling by two stay exact to the last bit
            total += row.real * np.cos(2 * np.pi * turned) - row.imag * np.sin(2 * np.pi * turned)
        for lane, piece in enumerate(pieces):
            if piece is not None:
                total[..., lane] += piece(phi)
        return total


def stack(tables: Iterable[Table]) -> tuple[Complexes, tuple[Pieces | None, ...]]:
    """Fourier coefficients (lane, harmonic) and pieces of one table per lane.

    >>> coefficients, pieces = stack([Periodic(3e8, (5e7,)), Periodic(2e8)])
    >>> coefficients.shape, pieces
    ((2, 2), (None, None))
    """
    rows = list(tables)
    width = 1 + max((len(t.harmonics) for t in rows if isinstance(t, Periodic)), default=0)
    coefficients = np.zeros((len(rows), width), complex)
    pieces: list[Pieces | None] = []
    for lane, table in enumerate(rows):
        if isinstance(table, Pieces):
            pieces.append(table)
        else:
            pieces.append(None)
            coefficients[lane, 0] = table.mean
            coefficients[lane, 1 : 1 + len(table.harmonics)] = table.harmonics
    return coefficients, tuple(pieces)
