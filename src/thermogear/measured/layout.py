"""How the numbers of a text file are written: separator, decimal sign, names, units, facts."""

from __future__ import annotations

import itertools
import re
import statistics
from dataclasses import dataclass, field
from pathlib import Path

from thermogear.base.cells import MISSING, NUMBER, cells_of
from thermogear.measured.clock import comment_column
from thermogear.measured.labview import Waves, waves_of
from thermogear.measured.options import A_TEXT, ReadOptions, refused
from thermogear.measured.record import Notice
from thermogear.measured.traps import (
    SpeedFact,
    is_possible_rate,
    is_rate_name,
    speed_fact,
    split_unit,
)
from thermogear.measured.units import factor_of, kind_of, unit, unknown

MOST_COLUMNS = 4096
_LONGEST_FACT = 400  # characters of a line above the table that are looked at
_META = re.compile(r"^[\s#%;/!\"']*([^:=,;\t]{2,40}?)\s*[:=,;\t]\s*\"?([^\s\"]+)\s*\"?([^\s\"]*)")


@dataclass
class Layout:
    """How the numbers of a text file are written: found from its first lines.

    ``separator`` None: runs of blanks. ``paired``: commas part both numbers and decimals, two
    fields make one number. ``thousands``: the sign that groups digits, "" for none. ``skip``: lines
    before the first row. ``commented``: what follows the columns is a comment; ``clocks``: clock
    stamps are turned to seconds; ``waves``: what a LabVIEW header says;
    ``strange``: units of columns that are none known; ``speeds`` of a shaft that it states.
    """

    separator: str | None
    decimal: str
    paired: bool
    columns: int
    names: list[str]
    units: list[str | None]
    skip: int
    rate: float | None = None
    commented: bool = field(default=False, kw_only=True)
    thousands: str = field(default="", kw_only=True)
    strange: dict[int, str] = field(default_factory=dict, kw_only=True)
    clocks: bool = field(default=False, kw_only=True)
    waves: Waves | None = field(default=None, kw_only=True)
    speeds: list[SpeedFact] = field(default_factory=list, kw_only=True)
    notices: list[Notice] = field(default_factory=list)

    def plain(self, line: str) -> str:
        """A line with its numbers as Python writes them."""
        return plain(line, self.separator, self.decimal, self.thousands)


def plain(line: str, separator: str | None, decimal: str, thousands: str) -> str:
    """A line with numbers as Python writes them.

    >>> plain("1.234,5;2,0", ";", ",", ".")
    '1234.5;2.0'
    """
    line = line.replace(thousands, "") if thousands else line
    return line.replace(",", ".") if decimal == "," and separator != "," else line


def _is_row(cells: list[str]) -> bool:
    numbers = [bool(NUMBER.match(cell)) for cell in cells]
    return any(numbers) and all(
        number or cell.lower() in MISSING for number, cell in zip(numbers, cells, strict=True)
    )


def find_layout(head: list[str], path: Path, options: ReadOptions) -> Layout:
    """The layout of the file that starts with these lines; what is ambiguous is refused."""
    body = [line for line in head if line.strip()]
    if not body:
        raise refused(path, "text", "it is empty", A_TEXT)
    separator, decimal, thousands = _separator(body, options, path)
    table = [cells_of(plain(line, separator, decimal, thousands), separator) for line in head]
    comment = comment_column(table)
    if comment is not None:
        table = [c if i < comment[0] else c[: comment[1]] for i, c in enumerate(table)]
    rows = [i for i, cells in enumerate(table) if _is_row(cells)]
    _fill(table, head, rows, separator)
    # the table starts at the first row that another one of equal width follows at once
    follows = dict(itertools.pairwise(rows))
    start = next(
        (
            i
            for i in rows
            if i not in follows or (follows[i] == i + 1 and len(table[i]) == len(table[i + 1]))
        ),
        None,
    )
    if start is None:
        raise refused(path, "text", "no row of numbers in its first lines", A_TEXT)
    width = len(table[start])
    start = _empty_first(table, start)
    above = [line for line in head[:start] if line.strip().strip(separator)]
    if comment is not None and comment[0] < start:
        above = [line for line in head[: comment[0]] if line.strip()]
        above.append((separator or " ").join(table[comment[0]]))
    names, units = _header(above, separator, width)
    paired = separator == "," and _paired(
        [table[i] for i in rows if i >= start], len(names), path, options
    )
    columns = width // 2 if paired else width
    if columns > MOST_COLUMNS:
        why = f"{columns} columns; allowed 1..{MOST_COLUMNS} (channels stand side by side)"
        raise refused(path, "text", why)
    layout = Layout(separator, decimal, paired, columns, names, units, start)
    layout.commented, layout.thousands = comment is not None, thousands
    _of_labview(layout, above)
    if paired:
        layout.notices.append(Notice.of("commas_ambiguous"))
    if len(names) != columns:
        if len(names) > 1:
            layout.notices.append(Notice.of("names_do_not_fit", names=len(names), columns=columns))
        layout.names = [f"column {i + 1}" for i in range(columns)]
        layout.units = [None] * columns
    _facts(layout, above)
    return layout


def _fill(table: list[list[str]], head: list[str], rows: list[int], separator: str | None) -> None:
    """Give back the empty last cell to rows that lack it, where others or the names have one.

    A separator at the end of every line, names and all, parts nothing.
    """
    if separator is None or not rows:
        return
    counts = [head[i].rstrip("\r\n").count(separator) + 1 for i in rows]
    width = statistics.mode(counts)
    named = [i for i in range(rows[0]) if any(table[i])][-1:]
    if width == 1 or all(len(table[i]) != width for i in (*rows, *named)):
        return
    for i, count in zip(rows, counts, strict=True):
        if count == width == len(table[i]) + 1:
            table[i] = [*table[i], ""]


def _empty_first(table: list[list[str]], start: int) -> int:
    """The first row, at ``start`` or before it, if rows before hold nothing but "NaN"."""
    width = len(table[start])
    while start > 0 and len(table[start - 1]) == width:
        words = [cell.lower().strip("-") for cell in table[start - 1]]
        if not any(words) or not all(word in MISSING for word in words):
            break
        start -= 1
    return start


def _of_labview(layout: Layout, above: list[str]) -> None:
    """Units, steps and starts that a LabVIEW header states for its channels."""
    waves = waves_of(above, layout.separator)
    if waves is None:
        return
    layout.waves = placed = waves.placed(layout.columns)
    if placed.columns and len(layout.names) == layout.columns:
        # LabVIEW counts X in seconds
        layout.units = ["s" if waves.axis == "time" else None] * layout.columns
        for i, wave in placed.columns.items():
            layout.units[i], layout.strange[i] = unit(wave.unit), unknown(wave.unit)


def _separator(body: list[str], options: ReadOptions, path: Path) -> tuple[str | None, str, str]:
    """Separator, decimal sign and the sign that groups thousands, "" for none."""
    sample = body[len(body) // 2 :]  # the second half: past the header
    for separator in ("\t", ";"):
        if sum(separator in line for line in sample) > 0.8 * len(sample):
            commas = sum(bool(re.search(r"\d,\d", line)) for line in sample)
            points = sum(bool(re.search(r"\d\.\d", line)) for line in sample)
            if commas and points:
                signs = [options.decimal] if options.decimal else [",", "."]
                grouped = [sign for sign in signs if _groups(sample, separator, sign)]
                if len(grouped) == 1:
                    return separator, grouped[0], "," if grouped[0] == "." else "."
                if options.decimal is None:
                    raise refused(path, "text", "it holds both 1,2 and 1.2: give --decimal")
            return separator, options.decimal or ("," if commas else "."), ""
    if sum("," in line for line in sample) > 0.5 * len(sample):
        blanks = sum(bool(re.search(r"\d\s+[-+\d]", line.strip())) for line in sample)
        if blanks > 0.8 * len(sample):
            return None, ",", ""
        return ",", options.decimal or ".", ""
    return None, options.decimal or ".", ""


def _groups(sample: list[str], separator: str, decimal: str) -> bool:
    """Whether the sign that is not the ``decimal`` one groups thousands wherever it is."""
    other = "," if decimal == "." else "."
    grouped = re.compile(rf"[+-]?[1-9]\d{{0,2}}(\{other}\d{{3}})+(\{decimal}\d*)?")
    cells = [cell for line in sample for cell in cells_of(line, separator) if other in cell]
    return bool(cells) and all(grouped.fullmatch(cell) for cell in cells)


def _header(
    above: list[str], separator: str | None, width: int
) -> tuple[list[str], list[str | None]]:
    """Names and units from the lines above the table (as many as there are)."""
    if not above:
        return [], []
    parted = separator
    if separator is None and width > 1:
        # names may be parted by tabs or commas though the numbers are parted by blanks
        parted = next((c for c in "\t,;" if above[-1].count(c) + 1 == width), None)
    lines = [cells_of(line.strip().lstrip("#%").strip(), parted) for line in above]
    if separator is None and parted is None and width == 1:
        lines = [[line.strip()] for line in above]  # one column: its name may hold blanks
    units: list[str | None] = [unit(cell) for cell in lines[-1]]
    blank = [cell.strip("[]() -") == "" for cell in lines[-1]]
    only_units = any(units) and all(
        bool(known) or empty for known, empty in zip(units, blank, strict=True)
    )
    if only_units and len(lines) > 1 and len(lines[-2]) == len(lines[-1]):
        names = [split_unit(cell) for cell in lines[-2]]
    else:
        names = [split_unit(cell) for cell in lines[-1]]
        units = [None] * len(names)
    if len(names) == 1 and width > 2:
        return [], []  # a title, not a name
    return (
        [name or f"column {i + 1}" for i, (name, _) in enumerate(names)],
        [known or said for known, (_, said) in zip(units, names, strict=True)],
    )


def _paired(rows: list[list[str]], named: int, path: Path, options: ReadOptions) -> bool:
    """Comma separators: whether two fields make one number with a decimal comma."""
    width = len(rows[0])
    if options.decimal == "." or (named == width and options.decimal is None):
        return False
    rows = [row for row in rows if len(row) == width]
    whole = all("." not in cell for row in rows for cell in row)
    halves = width % 2 == 0 and all(
        re.fullmatch(r"\d+([eE][+-]?\d+)?", cell) for row in rows for cell in row[1::2]
    )
    if options.decimal == "," or (named and 2 * named == width):
        if not (whole and halves):
            why = "the fields do not pair into numbers with a decimal comma"
            odd = next((c for row in rows for c in row if "." in c), None)
            why += "" if odd is None else f": {odd[:20]!r} holds a point"
            raise refused(path, "text", why, "--decimal ." if odd else None)
        return True
    if whole and 0 < named < width < 2 * named:
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
    return False


def _facts(layout: Layout, above: list[str]) -> None:
    """What the lines above the names state: rate and unit."""
    for line in above:
        found = _META.match(line.strip()[:_LONGEST_FACT])
        if not found:
            continue
        key, value, tail = found.groups()
        number = value.replace(",", ".")
        key_name, key_unit = split_unit(key)
        if is_rate_name(key_name) and NUMBER.match(number):
            said = unit(tail) or key_unit
            if said is None or kind_of(said) != "frequency":
                layout.notices.append(
                    Notice.of("rate_without_unit", name=key.strip(), value=float(number))
                )
            elif is_possible_rate(float(number) * factor_of(said)):
                layout.rate = float(number) * factor_of(said)
        elif NUMBER.match(number) and (fact := speed_fact(key, float(number), unit(tail))):
            layout.speeds.append(fact)
        elif key_name.strip().lower() in ("unit", "units", "单位") and unit(value):
            layout.units = [u or unit(value) for u in layout.units]
