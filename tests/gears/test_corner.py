"""Tip-corner contact against a rigid rotation found by root search, and its symmetries."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from conftest import Compared
from thermogear.gears.corner import contact_point
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair

RIG = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))
SHIFTED = GearPair(
    Gear(17, 3e-3, profile_shift=0.4), Gear(40, 3e-3, profile_shift=-0.1), centre_distance=86.6e-3
)


@pytest.mark.parametrize("pair", [RIG, SHIFTED])
@pytest.mark.parametrize("part", [0.02, 0.1])
def test_late_gap_is_the_turn_that_brings_the_flank_to_the_corner(
    pair: GearPair, part: float, compared: Compared
) -> None:
    """Both flanks drawn as point sets; the wheel is turned until its flank meets the corner."""
    s = pair.path.e + part * pair.base_pitch
    r1, r2, length = pair.pinion.base_radius, pair.wheel.base_radius, pair.line_of_action
    # pinion: involute whose string at N1 (angle 0) is s long; its tip at string s_E
    psi = (s - pair.path.e) / r1
    tip = complex(r1, pair.path.e) * complex(math.cos(psi), math.sin(psi))
    centre = complex(r1 + r2, length)

    def flank_angle(advance: float) -> float:
        """Polar angle of the wheel's flank at the corner's radius, minus the corner's."""
        radius = abs(tip - centre)
        string = math.sqrt(radius**2 - r2**2)
        start = -(length - (s - advance)) / r2  # base point of the involute, from N2
        turn = start + string / r2
        point = centre - complex(r2, string) * complex(math.cos(turn), -math.sin(turn))
        # the string ends backwards along the line of action
        return float(np.angle((point - centre) / (tip - centre)))

    gap = brentq(flank_angle, -1e-3, 1e-2, xtol=1e-16)
    got = contact_point(pair, s)
    compared(
        "gap of a tip corner",
        "turning the drawn flank until it meets the corner",
        float(got.gap) - gap,
        1e-13,
        "m",
    )
    assert float(got.gap) > 0.0
    assert float(got.pinion) == pair.path.e


@pytest.mark.parametrize("pair", [RIG, SHIFTED])
def test_swapping_the_gears_swaps_early_and_late(pair: GearPair) -> None:
    other = pair.swapped()
    s = np.linspace(pair.path.a - 0.3 * pair.base_pitch, pair.path.e + 0.3 * pair.base_pitch, 41)
    one, two = contact_point(pair, s), contact_point(other, pair.line_of_action - s)
    assert np.allclose(one.gap, two.gap, rtol=0, atol=1e-15)
    assert np.allclose(one.pinion, two.wheel, rtol=0, atol=1e-15)


def test_on_the_path_the_involutes_touch() -> None:
    s = np.linspace(RIG.path.a, RIG.path.e, 9)
    got = contact_point(RIG, s)
    assert np.array_equal(got.gap, np.zeros(9))
    assert np.array_equal(got.pinion, s)


def test_gap_starts_with_the_square_of_the_distance() -> None:
    d = np.array([1e-5, 2e-5]) * RIG.base_pitch
    for side in (contact_point(RIG, RIG.path.e + d), contact_point(RIG, RIG.path.a - d)):
        assert side.gap[1] / side.gap[0] == pytest.approx(4.0, rel=1e-3)


def test_without_extension_and_beyond_the_flank_nothing_touches() -> None:
    off = np.array([RIG.path.a - 1e-4, RIG.path.e + 1e-4])
    assert np.array_equal(contact_point(RIG, off, extended=False).gap, [np.inf, np.inf])
    assert np.array_equal(contact_point(RIG, [RIG.path.e + 40e-3]).gap, [np.inf])
