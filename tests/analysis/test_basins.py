"""Basins: published counts to the last start, entropies in closed form, matching."""

import numpy as np
import pytest

from thermogear.analysis.basins import basin_entropy, basins, basins_along
from thermogear.dynamics.models import TorsionalModel

# attractor (period, point on it) -> starts of the grid that end there
TWO = {(1, 0.6479430038359856, 0.1515298562326813): 8090,
       (1, 1.1775558499577545, 0.0073759870378711): 2111}  # fmt: skip
SEVEN = {
    (1, 1.1891341213667848, -0.015769872606784224): 188,
    (2, 1.3938511831289992, -0.1595454918219694): 754,
    (6, 0.24000691048296938, 0.4938098446293777): 42,
    (3, -0.46330319138998327, -0.13185735603201762): 476,
    (2, -0.5558583520761098, 1.375219409916116): 752,
    (6, 0.8884625719648779, 0.04020210704681767): 158,
    (3, 1.2450510440239528, -0.08588016974955277): 231,
}
MODEL_TWO = TorsionalModel(0.05, 0.7, 0.1, 0.1, 0.05)
MODEL_SEVEN = TorsionalModel(0.03, 1.3, 0.3, 0.1, -0.05)


@pytest.mark.parametrize(
    ("model", "count", "truth"),
    [(MODEL_TWO, 101, TWO), (MODEL_SEVEN, 51, SEVEN)],
    ids=["two", "seven"],
)
def test_published_counts(model, count, truth, compared):
    axis = np.linspace(-2.0, 2.0, count)
    data = basins(model, axis, axis)
    assert data.sizes["attractor_number"] == len(truth)
    for (period, x, v), starts in truth.items():
        away = np.hypot(data.attractor_x - x, data.attractor_v - v).min("attractor_point")
        (number,) = np.flatnonzero(away.values < 1e-9)
        assert data.attractor_period.values[number] == period
        compared(
            "starts in each basin",
            "counts computed apart",
            data["count"].values[number] - starts,
            0,
            "starts",
        )
    assert data.attrs["unassigned"] == 0.0
    assert data.fraction.values.sum() == pytest.approx(1.0, abs=1e-15)


def test_threads_change_no_bit():
    axis = np.linspace(-2.0, 2.0, 31)
    assert basins(MODEL_SEVEN, axis, axis, threads=1).identical(
        basins(MODEL_SEVEN, axis, axis, threads=3)
    )


def test_mirrored_forces_mirror_the_basins():
    axis = np.linspace(-2.0, 2.0, 21)
    one = basins(MODEL_TWO, axis, axis)
    other = basins(MODEL_TWO.replace(mean_force=-0.1, force_amplitude=-0.05), axis, axis)
    assert np.array_equal(one.attractor.values, other.attractor.values[::-1, ::-1])


def test_starts_that_the_survey_misses_find_their_attractor():
    axis = np.linspace(-2.0, 2.0, 51)
    whole = basins(MODEL_SEVEN, axis, axis)
    late = basins(MODEL_SEVEN, axis, axis, survey=2)
    assert np.array_equal(np.sort(whole["count"].values), np.sort(late["count"].values))


def test_entropy_in_closed_form():
    """A border through the middle of every box gives ln 2; one colour gives 0."""
    stripes = np.tile([0, 0, 1, 1], (8, 2))
    mixed, mean, share = basin_entropy(stripes, box=4)
    assert (mixed, mean, share) == pytest.approx((np.log(2.0), np.log(2.0), 1.0))
    assert basin_entropy(np.zeros((8, 8), int), box=4) == (0.0, 0.0, 0.0)


def test_attractors_keep_their_number_over_a_parameter():
    """The small orbit dies at the fold w = 0.79174; the large one keeps its number."""
    axis = np.linspace(-2.0, 2.0, 21)
    data = basins_along(MODEL_TWO, "frequency", [0.70, 0.74, 0.78, 0.80], axis, axis, survey=8)
    assert data.sizes["attractor_number"] == 2
    small = 1
    assert np.all(data.fraction.values[:3, small] > 0.0)
    assert data.fraction.values[3, small] == 0.0
    assert data.fraction.values[3, 0] == 1.0
