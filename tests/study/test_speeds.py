"""What is read off a look over the speeds: ranges, peaks, words."""

import numpy as np
import pytest
import xarray as xr

from said import numbers
from thermogear.analysis.settle import PERIODIC
from thermogear.base.display import rounded, worded
from thermogear.base.units import RPM
from thermogear.study.speeds import Speeds, told


def speeds(speed, factor, lost, least):
    data = {"dynamic_factor": factor, "contact_loss_share": lost, "mesh_force_min": least}
    data |= {"pinion_speed": speed, "label_code": np.full(np.shape(speed), PERIODIC)}
    return Speeds(xr.Dataset({name: ("motion", np.asarray(v)) for name, v in data.items()}), 0.025)


def test_ranges_and_peaks_are_those_of_the_curve():
    """Two resonances of known height and place; contact lost about the greater alone."""
    speed = np.linspace(100.0, 300.0, 81)
    near = [1.0 + h / (1.0 + ((speed - s) / 4.0) ** 2) for h, s in ((0.8, 140.0), (2.0, 240.0))]
    factor = near[0] + near[1] - 1.0
    lost, least = np.where(factor > 2.0, 0.1, 0.0), np.where(factor > 2.5, -1.0, 1.0)
    found = speeds(speed, factor, lost, least)
    (top, height), (second, lower) = found.peaks()
    assert (top, second) == pytest.approx((240.0, 140.0))
    assert (height, lower) == pytest.approx((factor[speed == 240.0][0], factor[speed == 140.0][0]))
    ((low, high),) = found.lost
    assert (low, high) == (speed[factor > 2.0][0], speed[factor > 2.0][-1])
    ((low, high),) = found.back
    assert (low, high) == (speed[factor > 2.5][0], speed[factor > 2.5][-1])
    assert found.several == []


def test_a_ripple_is_no_peak():
    speed = np.linspace(100.0, 300.0, 81)
    found = speeds(speed, 1.5 + 0.02 * np.sin(speed), 0.0 * speed, 1.0 + 0.0 * speed)
    assert found.peaks() == []
    assert found.lost == found.back == []


def test_two_motions_of_one_speed_make_a_range():
    grid = np.linspace(100.0, 200.0, 11)
    speed = np.concatenate([grid, grid[4:7]])
    found = speeds(speed, np.ones(14), np.zeros(14), np.ones(14))
    assert found.several == [(grid[4], grid[6])]
    assert found.grid == pytest.approx(grid)


def test_speeds_in_words():
    assert [rounded(value, digits=3) for value in (20123.0, 1994.0, 340.4, 12.34)] == [
        "20100", "1990", "340", "12.3"
    ]  # fmt: skip
    many = [(100.0 * RPM, 200.0 * RPM), (300.0 * RPM, 300.0 * RPM)]
    ends = (50.0 * RPM, 900.0 * RPM)
    assert numbers(worded(*told(many, ends=ends))[0]) == [100.0, 200.0, 300.0]
    assert numbers(worded(*told(many * 3, ends=ends))[0])[-1] == 3.0  # as many more
