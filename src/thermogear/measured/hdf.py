"""HDF5 (also netCDF-4 and MAT 7.3): data sets stay in the file and are read slice by slice."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from thermogear.measured.options import ReadOptions, refused, refusing, too_large
from thermogear.measured.record import Record
from thermogear.measured.tables import (
    LONGEST_UNIT,
    MOST_CHANNELS,
    Named,
    record_of,
    text_of,
)

_MOST_SETS = 4096
_MOST_SEEN = 1 << 16
"""Items of a file, each time that one is referred to. Chosen: far more than channels."""
_DEEPEST = 64
"""Groups inside one another. Chosen: known writers use up to 6; visiting costs their square."""
_WHOLE = 1 << 28
"""Bytes up to which a data set that is slow in slices is read as a whole."""
_CHUNK = 1 << 20
"""Bytes of a chunk that HDF5 keeps between two slices: larger ones it decodes anew for each."""


def read_hdf(path: Path, options: ReadOptions) -> Record:
    """A record from the numeric data sets of an HDF5 file, groups and all.

    Attributes named unit(s) and fs, rate, sampling_rate, ... are read; of MATLAB's files cells,
    structures and their units, as of version 5, and not its bookkeeping (#refs#). The file stays
    open as long as the record lives.
    """
    import h5py

    with refusing(path, "HDF5", OSError, RuntimeError, KeyError, ValueError, TypeError):
        file = h5py.File(path, "r", locking=False)
        contents = _Contents(file, path, options.limit)
        file.visititems(contents.visit)
        groups = {"": dict(file.attrs)} | contents.groups
        return record_of(path, "HDF5", contents.arrays, options, groups)


class _Contents:
    """What the data sets of a file are, one after another: ``arrays`` and attributes of
    ``groups``."""

    def __init__(self, file: Any, path: Path, limit: int) -> None:
        self.arrays: list[Named] = []
        self.groups: dict[str, dict[str, Any]] = {}
        self._file, self._path, self._limit = file, path, limit
        self._claimed = self._seen = 0

    def visit(self, name: str, item: Any) -> None:
        """Take one data set, or those that one of references points to."""
        self._seen += 1
        if name.count("/") + name.count("{") + name.count("(") >= _DEEPEST:
            raise refused(self._path, "HDF5", f"groups are nested more than {_DEEPEST} deep")
        if self._seen > _MOST_SEEN:
            raise refused(self._path, "HDF5", f"it holds more than {_MOST_SEEN} items")
        if name.startswith("#"):
            return
        if not hasattr(item, "dtype"):
            self.groups[name] = dict(item.attrs)
        elif item.dtype.kind == "O" and item.dtype.metadata and "ref" in item.dtype.metadata:
            self._referred(name, item)
        else:
            self._array(name, item)

    def _referred(self, name: str, item: Any) -> None:
        """The data sets of a cell array, or of a field in an array of structures."""
        parent, _, field = name.rpartition("/")
        cells = "MATLAB_class" in item.attrs
        for number, reference in enumerate(item[()].reshape(-1), start=1):
            if not reference:
                continue
            target = self._file[reference]
            path = f"{name}{{{number}}}" if cells else f"{parent}({number})/{field}"
            self.visit(path, target)
            if hasattr(target, "visititems"):
                target.visititems(
                    lambda inner, each, path=path: self.visit(f"{path}/{inner}", each)
                )

    def _array(self, name: str, item: Any) -> None:
        if "MATLAB_class" in item.attrs:
            name = name.replace("/", ".")
            kind = text_of(item.attrs["MATLAB_class"])
            if "MATLAB_object_decode" in item.attrs:
                self.arrays.append(Named(f"{name} ({kind})", None, ()))
                return
            if kind == "char":
                small = item[()].reshape(-1) if item.size <= LONGEST_UNIT else ()
                self.arrays.append(Named(name, "".join(map(chr, small)), ()))
                return
        if item.dtype.kind not in "iuf" or item.dtype.names or len(self.arrays) >= _MOST_SETS:
            return
        # data of other files are not fetched
        if item.external or item.is_virtual or "MATLAB_empty" in item.attrs:
            return
        data: Any = item
        shape = tuple(int(n) for n in item.shape or ())
        size, chunk = _size(item, shape)
        # what stands in the file byte by byte cannot be a mere claim
        self._claimed += max(0, size - int(item.id.get_storage_size()))
        if self._claimed > self._limit:
            raise too_large(self._path, becomes=self._claimed, limit=self._limit)
        table = len(shape) == 2 and 1 < min(shape) <= MOST_CHANNELS
        # a column of a chunked table would read all of it each time
        if math.prod(shape) == 1 or (size <= _WHOLE and (table or chunk > _CHUNK)):
            data = item[()]
        self.arrays.append(Named(name, data, shape, dict(item.attrs)))


def _size(item: Any, shape: tuple[int, ...]) -> tuple[int, int]:
    """Bytes that a data set takes once it is read, whole chunks; and those of one chunk."""
    if item.chunks is None:
        return math.prod(shape) * item.dtype.itemsize, 0
    whole = math.prod(-(-n // c) * c for n, c in zip(shape, item.chunks, strict=True))
    return whole * item.dtype.itemsize, math.prod(item.chunks) * item.dtype.itemsize
