"""NPZ and NPY: the zip directory is read before anything is unpacked; no pickle, ever."""

from __future__ import annotations

import math
import warnings
import zipfile
import zlib
from pathlib import Path
from tokenize import TokenError
from typing import IO

import numpy as np
from numpy.lib import format as npy

from thermogear.measured.options import ReadOptions, refused, refusing, too_large
from thermogear.measured.record import Record
from thermogear.measured.tables import Named, record_of

_MOST_MEMBERS = 4096


def read_npz(path: Path, options: ReadOptions) -> Record:
    """A record from an NPZ file; stored (not compressed) members would still be copied once."""
    # zipfile raises a RuntimeError for encrypted members and for compressions it does not know
    damages = zipfile.BadZipFile, zlib.error, OSError, EOFError, ValueError, KeyError, RuntimeError
    with refusing(path, "NPZ", *damages), zipfile.ZipFile(path) as file:
        members = [m for m in file.infolist() if m.filename.endswith(".npy")]
        if len(members) > _MOST_MEMBERS:
            raise refused(path, "NPZ", f"it holds {len(members)} arrays")
        total = sum(m.file_size for m in members)
        if total > options.limit:
            raise too_large(path, becomes=total, limit=options.limit)
        arrays = []
        for member in members:
            if member.flag_bits & 0x1:
                raise refused(path, "NPZ", f"{member.filename} is encrypted")
            with file.open(member) as stream:
                array = _array(stream, member.file_size, path)
            if array is not None:
                name = member.filename.removesuffix(".npy")
                arrays.append(Named(name, array, array.shape))
    return record_of(path, "NPZ", arrays, options, {})


def read_npy(path: Path, options: ReadOptions) -> Record:
    """A record from one NPY file, kept on disk as a memory map."""
    damages = OSError, ValueError, EOFError, OverflowError, SyntaxError, TypeError, TokenError
    with refusing(path, "NPY", *damages), warnings.catch_warnings(action="ignore"):
        data = np.load(path, mmap_mode="r", allow_pickle=False)
        if data.dtype.kind not in "iufb" or data.size == 0:
            raise refused(path, "NPY", f"it holds {data.dtype} of shape {data.shape}")
    return record_of(path, "NPY", [Named(path.stem, data, data.shape)], options, {})


def _header(stream: IO[bytes], path: Path) -> tuple[tuple[int, ...], bool, np.dtype[np.generic]]:
    damages = TokenError, SyntaxError, TypeError, EOFError, OverflowError
    with refusing(path, "NPY", *damages), warnings.catch_warnings():
        # numpy's remark on headers of Python 2 is not for the user
        warnings.simplefilter("ignore", UserWarning)
        version = npy.read_magic(stream)
        if version == (1, 0):
            shape, fortran, dtype = npy.read_array_header_1_0(stream)
        elif version == (2, 0):
            shape, fortran, dtype = npy.read_array_header_2_0(stream)
        else:
            raise refused(path, "NPY", f"version {version}")
    if any(n < 0 for n in shape):
        raise refused(path, "NPY", f"shape {shape}")
    return shape, fortran, dtype


def _array(stream: IO[bytes], size: int, path: Path) -> np.ndarray | None:
    """One member; None for what holds no plain numbers. Text may be a unit, so it is left out."""
    shape, fortran, dtype = _header(stream, path)
    if dtype.hasobject or dtype.kind not in "iufbc":
        return None
    need = math.prod(shape) * dtype.itemsize
    if need > size:
        raise refused(path, "NPZ", f"a member states {need} bytes and has {size}")
    data = stream.read(need)
    if len(data) != need:
        raise refused(path, "NPZ", "a member ends early")
    return np.frombuffer(data, dtype).reshape(shape, order="F" if fortran else "C")
