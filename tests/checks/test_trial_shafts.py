"""A few records of the trial of few turns and unknown shafts; `make trial NAME=shafts`."""

from __future__ import annotations

import numpy as np
import pytest
from scripts import script

TRIAL = script("trials/shafts")


@pytest.mark.parametrize("sort", range(len(TRIAL.SORTS)), ids=TRIAL.SORTS)
def test_intervals_hold(sort: int) -> None:
    rows = [TRIAL.run((sort, 1000 + number)) for number in range(2)]
    off = {name: np.abs([one for row in rows for one in row.errors[name]]) for name in TRIAL.LINES}
    print(TRIAL.SORTS[sort], {name: np.round(all_, 2).tolist() for name, all_ in off.items()})
    assert not any(row.refused for row in rows)
    assert off["mesh line"].size == 4
    assert np.mean(off["mesh line"] <= 1.0) >= 0.75
    assert max(one.max() for one in off.values() if one.size) < 3.0


def test_the_page_tells_every_sort() -> None:
    rows = [
        TRIAL.Row(sort, 5.0, {name: [0.5] for name in TRIAL.LINES}, "", 0, 1.0, "")
        for sort in TRIAL.SORTS
    ]
    assert [line.split(" | ")[0][2:] for line in TRIAL.table(rows)[2:8]] == list(TRIAL.SORTS)
