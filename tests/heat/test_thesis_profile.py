"""The thesis's deformation: its repaired reading, its printed form, the repaired profile."""

import math

import numpy as np
import pytest

from thermogear.base.materials import ZERO_CELSIUS
from thermogear.gears.geometry import Gear, involute
from thermogear.heat.expansion import RadialField, flank_growth, radial_displacement
from thermogear.heat.thesis_profile import (
    deformed_profile,
    flank_growth_as_printed,
    profile_as_printed,
    thesis_flank_growth,
    thesis_half_backlash,
)

LAM, COLD = 11.5e-6, ZERO_CELSIUS + 20.0
PINION = Gear(teeth=25, module=5e-3, bore_radius=0.025)
RADII = np.linspace(0.0590, 0.0675, 12)


def field(addendum: float, drop: float = 20.0) -> RadialField:
    hot = ZERO_CELSIUS + addendum
    return RadialField(
        bore_radius=PINION.bore_radius,
        tip_radius=PINION.tip_radius,
        bore_temperature=hot - drop,
        addendum_temperature=hot,
        reference=COLD,
    )


def test_reading_written_out_for_a_uniform_rise() -> None:
    """lambda tau { (cos a_k/2)[s r_k/r - 2 r_k (inv a_k - inv a)] + (r_k - r_b)/cos a_k }."""
    alpha, r = math.radians(20.0), 0.0625
    s = np.pi * 5e-3 / 2.0
    cosine = PINION.base_radius / RADII
    bracket = s * RADII / r - 2.0 * RADII * (involute(np.arccos(cosine)) - involute(alpha))
    expected = LAM * 100.0 * (0.5 * cosine * bracket + (RADII - PINION.base_radius) / cosine)
    ours = thesis_flank_growth(PINION, field(120.0, 0.0), RADII)
    assert ours == pytest.approx(expected, rel=1e-12)


def test_reading_is_two_to_four_times_too_small() -> None:
    radii = np.array([0.0625, 0.065, 0.0675])
    ratio = flank_growth(PINION, field(120.0), radii)
    ratio = ratio / thesis_flank_growth(PINION, field(120.0), radii)
    assert np.all((ratio > 1.9) & (ratio < 4.1))


def test_cold_is_undeformed() -> None:
    cold = RadialField.uniform(
        bore_radius=PINION.bore_radius,
        tip_radius=PINION.tip_radius,
        temperature=COLD,
        reference=COLD,
    )
    for function in (thesis_flank_growth, flank_growth_as_printed):
        assert np.all(function(PINION, cold, RADII) == 0.0)
    r, angle = deformed_profile(PINION, cold, RADII)
    assert np.array_equal(r, RADII)
    assert np.array_equal(angle, PINION.half_thickness_angle(RADII))


def test_printed_deformation_adds_a_pure_number_to_a_length() -> None:
    """Scaling the gear by two keeps the printed first term and doubles the second."""
    twice = Gear(teeth=25, module=1e-2, bore_radius=0.05)
    hot = ZERO_CELSIUS + 120.0
    same = RadialField(
        bore_radius=twice.bore_radius,
        tip_radius=twice.tip_radius,
        bore_temperature=hot - 20.0,
        addendum_temperature=hot,
        reference=COLD,
    )
    one = flank_growth_as_printed(PINION, field(120.0), RADII)
    two = flank_growth_as_printed(twice, same, 2.0 * RADII)
    assert np.min(np.abs(two / one - 2.0)) > 0.05


def test_printed_profile_radius_is_the_true_displacement() -> None:
    """r' = r + int + u_b is right as printed; theta' barely turns, lacking the temperature."""
    hot = field(120.0)
    r, angle = profile_as_printed(PINION, hot, RADII)
    moved = radial_displacement(
        hot, RADII, root_radius=PINION.root_radius, expansion=LAM, poisson=0.3
    )
    assert r == pytest.approx(RADII + moved, rel=1e-14)
    assert np.max(np.abs(angle - PINION.half_thickness_angle(RADII))) < 1e-6
    assert angle.shape == RADII.shape


def test_repaired_profile_of_a_uniform_rise_is_the_scaled_one() -> None:
    r, angle = deformed_profile(PINION, field(120.0, 0.0), RADII)
    assert r == pytest.approx(RADII * (1.0 + LAM * 100.0), rel=1e-13)
    assert angle == pytest.approx(PINION.half_thickness_angle(RADII), rel=1e-13)


def test_repaired_profile_grows_by_the_normal_growth() -> None:
    """Displacement (u_r, r dtheta) projected on the flank's normal is (B)."""
    hot = field(140.0)
    r, angle = deformed_profile(PINION, hot, RADII)
    alpha = PINION.pressure_angle_at(RADII)
    turned = RADII * (angle - PINION.half_thickness_angle(RADII))
    normal = (r - RADII) * np.sin(alpha) + turned * np.cos(alpha)
    assert normal == pytest.approx(flank_growth(PINION, hot, RADII), abs=1e-16)


def test_thesis_backlash_as_printed() -> None:
    assert thesis_half_backlash(125e-6, deformation_1=10e-6, deformation_2=30e-6) == pytest.approx(
        105e-6, rel=1e-14
    )
