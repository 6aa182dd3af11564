"""How the parameters of diagrams, maps, sweeps and branches are named and shown."""

from __future__ import annotations

import json

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import DataArray, Dataset
from thermogear.base.display import display
from thermogear.base.parameters import PARAMETERS, Parameter, long_name
from thermogear.views.typesetting import math_symbol, prose


def parameter_of(name: str, values: object = None) -> Parameter:
    """A parameter of the table, or a dotted field shown by the unit of its stored ``values``."""
    unit = str(getattr(values, "attrs", {}).get("units", "1"))
    how = display(name, unit)
    other = Parameter(
        name=name, words=name.replace("_", " "), unit=unit, factor=how.scale / how.per,
        zero=how.zero,
        shown="" if unit == "1" else how.unit,
    )  # fmt: skip
    return PARAMETERS.get(long_name(name), other)


def shown(name: str, values: ArrayLike | DataArray) -> NDArray[np.float64]:
    """Values of a parameter in the unit its axis shows."""
    return np.asarray(parameter_of(name, values).show(np.asarray(values, dtype=float)))


def axis_words(name: str, values: object = None) -> str:
    """The label of a parameter's axis in a picture; a dash where it has no unit."""
    words = math_symbol(parameter_of(name, values).label)
    return words if "[" in words else f"{words} [–]"


def page_words(name: str, values: object = None) -> Markup:
    """The heading of a parameter's column on a page."""
    return prose(parameter_of(name, values).label)


def named(data: Dataset, axis: str) -> list[str]:
    """The names along a numbered axis, as stored with it."""
    return [str(one) for one in json.loads(str(data[axis].attrs["names"]))]


def each_state(data: Dataset) -> list[tuple[str, Dataset]]:
    """A map in every state of heat that it has, with the state's name; "" where it has one."""
    if "state" not in data["label"].dims:
        return [("", data)]
    return [(name, data.isel(state=i)) for i, name in enumerate(named(data, "state"))]
