"""Datasets as tables of rows: units in the heads, the words of flags in place of their numbers."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import DataArray, Dataset
from thermogear.base.display import display
from thermogear.base.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

UNITS = ("si", "display")
PLACES = {"bundle", "gear_temperature", "operating", "point", "state"}
"""Dimensions of points; others are a curve's."""
FIRST = ("status", "label", "period")
"""Columns that stand behind the axes, before all numbers."""


def frames(data: Dataset, units: str = "si") -> dict[tuple[str, ...], pd.DataFrame]:
    """Dimensions (sorted) -> the variables that have them, a row for each place.

    Columns are named ``name [unit]``, in ``units`` "si" or as pages show them ("display"); single
    numbers, which have no dimension, are left out.
    """
    if units not in UNITS:
        raise InputError("units", repr(units), allowed=" | ".join(UNITS), fix='write units="si"')
    families: dict[tuple[str, ...], list[str]] = {}
    for name, variable in data.data_vars.items():
        dims = tuple(sorted(str(d) for d in variable.dims))
        if dims:
            families.setdefault(dims, []).append(str(name))
    return {dims: _frame(data[names], units) for dims, names in families.items()}


def stretched(data: Dataset, dims: Iterable[str]) -> dict[str, NDArray[Any]]:
    """Every variable that runs along no other dimension than ``dims``, spread over all of them.

    Its values in the order of the rows, the last dimension fastest; flags as their words.
    """
    sizes = {dim: data.sizes[dim] for dim in dims}
    found = {}
    for name, variable in in_words(data).variables.items():
        if set(variable.dims) <= set(sizes):
            own = [variable.dims.index(dim) for dim in sizes if dim in variable.dims]
            sides = [sizes[dim] if dim in variable.dims else 1 for dim in sizes]
            values = variable.values.transpose(own).reshape(sides)
            found[str(name)] = np.broadcast_to(values, tuple(sizes.values())).ravel()
    return found


def rows_of(columns: Mapping[str, ArrayLike]) -> list[dict[str, Any]]:
    """The rows of ``columns`` of one length, by their names."""
    values = [np.asarray(column).tolist() for column in columns.values()]
    return [dict(zip(columns, row, strict=True)) for row in zip(*values, strict=True)]


def rows_along(data: Dataset, *dims: str) -> list[dict[str, Any]]:
    """A row for each place along ``dims``: the values of :func:`stretched` by their names."""
    return rows_of(stretched(data, dims))


def told(rows: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """Answers as rows: name, value and unit, limit, verdict, operating point, sentence."""
    import pandas as pd

    heads = ["name", "value", "unit", "limit", "verdict", "operating", "question", "sentence"]
    return pd.DataFrame(list(rows), columns=heads)


def csv_text(frame: pd.DataFrame) -> str:
    """A frame as CSV that a spreadsheet reads safely: no text is a formula."""
    words = frame.select_dtypes(["object", "string"]).columns
    safe = frame.assign(**{str(name): frame[name].map(harmless) for name in words})
    text: str = safe.rename(columns=harmless).to_csv(
        index=False, float_format="%.15g", lineterminator="\n"
    )
    return text


def csv_tables(groups: Mapping[str, Dataset], stem: str) -> dict[str, str]:
    """One CSV text for each group and set of dimensions, by its file, which begins with ``stem``.

    SI; the heads name the units. What is the same at all :data:`PLACES`, such as a time, stands
    beside what differs there. Single numbers are left out.
    """
    texts = {}
    for group, data in groups.items():
        families = {frozenset(dims): frame for dims, frame in frames(data).items()}
        for dims, frame in families.items():
            alike = [
                dims_of_frame
                for dims_of_frame in families
                if dims_of_frame < dims <= dims_of_frame | PLACES
            ]
            if any(dims < dims_of_frame <= dims | PLACES for dims_of_frame in families):
                continue
            for dims_of_frame in alike:
                frame = frame.merge(families[dims_of_frame], how="left")
            name = f"{stem}{group.replace('/', '_')}_by_{'_'.join(sorted(dims))}.csv"
            texts[name] = csv_text(frame)
    return texts


def table_text(head: Iterable[object], rows: Iterable[Iterable[object]]) -> str:
    """A CSV text: one header line, then a line for each row, its numbers in full."""
    import pandas as pd

    return csv_text(pd.DataFrame([*map(list, rows)], columns=[*map(str, head)]))


def harmless(value: object) -> object:
    """A text that a spreadsheet would take for a formula with an apostrophe before it."""
    if isinstance(value, str) and (value[:1] in {"=", "+", "@"} or re.match(r"-\D", value)):
        return f"'{value}"
    return value


def points(groups: Iterable[Dataset]) -> Dataset:
    """What the groups say of each point: the variables of the dimensions that most of them have.

    Curves are left out: a dimension with more than one place that only some variables have is one.
    """
    import xarray as xr

    every = [spread(data) for data in groups]
    counts = Counter(
        frozenset(map(str, v.dims)) for data in every for v in data.data_vars.values() if v.dims
    )
    wanted = max(counts, key=lambda dims: counts[dims])
    parts: list[Dataset] = []
    for data in every:
        own = [n for n, v in data.data_vars.items() if frozenset(map(str, v.dims)) == wanted]
        taken = {n for part in parts for n in part.data_vars}
        parts.append(data[[n for n in own if n not in taken]])
    kept = [part for part in parts if part.data_vars]
    return xr.merge(kept, combine_attrs="drop_conflicts", compat="no_conflicts")


def spread(data: Dataset, dim: str = "bearing") -> Dataset:
    """What every ``bearing`` has of a point as variables of the point, one for each by its name."""
    if dim not in data.dims or "names" not in data[dim].attrs:
        return data
    names = [one.replace(" ", "_") for one in json.loads(data[dim].attrs["names"])]
    own = {
        f"{name}_{word}": variable.isel({dim: place})
        for name, variable in data.data_vars.items()
        if dim in variable.dims
        for place, word in enumerate(names)
    }
    return data.assign({name: one.drop_vars(dim) for name, one in own.items()})


def _frame(data: Dataset, units: str) -> pd.DataFrame:
    frame = in_words(data).to_dataframe().reset_index()
    dims = [name for name in map(str, data.dims) if name in frame.columns]
    first = [*dims, *(name for name in FIRST if name in frame.columns)]
    frame = frame[[*first, *(name for name in map(str, frame.columns) if name not in first)]]
    heads = {}
    for column in map(str, frame.columns):
        if column not in data.variables or {"flag_meanings", "flags"} & set(data[column].attrs):
            continue
        unit = str(data[column].attrs.get("units", ""))
        # a time of minutes is no number of milliseconds
        if units == "display" and unit and not (unit == "s" and frame[column].abs().max() > 1.0):
            shown = display(column, unit)
            frame[column], unit = shown(frame[column]), shown.unit
        if unit:
            heads[column] = f"{column} [{unit}]"
    named: pd.DataFrame = frame.rename(columns=heads)
    named.attrs["units"] = units
    return named


def in_words(data: Dataset) -> Dataset:
    """The same with the words of its flags in place of their numbers."""
    words: dict[Any, Any] = {
        name: (variable.dims, json.loads(variable.attrs["names"]))
        for name, variable in data.coords.items()
        if "names" in variable.attrs and variable.dims == (name,)
    }
    if "state" in data.dims and "state_names" in data.attrs:
        words["state"] = (("state",), json.loads(data.attrs["state_names"]))
    if "direction" in data.coords:
        words["direction"] = (("direction",), np.where(data["direction"].values > 0, "up", "down"))
    for name, variable in data.data_vars.items():
        if "flag_meanings" in variable.attrs:
            meanings = np.array([*str(variable.attrs["flag_meanings"]).split(), "unknown"])
            places = variable.values.astype(int)
            known = (places >= 0) & (places < meanings.size - 1)
            words[name] = (variable.dims, meanings[np.where(known, places, -1)])
        elif "missing_value" in variable.attrs:
            # no coordinates: those of the frame are words by now
            counts, none = variable.values, variable.attrs["missing_value"]
            words[name] = (variable.dims, np.where(counts == none, np.nan, counts), variable.attrs)
        elif "flag_masks" in variable.attrs and "flags" in variable.attrs:
            words[name] = (variable.dims, _sums(variable))
    return data.assign(words)


def _sums(variable: DataArray) -> NDArray[np.object_]:
    """The words of a sum of flags, with spaces between; "none", and "unknown" below zero."""
    flags = list(
        zip(str(variable.attrs["flags"]).split(), variable.attrs["flag_masks"], strict=True)
    )
    told = {
        int(value): "unknown"
        if value < 0
        else " ".join(word for word, mask in flags if int(value) & int(mask)) or "none"
        for value in np.unique(variable.values)
    }
    found = np.empty(variable.shape, dtype=object)
    for place, value in np.ndenumerate(variable.values):
        found[place] = told[int(value)]
    return found
