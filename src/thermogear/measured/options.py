"""What a user may tell every reader, and the refusals they share."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from thermogear.base.errors import InputError

DECODED_LIMIT = 8 << 30
"""Most bytes that a packed file (gz, npz, mat) may become; ``--limit`` raises it."""


@dataclass(frozen=True)
class ReadOptions:
    """``decimal``: "." or "," where a text file leaves it open; ``limit``: bytes after unpacking.

    ``keep``: names (or numbers from 1) of the channels to keep; the others of a large file are
    then never held.
    """

    decimal: str | None = None
    keep: tuple[str, ...] = ()
    limit: int = DECODED_LIMIT

    def __post_init__(self) -> None:
        if self.decimal not in (None, ".", ","):
            raise InputError("decimal", repr(self.decimal), allowed="'.' or ','")
        if self.limit <= 0:
            raise InputError("limit", self.limit, allowed="> 0 bytes")


def refused(path: Path, as_what: str, reason: object) -> InputError:
    """A file that does not hold what its kind promises."""
    text = " ".join(str(reason).split())[:200] or type(reason).__name__
    return InputError("file", path.name, why=f"cannot be read as {as_what}: {text}")


def too_large(path: Path, *, becomes: int, limit: int) -> InputError:
    """A packed file that would become larger than the limit."""
    return InputError(
        "file",
        path.name,
        why=f"unpacked it is {becomes / 2**30:.3g} GiB",
        allowed=f"up to {limit / 2**30:.3g} GiB",
        fix="raise --limit if that is meant",
    )
