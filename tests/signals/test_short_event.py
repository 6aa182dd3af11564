"""A short event, a level that changes, a sensor that dies: found there, and nothing else is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.signals.events import quiet, short_event


def vibration(random: np.random.Generator) -> NDArray[np.float64]:
    """A line with a sideband in noise, a load that walks by 10 %, or a run-up, or impacts."""
    count = int(random.integers(4_000, 40_000))
    turn = 2 * np.pi * 10 ** random.uniform(-2.0, -0.5) * np.arange(count)
    kind = random.integers(4)
    if kind == 1:
        turn = turn * np.linspace(0.5, 1.0, count)
    x = (1 + random.uniform(0, 0.3) * np.cos(turn / random.integers(10, 60))) * np.cos(turn)
    x += 10 ** random.uniform(-3, 0) * random.normal(size=count)
    if kind == 2:
        walk = np.cumsum(random.normal(size=count))
        x *= 1 + 0.1 * (walk - walk.mean()) / walk.std()
    if kind == 3:
        for at in range(0, count - 60, int(random.integers(60, 900))):
            x[at : at + 60] += 20.0 * np.exp(-np.arange(60) / 9.0) * np.cos(np.arange(60))
    return np.asarray(x)


def test_what_goes_on_is_no_event() -> None:
    random = np.random.default_rng([26, 11, 2026])
    assert [short_event(vibration(random)) for _ in range(200)] == [None] * 200


def test_an_event_is_found_in_its_place() -> None:
    random = np.random.default_rng([27, 11, 2026])
    found = 0
    for _ in range(60):
        x = vibration(random)
        first = int(random.integers(0, x.size - 200))
        x[first : first + 100] += 12.0 * np.ptp(x) * np.sin(1.3 * np.arange(100))
        event = short_event(x)
        if event is not None:
            found += 1
            assert event.first - 300 < first < event.last
            assert event.times > 5.0
    assert found >= 50  # beside rare impacts that come back nothing is told


def test_no_sensor_dies_in_what_goes_on() -> None:
    random = np.random.default_rng([28, 11, 2026])
    for _ in range(200):
        x = vibration(random)
        assert not quiet(x, np.ones(x.size, dtype=bool)).any()


def test_a_sensor_that_dies_beside_samples_that_are_missing_is_told() -> None:
    x = np.sin(1.3 * np.arange(20_000.0))
    x[12_000:] *= 1e-3
    free = np.ones(x.size, dtype=bool)
    free[11_500:12_000] = False
    assert np.flatnonzero(quiet(np.where(free, x, np.nan), free))[0] == 12_000


def test_a_machine_that_starts_is_no_sensor_that_dies() -> None:
    x = np.sin(1.3 * np.arange(20_000.0)) * np.linspace(0.0, 1.0, 20_000) ** 2
    assert not quiet(x, np.ones(x.size, dtype=bool)).any()


def test_a_sensor_that_dies_is_told_with_its_place() -> None:
    random = np.random.default_rng([29, 11, 2026])
    for _ in range(40):
        turn = 2 * np.pi * float(random.uniform(0.05, 0.4)) * np.arange(20_000)
        x = np.cos(turn) * (1 + 0.1 * np.cos(turn / 23)) + 0.3 * random.normal(size=turn.size)
        at = int(random.integers(3_000, 17_000))
        dead = np.where(np.arange(x.size) < at, x, 1e-2 * random.normal(size=x.size))
        still = np.flatnonzero(quiet(dead, np.ones(x.size, dtype=bool)))
        assert abs(int(still[0]) - at) <= 200
        assert still[-1] == x.size - 1
