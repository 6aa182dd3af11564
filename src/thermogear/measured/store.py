"""Samples that stay on disk and are read slice by slice; columns that grow row by row."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

Floats = NDArray[np.float64]


class FileTable:
    """Frames of ``columns`` numbers each, in a file, one after another from ``offset`` on.

    Read by plain reads and not mapped: memory holds the slice asked for and nothing else,
    however much of the file has been gone through.
    """

    def __init__(
        self, file: IO[bytes], dtype: DTypeLike, *, offset: int, frames: int, columns: int = 1
    ) -> None:
        self._file, self._dtype, self._offset = file, np.dtype(dtype), offset
        self.shape = (frames, columns)

    @classmethod
    def of(
        cls, path: Path, dtype: DTypeLike, *, offset: int, frames: int, columns: int = 1
    ) -> FileTable:
        """The table in a file that stays open as long as the table lives."""
        return cls(path.open("rb"), dtype, offset=offset, frames=frames, columns=columns)

    def __len__(self) -> int:
        return self.shape[0]

    def frames(self, key: slice) -> NDArray[Any]:
        """The frames of a slice of step 1, shape (frames, columns)."""
        start, stop, _ = key.indices(self.shape[0])
        count = max(0, stop - start) * self.shape[1]
        size = self._dtype.itemsize
        self._file.seek(self._offset + start * self.shape[1] * size)
        data = self._file.read(count * size)
        whole = len(data) // size // self.shape[1]
        return np.frombuffer(data, self._dtype, whole * self.shape[1]).reshape(whole, -1)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice):
            return self.frames(key)[:, 0]
        rows, column = key
        return self.frames(rows)[:, column]

    def __del__(self) -> None:
        self._file.close()


class ColumnStore:
    """Appended tables, kept column by column; ``spill`` keeps them on disk.

    The unnamed files disappear with their arrays. In memory the peak is the data once plus one
    column; spilled it is one block of rows.
    """

    def __init__(self, columns: int, spill: bool) -> None:
        self.rows = 0
        self._parts: list[list[Floats]] = [[] for _ in range(columns)]
        self._files: list[IO[bytes]] = [
            # the arrays own these files: closed when they go
            tempfile.TemporaryFile()  # noqa: SIM115
            for _ in range(columns if spill else 0)
        ]

    def append(self, table: Floats) -> None:
        """Rows of all columns."""
        self.rows += table.shape[0]
        for place in range(table.shape[1]):
            column = np.ascontiguousarray(table[:, place], dtype=float)
            if self._files:
                self._files[place].write(column.tobytes())
            else:
                self._parts[place].append(column)

    def columns(self) -> Sequence[Floats | FileTable]:
        """The columns; the store is empty afterwards."""
        if self.rows == 0:
            return []
        if self._files:
            found = []
            for file in self._files:
                file.flush()
                found.append(FileTable(file, np.float64, offset=0, frames=self.rows))
            return found
        result = []
        for parts in self._parts:
            result.append(np.concatenate(parts))
            parts.clear()
        return result
