"""CSV and TXT in their real variants: separators, decimal comma, units row, encodings, cuts."""

from __future__ import annotations

import gzip
import io
import re
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import IO

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.cells import MISSING, NUMBER, cells_of
from thermogear.measured.choosing import is_time_column
from thermogear.measured.clock import has_clocks, is_stamp_name, without_clocks
from thermogear.measured.contract import (
    UNSTATED,
    Stated,
    record_of_channels,
    stated_rate,
    timed,
)
from thermogear.measured.encodings import encoding_of
from thermogear.measured.layout import Layout, find_layout
from thermogear.measured.options import (
    A_TEXT,
    ReadOptions,
    places_of,
    refused,
    refusing,
    too_large,
)
from thermogear.measured.parts import cut
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.store import ColumnStore
from thermogear.measured.traps import MOST_STAMPS, is_tacho_name, is_time_name
from thermogear.measured.units import counts_turns

_HEAD = 1 << 16
_LONGEST = 1 << 20
"""Characters of one line, and of the rows parsed at once."""
_BLOCK = re.compile(r" \(block \d+\)$")


def read_text(path: Path, options: ReadOptions) -> Record:
    """A record from a CSV or TXT file (also gzipped), read row block by row block."""
    encoding, notes = _encoding(path)
    with _open(path, encoding, options) as lines:
        head = _head(lines)
    clocks = has_clocks(head)
    if clocks:
        head = [without_clocks(line) for line in head]
    layout = find_layout(head, path, options)
    layout.clocks = clocks
    if clocks:
        layout.units = [
            "s" if u is None and (is_time_name(n) or is_stamp_name(n)) else u
            for n, u in zip(layout.names, layout.units, strict=True)
        ]
        layout.names = ["time" if is_stamp_name(n) else n for n in layout.names]
    layout.notices[:0] = notes
    keep, named = _kept(layout, options)
    store = ColumnStore(len(keep))
    with _open(path, encoding, options) as lines:
        for _ in range(layout.skip):
            next(lines, None)
        for table in _tables(lines, layout, path):
            store.append(table[:, keep])
    if store.rows == 0:
        raise refused(path, "text", "it holds no row of numbers", A_TEXT)
    return _record(path, layout, keep, named, store.columns())


# --- opening -------------------------------------------------------------------------------------


class _Counted(io.RawIOBase):
    """A byte stream that refuses to become longer than the limit."""

    def __init__(self, stream: IO[bytes], path: Path, limit: int) -> None:
        self._stream, self._path, self._limit, self._count = stream, path, limit, 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        with refusing(self._path, "text", OSError, EOFError, zlib.error):
            data = self._stream.read(len(buffer))
        self._count += len(data)
        if self._count > self._limit:
            raise too_large(self._path, becomes=self._count, limit=self._limit)
        buffer[: len(data)] = data
        return len(data)

    def close(self) -> None:
        self._stream.close()
        super().close()


def _bytes(path: Path) -> IO[bytes]:
    with path.open("rb") as file:
        packed = file.read(2) == b"\x1f\x8b"
    return gzip.open(path, "rb") if packed else path.open("rb")  # type: ignore[return-value]


def _open(path: Path, encoding: str, options: ReadOptions) -> io.TextIOWrapper:
    counted = io.BufferedReader(_Counted(_bytes(path), path, options.limit), 1 << 18)
    return io.TextIOWrapper(counted, encoding=encoding, errors="replace", newline=None)


def _encoding(path: Path) -> tuple[str, list[Notice]]:
    with refusing(path, "text", OSError, EOFError, zlib.error), _bytes(path) as stream:
        head = stream.read(_HEAD)
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16", [Notice.of("text_utf_16")]
    if head.startswith(b"\xef\xbb\xbf"):
        return "utf-8-sig", []
    zeros = head[1::2].count(0), head[0::2].count(0)
    if max(zeros) > 0.4 * len(head) / 2:
        name = "utf-16-le" if zeros[0] >= zeros[1] else "utf-16-be"
        return name, [Notice.of("text_utf_16_unmarked")]
    if b"\0" in head:
        raise refused(path, "text", "it is binary: it holds zero bytes", A_TEXT)
    # a character may be cut at the end of the head
    whole = head[: len(head) - 4 if len(head) == _HEAD else None]
    try:
        whole.decode("utf-8")
    except UnicodeDecodeError:
        found = encoding_of(whole)
    else:
        return "utf-8", []
    return found.codec, [
        Notice.of("text_not_utf_8" if found.likely else "text_doubtful", encoding=found.name)
    ]


def _head(lines: io.TextIOWrapper) -> list[str]:
    """The first 400 lines, or those that begin within four times what tells the encoding."""
    text = lines.read(4 * _HEAD)
    return (text + lines.readline(_LONGEST)).split("\n")[:400]


def _kept(layout: Layout, options: ReadOptions) -> tuple[list[int], tuple[str, ...]]:
    """The columns to keep, with the times and what tells a shaft's angle; names of the channels
    that are asked for, with their blocks."""
    if not options.keep:
        return list(range(layout.columns)), ()
    columns = list(zip(layout.names, layout.units, strict=True))
    times = {i for i, column in enumerate(columns) if is_time_column(*column)}
    channels = [i for i in range(layout.columns) if i not in times]
    blocks = [_BLOCK.search(key) for key in options.keep]
    keys = [_BLOCK.sub("", key) for key in options.keep]
    wanted = [channels[place] for place in places_of(keys, [layout.names[i] for i in channels])]
    special = {
        i for i, (name, unit) in enumerate(columns) if is_tacho_name(name) or counts_turns(unit)
    }
    named = tuple(
        layout.names[i] + (block[0] if block else "")
        for i, block in zip(wanted, blocks, strict=True)
    )
    return sorted({*wanted, *special, *times}), named


# --- rows ----------------------------------------------------------------------------------------


def _tables(lines: io.TextIOWrapper, layout: Layout, path: Path) -> Iterator[Floats]:
    """Blocks of rows; the last row is held back until it is known to be whole."""
    number = layout.skip
    while text := lines.read(_LONGEST):
        last = len(text) < _LONGEST
        text += lines.readline(_LONGEST)
        begin = text.rfind("\n", 0, -1) + 1
        if len(text) - begin > _LONGEST:
            place = number + text.count("\n", 0, begin) + 1
            raise refused(path, "text", f"line {place} is longer than {_LONGEST} characters")
        rows = text.count("\n")
        if layout.clocks:
            text = "\n".join(map(without_clocks, text.split("\n")))
        if not text.endswith("\n"):
            text = _cut_end(text, layout)
        yield _table(text, layout, path, number, last)
        number += rows


def _cut_end(text: str, layout: Layout) -> str:
    """The rows without a last one that the end of the file has cut."""
    above, _, end = text.rpartition("\n")
    if not above:
        return text
    row = _fields(end, layout)
    lengths = [
        len(f[-1]) for f in (_fields(line, layout) for line in above.split("\n")[-199:]) if f
    ]
    cut = len(row) < layout.columns or (lengths and len(row[-1]) < min(lengths))
    layout.notices.append(Notice.of("last_row_dropped" if cut else "last_row_unended"))
    return above if cut else text


def _fields(line: str, layout: Layout) -> list[str]:
    cells = cells_of(layout.plain(line), layout.separator)
    if layout.commented:
        cells = cells[: layout.columns]
    if layout.paired:
        whole = iter(cells)
        cells = [f"{left}.{right}" for left, right in zip(whole, whole, strict=False)]
    return cells


def _table(text: str, layout: Layout, path: Path, number: int, last: bool) -> Floats:
    if not layout.paired:
        try:
            used = range(layout.columns) if layout.commented else None
            lines = io.StringIO(layout.plain(text))
            table = np.loadtxt(
                lines, delimiter=layout.separator, ndmin=2, comments=None, usecols=used
            )
            if table.shape[1] == layout.columns:
                return table
        except (ValueError, UserWarning):
            table = np.empty((0, 0))  # gaps, quotes or a broken row: cell by cell below
    rows: list[list[float]] = []
    block = text.split("\n")
    for place, line in enumerate(block):
        cells = _fields(line, layout)
        if not any(cells):
            continue
        if len(cells) == layout.columns - 1 and layout.separator is not None:
            fields = 0 if layout.paired else line.count(layout.separator) + 1
            if line.endswith(layout.separator) or fields == layout.columns:
                cells.append("")  # an empty last cell, not a missing one
        if len(cells) != layout.columns:
            if last and not any(block[place + 1 :]):
                layout.notices.append(Notice.of("last_row_dropped"))
                break
            raise refused(
                path,
                "text",
                f"line {number + place + 1} has {len(cells)} fields, the others {layout.columns}",
            )
        try:
            rows.append([_value(cell) for cell in cells])
        except ValueError as error:
            raise refused(path, "text", f"line {number + place + 1}: {error}") from error
    return np.asarray(rows, dtype=float).reshape(len(rows), layout.columns)


def _value(cell: str) -> float:
    if NUMBER.match(cell):
        return float(cell)
    if cell.lower() in MISSING:
        return float("nan")
    raise ValueError(f"{cell[:40]!r} is not a number")


# --- the record ----------------------------------------------------------------------------------


def _record(
    path: Path,
    layout: Layout,
    keep: list[int],
    named: tuple[str, ...],
    columns: Sequence[Floats],
) -> Record:
    waves, notices = layout.waves, layout.notices
    header = UNSTATED if layout.rate is None else stated_rate(layout.rate, "header", notices)
    # channels with the time column that is theirs, of each block under one header
    together: dict[tuple[int, int], list[Stated]] = {}
    for i, column in zip(keep, columns, strict=True):
        strange = layout.strange.get(i, "")
        channel = Channel(layout.names[i], column, layout.units[i], strange=strange)
        place, signal = 0, Stated(channel, header, speeds=tuple(layout.speeds))
        if waves is not None and i in waves.columns:
            wave = waves.columns[i]
            base = wave.base(layout.names[i]) if header is UNSTATED else header
            place, signal = waves.own_time(i), replace(signal, base=base, axis=waves.axis)
        elif waves is not None:
            place = i
            if _empty(column):  # X_Columns No
                continue
        by, held = (0, 0) if waves is None else waves.samples(i)
        for block in _blocks(signal, by, held):
            together.setdefault((place, block.block), []).append(block)
    stated = [signal for some in together.values() for signal in timed(some, notices)]
    return record_of_channels(path, "text", stated, notices, keep=named)


def _blocks(signal: Stated, by: int, held: int) -> list[Stated]:
    """A channel's blocks under one LabVIEW header: one ``by`` so many rows, ``held`` by the
    channel; all of it where the header does not say (0)."""
    channel, blocks = signal.channel, []
    for k, first in enumerate(range(0, len(channel), by or len(channel)), start=1):
        part = cut(channel, first=first, count=min(held or len(channel), len(channel) - first))
        name = channel.name if k == 1 else f"{channel.name} (block {k})"
        blocks.append(
            replace(signal, channel=replace(part, name=name), count=held or None, block=k)
        )
    return blocks


def _empty(column: Floats) -> bool:
    """Whether a column holds no number."""
    return not np.any(np.isfinite(column[:MOST_STAMPS]))
