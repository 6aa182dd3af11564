"""Motions side by side along a parameter, against diagrams run up and down and against theory."""

import numpy as np

from thermogear.analysis.diagram import orbit_diagram
from thermogear.analysis.family import ModelFamily
from thermogear.analysis.section import lanes_of
from thermogear.analysis.settle import PERIODIC
from thermogear.analysis.side_by_side import motions_along
from thermogear.dynamics.models import TorsionalModel

BISTABLE = TorsionalModel(
    damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1, mean_force=0.1, force_amplitude=0.05
)
STARTS = [(1.1, 0.0), (1.3, 0.0), (-1.0, 0.0)]


def lanes(model, values):
    return lanes_of(ModelFamily(model, ("frequency",))(values[:, None]))


def test_two_motions_live_where_a_diagram_up_and_down_finds_two():
    """The hysteresis of a softening resonance, its fold at 0.7917 known to nine digits."""
    values = np.linspace(0.70, 0.82, 25)
    found = motions_along(lanes(BISTABLE, values), STARTS)
    diagram = orbit_diagram(BISTABLE, "frequency", values, starts=[(1.18, 0.007)], branch_period=0)
    up, down = diagram.section_x.values[0, 0, :, -1], diagram.section_x.values[1, 0, :, -1]
    apart = np.abs(up - down) > 0.05
    count = found.count(values.size)
    assert np.all(count[apart] >= 2)
    assert np.all(count[values > 0.7917368893619342] == 1)
    assert apart.any()
    assert not apart.all()


def test_lasting_contact_has_one_motion_everywhere():
    """A force that never lets the flanks part makes the equation linear: one motion, period 1."""
    model = BISTABLE.replace(mean_force=1.0, stiffness_amplitude=0.0)
    values = np.linspace(0.3, 1.7, 12)
    found = motions_along(lanes(model, values), [(2.0, 0.0), (2.3, 0.0)])
    assert np.all(found.count(values.size) == 1)
    assert np.all(found.label == PERIODIC)
    assert np.all(found.period == 1)


def test_what_one_start_misses_a_neighbour_hands_on():
    """Without the far throw the same motions are found."""
    values = np.linspace(0.74, 0.79, 11)
    whole = motions_along(lanes(BISTABLE, values), STARTS)
    low = motions_along(lanes(BISTABLE, values), [(1.1, 0.0), (-1.0, 0.0)])
    assert np.array_equal(whole.count(values.size), low.count(values.size))
