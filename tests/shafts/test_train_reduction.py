"""Fewer coordinates for a drive train: statics exact, frequencies from above, no false spring."""

from __future__ import annotations

import numpy as np
import pytest
from tests.conftest import Compared
from tests.dynamics.geared_trains import moving, rig
from tests.dynamics.test_geared_truth import TRUTH
from tests.shafts.trains import random_train

from thermogear.base.errors import InputError
from thermogear.dynamics.ladder import Engine
from thermogear.shafts.assembly import assemble
from thermogear.shafts.reduction import interface_of, reduced
from thermogear.shafts.statics import equilibrium

PARAMS = TRUTH["N3"]["params"]


def test_frequencies_fall_towards_the_true_ones(compared: Compared) -> None:
    assembly = rig(PARAMS)
    rest = equilibrium(assembly, 80.0, mesh=3.6e8, half_backlash=4e-5)
    errors = [
        reduced(assembly, count).frequency_errors(rest.linear()) for count in (20, 30, 60, None)
    ]
    assert all(one.min() > -1e-9 for one in errors)
    worst = [one.max() for one in errors]
    assert worst[1] <= worst[0] < 0.012
    assert worst[2] < 2e-4
    compared("all coordinates kept", "the whole train", errors[-1], 1e-9)


def test_statics_are_exact(compared: Compared) -> None:
    rng = np.random.default_rng(7)
    worst = []
    for _ in range(3):
        assembly = assemble(random_train(rng))
        torque = 50.0
        rest = equilibrium(assembly, torque, mesh=2e8, half_backlash=0.0)
        kept = reduced(assembly, len(interface_of(assembly)) + 3)
        stiff = kept.matrix(rest.linear().stiffness)
        p = np.linalg.solve(stiff, kept.vector(assembly.end_torques(torque)))
        delta = float(assembly.drive @ kept.basis @ p)
        worst.append(delta / rest.drive - 1.0)
    compared("deflection of the teeth, reduced", "the whole train", worst, 1e-8)


def test_open_flanks_leave_no_spring(compared: Compared) -> None:
    """Inside the gap the gears fall apart as those of the unreduced train do."""
    params = PARAMS | {"e_re": [], "e_im": [], "k_re": [], "k_im": [], "T1": 20.0, "b": 2e-3}
    assembly = rig(params)
    ends = []
    for count in (30, 60, None):
        model, _, kept = moving(assembly, params, count)
        # at rest without load, in the middle of the gap
        still = np.zeros(2 * model.size)
        run = Engine(model).run(still, 4)
        assert run.shares[1] == 1.0
        ends.append(float(run.state[: kept.size] @ model.drive))
    compared("free flight in the gap, 30 and 60", "the whole train", np.array(ends[:2]) / ends[2]
             - 1.0, 2e-3)  # fmt: skip


def test_too_few_coordinates_are_refused() -> None:
    with pytest.raises(InputError, match="coordinates"):
        reduced(rig(PARAMS), 12)
