"""What a user may tell every reader, and the refusals they share."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from thermogear.base.errors import InputError, meant

LEAST_DECODED = 256 << 20
"""Bytes that any packed file may become."""
DECODED_LIMIT = 8 << 30
"""Most bytes that a packed file may become unless ``--limit`` says otherwise."""
UNPACKED = 32
"""How many times its own size a packed file may become: records of sensors, which hold noise,
become 1.1 to 10 times as large."""
MOST_LIMIT = 1 << 50

A_TEXT = "a text holds a row of numbers for each sample, 256 or more, below their names"
"""What to say of a text that holds no record."""
_NAMED, _NAMED_LETTERS = 12, 40
"""Channels that a refusal names, and letters of one that is not there."""


def decoded_limit(size: int) -> int:
    """Bytes that a packed file (gz, npz, mat, hdf5) of ``size`` bytes may become by itself."""
    return min(DECODED_LIMIT, max(LEAST_DECODED, UNPACKED * size))


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
        if not 1 <= self.limit <= MOST_LIMIT:
            raise InputError("limit", f"{self.limit} bytes", allowed=f"1..{MOST_LIMIT} bytes")


def bytes_of_gibibytes(number: float) -> int:
    """``--limit`` [GiB] as bytes."""
    if not (math.isfinite(number) and 1 <= number * 2**30 <= MOST_LIMIT):
        raise InputError("--limit", f"{number:g} GiB", allowed=f"> 0 .. {MOST_LIMIT >> 30} GiB")
    return int(number * 2**30)


def place_of(key: str, count: int) -> int | None:
    """The place, from 0, that ``key`` means as a number from 1 to ``count``; None otherwise."""
    if not (key.isascii() and key.isdigit() and len(key) <= 9):
        return None
    return int(key) - 1 if 1 <= int(key) <= count else None


def places_of(keys: Iterable[str], names: Sequence[str]) -> list[int]:
    """The places, from 0, of the channels that ``keys`` mean: their names, or numbers from 1.

    >>> places_of(["b", "1"], ["a", "b"])
    [1, 0]
    """
    found = []
    for key in keys:
        place = names.index(key) if key in names else place_of(key, len(names))
        if place is None:
            raise _no_channel(key, names)
        found.append(place)
    return found


def _no_channel(key: str, names: Sequence[str]) -> InputError:
    """The refusal of a channel ``key`` that none of ``names`` is, with the nearest of them."""
    shown = ", ".join(sorted(names)[:_NAMED]) + (", ..." if len(names) > _NAMED else "")
    return InputError(
        "channel",
        repr(key[:_NAMED_LETTERS]),
        allowed=f"1..{len(names)} or a name",
        why=f"known: {shown}",
        fix=meant(key, names, cutoff=0.5),
    )


def no_tacho(error: InputError) -> InputError:
    """The refusal of a channel as that of a tacho, which may be a file as well."""
    why = f"there is no such file and no such channel; {error.why}"
    return InputError("tacho", error.got, allowed=error.allowed, why=why, fix=error.fix)


def refused(path: Path, as_what: str, reason: object, fix: str | None = None) -> InputError:
    """A file that does not hold what its kind promises."""
    text = " ".join(str(reason).split())[:200] or type(reason).__name__
    why = f"cannot be read as {as_what}: {text}"
    return InputError("file", path.name, why=why, fix=fix)


@contextmanager
def refusing(path: Path, as_what: str, *errors: type[Exception]) -> Iterator[None]:
    """What is ``refused`` where reading a damaged file fails by one of these ``errors``."""
    try:
        yield
    except InputError:
        raise
    except errors as error:
        raise refused(path, as_what, error) from error


def too_large(path: Path, *, becomes: int, limit: int) -> InputError:
    """A packed file that would become larger than the limit."""
    return InputError(
        "file",
        path.name,
        why=f"unpacked it is {becomes / 2**30:.3g} GiB or more",
        allowed=f"up to {limit / 2**30:.3g} GiB",
        fix="raise --limit if that is meant",
    )
