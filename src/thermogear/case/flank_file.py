"""The CSV file of an inspection chart: which column is what, its unit, its sign.

A header names the columns with their units; lines ``# key: value`` above it say what a chart
says in words. What is not said and cannot be known is asked for in the refusal. A block that
starts with a column ``tooth`` holds pitch deviations.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.cells import MISSING, NUMBER, cells_of
from thermogear.base.errors import InputError, nearest, short
from thermogear.base.units import half_digit
from thermogear.case.units import read_quantity

LARGEST = 400_000
"""Characters of a chart's file, at most: more than any chart has points."""
MOST_TRACES = 400
POSITIONS = {
    "diameter": "length",
    "radius": "length",
    "roll angle": "angle",
    "roll length": "length",
    "roll path": "length",
}
"""What a trace may run over, and the kind of its unit."""
SIDES = ("left", "right", "drive", "back")
SIGNS = {"material outside is positive": 1.0, "material inside is positive": -1.0}
KEYS = ("sign", "evaluate", "drive", "teeth")
_EXAMPLE = "diameter [mm], tooth 1 left [um], tooth 1 right [um]"
_HEAD = re.compile(r"(?P<words>[^\[\]()]*?)\s*(?:[\[(]\s*(?P<unit>[^\[\]()]*?)\s*[\])])?")
_RANGE = re.compile(
    r"(?P<over>[a-z ]*?)\s*(?P<low>[-+]?[\d.,]+?)\s*(?P<first>[a-zA-Z°µμ]*)\s*\.\.\s*"
    r"(?P<high>[-+]?[\d.,]+)\s*(?P<unit>[a-zA-Z°µμ]*)"
)


@dataclass(frozen=True, eq=False, kw_only=True)
class FlankFile:
    """What a chart's files hold (SI, material outside positive).

    ``over``: what ``position`` is, a key of :data:`POSITIONS`; ``added`` [m] of shape (trace,
    point) with the ``side`` ("left", "right", "drive", "back") and ``tooth`` of each trace;
    ``rounding``: half a unit of the last digit of the positions;
    ``evaluate``: what the range runs over and its ends; ``drive``: the side that drives; ``pitch``:
    [m] over the teeth by the column's name; ``places``: the line of each point.
    """

    over: str
    position: Floats
    added: Floats
    side: tuple[str, ...]
    tooth: tuple[int, ...]
    places: tuple[str, ...]
    rounding: float = 0.0
    evaluate: tuple[str, float, float] | None = None
    drive: str | None = None
    teeth: int | None = None
    signed: bool = False
    pitch: Mapping[str, Floats] = field(default_factory=dict)


def read_flanks(texts: Mapping[str, str]) -> FlankFile:
    """The traces, and the pitch deviations, in ``texts`` by the name of their file.

    Raises InputError in one line, its field empty, for whatever is missing, doubtful or no chart.
    """
    facts: dict[str, tuple[str, str]] = {}
    blocks = [block for name, text in texts.items() for block in _blocks(name, text, facts)]
    traces = [block for block in blocks if not block.of_pitch]
    if len(traces) != 1:
        name = traces[1].where if traces else ", ".join(texts)
        raise InputError(
            "",
            f"{name}: {len(traces) or 'no'} tables of profile traces",
            allowed="one table over one row of points",
            fix=f"put all teeth side by side: {_EXAMPLE}",
        )
    sign = _sign(facts)
    table = traces[0]
    over, scale = _position(table)
    columns = [_trace(table, place) for place in range(1, len(table.head))]
    if not columns:
        raise table.refused("one column", allowed=f"a position and 1..{MOST_TRACES} traces")
    if len(columns) > MOST_TRACES:
        raise table.refused(f"{len(columns)} traces", allowed=f"1..{MOST_TRACES}")
    named = [column[:2] for column in columns]
    if len(set(named)) < len(named):
        twice = next(trace for place, trace in enumerate(named) if trace in named[:place])
        raise table.refused(f"tooth {twice[1]} {twice[0]} twice", fix="number the teeth")
    values = table.values()
    added = sign * np.stack([values[:, i + 1] * column[2] for i, column in enumerate(columns)])
    for row, column in zip(added, table.head[1:], strict=True):
        try:
            bounds.ADDED.require("", row)
        except InputError as error:
            raise table.refused(
                f"column '{column}' up to {1e3 * np.abs(row).max():.6g} mm",
                allowed=error.allowed,
                fix="correct the unit in the header",
            ) from error
    sides = tuple(column[0] for column in columns)
    return FlankFile(
        over=over,
        position=values[:, 0] * scale,
        added=added,
        side=sides,
        tooth=tuple(column[1] for column in columns),
        places=tuple(table.places),
        rounding=scale * min(map(half_digit, table.positions())),
        evaluate=_range(facts, over),
        drive=_drive(facts, sides, table),
        teeth=_teeth(facts),
        signed="sign" in facts,
        pitch=_pitch([block for block in blocks if block.of_pitch]),
    )


# --- tables of a text ---------------------------------------------------------------------


@dataclass
class _Block:
    """A header and the rows below it; ``where`` names its place, ``comma`` a decimal comma."""

    name: str
    line: int
    head: list[str]
    separator: str
    comma: bool = False
    rows: list[tuple[int, str]] = field(default_factory=list)

    @property
    def where(self) -> str:
        return f"{self.name} line {self.line}"

    @property
    def of_pitch(self) -> bool:
        return _HEAD.fullmatch(self.head[0].lower()) is not None and self.head[
            0
        ].strip().lower() in ("tooth", "tooth number")

    @property
    def places(self) -> list[str]:
        return [f"{self.name} line {line}" for line, _ in self.rows]

    def refused(
        self,
        got: str,
        *,
        allowed: str | None = None,
        why: str | None = None,
        fix: str | None = None,
    ) -> InputError:
        return InputError("", f"{self.where}: {got}", allowed=allowed, why=why, fix=fix)

    def positions(self) -> list[str]:
        """The texts of the first column."""
        rows = (row.replace(",", ".") if self.comma else row for _, row in self.rows)
        return [cells_of(row, self.separator)[0] for row in rows]

    def values(self) -> Floats:
        """The numbers, (row, column)."""
        if len(self.rows) < 2:
            raise self.refused(
                f"{len(self.rows) or 'no'} row{'s' * (len(self.rows) != 1)} of numbers",
                allowed="a row for each point of the trace",
            )
        rows = []
        for line, text in self.rows:
            cells = cells_of(text.replace(",", ".") if self.comma else text, self.separator)
            if len(cells) != len(self.head):
                fix = "part the columns by semicolons where numbers have a decimal comma"
                raise InputError(
                    "",
                    f"{self.name} line {line}: {len(cells)} values",
                    allowed=f"{len(self.head)}, one for each column of the header",
                    fix=fix if self.separator == "," and len(cells) > len(self.head) else None,
                )
            for cell, column in zip(cells, self.head, strict=True):
                if not NUMBER.match(cell):
                    gap = cell.lower() in MISSING
                    raise InputError(
                        "",
                        f"{self.name} line {line}: {short(cell)} in column '{column}'",
                        allowed="a number",
                        fix="leave the row, or the tooth, out" if gap else None,
                    )
            rows.append([float(cell) for cell in cells])
        values = np.array(rows)
        if not np.all(np.isfinite(values)):
            place = int(np.argmin(np.isfinite(values).all(axis=1)))
            raise InputError("", f"{self.places[place]}: a number beyond reason", allowed="finite")
        return values


def _blocks(name: str, text: str, said: dict[str, tuple[str, str]]) -> list[_Block]:
    """The tables of a text; what its lines ``# key: value`` say goes into ``said``."""
    if len(text) > LARGEST:
        raise InputError(
            "",
            f"{name}: {len(text)} characters",
            allowed=f"<= {LARGEST}",
            why="a chart has some hundred points for each tooth",
            fix="leave points or teeth out",
        )
    blocks: list[_Block] = []
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip().strip('"').strip()
        if not bare.strip(",;\t "):
            continue
        if bare.startswith("#"):
            _fact(name, number, bare, said)
        elif _is_header(bare):
            separator = next((sign for sign in ";\t" if sign in line), ",")
            head = cells_of(line.strip(), separator)
            blocks.append(_Block(name, number, head, separator))
            _position_name(blocks[-1])
        elif blocks:
            blocks[-1].rows.append((number, line.strip()))
        else:
            raise InputError(
                "",
                f"{name} line {number}: {short(bare)}",
                allowed="a header above the numbers",
                why="which column is what, in which unit?",
                fix=f"write {_EXAMPLE}",
            )
    if not blocks:
        raise InputError("", f"{name}: no table", allowed=f"a chart: {_EXAMPLE}, rows below")
    for block in blocks:
        body = [row for _, row in block.rows]
        commas = any(re.search(r"\d,\d", row) for row in body)
        points = any(re.search(r"\d\.\d", row) for row in body)
        if block.separator != "," and commas and points:
            raise block.refused("both 1,2 and 1.2 below it", allowed="one decimal sign")
        block.comma = block.separator != "," and commas
    return blocks


def _is_header(line: str) -> bool:
    """Whether a line holds names and not numbers."""
    cells = [cell.strip().strip('"').lower() for cell in re.split(r"[;,\t]", line)]
    cells = [cell for cell in cells if cell]
    words = [cell for cell in cells if re.search(r"[a-z]{2}", cell) and cell not in MISSING]
    return bool(words) and not re.match(r"[-+]?[\d.]+(e[-+]?\d+)?$", cells[0])


def _fact(name: str, line: int, text: str, said: dict[str, tuple[str, str]]) -> None:
    """Keep what a line ``# key: value`` says; another comment is one."""
    key, colon, value = text.lstrip("#").strip().partition(":")
    key = key.strip().lower()
    if not colon or " " in key:
        return
    where = f"{name} line {line}: '{key}: {value.strip()[:40]}'"
    if key not in KEYS:
        if difflib.get_close_matches(key, KEYS, n=1, cutoff=0.7):
            raise InputError("", where, fix=nearest(key, KEYS))
        return
    if key in said and said[key][1] != value.strip():
        raise InputError("", where, why=f"{said[key][0]} says another", fix="leave one out")
    said[key] = (where, value.strip())


# --- what the columns are ----------------------------------------------------------------


def _column(block: _Block, place: int) -> tuple[str, str]:
    """(words, unit) of a column of the header."""
    match = _HEAD.fullmatch(block.head[place].strip())
    if match is None:
        raise block.refused(f"column '{block.head[place]}'", allowed=_EXAMPLE)
    return " ".join(match["words"].lower().split()), match["unit"] or ""


def _scale(block: _Block, place: int, kind: str, ask: str) -> float:
    """The SI value of one unit of a column."""
    words, unit = _column(block, place)
    if not unit:
        raise block.refused(
            f"column '{words}' without a unit", allowed=f"a unit of {kind}", fix=ask
        )
    try:
        return read_quantity(f"1 {unit}", kind)
    except InputError as error:
        raise block.refused(
            f"column '{block.head[place]}'",
            allowed=f"a unit of {kind}",
            why=error.why,
            fix=f"write '{words} [{'deg' if kind == 'angle' else 'mm'}]'",
        ) from error


def _position_name(block: _Block) -> str:
    """What the first column is: what a trace runs over, or "tooth"."""
    words, _ = _column(block, 0)
    if block.of_pitch or words in POSITIONS:
        return words
    close = difflib.get_close_matches(words, POSITIONS, n=1, cutoff=0.5)
    raise block.refused(
        f"column '{words[:40]}'",
        allowed=" | ".join(POSITIONS),
        fix=f"did you mean '{close[0]}'?" if close else "a line that is no header starts with #",
    )


def _position(block: _Block) -> tuple[str, float]:
    """What the first column is, and the SI value of its unit."""
    words = _position_name(block)
    kind = POSITIONS[words]
    units = "'[deg]' or '[rad]'" if kind == "angle" else "'[mm]'"
    return words, _scale(block, 0, kind, f"write {units} behind it")


def _trace(block: _Block, place: int) -> tuple[str, int, float]:
    """Side, tooth and SI value of the unit of a trace's column."""
    words, unit = _column(block, place)
    parts = words.replace("flank", "").replace("tooth", "").split()
    side = [part for part in parts if part in SIDES]
    number = [part for part in parts if part.isdigit()]
    if len(side) != 1 or len(number) > 1 or len(parts) > len(side) + len(number):
        ask = "which flank is it?" if not side else None
        tooth = number[0] if number else place
        raise block.refused(
            f"column '{words}'",
            allowed="'tooth 1 left [um]': tooth and flank, left | right",
            why=ask,
            fix=f"write 'tooth {tooth} left [um]' or 'tooth {tooth} right [um]'",
        )
    ask = ""
    if not unit:
        most = float(np.abs(block.values()[:, place]).max())
        likely, words_ = ("mm", "millimetres") if most < 0.2 else ("um", "micrometres")
        ask = f"are the values, up to {most:.6g}, {words_}? then write '{words} [{likely}]'"
    scale = _scale(block, place, "length", ask)
    return side[0], int(number[0]) if number else 1, scale


def _pitch(blocks: Iterable[_Block]) -> dict[str, Floats]:
    """Pitch deviations [m] over the teeth, signs as in the file, by the name of their column."""
    deviations: dict[str, Floats] = {}
    for block in blocks:
        values = block.values()
        teeth = values[:, 0]
        if not np.array_equal(teeth, np.arange(1, teeth.size + 1)):
            raise block.refused("teeth that do not count 1, 2, 3, ...", allowed="every tooth once")
        for place in range(1, len(block.head)):
            words, _ = _column(block, place)
            scale = _scale(block, place, "length", f"write '{words} [um]' if that is meant")
            deviations[words] = scale * values[:, place]
    return deviations


# --- what the lines say -------------------------------------------------------------------


def _sign(said: Mapping[str, tuple[str, str]]) -> float:
    if "sign" not in said:
        return 1.0
    where, value = said["sign"]
    words = " ".join(value.lower().split())
    known = SIGNS | {f"{k.split()[1]} is positive": s for k, s in SIGNS.items()}
    if words not in known:
        raise InputError("", where, allowed=" | ".join(SIGNS), fix=nearest(words, SIGNS))
    return known[words]


def _drive(
    said: Mapping[str, tuple[str, str]], sides: tuple[str, ...], block: _Block
) -> str | None:
    """The side that drives, where the columns say left and right."""
    hands = sorted({side for side in sides if side in ("left", "right")})
    if hands and set(sides) - set(hands):
        raise block.refused("left and right beside drive and back", allowed="one way of naming")
    if "drive" in said:
        where, value = said["drive"]
        if value.lower() not in ("left", "right"):
            raise InputError("", where, allowed="left | right")
        if not hands:
            raise InputError("", where, why="the columns name drive and back themselves")
        return value.lower()
    if len(hands) == 2:
        raise block.refused(
            "left and right flanks",
            why="which of them drives?",
            fix="write a line '# drive: right' or '# drive: left'",
        )
    return hands[0] if hands else None


def _range(said: Mapping[str, tuple[str, str]], over: str) -> tuple[str, float, float] | None:
    """What the evaluated range runs over, and its ends."""
    if "evaluate" not in said:
        return None
    where, value = said["evaluate"]
    match = _RANGE.fullmatch(value.strip())
    allowed = "for instance '# evaluate: 62.1..66.8 mm', lengths as in the first column"
    if match is None:
        raise InputError("", where, allowed=allowed)
    unit, axis = match["unit"] or match["first"], match["over"].strip() or over
    if axis not in POSITIONS:
        raise InputError("", where, allowed=" | ".join(POSITIONS), fix=nearest(axis, POSITIONS))
    if not unit:
        raise InputError("", where, why="its unit is missing", allowed=allowed)
    units = (match["first"] or unit, unit)
    low, high = match["low"].replace(",", "."), match["high"].replace(",", ".")
    try:
        ends = [
            read_quantity(f"{number} {end_unit}", POSITIONS[axis])
            for number, end_unit in zip((low, high), units, strict=True)
        ]
    except InputError as error:
        raise InputError("", where, allowed=allowed, why=error.why) from error
    if not 0.0 <= ends[0] < ends[1]:
        raise InputError("", where, allowed="a lower and a higher end")
    return axis, ends[0], ends[1]


def _teeth(said: Mapping[str, tuple[str, str]]) -> int | None:
    if "teeth" not in said:
        return None
    where, value = said["teeth"]
    if not value.isdigit() or len(value) > 6:
        raise InputError("", where, allowed="a whole number")
    return int(value)
