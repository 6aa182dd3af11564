"""Names of arrays by what they hold; a docstring states their shape and unit.

The types of xarray stand here for annotations alone: naming one does not load the library.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Complexes", "DataArray", "DataTree", "Dataset", "Flags", "Floats", "Variable", "Whole",
]  # fmt: skip

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Whole = NDArray[np.int64]
Flags = NDArray[np.bool_]

if TYPE_CHECKING:
    from xarray import DataArray, Dataset, DataTree, Variable
else:
    DataArray = Dataset = DataTree = Variable = Any
