"""Averages, combs, envelopes and cepstra against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.signals.kurtogram import (
    envelope_spectrum,
    impulsive_band,
    kurtogram,
    real_cepstrum,
    spectral_kurtosis,
)
from thermogear.signals.synchronous import (
    comb_gain,
    demodulated,
    repeating_turns,
    separated,
    shared_step,
    synchronous_averages,
    tooth_means,
)


@pytest.mark.parametrize(
    ("teeth", "turns", "leaks"),
    [
        ((19, 48), 48, (0.0, 0.0, 0.0)),
        ((19, 48), 50, (0.013, 0.032, 0.033)),
        ((20, 60), 30, (0.0, 0.0)),
        ((20, 60), 10, (0.100, 0.100)),
    ],
)
def test_an_average_leaves_of_the_mate_what_the_comb_says(
    teeth: tuple[int, int], turns: int, leaks: tuple[float, ...]
) -> None:
    per_turn = 480
    angle = 2 * np.pi * np.arange(per_turn * turns) / per_turn
    for rank, leak in enumerate(leaks, start=1):
        order = rank * teeth[0] / teeth[1]
        assert float(comb_gain(order, turns=turns)) == pytest.approx(leak, abs=5e-4)
        line = np.exp(1j * order * angle)
        left = [
            synchronous_averages(part, samples_per_turn=per_turn, turns=turns)[0]
            for part in (line.real, line.imag)
        ]
        # the average of a line is the line over a turn, shortened by the comb
        assert np.max(np.abs(left[0] + 1j * left[1])) == pytest.approx(
            float(comb_gain(order, turns=turns)), abs=1e-9
        )


def test_turns_that_repeat_and_orders_that_both_shafts_have() -> None:
    for z, mate in ((19, 48), (20, 60), (60, 20), (24, 36), (25, 25)):
        turns = repeating_turns(mesh_order=z, mate_order=mate)
        assert (turns * z) % mate == 0
        assert all((n * z) % mate for n in range(1, turns))
        step = shared_step(mesh_order=z, mate_order=mate)
        assert [k for k in range(1, 3 * step) if (k * mate) % z == 0] == [step, 2 * step]


def test_noise_falls_with_the_root_of_the_turns() -> None:
    noise = np.random.default_rng(21).normal(size=64 * 64 * 40)
    average = synchronous_averages(noise, samples_per_turn=64, turns=64)
    assert float(np.std(average)) == pytest.approx(1 / 8, rel=0.05)
    with pytest.raises(InputError, match=r"^turns: got 9; allowed 1..8"):
        synchronous_averages(np.zeros(80), samples_per_turn=10, turns=9)


def test_parts_sum_up_and_lack_what_was_removed() -> None:
    x = np.random.default_rng(22).normal(size=(3, 512))
    parts = separated(x, mesh_order=20, highest=100, step=5)
    assert np.allclose(parts.regular + parts.difference, x)
    residual = np.abs(np.fft.rfft(parts.residual, axis=-1))
    assert np.all(residual[:, list(parts.removed)] < 1e-9)
    assert set(range(5, 101, 5)) <= set(parts.removed)
    difference = np.abs(np.fft.rfft(parts.difference, axis=-1))
    assert np.all(difference[:, [19, 21, 39, 41, 101, 200]] < 1e-9)
    left = int(np.count_nonzero(difference[0] > 1e-9))
    assert left == parts.kept


def test_a_delayed_tooth_has_one_delay_at_every_harmonic() -> None:
    teeth, count, delay = 20, 2048, 0.01
    angle = np.arange(count) / count
    late = delay * np.exp(-0.5 * (((angle * teeth - 7.5) / 1.5) ** 2))
    x = sum(np.cos(2 * np.pi * k * (teeth * angle - late)) / k for k in (1, 2, 3))
    found = []
    for k in (1, 2, 3):
        a = demodulated(x, mesh_order=teeth, harmonic=k)
        phase = np.unwrap(np.angle(a)) / (2 * np.pi * k)
        found.append(float(np.median(phase) - tooth_means(phase, teeth=teeth)[7]))
    assert found == pytest.approx([found[0]] * 3, rel=0.02)
    assert found[0] == pytest.approx(delay, rel=0.05)
    with pytest.raises(InputError, match=r"^harmonic: got 60; "):
        demodulated(x, mesh_order=teeth, harmonic=60)


def test_spectral_kurtosis_of_noise_of_a_line_and_of_bursts() -> None:
    drawn = np.random.default_rng(23)
    count = 400
    noise = drawn.normal(size=(2000, count)) + 1j * drawn.normal(size=(2000, count))
    kurtosis = spectral_kurtosis(noise)
    assert float(np.mean(kurtosis)) == pytest.approx(0.0, abs=0.02)
    assert float(np.std(kurtosis)) == pytest.approx(2 / np.sqrt(count), rel=0.08)
    share = 0.25
    noise[:, int(share * count) :] = 0.0
    assert float(np.mean(spectral_kurtosis(noise))) == pytest.approx(2 / share - 2, rel=0.05)


def test_noise_has_no_impulsive_band_and_ringing_impacts_have() -> None:
    drawn = np.random.default_rng(24)
    quiet = 0
    for _ in range(150):
        quiet += impulsive_band(kurtogram(drawn.normal(size=4096)), samples=4096) is None
    assert quiet >= 143  # of 150 at 1 %: more than 7 with a chance of 2e-4
    time = np.arange(32_768)
    ringing = np.exp(-(time % 800) / 40.0) * np.sin(2 * np.pi * 0.3 * (time % 800))
    x = ringing + 0.1 * drawn.normal(size=time.size)
    band = impulsive_band(kurtogram(x), samples=x.size)
    assert band is not None
    assert band.low <= 0.3 <= band.high
    rates = envelope_spectrum(x, low=band.low, high=band.high)
    place, level = rates.level(low=0.98 / 800, high=1.02 / 800)
    assert place == pytest.approx(1 / 800, rel=0.03)
    assert level > 20.0


def test_lines_of_an_envelope_that_swells() -> None:
    count, m, rate = 1 << 17, 0.5, 64 / (1 << 17)
    noise = np.random.default_rng(25).normal(size=count)
    x = noise * (1 + m * np.cos(2 * np.pi * rate * np.arange(count)))
    found = envelope_spectrum(x, low=0.0, high=0.5)
    lines = found.amplitude[[63, 127]]
    closed = np.array([2 * m, 0.5 * m**2]) / (1 + m**2 / 2)
    assert lines == pytest.approx(closed, abs=4 * np.sqrt(4 / (count / 2)))
    still = envelope_spectrum(noise, low=0.0, high=0.5)
    assert float(np.mean(still.amplitude**2)) == pytest.approx(4 / (count / 2), rel=0.03)


def test_an_echo_in_the_cepstrum() -> None:
    x = np.random.default_rng(26).normal(size=4096)
    a, delay = 0.3, 100
    quefrency = real_cepstrum(x + a * np.roll(x, delay)) - real_cepstrum(x)
    assert quefrency[[delay, 2 * delay]] == pytest.approx([a / 2, -(a**2) / 4], abs=1e-9)
