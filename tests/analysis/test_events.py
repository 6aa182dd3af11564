"""Events of branches against values of bisection, derivatives that know jumps."""

import numpy as np
import pytest

from thermogear.analysis.bifurcations import FLIP, FOLD, GRAZING, SUBCRITICAL, SUPERCRITICAL
from thermogear.analysis.continuation import continuation, family_of
from thermogear.analysis.curve import Curve
from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.excitation import Periodic
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel
from thermogear.dynamics.tables import Pieces

# events of three sets of numbers drawn at random, located by bisection with derivatives of the
# maps by differences
DRAWN = (
    (
        "force_amplitude",
        2.0,
        1,
        (0.8877198766122869, 0.22818973030136352),
        {
            "damping_ratio": 0.11210438272143748,
            "frequency": 0.7306311774130615,
            "stiffness_amplitude": 0.18149712545299912,
            "mean_force": 0.18767463672122664,
            "force_amplitude": 0.2628894053376375,
            "half_backlash": 0.9296571653058734,
        },
        (
            (FLIP, 0.36408389454128415, SUPERCRITICAL),
            (GRAZING, 0.47959174534544613, "back-side impacts per orbit 0 -> 1"),
            (FLIP, 0.47984036594959883, SUBCRITICAL),
            (FOLD, 0.4858933261028058, ""),
            (FOLD, 0.4090406829401414, ""),
        ),
    ),
    (
        "frequency",
        1.25,
        2,
        (1.1443209621512465, 0.04612287810156546),
        {
            "damping_ratio": 0.05993057692175728,
            "frequency": 1.3174146792882162,
            "stiffness_amplitude": 0.1482881648126012,
            "mean_force": 0.07068122949952908,
            "force_amplitude": 0.38941996175250093,
            "half_backlash": 0.9383560472207713,
        },
        ((GRAZING, 1.640458140219699, "contact losses per orbit 1 -> 2"),),
    ),
    (
        "frequency",
        1.25,
        1,
        (1.4483208818699418, -0.28475764717701374),
        {
            "damping_ratio": 0.06753609697299359,
            "frequency": 0.722401989847857,
            "stiffness_amplitude": 0.15975864242812637,
            "mean_force": 0.234052145671248,
            "force_amplitude": 0.3675861615669161,
            "half_backlash": 1.1331611671058326,
        },
        ((FOLD, 0.7608269546188713, ""),),
    ),
)


@pytest.mark.parametrize(("parameter", "factor", "period", "guess", "numbers", "known"), DRAWN)
def test_events_lie_where_bisection_finds_them(parameter, factor, period, guess, numbers, known):
    model = TorsionalModel(**numbers)
    orbit = periodic_orbit(model, period, guess)
    branch = continuation(orbit, parameter, factor * numbers[parameter])
    found = branch.bifurcations
    assert [(b.kind, b.note) for b in found] == [(kind, note) for kind, _, note in known]
    assert [b.value for b in found] == pytest.approx([value for _, value, _ in known], rel=1e-10)
    # at a grazing contact is another a billionth of the value to either side
    for graze in branch.of_kind(GRAZING):
        sides = [
            periodic_orbit(
                model.replace(**{parameter: graze.value * (1.0 + away)}), graze.period, graze.state
            )
            for away in (-1e-9, 1e-9)
        ]
        assert len({(one.contact_losses, one.back_impacts) for one in sides}) == 2


@pytest.mark.parametrize("parameter", ["frequency", "half_backlash"])
def test_the_derivative_in_the_parameter_knows_jumps(parameter):
    model = DeadZoneModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness=Pieces.constant(starts=(0.0, 0.6), values=(1.2, 0.7)),
        force=Periodic(0.1, (0.3 + 0.1j,)),
        half_backlash=0.9,
    )
    family, value = family_of(model, parameter)
    curve = Curve(family, parameter, 1, start=value, span=1.0)
    here = np.array([1.1, 0.3, value])
    moved, _ = curve.in_parameter(here, curve.residual(here)[2])
    step = np.array([0.0, 0.0, 1e-5])
    ends = [curve.residual(here + sign * step)[0] for sign in (1.0, -1.0)]
    assert moved == pytest.approx((ends[0] - ends[1]) / 2e-5, rel=3e-8, abs=1e-8)


def test_a_branch_that_turns_back_out_of_its_range_shows_its_fold():
    """Begun closely before a fold and with a long first step."""
    orbit = periodic_orbit(TorsionalModel(**DRAWN[2][4]), 1, DRAWN[2][3])
    whole = continuation(orbit, "frequency", 0.9)
    (fold,) = whole.of_kind(FOLD)
    model = TorsionalModel(**DRAWN[2][4]).replace(frequency=fold.value * (1.0 - 1e-7))
    beside = periodic_orbit(model, 1, fold.state)
    branch = continuation(beside, "frequency", 0.8, span=1.0)
    assert [b.value for b in branch.of_kind(FOLD)] == pytest.approx([fold.value], rel=1e-10)
