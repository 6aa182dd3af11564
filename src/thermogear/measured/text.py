"""CSV and TXT in their real variants: separators, decimal comma, units row, encodings, cuts."""

from __future__ import annotations

import gzip
import io
import re
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError, nearest
from thermogear.measured.options import ReadOptions, refused, too_large
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.store import ColumnStore
from thermogear.measured.traps import (
    is_rate_name,
    is_tacho_name,
    is_time_name,
    read_time,
    split_unit,
    without_doubles,
)
from thermogear.measured.units import factor_of, kind_of, unit

Floats = NDArray[np.float64]

_HEAD = 1 << 16
_LINES = 1 << 15  # rows parsed at once
_LONGEST = 1 << 20  # characters of one line
_NUMBER = re.compile(r"^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$")
_MISSING = {"", "nan", "na", "n/a", "null", "-", "--", "inf", "-inf", "#n/a", "-nan", "1.#qnan"}
_META = re.compile(r"^[\s#%;/!\"']*([^:=,;\t]{2,40}?)\s*[:=,;\t]\s*\"?([^\s\"]+)\s*\"?([^\s\"]*)")


@dataclass
class Layout:
    """How the numbers of a text file stand: found from its first lines."""

    separator: str | None  # None: runs of blanks
    decimal: str
    paired: bool  # comma separators and decimal commas: two fields make one number
    columns: int
    names: list[str]
    units: list[str | None]
    skip: int  # lines before the first row
    rate: float | None = None
    notices: list[Notice] = field(default_factory=list)


def read_text(path: Path, options: ReadOptions) -> Record:
    """A record from a CSV or TXT file (also gzipped), read row block by row block."""
    encoding, notes = _encoding(path)
    with _open(path, encoding, options) as lines:
        head = _head(lines)
    layout = _layout(head, path, options)
    layout.notices[:0] = notes
    keep = _kept(layout, options)
    size = path.stat().st_size * (8 if path.suffix == ".gz" else 1)
    store = ColumnStore(len(keep), spill=size > (128 << 20))
    with _open(path, encoding, options) as lines:
        for _ in range(layout.skip):
            next(lines, None)
        for table in _tables(lines, layout, path):
            store.append(table[:, keep])
    columns = store.columns()
    if store.rows == 0:
        raise refused(path, "text", "it holds no row of numbers")
    return _record(path, layout, keep, columns)


# --- opening -------------------------------------------------------------------------------------


class _Counted(io.RawIOBase):
    """A byte stream that refuses to become longer than the limit."""

    def __init__(self, stream: IO[bytes], path: Path, limit: int) -> None:
        self._stream, self._path, self._limit, self._count = stream, path, limit, 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        data = self._stream.read(len(buffer))
        self._count += len(data)
        if self._count > self._limit:
            raise too_large(self._path, self._count, self._limit)
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
    try:
        with _bytes(path) as stream:
            head = stream.read(_HEAD)
    except (OSError, EOFError, zlib.error) as error:
        raise refused(path, "text", error) from error
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16", [Notice("info", "the text is UTF-16")]
    if head.startswith(b"\xef\xbb\xbf"):
        return "utf-8-sig", []
    zeros = head[1::2].count(0), head[0::2].count(0)
    if max(zeros) > 0.4 * len(head) / 2:
        name = "utf-16-le" if zeros[0] >= zeros[1] else "utf-16-be"
        return name, [Notice("info", "the text is UTF-16 without its mark")]
    if b"\0" in head:
        raise refused(path, "text", "it holds zero bytes")
    for name in ("utf-8", "gb18030", "latin-1"):
        try:
            # a character may be cut at the end of the head
            head[: len(head) - 4 if len(head) == _HEAD else None].decode(name)
        except UnicodeDecodeError:
            continue
        if name == "utf-8":
            return name, []
        said = "GBK" if name == "gb18030" else "Latin-1"
        return name, [Notice("info", f"the text is not UTF-8; it is read as {said}")]
    raise refused(path, "text", "unknown encoding")


def _head(lines: io.TextIOWrapper) -> list[str]:
    found: list[str] = []
    size = 0
    while len(found) < 400 and size < 4 * _HEAD:
        line = lines.readline(_LONGEST)
        if not line:
            break
        found.append(line.rstrip("\r\n"))
        size += len(line)
    return found


# --- layout --------------------------------------------------------------------------------------


def _cells(line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    cells = [cell.strip().strip('"').strip() for cell in line.split(separator)]
    if len(cells) > 1 and cells[-1] == "":  # a separator at the end of each row
        cells.pop()
    return cells


def _is_number(cell: str) -> bool:
    return bool(_NUMBER.match(cell)) or cell.lower() in _MISSING


def _is_row(cells: list[str]) -> bool:
    return bool(cells) and all(map(_is_number, cells)) and any(map(_NUMBER.match, cells))


def _layout(head: list[str], path: Path, options: ReadOptions) -> Layout:
    body = [line for line in head if line.strip()]
    if not body:
        raise refused(path, "text", "it is empty")
    separator, decimal = _separator(body, options, path)
    swap = str.maketrans(",", ".") if decimal == "," and separator != "," else None

    def cells(line: str) -> list[str]:
        return _cells(line.translate(swap) if swap else line, separator)

    rows = [i for i, line in enumerate(head) if _is_row(cells(line))]
    # the table starts at the first row that a second one of equal width follows
    start = next(
        (
            i
            for i, j in zip(rows, [*rows[1:], -1], strict=True)
            if j == -1 or (j == i + 1 and len(cells(head[i])) == len(cells(head[j])))
        ),
        None,
    )
    if start is None:
        raise refused(path, "text", "no row of numbers in its first lines")
    width = len(cells(head[start]))
    layout = Layout(separator, decimal, False, width, [], [None] * width, start)
    above = [line for line in head[:start] if line.strip()]
    named = _names(layout, above, separator)
    if separator == "," and options.decimal != ".":
        _paired(layout, named, head[start:], cells, path, options)
    if not layout.names:
        layout.names = [f"column {i + 1}" for i in range(layout.columns)]
    if len(layout.units) != layout.columns:
        layout.units = [None] * layout.columns
    _facts(layout, above)
    return layout


def _separator(body: list[str], options: ReadOptions, path: Path) -> tuple[str | None, str]:
    sample = body[len(body) // 2 :]  # the second half: past the header
    for separator in ("\t", ";"):
        if sum(separator in line for line in sample) > 0.8 * len(sample):
            commas = sum(bool(re.search(r"\d,\d", line)) for line in sample)
            points = sum(bool(re.search(r"\d\.\d", line)) for line in sample)
            if commas and points and options.decimal is None:
                raise refused(path, "text", "it holds both 1,2 and 1.2: give --decimal")
            return separator, options.decimal or ("," if commas else ".")
    if sum("," in line for line in sample) > 0.5 * len(sample):
        blanks = sum(bool(re.search(r"\d\s+[-+\d]", line.strip())) for line in sample)
        if blanks > 0.8 * len(sample):
            return None, ","
        return ",", options.decimal or "."
    return None, options.decimal or "."


def _names(layout: Layout, above: list[str], separator: str | None) -> int:
    """Names and units from the lines above the table; returns how many names stand there."""
    lines = [_cells(line.lstrip("#%").strip(), separator) for line in above]
    if separator is None and above:
        # names may be parted by commas or tabs though the numbers are parted by blanks
        for other in ("\t", ",", ";"):
            if above[-1].count(other) + 1 == layout.columns and layout.columns > 1:
                lines = [_cells(line.lstrip("#%").strip(), other) for line in above]
                break
    if not lines:
        return 0
    units: list[str | None] = [None] * layout.columns
    last = lines[-1]
    known = [unit(cell) for cell in last]
    blank = [cell.strip("[]() -") == "" for cell in last]
    is_units = (
        len(lines) > 1
        and any(known)
        and all(bool(k) or b for k, b in zip(known, blank, strict=True))
    )
    if is_units:
        lines.pop()
        if len(known) == layout.columns:
            units = known
    split = [split_unit(cell) for cell in lines[-1]]
    names = [name for name, _ in split]
    if len(names) == layout.columns and all(names):
        layout.names = names
        layout.units = [u or v for u, (_, v) in zip(units, split, strict=True)]
    elif len(names) > 1 or layout.columns == 1:
        layout.units = units
        return len(names) if len(names) != 1 or layout.columns != 1 else 1
    return len(names) if len(names) > 1 or layout.columns <= 2 else 0


def _paired(
    layout: Layout,
    named: int,
    table: list[str],
    cells: object,
    path: Path,
    options: ReadOptions,
) -> None:
    """Comma separators: decide whether two fields make one number (decimal comma)."""
    rows = [row for row in (_cells(line, ",") for line in table) if _is_row(row)]
    width = layout.columns
    whole = all("." not in cell for row in rows for cell in row)
    halves = width % 2 == 0 and all(
        re.fullmatch(r"\d+([eE][+-]?\d+)?", cell) for row in rows for cell in row[1::2]
    )
    if named == width and options.decimal is None:
        return
    if options.decimal == "," or (named and 2 * named == width):
        if not (whole and halves):
            raise refused(path, "text", "the fields do not pair into numbers with a decimal comma")
        layout.paired, layout.columns = True, width // 2
        layout.notices.append(
            Notice("warning", "commas part both numbers and decimals: two fields make one number")
        )
        layout.units = [None] * layout.columns
        header = [i for i in range(1) if named == layout.columns]
        layout.names = [] if not header else layout.names
        return
    if whole and named and named < width < 2 * named:
        raise refused(
            path,
            "text",
            f"{named} names over rows of {width} fields: some commas part numbers and some are "
            "decimal; save it with another separator",
        )
    if whole and halves and not named:
        raise refused(
            path,
            "text",
            f"rows of {width} whole fields may be {width} integers or {width // 2} numbers with "
            "a decimal comma: give --decimal . or --decimal ,",
        )


def _facts(layout: Layout, above: list[str]) -> None:
    """What the lines above the names state: rate, count of channels, unit."""
    for line in above:
        found = _META.match(line)
        if not found:
            continue
        key, value, tail = found.groups()
        number = value.replace(",", ".")
        key_name, key_unit = split_unit(key)
        if is_rate_name(key_name) and _NUMBER.match(number):
            said = unit(tail) or key_unit
            if said is None or kind_of(said) != "frequency":
                layout.notices.append(
                    Notice(
                        "important",
                        f"the header says {key.strip()} = {value} without a unit: it is not used "
                        "(give --rate)",
                    )
                )
            elif float(number) > 0:
                layout.rate = float(number) * factor_of(said)
        elif re.match(r"(number of )?channels?( count)?$", key_name.strip(), re.I) and re.fullmatch(
            r"\d+", number
        ):
            signals = sum(not is_time_name(name) for name in layout.names)
            if int(number) not in (signals, layout.columns):
                layout.notices.append(
                    Notice(
                        "important",
                        f"the header says {number} channels, the rows hold {signals}",
                    )
                )
        elif key_name.strip().lower() in ("unit", "units", "单位") and unit(value):
            layout.units = [u or unit(value) for u in layout.units]


def _kept(layout: Layout, options: ReadOptions) -> list[int]:
    if not options.keep:
        return list(range(layout.columns))
    wanted = set()
    for key in options.keep:
        if key in layout.names:
            wanted.add(layout.names.index(key))
        elif key.isdigit() and 1 <= int(key) <= layout.columns:
            wanted.add(int(key) - 1)
        else:
            raise InputError("channel", repr(key), fix=nearest(key, layout.names))
    special = {i for i, n in enumerate(layout.names) if is_time_name(n) or is_tacho_name(n)}
    return sorted(wanted | special)


# --- rows ----------------------------------------------------------------------------------------


def _tables(lines: io.TextIOWrapper, layout: Layout, path: Path) -> Iterator[Floats]:
    """Blocks of rows; the last row is held back until it is known to be whole."""
    number = layout.skip
    try:
        while True:
            block = list(islice(lines, _LINES))
            if not block:
                return
            last = len(block) < _LINES
            if last:
                _cut_end(block, layout)
            if block:
                yield _table(block, layout, path, number, last)
            number += len(block)
    except (OSError, EOFError, zlib.error) as error:
        layout.notices.append(
            Notice("important", f"the packed file ends early ({type(error).__name__})")
        )
        raise refused(path, "text", error) from error


def _cut_end(block: list[str], layout: Layout) -> None:
    """Drop a last row that the end of the file has cut."""
    if block[-1].endswith("\n") or len(block) < 2:
        return
    row = _fields(block[-1], layout)
    lengths = [len(f[-1]) for f in (_fields(line, layout) for line in block[-200:-1]) if f]
    cut = len(row) < layout.columns or (lengths and len(row[-1]) < min(lengths))
    if cut:
        block.pop()
        layout.notices.append(Notice("warning", "the last row is cut off and is dropped"))
    else:
        layout.notices.append(
            Notice("info", "the last row has no line end: its last value may be cut")
        )


def _fields(line: str, layout: Layout) -> list[str]:
    if layout.decimal == "," and layout.separator != ",":
        line = line.replace(",", ".")
    cells = _cells(line, layout.separator)
    if layout.paired:
        whole = iter(cells)
        cells = [f"{left}.{right}" for left, right in zip(whole, whole, strict=False)]
    return cells


def _table(block: list[str], layout: Layout, path: Path, number: int, last: bool) -> Floats:
    if not layout.paired:
        swap = layout.decimal == "," and layout.separator != ","
        plain = [line.replace(",", ".") for line in block] if swap else block
        try:
            table = np.loadtxt(plain, delimiter=layout.separator, ndmin=2, comments=None)
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
            if raw.endswith(layout.separator):
                cells.append("")  # an empty last cell, not a missing one
        if len(cells) != layout.columns:
            if last and place == len(block) - 1:
                layout.notices.append(Notice("warning", "the last row is cut off and is dropped"))
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
    if _NUMBER.match(cell):
        return float(cell)
    if cell.lower() in _MISSING:
        return float("nan")
    raise ValueError(f"{cell[:40]!r} is not a number")


# --- the record ----------------------------------------------------------------------------------


def _record(path: Path, layout: Layout, keep: list[int], columns: list[Floats]) -> Record:
    notes = list(layout.notices)
    names = [layout.names[i] for i in keep]
    units = [layout.units[i] for i in keep]
    rate, origin, start = layout.rate, "header" if layout.rate else "", 0.0
    times = [i for i, name in enumerate(names) if is_time_name(name)]
    for place in times[:1]:
        t = np.asarray(columns[place])
        same = {
            int(i) + 1
            for i in np.flatnonzero(np.diff(t) == 0.0)
            if all(c[i] == c[i + 1] for c in columns)
        }
        base = read_time(names[place], units[place], t, same)
        notes += base.notices
        start = base.start
        if base.drop:
            columns = [np.delete(c, base.drop) for c in columns]
        if base.rate is not None and rate is not None and abs(base.rate / rate - 1) > 1e-3:
            notes.append(
                Notice(
                    "important",
                    f"the header says {rate:g} samples/s, the {base.origin} {base.rate:g} "
                    f"(factor {rate / base.rate:.4g}): neither is used (give --rate)",
                )
            )
            rate, origin = None, ""
        elif base.rate is not None:
            rate, origin = base.rate, base.origin
    if len(times) > 1:
        notes.append(Notice("warning", f"{len(times)} time columns; the first is used"))
    channels = [
        Channel(name, column, unit_name)
        for i, (name, unit_name, column) in enumerate(zip(names, units, columns, strict=True))
        if i not in times
    ]
    channels, doubled = without_doubles(channels, path.name)
    tacho = next((c.name for c in channels if is_tacho_name(c.name)), None)
    return Record(tuple(channels), path.name, rate, origin, start, tacho, (*notes, *doubled))
