"""A notice is a code with data; its sentence comes from the catalogue."""

import ast
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
                code = ast.literal_eval(node.args[0])
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
