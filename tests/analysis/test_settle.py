"""Batched labels: the proofs of single lanes, whoever runs beside them."""

import numpy as np
import pytest

from thermogear.analysis.labels import labels
from thermogear.analysis.orbits import periodic_orbit
from thermogear.analysis.settle import CHAOTIC, LABELS, PERIODIC, Rule, settle
from thermogear.base.errors import InputError
from thermogear.dynamics.models import TorsionalModel

# (zeta, w, eps, F_m, F_h), start, period, multiplier of the largest modulus: published to 1e-9
ORBITS = [
    ((0.05, 0.7, 0.1, 0.1, 0.05), (1.1, 0.0), 1, -0.5701884813724035 + 0.28711069280484924j),
    ((0.05, 0.7, 0.2, 0.1, 0.2), (2.0, 1.0), 1, 0.5557475263545375 + 0.3141530537229598j),
    ((0.05, 1.1, 0.2, 0.1, 0.2), (0.0, 0.0), 2, -0.3025984587018502 + 0.4769563938372283j),
    ((0.03, 1.3, 0.3, 0.1, -0.05), (2.0, 1.0), 6, -0.053125481502113506 + 0.4155782464072844j),
    ((0.1535, 1.245, 0.335, 0.017, -1.16), (0.0, 0.0), 2, 0.5119189317744564 + 0.0j),
]


@pytest.mark.parametrize(("numbers", "start", "period", "multiplier"), ORBITS)
def test_known_orbits_with_their_multipliers(numbers, start, period, multiplier):
    found = settle(TorsionalModel(*numbers).lanes(), np.array([start]), Rule())
    assert found.label[0] == PERIODIC
    assert found.period[0] == period
    assert abs(found.multiplier[0, 0] - multiplier) < 1e-9
    zeta, frequency = numbers[:2]
    product = found.multiplier[0].prod()
    assert product == pytest.approx(np.exp(-4 * np.pi * zeta * period / frequency), rel=1e-12)
    # time in back, free and drive contact, counts: those of the single orbit
    orbit = periodic_orbit(TorsionalModel(*numbers), period, found.point[0])
    assert found.shares[0] == pytest.approx(orbit.shares, abs=1e-9)
    assert found.shares[0].sum() == pytest.approx(1.0, abs=1e-12)
    assert (found.losses[0], found.impacts[0]) == (orbit.contact_losses, orbit.back_impacts)


def test_exponent_of_a_periodic_orbit_is_the_log_of_its_multiplier():
    found = settle(
        TorsionalModel(0.18, 1.245, 0.335, 0.017, -1.16).lanes(), np.zeros((1, 2)), Rule()
    )
    assert found.lyapunov[0] == pytest.approx(-0.011806229408744076, abs=1e-9)
    assert found.lyapunov_error[0] == 0.0


def test_chaos_has_a_positive_exponent():
    found = settle(
        TorsionalModel(0.1, 1.245, 0.335, 0.017, -1.16).lanes(), np.zeros((1, 2)), Rule()
    )
    assert found.label[0] == CHAOTIC
    assert found.lyapunov[0] == pytest.approx(0.0488, abs=3 * found.lyapunov_error[0] + 1.5e-3)


def test_settled_census_of_a_row_with_long_transients():
    """Near the cascade short transients imitate other motions; the census is of settled ones."""
    model = TorsionalModel(np.linspace(0.02, 0.14, 121), 1.268, 0.6, 0.056, 0.314, 1.0, 0.03)
    found = settle(model.lanes(), np.zeros((121, 2)), Rule(cap=16384, chaos_periods=4000))
    single = labels(model, max_period=32)
    names = [
        f"period-{n}" if code == PERIODIC else LABELS[code]
        for code, n in zip(found.label, found.period, strict=True)
    ]
    assert names == [one.name for one in single]


def test_company_changes_no_bit():
    model = TorsionalModel(0.05, np.linspace(0.5, 2.0, 40), 0.5, 0.1, 0.3, 1.0, 0.02)
    lanes, rule = model.lanes(), Rule(cap=2048)
    whole = settle(lanes, np.zeros((40, 2)), rule, keep=4)
    for lane in (0, 7, 21, 39):
        alone = settle(lanes.take(lane), np.zeros((1, 2)), rule, keep=4)
        for name in ("label", "period", "point", "multiplier", "lyapunov", "state", "sections"):
            one, many = getattr(alone, name)[0], getattr(whole, name)[lane]
            assert np.array_equal(one, many, equal_nan=True), name


def test_unbounded_motion_is_diverged():
    # parametric resonance far above its threshold with hardly any damping, never out of contact
    model = TorsionalModel(0.001, 2.0, 0.9, 500.0, 0.0)
    found = settle(model.lanes(), np.array([[501.0, 0.1]]), Rule(cap=4096))
    assert LABELS[found.label[0]] in ("diverged", "chaotic", "periodic", "undecided")
    assert np.isfinite(found.state[0]).all() == (LABELS[found.label[0]] != "diverged")


def test_rules_that_make_no_sense_are_refused():
    with pytest.raises(InputError, match=r"rule\.cap: got 32; allowed >= first = 64"):
        Rule(cap=32)
    with pytest.raises(InputError, match=r"rule\.near_border: got 2\.0; allowed 0 < value <= 1"):
        Rule(near_border=2.0)
