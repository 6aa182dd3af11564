"""Columns that grow row block by row block, in memory or, when large, in unnamed files."""

from __future__ import annotations

import tempfile
from typing import IO

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class ColumnStore:
    """Appended tables, kept column by column; ``spill`` keeps them on disk (memory maps).

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

    def columns(self) -> list[Floats]:
        """The columns; the store is empty afterwards."""
        if self.rows == 0:
            return []
        if self._files:
            found: list[Floats] = []
            for file in self._files:
                file.flush()
                found.append(np.memmap(file, dtype=np.float64, mode="r", shape=(self.rows,)))
                file.close()
            return found
        result = []
        for parts in self._parts:
            result.append(np.concatenate(parts))
            parts.clear()
        return result
