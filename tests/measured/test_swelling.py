"""Impacts that slip beside a shaft, as ``measure`` tells them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal, stats

from thermogear.measured.figures import figures
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure
from thermogear.measured.swelling import PARTS, Swelling, defects_of
from thermogear.study.bearing_rates import bearing_rates

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


def swells(*orders: float) -> list[Swelling]:
    """Rates at these orders of the shaft."""
    return [
        Swelling(
            channel="a", position=1e-3 * order, frequency=None, order=order, low=0.1, high=0.2,
            powers=(9.0,), chance=1e-6,
        )
        for order in orders
    ]  # fmt: skip


def test_an_inner_race_is_found_by_lines_a_turn_beside_its_rate() -> None:
    """6205 of the reference table: 3.572 and 5.428 without slip, cage 0.397."""
    own = bearing_rates(["6205"])
    assert (own[0].outer, own[0].inner, own[0].cage) == pytest.approx(
        (3.572, 5.428, 0.397), abs=1e-3
    )
    (inner,) = defects_of(swells(1.0, 4.37, 3.37), own)
    assert (inner.part, inner.side_lines) == (PARTS[1], True)
    assert inner.order == pytest.approx(5.37)
    (outer,) = defects_of(swells(3.55), own)
    assert outer.part == PARTS[0]
    assert defects_of(swells(2.5), own) == ()


def test_the_chance_of_a_hit_is_how_often_rates_anywhere_hit() -> None:
    random = np.random.default_rng(12)
    own = bearing_rates(["6308"])
    ends = np.log([own[0].cage / 1.1, max(own[0].inner, own[0].element) * 1.1])
    hits, told = 0, 0.0
    for _ in range(400):
        found = defects_of(swells(*np.exp(random.uniform(*ends, 3))), own)
        direct = [one.chance for one in found if not one.side_lines]
        hits, told = hits + bool(direct), max([told, *direct])
    assert hits <= stats.binom.ppf(0.999, 400, told)
    assert hits >= stats.binom.ppf(0.001, 400, told)


def test_noise_has_none() -> None:
    noise = np.random.default_rng(8).normal(size=1 << 14)
    assert measure(Record((Channel("cap", noise, "g"),), "x", RATE, "given")).swellings == ()
