"""Backlash by ISO/TR 10064-2, DIN 3967 and DIN 3964, and its kinds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.gears.backlash import (
    backlash_span,
    normal_from_circumferential,
    normal_from_distance,
)
from thermogear.gears.backlash_standards import (
    ALLOWANCES,
    SERIES,
    centre_distance_tolerance,
    least_normal_backlash,
    recommended_normal_backlash,
    standard_backlash,
    thickness_limits,
    thickness_tolerance,
    upper_allowance,
)
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair

PAIR = GearPair(Gear(25, 3e-3), Gear(75, 3e-3))


@pytest.mark.parametrize(
    ("module", "distance", "whole", "half"),
    [
        (1.5, 50, 87, 43),
        (2, 100, 113, 57),
        (3, 100, 133, 67),
        (3, 200, 167, 83),
        (4.5, 91.5, 161, 80),
        (5, 200, 207, 103),
        (8, 400, 333, 167),
    ],
)
def test_recommended_least_backlash(module: float, distance: float, whole: int, half: int) -> None:
    found = 1e6 * least_normal_backlash(module=1e-3 * module, centre_distance=1e-3 * distance)
    assert found == pytest.approx(whole, abs=0.51)
    assert 0.5 * found == pytest.approx(half, abs=0.51)


def test_a_pair_asks_with_its_own_sizes() -> None:
    assert recommended_normal_backlash(PAIR) == pytest.approx(150e-6, rel=1e-12)


def test_thickness_by_din_3967() -> None:
    upper, lower = thickness_limits(0.1, "27cd")
    assert (1e6 * upper, 1e6 * lower) == pytest.approx((-70.0, -170.0))
    assert thickness_limits(0.1, "cd27") == (upper, lower)


def test_the_tables_run_evenly() -> None:
    diameters = (0.01, 0.05, 0.125, 0.28, 0.56)
    for d in diameters:
        thin = [upper_allowance(d, series) for series in ALLOWANCES]
        assert thin == sorted(thin)
        wide = [thickness_tolerance(d, number) for number in SERIES]
        assert wide == sorted(wide)
        assert len(set(wide)) == len(SERIES)
    for series in ALLOWANCES:
        row = [-upper_allowance(d, series) for d in diameters]
        assert row == sorted(row)
    for number in SERIES:
        column = [thickness_tolerance(d, number) for d in (*diameters, 1.0)]
        assert column == sorted(column)
    # a step holds its upper end
    assert upper_allowance(0.1251, "cd") < upper_allowance(0.125, "cd")
    for usual in ("b26", "c25", "cd25", "d25", "e25", "ab25", "d26", "f24", "f25", "g22"):
        assert thickness_limits(0.1, usual)[1] < 0.0


def test_centre_distance_by_din_3964() -> None:
    """IT6/7/8 of the printed table in um."""
    table = {
        50: (16, 25, 39),
        80: (19, 30, 46),
        120: (22, 35, 54),
        180: (25, 40, 63),
        250: (29, 46, 72),
    }
    for size, printed in table.items():
        found = [2e6 * centre_distance_tolerance(1e-3 * size, grade) for grade in (6, 7, 8)]
        assert found == pytest.approx(printed, abs=1e-6)
    sizes = np.geomspace(4e-3, 3.0, 60)
    rising = [centre_distance_tolerance(float(a)) for a in sizes]
    assert rising == sorted(rising)
    assert centre_distance_tolerance(51e-3) == pytest.approx(15e-6)


def test_the_pair_of_the_collection() -> None:
    """25/75 m 3, a 150, 25cd, js7: j 141..253 um, half 71..127 um."""
    span = standard_backlash(PAIR, "25cd", "25cd")
    assert 1e6 * span.least == pytest.approx(141.0, abs=0.6)
    assert 1e6 * span.most == pytest.approx(253.0, abs=0.6)
    assert 1e6 * span.half.least == pytest.approx(71.0, abs=0.6)
    assert 1e6 * span.half.most == pytest.approx(127.0, abs=0.6)
    assert span.middle == pytest.approx(0.5 * (span.least + span.most), rel=1e-3)


def test_span_against_the_linear_formula() -> None:
    """-(A1 + A2) cos(a) + 2 A_a sin(a_w), right to first order in the axis deviation."""
    rng = np.random.default_rng(3967)
    for _ in range(50):
        z1, z2 = (int(z) for z in rng.integers(18, 90, 2))
        pair = GearPair(Gear(z1, 2e-3, profile_shift=0.2), Gear(z2, 2e-3))
        one, two = -np.sort(rng.uniform(0.0, 2e-4, (2, 2)))
        play = float(rng.uniform(1e-6, 3e-5))
        span = backlash_span(pinion=tuple(one), wheel=tuple(two), distance=(-play, play), pair=pair)
        swapped = backlash_span(
            pinion=tuple(two), wheel=tuple(one), distance=(play, -play), pair=pair.swapped()
        )
        assert swapped == pytest.approx(span, rel=1e-12)
        cosine = math.cos(pair.pinion.pressure_angle)
        sine = math.sin(pair.operating_pressure_angle)
        least = -(max(one) + max(two)) * cosine - 2.0 * play * sine
        most = -(min(one) + min(two)) * cosine + 2.0 * play * sine
        assert span.least == pytest.approx(least, abs=1e-7)
        assert span.most == pytest.approx(most, abs=1e-7)
        assert span.least <= span.middle <= span.most


def test_kinds_of_backlash() -> None:
    normal = 2e-4
    around = normal / math.cos(PAIR.pinion.pressure_angle)
    assert normal_from_circumferential(around, PAIR) == pytest.approx(normal, rel=1e-15)
    radial = normal / (2.0 * math.sin(PAIR.operating_pressure_angle))
    # closing the axes by j_r closes the backlash, to first order
    short = 1e-3
    left = normal_from_distance(PAIR.centre_distance - short * radial, PAIR)
    assert -left == pytest.approx(short * normal, rel=1e-3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: upper_allowance(0.6, "cd"),
            "thickness.diameter: got 600 mm; allowed 0 < d <= 560 mm; "
            "the range of DIN 3967's table",
        ),
        (
            lambda: upper_allowance(0.1, "de"),
            "thickness.series: got 'de'; allowed a | ab | b | bc | c | cd | d | e | f | g | h; "
            "did you mean 'e'?",
        ),
        (
            lambda: thickness_tolerance(0.1, 31),
            "thickness.number: got 31; allowed 21..30; 24..27 is usual",
        ),
        (
            lambda: thickness_limits(0.1, "js7"),
            "thickness: got 'js7'; allowed series and number, such as 'cd25'",
        ),
        (
            lambda: centre_distance_tolerance(150.0),
            "centre_distance: got 150000 mm; allowed 3..3150 mm",
        ),
        (
            lambda: centre_distance_tolerance(0.15, 9),
            "centre_distance.grade: got 9; allowed 6 | 7 | 8",
        ),
    ],
)
def test_what_the_tables_do_not_hold(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value) == message
