"""Labels of the published parameter rows, and what must never be mistaken."""

import numpy as np
import pytest

from thermogear.analysis.continuation import continuation
from thermogear.analysis.labels import counts, label, labels
from thermogear.base.errors import InputError
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.models import TorsionalModel

BASE = TorsionalModel(0.1535, 1.245, 0.335, 0.017, -1.16)
ROW = ["period-1", "period-2", "period-4", "chaotic"]


def heated(celsius):
    rise = (np.asarray(celsius, dtype=float) - 20.0) / 140.0
    return TorsionalModel(0.1535, 1.300551, 0.335, 0.0136, -0.928, 1 - 0.2 * rise, 0.02 * rise)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("damping_ratio", [0.18, 0.168, 0.114, 0.10]),
        ("frequency", [1.3, 1.28, 1.13, 1.1]),
        ("stiffness_amplitude", [0.1, 0.3, 0.53, 0.9]),
    ],
)
def test_rows_of_table_4_2(name, values):
    found = labels(BASE.replace(**{name: values}))
    assert [str(one) for one in found] == ROW
    assert found[3].lyapunov.value > 4 * found[3].lyapunov.error
    for one in found[:3]:
        assert abs(one.multipliers[0]) < 1.0


def test_heat_of_section_4_1_brings_in_the_half_frequency():
    found = labels(heated([20, 100, 140, 160]))
    assert [str(one) for one in found] == ["period-1", "period-1", "period-2", "period-2"]
    assert found[1].multipliers[0].real == pytest.approx(-0.9958567045590561, abs=1e-7)


def test_half_order_amplitudes_of_section_4_1(compared):
    data = simulate(heated([20, 125, 140]), discard=20_000, periods=32)
    lines = 2 * np.abs(np.fft.rfft(data.x.values, axis=1)) / data.sizes["sample"]
    compared(
        "half-order amplitude at 20, 125 and 140 °C",
        "0, 0.0044, 0.0088, computed apart",
        lines[:, 16] - [0.0, 0.0044, 0.0088],
        5e-5,
    )


def test_a_long_transient_does_not_fool_the_label():
    """121 damping ratios where 50 discarded periods mislabel 49 points."""
    model = TorsionalModel(np.linspace(0.02, 0.14, 121), 1.268, 0.6, 0.056, 0.314, 1.0, 0.03)
    first = labels(model)
    longer = labels(model, discard=4000)
    clear = [
        (a, b) for a, b in zip(first, longer, strict=True) if "undecided" not in (a.name, b.name)
    ]
    assert len(clear) >= 119
    assert all(str(a) == str(b) for a, b in clear)
    assert set(counts(first)) <= {
        "period-2", "period-4", "period-6", "period-8", "period-16", "chaotic", "undecided"
    }  # fmt: skip


def test_a_spiral_is_not_taken_for_a_longer_period():
    """Complex multipliers near a third of a turn return close after three periods."""
    model = TorsionalModel(0.01, 0.7, 0.1, 0.1, 0.05)
    assert str(label(model, initial_state=(1.1, 0.0))) == "period-1"


def test_at_the_border_itself_nothing_is_decided():
    flip = BASE.replace(damping_ratio=0.17004302692235368)
    assert label(flip).name == "undecided"


def test_a_diverging_motion_is_named_so():
    assert (
        label(TorsionalModel(0.0, 2.0, 0.9, 0.1, 0.05), initial_state=(1.5, 0.3)).name == "diverged"
    )


def test_one_label_wants_one_lane():
    with pytest.raises(InputError, match="one lane"):
        label(BASE.replace(frequency=[1.0, 1.1]))


def test_no_label_where_rounding_chooses_the_attractor():
    """A long chaotic transient ends on one of two orbits; the arithmetic decides which."""
    rng = np.random.default_rng(42)
    fields = [rng.uniform(*span, 500) for span in ((0.02, 0.2), (0.3, 2.2), (0, 0.9), (0.01, 0.3))]
    force, heat = rng.uniform(-1.2, 1.2, 500), rng.uniform(-0.03, 0.03, 500)
    zeta, w, eps, mean = (float(field[394]) for field in fields)
    model = TorsionalModel(zeta, w, eps, mean, float(force[394]), 1.0, float(heat[394]))
    found = label(model)
    assert str(found) in ("undecided", "period-2", "period-6")
    if str(found) != "undecided":
        assert found.orbit.stable


@pytest.mark.slow
def test_five_hundred_random_points_keep_their_labels():
    """Doubling transient or sub-steps changes no label; under 2 % stay undecided."""
    rng = np.random.default_rng(7)
    count = 500
    model = TorsionalModel(
        rng.uniform(0.02, 0.2, count),
        rng.uniform(0.3, 2.2, count),
        rng.uniform(0, 0.9, count),
        rng.uniform(0.01, 0.3, count),
        rng.uniform(-1.2, 1.2, count),
        1.0,
        rng.uniform(-0.03, 0.03, count),
    )
    first = labels(model)
    longer = labels(model, discard=1000, cap=64_000)
    for one, other in zip(first, longer, strict=True):
        assert str(one) == str(other) or "undecided" in (str(one), str(other))
    assert counts(first).get("undecided", 0) < 10
    assert not any("quasi" in str(one) for one in first)


def test_the_orbit_of_a_label_can_be_continued():
    model = TorsionalModel(0.18, 1.245, 0.335, 0.017, -1.16)
    orbit = label(model).orbit
    assert orbit is not None
    assert orbit.model is model
    branch = continuation(orbit, "damping_ratio", 0.16)
    (flip,) = branch.of_kind("period doubling")
    assert flip.value == pytest.approx(0.170043027, abs=1e-9)
