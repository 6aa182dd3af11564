"""Tooth pairs as springs of their own: limits, balance and agreement with the one spring."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.excitation import Periodic
from thermogear.base.pair_springs import PairSprings
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.load_shared import LoadSharedModel
from thermogear.dynamics.models import DeadZoneModel

COLUMNS = 65
PHASE = np.linspace(0.0, 1.0, COLUMNS)
NONE = PairSprings(np.zeros((1, 2)), np.zeros((1, 2)))
LINE = Periodic(1.0, (0.3,))


def alone(added: float = 0.0) -> PairSprings:
    """One pair that never leaves, with a cosine stiffness sampled finely."""
    fine = np.linspace(0.0, 1.0, 4097)
    return PairSprings(LINE(fine)[None], np.full((1, fine.size), added))


def entering() -> PairSprings:
    """Two pairs: as one enters the next one leaves; relieved towards both ends."""
    along = np.linspace(0.0, 2.0, 2 * COLUMNS - 1)
    k, s = 1.0 + 0.2 * np.sin(np.pi * along / 2), -0.4 * (along - 1.0) ** 4
    two = [np.stack([v[:COLUMNS], v[COLUMNS - 1 :]]) for v in (k, s)]
    return PairSprings(two[0], two[1])


def test_one_lasting_pair_is_the_one_spring() -> None:
    """m = 1, S = 0 on both sides: x'' + 2 zeta x' + k(t) f(x; b) = F with the same motion."""
    force = Periodic(0.1, (-0.2,))
    shared = LoadSharedModel(1.0, 0.16, 1.2, 1.0, force, alone(), alone())
    run = {"periods": 6, "samples_per_period": 32, "initial_state": (1.1, 0.0)}
    ours = simulate(shared, steps_per_period=4096, **run)  # type: ignore[arg-type]
    one = simulate(
        DeadZoneModel(
            damping_ratio=0.08, frequency=1.2, stiffness=LINE, force=force, half_backlash=1.0
        ),
        **run,
    )  # type: ignore[arg-type]
    assert ours["x"].values == pytest.approx(one["x"].values, abs=2e-5)
    assert ours.attrs["method"] == "rk4"
    assert int(ours["contact_losses"][0]) == int(one["contact_losses"][0])


def test_added_material_alike_on_all_drive_flanks_is_backlash_taken_up() -> None:
    force = Periodic(0.4, (0.1,))
    thick = LoadSharedModel(1.0, 0.1, 0.8, 1.0, force, alone(0.25), NONE)
    gap = LoadSharedModel(1.0, 0.1, 0.8, 0.75, force, alone(), NONE)
    y = np.linspace(0.5, 2.0, 7)
    assert thick.mesh_force(y, 0.3) == pytest.approx(gap.mesh_force(y, 0.3), rel=1e-14)


def test_the_sum_is_periodic_and_continuous_where_pairs_change_names() -> None:
    springs = entering()
    delta = np.linspace(-0.2, 1.0, 9)
    before, after = springs.force(delta, 1.0 - 1e-12), springs.force(delta, 0.0)
    assert before == pytest.approx(after, abs=1e-10)
    assert springs.force(delta, 0.37) == pytest.approx(springs.force(delta, 5.37), abs=1e-12)


def test_deflection_is_the_inverse_of_force() -> None:
    springs = entering()
    load = np.geomspace(1e-4, 10.0, 13)[:, None]
    phase = np.linspace(0.0, 0.999, 23)
    delta = springs.deflection(load, phase)
    assert springs.force(delta, phase) == pytest.approx(np.broadcast_to(load, delta.shape))
    # stiffness is the slope, and grows as further pairs touch
    slope = (springs.force(delta + 1e-7, phase) - springs.force(delta, phase)) / 1e-7
    inside = np.abs(slope - springs.stiffness_at(delta, phase)) < 1e-5
    assert inside.mean() > 0.99
    assert np.all(np.diff(springs.stiffness_at(delta, phase), axis=0) >= -1e-12)


def test_back_flanks_push_the_other_way_at_the_mirrored_phase() -> None:
    springs = entering()
    back = PairSprings(springs.stiffness, springs.added, offset=0.0, direction=-1)
    model = LoadSharedModel(1.0, 0.1, 0.8, 1.0, Periodic(0.0), springs, back)
    y, phase = np.linspace(-2.5, 2.5, 21), np.linspace(0.0, 2.0, 21)
    assert model.mesh_force(-y, -phase) == pytest.approx(-model.mesh_force(y, phase), abs=1e-13)


def test_compiled_steps_and_the_adaptive_reference_agree() -> None:
    model = LoadSharedModel(1.0, 0.2, 0.9, 1.0, Periodic(0.5, (0.1,)), entering(), NONE)
    run = {"periods": 2, "samples_per_period": 16, "initial_state": (model.rest(), 0.0)}
    fast = simulate(model, steps_per_period=4096, **run)  # type: ignore[arg-type]
    slow = simulate(model, method="adaptive", rtol=1e-9, atol=1e-11, **run)  # type: ignore[arg-type]
    assert slow.attrs["method"] == "adaptive"
    assert fast["x"].values == pytest.approx(slow["x"].values, abs=1e-5)


def test_rest_carries_the_mean_force() -> None:
    for mean in (0.3, -0.3):
        model = LoadSharedModel(1.0, 0.2, 0.9, 1.0, Periodic(mean), entering(), entering())
        assert float(model.mesh_force(model.rest(0.2), 0.2)) == pytest.approx(mean)


def test_impossible_springs_are_refused() -> None:
    with pytest.raises(InputError, match="allowed two arrays"):
        PairSprings(np.ones((2, 3)), np.ones((2, 4)))
    with pytest.raises(InputError, match="stiffness >= 0"):
        PairSprings(-np.ones((2, 3)), np.ones((2, 3)))
    with pytest.raises(InputError, match=r"mass: got 0\.0; allowed > 0"):
        LoadSharedModel(0.0, 0.1, 1.0, 1.0, Periodic(0.1), NONE, NONE)
