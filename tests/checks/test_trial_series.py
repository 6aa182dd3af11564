"""Fresh pairs of a class lie in the bands that a series of it states."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scripts import script


@pytest.mark.slow
def test_fresh_pairs_lie_in_the_stated_bands() -> None:
    trial = script("trial_series")
    shares = [row.share.value for number in (0, 1) for row in trial.held(number)]
    assert len(shares) == 6
    assert all(trial.LEAST <= share <= trial.MOST for share in shares), shares
    assert float(np.mean(shares)) > 0.85


def test_the_committed_table_holds() -> None:
    text = script("trial_series").PAGE.read_text("utf-8")
    rows = re.findall(r"^\| \d+/\d+ \|.*\| (\d+) \| \d+ to \d+ \|$", text, re.MULTILINE)
    assert len(rows) == 30
    assert re.search(r"^30 bands\. .*: (\d+)\.$", text, re.MULTILINE)
    assert all(80 <= int(row) <= 97 for row in rows)
