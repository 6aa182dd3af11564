"""Straight lines in place of samples: drawn bridges are seen, nothing else is."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import butter, sosfilt

from thermogear.signals.bridged import bridges
from thermogear.signals.quality import damages

Floats = NDArray[np.float64]
SEED = 26_11_2026


def drawn(random: np.random.Generator) -> Floats:
    """A mesh line with harmonics and one sideband; noise, white, filtered or walking; some records
    hold impacts, or begin quietly."""
    count = int(2 ** random.uniform(10, 13))
    turn = 2 * np.pi * 10 ** random.uniform(-3.0, -0.5) * np.arange(count)
    swing = 1.0 + random.uniform(0, 0.3) * np.cos(turn / random.integers(10, 60))
    x = swing * np.cos(turn) + random.uniform(0, 0.5) * np.cos(2 * turn + 1)
    noise = 10 ** random.uniform(-4, 0) * random.normal(size=count)
    kind = random.integers(5)
    if kind == 1:
        noise = sosfilt(butter(4, 10 ** random.uniform(-2, -0.1), output="sos"), noise)
    if kind == 2:
        noise = 0.1 * np.cumsum(noise)
    x = x + noise
    if kind == 3:
        for at in range(0, count - 60, int(random.integers(60, 400))):
            ring = np.exp(-np.arange(60) / random.uniform(2, 20))
            x[at : at + 60] += 30.0 * ring * np.cos(random.uniform(0.3, 3) * np.arange(60))
    if kind == 4:
        x *= np.clip(3 * (np.arange(count) / count - 0.3), 1e-3, 1.0)
    return np.asarray(x)


def written(x: Floats, random: np.random.Generator) -> Floats:
    """As a file holds it: all digits, single precision, six digits, three decimals, a converter."""
    form = random.integers(5)
    if form == 1:
        return x.astype(np.float32).astype(np.float64)
    if form == 2:
        return np.array([float(f"{one:.6g}") for one in x])
    if form == 3:
        return np.asarray(np.round(x + 50.0, 3))
    if form == 4:
        step = 8.0 * 2.0 ** -random.integers(10, 25)
        return np.asarray(np.round(x / step) * step)
    return x


def everywhere(x: Floats) -> NDArray[np.bool_]:
    return np.ones(x.size, dtype=bool)


def test_an_undamaged_record_has_no_straight_lines() -> None:
    random = np.random.default_rng([SEED, 1])
    for _ in range(300):
        x = written(drawn(random), random)
        assert not bridges(x, everywhere(x)).any()


def test_a_bridged_gap_is_found_to_the_sample() -> None:
    random = np.random.default_rng([SEED, 2])
    whole = 0
    for _ in range(60):
        x = drawn(random) + 0.05 * random.normal(size=1)
        x += 0.02 * random.normal(size=x.size)
        size = int(random.integers(8, 200))
        first = int(random.integers(20, x.size - size - 20))
        x[first : first + size + 1] = np.linspace(x[first], x[first + size], size + 1)
        found = np.flatnonzero(bridges(x, everywhere(x)))
        assert np.isin(found, np.arange(first, first + size + 1)).all()
        whole += np.array_equal(found, np.arange(first + 1, first + size))
    assert whole >= 50  # of 60: a line as level as noise, or a quiet place, is left alone


@pytest.mark.parametrize("bits", [10, 12, 16])
def test_a_line_between_levels_is_one_damage_and_sticks_to_no_level(bits: int) -> None:
    """Bridged behind the converter: the line's own values lie between its levels."""
    random = np.random.default_rng([SEED, 5, bits])
    step = 16.0 * 2.0**-bits
    for _ in range(5):
        turn = 2 * np.pi * float(random.uniform(0.1, 0.2)) * np.arange(10000)
        x = np.round((np.cos(turn) + 0.1 * random.normal(size=turn.size)) / step) * step
        x[3000:5001] = np.linspace(x[3000], x[3000] + 1.0, 2001)
        (told,) = damages(x)
        assert told.kind == "bridged"
        assert told.count == pytest.approx(2000, abs=2)
