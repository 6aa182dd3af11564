"""Folds, flips and grazings by their own conditions."""

import numpy as np
import pytest

from thermogear.analysis.bifurcations import FLIP, FOLD, GRAZING
from thermogear.analysis.continuation import continuation
from thermogear.analysis.orbits import periodic_orbit
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
