"""Shares of basins along a parameter: a map whose borders have a closed form, exact intervals."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import binom, binomtest

from conftest import Compared
from thermogear.analysis.basin_shares import (
    BISECTIONS,
    RAY_STEPS,
    SharePlan,
    basin_shares,
    interval,
    matched,
    share_plan,
)
from thermogear.analysis.family import Models
from thermogear.base.errors import InputError
from thermogear.base.plan import gather
from thermogear.base.vocabulary import STATUS
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import IteratedMap

SEED = 71
"""Of the starts; fixed before the first comparison."""
SHIFTS = (-0.4, 0.0, 0.4)


@dataclass(frozen=True)
class Cubic(IteratedMap):
    """u = x - v/2 - s goes to u (3 - u^2)/2, v to 0.3 v.

    u = 1 and -1 draw, with the multiplier 0; u from 0 to sqrt(3) ends on 1, and from there to
    sqrt(5) on -1, before it runs off.
    """

    shift: float = 0.0
    unit = np.ones(2)

    def iterate(self, state: Any) -> Any:
        u, v = state[0] - 0.5 * state[1] - self.shift, 0.3 * state[1]
        slope = 1.5 - 1.5 * u * u
        jacobian = np.array([[slope, 0.15 - 0.5 * slope], [0.0, 0.3]])
        return np.array([u * (1.5 - 0.5 * u * u) + self.shift + 0.5 * v, v]), jacobian


@pytest.fixture(scope="module")
def shares() -> Any:
    return basin_shares(Cubic(), "shift", SHIFTS, x=(-1, 1), v=(-1, 1), starts=150, seed=SEED)


def test_every_start_ends_where_the_closed_form_says(shares: Any, compared: Compared) -> None:
    starts = np.random.default_rng(SEED).uniform([-1, -1], [1, 1], (150, 2))
    u = starts[:, 0] - 0.5 * starts[:, 1] - np.array(SHIFTS)[:, None]
    far = np.abs(u) > np.sqrt(3.0)
    right = ((u > 0.0) != far).sum(axis=1)
    place = shares["motion_section"][:, :, 0, 0].values - np.array(SHIFTS)[:, None]
    # one number a motion, whatever its share: sections u = 1 and u = -1 move by the shift
    assert np.allclose(np.abs(place), 1.0)
    assert place[:, 0] == pytest.approx(place[0, 0])
    assert place[0, 0] == pytest.approx(-place[0, 1])
    counts = shares["motion_count"].values[:, int(place[0, 1] > 0.0)]
    compared("starts that end on a motion", "closed form", counts - right, 0, "starts")
    assert (shares["motion_count"].sum("motion") == 150).all()
    assert not shares["undecided"].any()
    assert not shares["diverged"].any()


def test_the_least_push_is_the_distance_of_the_border(shares: Any, compared: Compared) -> None:
    """Out of u = 1: to sqrt(3) along x, twice as far along v; an upper bound to the bisection."""
    least, step = np.sqrt(3.0) - 1.0, 2.0 / RAY_STEPS / 2.0**BISECTIONS
    for name, known in (("least_x", least), ("least_v", 2.0 * least)):
        away = shares[name].values - known
        assert (away >= -1e-12).all()
        compared("least disturbance", "closed form", away, step)
    assert shares["least_displacement"].isnull().all()


def test_intervals_hold_as_often_as_they_say(compared: Compared) -> None:
    """Exact coverage at every true share, and the bounds of another package."""
    n = 60
    low, high = interval(np.arange(n + 1), of=n)
    for share in np.linspace(0.003, 0.997, 41):
        inside = (low <= share) & (share <= high)
        assert binom.pmf(np.arange(n + 1)[inside], n, share).sum() >= 0.95
    other = [binomtest(k, n).proportion_ci(0.95, method="exact") for k in range(n + 1)]
    away = [np.subtract(low, [o.low for o in other]), np.subtract(high, [o.high for o in other])]
    compared("interval of a share", "scipy's binomtest", away, 1e-12)


def test_motions_keep_their_number_in_any_order() -> None:
    one, two, far = (np.array([[x, 0.0]]) for x in (0.0, 0.4, 5.0))
    assert matched([one, two], last=[]).tolist() == [0, 1]
    assert matched([two + 0.02, one + 0.02], last=[one, two]).tolist() == [1, 0]
    assert matched([far, one], last=[one]).tolist() == [1, 0]
    # a doubled orbit is the motion it was born from
    assert matched([np.array([[0.1, 0.0], [-0.1, 0.0]])], last=[one]).tolist() == [0]
    assert matched([], last=[one]).tolist() == []


def test_threads_change_no_bit() -> None:
    model = TorsionalModel(
        damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1, mean_force=0.1,
        force_amplitude=0.05,
    )  # fmt: skip
    plan = share_plan(model, "frequency", [0.6, 0.7], x=(-2, 2), v=(-2, 2), starts=80, seed=SEED)
    assert gather(plan, threads=3).identical(gather(plan, threads=1))
    assert plan.pilot(0.1, turn=1) == 0.5


@dataclass(frozen=True)
class Jamming:
    """A family whose first value has no motion."""

    names: tuple[str, ...] = ("shift",)
    units: tuple[str, ...] = ("1",)

    def inputs(self) -> dict[str, Any]:
        return {}

    def __call__(self, points: Any) -> Models:
        jam = np.int8(STATUS.index("jammed"))
        made = tuple(None if at < 0.0 else Cubic(float(at)) for at in points[:, 0])
        return Models(made, np.where(points[:, 0] < 0.0, jam, np.int8(0)))


def test_a_value_without_motion_is_a_status() -> None:
    found = basin_shares(Jamming(), "shift", (-1.0, 0.0), x=(-1, 1), v=(-1, 1), starts=20)
    assert found["status"].values.tolist() == [STATUS.index("jammed"), 0]
    assert np.isnan(found["motion_share"][0]).all()
    assert found["motion_share"][1].sum() == 1.0


def test_what_runs_off_has_diverged() -> None:
    found = basin_shares(Cubic(), "shift", [0.0], x=(2.3, 3.0), v=(-0.01, 0.01), starts=20)
    assert found["diverged"].values.tolist() == [20]
    assert found.sizes["motion"] == 0


def test_wrong_boxes_and_names_are_refused() -> None:
    for wrong in ({"x": (1, -1)}, {"v": (0, np.inf)}, {"starts": 0}):
        with pytest.raises(InputError) as told:
            share_plan(Cubic(), "shift", [0.0], **{"x": (-1, 1), "v": (-1, 1)} | wrong)
        assert told.value.field in wrong
    plan = share_plan(Cubic(), "shift", [0.0], x=(-1, 1), v=(-1, 1))
    assert isinstance(plan, SharePlan)
    assert replace(plan, seed=1).inputs() != plan.inputs()
