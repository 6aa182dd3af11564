"""Files, whole or not there: written near their place, then put into it; and what users wrote."""

from __future__ import annotations

import codecs
import hashlib
import io
import itertools
import os
import re
import shutil
import signal
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from thermogear.base.errors import InputError, meant

SCHEMA = 1
"""Version of what results and JSON outputs call and mean things; without one: before the first."""
LOCK = "lock"
"""Stands in every directory that one process at a time writes into; stays with what was written."""
SEAL = ".sha256"
"""Ending of a seal: the digest of the file next to it, as ``sha256sum -c`` reads it."""
PART = ".part"
"""Ending of what is being written; what a kill leaves of it is nothing."""

_OURS = re.compile(rf"\..+\.\d+-\d+{re.escape(PART)}")
"""Names that :func:`beside` gives, and no browser's downloads."""
_number = itertools.count()


@contextmanager
def beside(path: Path, *, new: bool = False) -> Iterator[Path]:
    """A name next to ``path`` to write to; the file replaces ``path`` at the end.

    An older file stays until then, and for good where writing fails; with ``new`` it is refused.
    A link is replaced, not followed. What the system refuses is reported with the name of ``path``.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}-{next(_number)}{PART}")
    try:
        yield temporary
        if new:
            _named_newly(temporary, path)
        else:
            temporary.replace(path)
    except OSError as error:
        if error.filename in (None, str(temporary)):
            error.filename, error.filename2 = str(path), None
        raise
    finally:
        temporary.unlink(missing_ok=True)


def decoded(raw: bytes, errors: str = "strict") -> str:
    """The text of a file a user made: UTF-8, or UTF-16 with its byte-order mark.

    Windows PowerShell 5.1 writes UTF-16 where its output is sent into a file with ``>``.
    """
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw.decode("utf-16", errors)
    return raw.decode("utf-8-sig", errors)


def meant_beside(path: Path, pattern: str = "*") -> str | None:
    """Advice for a ``path`` that is not there: the name beside it that is like its own."""
    try:
        names = [one.name for one in path.parent.glob(pattern)]
    except OSError:
        return None
    return meant(path.name, names, cutoff=0.6)


def require_regular(path: Path, field: str) -> None:
    """Refuse what is there and is no file on a disk: a pipe or a device may never end."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        why = "it is a pipe or a device"
        raise InputError(field, str(path), why=why, fix="write it to a file first")


def require_new_file(path: Path, field: str = "output") -> None:
    """Refuse a ``path`` that cannot be a new file: something is there, or nothing above it."""
    if path.is_dir():
        raise InputError(field, str(path), why="it is a directory", fix="name a file in it")
    if path.exists():
        raise InputError(field, str(path), why="it is there already", fix="name a new file")
    if not path.parent.is_dir():
        raise InputError(field, str(path), why=f"there is no directory {path.parent}")


def require_directory(path: Path, field: str = "output") -> None:
    """Refuse a ``path`` that cannot be a directory: a file is there, or above it."""
    for place in (path, *path.parents):
        if place.exists() and not place.is_dir():
            why = "it is a file" if place == path else f"{place} is a file"
            raise InputError(field, str(path), why=why, fix="name a directory")


def put(path: Path, data: bytes | str) -> Path:
    """Write ``data`` (text as UTF-8), flushed to the disk, whole or not at all; the path."""
    with beside(path) as temporary:
        _write(temporary, data.encode() if isinstance(data, str) else data)
    return path


def put_new(path: Path, data: bytes | str) -> Path:
    """:func:`put` where nothing is; of two processes that name one new file the second is told."""
    require_new_file(path)
    with beside(path, new=True) as temporary:
        _write(temporary, data.encode() if isinstance(data, str) else data)
    return path


def _named_newly(temporary: Path, path: Path) -> None:
    """Give ``temporary`` the name ``path``, unless another process has taken it meanwhile."""
    try:
        os.link(temporary, path)
    except FileExistsError:
        require_new_file(path)
    except OSError:  # a disk without links
        temporary.rename(path)


def _write(path: Path, data: bytes | memoryview) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def sync(directory: Path) -> None:
    """Flush the names in ``directory`` to the disk, where the system can."""
    try:
        handle = os.open(directory, os.O_RDONLY)
    except PermissionError:
        return  # Windows opens no directory
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


# --- one writer at a time -------------------------------------------------------------------


@contextmanager
def held(directory: Path, field: str = "output") -> Iterator[None]:
    """``directory`` for this process alone; InputError where another one holds it.

    What killed writers left in it is removed first; :func:`clear_parts` clears folders below it.
    """
    from filelock import FileLock, Timeout

    lock = FileLock(directory / LOCK)
    try:
        lock.acquire(timeout=0)
        if not Path(lock.lock_file).exists():  # its holder left nothing just now
            raise Timeout(lock.lock_file)
    except Timeout:
        raise InputError(
            field,
            str(directory),
            why="another process is writing into it",
            fix="wait for it, or name another directory",
        ) from None
    try:
        clear_parts(directory.iterdir())
        yield
    finally:
        lock.release()


def clear_parts(paths: Iterable[Path]) -> None:
    """Remove those of ``paths`` that killed writers left half written; the folder is held."""
    for path in paths:
        if _OURS.fullmatch(path.name) and not path.is_dir():
            path.unlink(missing_ok=True)


# --- seals ----------------------------------------------------------------------------------


def seal_of(path: Path) -> Path:
    """The place of the seal of ``path``."""
    return path.with_name(path.name + SEAL)


def put_sealed(path: Path, data: bytes | memoryview) -> Path:
    """:func:`put`, and the seal of ``path`` next to it.

    At no moment, not of a kill either, is a file next to a seal that denies it: while the
    new file takes the old one's place the seal vouches for both.
    """
    seal = seal_of(path)
    new = _line(hashlib.sha256(data).hexdigest(), path.name)
    with beside(seal) as last, beside(path) as temporary:
        _write(temporary, data)
        _write(last, new.encode())
        put(seal, new + _old_seal(seal))
        sync(path.parent)
    return path


def _line(digest: str, name: str) -> str:
    return f"{digest}  {name}\n"


def _old_seal(seal: Path) -> str:
    try:
        return seal.read_text(encoding="ascii")
    except (OSError, ValueError):
        return ""


def open_sealed(path: Path, *, field: str, fix: str = "") -> tuple[BinaryIO, bool]:
    """``path`` in memory, as its seal says it was written; and whether there is a seal at all.

    Raises InputError in one line, with ``fix``, where the file is missing, or is not what its
    seal vouches for.
    """
    try:
        raw = path.read_bytes()
    except (FileNotFoundError, IsADirectoryError, NotADirectoryError):
        raise InputError(field, str(path), why="there is no such file", fix=fix) from None
    seal = seal_of(path)
    try:
        lines = seal.read_bytes().splitlines()
    except FileNotFoundError:
        return io.BytesIO(raw), False
    if _line(hashlib.sha256(raw).hexdigest(), path.name).rstrip().encode() not in lines:
        why = f"it is not the file that {seal.name} vouches for; one of them is damaged or changed"
        raise InputError(field, str(path), why=why, fix=fix)
    return io.BytesIO(raw), True


# --- many files at once ---------------------------------------------------------------------

_FOLDER = ".thermogear-"


@contextmanager
def together(directory: Path) -> Iterator[Path]:
    """A new folder inside ``directory``; what is written there is put into place at the end.

    All of it, below the same names, or nothing: after an error or Ctrl+C ``directory`` holds what
    it held before. Links are replaced, and refused where a folder should be. ``directory`` must
    be :func:`held`.
    """
    for old in directory.glob(f"{_FOLDER}*{PART}"):
        shutil.rmtree(old)  # of a process that was killed: nobody else writes here
    folder = directory / f"{_FOLDER}{os.getpid()}-{next(_number)}{PART}"
    folder.mkdir()
    try:
        yield folder
        _put_in_place(folder, directory)
    except OSError as error:
        if isinstance(error.filename, str) and Path(error.filename).is_relative_to(folder):
            error.filename = str(directory / Path(error.filename).relative_to(folder))
        raise
    except KeyboardInterrupt as stop:
        if not stop.args:
            stop.args = (f"nothing was written to {directory}",)
        raise
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _put_in_place(folder: Path, directory: Path) -> None:
    found = sorted(path.relative_to(folder) for path in folder.rglob("*"))
    for name in (name for name in found if (folder / name).is_dir()):
        place = directory / name
        if place.is_symlink():
            raise InputError("output", str(place), why="it is a link", fix="remove the link")
        place.mkdir(exist_ok=True)
    files = [name for name in found if (folder / name).is_file()]
    seals = [name for name in files if name.name.endswith(SEAL)]
    with _uninterrupted():
        for name in seals:
            put(directory / name, (folder / name).read_text() + _old_seal(directory / name))
        for name in (*(name for name in files if name not in seals), *seals):
            (folder / name).replace(directory / name)
        sync(directory)


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Ctrl+C comes too late while the block runs."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
