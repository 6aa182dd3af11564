"""A few random cases: no sentence of theirs contradicts the data beside it."""

from __future__ import annotations

import pytest
from scripts import script


@pytest.mark.parametrize(("number", "whole"), [(4, False), (8, True)])
def test_random_cases_say_what_their_data_say(number: int, whole: bool) -> None:
    found = script("trials/answers").answered(number, whole)
    assert found.notes == []
    assert found.counts["cases"] == 1
    assert found.counts["sentences with a figure"] >= found.counts["sentences"] - 4


def test_the_committed_table_of_the_answers_has_no_contradiction() -> None:
    text = script("trials/answers").PAGE.read_text("utf-8")
    for name in ("answers", "run"):
        for what in ("contradictions", "exceptions"):
            assert f"| {name}: {what} | 0 |" in text
