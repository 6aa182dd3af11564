"""Load-shared force against the one spring: alike at the mean load, apart at light load."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.parameters import long_name
from thermogear.case.case import gear_case, load_case, load_example
from thermogear.case.examples import example_text
from thermogear.case.one_point import of_case, of_numbers
from thermogear.study.shared_force import shared_results


def test_where_the_two_forms_part() -> None:
    found = shared_results(of_case(load_example("rig")), speeds=(100.0, 400.0), count=3)
    summary, rest = found.summary, found.tree["rest"].to_dataset()
    # at the mean load itself, where both are built, and not at a neighbour of it
    assert summary["stiffness_at_mean_load"] < 1e-6
    assert summary["swing_at_rest_mean_load"] < 0.06
    assert summary["swing_in_motion_mean_load"] < 0.08
    # at light load the springs of the pairs follow the contact, the one spring does not
    light = rest.isel(load=0)
    exact = float(light["exact_stiffness"])
    assert float(light["shared_stiffness"]) == pytest.approx(exact, rel=0.05)
    assert float(light["one_spring_stiffness"]) > 1.5 * exact
    assert np.all(np.diff(rest["exact_stiffness"].values) > 0.0)
    even = of_case(load_example("rig", ["transmission_error.harmonics=[]"]))
    bare = shared_results(even, speeds=(200.0, 201.0), count=1)
    assert bare.summary["swing_at_rest_light_load"] > 0.3


def test_deviations_reach_both_forms() -> None:
    relieved = load_case(
        example_text("rig"),
        [
            "gears.pinion.tip_relief={amount='60 um', length='6 mm'}",
            "gears.wheel.tip_relief={amount='60 um', length='6 mm'}",
        ],
    )
    at, bare = (
        shared_results(of_case(case), speeds=(200.0, 201.0), count=1).tree["rest"].to_dataset()
        for case in (gear_case(relieved), load_example("rig"))
    )
    # both forms: more play, the same play, and softer flanks at the tips
    play = at["one_spring_clearance"].values
    np.testing.assert_allclose(at["shared_clearance"].values, play, rtol=1e-9)
    assert np.ptp(play) > 1e-6 + np.ptp(bare["one_spring_clearance"].values)
    for name in ("exact_stiffness", "shared_stiffness", "one_spring_stiffness"):
        assert float(at[name].sel(load=at["load"][16])) < 0.95 * float(bare[name][16])


def test_teeth_that_differ_are_compared_as_their_mean_tooth() -> None:
    """Errors of mean 0 about a common one: the forms of that common error."""
    both = []
    for errors in ('"5 um", "1 um", ' * 12 + '"3 um"', '"3 um", ' * 25):
        case = load_case(example_text("rig"), [f"gears.pinion.pitch_errors=[{errors}]"])
        point = of_case(gear_case(case))
        found = shared_results(point, speeds=(200.0, 201.0), count=1).tree["rest"].to_dataset()
        both.append(found)
    for name in both[0]:
        np.testing.assert_allclose(both[0][name], both[1][name], rtol=1e-9, atol=1e-15)


def test_without_gears_there_is_no_load_to_share() -> None:
    numbers = {"zeta": 0.1, "w": 1.2, "eps": 0.3, "fm": 0.1, "fh": 0.1}
    with pytest.raises(InputError, match="it has no tooth pairs to share a load"):
        shared_results(of_numbers({long_name(k): v for k, v in numbers.items()}))
    with pytest.raises(InputError, match="choose the bundle 'consistent'"):
        shared_results(of_case(load_example("rig"), bundle="thesis"))


ERROR = 'transmission_error.harmonics=[{order=1, amplitude="6 um", phase="40 deg"}]'
"""A kinematic error beside that of the springs: a swing that forgets either one shows it."""


def test_both_swings_vanish_far_above_resonance_and_are_static_towards_standstill() -> None:
    """r_b1 theta_1 - r_b2 theta_2: inertia holds it still, slowness lets it follow the load."""
    # so much damping that nothing rings after a pair has entered
    case = gear_case(load_case(example_text("rig"), [ERROR, "dynamics.damping_ratio=0.9"]))
    point = of_case(case)
    resonance = point.excitation().natural_frequency / case.pair.pinion.teeth
    ends = resonance / 60.0, 60.0 * resonance
    found = shared_results(point, speeds=ends, count=2)
    rest, moving = (found.tree[name].to_dataset() for name in ("rest", "motion"))
    for form in ("shared", "one_spring"):
        slow, fast = moving[f"{form}_swing"].sel(part=1.0).values
        static = float(rest[f"{form}_swing"].sel(load=point.excitation().mean_force))
        assert slow == pytest.approx(static, rel=0.02)
        # the damper alone still pulls: 2 zeta e omega_n/omega
        assert fast < 2.5 * 0.9 / 60.0 * static
