"""Everything that goes wrong, as one line for a person to read."""

from __future__ import annotations

import errno
import logging
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

import click

from thermogear.base.errors import printable

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""A full disk, a full quota, a limit of a file's size."""


def one_line(text: object) -> str:
    """``text`` without line breaks, tabs or control characters."""
    return printable(" ".join(str(text).split()))


def show_path(path: object, before: str = "") -> None:
    """A path on standard output, by itself or after the words ``before``."""
    click.echo(f"{before}{printable(str(path))}")


def put_text(text: str, output: str | None) -> None:
    """Print ``text``, or write it to a new file and print its name."""
    if output is None:
        click.echo(text, nl=False)
        return
    from thermogear.base.files import put_new

    show_path(put_new(Path(output), text))


def say(kind: str, text: object) -> None:
    """``kind: text`` as one line on the error stream."""
    print(f"{kind}: {one_line(text)}", file=sys.stderr, flush=True)


def system_error(error: OSError) -> str:
    """What the system refused, where, and what to do where there is no room."""
    reason = error.strerror or str(error) or type(error).__name__
    if error.errno in NO_ROOM:
        reason += "; make room there and give the same command again"
    return f"{error.filename}: {reason}" if error.filename is not None else reason


DEVELOPERS = (DeprecationWarning, PendingDeprecationWarning, FutureWarning, ResourceWarning)
"""What libraries tell programmers: nobody who gave a command can act on it, so it is dropped."""


class _Lines(logging.Handler):
    """What warns, each text once, as one line: warnings of ours and of libraries, their logs."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.known: set[str] = set()

    def tell(self, text: str) -> None:
        if text not in self.known:
            self.known.add(text)
            say("warning", text)

    def emit(self, record: logging.LogRecord) -> None:
        self.tell(f"{record.name.partition('.')[0]} says: {one_line(record.getMessage())}")

    def show(
        self,
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        text = one_line(message)
        if category.__module__.startswith("thermogear."):
            self.tell(text)
        elif not issubclass(category, DEVELOPERS):
            self.tell(f"a library says ({category.__name__}): {text}")


@contextmanager
def warnings_as_lines() -> Iterator[None]:
    """Print each warning once, as one line, for as long as the block runs; libraries' logs too."""
    from thermogear.base.errors import ValidityWarning

    lines, root = _Lines(), logging.getLogger()
    root.addHandler(lines)
    try:
        with warnings.catch_warnings(action="always", category=ValidityWarning):
            warnings.showwarning = lines.show
            yield
    finally:
        root.removeHandler(lines)
