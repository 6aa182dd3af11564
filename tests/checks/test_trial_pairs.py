"""Six of the random pairs of ``make trial NAME=pairs``: what must never happen does not."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from scripts import ROOT, script

from said import numbers
from thermogear.gears.deviations import FlankTable

COUNT, SEARCHES = 6, 1
WINDOW = 400
"""Neighbouring positions of the loaded contact: a fifth of the period, another one each time."""


@pytest.mark.slow
def test_six_random_pairs_go_through_the_whole_chain() -> None:
    trial = script("trials/pairs")
    drawn, refused = trial.draws(COUNT)
    steps = np.arange(WINDOW) / trial.POSITIONS
    found = [
        trial.trial(one, search=place < SEARCHES, phase=(0.2 * (place % 5)) + steps)
        for place, one in enumerate(drawn)
    ]
    counts: Counter[str] = sum((one.counts for one in found), Counter())
    notes = [note for one in found for note in one.notes]
    assert {what: counts[what] for what in trial.NEVER} == dict.fromkeys(trial.NEVER, 0), notes
    assert counts["ok"] + counts["jammed"] == 4 * COUNT
    assert counts["motions"] > COUNT
    assert refused.total() < 0.3 * (COUNT + refused.total())
    worst = {what: max(one.worst[what] for one in found) for what in found[0].worst}
    assert worst["shares off 1"] < 1e-12
    # a measured flank is cut into pieces that follow it within 1e-13 m, whatever the pair's size
    assert worst["scale, tangent stiffness"] < 1e-10
    drawn_alone = [
        one.worst["scale, tangent stiffness"]
        for one, pair in zip(found, drawn, strict=True)
        if not any(isinstance(deviation, FlankTable) for deviation in pair.deviations)
    ]
    assert len(drawn_alone) >= COUNT // 4
    assert max(drawn_alone) < 1e-12
    assert worst["exchange, tangent stiffness"] < 1e-6
    assert counts["positions on the path alone"] > 20 * COUNT


def test_the_committed_table_is_that_of_this_trial() -> None:
    trial = script("trials/pairs")
    text = trial.PAGE.read_text("utf-8")
    assert {float(trial.SEED), 2000.0} <= set(numbers(text))
    for what in trial.NEVER:
        assert f"| {what.replace('not_converged', 'cycle not converged')} | 0 |" in text
    assert ROOT in trial.PAGE.parents
