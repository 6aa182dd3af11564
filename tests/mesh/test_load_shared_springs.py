"""Springs of single tooth pairs against the exact loaded contact they are read from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.gears.geometry import GearPair
from thermogear.gears.loaded import LoadedModel, mesh_force, solve_mesh
from thermogear.mesh.load_shared import pair_springs
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair, ThermalDeviation

PHASE = (np.arange(48) + 0.5) / 48


@pytest.fixture(scope="module")
def hot(rig: GearPair, hot_rig: Operating) -> HotPair:
    return HotPair(rig, hot_rig, MeshModel.consistent())


@pytest.fixture(scope="module")
def cold(rig: GearPair, hot_rig: Operating) -> HotPair:
    still = replace(hot_rig, temperatures=hot_rig.temperatures.cold())
    return HotPair(rig, still, MeshModel.consistent())


def test_at_the_mean_load_force_and_stiffness_are_the_contact_s(cold: HotPair) -> None:
    springs = pair_springs(cold)
    force = 100.0 / cold.pair.pinion.base_radius
    # at the springs' own samples the share of every pair is exact
    phase = np.arange(0, 240, 5) / 240 + 1e-12
    exact = solve_mesh(cold.pair, force, phase, model=LoadedModel(body="rim"))
    assert springs.force(exact.deflection, phase) == pytest.approx(
        np.full(phase.size, force), rel=1e-6
    )
    tangent = springs.stiffness_at(exact.deflection, phase)
    assert tangent.mean() == pytest.approx(exact.tangent.mean(), rel=2e-3)


def test_away_from_the_mean_load_the_springs_follow_the_contact(cold: HotPair) -> None:
    springs = pair_springs(cold)
    mean = 100.0 / cold.pair.pinion.base_radius
    rest = springs.deflection(mean, PHASE)
    for part in (0.3, 0.6, 1.5, 2.5):
        delta = float(part * rest.mean())
        exact, _ = mesh_force(cold.pair, delta, PHASE)
        # hardening of the contact is what straight springs leave out
        assert springs.force(delta, PHASE).mean() == pytest.approx(exact.mean(), rel=0.05)


def test_no_pair_jumps_into_contact(cold: HotPair) -> None:
    """Tip corners meet gradually: force at a given deflection is continuous in the phase."""
    springs = pair_springs(cold)
    fine = np.arange(2400) / 2400
    for delta in (2e-6, 5e-6, 10e-6):
        force = springs.force(delta, fine)
        steps = np.abs(np.diff(np.append(force, force[0])))
        assert steps.max() < 0.02 * force.mean()


def test_corner_contact_brings_further_pairs_in_as_the_load_grows(cold: HotPair) -> None:
    springs = pair_springs(cold)
    mean = 100.0 / cold.pair.pinion.base_radius
    fine = (np.arange(480) + 0.5) / 480
    shares = []
    for part in (0.1, 1.0, 8.0):
        delta = springs.deflection(part * mean, fine)
        k, s = springs.at(fine)
        shares.append(float(((k > 0.0) & (delta + s > 0.0)).sum(axis=0).mean()))
    assert shares == sorted(shares)
    assert shares[2] > shares[0] + 0.05


def test_back_flanks_of_a_cold_symmetric_pair_are_as_stiff_as_the_drive_flanks(
    cold: HotPair,
) -> None:
    mean = 100.0 / cold.pair.pinion.base_radius
    fine = (np.arange(480) + 0.5) / 480
    values = [
        side.stiffness_at(side.deflection(mean, fine), fine).mean()
        for side in (pair_springs(cold), pair_springs(cold, flank="back"))
    ]
    assert values[1] == pytest.approx(values[0], rel=2e-3)


def test_heat_stands_in_the_springs_as_added_material(hot: HotPair, cold: HotPair) -> None:
    mean = 100.0 / hot.pair.pinion.base_radius
    phase = np.arange(0, 240, 5) / 240 + 1e-12
    drive = pair_springs(hot)
    exact = solve_mesh(
        hot.pair,
        np.array([mean] * 3),
        phase,
        deviations=(ThermalDeviation(hot),),
        model=LoadedModel(body="rim"),
    )
    # the hot moduli move the deflection a little, the growth moves it by tens of micrometres
    assert drive.deflection(mean, phase) == pytest.approx(exact.deflection[0], abs=0.3e-6)
    assert drive.deflection(mean, phase).mean() < pair_springs(cold).deflection(mean, phase).mean()


def test_no_load_no_springs(hot: HotPair) -> None:
    idle = replace(hot, operating=replace(hot.operating, torque=np.zeros(3)))
    with pytest.raises(InputError, match=r"operating\.torque: got 0 N m; allowed > 0 N m"):
        pair_springs(idle)
    with pytest.raises(InputError, match="flank: got 'front'"):
        pair_springs(hot, flank="front")
