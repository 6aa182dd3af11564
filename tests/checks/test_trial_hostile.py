"""Some of the mutated files of ``make trial NAME=hostile``: what must never happen does not."""

from __future__ import annotations

import numpy as np
import pytest
from scripts import ROOT, script

COUNT = 3


@pytest.mark.slow
def test_mutated_files_of_every_kind_end_in_a_result_or_one_line() -> None:
    trial = script("trials/hostile")
    found = trial.summed(trial.batch([(kind, 0, COUNT) for kind in trial.KINDS]))
    notes = [note for one in found.values() for note in one.notes]
    assert notes == []
    assert {kind: one.counts["files"] for kind, one in found.items()} == dict.fromkeys(
        trial.KINDS, COUNT
    )
    assert sum(one.counts["read"] for one in found.values()) > COUNT


def test_a_mutation_is_the_same_whenever_it_is_made() -> None:
    trial = script("trials/hostile")
    data = bytes(range(256)) * 8
    made = [
        [trial.mutated_bytes(data, np.random.default_rng([5, i])) for i in range(200)]
        for _ in range(2)
    ]
    assert made[0] == made[1]
    assert sum(one != data for one in made[0]) > 180


def test_the_committed_table_is_that_of_this_trial() -> None:
    trial = script("trials/hostile")
    text = trial.PAGE.read_text("utf-8")
    assert f"(seed {trial.SEED})" in text
    for kind in trial.KINDS:
        row = next(line for line in text.splitlines() if line.startswith(f"| {kind} |"))
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        assert cells[4 : 4 + len(trial.NEVER)] == ["0"] * len(trial.NEVER), row
    assert ROOT in trial.PAGE.parents
