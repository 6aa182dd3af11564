"""A notice is a code with data; its sentence comes from the catalogue."""

import ast
import math
import re
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

import thermogear
from thermogear.base.notice import LEVELS, SENTENCE, Entry, Notice, catalogue

CODED = ("case", "measured", "results", "signals", "study")
"""Folders whose notices all have codes."""


def test_every_entry_has_a_level_a_sentence_and_advice() -> None:
    for code, entry in catalogue().items():
        assert entry.level in LEVELS, code
        assert entry.to_do.endswith("."), code


def calls(name: str, folders: Sequence[str] = ("",)) -> Iterator[tuple[Path, ast.Call]]:
    """Every call of ``name`` in the source."""
    for folder in folders:
        for path in (Path(thermogear.__file__).parent / folder).rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            for node in ast.walk(ast.parse(text)) if f"{name}(" in text else ():
                if isinstance(node, ast.Call) and ast.unparse(node.func) == name:
                    yield path, node


def named(first: ast.expr) -> list[str]:
    """The codes that a first argument may be: one, one of two, or those a pattern fits."""
    if isinstance(first, ast.IfExp):
        return [*named(first.body), *named(first.orelse)]
    if isinstance(first, ast.JoinedStr):
        pattern = "".join(p.value if isinstance(p, ast.Constant) else ".+" for p in first.values)
        return [code for code in catalogue() if re.fullmatch(pattern, code)]
    return [ast.literal_eval(first)]


def test_every_use_names_a_known_code_with_its_fields() -> None:
    used = set()
    for path, call in calls("Notice.of"):
        names = {each.arg for each in call.keywords} - {"about"}
        for code in named(call.args[0]):
            fields = catalogue()[code].fields
            # None: further fields of a dictionary
            assert names == fields or (None in names and names - {None} < fields), (path, code)
            used.add(code)
    assert used == set(catalogue())


def test_no_notice_is_a_sentence() -> None:
    assert [(path, call.lineno) for path, call in calls("Notice", CODED)] == []


def test_data_and_sentence_agree() -> None:
    notice = Notice.of("rate_of_first_rows", rows=12, column="t")
    assert notice.code == "rate_of_first_rows"
    assert notice.data == {"rows": 12, "column": "t"}
    assert notice.text == catalogue()[notice.code].sentence.format(rows=12, column="t")
    assert Notice.stored(notice.as_dict()) == notice


@pytest.mark.parametrize(
    ("data", "text"),
    [
        ({"rows": 1, "names": ["a"]}, "1 row is left out: name a"),
        ({"rows": 2, "names": ["a", "b"]}, "2 rows are left out: names a, b"),
        ({"rows": 0, "names": []}, "0 rows are left out: names "),
    ],
)
def test_words_follow_a_count(
    data: dict[str, Any], text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    entry = Entry(
        "info", "{rows:d} {rows|row is|rows are} left out: {names|name|names} {names}", "Nothing."
    )
    monkeypatch.setattr("thermogear.base.notice.catalogue", lambda: {"rows_left": entry})
    assert entry.fields == {"rows", "names"}
    assert Notice.of("rows_left", **data).text == text


@pytest.mark.parametrize(
    ("names", "speed", "text"),
    [
        (["a"], None, "left out: a"),
        (
            list("abcdefghi"),
            [math.pi, 2.0 * math.pi],
            "left out: a, b, c, d, e, f, g, h, ... at 30, 60 rpm",
        ),
    ],
)
def test_a_clause_without_its_number_is_left_out_and_a_long_list_is_cut(
    names: list[str], speed: list[float] | None, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    entry = Entry("info", "left out: {names}[ at {speed:.0f rpm}]", "Nothing.")
    monkeypatch.setattr("thermogear.base.notice.catalogue", lambda: {"left_out": entry})
    notice = Notice.of("left_out", names=names, speed=speed)
    assert (notice.text, notice.data) == (text, {"names": names, "speed": speed})
    of_files = notice.of_files(["r1.csv", "r2.csv"])
    assert of_files.text == f"r1.csv, r2.csv: {text}"
    assert of_files.data == {**notice.data, "in_files": ["r1.csv", "r2.csv"]}


def test_a_range_in_a_list_and_what_a_notice_is_about(monkeypatch: pytest.MonkeyPatch) -> None:
    entry = Entry("info", "lost at {speeds:.6g rpm}, {teeth:.0f °C}", "Nothing.")
    monkeypatch.setattr("thermogear.base.notice.catalogue", lambda: {"lost": entry})
    data = {"speeds": [[math.pi, 2.0 * math.pi], [4.0 * math.pi] * 2], "teeth": 293.15}
    notice = Notice.of("lost", about="hot", **data)
    assert notice.text.removeprefix("hot: lost at ") == "30 to 60, 120 rpm, 20 °C"
    assert notice.data == {**data, "about": "hot"}
    assert Notice.stored(notice.as_dict()) == notice


def test_a_wrong_code_or_field_is_an_error() -> None:
    with pytest.raises(KeyError):
        Notice.of("no_such_code")
    with pytest.raises(TypeError, match="rate_of_first_rows: missing or unknown data: column, row"):
        Notice.of("rate_of_first_rows", row=12, rows=3)


def test_notices_of_older_results_keep_level_and_text() -> None:
    assert Notice.stored({"level": "warning", "text": "as it was"}) == Notice(
        "warning", "as it was"
    )
    assert Notice.stored("a bare text").level == "info"
    assert Notice.stored("a bare text").code == SENTENCE


def test_no_code_is_in_two_files() -> None:
    folder = Path(thermogear.__file__).parent / "base" / "notices"
    codes = [
        code for file in folder.glob("*.toml") for code in tomllib.loads(file.read_text("utf-8"))
    ]
    assert sorted(codes) == list(catalogue())
