"""Arrays and matrices that are coded: base64 of little-endian numbers (REXS 1.4 and later)."""

from __future__ import annotations

import base64
import binascii
import struct
from typing import Any

from thermogear.base.errors import InputError, short

_CODES = {"int32": "i", "float32": "f", "float64": "d"}


def decoded_array(code: object, text: object) -> tuple[Any, ...]:
    """The numbers of a coded array; InputError for an unknown code or a length that is no whole
    number of values."""
    letter = _CODES.get(code) if isinstance(code, str) else None
    if letter is None:
        raise InputError("code", short(code), allowed=" | ".join(_CODES))
    try:
        raw = base64.b64decode("".join(str(text).split()), validate=True)
    except (binascii.Error, ValueError) as cause:
        raise InputError("coded array", short(text), allowed="base64") from cause
    size = struct.calcsize(f"<{letter}")
    if len(raw) % size:
        raise InputError(
            "coded array", f"{len(raw)} bytes", allowed=f"a whole number of {code} ({size} bytes)"
        )
    return struct.unpack(f"<{len(raw) // size}{letter}", raw)


def decoded_matrix(code: object, text: object, rows: object, columns: object) -> list[Any]:
    """The rows of a coded matrix, row-major; a missing number of rows or columns follows."""
    flat = decoded_array(code, text)
    high, wide = (_count(one) for one in (rows, columns))
    if high is None and wide is None:
        high = wide = round(len(flat) ** 0.5)
    high = high if high is not None else len(flat) // max(wide or 1, 1)
    wide = wide if wide is not None else len(flat) // max(high, 1)
    if high * wide != len(flat):
        raise InputError("coded matrix", f"{len(flat)} values", allowed=f"{high} x {wide}")
    return [list(flat[k * wide : (k + 1) * wide]) for k in range(high)]


def _count(text: object) -> int | None:
    if text is None:
        return None
    try:
        found = int(str(text))
    except ValueError as cause:
        raise InputError("coded matrix", short(text), allowed="rows and columns") from cause
    return max(found, 0)
