"""Stored results: directories of ours, and files that are written whole or not at all."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from thermogear.base.errors import InputError, printable
from thermogear.base.files import LOCK, SCHEMA, held, put, require_directory, together

RESULTS = "results.nc"
SUMMARY = "summary.json"
MARK = ".thermogear"
"""Stands in every directory of ours from before the first result is written."""
_MARKED = "results of thermogear\n"


def json_text(summary: Mapping[str, Any]) -> str:
    """A summary with the version of its schema as a JSON text of lines.

    What is not finite is null; texts are printable.
    """
    content = {"schema": SCHEMA, **summary}
    return json.dumps(finite(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def finite(value: Any) -> Any:
    """NaN and infinity as None, which JSON has no word for; texts as a reader may be shown them."""
    if isinstance(value, str):
        return "\n".join(map(printable, value.split("\n")))
    if isinstance(value, Mapping):
        return {finite(k): finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [finite(v) for v in value]
    if isinstance(value, float) and not abs(value) < float("inf"):
        return None
    return value


def require_ours(directory: Path) -> None:
    """Refuse a ``directory`` that is neither new, nor empty, nor of earlier results."""
    require_directory(directory)
    inside = {path.name for path in directory.iterdir()} if directory.is_dir() else set()
    if inside - {LOCK} and not is_ours(directory):
        raise InputError(
            "output",
            str(directory),
            why="the directory holds files that are not results of thermogear",
            fix="name a new or an empty directory",
        )


@contextmanager
def claimed(directory: Path) -> Iterator[Path]:
    """``directory`` for this process alone, and a folder whose files it gets at the end.

    The directory is made if new; one that holds foreign files, or that another process writes
    into, is refused with an InputError. Whatever is written to the folder yielded is put into
    ``directory`` when the block ends: all of it, or after an error or Ctrl+C nothing; then what
    was made for it, directories, mark and lock, is taken away again.
    """
    require_ours(directory)
    made = [place for place in (directory, *directory.parents) if not place.exists()]
    new = made or not any(directory.iterdir())
    directory.mkdir(parents=True, exist_ok=True)
    with held(directory):
        require_ours(directory)  # it may have come while the lock did
        if not (directory / MARK).is_file():
            put(directory / MARK, _MARKED)
        try:
            with together(directory) as folder:
                yield folder
        except BaseException:
            if new:
                for name in (MARK, LOCK):
                    (directory / name).unlink(missing_ok=True)
                for place in made:
                    place.rmdir()
            raise


def is_ours(directory: Path) -> bool:
    """Whether a run wrote here: its mark is there."""
    try:
        return (directory / MARK).read_bytes().startswith(_MARKED.strip().encode())
    except OSError:
        return False
