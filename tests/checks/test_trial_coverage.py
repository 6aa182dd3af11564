"""Stated intervals of lines on trial, a tenth of it: `make trial-coverage` runs it whole."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from scripts import script

TRIAL = script("trial_coverage")
RUNS = 24
SHORT = ("white noise, rms 0.1", "load wanders 5 %, 1 s", "neighbour 0.4 Hz away, 0.3 amplitudes")


@pytest.mark.parametrize("name", SHORT)
def test_intervals_hold(name: str) -> None:
    """As often as 95 % of few runs: fewer would come once in ten thousand tests."""
    (place,) = (i for i, one in enumerate(TRIAL.SCENARIOS) if one.name == name)
    cell = TRIAL.run(place, RUNS)
    least = stats.binom.ppf(1e-4, RUNS, 0.95) / RUNS
    assert np.all(cell.held >= least)
    assert np.all(cell.widths[:2] < 2.0 * TRIAL.WIDEST)  # of few runs the sd itself is loose


def test_weighing_teeth_changes_no_digit(monkeypatch: pytest.MonkeyPatch) -> None:
    quick = TRIAL.run(0, 3)
    monkeypatch.setattr(TRIAL, "Mock", lambda return_value: TRIAL.weigh)
    whole = TRIAL.run(0, 3)
    np.testing.assert_array_equal(quick.errors, whole.errors)
    np.testing.assert_array_equal(quick.half_widths, whole.half_widths)


def test_drawn_records_are_what_they_say() -> None:
    random = np.random.default_rng(1)
    path = TRIAL.wandering(random, 400_000, rate=100.0, time_constant=1.0)
    # exp(-|t|/1 s), its variance 1: known to 2 % from 4 000 correlation times
    assert np.var(path) == pytest.approx(1.0, abs=0.08)
    assert np.mean(path[:-100] * path[100:]) == pytest.approx(np.exp(-1.0), abs=0.08)
    scenario = TRIAL.Scenario("x", wander=1e-2, load=0.05)
    made = TRIAL.drawn(scenario, np.random.default_rng(2))
    assert made.amplitudes[0] == pytest.approx(1.0, abs=0.1)
    assert made.frequency == pytest.approx(400.0, rel=0.05)


def test_a_cell_outside_is_named() -> None:
    errors = np.random.default_rng(3).normal(size=(4, 500))
    cell = TRIAL.Cell(
        name="x", errors=errors, half_widths=np.full((4, 500), 1.0), drawn=500, seconds=1.0
    )
    said = TRIAL.outside([cell])
    assert len(said) == 4
    assert "Outside: x, amplitude: " in "\n".join(TRIAL.told([cell], 500))


@pytest.mark.parametrize("number", [3, 12, 17, 18])
def test_an_unresolved_neighbour_is_no_wander(number: int) -> None:
    """A line 1.6 bins beside the mesh line, 0.3 as high: a quarter was followed, 4 to 10 half
    widths too high."""
    place = next(i for i, one in enumerate(TRIAL.SCENARIOS) if one.neighbour == (0.4, 0.3))
    cell = TRIAL.run(place, 1, first=number)
    assert abs(cell.errors[0, 0]) < 1.5 * cell.half_widths[0, 0]
