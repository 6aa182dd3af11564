"""HDF5 (also netCDF-4 and MAT 7.3): data sets stay in the file and are read slice by slice."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from thermogear.base.errors import InputError
from thermogear.measured.options import ReadOptions, refused
from thermogear.measured.record import Record
from thermogear.measured.tables import MOST_CHANNELS, Named, record_of

_MOST_SETS = 4096


def read_hdf(path: Path, options: ReadOptions) -> Record:
    """A record from the numeric data sets of an HDF5 file, groups and all.

    Attributes named unit(s) and fs, rate, sampling_rate, ... are read; MATLAB's bookkeeping
    (#refs#) is not. The file stays open as long as the record lives.
    """
    import h5py

    arrays: list[Named] = []
    common: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset) or name.startswith("#"):
            return
        if item.dtype.kind not in "iuf" or item.dtype.names or len(arrays) >= _MOST_SETS:
            return
        if item.external or item.is_virtual:  # data of other files are not fetched
            return
        data: Any = item
        if "MATLAB_empty" in item.attrs:
            return
        shape = tuple(int(n) for n in item.shape or ())
        if len(shape) == 2 and min(shape) > 1 and min(shape) <= MOST_CHANNELS:
            largest = max(shape) * min(shape) * item.dtype.itemsize
            if largest <= (1 << 28) and largest <= options.limit:
                data = item[()]  # one column of a chunked table would read all of it each time
        elif len(shape) <= 1 and max(shape, default=1) == 1:
            data = item[()]
        arrays.append(Named(name, data, shape, dict(item.attrs)))

    try:
        file = h5py.File(path, "r", locking=False)
        common = dict(file.attrs)
        file.visititems(visit)
        return record_of(path, "HDF5", arrays, options, common)
    except InputError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise refused(path, "HDF5", error) from error
