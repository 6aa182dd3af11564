"""The models and starts that analysis takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError
from thermogear.dynamics.lanes import Lanes


def lanes_of(model: object) -> Lanes:
    """The flat parameters of ``model``; InputError where the exact maps do not apply."""
    if isinstance(model, Lanes):
        return model
    made = getattr(model, "lanes", None)
    if not callable(made):
        raise InputError(
            "model",
            type(model).__name__,
            why="the section needs a piecewise-linear force and coefficients of time alone",
            allowed="TorsionalModel, DeadZoneModel or PairModel",
        )
    found: Lanes = made()
    return found


def plain(model: object) -> object:
    """The flat parameters of a one-mass model; any other model as it is."""
    return lanes_of(model) if callable(getattr(model, "lanes", None)) else model


def starts_of(initial_state: ArrayLike, lanes: int, *, dimension: int = 2) -> NDArray[np.float64]:
    """Start states (lane, d) from one state or one per lane."""
    start = np.asarray(initial_state, dtype=float)
    if not np.all(np.isfinite(start)):
        raise InputError("initial_state", start.tolist(), allowed="finite numbers")
    d = dimension
    if start.shape not in ((d,), (1, d), (lanes, d)):
        allowed = f"({d},) or ({lanes}, {d})"
        raise InputError("initial_state", f"shape {start.shape}", allowed=allowed)
    return np.array(np.broadcast_to(start, (lanes, d)))
