"""A few of the random branches of ``make trial NAME=branches``: no event missed, none invented."""

from __future__ import annotations

from scripts import script

from said import numbers


def test_five_random_branches_show_what_short_steps_show() -> None:
    trial = script("trials/branches")
    found = trial.Found()
    trial.branches(5, found)
    assert {what: found.counts[what] for what in trial.NEVER} == dict.fromkeys(trial.NEVER, 0), (
        found.notes
    )
    assert found.counts["branches"] == 5
    assert found.counts["branches with grazings"] >= 2


def test_the_committed_table_is_that_of_this_trial() -> None:
    trial = script("trials/branches")
    text = trial.PAGE.read_text("utf-8")
    assert {float(trial.SEED), 60.0} <= set(numbers(text))
