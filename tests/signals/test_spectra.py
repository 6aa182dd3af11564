"""Spectra: Parseval, exact lines, windows with their gains, orders of periodic records."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.signal import windows as reference_windows

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.signals.spectra import (
    Spectrum,
    amplitude_spectrum,
    order_amplitudes,
    order_lines,
)
from thermogear.signals.windows import WINDOWS, Window

SCIPY_NAMES = {"rectangular": "boxcar", "blackman-harris": "blackmanharris"}


def mean_square(spectrum: Spectrum) -> NDArray[np.float64]:
    """Of the windowed record, from the lines alone: (A_0^2 + sum A_k^2/2 + A_Nyquist^2)/ENBW."""
    shares = np.full(spectrum.amplitudes.shape[-1], 0.5)
    shares[[0, -1] if spectrum.samples % 2 == 0 else [0]] = 1.0
    return np.asarray(spectrum.amplitudes**2 @ shares / spectrum.noise_bandwidth)


@given(
    count=st.integers(16, 700),
    seed=st.integers(0, 2**31),
    name=st.sampled_from(WINDOWS),
)
def test_parseval_holds_for_every_window_and_length(count: int, seed: int, name: str) -> None:
    x = np.random.default_rng(seed).standard_normal((2, count)) + 0.3
    spectrum = amplitude_spectrum(x, 5120.0, name)
    weights = spectrum.window.samples(count)
    expected = np.sum((weights * x) ** 2, axis=-1) / np.sum(weights**2)
    np.testing.assert_allclose(mean_square(spectrum), expected, rtol=1e-9)


def test_parseval_with_a_rectangular_window_is_the_mean_square_itself() -> None:
    x = np.random.default_rng(3).standard_normal(4097)
    assert mean_square(amplitude_spectrum(x)) == pytest.approx(np.mean(x**2), rel=1e-12)


@pytest.mark.parametrize("name", WINDOWS)
def test_a_line_at_a_bin_is_read_exactly_and_offset_goes_to_zero_hertz(name: str) -> None:
    count, rate, rank = 1000, 2000.0, 137
    t = np.arange(count) / rate
    x = 0.25 + 3.0 * np.cos(2 * np.pi * rank * rate / count * t + 0.7)
    frequencies, amplitudes = amplitude_spectrum(x, rate, name)
    assert frequencies[rank] == pytest.approx(274.0, rel=1e-15)
    assert amplitudes[rank] == pytest.approx(3.0, rel=1e-12)
    assert amplitudes[0] == pytest.approx(0.25, rel=1e-11)


@pytest.mark.parametrize("name", WINDOWS)
def test_windows_agree_with_scipy_and_their_own_sums(name: str) -> None:
    mine = Window(name)
    theirs = getattr(reference_windows, SCIPY_NAMES.get(name, name))(512, sym=False)
    np.testing.assert_allclose(mine.samples(512), theirs, atol=1e-9)
    spectrum = amplitude_spectrum(np.ones(512), 1.0, name)
    assert spectrum.noise_bandwidth == pytest.approx(mine.noise_bandwidth, rel=1e-12)


@pytest.mark.parametrize("name", WINDOWS)
def test_the_loss_between_two_bins_follows_the_window_response(name: str) -> None:
    count, offset = 4096, 0.5
    x = np.cos(2 * np.pi * (1000 + offset) * np.arange(count) / count)
    read = amplitude_spectrum(x, 1.0, name).amplitudes[1000]
    assert read == pytest.approx(float(Window(name).response(offset)), rel=1e-3)


def test_noise_bandwidth_and_scalloping_are_the_published_ones() -> None:
    assert Window("rectangular").noise_bandwidth == pytest.approx(1.0)
    assert Window("hann").noise_bandwidth == pytest.approx(1.5)
    assert Window("blackman").noise_bandwidth == pytest.approx(1.7268, abs=1e-4)
    assert Window("flattop").noise_bandwidth == pytest.approx(3.7702, abs=1e-4)
    assert Window("rectangular").scalloping == pytest.approx(1 - 2 / np.pi)
    assert Window("hann").scalloping == pytest.approx(0.1512, abs=1e-4)
    assert Window("flattop").scalloping < 0.0012


def test_half_order_over_an_even_number_of_periods_is_exact(compared: Compared) -> None:
    per, periods = 128, 6
    t = np.arange(per * periods) / per
    x = 0.5 + 0.02 * np.cos(2 * np.pi * 0.5 * t + 0.3) + 0.8 * np.sin(2 * np.pi * t)
    amplitudes = order_amplitudes(
        x, samples_per_period=per, periods=periods, orders=[0.0, 0.5, 1.0, 1.5]
    )
    compared(
        "lines of a periodic record, half order among them",
        "the lines put in",
        amplitudes - [0.5, 0.02, 0.8, 0.0],
        1e-14,
    )
    assert np.angle(
        order_lines(x, samples_per_period=per, periods=periods, orders=0.5)[0]
    ) == pytest.approx(0.3, abs=1e-12)


def test_orders_keep_the_leading_axes_and_the_nyquist_order_is_single() -> None:
    per, periods = 8, 2
    t = np.arange(per * periods) / per
    x = np.stack([np.cos(2 * np.pi * 4 * t), 2.0 * np.cos(2 * np.pi * t)])
    lines = order_amplitudes(x, samples_per_period=per, periods=periods, orders=[1.0, 4.0])
    np.testing.assert_allclose(lines, [[0.0, 1.0], [2.0, 0.0]], atol=1e-14)


def test_an_order_between_two_lines_is_refused() -> None:
    x = np.zeros(64 * 3)
    message = (
        r"^orders: got 0\.5; allowed multiples of 1/3 over 3 periods; "
        r"take a number of periods that makes order x periods whole$"
    )
    with pytest.raises(InputError, match=message):
        order_amplitudes(x, samples_per_period=64, periods=3, orders=[1.0, 0.5])
    with pytest.raises(InputError, match=r"^record: got 191 samples; allowed 64 x 3 = 192"):
        order_amplitudes(x[:-1], samples_per_period=64, periods=3, orders=1.0)
    with pytest.raises(InputError, match=r"^orders: got \[33\.0\]; allowed 0\.\.32$"):
        order_amplitudes(x, samples_per_period=64, periods=3, orders=33.0)


def test_refusals_name_field_and_value() -> None:
    with pytest.raises(InputError, match=r"^window: got 'flatop'; did you mean 'flattop'\?$"):
        amplitude_spectrum(np.ones(8), 1.0, "flatop")
    with pytest.raises(InputError, match=r"^rate: got 0\.0; allowed > 0"):
        amplitude_spectrum(np.ones(8), 0.0)
    with pytest.raises(InputError, match=r"^record: got 1 non-finite of 8 samples"):
        amplitude_spectrum([0, 1, 2, np.nan, 4, 5, 6, 7])
