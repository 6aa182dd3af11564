"""The trial of teeth, a few short records: `make trial-teeth` scores 200."""

from __future__ import annotations

import pytest
from scripts import script

TRIAL = script("trial_teeth")
SEED = 5
SHORT = (("pinion", 0), ("wheel", 1), ("both", 2), ("first harmonic", 3), ("two stages", 4))
BEARINGS = (("periodic impacts", 5), ("slipping impacts", 6))


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Records of at most 60 000 samples."""
    monkeypatch.setattr("teeth_draws.MOST", 60_000)


@pytest.mark.usefixtures("short")
def test_no_gear_is_named_wrongly() -> None:
    rows = [TRIAL.scored(kind, number, SEED) for kind, number in (*SHORT, *BEARINGS)]
    assert [row.told for row in rows if row.outcome == "wrong"] == []
    assert [row.outcome for row in rows[-2:]] == ["undecided"] * 2


def test_drawn_sets_do_not_share_records() -> None:
    sets = [TRIAL.drawn(seed, 10, 4) for seed in (TRIAL.DEVELOPMENT, TRIAL.HELD_BACK)]
    assert [len(one) for one in sets] == [14, 14]
    assert not set(sets[0]) & set(sets[1])


def test_a_wrong_gear_is_shown() -> None:
    row = TRIAL.Scored(
        kind="wheel", number=1, clear=True, outcome="wrong", told="32/54", seconds=0.0
    )
    assert row.told in "\n".join(TRIAL.told([row], SEED))
