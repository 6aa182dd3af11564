"""A short event is found where it is, and nothing else is taken for one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.signals.events import short_event


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
