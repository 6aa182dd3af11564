"""The squared envelope without lines: its law under noise, and impacts that slip."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal, stats

from thermogear.signals.envelope import envelope_rates


def test_noise_has_no_rate_more_often_than_it_is_said() -> None:
    """Drawn noise, white and coloured: ``chance`` is a bound, and no record is below a hundredth of
    what so many records allow."""
    random = np.random.default_rng(41)
    chances = []
    for number in range(40):
        noise = random.normal(size=12_000)
        if number % 2:
            noise = signal.lfilter([1.0], [1.0, -0.9], noise)
        found = envelope_rates(noise)[0]
        chances.append(found.chance)
    few = np.sum(np.array(chances) < 0.1)
    assert few <= stats.binom.ppf(0.999, 40, 0.1)
    assert min(chances) > 0.01 / 40


def _slipping(
    random: np.random.Generator, rate: float, slip: float, count: int
) -> tuple[np.ndarray, float]:
    """Ringing impacts that slip, and the mean rate at which they came."""
    times = np.cumsum(1.0 + slip * random.normal(size=int(count * rate))) / rate
    times = times[times < count - 1]
    train = np.zeros(count)
    train[times.astype(int)] = 1.0
    pole = np.exp(2 * np.pi * 0.31 * (-0.03 + 1j))
    ringing = signal.lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], train)
    return ringing / np.std(ringing), float((times.size - 1) / (times[-1] - times[0]))


@pytest.mark.parametrize("slip", [0.005, 0.02])
def test_slipping_impacts_show_at_their_rate_beside_a_strong_line(slip: float) -> None:
    random = np.random.default_rng(int(1000 * slip))
    n = np.arange(60_000)
    for _ in range(5):
        rate = random.uniform(0.002, 0.006)
        ringing, mean = _slipping(random, rate, slip, n.size)
        x = ringing + 0.7 * random.normal(size=n.size)
        x += 20.0 * np.cos(2 * np.pi * random.uniform(0.01, 0.2) * n)
        found = envelope_rates(x)[0]
        assert found.chance < 1e-6
        assert found.rate == pytest.approx(mean, abs=1.5 / n.size)
        assert found.band[0] < 0.31 * 1.05
        assert found.band[1] > 0.31 * 0.95


def test_a_mesh_line_with_sidebands_is_no_swelling_noise() -> None:
    random = np.random.default_rng(9)
    n = np.arange(40_000)
    swing = 1.0 + 0.2 * np.cos(2 * np.pi * 0.0041 * n)
    x = swing * np.cos(2 * np.pi * 0.0943 * n) + 0.1 * random.normal(size=n.size)
    assert envelope_rates(x)[0].chance > 1e-2
    assert envelope_rates(np.zeros(200)) == ()


def test_a_record_whose_squares_vanish_has_no_rate() -> None:
    """In a mutated file: all powers were 0, and their quotient no number."""
    noise = 1e-260 * np.random.default_rng(3).normal(size=12_000)
    assert all(one.chance > 0.5 for one in envelope_rates(noise))
