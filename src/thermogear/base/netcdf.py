"""Trees of labelled results as sealed netCDF-4 files: one writer, one reader for all of them."""

from __future__ import annotations

import io
import warnings
from pathlib import Path

import xarray as xr

from thermogear.base.errors import InputError, UnsealedWarning
from thermogear.base.files import open_sealed, put_sealed, seal_of


def write_tree(tree: xr.DataTree, path: Path) -> Path:
    """Write ``tree`` as ``path`` (netCDF-4) with its seal beside it, whole or not at all.

    HDF5 writes into memory: a disk that is full is an OSError, and an older file stays.
    """
    made = io.BytesIO()
    tree.to_netcdf(made, engine="h5netcdf")
    return put_sealed(path, made.getbuffer())


def read_tree(path: Path, fix: str = "") -> xr.DataTree:
    """The whole of a stored file, in memory, as it was written.

    Raises InputError, in one line with ``fix``, where the file is missing, is not what its seal
    vouches for, or is no netCDF. A file without a seal is read with an UnsealedWarning: whoever
    opens it cannot know.
    """
    import h5py

    file, sealed = open_sealed(path, field="results", fix=fix)

    try:
        # h5py first: it refuses a damaged file without a second complaint on stderr
        with h5py.File(file, "r") as seen:
            seen.visititems(lambda name, item: None)
        with xr.open_datatree(file, engine="h5netcdf") as tree:
            found = tree.load()
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
