"""Samples that stay on disk and are read slice by slice; columns that grow row by row."""

from __future__ import annotations

import bisect
import tempfile
import weakref
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from thermogear.base.arrays import Floats

IN_MEMORY = 128 << 20
"""Bytes of a text's columns that are held; more of them go to disk."""
_PIECE = 16 << 20


class FileTable:
    """Frames of ``columns`` numbers each, in a file, one after another from ``offset`` on.

    Read by plain reads and not mapped: memory holds the slice asked for and nothing else,
    however much of the file has been gone through. The file stays open as long as the table lives.
    """

    def __init__(
        self, path: Path, dtype: DTypeLike, *, offset: int, frames: int, columns: int
    ) -> None:
        self._file, self._dtype, self._offset = path.open("rb"), np.dtype(dtype), offset
        self.shape = (frames, columns)
        # not __del__: among garbage in a ring the file itself may be found open first
        weakref.finalize(self, self._file.close)

    def frames(self, key: slice) -> NDArray[Any]:
        """The frames of a slice of step 1, shape (frames, columns)."""
        start, stop, _ = key.indices(self.shape[0])
        count = max(0, stop - start) * self.shape[1]
        size = self._dtype.itemsize
        self._file.seek(self._offset + start * self.shape[1] * size)
        data = self._file.read(count * size)
        whole = len(data) // size // self.shape[1]
        return np.frombuffer(data, self._dtype, whole * self.shape[1]).reshape(whole, -1)

    def __getitem__(self, key: tuple[slice, int]) -> Any:
        return self.frames(key[0])[:, key[1]]


class UnnamedFile:
    """An unnamed file that lives as long as whoever reads from it."""

    def __init__(self) -> None:
        self.file: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 (closed below)
        weakref.finalize(self, self.file.close)


class StoredColumn:
    """One column of rows that lie on disk block by block, read slice by slice.

    ``firsts``: the first row of each block, and the count of all rows; ``offsets``: where this
    column's numbers of each block begin.
    """

    def __init__(self, where: UnnamedFile, *, firsts: list[int], offsets: list[int]) -> None:
        self._where, self._firsts, self._offsets = where, firsts, offsets

    def __len__(self) -> int:
        return self._firsts[-1]

    def __getitem__(self, key: slice) -> Floats:
        start, stop, _ = key.indices(len(self))
        parts = [np.empty(0)]
        block = bisect.bisect_right(self._firsts, start) - 1
        while start < stop:
            end = min(stop, self._firsts[block + 1])
            self._where.file.seek(self._offsets[block] + 8 * (start - self._firsts[block]))
            parts.append(np.frombuffer(self._where.file.read(8 * (end - start))))
            start, block = end, block + 1
        return np.concatenate(parts)


class ColumnStore:
    """Appended tables, kept column by column; beyond ``IN_MEMORY`` bytes they go to disk.

    In memory the peak is the data once plus one column, on disk a few blocks of rows.
    """

    def __init__(self, columns: int) -> None:
        self.rows = 0
        self._parts: list[list[Floats]] = [[] for _ in range(columns)]
        self._where: UnnamedFile | None = None
        self._firsts, self._starts = [0], [0]

    def append(self, table: Floats) -> None:
        """Rows of all columns."""
        self.rows += table.shape[0]
        for place, part in enumerate(self._parts):
            part.append(np.ascontiguousarray(table[:, place], dtype=float))
        held = 8 * (self.rows - self._firsts[-1]) * len(self._parts)
        if held > (IN_MEMORY if self._where is None else _PIECE):
            self._spill()

    def _spill(self) -> None:
        self._where = self._where or UnnamedFile()
        for part in self._parts:
            for piece in part:
                self._where.file.write(piece.tobytes())
            part.clear()
        self._firsts.append(self.rows)
        self._starts.append(self._where.file.tell())

    def columns(self) -> Sequence[Floats | StoredColumn]:
        """The columns; the store is empty afterwards."""
        if self._where is not None:
            if self._firsts[-1] < self.rows:
                self._spill()
            self._where.file.flush()
            sizes = [8 * int(n) for n in np.diff(self._firsts)]
            return [
                StoredColumn(
                    self._where,
                    firsts=self._firsts,
                    offsets=[s + place * n for s, n in zip(self._starts, sizes, strict=False)],
                )
                for place in range(len(self._parts))
            ]
        result = []
        for parts in self._parts:
            result.append(np.concatenate(parts))
            parts.clear()
        return result
