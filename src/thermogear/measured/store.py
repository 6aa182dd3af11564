"""Rows of numbers that stay on disk and are read column by column."""

from __future__ import annotations

import tempfile
import weakref
from collections.abc import Sequence
from typing import IO

import numpy as np

from thermogear.base.arrays import Floats


class ColumnStore:
    """Appended tables of so many columns, kept in an unnamed file that lives as long as they do.

    The file is mapped: the system takes back the memory of what has been gone through.
    """

    def __init__(self, columns: int) -> None:
        self.rows = 0
        self._columns = columns
        self._file: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 (closed below)
        weakref.finalize(self, self._file.close)

    def append(self, table: Floats) -> None:
        """Rows of all columns."""
        self.rows += table.shape[0]
        self._file.write(np.asarray(table, dtype=float).tobytes())

    def columns(self) -> Sequence[Floats]:
        """The columns of all rows; nothing is appended afterwards."""
        self._file.flush()
        return list(np.memmap(self._file, float, "r", shape=(self.rows, self._columns)).T)
