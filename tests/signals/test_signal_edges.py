"""Edges of the signal formulas: the two sides of a line, and records that are too short."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.signals.filters import BandPass, taps_for
from thermogear.signals.following import follow_line
from thermogear.signals.lines import floor_around


@pytest.mark.parametrize(("lobe", "reach"), [(2, 10), (4, 60), (1, 25)])
def test_floor_of_a_sloping_spectrum_is_its_value_at_the_line(lobe: int, reach: int) -> None:
    """Both sides weigh alike, whatever stands in the lobe."""
    slope = np.arange(400.0)
    slope[200 - lobe : 200 + lobe + 1] = 1e6
    assert floor_around(slope, 200, lobe=lobe, reach=reach) == 200.0


def test_floor_near_an_end_is_taken_from_what_is_there_without_the_mean() -> None:
    flat = np.full(50, 3.0)
    flat[0] = 1e9
    assert floor_around(flat, 2, lobe=1, reach=1) == 3.0
    assert floor_around(flat, 48, lobe=1, reach=10) == 3.0
    assert floor_around(np.ones(3), 1, lobe=1) == 0.0


@pytest.mark.parametrize("low", [0.0, -0.5, 100.0, 120.0])
def test_a_band_without_a_lower_edge_is_refused(low: float) -> None:
    with pytest.raises(InputError, match=r"^band: got"):
        BandPass(1000.0, (low, 100.0), 65)


@pytest.mark.parametrize("samples", [3, 40, 79])
def test_a_record_shorter_than_two_kernels_is_refused(samples: int) -> None:
    """A half width of 0.05 needs a kernel of 40 samples."""
    x = np.cos(0.4 * np.pi * np.arange(80))
    with pytest.raises(InputError, match=r"^half_width: got 0\.05; allowed above"):
        follow_line(x[:samples], 1.0, frequency=0.2, half_width=0.05)
    assert follow_line(x, 1.0, frequency=0.2, half_width=0.05).cycles.size == 80


@pytest.mark.parametrize(("rate", "width"), [(1000.0, 10.0), (25600.0, 100.0), (5120.0, 77.0)])
def test_taps_give_the_transition_of_a_hamming_window(rate: float, width: float) -> None:
    """3.3 rate/width taps: from the edge (-6 dB) half the width goes to -50 dB and to 0.5 %."""
    taps = taps_for(rate, transition=width)
    assert taps % 2 == 1
    assert 0.0 <= taps - np.floor(3.3 * rate / width) <= 2.0
    low, high = 0.1 * rate, 0.3 * rate
    band = BandPass(rate, (low, high), taps)
    for edge, outwards in ((low, -1.0), (high, 1.0)):
        assert float(np.abs(band.gain(edge))) == pytest.approx(0.5, abs=2e-3)
        assert float(np.abs(band.gain(edge + outwards * 0.6 * width))) < 10 ** (-45 / 20)
        assert float(band.gain(edge - outwards * 0.6 * width)) == pytest.approx(1.0, abs=5e-3)


def test_floor_beside_the_mean_takes_bin_one_and_leaves_the_mean_out() -> None:
    assert floor_around(np.array([9.0, 1.0, 100.0, 3.0, 50.0]), 2, lobe=0, reach=1) == 2.0
