"""Springs of single tooth pairs against the exact loaded contact they are read from."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.gears.loaded import LoadedModel, mesh_force, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.mesh.load_shared import LADDER, OUT_OF_REACH, _springs, pair_springs
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


def shared(k: np.ndarray, s: np.ndarray, loads: np.ndarray) -> SimpleNamespace:
    """Straight springs k <delta + s> (position, pair) side by side under each load."""
    low, high = -s.max(axis=-1), np.full(len(s), 1.0)
    delta = np.empty((loads.size, len(s)))
    for n, load in enumerate(loads):
        a, b = low.copy(), high.copy()
        for _ in range(200):
            middle = 0.5 * (a + b)
            over = (k * np.maximum(middle[:, None] + s, 0.0)).sum(axis=-1) > load
            a, b = np.where(over, a, middle), np.where(over, middle, b)
        delta[n] = b
    return SimpleNamespace(deflection=delta, force=k * np.maximum(delta[..., None] + s, 0.0))


@pytest.mark.parametrize("steps", [1, 2, 12])
def test_straight_springs_are_read_back_whichever_load_first_reaches_them(steps: int) -> None:
    mean = 2000.0
    loads = mean * np.concatenate([[0.99, 1.0, 1.01], LADDER[:steps]])
    # the first pair carries; the second touches at a share of the mean load, or never
    reach = np.array([0.5, 0.995, 1.005, 1.0094, 1.1, 1.3, 1.5, 1.9, 8.0, 1e6])
    k = np.tile([3e8, 2e8], (reach.size, 1))
    s = np.stack([np.zeros_like(reach), -reach * mean / 3e8], axis=1)
    stiffness, added = _springs(shared(k, s, loads))  # type: ignore[arg-type]
    assert stiffness[:, 0] == pytest.approx(k[:, 0], rel=1e-6)
    assert added[:, 0] == pytest.approx(np.zeros(reach.size), abs=1e-11)
    # two loads of the ladder, or of 1.01 and the first, must feel it
    seen = reach * mean < loads[-2]
    assert stiffness[:, 1] == pytest.approx(np.where(seen, k[:, 1], 0.0), rel=1e-6)
    assert added[:, 1] == pytest.approx(np.where(seen, s[:, 1], OUT_OF_REACH), abs=1e-11)


def test_a_pair_that_two_loads_leave_free_has_one_spring(cold: HotPair) -> None:
    """The ladder is geometric: a load a rung up seeks free pairs at the same loads."""
    point = cold.operating
    one, up = (
        pair_springs(
            replace(cold, operating=replace(point, torque=factor * point.torque)), positions=24
        )
        for factor in (1.0, LADDER[0])
    )
    force = 100.0 / cold.pair.pinion.base_radius
    phase = np.arange(24) / 24
    # free under both loads, and touched by the last load that both ladders hold
    free = [
        springs.deflection(1.01 * load, phase) + springs.at(phase)[1] < -1e-8
        for springs, load in ((one, force), (up, LADDER[0] * force))
    ]
    (k, s), (k_up, s_up) = one.at(phase), up.at(phase)
    both = free[0] & free[1] & (k > 0.0) & (k_up > 0.0)
    assert both.sum() >= 3
    assert k[both] == pytest.approx(k_up[both], rel=1e-6)
    assert s[both] == pytest.approx(s_up[both], abs=1e-12)
    assert LADDER[-1] == pytest.approx(14.55, abs=0.01)


def test_springs_of_one_point_are_its_own_among_others(rig: GearPair, hot_rig: Operating) -> None:
    """Two points that differ in everything, one common temperature among them."""
    heat = replace(
        hot_rig.temperatures,
        pinion_addendum=np.array([400.0, 430.0]),
        pinion_bore=np.array([380.0, 420.0]),
        wheel_addendum=np.array([390.0, 410.0]),
        wheel_bore=375.0,
        housing=np.array([350.0, 370.0]),
    )
    both = replace(
        hot_rig, speed=np.array([100.0, 200.0]), torque=np.array([80.0, 160.0]), temperatures=heat
    )
    for point in (0, 1):
        names = ("pinion_addendum", "pinion_bore", "wheel_addendum", "housing")
        alone = replace(
            both,
            speed=both.speed[point : point + 1],
            torque=both.torque[point : point + 1],
            temperatures=replace(heat, **{n: getattr(heat, n)[point] for n in names}),
        )
        model = MeshModel.consistent()
        among = pair_springs(HotPair(rig, both, model), point, positions=8)
        own = pair_springs(HotPair(rig, alone, model), positions=8)
        assert np.array_equal(among.stiffness, own.stiffness)
        assert np.array_equal(among.added, own.added)
