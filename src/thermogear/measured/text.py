"""CSV and TXT in their real variants: separators, decimal comma, units row, encodings, cuts."""

from __future__ import annotations

import gzip
import io
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.cells import MISSING, NUMBER, cells_of
from thermogear.measured.choosing import is_time_column, time_column
from thermogear.measured.clock import has_clocks, is_stamp_name, without_clocks
from thermogear.measured.encodings import encoding_of
from thermogear.measured.labview import Stated
from thermogear.measured.layout import Layout, find_layout
from thermogear.measured.options import (
    A_TEXT,
    ReadOptions,
    places_of,
    refused,
    refusing,
    too_large,
)
from thermogear.measured.parts import with_gaps
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.store import ColumnStore, StoredColumn
from thermogear.measured.traps import (
    MOST_STAMPS,
    is_tacho_name,
    is_time_name,
    read_time,
    without_doubles,
)
from thermogear.measured.units import counts_turns

_HEAD = 1 << 16
_LINES = 1 << 15  # rows parsed at once
_CHARACTERS = 1 << 24  # of the rows parsed at once
_LONGEST = 1 << 20  # characters of one line


def read_text(path: Path, options: ReadOptions) -> Record:
    """A record from a CSV or TXT file (also gzipped), read row block by row block."""
    _require_limit(path, options.limit)
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
    keep = _kept(layout, options)
    store = ColumnStore(len(keep))
    with _open(path, encoding, options) as lines:
        for _ in range(layout.skip):
            next(lines, None)
        for table in _tables(lines, layout, path):
            store.append(table[:, keep])
    if store.rows == 0:
        raise refused(path, "text", "it holds no row of numbers", A_TEXT)
    return _record(path, layout, keep, store.columns())


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


def _require_limit(path: Path, limit: int) -> None:
    """Refuse a packed text that becomes longer than ``limit`` [bytes] before any row is parsed."""
    with _bytes(path) as stream:
        if isinstance(stream, gzip.GzipFile):
            counted, block = _Counted(stream, path, limit), memoryview(bytearray(_HEAD))
            while counted.readinto(block):
                pass


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
    return [line.rstrip("\r\n") for line in _some(lines, 400, 4 * _HEAD)[0]]


def _some(lines: io.TextIOWrapper, most: int, characters: int) -> tuple[list[str], bool]:
    """The next lines, up to so many of them or of ``characters``, and whether the file ends."""
    found: list[str] = []
    size = 0
    while len(found) < most and size < characters:
        line = lines.readline(_LONGEST)
        if not line:
            return found, True
        found.append(line)
        size += len(line)
    return found, False


def _kept(layout: Layout, options: ReadOptions) -> list[int]:
    if not options.keep:
        return list(range(layout.columns))
    columns = list(zip(layout.names, layout.units, strict=True))
    times = {i for i, column in enumerate(columns) if is_time_column(*column)}
    waves = layout.waves.columns if layout.waves is not None else {}
    channels = [i for i in range(layout.columns) if i not in times]
    names = [layout.names[i] for i in channels]
    wanted = {channels[place] for place in places_of(options.keep, names)}
    special = {
        i for i, (name, unit) in enumerate(columns) if is_tacho_name(name) or counts_turns(unit)
    }
    if layout.waves is not None:  # a LabVIEW file may hold channels of several rates
        times &= {layout.waves.own_time(i) for i in wanted}
        steps = {waves[i].seconds for i in wanted if i in waves}
        special = {i for i in special if i not in waves or waves[i].seconds in steps}
    return sorted(wanted | times | special)


# --- rows ----------------------------------------------------------------------------------------


def _tables(lines: io.TextIOWrapper, layout: Layout, path: Path) -> Iterator[Floats]:
    """Blocks of rows; the last row is held back until it is known to be whole."""
    number = layout.skip
    while True:
        block, last = _block(lines, path, number)
        if not block:
            return
        if layout.clocks:
            block = [without_clocks(line) for line in block]
        if last:
            _cut_end(block, layout)
        if block:
            yield _table(block, layout, path, number, last)
        number += len(block)


def _block(lines: io.TextIOWrapper, path: Path, number: int) -> tuple[list[str], bool]:
    """The next rows, and whether the file ends with them."""
    block, last = _some(lines, _LINES, _CHARACTERS)
    for place, line in enumerate(block, start=number + 1):
        if len(line) == _LONGEST and not line.endswith("\n"):
            raise refused(path, "text", f"line {place} is longer than {_LONGEST} characters")
    return block, last


def _cut_end(block: list[str], layout: Layout) -> None:
    """Drop a last row that the end of the file has cut."""
    if block[-1].endswith("\n") or len(block) < 2:
        return
    row = _fields(block[-1], layout)
    lengths = [len(f[-1]) for f in (_fields(line, layout) for line in block[-200:-1]) if f]
    cut = len(row) < layout.columns or (lengths and len(row[-1]) < min(lengths))
    if cut:
        block.pop()
        layout.notices.append(Notice.of("last_row_dropped"))
    else:
        layout.notices.append(Notice.of("last_row_unended"))


def _fields(line: str, layout: Layout) -> list[str]:
    if layout.decimal == "," and layout.separator != ",":
        line = line.replace(",", ".")
    cells = cells_of(line, layout.separator)
    if layout.commented:
        cells = cells[: layout.columns]
    return cells


def _table(block: list[str], layout: Layout, path: Path, number: int, last: bool) -> Floats:
    swap = layout.decimal == "," and layout.separator != ","
    plain = [line.replace(",", ".") for line in block] if swap else block
    try:
        used = range(layout.columns) if layout.commented else None
        table = np.loadtxt(plain, delimiter=layout.separator, ndmin=2, comments=None, usecols=used)
        if table.shape[1] == layout.columns:
            return table
    except (ValueError, UserWarning):
        table = np.empty((0, 0))  # gaps, quotes or a broken row: cell by cell below
    rows: list[list[float]] = []
    for place, line in enumerate(block):
        cells = _fields(line, layout)
        if not any(cells):
            continue
        if len(cells) == layout.columns - 1 and layout.separator is not None:
            raw = line.rstrip("\r\n")
            if raw.endswith(layout.separator) or raw.count(layout.separator) + 1 == layout.columns:
                cells.append("")  # an empty last cell, not a missing one
        if len(cells) != layout.columns:
            if last and place == len(block) - 1:
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
    path: Path, layout: Layout, keep: list[int], columns: Sequence[Floats | StoredColumn]
) -> Record:
    names = [layout.names[i] for i in keep]
    units = [layout.units[i] for i in keep]
    stated = _stated(layout, keep)
    notes = [*layout.notices, *stated.notices]
    gaps: tuple[tuple[int, int], ...] = ()
    half, note, jitter = stated.half_width, stated.note, 0.0
    rate, start = stated.rate, stated.start
    origin = "" if rate is None else "header" if layout.rate is not None else "Delta_X"
    table = list(zip(names, units, columns, strict=True))
    times = [i for i, (name, unit_name, _) in enumerate(table) if is_time_column(name, unit_name)]
    best = time_column([table[i] for i in times])
    if layout.waves is not None and (
        stated.several or (best is not None and _empty(columns[times[best]]))
    ):
        best = None  # X_Columns No: the X column is empty
    if best is not None:
        place = times[best]
        t = np.asarray(columns[place][:MOST_STAMPS])
        if t.size < len(columns[place]):
            notes.append(Notice.of("rate_of_first_rows", rows=t.size, column=names[place]))
        base = read_time(names[place], units[place], t, stated=rate is not None)
        notes += base.notices
        start, gaps, jitter = base.start, base.gaps, base.jitter
        if (
            base.rate is not None
            and rate is not None
            and abs(base.rate / rate - 1) > 1e-3 + half / rate
        ):
            notes.append(
                Notice.of(
                    "rate_stated_twice",
                    origin="the header",
                    rate=rate,
                    other_origin=base.origin,
                    other_rate=base.rate,
                    ratio=rate / base.rate,
                )
            )
            rate, origin, half, note = None, "", 0.0, ""
        elif base.rate is not None and (
            rate is None or max(half, abs(base.rate - rate)) > base.half_width
        ):
            rate, origin = base.rate, base.origin
            half, note = base.half_width, base.note
        if len(times) > 1 and layout.waves is None:
            notes.append(Notice.of("several_time_columns", columns=len(times), used=names[place]))
    channels = [
        Channel(name, column, unit_name)
        for i, (name, unit_name, column) in enumerate(zip(names, units, columns, strict=True))
        if i not in times
    ]
    channels, doubled = without_doubles(channels, path.name)
    channels = [with_gaps(one, gaps) for one in channels] if gaps else channels
    tacho = next((c.name for c in channels if is_tacho_name(c.name)), None)
    return Record(
        tuple(channels),
        path.name,
        rate,
        origin,
        start,
        tacho,
        (*notes, *doubled),
        rate_half_width=half,
        rate_note=note,
        jitter=jitter,
    )


def _stated(layout: Layout, keep: list[int]) -> Stated:
    """The rate that the header states for the columns ``keep``."""
    if layout.rate is not None or layout.waves is None:
        return Stated(rate=layout.rate)
    return layout.waves.stated({i: layout.names[i] for i in keep})


def _empty(column: Floats | StoredColumn) -> bool:
    """Whether a column holds no number."""
    return not np.any(np.isfinite(column[:MOST_STAMPS]))
