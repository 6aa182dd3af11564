"""The plane in which states of any length are drawn, and from which starts are taken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.dynamics.return_map import return_map


@dataclass(frozen=True, eq=False, kw_only=True)
class Plane:
    """(x, v) = ``onto`` z of a state z (d,), and z = ``rest`` + ``lift`` ((x, v) - onto rest).

    ``onto`` (2, d), ``lift`` (d, 2) with onto lift = 1, ``rest`` (d,); ``unit`` (2,) the scales of
    (x, v); ``words`` their names and units; ``scale`` [m], [m/s] of one in (x, v) where they are a
    displacement and its rate, else nan.
    """

    onto: Floats
    lift: Floats
    rest: Floats
    unit: Floats
    words: tuple[tuple[str, str], tuple[str, str]] = (("displacement", "1"), ("velocity", "1"))
    scale: tuple[float, float] = (float("nan"), float("nan"))

    def of(self, states: ArrayLike) -> Floats:
        """(x, v) (..., 2) of ``states`` (..., d)."""
        return np.asarray(np.asarray(states, dtype=float) @ self.onto.T)

    def starts(self, pairs: ArrayLike) -> Floats:
        """The states (..., d) that ``pairs`` (..., 2) stand for."""
        away = np.asarray(pairs, dtype=float) - self.onto @ self.rest
        return np.asarray(self.rest + away @ self.lift.T)


def plane_of(model: object) -> Plane:
    """The ``plane`` of a model's return map; where it names none, its first two components."""
    section = return_map(model)
    own = getattr(section, "plane", None)
    if own is not None:
        found: Plane = own
        return found
    d = section.dimension
    onto = np.eye(2, d)
    return Plane(
        onto=onto,
        lift=onto.T.copy(),
        rest=np.zeros(d),
        unit=np.append(section.unit, 1.0)[:2],
    )
