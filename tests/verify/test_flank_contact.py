"""Contact of finely divided flanks: Hertz, levers, corners, relief and heat done apart."""

from __future__ import annotations

import numpy as np
import pytest

from checked_pairs import corner_pairs, drawn_pairs
from finite_elements import pair_stiffness
from finite_elements.contact import FlankContact, closed
from finite_elements.sector import FlankSector

pytestmark = pytest.mark.slow


def test_pressure_in_mid_contact_is_that_of_hertz() -> None:
    """One pair carries 200 N/mm: p0 = sqrt(F E*/(pi rho)), a = sqrt(4 F rho/(pi E*))."""
    pair = corner_pairs()[0].pair
    s = pair.path.a + 0.85 * pair.base_pitch
    arcs = (
        s**2 / (2.0 * pair.pinion.base_radius),
        (pair.line_of_action - s) ** 2 / (2.0 * pair.wheel.base_radius),
    )
    pinion, wheel = (
        FlankSector(gear, 15e-6, core=(arc, 0.3e-3))
        for gear, arc in zip((pair.pinion, pair.wheel), arcs, strict=True)
    )
    contact = FlankContact(pair, (pinion, wheel), corners=False, near="stress")
    solved = contact.solve(200e3, 0.85)
    rho, modulus = s * (1.0 - s / pair.line_of_action), 0.5 * 206e9
    assert solved.pressure == pytest.approx(np.sqrt(200e3 * modulus / (np.pi * rho)), rel=0.01)
    half_width = np.sqrt(4.0 * 200e3 * rho / (np.pi * modulus))
    assert solved.half_width[0] == pytest.approx(half_width, rel=0.01)


@pytest.mark.parametrize(
    ("index", "phase", "deflection", "share"),
    [
        (0, [0.3625, 0.7125, 0.7625], [12.916, 13.402, 15.247], [0.4888, 0.6033, 0.7698]),
        (1, [0.2625, 0.3125, 0.7625], [14.329, 13.305, 17.848], [0.3478, 0.4443, 1.0]),
        (2, [0.2625, 0.3125, 0.7625], [13.889, 13.507, 13.175], [0.08556, 0.09612, 0.4642]),
    ],
)
def test_finite_elements_done_apart(
    index: int, phase: list[float], deflection: list[float], share: list[float]
) -> None:
    """m 5, 25/75 at 200 N/mm, plane strain near the contact: within 0.5 % and 0.006."""
    checked = corner_pairs()[index]
    force = checked.line_load * checked.pair.face_width
    got = pair_stiffness(
        checked.pair,
        force,
        phase,
        deviations=checked.deviations,
        corners=True,
    )
    assert 1e6 * got.deflection == pytest.approx(deflection, rel=5e-3)
    assert got.share[:, 1] == pytest.approx(share, abs=6e-3)
    assert got.share.sum(axis=-1) == pytest.approx(1.0, abs=7e-3)


def test_pressures_and_gaps_exclude_each_other() -> None:
    """Two springs of 1 and 2 under 3 with gaps 0 and 1: both carry, p = delta and 2 (delta - 1)."""
    stiff = np.diag([1.0, 0.5])
    ones = np.ones(2)
    pressure, deflection = closed(stiff, gap=np.array([0.0, 1.0]), area=ones, lever=ones, load=3.0)
    assert pressure == pytest.approx([5.0 / 3.0, 4.0 / 3.0])
    assert deflection == pytest.approx(5.0 / 3.0)
    pressure, deflection = closed(stiff, gap=np.array([0.0, 9.0]), area=ones, lever=ones, load=3.0)
    assert (pressure.tolist(), deflection) == ([3.0, 0.0], 3.0)


def test_drawn_pairs_are_of_their_kinds() -> None:
    pairs = [checked.pair for checked in drawn_pairs()]
    gears = [(pair.pinion, pair.wheel) for pair in pairs]
    assert len(pairs) == 12
    assert sum(g.pressure_angle > np.radians(24.9) for g, _ in gears) >= 2
    assert sum(min(g.profile_shift for g in both) >= 0.6 for both in gears) >= 2
    rims = [max((g.root_radius - g.bore_radius) / g.module for g in both) for both in gears]
    assert sum(rim < 1.5 for rim in rims) >= 2
    assert sum(pair.contact_ratio > 2.0 for pair in pairs) >= 2
    assert any(g.teeth < 15 for g, _ in gears)
    starts = [p.path.a / (p.pinion.base_radius * p.pinion.junction[1]) - 1.0 for p in pairs]
    assert 0.0 < min(starts) < 0.02
    assert [c.name for c in drawn_pairs()] == [c.name for c in drawn_pairs()]
