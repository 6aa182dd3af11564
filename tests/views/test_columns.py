"""A table declared once: what the page, the terminal, JSON and CSV show of the same rows."""

from __future__ import annotations

import csv
import itertools
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from markupsafe import Markup

import thermogear
from thermogear.base.display import CELSIUS, MICROMETRE, PERCENT, exactly
from thermogear.base.vocabulary import label, status_attributes
from thermogear.results.files import json_text
from thermogear.results.result import Notice, Result
from thermogear.results.tables import rows_of, table_text
from thermogear.views.columns import (
    Column,
    by_name,
    declared,
    in_full,
    key,
    reaches,
    rows_along,
    units,
)
from thermogear.views.page import Code, Page, Text, lines_of, typed

GAP = np.array([[1.0 / 3e4, -2e-9], [np.nan, 4e-5]])
COLUMNS = (
    Column("state", "state"),
    Column("point", "operating"),
    Column("gap", "half_backlash", ".1f"),
    Column("twice", lambda row: 2.0 * row["half_backlash"], 3, MICROMETRE),
    Column("oil", "oil", 3, CELSIUS),
    Column("share", "share", "+.1f", PERCENT),
    Column("teeth", "teeth"),
    Column("status", lambda row: row["status"].replace("_", "-")),
)


def data() -> xr.Dataset:
    """Two dimensions, a missing number, a number of one dimension alone, words and flags."""
    dims = ("state", "operating")
    made = label(
        {"half_backlash": (dims, GAP), "curve": (("phase",), [1.0, 2.0, 3.0], "1", "a curve")},
        {
            "state": ["undeformed", "hot"],
            "pinion_speed": ("operating", [100.0 * np.pi, 200.0 * np.pi]),
            "pinion_torque": ("operating", [10.0, 10.0]),
        },
    )
    return made.assign(
        oil=("state", [293.15, 353.15]),
        share=("operating", [0.25, -0.25]),
        teeth=((), 20),
        status=(dims, np.array([[0, 1], [2, 0]], np.int8), status_attributes()),
    )


def test_rows_hold_every_place_in_full_precision() -> None:
    found = rows_along(data(), "state", "operating")
    places = list(itertools.product(range(2), range(2)))
    for (s, o), row in zip(places, found, strict=True):
        here = data().isel(state=s, operating=o)
        assert row["state"] == str(here["state"].item())
        assert row["operating"] == ("3000 rpm", "6000 rpm")[o]
        assert row["oil"] == float(here["oil"])
        assert row["teeth"] == 20
        assert row["half_backlash"] == float(GAP[s, o]) or math.isnan(GAP[s, o])
        assert "curve" not in row
    assert [row["status"] for row in found] == ["ok", "jammed", "not_converged", "ok"]
    # the other way round the same rows in the other order
    turned = rows_along(data(), "operating", "state")
    assert [repr(row["half_backlash"]) for row in turned] == list(map(repr, GAP.T.ravel().tolist()))


IN_JSON = (
    Column("state", "state", key="state"),
    Column("gap", "half_backlash", ".1f", key="gap_um"),
    Column("oil", "oil", 3, CELSIUS, "oil_degC"),
    key("half_backlash"),
    key("teeth"),
    key("status"),
)


def test_json_gets_numbers_and_null_where_one_is_missing() -> None:
    """The same column gives the page its digits and JSON all of them, in the unit of its name."""
    rows = rows_along(data(), "state", "operating")
    told = json.loads(json_text({"rows": [in_full(IN_JSON, row) for row in rows]}))["rows"]
    assert [row["half_backlash"] for row in told] == [1.0 / 3e4, -2e-9, None, 4e-5]
    assert told[0]["gap_um"] == MICROMETRE(1.0 / 3e4)
    assert (told[0]["oil_degC"], told[-1]["oil_degC"]) == (20.0, 80.0)
    assert all(type(row["teeth"]) is int for row in told)
    # what has no words is not on the page
    assert declared("", IN_JSON, rows).head == ["state", "gap [µm]", "oil [°C]"]


def test_json_gets_arrays_by_the_names_along_dimensions() -> None:
    whole = by_name(data(), IN_JSON)
    assert whole["half_backlash"][0] == [1.0 / 3e4, -2e-9]
    assert whole["status"] == [["ok", "jammed"], ["not_converged", "ok"]]
    each = by_name(data(), IN_JSON, "state")
    assert list(each) == ["undeformed", "hot"]
    for place, name in enumerate(each):
        assert repr(each[name]["half_backlash"]) == repr(GAP[place].tolist())
        assert each[name]["oil_degC"] == whole["oil_degC"][place]


def test_a_stored_name_in_json_has_its_unit_beside_it() -> None:
    assert units(IN_JSON, data()) == {"half_backlash": "m"}


def test_reaches_are_those_of_all_places() -> None:
    table = reaches("Gaps.", IN_JSON[1:3], data())
    assert table.rows == [["gap [µm]", "−0.002 to 40"], ["oil [°C]", "20 to 80"]]
    assert lines_of(Code("a = 1\nb = 2"), table)[:3] == ["a = 1", "b = 2", "Gaps."]


def test_every_json_says_what_it_is_and_carries_codes() -> None:
    """Version, title, kind and notices with code and data are added in one place."""
    notice = Notice("warning", "mind", "some_code", {"a": 1.0})
    result = Result.of("drawing", "Gears", {"": data()}, [notice])
    assert Page(result, "", (), numbers=lambda: {"gap_um": 1.0}).figures == {
        "thermogear": thermogear.__version__, "title": "Gears", "kind": "drawing", "gap_um": 1.0,
        "notices": [
            {"code": "some_code", "level": "warning", "data": {"a": 1.0}, "text": "mind"}
        ],
    }  # fmt: skip
    assert Page(result, "", ()).figures == {}


def test_the_page_has_units_in_heads_and_digits_as_declared() -> None:
    rows = rows_along(data(), "state", "operating")
    table = declared("Gaps.", COLUMNS, rows, names=2, marked=lambda row: row["status"] == "jammed")
    assert table.head == [
        "state", "point", "gap [µm]", "twice [µm]", "oil [°C]", "share [%]", "teeth",
        "status",
    ]  # fmt: skip
    assert table.rows == [
        ["undeformed", "3000 rpm", "33.3", "66.7", "20.0", "+25.0", "20", "ok"],
        # what rounds to zero has no sign
        ["undeformed", "6000 rpm", "0.0", "−0.00400", "20.0", "−25.0", "20", "jammed"],
        ["hot", "3000 rpm", "–", "–", "80.0", "+25.0", "20", "not-converged"],
        ["hot", "6000 rpm", "40.0", "80.0", "80.0", "−25.0", "20", "ok"],
    ]
    assert table.marked == {1}


def test_csv_gets_the_rows_of_the_page_in_full() -> None:
    columns = (COLUMNS[0], *COLUMNS[2:])
    table = declared("Gaps.", columns, rows_along(data(), "state", "operating"))
    head, *lines = csv.reader(table_text(table.head, table.figures).splitlines())
    assert head == table.head
    gaps = [float(line[1] or "nan") for line in lines]
    assert gaps == pytest.approx(1e6 * GAP.ravel(), rel=1e-14, nan_ok=True)
    for line, row in zip(lines, table.rows, strict=True):
        assert (line[0], line[-1]) == (row[0], row[-1])
        shown = [float(typed(cell)) for cell in row[1:6] if cell != "–"]
        assert shown == pytest.approx([float(cell) for cell in line[1:6] if cell], abs=0.05)


def test_the_terminal_shows_the_cells_of_the_page_in_columns() -> None:
    table = declared("Gaps.", COLUMNS, rows_along(data(), "state", "operating"), names=2)
    caption, *lines = lines_of(table)
    body = lines[-len(table.rows) :]
    assert caption == "Gaps."
    assert [line.split() for line in body] == [
        " ".join(map(typed, row)).split() for row in table.rows
    ]
    assert all(line.isascii() for line in lines)
    # words begin, and numbers end, in one place of every line
    assert {line.index(row[1]) for line, row in zip(body, table.rows, strict=True)} == {14}
    gaps = [typed(row[2]) for row in table.rows]
    assert (
        len({line.index(f" {gap} ") + len(gap) for line, gap in zip(body, gaps, strict=True)}) == 1
    )
    # a head is folded over its column, no word of it is lost
    heads = " ".join(lines[: -len(table.rows)]).split()
    assert sorted(heads) == sorted(" ".join(map(typed, table.head)).split())


@pytest.mark.parametrize(
    ("page", "terminal"),
    [
        ("3.20·10⁻⁷", "3.20e-7"),
        ("k [10⁸ N/m]", "k [1e8 N/m]"),
        ("b′ 20 °C → −3 µm", "b' 20 degC -> -3 um"),
        (Markup("f<sub>n</sub> &lt; 5"), "fn < 5"),
    ],
)
def test_letters_that_a_terminal_may_lack(page: str, terminal: str) -> None:
    assert typed(page) == terminal


def test_heads_keep_their_marks_and_words_are_no_numbers() -> None:
    column = Column(Markup("f<sub>n</sub>"), "natural_frequency", 4)
    assert column.title == Markup("f<sub>n</sub> [Hz]")
    assert isinstance(column.title, Markup)
    assert column.cell({"natural_frequency": 1234.5678}) == "1235"
    assert column.cell({"natural_frequency": "none"}) == "none"
    assert column.cell({}) == column.cell({"natural_frequency": math.inf}) == "–"
    # a pure number has no unit, an own way to write it no digits
    assert Column("share", "load_share", exactly).title == "share"
    assert Column("share", "load_share", exactly).cell({"load_share": 0.5}) == "0.5"


def test_texts_stand_between_tables_and_an_empty_one_has_its_heads() -> None:
    table = declared("", COLUMNS[:1], [])
    assert lines_of(Text("−1 µm"), table) == ["-1 um", "  state"]
    assert rows_of({"a": np.arange(2), "b": ["x", "y"]}) == [{"a": 0, "b": "x"}, {"a": 1, "b": "y"}]
    cells = (0.1, math.nan, 3, "a,b", "=1")
    assert table_text(["=1", "b"], [(v, v) for v in cells]).splitlines() == [
        "'=1,b", "0.1,0.1", ",", "3,3", '"a,b","a,b"', "'=1,'=1",
    ]  # fmt: skip


def test_no_page_writes_its_lines_by_hand() -> None:
    """A page names blocks for the terminal; its lines and the notices are made in one place."""
    pages = Path(thermogear.__file__).parent / "views" / "pages"
    texts = {path.name: path.read_text("utf-8") for path in pages.glob("*.py")}
    found = re.compile(r"lines=lambda|lines_of|notice_lines|as_dict\(\)")
    assert [name for name, text in texts.items() if found.search(text)] == []
