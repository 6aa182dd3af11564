"""Tip-corner contact against a rigid rotation found by root search, and its symmetries."""

from __future__ import annotations

import math
from dataclasses import replace

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
        float(got.gap * got.lever) - gap,
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
    # the same opening; the pinion's advance is that over its lever
    reached = np.isfinite(one.gap)
    assert np.array_equal(reached, np.isfinite(two.gap))
    for side in (one, two):
        assert np.all(side.lever[side.gap == 0.0] == 1.0)
    open_one, open_two = (side.gap[reached] * side.lever[reached] for side in (one, two))
    assert np.allclose(open_one, open_two, rtol=0, atol=1e-15)
    assert np.allclose(one.pinion, two.wheel, rtol=0, atol=1e-15)


def test_on_the_path_the_involutes_touch() -> None:
    s = np.linspace(RIG.path.a, RIG.path.e, 9)
    got = contact_point(RIG, s)
    assert np.array_equal(got.gap, np.zeros(9))
    assert np.array_equal(got.pinion, s)


def rounded(rounding: float) -> GearPair:
    """The rig with both tips' edges rounded."""
    return GearPair(*(replace(gear, tip_rounding=rounding) for gear in (RIG.pinion, RIG.wheel)))


@pytest.mark.parametrize("rounding", [0.0, 0.05e-3, 0.2e-3])
def test_a_rounded_edge_touches_where_its_circle_does(rounding: float) -> None:
    """The circle drawn as points, each a part of the pinion that turns until one touches."""
    pair = rounded(rounding)
    r1, q = pair.pinion.base_radius, pair.tip_ends[1]
    for part in (0.02, 0.05):
        s = pair.path.e + part * pair.base_pitch
        got = contact_point(pair, s)
        centre = complex(r1, q - rounding) * np.exp(1j * (s - q) / r1)

        def opening(turn: float, s: float = s, centre: complex = centre) -> float:
            """Least normal distance of the turned circle to the wheel's involute."""
            around = centre + 1j * rounding * np.exp(1j * np.linspace(-0.2, 0.2, 4001))
            point = around * np.exp(1j * turn)
            r2, length = pair.wheel.base_radius, pair.line_of_action
            seen = np.conj(complex(r1 + r2, length) - point)
            string = np.sqrt(np.abs(seen) ** 2 - r2**2)
            psi = np.angle(seen / (r2 - 1j * string))
            # where the involute of s stands on the same string
            return float(np.min(s - (length - string + r2 * psi)))

        assert opening(0.0) == pytest.approx(float(got.gap * got.lever), rel=1e-6)
        h = 1e-6
        assert -(opening(h) - opening(-h)) / (2 * h * r1) == pytest.approx(
            float(got.lever), rel=1e-6
        )
        # the mesh moves on by ds: the wheel falls back by ds along its normal, the edge by less
        ends = [contact_point(pair, s + d) for d in (-1e-6, 1e-6)]
        opens = np.diff([float(e.gap * e.lever) for e in ends])[0] / 2e-6
        assert opens == pytest.approx(1.0 - float(got.lever), rel=1e-6)


def test_a_rounding_shortens_the_path_and_leaves_its_limit() -> None:
    alpha = float(RIG.pinion.pressure_angle_at(RIG.pinion.tip_radius))
    for rounding in (1e-9, 1e-5):
        pair = rounded(rounding)
        lost = (RIG.path.e - pair.path.e) / rounding
        assert lost == pytest.approx((1.0 - math.sin(alpha)) / math.sin(alpha), rel=2e-3)
    off = RIG.path.e + np.array([0.01, 0.03]) * RIG.base_pitch
    sharp, round_ = contact_point(RIG, off), contact_point(rounded(1e-9), off)
    for name in ("gap", "lever", "angle", "wheel", "distance"):
        assert getattr(round_, name) == pytest.approx(getattr(sharp, name), rel=1e-5, abs=1e-10)
    assert np.array_equal(sharp.rounding, [0.0, 0.0])


def test_the_distance_to_an_edge_is_the_arc_of_the_flank() -> None:
    """Of the nearer edge: pinion near E, wheel near A; nothing off the path."""
    for s, radii in ((RIG.path.e - 1e-4, 1), (RIG.path.a + 1e-4, 0)):
        gear = (RIG.wheel, RIG.pinion)[radii]
        string = s if radii else RIG.line_of_action - s
        steps = np.linspace(string, (RIG.line_of_action - RIG.path.a, RIG.path.e)[radii], 2001)
        point = (gear.base_radius + 1j * steps) * np.exp(-1j * steps / gear.base_radius)
        arc = float(np.abs(np.diff(point)).sum())
        assert float(contact_point(RIG, s).distance) == pytest.approx(arc, rel=1e-6)
    assert float(contact_point(RIG, RIG.path.e + 1e-4).distance) == 0.0


def test_gap_starts_with_the_square_of_the_distance() -> None:
    d = np.array([1e-5, 2e-5]) * RIG.base_pitch
    for side in (contact_point(RIG, RIG.path.e + d), contact_point(RIG, RIG.path.a - d)):
        assert side.gap[1] / side.gap[0] == pytest.approx(4.0, rel=1e-3)


def test_without_extension_and_beyond_the_flank_nothing_touches() -> None:
    off = np.array([RIG.path.a - 1e-4, RIG.path.e + 1e-4])
    assert np.array_equal(contact_point(RIG, off, extended=False).gap, [np.inf, np.inf])
    assert np.array_equal(contact_point(RIG, [RIG.path.e + 40e-3]).gap, [np.inf])
