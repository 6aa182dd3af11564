"""Some of the random motions of ``make trial NAME=labels``: no label that is asserted is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from scripts import ROOT, script

from said import numbers

COUNT = 40


@pytest.mark.slow
def test_labels_of_random_motions_stand_another_test() -> None:
    trial = script("trials/labels")
    drawn, _ = trial.draws(COUNT)
    found = trial.Found()
    for one in trial.all_trials(drawn, workers=1):
        found.add(one)
    assert {what: found.counts[what] for what in trial.WRONG} == dict.fromkeys(trial.WRONG, 0), (
        found.notes
    )
    periods = sum(n for what, n in found.counts.items() if what.startswith("period-"))
    assert periods + sum(found.counts[w] for w in ("chaotic", "diverged", "undecided")) == COUNT
    assert periods > COUNT // 2
    assert found.counts["chaotic"] > 0
    assert found.worst["largest multipliers apart"] < 1e-6


def test_the_trial_sees_what_is_wrong() -> None:
    """Chaos that ends, a multiplier that is another's, and an orbit the start does not reach."""
    trial = script("trials/labels")
    columns = np.array([[0.0362811934206, 0.4856413205293, 0.287450100057, 0.3020883356857,
                         0.5082231342633, 1.0579260211767, 0.0]])  # fmt: skip
    start = np.array([[-0.2291657201697, -1.7074805351333]])
    drawn = trial.Drawn(columns, start)
    (words,) = trial.ends(drawn)
    assert words == f"period 5 by {trial.FAR} periods"
    (one,) = trial.labels(drawn.model, initial_state=start, starts=2)
    found = trial.Found()
    if one.orbit is not None:
        assert trial.confirm(drawn, 0, one, found) == ""


def test_the_committed_table_of_labels_is_that_of_this_trial() -> None:
    trial = script("trials/labels")
    text = trial.PAGE.read_text("utf-8")
    assert {float(trial.SEED), 2000.0} <= set(numbers(text))
    (wrong,) = (line for line in text.splitlines() if line.startswith("| asserted labels"))
    assert numbers(wrong)[0] == 0.0
    for what in trial.WRONG:
        assert f"| {what} | 0 |" in text
    assert ROOT in trial.PAGE.parents
