"""Gauss and Legendre's nodes and weights, found once: finding them costs more than most sums."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray


@cache
def gauss(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes in -1..1 and weights of the rule of ``count`` nodes; not to be written to.

    >>> nodes, weights = gauss(2)
    >>> f"{weights @ nodes**2:.4f}"
    '0.6667'
    """
    nodes, weights = np.polynomial.legendre.leggauss(count)
    nodes.setflags(write=False)
    weights.setflags(write=False)
    return nodes, weights
