"""The pace of rounded and of jittering stamps, against linear programs and drawn clocks."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import optimize

from thermogear.base.errors import InputError
from thermogear.signals.stamps import USUAL_RATES, grain_of, jumps_of, pace_of, usual_rate


def test_the_ends_are_those_of_a_linear_program() -> None:
    """Least and greatest h with |t - a - h p| <= r/2 for every stamp, by HiGHS."""
    random = np.random.default_rng(31)
    for _ in range(12):
        step, grain = random.uniform(0.5, 3.0), 0.25
        t = grain * np.round((random.uniform(0.0, 9.0) + step * np.arange(150)) / grain)
        matrix = np.stack([np.ones(t.size), np.arange(t.size)], axis=1)
        bounds = np.concatenate([t + grain / 2, grain / 2 - t])
        ends = [
            sign
            * optimize.linprog(
                [0.0, sign], np.concatenate([matrix, -matrix]), bounds, bounds=(None, None)
            ).fun
            for sign in (1.0, -1.0)
        ]
        pace = pace_of(t, grain=np.full(t.size, grain))
        assert pace.even
        assert (pace.low, pace.high) == pytest.approx(ends, rel=1e-7)
        assert pace.low <= step <= pace.high


def test_rates_of_drawn_columns_are_in_their_intervals() -> None:
    """A short one of `make trial NAME=stamps`: rounding gives bounds, jitter 95 %."""
    random = np.random.default_rng(2411)
    held = []
    for _ in range(80):
        rate, decimals = random.uniform(300.0, 2e4), int(random.integers(3, 7))
        count, jitter = int(random.integers(2000, 9000)), random.choice([0.0, 0.1, 0.2])
        place = np.arange(count) + random.uniform(-jitter, jitter, count)
        t = np.round(place / rate + random.uniform(0.0, 1.0), decimals)
        pace = pace_of(t, grain=grain_of(t))
        held.append(pace.low <= 1.0 / rate <= pace.high)
        assert jitter or (held[-1] and pace.even)
        assert pace.high / pace.low - 1.0 < 4.0 / count * max(1.0, 10.0**-decimals * rate)
        assert pace.jitter <= jitter / np.sqrt(3.0) * 1.5 + 1e-9
    assert np.mean(held) >= 0.95


def test_slow_errors_widen_the_interval() -> None:
    """A clock that goes to and fro within a third of a step, 2 turns in the record."""
    place = np.arange(4000)
    t = place + 0.3 * np.sin(np.pi * 4.0 * place / place.size + 1.0)
    pace = pace_of(t, grain=np.full(t.size, 1e-9))
    assert not pace.even
    assert pace.low < 1.0 < pace.high
    left = t - np.polyval(np.polyfit(place, t, 1), place)  # a line takes a part of the sine
    assert pace.jitter == pytest.approx(np.std(left), rel=1e-3)


def test_rounding_steps_of_decimals_digits_and_floats() -> None:
    t = np.arange(20_000) / 3000.0 + 7.0
    fixed = grain_of(np.round(t, 4))
    np.testing.assert_allclose(fixed, 1e-4)
    digits = np.array([float(f"{one:.6g}") for one in t])
    np.testing.assert_allclose(grain_of(digits), np.where(digits < 10.0, 1e-5, 1e-4))
    assert grain_of(t).max() < 1e-14
    single = t.astype(np.float32).astype(float)
    np.testing.assert_allclose(grain_of(single).max(), np.spacing(np.float32(13.0)))


def test_a_clock_that_is_not_usual_stays_itself() -> None:
    assert usual_rate(51_199.7, high=51_199.9) is None
    assert usual_rate(4_950.0, high=5_050.0) is None  # so wide that any may lie there
    assert usual_rate(2048.0, high=2048.0) == 2048.0
    assert np.all(np.diff(np.log(USUAL_RATES)) > 1e-3)


def test_how_many_samples_are_lost_is_not_told_where_stamps_repeat() -> None:
    """5 kHz, stamps of a millisecond: 400 samples lost are a jump by no whole number of steps."""
    place = np.arange(20_000)
    t = np.round(place / 5000.0, 3)
    assert jumps_of(t, grain=np.full(t.size, 1e-3))[0].size == 0
    t = np.round((place + 400 * (place >= 9000)) / 5000.0, 3)
    rows, ahead = jumps_of(t, grain=np.full(t.size, 1e-3))
    assert rows.tolist() == [9000]
    assert ahead % 1.0 == pytest.approx([0.5], abs=1e-9)


def test_two_stamps_have_no_pace() -> None:
    with pytest.raises(InputError, match=r"stamps.*allowed >= 3"):
        pace_of(np.array([0.0, 1.0]), grain=np.full(2, 0.1))
