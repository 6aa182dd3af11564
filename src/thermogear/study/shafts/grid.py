"""A drive train over one or two parameters for continuation: computed on a grid, straight between.

The mesh, clearances and friction of a train take seconds at one value. Between neighbouring values
of the grid every number of its equations runs straight; only the corners that a walk passes are
computed.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.base.vocabulary import STATUS, STILL
from thermogear.dynamics.between import between
from thermogear.dynamics.geared import GearedModel
from thermogear.study.shafts.family import TrainFamily

Floats = NDArray[np.float64]
BEYOND = 0.5
"""Cells of the grid by which a walk's steps may reach beyond its ends."""


@dataclass(frozen=True, eq=False)
class TrainGrid:
    """``family`` at the corners of ``axes`` (one or two, ascending), straight between them."""

    family: TrainFamily
    axes: tuple[Floats, ...]
    _kept: dict[tuple[int, ...], GearedModel] = field(init=False, repr=False, default_factory=dict)

    def __call__(self, *values: float) -> GearedModel:
        """The train in motion at one value of each parameter.

        InputError beyond the grid, or where the train has no motion.
        """
        places = [self._cell(axis, at) for axis, at in zip(self.axes, values, strict=True)]
        return self._mixed((), places)

    def _cell(self, axis: Floats, value: float) -> tuple[int, float]:
        """The cell that a value lies in, and where in it."""
        place = int(np.clip(np.searchsorted(axis, value, side="right") - 1, 0, axis.size - 2))
        weight = float((value - axis[place]) / (axis[place + 1] - axis[place]))
        if not -BEYOND <= weight <= 1.0 + BEYOND:
            number = next(i for i, one in enumerate(self.axes) if one is axis)
            raise InputError(
                self.family.names[number], value, allowed=f"{axis[0]:.6g}..{axis[-1]:.6g}"
            )
        return place, weight

    def _mixed(self, corner: tuple[int, ...], rest: list[tuple[int, float]]) -> GearedModel:
        if not rest:
            return self._corner(corner)
        (place, weight), *others = rest
        low = self._mixed((*corner, place), others)
        if weight == 0.0:
            return low
        high = self._mixed((*corner, place + 1), others)
        return high if weight == 1.0 else between(low, high, weight)

    def _corner(self, corner: tuple[int, ...]) -> GearedModel:
        found = self._kept.get(corner)
        if found is not None:
            return found
        row = [float(axis[place]) for axis, place in zip(self.axes, corner, strict=True)]
        train = self.family.train(row)
        if train is None:
            rest = self.family.at_rest(row)[0]
            words = ", ".join(
                f"{name} {value:.6g}" for name, value in zip(self.family.names, row, strict=True)
            )
            raise InputError(
                "parameter",
                f"{words} (SI): {STATUS[rest.status].replace('_', ' ')}",
                why=STILL[STATUS[rest.status]],
                fix="choose a smaller range",
            )
        self._kept[corner] = train.model
        return train.model
