"""Orders: angle from tacho and mesh line, resampling, Welch."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import interpolate, signal

from thermogear.base.errors import InputError
from thermogear.signals.following import follow_line
from thermogear.signals.orders import resample_by_angle, rising_edges
from thermogear.signals.spectra import order_amplitudes

RATE = 8192.0


def wandering_turns(seconds: float = 6.0) -> tuple[np.ndarray, np.ndarray]:
    """Time and shaft angle [turns] of a shaft at 20 turns/s whose speed wanders by 2 %."""
    t = np.arange(int(RATE * seconds)) / RATE
    return t, 20.0 * t + 0.1 * np.sin(2 * np.pi * 0.7 * t)


def gear(turns: np.ndarray) -> np.ndarray:
    mesh = np.cos(2 * np.pi * 25 * turns) + 0.3 * np.cos(2 * np.pi * 50 * turns)
    return mesh + 0.1 * np.cos(2 * np.pi * 26 * turns) + 0.05 * np.cos(2 * np.pi * 24 * turns)


def test_tacho_orders_are_sharp_where_the_speed_wanders() -> None:
    t, turns = wandering_turns()
    pulse = (np.mod(turns, 1.0) < 0.1).astype(float)
    smooth = signal.sosfiltfilt(signal.butter(2, 0.3, output="sos"), pulse)
    times = rising_edges(smooth, rate=RATE)
    assert times.size == pytest.approx(turns[-1], abs=2)
    angle = interpolate.CubicSpline(times, np.arange(times.size))(t, extrapolate=False)
    inside = np.isfinite(angle)
    y = resample_by_angle(gear(turns)[inside], angle[inside], samples_per_turn=256, turns=100)
    lines = order_amplitudes(y, samples_per_period=256, periods=100, orders=[24, 25, 26, 50, 25.5])
    np.testing.assert_allclose(lines[:4], [0.05, 1.0, 0.1, 0.3], rtol=0.05, atol=0.005)
    assert lines[4] < 0.005


def test_mesh_line_phase_gives_the_angle_without_a_tacho() -> None:
    t, turns = wandering_turns()
    rng = np.random.default_rng(1)
    x = gear(turns) + 0.2 * rng.standard_normal(t.size)
    # the neighbours at orders 24 and 26 lie 20 Hz off
    cycles = follow_line(x, RATE, frequency=500.0, half_width=15.0, cut=False).cycles
    difference = cycles - 25 * turns
    assert np.std(difference - np.round(difference.mean())) < 0.02
    y = resample_by_angle(x, cycles / 25.0, samples_per_turn=256, turns=100)
    lines = order_amplitudes(y, samples_per_period=256, periods=100, orders=[24, 25, 26, 50])
    np.testing.assert_allclose(lines, [0.05, 1.0, 0.1, 0.3], atol=0.02)


def test_refusals() -> None:
    assert rising_edges(np.zeros(100), rate=10.0).size == 0
    with pytest.raises(InputError, match=r"^angle: got shape \(5,\); allowed rising"):
        resample_by_angle(np.zeros(5), [0, 1, 1, 2, 3], samples_per_turn=8)
    with pytest.raises(InputError, match=r"^half_width: got 0\.2"):
        follow_line(np.zeros(100), 1.0, frequency=0.1, half_width=0.2)
