"""Coarse levels: seen where they falsify a line, and nowhere else."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.signals.lines import line_in, line_spectrum
from thermogear.signals.quality import coarse, damages

Floats = NDArray[np.float64]
SEED = 27_11_2026


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
        assert "coarse" not in told


def test_coarse_levels_falsify_a_line_by_no_more_than_is_told() -> None:
    random = np.random.default_rng([SEED, 4])
    told = 0
    for _ in range(60):
        step = float(10 ** random.uniform(-1.0, -0.2))
        pace = float(random.uniform(0.05, 0.4))
        x = np.cos(2 * np.pi * pace * np.arange(8192)) + random.uniform(-1.0, 1.0)
        x += step * float(10 ** random.uniform(-3.0, -0.5)) * random.normal(size=x.size)
        y = np.round(x / step) * step
        true, read = (
            line_in(line_spectrum(v - v.mean(), 1.0), near=pace, half_width=1e-3) for v in (x, y)
        )
        share = coarse(y, everywhere(y))
        assert abs(read.amplitude / true.amplitude - 1.0) <= share + 0.01
        told += share > 0.01
    assert told > 30
