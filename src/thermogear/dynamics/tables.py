"""Periodic coefficient tables as the kernels read them: Fourier series and pieces with jumps.

Everything is held per lane (one lane = one parameter point) in flat arrays; the phase is
counted in periods, 0 at the Poincare section.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base import fourier
from thermogear.base.arrays import Complexes, Floats, rows_at
from thermogear.base.excitation import Periodic
from thermogear.base.pieces import Pieces as Pieces

Table = Periodic | Pieces


@dataclass(frozen=True, kw_only=True)
class LaneTables:
    """Parameter points side by side: x'' + c x' + k(t) f(x; b) = F(t), one entry per lane.

    ``stiffness`` and ``force`` are Fourier coefficients of shape (lane, harmonic), column 0 the
    mean; ``stiffness_pieces`` and ``force_pieces`` add jumps, lane by lane (None: none).
    ``mesh_periods``: so many mesh periods are one ``period`` of every lane.
    """

    period: Floats
    damping: Floats
    half_backlash: Floats
    stiffness: Complexes
    force: Complexes
    stiffness_pieces: tuple[Pieces | None, ...]
    force_pieces: tuple[Pieces | None, ...]
    mesh_periods: int = 1

    def __len__(self) -> int:
        return int(self.period.size)

    @property
    def mesh_period(self) -> Floats:
        """Time of one mesh period, (lane,)."""
        return self.period / self.mesh_periods

    @property
    def unit(self) -> Floats:
        """Scales of (x, x') for distances: b and 2 pi b over the mesh period, (lane, 2)."""
        speed = 2.0 * np.pi * self.half_backlash / self.mesh_period
        return np.stack([self.half_backlash, speed], axis=1)

    @property
    def by_fft(self) -> bool:
        """Whether the tables go by FFT: those of a turn, and all of very many harmonics."""
        width = max(self.stiffness.shape[1], self.force.shape[1])
        return self.mesh_periods > 1 or width > fourier.MANY + 1

    def take(self, index: ArrayLike) -> Self:
        """The lanes of ``index``, in that order."""
        chosen = np.arange(len(self))[np.atleast_1d(np.asarray(index))]
        return type(self)(
            period=self.period[chosen],
            damping=self.damping[chosen],
            half_backlash=self.half_backlash[chosen],
            stiffness=rows_at(self.stiffness, chosen),
            force=rows_at(self.force, chosen),
            stiffness_pieces=tuple(self.stiffness_pieces[i] for i in chosen),
            force_pieces=tuple(self.force_pieces[i] for i in chosen),
            mesh_periods=self.mesh_periods,
        )

    def jumps(self, lane: int) -> tuple[float, ...]:
        """Phases in (0, 1) where a table of this lane may jump."""
        pieces = (self.stiffness_pieces[lane], self.force_pieces[lane])
        return tuple(sorted({s for one in pieces if one is not None for s in one.starts[1:]}))

    def values(self, name: str, phase: ArrayLike) -> Floats:
        """Stiffness or force of every lane at ``phase``: shape (phase..., lane)."""
        coefficients: Complexes = getattr(self, name)
        pieces: tuple[Pieces | None, ...] = getattr(self, name + "_pieces")
        phi = np.asarray(phase, dtype=float)
        total = np.empty((*phi.shape, len(self)))
        total[...] = coefficients[:, 0].real
        if self.by_fft:
            total[...] = np.moveaxis(fourier.values(coefficients, phi), 0, -1)
        for order in range(1, 1 if self.by_fft else coefficients.shape[1]):
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
    series = [table if isinstance(table, Periodic) else Periodic(0.0) for table in rows]
    return Periodic.columns(series), tuple(t if isinstance(t, Pieces) else None for t in rows)
