"""MAT version 5 (and 6, 7): numeric variables, also inside structures; nothing is executed.

The layout is that of "MAT-File Format", The MathWorks: a 128 byte header, then tagged elements;
an element of type 15 is a zlib stream of one variable. A reader of our own sees a variable that
is stored twice, which a dictionary of variables would hide, and checks every size first.
"""

from __future__ import annotations

import math
import mmap
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermogear.measured.options import ReadOptions, refused, refusing, too_large
from thermogear.measured.record import Record
from thermogear.measured.tables import LONGEST_UNIT, Named, record_of

_KINDS = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
    16: "u1",
    17: "u2",
    18: "u4",
}
_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCT, _CHAR, _OPAQUE = 1, 2, 4, 17
_TEXTS = {1: "latin-1", 2: "latin-1", 4: "utf-16*", 16: "utf-8", 17: "utf-16*"}
_DEEPEST = 8
_MOST_PARTS = 1 << 16
"""Elements of one file or variable: fields of structures and their numbers."""


class _Malformed(Exception):
    """What the bytes do not keep of the format's promises."""


@dataclass(frozen=True)
class _Buffer:
    data: memoryview
    order: str  # "<" or ">"

    def elements(self) -> Iterator[tuple[int, memoryview]]:
        """The tagged elements one after another: (type, bytes)."""
        place, end = 0, len(self.data)
        for _ in range(_MOST_PARTS):
            if place + 8 > end:
                return
            first, second = struct.unpack(self.order + "II", self.data[place : place + 8])
            if first >> 16:  # small element: size and type share a word, data follow at once
                kind, size, start = first & 0xFFFF, first >> 16, place + 4
                if size > 4:
                    raise _Malformed(f"a small element of {size} bytes")
                following = place + 8
            else:
                kind, size, start = first, second, place + 8
                padded = size if kind == _COMPRESSED else -(-size // 8) * 8
                following = start + padded
            if start + size > end:
                raise _Malformed(f"an element of {size} bytes where {end - start} are left")
            yield kind, self.data[start : start + size]
            place = following
        raise _Malformed(f"more than {_MOST_PARTS} elements")


def read_mat(path: Path, options: ReadOptions) -> Record:
    """A record from a MAT file of version 5 to 7 (7.3 is HDF5 and read as such)."""
    with path.open("rb") as file:
        whole = path.stat().st_size >= 136
        # numbers that are not packed stay in the file
        raw = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) if whole else b""
    if raw[126:128] not in (b"IM", b"MI"):
        raise refused(path, "MAT", "no version 5 header (save it with -v7 or -v7.3)")
    order = "<" if raw[126:128] == b"IM" else ">"
    arrays: list[Named] = []
    left = options.limit
    damages = _Malformed, zlib.error, struct.error, ValueError, OverflowError
    with refusing(path, "MAT", *damages):
        for kind, body in _Buffer(memoryview(raw)[128:], order).elements():
            if kind == _COMPRESSED:
                packed, left = _unpacked(body, order, left, path, options)
                for inner, content in _Buffer(memoryview(packed), order).elements():
                    if inner == _MATRIX:
                        arrays += _matrix(content, order, "", 0)
            elif kind == _MATRIX:
                arrays += _matrix(body, order, "", 0)
    return record_of(path, "MAT", arrays, options, {})


def _unpacked(
    body: memoryview, order: str, left: int, path: Path, options: ReadOptions
) -> tuple[bytes, int]:
    """One packed variable, whose own tag says its size before it is unpacked; what is left."""
    engine = zlib.decompressobj()
    tag = engine.decompress(body, 8)
    if len(tag) < 8:
        raise _Malformed("a packed variable that ends at once")
    size = int(struct.unpack(order + "I", tag[4:])[0])
    left -= size
    if left < 0:
        raise too_large(path, becomes=options.limit - left, limit=options.limit)
    return tag + engine.decompress(engine.unconsumed_tail, size) if size else tag, left


def _matrix(body: memoryview, order: str, prefix: str, depth: int) -> list[Named]:
    """The numeric arrays and short texts of one variable, those inside structures by their dotted
    names."""
    if depth > _DEEPEST or len(body) == 0:
        return []
    parts = list(_Buffer(body, order).elements())
    if len(parts) < 3 or len(parts[0][1]) < 8:
        raise _Malformed("a variable without flags, dimensions and name")
    flags = struct.unpack(order + "I", parts[0][1][:4])[0]
    kind, is_complex = flags & 0xFF, bool(flags & 0x0800)
    if kind == _OPAQUE:
        texts = [bytes(part[1]).decode("ascii", "replace") for part in parts[1:4]]
        return [Named(f"{prefix}{texts[0]} ({texts[-1]})", None, ())]
    shape = tuple(int(n) for n in np.frombuffer(parts[1][1], order + "i4"))
    if len(shape) < 2 or any(n < 0 for n in shape):
        raise _Malformed(f"dimensions {shape}")
    own = bytes(parts[2][1]).decode("ascii", "replace").strip("\0")
    name = prefix + own if own else prefix.rstrip(".")
    if kind == _STRUCT:
        return _structure(parts, order, name, shape, depth)
    if kind == _CELL:
        return _cells(parts[3:], order, name, shape, depth)
    if kind == _CHAR:
        return [Named(name, _text(parts, order), ())]
    # without a name MATLAB keeps what its objects hold
    if not name or not 6 <= kind <= 15 or len(parts) < 4:
        return []
    if is_complex:  # no record: what it is called and how large it is will do
        return [Named(name, np.broadcast_to(np.complex128(0.0), shape), shape)]
    stored, content = parts[3]
    if stored not in _KINDS:
        raise _Malformed(f"numbers of type {stored}")
    dtype = np.dtype(order + _KINDS[stored])
    if math.prod(shape) * dtype.itemsize != len(content):
        raise _Malformed(f"{name}: {len(content)} bytes for the dimensions {shape}")
    values = np.frombuffer(content, dtype).reshape(shape, order="F")
    return [Named(name, values, shape)]


def _structure(
    parts: list[tuple[int, memoryview]],
    order: str,
    name: str,
    shape: tuple[int, ...],
    depth: int,
) -> list[Named]:
    if len(parts) < 5 or len(parts[3][1]) < 4:
        return []
    width = struct.unpack(order + "i", parts[3][1][:4])[0]
    text = bytes(parts[4][1])
    if width <= 0 or len(text) % width:
        raise _Malformed("field names of a structure")
    fields = [
        text[i : i + width].split(b"\0")[0].decode("ascii", "replace")
        for i in range(0, len(text), width)
    ]
    found: list[Named] = []
    if not fields:
        return found
    # the structures of an array one after another, each with all its fields
    one = math.prod(shape) == 1
    for place, (kind, body) in enumerate(parts[5:]):
        number, field = divmod(place, len(fields))
        if kind == _MATRIX:
            which = name if one else f"{name}({number + 1})"
            found += _matrix(body, order, f"{which}.{fields[field]}.", depth + 1)
    return found


def _text(parts: list[tuple[int, memoryview]], order: str) -> str:
    """The text of a variable of characters, where it may be a unit; of any other ""."""
    stored, content = parts[3] if len(parts) > 3 else (0, memoryview(b""))
    if stored not in _TEXTS or len(content) > LONGEST_UNIT:
        return ""
    wide = {"<": "-le", ">": "-be"}[order]
    return bytes(content).decode(_TEXTS[stored].replace("*", wide), "replace").strip()


def _cells(
    parts: list[tuple[int, memoryview]],
    order: str,
    name: str,
    shape: tuple[int, ...],
    depth: int,
) -> list[Named]:
    """The arrays in a cell array, numbered from 1."""
    found: list[Named] = []
    for number, (kind, body) in enumerate(parts[: math.prod(shape)], start=1):
        if kind == _MATRIX:
            found += _matrix(body, order, f"{name}{{{number}}}.", depth + 1)
    return found
