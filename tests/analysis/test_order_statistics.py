"""Quantiles and shares of a population out of a few drawn values, against closed forms."""

import math

import numpy as np
import pytest
from scipy import stats
from scipy.stats.mstats import hdquantiles

from thermogear.analysis.order_statistics import interval_ranks, proportion, quantile
from thermogear.base.errors import InputError


def test_the_ranks_are_those_of_the_binomial_distribution() -> None:
    assert [interval_ranks(64, share=share) for share in (0.1, 0.5, 0.9)] == [
        (2, 12),
        (24, 40),
        (53, 63),
    ]
    # nothing narrower holds the quantile so often
    for count in (3, 16, 64, 101):
        for share in (0.05, 0.5, 0.9):
            low, high = interval_ranks(count, share=share)
            drawn = stats.binom(count, share)

            def held(a: int, b: int) -> float:
                return float(drawn.cdf(b - 1) - drawn.cdf(a - 1))  # noqa: B023

            assert held(low, high) >= 0.95
            narrower = high - low - 1
            bounded = range(1, count + 1 - narrower)
            assert max((held(a, a + narrower) for a in bounded), default=0.0) < 0.95
            if low == 0 or high == count + 1:
                assert held(1, count) < 0.95


def test_the_greatest_of_64_bounds_the_95_percent_quantile() -> None:
    # all 64 lie below it with .95**64
    assert pytest.approx(0.9625, abs=5e-5) == 1.0 - 0.95**64
    assert interval_ranks(64, share=0.95)[1] == 64
    assert interval_ranks(58, share=0.95, confidence=1.0 - 0.95**58)[1] == 58
    assert quantile(np.arange(16.0), share=0.95).high == math.inf


def test_points_are_those_of_harrell_and_davis() -> None:
    values = np.random.default_rng(5).gumbel(size=37)
    for share in (0.05, 0.5, 0.9):
        there = hdquantiles(values, [share])[0]
        assert quantile(values, share=share).value == pytest.approx(there, rel=1e-12)
    moved = quantile(3.0 + 2.0 * values, share=0.9)
    np.testing.assert_allclose(moved, 3.0 + 2.0 * np.array(quantile(values, share=0.9)), rtol=1e-12)


def test_never_is_a_value() -> None:
    onset = np.append(np.arange(1.0, 41.0), np.full(24, np.inf))
    assert quantile(onset, share=0.5) == (32.0, 24.0, 40.0)
    assert quantile(onset, share=0.9) == (math.inf, math.inf, math.inf)
    assert quantile(np.full(16, np.inf), share=0.5).value == math.inf
    with pytest.raises(InputError, match="no nan"):
        quantile([1.0, math.nan], share=0.5)


def test_shares_are_those_of_clopper_and_pearson() -> None:
    for hits in (1, 31, 63):
        there = stats.binomtest(hits, 64).proportion_ci(method="exact")
        low, high = proportion(hits, of=64)[1:]
        assert (low, high) == pytest.approx((there.low, there.high), rel=1e-10)
    assert proportion(0, of=64)[1:] == pytest.approx((0.0, 1.0 - 0.05 ** (1 / 64)))
    assert proportion(64, of=64)[1:] == pytest.approx((0.05 ** (1 / 64), 1.0))


@pytest.mark.parametrize("name", ["normal", "exponential", "two far groups"])
def test_stated_intervals_hold_so_often(name: str) -> None:
    """1000 samples of 64: within 4 standard errors of 95 % at least, whatever the distribution."""
    rng = np.random.default_rng(7)
    draws, law = {
        "normal": (rng.standard_normal((1000, 64)), stats.norm()),
        "exponential": (rng.exponential(size=(1000, 64)), stats.expon()),
        "two far groups": (
            rng.standard_normal((1000, 64)) + 1e3 * (rng.random((1000, 64)) < 0.3), None
        ),
    }[name]  # fmt: skip
    for share in (0.5, 0.9, 0.95):
        true = (
            1e3 + stats.norm.ppf((share - 0.7) / 0.3)
            if share > 0.7
            else stats.norm.ppf(share / 0.7)
        )
        true = law.ppf(share) if law is not None else true
        found = [quantile(sample, share=share) for sample in draws]
        held = np.mean([one.low <= true <= one.high for one in found])
        assert held > 0.95 - 4.0 * math.sqrt(0.95 * 0.05 / 1000)
