"""Impacts that slip beside a shaft, as ``measure`` tells them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from thermogear.measured.figures import figures
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure

RATE = 12_800.0
SHAFT = 11.3  # turns/s
ORDER = 5.43


def bearing(seed: int) -> np.ndarray:
    """Impacts that slip by 1 %, ringing at 4.2 kHz, in noise; no mesh line."""
    random = np.random.default_rng(seed)
    count = 1 << 16
    rate = ORDER * SHAFT / RATE
    times = np.cumsum(1.0 + 0.01 * random.normal(size=int(count * rate))) / rate
    train = np.zeros(count)
    train[times[times < count - 1].astype(int)] = 1.0
    pole = np.exp(2 * np.pi * 4200.0 / RATE * (-0.03 + 1j))
    ringing = signal.lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], train)
    return np.asarray(ringing / np.std(ringing) + random.normal(size=count))


def test_impacts_are_told_in_hertz_and_by_the_speed_said() -> None:
    record = Record((Channel("cap", bearing(3), "g"),), "x", RATE, "given")
    found = measure(record, speed=2 * np.pi * SHAFT)
    assert found.teeth is None
    swelling = found.swellings[0]
    assert swelling.frequency == pytest.approx(ORDER * SHAFT, rel=3e-3)
    assert swelling.order == pytest.approx(ORDER, rel=3e-3)
    assert swelling.low * RATE < 4200.0 < swelling.high * RATE
    assert figures(found)["swellings"][0]["channel"] == "cap"
    assert swelling.words in figures(found)["evidence"]


def test_noise_has_none() -> None:
    noise = np.random.default_rng(8).normal(size=1 << 14)
    assert measure(Record((Channel("cap", noise, "g"),), "x", RATE, "given")).swellings == ()
