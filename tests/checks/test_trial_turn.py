"""Two of the random pairs of ``make trial NAME=turn``: the exact engine and other steps agree."""

from __future__ import annotations

import pytest
from scripts import script

from said import numbers


def test_motions_over_a_turn_stand_another_integration(monkeypatch: pytest.MonkeyPatch) -> None:
    trial = script("trials/turn")
    monkeypatch.setattr(trial, "FINER_UP_TO", 100)
    found = [one for one in trial.all_compared(2) if one is not None]
    assert len(found) == 2
    for one in found:
        assert one.factor_error < trial.FACTOR
        assert one.loss_error < trial.LOSS
        assert one.label.mesh_periods == one.drawn.mesh_periods
    text = trial.page(found, 0)
    assert text.startswith(trial.HEAD)
    assert {2.0, 1.0, 0.5} <= set(numbers(text[len(trial.HEAD) :]))


def test_the_committed_table_of_turns_is_that_of_this_trial() -> None:
    trial = script("trials/turn")
    text = trial.PAGE.read_text("utf-8")
    assert text.startswith(trial.HEAD)
    assert {float(trial.SEED), float(len(trial.LENGTHS))} <= set(numbers(text))
    rows = [line for line in text.splitlines() if line.startswith("| ")][1:]
    lengths = [int(row.split("|")[2]) for row in rows]
    assert sum(length > 1500 for length in lengths) == 3
    assert sum(length > 500 for length in lengths) == 5
