"""How the parameters of diagrams, maps, sweeps and branches are named and shown."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray

from thermogear.base.parameters import PARAMETERS, long_name
from thermogear.views.typesetting import math_symbol, prose

if TYPE_CHECKING:
    import xarray as xr


def shown(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Values of a parameter in the unit its axis shows."""
    one, found = PARAMETERS.get(long_name(name)), np.asarray(values, dtype=float)
    return found if one is None else np.asarray(one.show(found))


def axis_words(name: str, unit: str = "1") -> str:
    """The label of a parameter's axis in a picture, with its ``unit`` as stored if it says none."""
    words = math_symbol(_words(name))
    return words if "[" in words else f"{words} [{'–' if unit == '1' else unit}]"


def page_words(name: str) -> Markup:
    """The heading of a parameter's column on a page."""
    return prose(_words(name))


def _words(name: str) -> str:
    one = PARAMETERS.get(long_name(name))
    return name.replace("_", " ") if one is None else one.label


def named(data: xr.Dataset, axis: str) -> list[str]:
    """The names along a numbered axis, as stored with it."""
    return [str(one) for one in json.loads(str(data[axis].attrs["names"]))]


def each_state(data: xr.Dataset) -> list[tuple[str, xr.Dataset]]:
    """A map in every state of heat that it has, with the state's name; "" where it has one."""
    if "state" not in data["label"].dims:
        return [("", data)]
    return [(name, data.isel(state=i)) for i, name in enumerate(named(data, "state"))]
