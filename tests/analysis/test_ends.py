"""Ends of ranges and grids: branches that begin there, surveys that include them."""

import numpy as np
import pytest

from thermogear.analysis.basins import _spread, basin_plan
from thermogear.analysis.diagram import DIAGRAM_RULE, diagram_plan, orbit_diagram
from thermogear.analysis.family import ModelFamily
from thermogear.analysis.maps import map_plan, parameter_map
from thermogear.base.plan import bytes_of, empty_arrays
from thermogear.dynamics.models import TorsionalModel

BISTABLE = TorsionalModel(
    damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1, mean_force=0.1, force_amplitude=0.05
)


@pytest.mark.parametrize("values", [[0.60, 0.62], [0.62, 0.60], [0.60, 0.61, 0.62]])
def test_a_branch_reaches_both_ends_wherever_it_was_found(values):
    """Of two values the later one is the seed: one arm is all there is."""
    data = orbit_diagram(BISTABLE, "frequency", values, branch_period=1)
    assert data.sizes["branch"] >= 1
    for line in data.branch_value.values:
        known = line[np.isfinite(line)]
        assert known.min() == pytest.approx(0.60, abs=1e-12)
        assert known.max() == pytest.approx(0.62, abs=1e-12)
        # every value once, in order
        assert np.all(np.diff(known) > 0.0) or np.all(np.diff(known) < 0.0)


@pytest.mark.parametrize("side", [2, 3, 5, 40])
def test_a_survey_of_a_grid_stands_on_its_corners(side):
    x, v = [0.0, 0.25, 0.5, 1.0, 2.0, 3.0, 7.0], [-1.0, 0.0, 4.0]
    starts = _spread(x, v, side)
    assert len(starts) == min(side, 7) * min(side, 3)
    assert len(np.unique(starts, axis=0)) == len(starts)
    for corner in ((0.0, -1.0), (0.0, 4.0), (7.0, -1.0), (7.0, 4.0)):
        assert corner in {(float(a), float(b)) for a, b in starts}


@pytest.mark.slow
def test_a_point_without_an_orbit_has_no_numbers_of_one():
    """Table 4.2: period 1 at zeta = 0.18, chaos at 0.10; unknown counts are -1, not 0 or 1."""
    model = TorsionalModel(
        damping_ratio=0.1535,
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    told: list[tuple[int, int]] = []
    data = parameter_map(
        model,
        {"damping_ratio": [0.10, 0.18], "mean_force": [0.017, 0.0171]},
        refine=False,
        progress=lambda done, total: told.append((done, total)),
    )
    chaos, orbit = data.isel(damping_ratio=0), data.isel(damping_ratio=1)
    assert np.all(chaos["period"] == 0)
    assert np.all(orbit["period"] == 1)
    # chaos has no orbit whose numbers could be told; how long it is in contact it has
    for name in ("contact_losses", "back_impacts", "multiplier_real", "point_x"):
        assert np.all(np.isnan(chaos[name]))
        assert np.all(np.isfinite(orbit[name]))
    for name in ("drive_share", "back_share"):
        assert np.all((data[name] >= 0.0) & (data[name] <= 1.0))
    assert np.all(chaos["lyapunov"] > 0.0)
    assert np.all(orbit["lyapunov"] < 0.0)
    # progress ends at the whole
    assert told[-1][0] == told[-1][1]
    assert len({total for _, total in told}) == 1


def test_the_announced_size_is_that_of_the_arrays():
    axis = np.linspace(-1.0, 1.0, 7)
    plan = basin_plan(BISTABLE, x=axis, v=axis[:3])
    assert bytes_of(plan) == sum(values.nbytes for values in empty_arrays(plan).values())


class Asked:
    """A family that notes the parameter points it is asked for."""

    def __init__(self, *names):
        self.family = ModelFamily(BISTABLE, names)
        self.names, self.units, self.points = names, self.family.units, []

    def inputs(self):
        return self.family.inputs()

    def __call__(self, points):
        self.points += [tuple(row) for row in points.tolist()]
        return self.family(points)


@pytest.mark.parametrize(
    ("share", "sides"), [(0.0, (1, 1)), (0.3, (3, 2)), (0.6, (4, 2)), (1.0, (5, 3))]
)
def test_a_pilot_of_a_map_does_the_share_that_it_tells(share, sides):
    family = Asked("frequency", "mean_force")
    axes = {"frequency": [0.5, 0.52, 0.54, 0.56, 0.6], "mean_force": [0.3, 0.35, 0.5]}
    plan = map_plan(family, axes, refine=False)
    assert plan.pilot(share, turn=0) * 15 == sides[0] * sides[1] == len(family.points)
    for place, (side, values) in enumerate(zip(sides, axes.values(), strict=True)):
        seen = {point[place] for point in family.points}
        assert len(seen) == side
        assert seen <= set(values)
    assert len(set(family.points)) == len(family.points)
    # each turn takes other points, until all are seen
    for turn in range(1, 40):
        plan.pilot(share, turn=turn)
    assert len(set(family.points)) == 15


def test_a_pilot_of_a_diagram_does_the_share_that_it_tells():
    values = [0.5, 0.52, 0.54, 0.58, 0.6]
    for share, count in ((0.0, 1), (0.1, 1), (0.3, 3), (0.4, 4)):
        family = Asked("frequency")
        plan = diagram_plan(family, "frequency", values, branch_period=0)
        assert plan.pilot(share, turn=0) == count / 10
        seen = [value for (value,) in family.points]
        assert len(set(seen)) == len(seen) == count
        # neighbours, as the diagram itself goes from value to value
        first = values.index(min(seen))
        assert sorted(seen) == values[first : first + count]
    assert plan.rule == DIAGRAM_RULE


def test_a_pilot_of_basins_does_one_share_of_survey_and_grid():
    plan = basin_plan(BISTABLE, x=np.linspace(-1.0, 1.0, 5), v=[0.0, 0.5, 1.0], survey=2)
    shares = [plan.pilot(share, turn=0) for share in (0.0, 0.25, 0.5, 1.0)]
    assert shares == [0.25, 0.25, 0.5, 1.0]
    # a coarse look first has the attractors of the whole
    assert plan.thinned(2)[0].attractors is plan.attractors
