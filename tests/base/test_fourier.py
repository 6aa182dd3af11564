"""Series of very many harmonics by FFT against the same term by term."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base import fourier
from thermogear.base.excitation import Periodic
from thermogear.dynamics.exact import _of_harmonics

RANDOM = np.random.default_rng(9)
ROWS = RANDOM.standard_normal((2, 31)) + 1j * RANDOM.standard_normal((2, 31))
ROWS[:, 0] = (2.0, -1.0)
SERIES = [Periodic(float(row[0].real), tuple(row[1:])) for row in ROWS]


@pytest.mark.parametrize("count", [1, 7, 30, 31, 60, 61, 64, 500])
def test_uniform_phases(count: int) -> None:
    phase = np.arange(count) / count
    for series, values in zip(SERIES, fourier.sampled(ROWS, count), strict=True):
        assert values == pytest.approx(series(phase), abs=1e-12)


@pytest.mark.parametrize(
    "phase",
    [
        np.arange(96) / 96,
        np.tile(np.arange(40) / 40, 3) + 5.0,
        np.arange(200)[::-1] / 100,
        np.array(0.3),
        np.array([0.1, np.nan, 0.7]),
        RANDOM.uniform(-2.0, 2.0, (5, 4)),
        np.empty(0),
    ],
)
def test_any_phases(phase: np.ndarray) -> None:
    found = fourier.values(ROWS, phase)
    for series, values in zip(SERIES, found, strict=True):
        assert values.shape == phase.shape
        np.testing.assert_allclose(values, series(phase), atol=1e-11)


@pytest.mark.parametrize("count", [16, 128, 512])
def test_taylor_tables(count: int) -> None:
    centres, half = (np.arange(count) + 0.5) / count, np.full(count, 0.5 / count)
    direct = _of_harmonics(ROWS, centres, half, 8)
    scale = np.abs(direct).max(axis=0)
    assert np.all(np.abs(fourier.taylor(ROWS, count=count, order=8) - direct) <= 1e-11 * scale)


@pytest.mark.parametrize("order", [0, 1, 3])
def test_a_bound_holds_and_is_near(order: int) -> None:
    rows = np.vstack([ROWS, np.eye(1, 31, 30) * np.exp(1j * np.pi / 8.0)])
    fine = np.arange(40_000) / 40_000
    for row, bound in zip(rows, fourier.bound(rows, order), strict=True):
        series = Periodic(float(row[0].real), tuple(row[1:]))
        greatest = np.abs((series.derivative(order) if order else series)(fine)).max()
        assert greatest * (1.0 - 1e-12) <= bound <= 1.09 * greatest


def test_very_many_harmonics_go_by_fft() -> None:
    few = Periodic(1.0, (0.5, 0.25j))
    many = Periodic(1.0, (0.5, 0.25j, *([0.0] * fourier.MANY)))
    phase = np.arange(64) / 64
    assert many(phase) == pytest.approx(few(phase), abs=1e-13)
    assert float(many(0.3)) == pytest.approx(float(few(0.3)), abs=1e-13)
    assert many.derivative(2)(phase) == pytest.approx(few.derivative(2)(phase), abs=1e-9)
