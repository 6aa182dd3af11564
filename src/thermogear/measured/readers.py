"""``read_record``: one door for every format, chosen by what the file is, not by its name."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from pathlib import Path

from thermogear.base.errors import InputError, meant
from thermogear.base.files import require_regular
from thermogear.measured.hdf import read_hdf
from thermogear.measured.matlab import read_mat
from thermogear.measured.optional import read_mdf, read_tdms, read_uff
from thermogear.measured.options import ReadOptions, decoded_limit, no_tacho
from thermogear.measured.packed import read_npy, read_npz
from thermogear.measured.record import Record
from thermogear.measured.text import read_text
from thermogear.measured.traps import examined
from thermogear.measured.wave import read_wave

Reader = Callable[[Path, ReadOptions], Record]

_HDF = b"\x89HDF\r\n\x1a\n"
READERS: dict[str, Reader] = {
    "HDF5": read_hdf,
    "MAT": read_mat,
    "MDF": read_mdf,
    "NPY": read_npy,
    "NPZ": read_npz,
    "TDMS": read_tdms,
    "UFF": read_uff,
    "WAV": read_wave,
    "text": read_text,
}
_LOOKED_AT = 1000  # files of a folder, for one that is named alike
_SUFFIXES = {
    ".h5": "HDF5",
    ".hdf5": "HDF5",
    ".nc": "HDF5",
    ".mat": "MAT",
    ".mf4": "MDF",
    ".mdf": "MDF",
    ".npy": "NPY",
    ".npz": "NPZ",
    ".tdms": "TDMS",
    ".uff": "UFF",
    ".unv": "UFF",
    ".wav": "WAV",
}


def format_of(path: Path) -> str:
    """The kind of a file from its first bytes; from its name only where they do not tell."""
    with path.open("rb") as file:
        head = file.read(520)
    if head.startswith(_HDF) or head[512:520] == _HDF:
        return "HDF5"
    if head[126:128] in (b"IM", b"MI") and path.suffix.lower() == ".mat":
        return "MAT"
    for magic, kind in (
        (b"PK\x03\x04", "NPZ"),
        (b"PK\x05\x06", "NPZ"),
        (b"\x93NUMPY", "NPY"),
        (b"TDSm", "TDMS"),
        (b"MDF ", "MDF"),
        (b"RIFF", "WAV"),
        (b"RF64", "WAV"),
    ):
        if head.startswith(magic):
            return kind
    return _SUFFIXES.get(path.suffix.lower(), "text")


def _beside(path: Path) -> str | None:
    """The file that may be meant, where there is one named alike."""
    if not path.parent.is_dir():
        return f"there is no folder {path.parent}"
    names = [one.name for one in itertools.islice(path.parent.iterdir(), _LOOKED_AT)]
    return meant(path.name, names, cutoff=0.6)


def read_record(
    file: str | Path,
    *,
    rate: float | None = None,
    unit: str | None = None,
    scale: float | None = None,
    channels: Sequence[str | int] = (),
    tacho: str | int | None = None,
    decimal: str | None = None,
    limit: int | None = None,
) -> Record:
    """A record from CSV/TXT (also .gz), MAT, WAV, NPZ, NPY, HDF5, TDMS, UFF or MDF.

    Rate and unit are never guessed: what the file does not state stays None until ``rate``
    [samples/s], ``unit`` (of the vibration channels) or ``scale`` (its units at full scale, for
    integer samples) say it. ``channels`` keeps those alone; ``tacho`` names the tacho channel;
    ``decimal`` is "." or "," where the text leaves it open; ``limit`` bytes is the most that a
    packed file may become (None: :func:`~thermogear.measured.options.decoded_limit` of its
    size). What looks wrong is in ``notices``.

    Raises InputError (one line) for a file that cannot be read.
    """
    path = Path(file)
    if path.is_dir():
        raise InputError("file", str(file), why="it is a directory", fix="name a file in it")
    require_regular(path, "file")
    if not path.is_file():
        raise InputError("file", str(file), why="there is no such file", fix=_beside(path))
    most = decoded_limit(path.stat().st_size) if limit is None else int(limit)
    keep = [str(c) for c in channels]
    if keep and tacho is not None:
        keep.append(str(tacho))
    options = ReadOptions(decimal, tuple(keep), most)
    try:
        record = READERS[format_of(path)](path, options)
    except InputError as error:
        told = error.field == "channel" and keep[len(channels) :] and error.got == repr(keep[-1])
        raise (no_tacho(error) if told else error) from error
    return examined(record.supplied(rate, unit, scale, tacho))
