"""Path of contact, velocities and Hertz line contact against kinematics and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermogear.gears.contact import (
    back_flank_position,
    curvature_radii,
    entrainment_velocity,
    flank_radii,
    hertz_half_width,
    hertz_pressure,
    pair_positions,
    pair_reduced_modulus,
    path_of_contact,
    reduced_modulus,
    reduced_radius,
    rolling_velocities,
    sliding_velocity,
    sum_velocity,
)
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair

RIG = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))
SHIFTED = GearPair(
    Gear(17, 3e-3, profile_shift=0.4), Gear(40, 3e-3, profile_shift=-0.1), centre_distance=86.6e-3
)


@pytest.mark.parametrize("pair", [RIG, SHIFTED])
def test_flank_velocities_are_those_of_the_turning_gears(pair: GearPair) -> None:
    """Velocity across the normal of each body's point at the contact, by plane kinematics."""
    omega = 104.7
    s = path_of_contact(pair, 41)
    angle = pair.operating_pressure_angle
    first = np.array([0.0, 0.0])
    normal = np.array([math.cos(angle), math.sin(angle)])  # from the pinion's centre to N1
    along = np.array([math.sin(angle), -math.cos(angle)])
    centre = np.array([pair.centre_distance, 0.0])
    points = pair.pinion.base_radius * normal + s[:, None] * along
    assert np.allclose(np.hypot(*(points - first).T), flank_radii(pair, s)[0])
    assert np.allclose(np.hypot(*(points - centre).T), flank_radii(pair, s)[1])

    def speed(point: np.ndarray, about: np.ndarray, rate: float) -> np.ndarray:
        arm = point - about
        return rate * np.stack([-arm[:, 1], arm[:, 0]], axis=1)

    v1 = speed(points, first, -omega)
    v2 = speed(points, centre, omega / pair.ratio)
    # along the line of action both move alike; across it they roll and slide
    assert np.allclose(v1 @ along, v2 @ along)
    rolling1, rolling2 = rolling_velocities(pair, omega, s)
    assert np.allclose(np.abs(v1 @ normal), rolling1)
    assert np.allclose(np.abs(v2 @ normal), rolling2)
    # across the line, towards the wheel's side, the flanks move backwards over the contact
    assert np.allclose((v2 - v1) @ normal, sliding_velocity(pair, omega, s))


def test_sliding_vanishes_exactly_at_the_pitch_point() -> None:
    assert float(sliding_velocity(RIG, 100.0, RIG.path.c)) == 0.0
    v1, v2 = rolling_velocities(RIG, 100.0, RIG.path.c)
    assert float(v1) == pytest.approx(float(v2), rel=1e-14)
    assert float(sum_velocity(RIG, 100.0, RIG.path.c)) == pytest.approx(
        2.0 * float(entrainment_velocity(RIG, 100.0, RIG.path.c))
    )


def test_velocities_broadcast_over_operating_points_and_positions() -> None:
    omega = np.array([[100.0], [200.0]])
    s = path_of_contact(RIG, 7)
    for one in (0, 1):
        assert np.array_equal(
            sliding_velocity(RIG, omega, s)[one], sliding_velocity(RIG, omega[one, 0], s)
        )
    assert np.allclose(
        sliding_velocity(RIG, omega, s), np.subtract(*rolling_velocities(RIG, omega, s))
    )


def test_reduced_radius_of_two_curvatures() -> None:
    s = path_of_contact(SHIFTED, 9)
    rho1, rho2 = curvature_radii(SHIFTED, s)
    assert np.allclose(1.0 / reduced_radius(SHIFTED, s), 1.0 / rho1 + 1.0 / rho2)
    assert float(reduced_radius(SHIFTED, 0.0)) == 0.0


def test_half_width_of_the_flash_example() -> None:
    """w = 200 N/mm, radii 21.4/64.1 mm, steel: B = 190 um."""
    radius = 21.4e-3 * 64.1e-3 / 85.5e-3
    assert float(hertz_half_width(200e3, radius, pair_reduced_modulus(RIG))) == pytest.approx(
        190e-6, abs=0.5e-6
    )


def test_half_width_for_equal_materials_carries_eta_4() -> None:
    w, rho, e, nu = 200e3, 0.016, 206e9, 0.3
    direct = math.sqrt(8.0 * w * rho * (1.0 - nu**2) / (math.pi * e))
    assert float(hertz_half_width(w, rho, reduced_modulus(e, nu, e, nu))) == pytest.approx(
        direct, rel=1e-14
    )


def test_hertz_pressure_carries_the_load() -> None:
    """The semi-ellipse of pressure over 2 B is the line load; its edges are load-free."""
    w, rho, e = np.array([0.0, 1e3, 2e5, 8e5]), 0.016, 113e9
    half, peak = hertz_half_width(w, rho, e), hertz_pressure(w, rho, e)
    assert np.allclose(0.5 * math.pi * half * peak, w)
    assert half[0] == 0.0
    assert peak[0] == 0.0
    assert float(hertz_pressure(1.0, 0.0, e)) == math.inf


def test_pairs_follow_each_other_by_one_base_pitch() -> None:
    phase = np.array([0.0, 0.5, 0.7, 0.72, 1.0])
    s = pair_positions(RIG, phase)
    assert s.shape == (5, 2)
    assert s[0, 0] == pytest.approx(RIG.path.a, rel=1e-15)
    assert s[0, 1] == pytest.approx(RIG.path.d, rel=1e-15)
    # the second pair leaves at phase eps - 1 = 0.714
    assert np.array_equal(np.isnan(s[:, 1]), [False, False, False, True, False])
    assert np.array_equal(s[4], s[0])


@pytest.mark.parametrize("pair", [RIG, SHIFTED])
def test_back_flank_position_is_an_involution(pair: GearPair) -> None:
    s = pair.path.a + np.linspace(0.0, 0.999, 50) * pair.base_pitch
    twice = back_flank_position(pair, back_flank_position(pair, s))
    off = np.mod(twice - s + 0.5 * pair.base_pitch, pair.base_pitch) - 0.5 * pair.base_pitch
    assert np.abs(off).max() < 1e-15


def test_back_flank_of_a_standard_pair() -> None:
    s = RIG.path.c
    got = float(back_flank_position(RIG, s))
    want = 2.0 * RIG.path.c + 0.5 * RIG.base_pitch - s
    assert (got - want) / RIG.base_pitch == pytest.approx(
        round((got - want) / RIG.base_pitch), abs=1e-12
    )
    assert RIG.path.a <= got < RIG.path.d


def test_back_flank_of_a_shifted_pair_by_turning_the_tooth() -> None:
    """A pinion tooth centred on the line of centres cuts both lines of action alike."""
    pair = GearPair(SHIFTED.pinion, SHIFTED.wheel)
    gear = pair.pinion
    thickness = float(gear.half_thickness_angle(pair.operating_radii[0]))
    s = pair.path.c + gear.base_radius * thickness
    got = float(back_flank_position(pair, s))
    assert (got - s) / pair.base_pitch == pytest.approx(
        round((got - s) / pair.base_pitch), abs=1e-9
    )
