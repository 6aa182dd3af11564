"""Names of arrays by what they hold; a docstring states their shape and unit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Whole = NDArray[np.int64]
Flags = NDArray[np.bool_]
