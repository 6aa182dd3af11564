"""Orbit diagrams: states carried on, hysteresis between folds, published bifurcations."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from thermogear.analysis.bifurcations import FLIP, FOLD
from thermogear.analysis.branches import JUMP, KINDS, _Line, _on, _seeds, _with_bifurcations
from thermogear.analysis.continuation import continuation
from thermogear.analysis.diagram import diagram_plan, orbit_diagram
from thermogear.analysis.family import ModelFamily
from thermogear.analysis.orbits import periodic_orbit
from thermogear.analysis.settle import CHAOTIC, PERIODIC
from thermogear.base.errors import InputError
from thermogear.base.excitation import Periodic
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel

TABLE = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.245,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)
BISTABLE = TorsionalModel(
    damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1, mean_force=0.1, force_amplitude=0.05
)


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
    # no branch twice: at the first value every one stands elsewhere
    first = [
        (float(x), float(v))
        for line, xs, vs in zip(data.branch_value, data.branch_x, data.branch_v, strict=True)
        for x, v in zip(xs.values[line == values[0]], vs.values[line == values[0]], strict=True)
    ]
    assert len(first) >= 2
    assert len({(round(x, 6), round(v, 6)) for x, v in first}) == len(first)


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


@pytest.mark.parametrize("scale", [1.0, 1e-4])
@pytest.mark.parametrize("axis", [0, 1])
def test_every_stretch_on_which_an_orbit_runs_on_gives_its_middle(scale, axis):
    """Stretches of 7, 3 and 1 values; the orbit is stored from either of its points on."""
    force = Periodic(0.1 * scale, (0.05 * scale,))
    model = DeadZoneModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness=Periodic(1.0, (0.1,)),
        force=force,
        half_backlash=scale,
    )
    values = np.linspace(0.60, 0.71, 12)
    unit = replace(model, frequency=float(values[7])).lanes().unit[0]
    drift = 0.01 * np.arange(12)[:, None] * unit
    drift[7:, axis] += (JUMP + 0.005 - 0.01) * unit[axis]  # one jump a little too far
    near, far = scale * np.array([[1.1, 0.5], [-0.3, -0.4]])
    two = np.stack([near + drift, far + drift])
    keep = 5
    order = (np.arange(keep) + np.array([0, 1, 1, 0, 1, 0, 0, 1, 0, 0, 1, 0])[:, None]) % 2
    state = two[order, np.arange(12)[:, None]]  # (value, section, 2)
    label = np.full(12, PERIODIC)
    label[10] = CHAOTIC
    period = np.full(12, 2)
    both = [(label, period, state), (np.full(12, CHAOTIC), 0 * period, state)]
    dims = ("direction", "start", "frequency")
    data = xr.Dataset(
        {
            "label": (dims, np.array([[b[0]] for b in both])),
            "period": (dims, np.array([[b[1]] for b in both])),
            "section_x": ((*dims, "section"), np.array([[b[2][..., 0]] for b in both])),
            "section_v": ((*dims, "section"), np.array([[b[2][..., 1]] for b in both])),
        },
        {"frequency": values},
    )
    family = ModelFamily(model, ("frequency",))
    found = list(_seeds(data, family, "frequency", 2))
    assert [(n, value) for n, value, _ in found] == [
        (2, values[3]),
        (2, values[8]),
        (2, values[11]),
    ]
    for (_, _, point), place in zip(found, (3, 8, 11), strict=True):
        assert np.array_equal(point, state[place, -1])
    assert list(_seeds(data, family, "frequency", 1)) == []
    # a jump a little shorter is none
    state[7:, :, axis] -= 0.01 * unit[axis]
    data["section_x"][0, 0], data["section_v"][0, 0] = state[..., 0], state[..., 1]
    again = list(_seeds(data, family, "frequency", 2))
    assert [value for _, value, _ in again] == [values[5], values[11]]


def test_an_orbit_lies_on_the_line_that_leads_to_it_and_on_no_other():
    """Below the fold at 0.79174 a stable and an unstable orbit are on one line, a third is not."""
    family = ModelFamily(BISTABLE, ("frequency",))
    low = periodic_orbit(BISTABLE, 1, (1.1776, 0.0074))
    branch = continuation(low, "frequency", 0.9)
    line = _Line(1, branch.values, branch.states, branch.multipliers, branch.bifurcations, cut=())
    turn = int(np.argmax(branch.values))
    assert 2 < turn < branch.values.size - 3
    for value in (0.705, 0.75, 0.7871, float(branch.values[2])):
        model = BISTABLE.replace(frequency=value)
        for part in (slice(None, turn), slice(turn, None)):
            at = np.argmin(np.abs(branch.values[part] - value))
            if abs(branch.values[part][at] - value) < 0.05:
                orbit = periodic_orbit(model, 1, branch.states[part][at])
                assert _on(line, orbit, value, family)
        other = periodic_orbit(model, 1, (0.65, 0.15))
        assert not _on(line, other, value, family)
        assert not _on(line, periodic_orbit(model, 2, orbit.state), value, family)
    assert not _on(line, periodic_orbit(BISTABLE.replace(frequency=0.85), 1), 0.85, family)


def test_a_bifurcation_met_on_two_branches_is_told_once():
    def at(value, kind=FOLD, period=1, note=""):
        return SimpleNamespace(
            value=value, kind=kind, period=period, note=note, state=np.array([value, -value])
        )

    one = SimpleNamespace(bifurcations=(at(2.0), at(1.0, FLIP, note="a"), at(0.0)))
    two = SimpleNamespace(
        bifurcations=(
            at(2.0 + 1e-7),  # the same fold to 1e-7 of its value
            at(2.0, FLIP),
            at(2.0, period=2),
            at(2.0 + 3e-7, note="b"),
            at(0.5e-10),
            at(2e-10),
        )
    )
    data = _with_bifurcations(xr.Dataset(), [one, two], ModelFamily(TABLE, ("frequency",)))
    told = list(
        zip(
            data.bifurcation_value.values.tolist(),
            [KINDS[k] for k in data.bifurcation_kind.values],
            data.bifurcation_period.values.tolist(),
            data.bifurcation_branch.values.tolist(),
            strict=True,
        )
    )
    assert told == [
        (0.0, FOLD, 1, 0),
        (2e-10, FOLD, 1, 1),
        (1.0, FLIP, 1, 0),
        (2.0, FOLD, 1, 0),
        (2.0, FOLD, 2, 1),
        (2.0, FLIP, 1, 1),
        (2.0 + 3e-7, FOLD, 1, 1),
    ]
    assert data.attrs["bifurcation_notes"] == '["", "", "a", "", "", "", "b"]'
    assert np.array_equal(data.bifurcation_x, -data.bifurcation_v)
    assert np.array_equal(data.bifurcation_x, data.bifurcation_value)


def test_each_block_needs_the_one_that_its_direction_comes_from():
    plan = diagram_plan(BISTABLE, "frequency", np.linspace(0.6, 0.7, 11), block=4)
    up, down = ([plan.needs((d, b)) for b in range(3)] for d in (0, 1))
    assert up == [None, (0, 0), (0, 1)]
    assert down == [(1, 1), (1, 2), None]
    for bad in ({"keep": 0}, {"block": 0}, {"branch_period": -1}):
        with pytest.raises(InputError, match=f"{next(iter(bad))}: got"):
            diagram_plan(BISTABLE, "frequency", [0.6, 0.7], **bad)
    assert diagram_plan(BISTABLE, "frequency", [0.6], keep=1, block=1, branch_period=0)
