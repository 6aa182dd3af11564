"""Indicators of gears against closed forms, scipy and drawings with seeds fixed beforehand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from thermogear.base.errors import InputError
from thermogear.signals.indicators import (
    crest_factor,
    energy_operator,
    energy_ratio,
    fm0,
    gear_indicators,
    modulation_depths,
    moment_scatter,
    na4_of_moments,
    normalised_moment,
    sideband_index,
    sideband_ratio,
)
from thermogear.signals.synchronous import demodulated, separated

COUNT = 4096
TURN = 2 * np.pi * np.arange(COUNT) / COUNT
POWERS = (4, 6, 8)


def moments(x: np.ndarray) -> list[float]:
    return [float(normalised_moment(x, power=power)) for power in POWERS]


def test_moments_of_known_waves() -> None:
    uniform = (np.arange(100_000) + 0.5) / 100_000
    assert moments(np.cos(TURN)) == pytest.approx([1.5, 2.5, 4.375], rel=1e-12)
    assert moments(np.sign(np.cos(TURN + 0.001))) == pytest.approx([1.0, 1.0, 1.0], rel=1e-6)
    assert moments(uniform) == pytest.approx([1.8, 27 / 7, 9.0], rel=1e-6)
    spike = np.zeros(500)
    spike[7] = 1.0
    assert moments(spike)[0] == pytest.approx(500 - 2 + 1 / 499, rel=1e-12)
    assert moments(spike)[1:] == pytest.approx([500.0**2, 500.0**3], rel=0.02)


@pytest.mark.parametrize("share", [0.5, 0.25, 0.125])
def test_moments_of_a_sine_on_a_share_of_the_turn(share: float) -> None:
    burst = np.where(np.arange(COUNT) < share * COUNT, np.sin(64 * TURN), 0.0)
    assert moments(burst) == pytest.approx(
        [1.5 / share, 2.5 / share**2, 4.375 / share**3], rel=1e-9
    )


def test_moments_of_noise_of_a_burst_in_noise_and_of_a_modulated_sine() -> None:
    drawn = np.random.default_rng(11)
    noise = drawn.normal(size=1_000_000)
    assert moments(noise)[0] == pytest.approx(3.0, abs=0.03)
    assert moments(noise)[1] == pytest.approx(15.0, abs=0.6)
    power, share = 2.0, 0.1
    size = np.where(np.arange(noise.size) < share * noise.size, np.sqrt(2 * power / share), 0.0)
    x = noise + size * np.sin(0.7 * np.arange(noise.size))
    expected = (3 + 6 * power + 1.5 * power**2 / share) / (1 + power) ** 2
    assert moments(x)[0] == pytest.approx(expected, rel=0.01)
    m = 0.6
    wave = (1 + m * np.cos(TURN)) * np.cos(50 * TURN)
    closed = 1.5 * (1 + 3 * m**2 + 0.375 * m**4) / (1 + m**2 / 2) ** 2
    assert moments(wave)[0] == pytest.approx(closed, rel=1e-9)


def test_moments_are_those_of_scipy() -> None:
    x = np.random.default_rng(12).gamma(2.0, size=(3, 700))
    assert normalised_moment(x, power=4) == pytest.approx(stats.kurtosis(x, axis=-1, fisher=False))
    for power in POWERS:
        scaled = stats.moment(x, power, axis=-1) / np.var(x, axis=-1) ** (power / 2)
        assert normalised_moment(x, power=power) == pytest.approx(scaled)


def test_scatter_of_moments_under_noise() -> None:
    x = np.random.default_rng(13).normal(size=(2000, 2000))
    for power, room in ((4, 0.06), (6, 0.15)):
        drawn = float(np.std(normalised_moment(x, power=power)))
        assert drawn == pytest.approx(moment_scatter(power, count=2000), rel=room)


def test_fm0_of_equal_harmonics() -> None:
    for count, closed in ((1, 2.0), (2, 1.5625), (3, 1.438), (4, 1.379)):
        wave = sum(np.cos(16 * k * TURN) for k in range(1, count + 1))
        assert float(fm0(wave, mesh_order=16, harmonics=count)) == pytest.approx(closed, abs=1e-3)


def test_energy_operator_of_a_sine_and_of_noise() -> None:
    assert np.isnan(energy_operator(np.zeros(64)))
    # psi = u + v with u = a^2, v = b c: central moments 60 + 6 x 2 x 1 + 9 = 81 over (2 + 1)^2
    drawn = energy_operator(np.random.default_rng(14).normal(size=(40, 50_000)))
    assert abs(float(np.mean(drawn)) - 9.0) < 4 * float(stats.sem(drawn))
    sine = np.sin(0.3 * np.arange(40.0))
    psi = sine[1:-1] ** 2 - sine[:-2] * sine[2:]
    assert psi == pytest.approx(np.full(38, np.sin(0.3) ** 2))


def test_na4_steps_where_the_variance_does() -> None:
    runs, factor = 50, 4.0
    noise = np.random.default_rng(15).normal(size=(40, runs + 1, 2_000))
    noise[:, -1] *= np.sqrt(factor)
    closed = 3 * factor**2 / ((runs + factor) / (runs + 1)) ** 2
    assert closed == pytest.approx(42.8, abs=0.05)
    fourth, variance = (stats.moment(noise, order, axis=-1) for order in (4, 2))
    last = [
        float(na4_of_moments(fourth=f, variance=v)[-1])
        for f, v in zip(fourth, variance, strict=True)
    ]
    assert abs(float(np.mean(last)) - closed) < 4 * float(stats.sem(last))
    single = float(na4_of_moments(fourth=fourth[0, :1], variance=variance[0, :1])[0])
    assert single == pytest.approx(float(normalised_moment(noise[0, 0], power=4)))


def test_sidebands_and_depths_of_a_known_modulation() -> None:
    m, b = 0.3, 0.1
    x = 2.0 * (1 + m * np.cos(TURN)) * np.cos(40 * TURN + b * np.cos(TURN + 1.0))
    amplitude, phase = modulation_depths(demodulated(x, mesh_order=40, harmonic=1))
    assert float(amplitude) == pytest.approx(m, rel=1e-6)
    assert float(phase) == pytest.approx(b, rel=1e-3)
    plain = 2.0 * (1 + m * np.cos(TURN)) * np.cos(40 * TURN)
    assert float(sideband_index(plain, mesh_order=40)) == pytest.approx(0.5 * m * 2.0)
    assert float(sideband_ratio(plain, mesh_order=40)) == pytest.approx(m)


def test_energy_ratio_is_the_root_of_the_ratio_of_powers() -> None:
    x = np.cos(40 * TURN) + 0.5 * np.cos(TURN) + 0.2 * np.cos(41 * TURN) + 0.3 * np.cos(47 * TURN)
    parts = separated(x, mesh_order=40)
    closed = np.sqrt(0.3**2 / (1.0 + 0.5**2 + 0.2**2))
    assert float(energy_ratio(difference=parts.difference, regular=parts.regular)) == pytest.approx(
        closed
    )
    assert float(np.std(parts.residual)) == pytest.approx(np.sqrt((0.2**2 + 0.3**2) / 2))
    assert float(crest_factor(np.cos(TURN))) == pytest.approx(np.sqrt(2.0))


@pytest.mark.parametrize("noise", [0.02, 0.05, 0.1, 0.2])
def test_a_known_modulation_comes_back_out_of_noise(noise: float) -> None:
    depth, turns = 0.15, 48
    drawn = np.random.default_rng(int(1000 * noise))
    x = (1 + depth * np.cos(TURN)) * np.cos(40 * TURN)
    averages = x + noise / np.sqrt(turns) * drawn.normal(size=(200, COUNT))
    index = sideband_index(averages, mesh_order=40)
    # each of the two lines has noise of 2/sqrt(N) of a sample's in its real part
    spread = noise / np.sqrt(turns) * np.sqrt(2.0 / COUNT) / np.sqrt(2.0)
    inside = np.abs(index - depth / 2) < 1.96 * spread
    assert stats.binomtest(int(inside.sum()), 200, 0.95).pvalue > 1e-4


def test_a_signal_without_power_has_no_ratio() -> None:
    found = gear_indicators(np.zeros((2, 256)), mesh_order=20, highest=100)
    assert all(np.isnan(found[name]).all() for name in ("fm4", "fm0", "energy_ratio"))
    with pytest.raises(InputError, match=r"^mesh_order: got 2; "):
        separated(np.zeros(64), mesh_order=2)
