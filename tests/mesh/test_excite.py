"""The excitation that leaves the gears: masses, forces, frequencies, jammed points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear import (
    GearPair,
    InputError,
    MeshModel,
    Operating,
    Periodic,
    excitation,
    mesh_cycle,
)
from thermogear.mesh.excite import disc_inertia


def test_the_rig_as_solid_discs_of_pitch_radius(rig: GearPair, hot_rig: Operating) -> None:
    cycle = mesh_cycle(rig, hot_rig)
    found = excitation(cycle, rig, damping_ratio=0.07)
    assert len(found) == 3
    for one, rpm in zip(found, (1000.0, 2000.0, 3000.0), strict=True):
        assert one is not None
        assert one.equivalent_mass == pytest.approx(1.227, abs=5e-4)
        assert one.mesh_frequency == pytest.approx(2.0 * np.pi * 25.0 * rpm / 60.0, rel=1e-14)
        assert one.mean_force == pytest.approx(100.0 / rig.pinion.base_radius, rel=1e-14)
        # torques balance: no angular acceleration of the pair as a whole
        assert one.torques[0] / one.base_radii[0] == pytest.approx(
            one.torques[1] / one.base_radii[1], rel=1e-14
        )
        assert one.stiffness.mean == pytest.approx(float(cycle["mean_stiffness"][0]), rel=1e-12)


def test_disc_inertias_of_tip_and_bored_discs(rig: GearPair) -> None:
    tip = [disc_inertia(g, radius=g.tip_radius) for g in (rig.pinion, rig.wheel)]
    bored = [
        disc_inertia(g, radius=g.pitch_radius, bore_radius=g.bore_radius)
        for g in (rig.pinion, rig.wheel)
    ]
    r1, r2 = rig.pinion.base_radius, rig.wheel.base_radius

    def mass(inertias: list[float]) -> float:
        return inertias[0] * inertias[1] / (inertias[0] * r2**2 + inertias[1] * r1**2)

    assert mass(tip) == pytest.approx(1.633, abs=5e-4)
    assert mass(bored) == pytest.approx(1.195, abs=5e-4)


def test_inertia_of_a_thin_ring_is_mass_times_radius_squared(rig: GearPair) -> None:
    gear = rig.wheel
    mass = 7850.0 * gear.face_width * np.pi * (0.1**2 - 0.0999**2)
    ring = disc_inertia(gear, radius=0.1, bore_radius=0.0999)
    assert ring == pytest.approx(mass * 0.5 * (0.1**2 + 0.0999**2), rel=1e-12)


def test_jammed_points_have_no_excitation(rig: GearPair, hot_rig: Operating) -> None:
    cycle = mesh_cycle(rig, replace(hot_rig, half_backlash=20e-6))
    assert excitation(cycle, rig, damping_ratio=0.07) == [None, None, None]


def test_perfect_gears_at_equal_uniform_temperature_have_no_error(
    rig: GearPair, hot_rig: Operating
) -> None:
    cold = replace(hot_rig, temperatures=hot_rig.temperatures.cold())
    secant = MeshModel.consistent().override(spring="secant", stiffness="textbook-30-degree")
    cycle = mesh_cycle(rig, cold, secant)
    first = excitation(cycle, rig, damping_ratio=0.07)[0]
    assert first is not None
    assert np.all(first.error(np.arange(64) / 64) == 0.0)
    given = Periodic(0.0, (5e-6,))
    first = excitation(cycle, rig, damping_ratio=0.07, transmission_error=given)[0]
    assert first is not None
    assert first.error(np.arange(4) / 4) == pytest.approx([5e-6, 0.0, -5e-6, 0.0], abs=1e-20)


def test_motion_without_speed_is_refused(rig: GearPair, hot_rig: Operating) -> None:
    cycle = mesh_cycle(rig, replace(hot_rig, speed=np.zeros(3)))
    with pytest.raises(InputError, match=r"operating.speed: got 0 rpm; allowed > 0 rpm"):
        excitation(cycle, rig, damping_ratio=0.07)
    # the slowest creep is a motion, and one point at rest among others is none
    creep = mesh_cycle(rig, replace(hot_rig, speed=np.array([1e-3, 0.5, 2.0])))
    found = excitation(creep, rig, damping_ratio=0.07)
    assert [one.mesh_frequency for one in found if one is not None] == pytest.approx(
        [0.025, 12.5, 50.0], rel=1e-14
    )
    mixed = mesh_cycle(rig, replace(hot_rig, speed=np.array([100.0, 0.0, 100.0])))
    with pytest.raises(InputError, match=r"operating.speed: got 0 rpm"):
        excitation(mixed, rig, damping_ratio=0.07)


def test_error_and_stiffness_are_the_curves_of_their_own_point(
    rig: GearPair, hot_rig: Operating
) -> None:
    """Of three points the jammed one alone is left out; all harmonics give the samples back."""
    cycle = mesh_cycle(
        rig, replace(hot_rig, torque=np.array([50.0, 100.0, 200.0])), mesh_positions=65
    )
    cycle["status"][1] = 1
    given = Periodic(1e-6, (2e-6 + 1e-6j,))
    found = excitation(
        cycle, rig, damping_ratio=0.05, transmission_error=given, harmonics=32, inertias=(1.0, 2.0)
    )
    assert [one is None for one in found] == [False, True, False]
    for point in (0, 2):
        one = found[point]
        assert one is not None
        assert one.stiffness(np.arange(65) / 65) == pytest.approx(
            cycle["mesh_stiffness"].values[point], rel=1e-12
        )
        assert one.error(np.arange(65) / 65) == pytest.approx(
            given(np.arange(65) / 65) + cycle["spring_error"].values[point], abs=1e-15
        )
        assert (one.inertias, one.damping_ratio) == ((1.0, 2.0), 0.05)
        assert one.half_backlash == float(cycle["half_backlash"][point])
        assert one.reference_half_backlash == hot_rig.half_backlash
        assert one.torques == pytest.approx((50.0 * 2**point, 150.0 * 2**point), rel=1e-14)
