"""Folds, flips and grazings by their own conditions, and carried from case to case."""

import numpy as np
import pytest

from thermogear.analysis.bifurcations import FLIP, FOLD, GRAZING, PITCHFORK, carried
from thermogear.analysis.continuation import continuation, family_of
from thermogear.analysis.labels import label
from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics.models import TorsionalModel

FORCED = TorsionalModel(
    damping_ratio=0.05,
    frequency=1.1,
    stiffness_amplitude=0.2,
    mean_force=0.1,
    force_amplitude=0.15,
)
DOUBLING = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.3,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)


@pytest.fixture(scope="module")
def branches():
    """The resonance of a loaded pair from above, and a rattle that doubles."""
    return (
        continuation(periodic_orbit(FORCED, 1, (1.1, 0.0)), "frequency", 0.45),
        continuation(periodic_orbit(DOUBLING, 1, (1.08, -0.25)), "frequency", 1.1),
    )


def test_every_event_meets_its_condition(branches):
    """mu = 1 at a fold, -1 at a flip; where contact changes an extreme stands on an edge."""
    seen = set()
    for event in (e for branch in branches for e in branch.bifurcations):
        seen.add(event.kind)
        mu = event.multipliers
        if event.kind == FOLD:
            assert abs(np.prod(1.0 - mu)) < 1e-9
        if event.kind == FLIP:
            assert abs(np.prod(1.0 + mu)) < 1e-9
        if event.kind == GRAZING:
            _, x, v = event.orbit.samples(4096)
            step = float(event.orbit.lanes.period[0]) / 4096
            turn = np.flatnonzero(v * np.roll(v, -1) <= 0.0)
            # by the parabola through the slopes at both ends
            share = v[turn] / (v[turn] - np.roll(v, -1)[turn])
            extremes = x[turn] + 0.5 * step * share * v[turn]
            b = float(event.orbit.lanes.half_backlash[0])
            assert np.min(np.abs(np.abs(extremes) - b)) < 1e-7
    assert seen == {FOLD, FLIP, GRAZING}


def test_contact_changes_at_grazings_alone(branches):
    """Along a branch the counts change as often as grazings stand there, as their notes say."""
    for branch in branches:
        counts = np.column_stack([branch.contact_losses, branch.back_impacts])
        changed = np.any(np.diff(counts, axis=0) != 0, axis=1).sum()
        assert len(branch.of_kind(GRAZING)) >= changed


@pytest.mark.parametrize("share", [0.0, 0.02, -0.02])
def test_a_carried_event_is_the_one_that_is_walked_to(branches, share):
    worst = 0.0
    for branch, model, start in zip(
        branches, (FORCED, DOUBLING), ((1.1, 0.0), (1.08, -0.25)), strict=True
    ):
        other = model.replace(damping_ratio=model.damping_ratio * (1.0 + share))
        family, _ = family_of(other, "frequency")
        walked = continuation(
            periodic_orbit(other, 1, start), "frequency", float(branch.values[-1])
        )
        kinds = {FOLD, FLIP}
        mine = [e for e in branch.bifurcations if e.kind in kinds]
        theirs = [e for e in walked.bifurcations if e.kind in kinds]
        assert [e.kind for e in mine] == [e.kind for e in theirs]
        assert mine
        for here, there in zip(mine, theirs, strict=True):
            found = carried(here, family)
            worst = max(worst, abs(found.value - there.value))
            assert found.kind == there.kind
            assert found.note == there.note
            assert found.state == pytest.approx(there.state, abs=1e-7)
    assert worst < 1e-10


def test_a_pitchfork_is_carried_as_one():
    """An equation without mean: its symmetric orbit loses the symmetry at a pitchfork."""
    model = TorsionalModel(
        damping_ratio=0.0865,
        frequency=0.85,
        stiffness_amplitude=0.0,
        mean_force=0.0,
        force_amplitude=0.69,
    )
    other = model.replace(force_amplitude=0.7)
    found = []
    for one in (model, other):
        orbit = label(one, initial_state=(3.0, 0.0)).orbit
        found.append(continuation(orbit, "frequency", 0.36).of_kind(PITCHFORK)[0])
    family, _ = family_of(other, "frequency")
    fork = carried(found[0], family)
    assert fork.kind == PITCHFORK
    assert fork.note == found[1].note
    assert fork.value == pytest.approx(found[1].value, abs=1e-10)


def test_what_cannot_be_carried_is_refused(branches):
    grazing = branches[0].of_kind(GRAZING)[0]
    with pytest.raises(InputError, match="bifurcation"):
        carried(grazing, branches[0].family)
    fold = branches[0].of_kind(FOLD)[0]
    far, _ = family_of(FORCED.replace(force_amplitude=1e-3), "frequency")
    with pytest.raises(ConvergenceError, match="follow the branch"):
        carried(fold, far)
