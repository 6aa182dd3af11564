"""Two-parameter maps: early exit and refinement against the full run."""

import numpy as np
import pytest

from thermogear.analysis.family import family_for
from thermogear.analysis.maps import MAP_RULE, MapPlan, _refined, parameter_map
from thermogear.base.errors import InputError
from thermogear.base.vocabulary import ASSUMED
from thermogear.dynamics.models import TorsionalModel

MODEL = TorsionalModel(
    damping_ratio=0.05, frequency=1.0, stiffness_amplitude=0.3, mean_force=0.1, force_amplitude=0.3
)


def axes(count):
    return {
        "frequency": np.linspace(0.4, 2.2, count),
        "stiffness_amplitude": np.linspace(0.05, 0.9, count),
    }


def changed(one, other):
    differs = (one.label.values != other.label.values) | (one.period.values != other.period.values)
    return float(differs.mean())


def test_result_does_not_depend_on_threads():
    one = parameter_map(MODEL, axes(24), tile=8, threads=1, refine=True)
    two = parameter_map(MODEL, axes(24), tile=8, threads=3, refine=True)
    assert one.identical(two)


def test_every_point_computed_is_the_same_with_and_without_refinement():
    coarse = parameter_map(MODEL, axes(24), tile=24, refine=True)
    full = parameter_map(MODEL, axes(24), refine=False)
    inside = coarse.status.values != ASSUMED
    assert 0.2 < inside.mean() < 1.0
    for name in ("label", "period", "multiplier_real", "lyapunov"):
        assert np.array_equal(
            coarse[name].values[inside], full[name].values[inside], equal_nan=True
        )
    # a point that its equal neighbours spoke for has a label, and no number at all
    for name in set(coarse.data_vars) - {"label", "period", "status"}:
        assert np.all(np.isnan(coarse[name].values[~inside])), name
        assert full[name].dtype == float
    assert np.all(coarse.label.values[~inside] > 0)
    assert not np.any(full.status.values == ASSUMED)
    assert coarse.attrs["computed_points"] == inside.sum()
    assert coarse.attrs["total_periods"] == coarse.used_periods.values[inside].sum()
    assert coarse.attrs["full_periods"] == 24 * 24 * MAP_RULE.cap


@pytest.mark.slow
def test_four_times_fewer_periods_and_few_labels_changed(at_length):
    count = at_length(40, 128, "points of each axis of a map")
    full = parameter_map(MODEL, axes(count), rule=MAP_RULE.full(), refine=False)
    fast = parameter_map(MODEL, axes(count), refine=True)
    assert fast.attrs["full_periods"] >= 4 * fast.attrs["total_periods"]
    assert changed(full, fast) <= 0.003


def test_scaling_leaves_the_map_alone():
    """(b, F_m, F_h) times two doubles x and changes no label, multiplier or exponent bit."""
    one = parameter_map(MODEL, axes(12), refine=False)
    other = parameter_map(
        MODEL.replace(half_backlash=2.0, mean_force=0.2, force_amplitude=0.6),
        axes(12),
        refine=False,
    )
    assert np.array_equal(one.label, other.label)
    assert np.array_equal(one.multiplier_real, other.multiplier_real, equal_nan=True)
    assert np.array_equal(2.0 * one.point_x, other.point_x, equal_nan=True)


def test_refusals_name_the_parameter():
    with pytest.raises(InputError, match=r"parameter: got 'frequncy'; did you mean 'frequency'\?"):
        parameter_map(MODEL, {"frequncy": [1.0, 2.0], "mean_force": [0.1, 0.2]})
    with pytest.raises(InputError, match=r"axes: got \['frequency'\]; allowed two parameters"):
        parameter_map(MODEL, {"frequency": [1.0, 2.0]})


def brute_refined(label, period, computed, stride):
    """Cell by cell: wanted where a cell or one of its neighbours differs; else its label."""
    rows, columns = (sorted({*range(0, n, stride), n - 1}) for n in label.shape)
    cells = [(a, b) for a in range(len(rows) - 1) for b in range(len(columns) - 1)]

    def differs(a, b):
        corners = [(rows[a + i], columns[b + j]) for i in (0, 1) for j in (0, 1)]
        codes = {(label[c], period[c]) for c in corners}
        return len(codes) > 1 or label[corners[0]] == 0

    def box(a, b):
        return slice(rows[a], rows[a + 1] + 1), slice(columns[b], columns[b + 1] + 1)

    wanted = np.zeros(label.shape, bool)
    near = {
        (a, b): any(
            differs(a + i, b + j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (a + i, b + j) in cells
        )
        for a, b in cells
    }
    for cell in cells:
        if near[cell]:
            wanted[box(*cell)] = True
    spoken, spoken_period = label.copy(), period.copy()
    for cell in cells:
        if not near[cell]:
            fresh = (computed[box(*cell)] == 0) & ~wanted[box(*cell)]
            corner = rows[cell[0]], columns[cell[1]]
            spoken[box(*cell)][fresh] = label[corner]
            spoken_period[box(*cell)][fresh] = period[corner]
    return wanted, spoken, spoken_period


@pytest.mark.parametrize("stride", [2, 4])
@pytest.mark.parametrize("shape", [(9, 9), (22, 19), (3, 14)])
def test_only_cells_that_differ_from_a_neighbour_are_gone_into(shape, stride):
    rng = np.random.default_rng(shape[0] + stride)
    for odd in (0.0, 0.02, 0.2):
        label = np.where(rng.random(shape) < odd, rng.integers(0, 5, shape), 1).astype(np.int8)
        period = np.where(rng.random(shape) < odd, 2, 1).astype(np.int32)
        computed = np.zeros(shape, np.int8)
        lattice = np.ix_(*(sorted({*range(0, n, stride), n - 1}) for n in shape))
        computed[lattice] = 1
        found = {
            "label": label.copy(),
            "period": period.copy(),
        }
        wanted, spoken, spoken_period = brute_refined(label, period, computed, stride)
        assert np.array_equal(_refined(found, computed == 1, stride), wanted)
        assert np.array_equal(found["label"], spoken)
        assert np.array_equal(found["period"], spoken_period)


def test_strides_and_tiles_that_make_no_lattice_are_refused():
    for stride in (0, 3, 6, -4):
        with pytest.raises(InputError, match="stride: got"):
            parameter_map(MODEL, axes(3), stride=stride)
    with pytest.raises(InputError, match="tile: got 1; allowed >= 2"):
        parameter_map(MODEL, axes(3), tile=1)
    assert MapPlan(
        family=family_for(MODEL, tuple(axes(2))), axes=((1.0,), (0.1, 0.2)), tile=2, stride=1
    )
