"""Fifteen of the damages of ``trial NAME=damage``: none is read back different without a word."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from scripts import ROOT, script

from said import numbers


@pytest.mark.slow
def test_no_damage_is_read_back_without_a_word(tmp_path: Path) -> None:
    trial = script("trials/damage")
    made = trial.specimens(tmp_path / "made", short=True)
    told = Counter(trial.trial(*one, tmp_path) for one in trial.drawn(made, 15))
    readers = Counter(reader for reader, _ in told.elements())
    assert {what: readers[what] for what in trial.NEVER} == dict.fromkeys(trial.NEVER, 0), told
    assert readers[trial.REFUSED] > 10
    commands = Counter(command for _, command in told.elements())
    assert commands["repaired by the command"] > 5
    assert commands["WRONG after the command"] == 0


def test_the_committed_table_is_that_of_this_trial() -> None:
    trial = script("trials/damage")
    text = trial.PAGE.read_text("utf-8")
    assert {float(trial.SEED), float(trial.COUNT)} <= set(numbers(text))
    for what in trial.NEVER:
        assert f"| {what} | 0 |" in text
    assert ROOT in trial.PAGE.parents
