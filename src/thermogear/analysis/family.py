"""A family of models: from rows of parameter values to lanes, from a case or from plain numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.section import lanes_of
from thermogear.base.arrays import Floats
from thermogear.base.bounds import floats
from thermogear.base.errors import InputError, nearest
from thermogear.base.excitation import Periodic
from thermogear.base.plan import Arrays, Coordinate, Variable
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.models import ClearanceModel
from thermogear.dynamics.return_map import return_map
from thermogear.dynamics.tables import Pieces

if TYPE_CHECKING:
    from thermogear.analysis.settle import Settled


@runtime_checkable
class Family(Protocol):
    """``family(points)`` makes one lane of every row of ``points`` (point, parameter).

    ``names`` of the parameters, their ``units`` ("1": a pure number), ``inputs`` what
    defines the family, as plain numbers and texts. What it returns has ``lanes()``, or it is
    :class:`Models`; a ``status`` array with it marks points that have no motion (jammed). A family
    of models whose states are longer than (x, x') has their ``dimension``.
    """

    @property
    def names(self) -> tuple[str, ...]:
        """Of the parameters."""

    @property
    def units(self) -> tuple[str, ...]:
        """Of the parameters; "1": a pure number."""

    def inputs(self) -> dict[str, Any]:
        """What defines the family, as plain numbers and texts."""

    def __call__(self, points: Floats) -> Any:
        """One lane of every row of ``points`` (point, parameter)."""


@runtime_checkable
class Watching(Protocol):
    """A family that reads more from a settled motion than its label.

    ``kinds``: those of its variables, whole numbers, that tell kinds of motion apart as labels do.
    """

    @property
    def kinds(self) -> tuple[str, ...]:
        """Of its variables those that tell kinds of motion apart."""

    def watched(self, dims: tuple[str, ...]) -> dict[str, Variable]:
        """The stored variables over ``dims``, some over axes of their own behind them."""

    def watched_coordinates(self) -> dict[str, Coordinate]:
        """Those axes."""

    def watch(self, points: Floats, found: Settled) -> Arrays:
        """The values at ``points`` (point, parameter), whose motions are ``found``."""


def watched_variables(family: Family, dims: tuple[str, ...]) -> dict[str, Variable]:
    """What a family reads from its motions, nothing where it only labels them."""
    return family.watched(dims) if isinstance(family, Watching) else {}


def watched_axes(family: Family) -> dict[str, Coordinate]:
    """The axes that these variables have of their own."""
    return family.watched_coordinates() if isinstance(family, Watching) else {}


def watched_arrays(family: Family, points: Floats, found: Settled) -> Arrays:
    """Their values at ``points`` (point, parameter)."""
    return family.watch(points, found) if isinstance(family, Watching) else {}


@dataclass(frozen=True, eq=False)
class Models:
    """A model with a return map for every point; None where its ``status`` is not 0."""

    models: tuple[object, ...]
    status: NDArray[np.int8]


@dataclass(frozen=True)
class ModelFamily:
    """A model of one lane, or with a return map, with some number fields put to other values."""

    model: Any
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        if not is_dataclass(self.model) or isinstance(self.model, type):
            raise InputError(
                "model", type(self.model).__name__, allowed="a model with named fields"
            )
        if isinstance(self.model, ClearanceModel):
            if len(lanes_of(self.model)) != 1:
                raise InputError("model", f"{len(lanes_of(self.model))} lanes", allowed="one lane")
        else:
            return_map(self.model)
        known = [
            f.name for f in fields(self.model) if isinstance(getattr(self.model, f.name), float)
        ]
        for name in self.names:
            if name not in known:
                raise InputError("parameter", repr(name), fix=nearest(str(name), known))
        if len(set(self.names)) < len(self.names):
            raise InputError("parameter", list(self.names), allowed="different parameters")

    @cached_property
    def dimension(self) -> int:
        """Length of a state."""
        return return_map(self.model).dimension

    @property
    def units(self) -> tuple[str, ...]:
        """Every number of a model is dimensionless."""
        return ("1",) * len(self.names)

    def inputs(self) -> dict[str, Any]:
        """The model's fields that do not vary."""
        held = [field.name for field in fields(self.model) if field.name not in self.names]
        plain = {name: _plain(getattr(self.model, name)) for name in held}
        return {"type": type(self.model).__name__, **plain}

    def __call__(self, points: Floats) -> Any:
        columns = np.asarray(points, dtype=float)
        model: Any = self.model
        if not isinstance(model, ClearanceModel):
            made = [
                replace(model, **dict(zip(self.names, map(float, row), strict=True)))
                for row in columns
            ]
            return Models(tuple(made), np.zeros(len(made), np.int8))
        changes = {name: columns[:, i].copy() for i, name in enumerate(self.names)}
        return replace(self.model, **changes)


def _plain(value: object) -> object:
    """A field as plain numbers and texts."""
    if isinstance(value, Periodic):
        pairs = [[c.real, c.imag] for c in value.harmonics]
        return {"mean": value.mean, "harmonics": pairs}
    if isinstance(value, Pieces):
        return {"starts": list(value.starts), "pieces": [list(c) for c in value.coefficients]}
    if is_dataclass(value) and not isinstance(value, type):
        return {f.name: _plain(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, tuple):
        return [_plain(part) for part in value]
    if isinstance(value, complex):
        return [value.real, value.imag]
    if value is None or callable(value):
        return getattr(value, "__qualname__", None)
    return float(np.asarray(value)) if np.ndim(value) == 0 else np.asarray(value).tolist()  # type: ignore[arg-type]


def family_for(model: object, names: Sequence[str]) -> Family:
    """``model`` itself where it is a family of these parameters, else its fields vary."""
    wanted = tuple(names)
    if isinstance(model, Family) and not is_model(model):
        if model.names != wanted:
            raise InputError("parameter", list(wanted), allowed=str(list(model.names)))
        return model
    return ModelFamily(model, wanted)


def is_model(thing: object) -> bool:
    """Whether it makes lanes, or a return map, by itself."""
    return hasattr(thing, "lanes") or hasattr(thing, "return_map")


def dimension_of(family: Family) -> int:
    """Length of the states of a family's models."""
    return int(getattr(family, "dimension", 2))


def lanes_and_status(
    family: Family, points: Floats
) -> tuple[Lanes | tuple[object, ...], NDArray[np.int8]]:
    """The lanes (or models) of ``points``, and which have no motion (status other than 0)."""
    return unpacked(family(points), len(points))


def unpacked(made: Any, count: int) -> tuple[Lanes | tuple[object, ...], NDArray[np.int8]]:
    """:func:`lanes_and_status` of what a family ``made`` for so many points."""
    if isinstance(made, Models):
        return made.models, made.status
    lanes = lanes_of(made)
    if len(lanes) == 1 and count > 1:
        lanes = lanes.take(np.zeros(count, int))
    return lanes, np.asarray(getattr(made, "status", np.zeros(count)), dtype=np.int8)


def taken(lanes: Lanes | Sequence[object], index: NDArray[np.int64]) -> Lanes | tuple[object, ...]:
    """Some of the lanes, or models."""
    return lanes.take(index) if isinstance(lanes, Lanes) else tuple(lanes[i] for i in index)


def model_at(family: Family, value: float) -> object:
    """The one lane, or model, of one value of the one parameter."""
    lanes, _ = lanes_and_status(family, np.array([[value]]))
    return lanes if isinstance(lanes, Lanes) else lanes[0]


def axis_values(name: str, values: ArrayLike) -> Floats:
    """Finite, different, one axis."""
    found = np.atleast_1d(floats(name, values))
    if found.ndim != 1 or found.size == 0 or not np.all(np.isfinite(found)):
        raise InputError(name, f"shape {found.shape}", allowed="finite numbers on one axis")
    if np.unique(found).size < found.size:
        raise InputError(name, "values that repeat", allowed="different values")
    return found
