"""Codes that stick, values that wrap around, coarse levels, another grid: seen, nothing else is."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from thermogear.signals.bridged import evenly
from thermogear.signals.converter import coarse, missing_codes, stuck, wrapped
from thermogear.signals.lines import find_line
from thermogear.signals.quality import damages

Floats = NDArray[np.float64]
SEED = 27_11_2026
KINDS = {"stuck", "wrapped", "another grid", "coarse"}


def everywhere(x: Floats) -> NDArray[np.bool_]:
    return np.ones(x.size, dtype=bool)


def drawn(random: np.random.Generator, count: int = 6000) -> Floats:
    """Lines of a mesh and its sidebands in noise; in step, square, in bursts, or in rest."""
    n = np.arange(count)
    kind = random.integers(5)
    pace = 1.0 / random.integers(4, 100) if kind == 1 else random.uniform(0.01, 0.4)
    turn = 2 * np.pi * pace * n + random.uniform(0.0, 6.0)
    x = (1.0 + random.uniform(0, 0.3) * np.cos(turn / 20)) * np.cos(turn)
    x += random.uniform(0, 0.5) * np.cos(2 * turn + 1)
    if kind == 2:
        x = np.tanh(random.uniform(1.0, 30.0) * x)
    if kind == 3:
        x *= np.maximum(0.01, np.cos(2 * np.pi * n / random.uniform(200, 3000)))
    if kind == 4:
        x = np.exp(-(n % 300) / random.uniform(5, 40)) * x
    return np.asarray(x + 10 ** random.uniform(-5.0, -0.5) * random.normal(size=count))


def test_an_undamaged_record_shows_no_fault_of_a_converter() -> None:
    random = np.random.default_rng([SEED, 1])
    for _ in range(250):
        x = drawn(random)
        step = 2.0 * float(np.max(np.abs(x))) * 2.0 ** -random.integers(8, 25)
        told = {one.kind for one in damages(np.round(x / step) * step)}
        assert not told & KINDS


def test_stuck_samples_are_found_and_no_other() -> None:
    random = np.random.default_rng([SEED, 2])
    for share in (0.005, 0.02, 0.1):
        x = np.cos(0.37 * np.arange(8000)) + 0.1 * random.normal(size=8000)
        at = random.random(x.size) < share
        value = float(random.uniform(-0.8, 0.8))
        x[at] = value
        ((found, where),) = stuck(x, everywhere(x))
        assert where == value
        np.testing.assert_array_equal(found, at)


def test_no_level_sticks_where_a_part_is_not_rounded() -> None:
    random = np.random.default_rng([SEED, 7])
    for bits in (9, 10, 11, 12, 14):
        turn = 2 * np.pi * float(random.uniform(0.1, 0.2)) * np.arange(10000)
        x = np.cos(turn) + 0.1 * random.normal(size=turn.size)
        step = 16.0 * 2.0**-bits
        part = slice(3000, int(random.integers(3500, 9000)))
        y = np.round(x / step) * step
        y[part] = x[part]
        assert stuck(y, everywhere(y)) == []


@pytest.mark.parametrize("noise", [0.01, 0.05, 0.2])
@pytest.mark.parametrize("pace", [0.0113, 0.1637, 0.297])
def test_wrapped_samples_are_put_back(noise: float, pace: float) -> None:
    random = np.random.default_rng([SEED, 3])
    turn = 2 * np.pi * pace * np.arange(16000)
    x = (1.0 + 0.3 * np.cos(turn / 23.0)) * np.cos(turn) + noise * random.normal(size=turn.size)
    assert wrapped(x, everywhere(x)) == []
    for share in (0.005, 0.02):
        limit = float(np.quantile(np.abs(x), 1.0 - share))
        over = np.mod(x + limit, 2.0 * limit) - limit
        whole = over.copy()
        for at, put in wrapped(over, everywhere(x)):
            whole[at] += put
        assert np.mean(np.abs(whole - x) > 0.05) < 0.1 * share


def test_values_that_wrap_around_in_noise_are_told_and_hard_ends_alone_are_not() -> None:
    random = np.random.default_rng([SEED, 6])
    told = 0
    for share in (0.003, 0.01, 0.03, 0.08) * 6:
        turn = 2 * np.pi * float(random.uniform(0.02, 0.3)) * np.arange(10000)
        x = np.cos(turn) + 0.5 * np.cos(2.0 * turn) + 0.6 * random.normal(size=turn.size)
        limit = float(np.quantile(np.abs(x), 1.0 - share))
        told += bool(wrapped(np.mod(x + limit, 2.0 * limit) - limit, everywhere(x)))
        for ends in (np.arcsin(np.sin(turn)), random.uniform(-1.0, 1.0, turn.size)):
            assert wrapped(ends + 0.2 * np.cos(turn), everywhere(x)) == []
    assert told >= 21


def test_samples_set_to_a_value_near_an_end_are_told_and_wrap_around_nowhere() -> None:
    random = np.random.default_rng([SEED, 8])
    x = np.cos(0.37 * np.arange(8000)) + 0.1 * random.normal(size=8000)
    at = random.random(x.size) < 0.08
    for beyond in (1, 3):
        value = float(np.sort(x)[-1 - beyond])
        y = np.where(at & (x < value), value, x)
        told = damages(y)
        assert "wrapped" not in {one.kind for one in told}
        assert sum(one.count for one in told) > 0.8 * np.count_nonzero(at)


def test_two_states_are_no_amplitude() -> None:
    x = np.cos(0.37 * np.arange(8000)) + 0.05 * np.random.default_rng(SEED).normal(size=8000)
    assert coarse(np.where(x > 0.1, 1.0, 0.0), everywhere(x)) > 0.25
    assert coarse(np.ones(8000), everywhere(x)) == 0.0


def test_coarse_levels_falsify_a_line_by_no_more_than_is_told() -> None:
    random = np.random.default_rng([SEED, 4])
    told = 0
    for _ in range(60):
        step = float(10 ** random.uniform(-1.0, -0.2))
        pace = float(random.uniform(0.05, 0.4))
        x = np.cos(2 * np.pi * pace * np.arange(8192)) + random.uniform(-1.0, 1.0)
        x += step * float(10 ** random.uniform(-3.0, -0.5)) * random.normal(size=x.size)
        y = np.round(x / step) * step
        true, read = (find_line(v - v.mean(), 1.0, near=pace, half_width=1e-3) for v in (x, y))
        share = coarse(y, everywhere(y))
        assert abs(read.amplitude / true.amplitude - 1.0) <= share + 0.01
        told += share > 0.01
    assert told > 30


def test_samples_repeated_at_even_distances_are_another_grid() -> None:
    random = np.random.default_rng([SEED, 5])
    x = np.cos(1.01 * np.arange(8000)) + 0.1 * random.normal(size=8000)
    for times in (1.002, 1.0078, 1.03, 1.1):
        y = x[np.rint(np.arange(x.size) / times).astype(int)]
        (told,) = damages(y)
        assert told.kind in KINDS
        assert told.count == pytest.approx(x.size * (1.0 - 1.0 / times), abs=2)
    repeats = np.concatenate([[False], random.random(x.size - 1) < 0.03])
    places = np.flatnonzero(repeats)
    x[places] = x[places - 1]
    assert not evenly(x, repeats)


@pytest.mark.parametrize("bit", [2, 4, 6, 8, 10])
def test_a_bit_that_does_not_change_is_told_and_decimals_are_not(bit: int) -> None:
    random = np.random.default_rng([SEED, 9, bit])
    for _ in range(10):
        turn = 2 * np.pi * float(random.uniform(0.02, 0.3)) * np.arange(12000)
        x = np.cos(turn) + float(10 ** random.uniform(-2, -0.3)) * random.normal(size=turn.size)
        codes = np.rint(x / float(np.max(np.abs(x))) * 1500.0).astype(np.int64)
        assert missing_codes((codes | 1 << bit).astype(float), everywhere(x)) == 1 << bit
        for step in (1.0, 0.00244140625, 9.80665e-3, 2.56):
            written = np.round(codes * step, 5)
            assert missing_codes(written, everywhere(x)) == 0
