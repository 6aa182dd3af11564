"""Where the flank ends and where contact begins; clearances; the least profile shift."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.pair import GearPair

SINE = math.sin(math.radians(20.0))


def test_fzg_c() -> None:
    """Flank from 67.73 and 102.6 mm, contact from 68.25 and 104.0 mm: no interference."""
    pair = GearPair(
        Gear(16, 4.5e-3, profile_shift=0.1817, tip_radius=41.23e-3, face_width=14e-3),
        Gear(24, 4.5e-3, profile_shift=0.1715, tip_radius=59.18e-3, face_width=14e-3),
    )
    form = [2e3 * gear.form_radius for gear in (pair.pinion, pair.wheel)]
    start = [2e3 * radius for radius in pair.start_radii]
    assert form == pytest.approx([67.73, 102.6], abs=0.051)
    assert start == pytest.approx([68.25, 104.0], abs=0.051)
    assert form[0] == pytest.approx(67.73, abs=0.006)
    assert start[0] == pytest.approx(68.25, abs=0.006)


@pytest.mark.parametrize(("teeth", "shift"), [(10, 0.415), (12, 0.298), (14, 0.181), (16, 0.064)])
def test_least_shift(teeth: int, shift: float) -> None:
    assert 1.0 - 0.5 * teeth * SINE**2 == pytest.approx(shift, abs=6e-4)
    least = Gear(teeth, 3e-3, profile_shift=0.5).minimum_profile_shift
    assert least == pytest.approx(shift, abs=6e-4)
    assert not Gear(teeth, 3e-3, profile_shift=least).undercut
    assert Gear(teeth, 3e-3, profile_shift=least - 0.01, allow_undercut=True).undercut


def test_form_circle_in_closed_form() -> None:
    """d_Ff = sqrt(g^2 + d_b^2), g = d sin(a) - 2 B/sin(a), B = m (h_fP - x - rho (1 - sin a))."""
    rng = np.random.default_rng(21771)
    for _ in range(60):
        teeth, m, x = int(rng.integers(18, 120)), float(rng.uniform(1e-3, 8e-3)), 0.1
        rack = Rack(dedendum=1.25, fillet_radius=float(rng.uniform(0.1, 0.38)))
        gear = Gear(teeth, m, profile_shift=x + float(rng.uniform(0.0, 0.5)), rack=rack)
        depth = 1.25 - gear.profile_shift - rack.fillet_radius * (1.0 - SINE)
        g = m * teeth * SINE - 2.0 * m * depth / SINE
        assert 2.0 * gear.form_radius == pytest.approx(
            math.hypot(g, 2.0 * gear.base_radius), rel=1e-12
        )


def test_contact_begins_above_the_form_circle_and_clearances_are_the_racks() -> None:
    rng = np.random.default_rng(53)
    for _ in range(60):
        z1, z2 = (int(z) for z in rng.integers(18, 90, 2))
        pair = GearPair(Gear(z1, 2e-3), Gear(z2, 2e-3))
        for gear, start in zip((pair.pinion, pair.wheel), pair.start_radii, strict=True):
            assert start >= gear.form_radius * (1.0 - 1e-9)
            assert start < gear.pitch_radius
        assert pair.tip_clearances == pytest.approx([0.25 * 2e-3] * 2, rel=1e-9)
        assert pair.swapped().start_radii == pytest.approx(pair.start_radii[::-1], rel=1e-12)
        # a tip that touches the pinion there: its own contact's other end
        rho = math.sqrt(pair.wheel.tip_radius**2 - pair.wheel.base_radius**2)
        reach = pair.line_of_action - rho
        assert pair.start_radii[0] == pytest.approx(
            math.hypot(pair.pinion.base_radius, reach), rel=1e-12
        )
