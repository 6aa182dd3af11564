"""The same motion in other units of length, and chaos among the attractors.

x'' + 2 zeta x' + k(t) f(x; b) = F(t) keeps its form under x -> L x, b -> L b, F -> L F. With L a
power of two no rounding changes either, so every study must say the same to the last bit.
"""

import numpy as np
import pytest

from thermogear.analysis.basins import basins
from thermogear.analysis.continuation import continuation
from thermogear.analysis.diagram import orbit_diagram
from thermogear.analysis.labels import label
from thermogear.analysis.lyapunov import lyapunov_exponent
from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.excitation import Periodic
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel

SCALES = [2.0**-13, 2.0**9]


def rattling(scale=1.0, damping=0.1):
    """The base set of table 4.2: period 1 at 0.18, 2 at 0.168, chaotic at 0.10."""
    force = Periodic(0.017 * scale, (-1.16 * scale,))
    return DeadZoneModel(
        damping_ratio=damping,
        frequency=1.245,
        stiffness=Periodic(1.0, (0.335,)),
        force=force,
        half_backlash=scale,
    )


def bistable(scale=1.0, frequency=0.7):
    force = Periodic(0.1 * scale, (0.05 * scale,))
    return DeadZoneModel(
        damping_ratio=0.05,
        frequency=frequency,
        stiffness=Periodic(1.0, (0.1,)),
        force=force,
        half_backlash=scale,
    )


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("model", [rattling, bistable])
def test_basins_do_not_know_the_unit_of_length(model, scale):
    axis = np.linspace(-2.0, 2.0, 5)
    one, other = (
        basins(model(), x=axis, v=axis),
        basins(model(scale), x=scale * axis, v=scale * axis),
    )
    assert np.array_equal(one.attractor.values, other.attractor.values)
    assert np.array_equal(one.attractor_period.values, other.attractor_period.values)
    assert np.array_equal(scale * one.attractor_x, other.attractor_x, equal_nan=True)
    assert np.array_equal(scale * one.attractor_v, other.attractor_v, equal_nan=True)


def test_all_starts_of_a_chaotic_point_end_on_its_one_set():
    axis = np.linspace(-2.0, 2.0, 5)
    data = basins(rattling(), x=axis, v=axis)
    assert data.attractor_period.values.tolist() == [0]
    assert np.all(data.attractor.values == 0)
    assert data.fraction.values.tolist() == [1.0]


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("damping", [0.18, 0.168, 0.1])
def test_labels_and_exponents_do_not_know_it_either(scale, damping):
    one, other = label(rattling(1.0, damping)), label(rattling(scale, damping))
    assert str(one) == str(other)
    assert (one.lyapunov is None) == (damping > 0.1)
    if one.lyapunov is not None:
        assert one.lyapunov.value == other.lyapunov.value
    assert np.array_equal(one.multipliers, other.multipliers)
    run = {"discard": 200, "batches": 8, "batch_periods": 200}
    assert (
        lyapunov_exponent(rattling(1.0, damping), **run).value
        == lyapunov_exponent(rattling(scale, damping), **run).value
    )


@pytest.mark.parametrize("scale", SCALES)
def test_orbits_and_their_branches_scale(scale):
    start = np.array([1.178, 0.0074])
    one = periodic_orbit(bistable(), 1, start)
    other = periodic_orbit(bistable(scale), 1, scale * start)
    assert other.state == pytest.approx(scale * one.state, rel=1e-12)
    assert other.multipliers == pytest.approx(one.multipliers, rel=1e-9)
    assert (other.contact_losses, other.back_impacts) == (one.contact_losses, one.back_impacts)
    there = continuation(one, "frequency", 0.85)
    here = continuation(other, "frequency", 0.85)
    assert len(here.bifurcations) == len(there.bifurcations) > 0
    for a, b in zip(here.bifurcations, there.bifurcations, strict=True):
        assert a.kind == b.kind
        assert a.value == pytest.approx(b.value, abs=1e-10)
        assert a.state == pytest.approx(scale * b.state, rel=1e-8)


@pytest.mark.parametrize("scale", SCALES)
def test_a_diagram_scales_with_its_branches(scale):
    values = np.linspace(0.75, 0.82, 15)
    start = np.array([(1.18, 0.007)])
    one = orbit_diagram(bistable(), "frequency", values, starts=start, branch_period=1)
    other = orbit_diagram(
        bistable(scale), "frequency", values, starts=scale * start, branch_period=1
    )
    for name in ("section_x", "section_v"):
        assert np.array_equal(scale * one[name], other[name], equal_nan=True)
    assert np.array_equal(one["label"], other["label"])
    assert other.sizes == one.sizes
    assert np.array_equal(one["bifurcation_kind"], other["bifurcation_kind"])
    assert other["bifurcation_value"].values == pytest.approx(
        one["bifurcation_value"].values, abs=1e-10
    )


def test_a_family_is_measured_by_the_scales_of_its_first_lane():
    lanes = TorsionalModel(
        damping_ratio=0.1,
        frequency=[0.5, 2.0],
        stiffness_amplitude=0.1,
        mean_force=0.1,
        force_amplitude=0.1,
    ).lanes()
    assert lanes.unit[0].tolist() == pytest.approx([1.0, 0.5], rel=1e-15)
