"""Names of arrays by what they hold; a docstring states their shape and unit.

The types of xarray stand here for annotations alone: naming one does not load the library.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Whole = NDArray[np.int64]
Flags = NDArray[np.bool_]

if TYPE_CHECKING:
    from xarray import DataArray as DataArray
    from xarray import Dataset as Dataset
    from xarray import DataTree as DataTree
    from xarray import Variable as Variable
else:
    DataArray = Dataset = DataTree = Variable = Any


def rows_at(rows: NDArray[Any], index: Whole) -> NDArray[Any]:
    """``rows[index]``, for reading: where all of them are one row that row is held once.

    So the tables of a turn, which are large, along a row of speeds.

    >>> rows_at(np.eye(2), np.zeros(3, int)).strides
    (0, 8)
    """
    if rows.ndim < 2 or len(index) < 2 or not (rows.strides[0] == 0 or np.all(index == index[0])):
        return np.asarray(rows[index])
    return np.broadcast_to(rows[index[0]], (len(index), *rows.shape[1:]))


def by_row(law: Callable[[NDArray[Any]], NDArray[Any]], rows: NDArray[Any]) -> NDArray[Any]:
    """``law`` of ``rows``, a row in a row out: of one alone where :func:`rows_at` holds one.

    >>> by_row(np.negative, rows_at(np.eye(2), np.zeros(3, int))).strides
    (0, 8)
    """
    if len(rows) > 1 and rows.strides[0] == 0:
        return np.broadcast_to(law(rows[:1])[0], rows.shape)
    return law(rows)
