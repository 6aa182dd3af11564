"""Two-parameter maps: early exit and refinement against the full run."""

import numpy as np
import pytest

from thermogear.analysis.maps import MAP_RULE, parameter_map
from thermogear.base.errors import InputError
from thermogear.dynamics.models import TorsionalModel

MODEL = TorsionalModel(0.05, 1.0, 0.3, 0.1, 0.3)


def axes(count):
    return {
        "frequency": np.linspace(0.4, 2.2, count),
        "stiffness_amplitude": np.linspace(0.05, 0.9, count),
    }


def changed(one, other):
    differs = (one.label.values != other.label.values) | (one.period.values != other.period.values)
    return float(differs.mean())


def test_result_does_not_depend_on_threads():
    one = parameter_map(MODEL, axes(24), tile=8, threads=1)
    two = parameter_map(MODEL, axes(24), tile=8, threads=3)
    assert one.identical(two)


def test_every_point_computed_is_the_same_with_and_without_refinement():
    coarse = parameter_map(MODEL, axes(24), tile=24)
    full = parameter_map(MODEL, axes(24), refine=False)
    inside = coarse.computed.values == 1
    assert 0.2 < inside.mean() < 1.0
    for name in ("label", "period", "multiplier_real", "lyapunov"):
        assert np.array_equal(
            coarse[name].values[inside], full[name].values[inside], equal_nan=True
        )


@pytest.mark.slow
def test_four_times_fewer_periods_and_few_labels_changed():
    full = parameter_map(MODEL, axes(128), rule=MAP_RULE.full(), refine=False)
    fast = parameter_map(MODEL, axes(128))
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
