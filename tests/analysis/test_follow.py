"""A motion that is followed: onto its mother, through a cascade into chaos, off a fold."""

import numpy as np
import pytest

from thermogear.analysis.bifurcations import FLIP
from thermogear.analysis.continuation import continuation, family_of
from thermogear.analysis.follow import LONGEST_PERIOD, follow
from thermogear.analysis.labels import label
from thermogear.analysis.orbits import periodic_orbit
from thermogear.dynamics.models import TorsionalModel

MODEL = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.3,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)


@pytest.fixture(scope="module")
def flip():
    """Where the orbit of one period doubles on the way down."""
    orbit = periodic_orbit(MODEL, 1, (1.08, -0.25))
    branch = continuation(orbit, "frequency", 1.1, stop_at=FLIP)
    return branch.of_kind(FLIP)[0].value


def settle(value, state):
    found = label(MODEL.replace(frequency=value), initial_state=state, cap=4000)
    return (found.orbit.state if found.orbit else np.asarray(state)), found.period


def followed(start, to, state, period):
    family, _ = family_of(MODEL, "frequency")
    return follow(
        family, "frequency", start=start, to=to, state=state, period=period, settle=settle
    )


@pytest.mark.parametrize("away", [0.002, 0.02])
def test_a_doubled_orbit_is_followed_back_onto_its_mother(flip, away):
    """It was carried on as an orbit of two periods, whose doublings then looked like folds."""
    start = flip - 0.006
    two = label(MODEL.replace(frequency=start), initial_state=(1.0, -0.2)).orbit
    assert two.period == 2
    there = followed(start, flip + away, two.state, 2)
    assert (there.value, there.period, there.leaps) == (flip + away, 1, ())
    mother = periodic_orbit(MODEL.replace(frequency=flip + away), 1, there.state)
    assert there.state == pytest.approx(mother.state, abs=1e-9)


def test_a_cascade_is_followed_into_chaos_without_a_jump(flip):
    orbit = periodic_orbit(MODEL, 1, (1.08, -0.25))
    there = followed(1.3, 1.1, orbit.state, 1)
    assert there.period == 0
    assert there.leaps == ()
    # beyond it lie orbits of more periods than are followed, and chaos
    assert 1.1 < there.value < flip
    beyond = label(MODEL.replace(frequency=there.value - 1e-4), initial_state=there.state)
    assert beyond.period == 0 or beyond.period > LONGEST_PERIOD


def test_a_run_behind_a_jump_may_be_asked_for_its_first_jump_back():
    """Over a fold and back: the first jump of the way back is the other fold."""
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness_amplitude=0.1,
        mean_force=0.1,
        force_amplitude=0.05,
    )
    family, _ = family_of(model, "frequency")

    def quick(value, state):
        found = label(model.replace(frequency=value), initial_state=state, cap=4000)
        return (found.orbit.state if found.orbit else np.asarray(state)), found.period

    def way(start, to, state):
        return follow(
            family, "frequency", start=start, to=to, state=state, period=1, settle=quick,
            most_leaps=1,
        )  # fmt: skip

    calm = label(model.replace(frequency=0.75), initial_state=(1.18, 0.007)).orbit
    up = way(0.75, 0.85, calm.state)
    (there,) = up.leaps
    assert (up.value, up.period) == (there.landed, there.found_period)
    assert there.value == pytest.approx(0.7917368893619342, abs=1e-9)
    back = way(there.landed, 0.4, there.found)
    (home,) = back.leaps
    assert home.value < there.value
