"""Files, whole or not there: written beside their place, then put into it; and what users wrote."""

from __future__ import annotations

import codecs
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


def decoded(raw: bytes, errors: str = "strict") -> str:
    """The text of a file a user made: UTF-8, or UTF-16 with its byte-order mark.

    Windows PowerShell 5.1 writes UTF-16 where its output is sent into a file with ``>``.
    """
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw.decode("utf-16", errors)
    return raw.decode("utf-8-sig", errors)


def require_new_file(path: Path, field: str = "output") -> None:
    """Refuse a ``path`` that cannot be a new file: something stands there, or nothing above it."""
    if path.is_dir():
        raise InputError(field, str(path), why="it is a directory", fix="name a file in it")
    if path.exists():
        raise InputError(field, str(path), why="it is there already", fix="name a new file")
    if not path.parent.is_dir():
        raise InputError(field, str(path), why=f"there is no directory {path.parent}")


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
