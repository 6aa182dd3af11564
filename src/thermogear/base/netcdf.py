"""Trees of labelled results as sealed netCDF-4 files: one writer, one reader for all of them."""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterator, Mapping
from itertools import count
from pathlib import Path
from typing import Any, BinaryIO

import h5py
import numpy as np
import xarray as xr
from xarray.conventions import cf_encoder, encode_dataset_coordinates

from thermogear.base.errors import InputError, UnsealedWarning
from thermogear.base.files import open_sealed, put_sealed, seal_of

_NO_VARIABLE = b"This is a netCDF dimension but not a netCDF variable."
_LAYOUT = {
    "CLASS",
    "DIMENSION_LIST",
    "NAME",
    "REFERENCE_LIST",
    "_NCProperties",
    "_Netcdf4Coordinates",
    "_Netcdf4Dimid",
}
"""Attributes that belong to netCDF-4 itself."""
_Scales = dict[Any, "tuple[h5py.Dataset, int]"]
"""Of each dimension its scale and number."""


def write_tree(tree: xr.DataTree, path: Path) -> Path:
    """Write ``tree`` as ``path`` (netCDF-4) with its seal next to it, whole or not at all.

    HDF5 writes into memory: a disk that is full is an OSError, and an older file stays. The same
    is stored as by ``tree.to_netcdf(engine="h5netcdf")``, which opens every group and dimension
    anew for each variable and takes ten times as long.
    """
    made, numbers = io.BytesIO(), count()
    with h5py.File(made, "w", track_order=True) as file:
        versions = f"version=2,h5py={h5py.__version__},hdf5={h5py.version.hdf5_version}"
        file.attrs["_NCProperties"] = np.bytes_(versions)
        scales: dict[str, _Scales] = {}
        for node in tree.subtree:
            above = scales[node.parent.path] if node.parent and node is not tree else {}
            data = node.to_dataset(inherit=node is tree)
            group = file if node is tree else file.create_group(node.path, track_order=True)
            scales[node.path] = _write_group(group, data, above, numbers)
    return put_sealed(path, made.getbuffer())


def _write_group(
    group: h5py.Group, data: xr.Dataset, above: _Scales, numbers: Iterator[int]
) -> _Scales:
    """Write ``data`` into ``group``, CF-encoded; the scales of the dimensions known there.

    A dimension's scale is the variable of its name, or an empty data set; those of the groups
    ``above`` serve too. ``numbers`` counts the dimensions of the file.
    """
    variables, attributes = cf_encoder(*encode_dataset_coordinates(data))
    _write_attributes(group, attributes)
    sizes = {dim: n for one in variables.values() for dim, n in one.sizes.items()}
    own = {dim: n for dim, n in sizes.items() if dim not in above}
    made: dict[Any, h5py.Dataset] = {}
    texts = h5py.string_dtype()
    for name, one in variables.items():
        values = one.values.astype(texts) if one.dtype.kind in "OU" else one.values
        longest = tuple(n or None for n in values.shape) if 0 in values.shape else None
        fill = one.attrs.get("_FillValue")
        made[name] = group.create_dataset(
            name, data=values, fillvalue=fill, maxshape=longest, track_order=True
        )
        _write_attributes(made[name], one.attrs)
    scales = dict(above)
    for dim, n in own.items():
        scale = made.get(dim) or group.create_dataset(dim, (n,), ">f4", maxshape=(n or None,))
        scale.make_scale(dim if dim in made else _NO_VARIABLE + b"%10d" % n)
        scales[dim] = scale, next(numbers)
        scale.attrs["_Netcdf4Dimid"] = np.int32(scales[dim][1])
    for name, one in variables.items():
        if one.dims:
            ids = [scales[dim][1] for dim in one.dims]
            made[name].attrs["_Netcdf4Coordinates"] = np.array(ids, np.int32)
        for place, dim in enumerate(one.dims if name not in own else ()):
            made[name].dims[place].attach_scale(scales[dim][0])
    return scales


def _write_attributes(target: h5py.Group | h5py.Dataset, attributes: Mapping[Any, Any]) -> None:
    """Texts as they are, single numbers as arrays of one, as netCDF has them."""
    for name, value in attributes.items():
        target.attrs[name] = (
            np.atleast_1d(value) if isinstance(value, int | float | np.number) else value
        )


def read_tree(path: Path, fix: str = "") -> xr.DataTree:
    """The whole of a stored file, in memory, as it was written.

    Raises InputError, in one line with ``fix``, where the file is missing, is not what its seal
    vouches for, or is no netCDF. A file without a seal is read with an UnsealedWarning: whoever
    opens it cannot know.
    """
    file, sealed = open_sealed(path, field="results", fix=fix)
    try:
        found = _read(file)
    except (OSError, ValueError, KeyError, TypeError, RuntimeError, AttributeError) as error:
        raise InputError(
            "results", str(path), why="it cannot be read as netCDF; it is damaged", fix=fix
        ) from error
    if not sealed:
        warnings.warn(
            f"{path} has no {seal_of(path).name} beside it: nothing says whether it is as written",
            UnsealedWarning,
            stacklevel=2,
        )
    return found


def _read(file: BinaryIO) -> xr.DataTree:
    """What ``xarray.open_datatree(file, engine="h5netcdf").load()`` gives, in a tenth of the time.

    Files of :func:`write_tree` and of h5netcdf: every variable names its dimensions by number.
    """
    with h5py.File(file, "r") as opened:
        groups: list[h5py.Group] = [opened]
        for group in groups:
            groups.extend(one for one in group.values() if isinstance(one, h5py.Group))
        names = {
            one.attrs["_Netcdf4Dimid"]: name
            for group in groups
            for name, one in group.items()
            if one.attrs.get("CLASS") == b"DIMENSION_SCALE"
        }
        return xr.DataTree.from_dict({one.name: _read_group(one, names) for one in groups})


def _read_group(group: h5py.Group, dimensions: Mapping[int, str]) -> xr.Dataset:
    variables, counts = {}, {}
    for name, one in group.items():
        if isinstance(one, h5py.Group) or bytes(one.attrs.get("NAME", b"")).startswith(
            _NO_VARIABLE
        ):
            continue
        dims = tuple(dimensions[number] for number in one.attrs.get("_Netcdf4Coordinates", ()))
        text = h5py.check_string_dtype(one.dtype)
        values = np.asarray(one.asstr()[()], str) if text else one[()]
        own = _read_attributes(one)
        if values.dtype.kind == "i" and "missing_value" in own:
            # a count stays whole here; others read a missing number
            counts[name] = {"missing_value": own.pop("missing_value")}
        variables[name] = xr.Variable(dims, values, own)
    data = xr.decode_cf(xr.Dataset(variables, attrs=_read_attributes(group)))
    for name, own in counts.items():
        data[name].attrs |= own
    return data


def _read_attributes(source: h5py.Group | h5py.Dataset) -> dict[str, Any]:
    found = {}
    for name, value in source.attrs.items():
        if name not in _LAYOUT:
            several = np.ndim(value) > 0
            values = list(value) if several and value.dtype.kind == "O" else value
            found[name] = values[0] if several and len(values) == 1 else values
    return found
