"""How well each way from acceleration to displacement reads a line: laws, then the whole table."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import integrate, signal

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.signals.filters import BandPass, taps_for, without_trend
from thermogear.signals.integration import trapezoid_factor
from thermogear.signals.lines import line_in, line_spectrum
from thermogear.signals.spectra import amplitude_spectrum

G = 9.80665
LINES = ((419.7, 10.4e-6), (832.58, 19.3e-6), (1251.6, 48.5e-6))
Floats = NDArray[np.float64]


def rig(rate: float, seconds: float = 4.0, seed: int = 7) -> Floats:
    """The thesis's three lines as acceleration, with noise, 0.05 g offset and a drift."""
    t = np.arange(int(rate * seconds)) / rate
    x = np.zeros_like(t)
    for place, (frequency, amplitude) in enumerate(LINES):
        omega = 2 * np.pi * frequency
        x -= amplitude * omega**2 * np.cos(omega * t + 0.4 + place)
    noise = np.random.default_rng(seed).standard_normal(t.size)
    return x + 0.05 * G + 0.02 * G * t / seconds + 0.05 * G * noise


def twice_trapezoid(x: Floats, rate: float) -> Floats:
    """Two running trapezoidal sums from zero, the thesis's way."""
    for _ in range(2):
        x = integrate.cumulative_trapezoid(x, dx=1.0 / rate, initial=0.0)
    return x


def through(band: BandPass, x: Floats) -> Floats:
    """The record behind the filter, samples that every tap saw."""
    return np.asarray(signal.oaconvolve(x, band.coefficients, mode="valid"))


def errors(displacement: Floats, rate: float) -> list[float]:
    """Error of each line in per cent, read with a flat-top window."""
    return [
        100
        * (
            line_in(line_spectrum(displacement, rate), near=f, half_width=4.0).amplitude / amplitude
            - 1
        )
        for f, amplitude in LINES
    ]


def filtered(rate: float) -> Floats:
    band = BandPass(rate, (0.4 * LINES[0][0], min(1.5 * LINES[2][0], 0.45 * rate)), 1025)
    for frequency, _ in LINES:
        assert band.gain(frequency) == pytest.approx(1.0, abs=3e-3)
    return through(band, rig(rate))


@pytest.mark.parametrize("phase", [0.0, 1.1])
@pytest.mark.parametrize("u", [1e-3, 0.05, 0.2575, 0.768, 1.4])
def test_trapezoid_law_is_exact(u: float, phase: float, compared: Compared) -> None:
    rate, count = 1000.0, 4000
    frequency = u * rate / np.pi
    n, omega = np.arange(count), 2 * np.pi * frequency
    a = np.cos(2 * u * n + phase)
    # two running sums from zero: the line, and the two integration constants
    step = 1 / rate
    scale = (step / (2 * np.tan(u))) ** 2
    start = step / (2 * np.tan(u)) * np.sin(phase)
    expected = -scale * (np.cos(2 * u * n + phase) - np.cos(phase)) - start * n * step
    got = twice_trapezoid(a, rate)
    assert np.max(np.abs(got - expected)) <= 1e-12 * max(np.max(np.abs(expected)), 1.0)
    law = float(trapezoid_factor(frequency, rate=rate))
    compared(
        "loss of a line by two trapezoidal sums",
        "the sums in closed form",
        scale * omega**2 / law - 1.0,
        1e-12,
    )


def test_trapezoid_factor_at_its_ends() -> None:
    np.testing.assert_allclose(trapezoid_factor([0.0, 500.0], rate=1000.0), [1.0, 0.0], atol=1e-30)
    with pytest.raises(InputError, match=r"^frequency: got 501\.0; allowed 0\.\.500 Hz"):
        trapezoid_factor(501.0, rate=1000.0)


@pytest.mark.parametrize(("rate", "limit"), [(5120.0, 4e-4), (25600.0, 4e-4)])
def test_flat_top_line_over_omega_squared(rate: float, limit: float, compared: Compared) -> None:
    x = without_trend(rig(rate))
    for frequency, amplitude in LINES:
        line = line_in(line_spectrum(x, rate), near=frequency, half_width=4.0)
        read = line.amplitude / (2 * np.pi * line.frequency) ** 2
        compared(
            "displacement of a flat-top line over ω²",
            "the lines put in",
            read / amplitude - 1.0,
            limit,
        )


@pytest.mark.parametrize("rate", [5120.0, 25600.0])
def test_trapezoid_after_a_filter_loses_what_its_law_says(rate: float) -> None:
    x = without_trend(twice_trapezoid(filtered(rate), rate))
    law = [100 * (float(trapezoid_factor(f, rate=rate)) - 1) for f, _ in LINES]
    np.testing.assert_allclose(errors(x, rate), law, atol=0.3)
    table = {5120.0: (-4.3, -16.9, -36.8), 25600.0: (-0.1, -0.6, -1.5)}
    np.testing.assert_allclose(law, table[rate], atol=0.16)


@pytest.mark.parametrize(
    ("rate", "table"), [(5120.0, (-0.2, -3.7, -16.5)), (25600.0, (0.0, 0.0, 0.0))]
)
def test_simpson_after_a_filter(rate: float, table: tuple[float, float, float]) -> None:
    x = filtered(rate)
    for _ in range(2):
        x = integrate.cumulative_simpson(x, dx=1.0 / rate, axis=-1, initial=0.0)
    x = without_trend(x)
    np.testing.assert_allclose(errors(x, rate), table, atol=0.3)


@pytest.mark.parametrize("rate", [5120.0, 25600.0])
def test_trapezoid_alone_drifts_by_metres(rate: float) -> None:
    assert np.ptp(twice_trapezoid(rig(rate), rate)) > 1.0


@pytest.mark.parametrize("rate", [5120.0, 25600.0])
def test_hann_lines_of_a_tenth_of_a_second_lose_four_per_cent(rate: float) -> None:
    x = without_trend(rig(rate, 0.1))
    spectrum = amplitude_spectrum(x, rate, "hann")
    losses = [
        100
        * (
            spectrum.amplitudes[round(f / spectrum.bin_width)] / (amplitude * (2 * np.pi * f) ** 2)
            - 1
        )
        for f, amplitude in LINES
    ]
    assert min(losses) == pytest.approx(-4.2, abs=0.5)


@pytest.mark.parametrize(
    ("taps", "loss", "within"),
    [(65, -18.7, 0.1), (129, -6.9, 0.1), (257, 0.0, 0.15), (513, 0.0, 0.15), (1025, 0.0, 0.15)],
)
def test_taps_decide_the_gain_at_the_line(taps: int, loss: float, within: float) -> None:
    band = BandPass(25600.0, (0.5 * 419.7, 3 * 419.7), taps)
    assert 100 * (float(band.gain(419.7)) - 1) == pytest.approx(loss, abs=within)


def test_a_filtered_line_keeps_phase_and_loses_only_its_edges() -> None:
    rate, frequency = 1000.0, 120.0
    t = np.arange(3000) / rate
    x = np.cos(2 * np.pi * frequency * t)
    band = BandPass(rate, (60.0, 200.0), 301)
    y = through(band, x)
    assert y.size == t.size - 300
    expected = float(band.gain(frequency)) * x[150:-150]
    np.testing.assert_allclose(y, expected, atol=1e-12)


def test_filter_refusals() -> None:
    with pytest.raises(InputError, match=r"^band: got 50\.\.600; allowed 0 < low < high < 500"):
        BandPass(1000.0, (50.0, 600.0), 65)
    with pytest.raises(InputError, match=r"^taps: got 64; allowed an odd number >= 3; the delay"):
        BandPass(1000.0, (50.0, 60.0), 64)
    assert taps_for(1000.0, transition=10.0) % 2 == 1


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("rate", [5120.0, 25600.0])
def test_line_within_five_hundredths_per_cent_and_two_hundredths_bin(
    rate: float, seed: int, compared: Compared
) -> None:
    x = without_trend(rig(rate, 4.0, seed))
    for frequency, amplitude in LINES:
        line = line_in(line_spectrum(x, rate), near=frequency, half_width=4.0)
        compared(
            "frequency of a noisy line, in bins",
            "the line put in",
            (line.frequency - frequency) * x.size / rate,
            0.02,
        )
        expected = amplitude * (2 * np.pi * frequency) ** 2
        compared(
            "amplitude of a noisy line", "the line put in", line.amplitude / expected - 1.0, 5e-4
        )


def test_a_line_is_looked_for_within_the_spectrum_alone() -> None:
    t = np.arange(5000) / 1000.0
    with pytest.raises(InputError, match=r"no bin of the spectrum lies there$"):
        line_in(line_spectrum(t, 1000.0), near=700.0, half_width=1.0)


def _band(rate: float) -> BandPass:
    return BandPass(rate, (0.4 * LINES[0][0], min(1.5 * LINES[2][0], 0.45 * rate)), 1025)
