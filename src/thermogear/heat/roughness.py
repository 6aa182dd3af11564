"""Rms from mean roughness: drawings and cases state Ra, films and some friction laws want Rq."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

RMS_OF_MEAN_ROUGHNESS = 1.25
"""Rq over Ra. A Gaussian surface has sqrt(pi/2) = 1.2533, a sine 1.1107."""


def rms_roughness(roughness: ArrayLike) -> NDArray[np.float64]:
    """Rq = 1.25 Ra, the root mean square from the arithmetic mean roughness [m].

    ``roughness`` Ra [m], any shape. Exact to 0.3 % for Gaussian heights, which ground and run
    flanks roughly have. Source: the mean of the absolute value of a normal variable is
    sqrt(2/pi) of its standard deviation.

    >>> f"{1e6 * rms_roughness(0.4e-6):.2f} um"
    '0.50 um'
    """
    return np.asarray(RMS_OF_MEAN_ROUGHNESS * np.asarray(roughness, dtype=float))
