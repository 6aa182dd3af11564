"""Shares of basins against other starts; `trial NAME=basins` in short."""

from __future__ import annotations

from scripts import script

from conftest import AtLength, Compared

TRIAL = script("trials/basins")


def test_intervals_of_shares_hold_other_starts(at_length: AtLength, compared: Compared) -> None:
    count = at_length(300, TRIAL.COUNT, "other starts at each value")
    rows = list(TRIAL.held("two motions", count))
    assert len(rows) == 10
    assert all(row.inside for row in rows)
    compared("share of the starts", "other starts", [row.share - row.other for row in rows], 0.1)
    assert len(TRIAL.page(rows)) == 6 + len(rows)  # heading, sentence and head of the table
