"""Datasets as tables of rows: units in the heads, the words of flags in place of their numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


def frames(data: xr.Dataset) -> dict[tuple[str, ...], pd.DataFrame]:
    """Dimensions (sorted) -> the variables that have them, a row for each place.

    Columns are named ``name [unit]``; single numbers, which have no dimension, are left out.
    """
    families: dict[tuple[str, ...], list[str]] = {}
    for name, variable in data.data_vars.items():
        dims = tuple(sorted(str(d) for d in variable.dims))
        if dims:
            families.setdefault(dims, []).append(str(name))
    found = {}
    for dims, names in families.items():
        frame = _in_words(data[names]).to_dataframe().reset_index()
        units = {
            str(column): f"{column} [{data[column].attrs['units']}]"
            for column in frame.columns
            if column in data.variables and data[column].attrs.get("units")
        }
        found[dims] = frame.rename(columns=units)
    return found


def _in_words(data: xr.Dataset) -> xr.Dataset:
    """The same with the words of its flags in place of their numbers."""
    words = {}
    for name, variable in data.data_vars.items():
        if "flag_meanings" in variable.attrs:
            meanings = np.array(str(variable.attrs["flag_meanings"]).split())
            words[name] = (variable.dims, meanings[variable.values.astype(int)])
    return data.assign(words)
