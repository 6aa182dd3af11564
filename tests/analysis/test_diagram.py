"""Orbit diagrams: states carried on, hysteresis between folds, published bifurcations."""

import numpy as np
import pytest

from thermogear.analysis.branches import KINDS
from thermogear.analysis.diagram import orbit_diagram
from thermogear.base.errors import InputError
from thermogear.dynamics.models import TorsionalModel

TABLE = TorsionalModel(0.1535, 1.245, 0.335, 0.017, -1.16)
BISTABLE = TorsionalModel(0.05, 0.7, 0.1, 0.1, 0.05)


def located(data, kind, period):
    chosen = (data.bifurcation_kind.values == KINDS.index(kind)) & (
        data.bifurcation_period.values == period
    )
    return data.bifurcation_value.values[chosen]


@pytest.mark.parametrize("block", [1, 5, 100])
def test_chunks_hand_the_state_on(block):
    values = np.linspace(0.74, 0.82, 13)
    whole = orbit_diagram(BISTABLE, "frequency", values, block=1000, branch_period=0)
    parts = orbit_diagram(BISTABLE, "frequency", values, block=block, branch_period=0, threads=2)
    assert parts.identical(whole)


def test_jump_up_at_the_fold_and_hysteresis():
    """The lower branch ends at the fold w = 0.7917368893619342; going down the upper one stays."""
    values = np.linspace(0.75, 0.82, 15)
    data = orbit_diagram(BISTABLE, "frequency", values, starts=[(1.18, 0.007)], branch_period=1)
    up, down = data.section_x.values[0, 0, :, -1], data.section_x.values[1, 0, :, -1]
    before = values < 0.7917368893619342
    assert np.all(up[before] > 1.17)
    assert np.allclose(up[~before], down[~before], atol=1e-9)
    assert np.all(np.abs(up[before] - down[before]) > 0.05)
    assert np.min(np.abs(located(data, "fold", 1) - 0.7917368893619342)) < 1e-9
    unstable = data.branch_multiplier.values > 1.0
    assert unstable.any()


def test_cascade_of_the_damping_row():
    data = orbit_diagram(TABLE, "damping_ratio", np.linspace(0.10, 0.18, 21), branch_period=4)
    assert located(data, "period doubling", 1) == pytest.approx([0.17004302692235368], abs=1e-9)
    assert located(data, "period doubling", 4) == pytest.approx([0.1099488144665799], abs=1e-9)
    assert located(data, "period halving", 1) == pytest.approx([0.17004302692235368], abs=1e-8)
    assert data.period.values[0, 0, -1] == 1
    assert data.lyapunov.values[0, 0, 0] > 0.04


def test_backlash_has_no_effect_without_back_side_impacts():
    """x - b' is the same for every b' while x > -b' always; the diagram says so."""
    values = np.linspace(1.28, 1.30, 3)
    one = orbit_diagram(TABLE, "frequency", values, starts=[(1.1, 0.0)], branch_period=0)
    narrow = TABLE.replace(half_backlash=0.8)
    other = orbit_diagram(narrow, "frequency", values, starts=[(0.9, 0.0)], branch_period=0)
    assert not one.back_side_matters.values.any()
    assert np.allclose(one.section_x - 1.0, other.section_x - 0.8, atol=1e-9)


def test_several_starts_find_coexisting_orbits():
    data = orbit_diagram(
        BISTABLE, "frequency", [0.70, 0.71], starts=[(1.1, 0.0), (0.0, 0.0)], branch_period=0
    )
    ends = data.section_x.values[0, :, 0, -1]
    assert ends == pytest.approx([1.1775558499577545, 0.6479430038359856], abs=1e-9)


def test_bad_starts_and_parameters_are_refused():
    with pytest.raises(InputError, match="starts: got"):
        orbit_diagram(TABLE, "frequency", [1.1, 1.2], starts=[(0.0, 0.0, 0.0)])
    with pytest.raises(InputError, match="did you mean 'damping_ratio'"):
        orbit_diagram(TABLE, "damping", [0.1, 0.2])
