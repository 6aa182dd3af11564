"""Names of arrays by what they hold; a docstring states their shape and unit.

The types of xarray stand here for annotations alone: naming one does not load the library.
"""

from __future__ import annotations

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
