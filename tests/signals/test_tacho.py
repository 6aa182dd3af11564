"""Pulses of a tacho: lost and extra ones, uneven marks, a speed summed."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.signals.orders import rising_edges
from thermogear.signals.tacho import numbered, pulse_turns, speed_turns


@pytest.mark.parametrize("seed", range(6))
def test_lost_and_extra_pulses_are_found(seed: int) -> None:
    """A run-up of a factor 4 and more, 10 % lost, 3 % added: the count is right throughout."""
    random = np.random.default_rng(seed)
    low, high = random.uniform(5, 15), random.uniform(40, 60)
    t = np.linspace(0.0, 12.0, 120_001)
    turns = low * t + (high - low) * t**2 / 24.0
    whole = np.arange(1, int(turns[-1]))
    at = np.interp(whole, turns, t)
    at = at[random.random(at.size) > 0.10] + 0.0
    at = np.sort(np.append(at, random.uniform(0.0, 12.0, int(0.03 * whole.size))))
    found = pulse_turns(numbered(at), 1.0, rate=1000.0, samples=12_000)
    own = (np.arange(12_000) / 1000.0)[found.first : found.first + found.turns.size]
    off = found.turns - np.interp(own, t, turns)
    off -= np.round(np.median(off))
    assert np.max(np.abs(off)) < 0.25
    assert np.std(off) < 0.02


def test_uneven_marks_are_moved_to_where_they_are() -> None:
    random = np.random.default_rng(5)
    marks = random.uniform(-0.15, 0.15, 8)
    marks -= marks.mean()
    n = np.arange(800)
    at = (n + marks[n % 8]) / 8.0 / 20.0 + 1.0  # 20 turns per second
    found = pulse_turns(numbered(at), 8.0, rate=2000.0, samples=12_000)
    own = (np.arange(12_000) / 2000.0)[found.first : found.first + found.turns.size]
    off = found.turns - 20.0 * own
    assert np.std(off - off.mean()) < 1e-3


def test_a_long_gap_ends_the_count_and_a_shaft_that_stands_is_refused() -> None:
    at = np.concatenate([np.arange(30) * 0.1, 50.0 + np.arange(60) * 0.037])
    assert numbered(at).times[0] == 50.0
    with pytest.raises(InputError, match=r"^speed: got 0 turns/s; allowed > 0"):
        speed_turns(np.zeros(100), rate=10.0, samples=100, sample_rate=10.0)
    with pytest.raises(InputError, match=r"^tacho: got 3 pulses; allowed >= 8 pulses"):
        numbered([0.0, 1.0, 2.0])


def test_a_count_ends_where_the_shaft_stands_still() -> None:
    """Down to rest, ten seconds there, up again: a tenth lost; only one side is counted, rightly.

    turns = 12 t^2 on both sides of the rest, so the closed form gives every pulse's time.
    """
    random = np.random.default_rng(41)
    whole = np.arange(1, 300)
    ramp = np.sqrt(whole / 12.0)
    times = np.concatenate([-ramp[::-1], 10.0 + ramp]) + 20.0
    kept = np.sort(random.permutation(times.size)[: int(0.9 * times.size)])
    found = numbered(times[kept])
    turns = np.where(times < 20.0, -12.0 * (times - 20.0) ** 2, 12.0 * (times - 30.0) ** 2)
    true = np.interp(found.times, times, turns)
    np.testing.assert_allclose(found.numbers, true - true[0], atol=1e-6)
    assert found.times.size > 200
    assert found.times[-1] < 20.0 or found.times[0] > 30.0


@pytest.mark.parametrize(("change", "lost"), [(-0.1, 0.0), (0.1, 0.0), (-0.05, 0.1), (0.05, 0.1)])
def test_pulses_of_a_fast_run_up_between_steady_speeds_are_counted(
    change: float, lost: float
) -> None:
    """The speed changes by a tenth from one pulse to the next, with a corner at both ends."""
    random = np.random.default_rng([26, 11, round(100 * lost), round(100 + 100 * change)])
    time = np.arange(0.0, 12.0, 1e-4)
    last = 1.0 / 30.0 if change > 0 else 1.0 / 5.0  # a period, of 1/10 s before
    period = 0.1 - change * np.clip(time - 3.0, 0.0, abs(0.1 - last) / abs(change))
    turns = np.cumsum(1.0 / period) * 1e-4
    own = np.arange(1, int(turns[-1]))
    for _ in range(5):
        kept = own[random.random(own.size) >= lost]
        times = np.interp(kept, turns, time) + 1e-4 * random.normal(size=kept.size)
        found = numbered(times)
        own_numbers = kept[np.searchsorted(times, found.times)]
        np.testing.assert_array_equal(found.numbers, own_numbers - own_numbers[0])
        assert found.times.size >= (0.9 if lost else 1.0) * kept.size


@pytest.mark.parametrize("speed", [30.0, 38.0, 53.0, 70.0])
@pytest.mark.parametrize("lost", [0.0, 0.05])
def test_square_pulses_of_few_samples_are_counted(speed: float, lost: float) -> None:
    """60 pulses a turn at 12 800/s: an edge is known to half a sample, a period of s samples to
    .71/s of itself."""
    random = np.random.default_rng([60, int(speed)])
    place = speed * 60.0 / 12_800.0 * np.arange(3000) + random.random()
    whole = np.floor(place).astype(int)
    up = (place - whole < 0.5) & (random.random(whole[-1] + 1) >= lost)[whole]
    times = rising_edges(5.0 * up, rate=12_800.0)
    found = numbered(times, grain=1.0 / 12_800.0)
    turned = (found.times[-1] - found.times[0]) * speed * 60.0
    assert found.numbers[-1] == pytest.approx(turned, rel=4e-3, abs=1.0)
    assert found.numbers[-1] > 0.95 * 3000 / 12_800.0 * speed * 60.0
    assert found.extra == 0
