"""Lines over the whole stretch: against least squares in time, closed forms, many records."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.signals.following import follow_line
from thermogear.signals.interval import Reading, noise_beside, read_line, student
from thermogear.signals.lines import line_spectrum
from thermogear.signals.strong import dirichlet, strong_lines

RATE = 1000.0


def reading(x: NDArray[np.float64], near: float) -> Reading:
    return read_line(line_spectrum(x, RATE), near)


def test_the_kernel_is_the_sum_it_stands_for() -> None:
    u, count = np.array([-3.2, 0.0, 0.4, 17.9]), 64
    n = np.arange(count)
    summed = np.exp(2j * np.pi * np.outer(u, n) / count).mean(axis=-1)
    np.testing.assert_allclose(dirichlet(u, count), summed, atol=1e-12)


@pytest.mark.parametrize(("frequency", "count"), [(50.3, 4000), (12.34, 1000), (7.7, 1000)])
def test_a_steady_line_is_read_exactly(frequency: float, count: int, compared: Compared) -> None:
    """A line that does not close on itself, down to eight periods: its image counts too."""
    t = np.arange(count) / RATE
    x = 2.0 * np.cos(2 * np.pi * frequency * t + 1.0)
    found = reading(x, frequency + 0.2 * RATE / count)
    error = [found.amplitude - 2.0, found.frequency - frequency]
    compared("a line over the whole stretch", "the line put in", error, 2e-3)


def test_a_line_in_noise_is_that_of_least_squares_in_time(compared: Compared) -> None:
    rng = np.random.default_rng(5)
    t = np.arange(4000) / RATE
    x = np.cos(2 * np.pi * 50.3 * t + 1.0) + rng.normal(size=t.size)
    found = reading(x - x.mean(), 50.3)
    turn = 2 * np.pi * found.frequency * t
    fit = np.linalg.lstsq(np.column_stack([np.cos(turn), np.sin(turn)]), x - x.mean())[0]
    # noise brings 2 sigma^2/N to the square of each of both, and to the sum of squares 4 sigma^2/N
    own = np.sqrt(np.hypot(*fit) ** 2 - 4.0 / t.size)
    compared("a line in noise", "least squares in time", found.amplitude / own - 1.0, 0.02)


def test_stated_errors_are_those_of_theory_and_of_the_draws() -> None:
    """Cramer and Rao: var A = 2 sigma^2/N, var f = 6 sigma^2/(pi^2 A^2 T^2 N); 150 draws."""
    rng = np.random.default_rng(512026)
    t = np.arange(4000) / RATE
    length = t.size / RATE
    line = np.cos(2 * np.pi * 50.3 * t + 1.0)
    found = [reading(line + rng.normal(size=t.size), 50.3) for _ in range(150)]
    theory = {"amplitude": 2.0 / t.size, "frequency": 6.0 / (np.pi**2 * length**2 * t.size)}
    truth = {"amplitude": 1.0, "frequency": 50.3}
    # a variance out of d degrees of freedom scatters by sqrt(2/d), a square of one error by sqrt(2)
    degrees = float(np.median([one.degrees for one in found]))
    for name, variance in theory.items():
        stated = np.array([getattr(one, f"{name}_error") for one in found]) ** 2 / variance
        off = (np.array([getattr(one, name) for one in found]) - truth[name]) ** 2 / variance
        rooms = 4.0 * np.sqrt(0.5 * np.pi * 2.0 / degrees / 150), 4.0 * np.sqrt(2.0 / 150)
        seen = float(np.median(stated)), float(off.mean())
        print(f"{name}: stated {seen[0]:.3f} +- {rooms[0]:.3f}, drawn {seen[1]:.3f} of theory")
        assert abs(seen[0] - 1.0) < rooms[0]
        assert abs(seen[1] - 1.0) < rooms[1]


def test_a_changing_amplitude_is_no_noise() -> None:
    """Its root mean square is read, and the interval stays that of the noise."""
    rng = np.random.default_rng(6)
    t = np.arange(4000) / RATE
    a = 1.0 + 0.1 * np.cos(2 * np.pi * 0.9 * t + 2.0)
    x = a * np.cos(2 * np.pi * 50.3 * t) + 0.1 * rng.normal(size=t.size)
    found = reading(x, 50.3)
    assert found.amplitude == pytest.approx(np.sqrt(np.mean(a**2)), abs=found.half_width)
    assert found.half_width < 0.01
    assert found.changing == pytest.approx(0.1 / np.sqrt(2.0), rel=0.1)
    assert found.neighbours == ()


def test_a_neighbour_is_told_from_a_changing_amplitude() -> None:
    rng = np.random.default_rng(7)
    t = np.arange(4000) / RATE
    x = np.cos(2 * np.pi * 50.3 * t) + 0.3 * np.cos(2 * np.pi * 50.7 * t + 1.0)
    found = reading(x + 0.1 * rng.normal(size=t.size), 50.3)
    assert found.neighbours == (pytest.approx(50.7, abs=0.01),)
    assert found.amplitude == pytest.approx(1.0, abs=2.0 * found.half_width)
    assert found.explained


@pytest.mark.parametrize("wander", [1e-3, 1e-2])
def test_turns_of_a_wandering_line(wander: float, compared: Compared) -> None:
    t = np.arange(8000) / RATE
    speed = 100.0 * (1.0 + wander * np.sin(2 * np.pi * 0.3 * t + 0.7))
    cycles = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) / RATE
    x = np.cos(2 * np.pi * cycles + 0.4) + 0.05 * np.random.default_rng(8).normal(size=t.size)
    found = follow_line(x, RATE, frequency=100.0, half_width=2.5)
    assert found.whole
    turns = found.cycles - found.cycles[0] - cycles
    compared("turns of a wandering line", "the turns put in", turns, 0.05, "cycles")
    mean = cycles[-1] / t[-1]
    assert found.frequency == pytest.approx(mean, abs=1.5 * found.frequency_half_width)


@pytest.mark.parametrize(
    ("noise", "wander", "bend", "side"),
    [
        (0.1, 0.0, 0.0, 0.0),
        (0.001, 1e-2, 0.0, 0.0),
        (0.02, 0.0, 1e-2, 0.0),
        (0.05, 1e-3, 0.0, 0.12),
    ],
    ids=["noise", "a speed that walks", "a speed that bends", "sidebands"],
)
def test_mean_frequency_of_a_followed_line_is_in_its_interval(
    noise: float, wander: float, bend: float, side: float
) -> None:
    """Turns over time, of 40 drawn records of each cause of error: as often as 95 %."""
    n = np.arange(8000)
    inside = []
    for number in range(40):
        random = np.random.default_rng([18, number])
        walk = np.cumsum(random.normal(size=n.size)) / np.sqrt(n.size)
        turn = 2 * np.pi * random.uniform(1.0, 5.0) * n / n.size + random.uniform(0.0, 2 * np.pi)
        speed = 0.1 * (1.0 + wander * walk + bend * np.sin(turn))
        cycles = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))])
        x = np.cos(2 * np.pi * cycles) + noise * random.normal(size=n.size)
        shaft = 0.1 / 25
        for sign in (-1, 1):
            phase = random.uniform(0.0, 2 * np.pi)
            x += side * np.cos(2 * np.pi * (1.0 + sign / 25) * cycles + phase)
        beside = (0.1 - shaft, 0.1 + shaft) if side else ()
        found = follow_line(x, 1.0, frequency=0.1, half_width=0.004, beside=beside)
        off = found.frequency - cycles[-1] / n[-1]
        inside.append(abs(off) < found.frequency_half_width)
    print(f"inside {100 * np.mean(inside):.1f} %")
    assert np.mean(inside) >= stats.binom.ppf(1e-3, len(inside), 0.95) / len(inside)


def test_refusals() -> None:
    with pytest.raises(InputError, match="half_width"):
        follow_line(np.ones(100), RATE, frequency=100.0, half_width=1.0)
    assert student(1e9) == pytest.approx(1.959964, abs=1e-5)


@pytest.mark.parametrize("unit", [1e-60, 1e-12, 1e-7, 1e8, 1e12, 1e60])
def test_a_reading_is_the_same_in_every_unit(unit: float) -> None:
    random = np.random.default_rng(17)
    n = np.arange(4000)
    x = np.cos(0.6302 * n) + 0.02 * np.cos(0.6364 * n) + 0.1 * random.standard_normal(n.size)
    whole, scaled = line_spectrum(x, 1.0), line_spectrum(unit * x, 1.0)
    one = read_line(whole, 0.1003, strong=strong_lines(whole))
    other = read_line(scaled, 0.1003, strong=strong_lines(scaled))
    assert other.frequency == pytest.approx(one.frequency, rel=1e-12)
    assert other.frequency_error == pytest.approx(one.frequency_error, rel=1e-9)
    for name in ("amplitude", "amplitude_error", "noise"):
        assert getattr(other, name) == pytest.approx(unit * getattr(one, name), rel=1e-9)


def test_a_record_of_the_smallest_numbers_is_read_without_a_warning() -> None:
    x = 1e-310 * np.cos(0.6302 * np.arange(400))
    assert np.isfinite(read_line(line_spectrum(x, 1.0), 0.1003).amplitude)


def test_noise_is_not_lost_in_the_bins_of_fitted_lines() -> None:
    """Short records: six sidebands lie in the bins from which the noise of power 4 s^2/N is told.

    Of n powers the median over ln 2 scatters by 1/(ln 2 sqrt n) of its mean.
    """
    rng = np.random.default_rng(81)
    t = np.arange(320) / 2560.0
    sides = [400.0 + 16.0 * n for n in (-3, -2, -1, 1, 2, 3)]
    found = []
    for _ in range(120):
        x = np.sin(2 * np.pi * 400.0 * t) + 0.1 * rng.normal(size=t.size)
        x += 0.1 * sum(np.cos(2 * np.pi * f * t + rng.uniform(0.0, 6.0)) for f in sides)
        one = read_line(line_spectrum(x - x.mean(), 2560.0), 400.0, beside=sides)
        found.append(one.noise**2 / (4.0 * 0.01 / t.size))
    scatter = 1.0 / (np.log(2.0) * np.sqrt(70.0 * len(found)))
    assert np.mean(found) == pytest.approx(1.0, abs=4.0 * scatter + 0.01)  # 1/(2 n) of a median


def test_noise_at_a_line_follows_a_resonance_beside_it() -> None:
    """Powers of noise a + c m^2 without scatter: medians lie at the middle of each half."""
    m = np.arange(1.0, 41.0)
    power = np.log(2.0) * (1.0 - 4e-4 * m**2)
    whole = np.ones_like(power)
    noise, here, _ = noise_beside((power, power), shares=(whole, whole), followed=0.0)
    assert noise < 0.85
    assert here == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("skirts", [0.0, 60.0, 300.0])
@pytest.mark.parametrize("followed", [0.0, 15.0])
def test_skirts_of_a_change_are_no_noise(skirts: float, followed: float) -> None:
    """Powers drawn of noise 1, in I with skirts a/m^2: noise was 10 to 40 % too high, at the line
    20 to 90 %. Means of 200 with scatter 0.3/sqrt 200."""
    rng = np.random.default_rng(82)
    m, whole = np.arange(1.0, 41.0), np.ones(40)
    found = [
        noise_beside(
            (rng.exponential(size=40) * (1.0 + skirts / m**2), rng.exponential(size=40)),
            shares=(whole, whole),
            followed=followed,
        )
        for _ in range(200)
    ]
    assert np.mean([one[0] for one in found]) == pytest.approx(1.0, abs=0.08)
    assert np.mean([one[1] for one in found]) == pytest.approx(1.0, abs=0.15)
