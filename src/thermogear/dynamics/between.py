"""A model between two others of the same layout, number by number."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.pieces import Pieces
from thermogear.dynamics.geared import GearedModel


def between(one: GearedModel, other: GearedModel, weight: float) -> GearedModel:
    """``one`` + ``weight`` (``other`` - ``one``) in every number, functions of the phase included.

    Both are trains of one layout in the same coordinates. Pieces of both functions are kept.
    ``weight`` 0 is ``one`` itself.
    """
    found: GearedModel = one if weight == 0.0 else _mixed(one, other, weight)
    return found


def _mixed(a: Any, b: Any, weight: float) -> Any:
    if isinstance(a, Pieces):
        return _pieces(a, b, weight)
    if is_dataclass(a):
        made = {f.name: _mixed(getattr(a, f.name), getattr(b, f.name), weight) for f in fields(a)}
        return type(a)(**made)  # type: ignore[misc]
    if isinstance(a, tuple):
        return tuple(_mixed(x, y, weight) for x, y in _alike(a, b))
    return a + weight * (b - a) if isinstance(a, float | complex | np.ndarray) else a


def _alike(a: tuple[Any, ...], b: tuple[Any, ...]) -> Any:
    """Pairs of both; a series of harmonics is filled up with zeros."""
    longest = max(len(a), len(b))
    if all(isinstance(x, complex | float) for x in (*a, *b)):
        return zip(a + (0.0,) * (longest - len(a)), b + (0.0,) * (longest - len(b)), strict=True)
    return zip(a, b, strict=True)


def _pieces(a: Pieces, b: Pieces, weight: float) -> Pieces:
    """The mixture as polynomials between the borders of both."""
    starts = np.array(sorted({*a.starts, *b.starts}))
    one, two = _from(a, starts), _from(b, starts)
    size = max(one.shape[1], two.shape[1])
    one, two = (np.pad(row, ((0, 0), (0, size - row.shape[1]))) for row in (one, two))
    rows = (one + weight * (two - one)).tolist()
    return Pieces(starts=tuple(starts.tolist()), coefficients=tuple(map(tuple, rows)))


def _from(function: Pieces, starts: NDArray[np.float64]) -> NDArray[np.float64]:
    """Coefficients (start, power) of the polynomials at ``starts``, moved to them."""
    place = np.searchsorted(function.starts, starts, side="right") - 1
    size = max(len(row) for row in function.coefficients)
    table = np.zeros((len(function.starts), size))
    for number, row in enumerate(function.coefficients):
        table[number, : len(row)] = row
    own = table[place]
    step = starts - np.asarray(function.starts)[place]
    found = np.zeros_like(own)
    for power in range(size):
        for higher in range(power, size):
            found[:, power] += comb(higher, power) * own[:, higher] * step ** (higher - power)
    return found
