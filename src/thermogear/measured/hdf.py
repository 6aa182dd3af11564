"""HDF5 (also netCDF-4 and MAT 7.3): data sets stay in the file and are read slice by slice."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from thermogear.measured.options import ReadOptions, refused, refusing, too_large
from thermogear.measured.record import Record
from thermogear.measured.tables import MOST_CHANNELS, Named, record_of

_MOST_SETS = 4096
_DEEPEST = 64
"""Groups inside one another. Chosen: known writers use up to 6; visiting costs their square."""
_WHOLE = 1 << 28
"""Bytes up to which a data set that is slow in slices is read as a whole."""
_CHUNK = 1 << 20
"""Bytes of a chunk that HDF5 keeps between two slices: larger ones it decodes anew for each."""


def read_hdf(path: Path, options: ReadOptions) -> Record:
    """A record from the numeric data sets of an HDF5 file, groups and all.

    Attributes named unit(s) and fs, rate, sampling_rate, ... are read; MATLAB's bookkeeping
    (#refs#) is not. The file stays open as long as the record lives.
    """
    import h5py

    arrays: list[Named] = []
    common: dict[str, Any] = {}
    claimed = 0

    def visit(name: str, item: Any) -> None:
        nonlocal claimed
        if name.count("/") >= _DEEPEST:
            raise refused(path, "HDF5", f"groups are nested more than {_DEEPEST} deep")
        if not isinstance(item, h5py.Dataset) or name.startswith("#"):
            return
        if item.dtype.kind not in "iuf" or item.dtype.names or len(arrays) >= _MOST_SETS:
            return
        # data of other files are not fetched
        if item.external or item.is_virtual or "MATLAB_empty" in item.attrs:
            return
        data: Any = item
        shape = tuple(int(n) for n in item.shape or ())
        size, chunk = _size(item, shape)
        # what stands in the file byte by byte cannot be a mere claim
        claimed += max(0, size - int(item.id.get_storage_size()))
        if claimed > options.limit:
            raise too_large(path, becomes=claimed, limit=options.limit)
        table = len(shape) == 2 and 1 < min(shape) <= MOST_CHANNELS
        # a column of a chunked table would read all of it each time
        if math.prod(shape) == 1 or (size <= _WHOLE and (table or chunk > _CHUNK)):
            data = item[()]
        arrays.append(Named(name, data, shape, dict(item.attrs)))

    with refusing(path, "HDF5", OSError, RuntimeError, KeyError, ValueError, TypeError):
        file = h5py.File(path, "r", locking=False)
        common = dict(file.attrs)
        file.visititems(visit)
        return record_of(path, "HDF5", arrays, options, common)


def _size(item: Any, shape: tuple[int, ...]) -> tuple[int, int]:
    """Bytes that a data set takes once it is read, whole chunks; and those of one chunk."""
    if item.chunks is None:
        return math.prod(shape) * item.dtype.itemsize, 0
    whole = math.prod(-(-n // c) * c for n, c in zip(shape, item.chunks, strict=True))
    return whole * item.dtype.itemsize, math.prod(item.chunks) * item.dtype.itemsize
