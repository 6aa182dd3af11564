"""Files that are whole or not there: written beside their place, then put into it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from thermogear.base.errors import InputError


@contextmanager
def beside(path: Path) -> Iterator[Path]:
    """A name beside ``path`` to write to; the file takes the place of ``path`` at the end.

    An older file stays until then, and for good where writing fails.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def require_directory(path: Path, field: str = "output") -> None:
    """Refuse a ``path`` that cannot be a directory: a file stands there, or above it."""
    for place in (path, *path.parents):
        if place.exists() and not place.is_dir():
            why = "it is a file" if place == path else f"{place} is a file"
            raise InputError(field, str(path), why=why, fix="name a directory")


def put(path: Path, data: bytes | str) -> Path:
    """Write ``data`` (text as UTF-8), flushed to the disk, whole or not at all; the path."""
    with beside(path) as temporary, temporary.open("wb") as file:
        file.write(data.encode() if isinstance(data, str) else data)
        file.flush()
        os.fsync(file.fileno())
    return path
