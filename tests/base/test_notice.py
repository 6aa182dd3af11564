"""A notice is a code with data; its sentence comes from the catalogue."""

import ast
import math
from pathlib import Path
from typing import Any

import pytest

import thermogear
from thermogear.base.notice import LEVELS, SENTENCE, Entry, Notice, catalogue


def test_every_entry_has_a_level_a_sentence_and_advice() -> None:
    for code, entry in catalogue().items():
        assert entry.level in LEVELS, code
        assert entry.to_do.endswith("."), code


def test_every_use_names_a_known_code_with_its_fields() -> None:
    used = set()
    for path in Path(thermogear.__file__).parent.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if "Notice.of(" not in text:
            continue
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "Notice.of":
                first = node.args[0]  # a code, or one of two
                codes = [first.body, first.orelse] if isinstance(first, ast.IfExp) else [first]
                for code in map(ast.literal_eval, codes):
                    assert {each.arg for each in node.keywords} == catalogue()[code].fields, path
                    used.add(code)
    assert used == set(catalogue())


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
    assert of_files.data == {**notice.data, "files": ["r1.csv", "r2.csv"]}


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
