"""Fresh pairs of a class lie in the bands that a series of it states."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scripts import script


@pytest.mark.slow
def test_fresh_pairs_lie_in_the_stated_bands() -> None:
    trial = script("trials/series")
    rows = list(trial.held(6, parts=32))
    assert len(rows) == 3
    assert all(row.share.high > trial.LEAST and row.share.low < trial.MOST for row in rows)
    assert 0.8 < float(np.mean([row.share.value for row in rows])) < 1.0


def test_the_committed_table_holds() -> None:
    text = script("trials/series").PAGE.read_text("utf-8")
    rows = re.findall(r"^\| \d+/\d+ \|.*\| (\d+) \| (\d+) to (\d+) \|$", text, re.MULTILINE)
    held, low, high = np.array(rows, dtype=float).T
    assert held.size == 30
    # of 64 pairs each, band and count scatter by 5 %
    assert 85.0 < held.mean() < 93.0
    assert (low <= 97.0).all()
    assert (high >= 80.0).all()
