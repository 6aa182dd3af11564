"""Studies declared once: function, command and what is stored follow from the same fields."""

from __future__ import annotations

import inspect
from dataclasses import fields
from importlib import import_module
from typing import Any

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.progress import silent
from thermogear.base.units import RPM
from thermogear.case.case import gear_case, load_example
from thermogear.case.one_point import of_numbers
from thermogear.front.cli import cli
from thermogear.study.answers.survey import answers
from thermogear.study.declared import (
    COMMANDS,
    Campbell,
    ClosedOrbit,
    Contact,
    Lyapunov,
    NaturalModes,
    ReliefSurvey,
    Study,
    Temperature,
    declared,
    option,
)
from thermogear.study.friction import friction_survey
from thermogear.study.orbit import orbit_results
from thermogear.study.relief import relief_survey
from thermogear.study.shafts.campbell import campbell
from thermogear.study.shafts.statics import statics
from thermogear.study.shafts.waterfall import waterfall
from thermogear.study.warm_up import warm_up_survey

NUMBERS = {
    "damping_ratio": 0.1535,
    "frequency": 1.245,
    "stiffness_amplitude": 0.335,
    "mean_force": 0.017,
    "force_amplitude": -1.16,
}


@pytest.mark.parametrize("name", COMMANDS)
def test_function_and_command_have_the_fields_of_the_declaration(name: str) -> None:
    study: Any = COMMANDS[name]
    module, _, function = study.home.partition(":")
    parameters = inspect.signature(getattr(import_module(module), function)).parameters
    assert "progress" in parameters
    for each in fields(study):
        assert each.name in {parameter.name for parameter in cli.commands[name].params}
        if study.arguments is Study.arguments:
            assert parameters[each.name].default == each.default
    assert cli.commands[name].help == inspect.getdoc(study)


def test_what_was_asked_is_stored_from_python_and_from_the_command_line() -> None:
    result = orbit_results(of_numbers(NUMBERS), 2)
    assert result.table("asked") == {"period": 2, "transient": True}
    given = cli.commands["orbit"].make_context("orbit", ["--period", "2", "--direct"]).params
    fields_given = {name: given[name] for name in ("period", "transient")}
    asked = ClosedOrbit(**fields_given).of_subject(of_numbers(NUMBERS, (0.78, 0.045)))(silent)
    assert asked.table("asked") == {"period": 2, "transient": False}


@pytest.mark.parametrize(
    ("study", "asked", "line"),
    [
        (Lyapunov, {"batches": 3}, "batches: got 3; allowed 4..100000"),
        (ReliefSurvey, {"shape": "round"}, "shape: got 'round'; allowed linear | parabolic"),
        (Contact, {"body": "bore"}, "body: got 'bore'; allowed bore-clamped | rim"),
        (NaturalModes, {"count": True}, "count: got True; allowed 1..60, a whole number"),
        (ReliefSurvey, {"torque": "abc"}, "torque: got 'abc'; allowed a number [N m]"),
        (ReliefSurvey, {"torque": 1e8}, "torque: got 1e+08 N m; allowed 0..1e7 N m"),
        (Campbell, {"speeds": (100.0,)}, "speeds: got (100.0,); allowed two numbers [rad/s]"),
        (
            Temperature,
            {"torques": []},
            "torques: got []; allowed one number or more, on one axis [N m]",
        ),
        (Temperature, {"speeds": "abc"}, "speeds: got 'abc'; allowed numbers [rad/s]"),
    ],
)
def test_python_is_refused_under_the_name_of_the_field(
    study: type[Study], asked: dict[str, Any], line: str
) -> None:
    with pytest.raises(InputError) as error:
        study(**asked)
    assert str(error.value) == line


@pytest.mark.parametrize("given", ["rig", None, load_example("table-4.2")])
@pytest.mark.parametrize(
    "study", [answers, friction_survey, relief_survey, statics, campbell, waterfall, warm_up_survey]
)
def test_what_has_no_gears_is_refused_from_python(study: Any, given: Any) -> None:
    with pytest.raises(InputError, match=r"^case: got kind = .*; allowed kind = 'gear'; there is"):
        study(given, **({"speeds": [100.0]} if study is waterfall else {}))


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ({"duty": "x.csv"}, "duty: got 'x.csv'; allowed a Duty; pass read_duty(FILE, case)"),
        ({"measured": 5}, "measured: got 5; allowed a Measured; pass read_measured(FILE)"),
        ({"moments": "many"}, "moments: got many; allowed a whole number >= 1"),
    ],
)
def test_a_warm_up_takes_what_was_read(arguments: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError) as error:
        warm_up_survey(gear_case(load_example("rig")), **arguments)
    assert str(error.value) == line


def test_arrays_are_stored_as_lists_and_what_is_no_number_is_left_out() -> None:
    axes = {"speeds": np.array([1.0, 2.0]) * RPM, "torques": (np.int64(5), 2.5)}
    asked = Temperature(**axes).asked({"own": True})
    assert asked == {
        "speeds": [RPM, 2.0 * RPM], "torques": [5, 2.5], "own": True, "force": False
    }  # fmt: skip
    assert type(asked["torques"][0]) is int
    assert COMMANDS["warmup"](duty="a.csv").asked({"duty": object()})["duty"] == "a.csv"  # type: ignore[call-arg]


def test_the_speeds_of_the_case_are_asked_where_its_own_are_wanted() -> None:
    case = gear_case(load_example("rig"))
    asked = Temperature(own=True)
    arguments = asked.arguments(case)
    assert arguments == {"speeds": case.speeds, "torques": case.torques}
    assert asked.asked(arguments)["speeds"] == list(case.speeds)


def test_a_function_is_not_called_with_what_is_not_allowed() -> None:
    from dataclasses import dataclass

    @dataclass(frozen=True)
    class Turns(Study, kind="turns", home="", of="point"):
        count: int = option(2, "--count", "Turns.", allowed=range(1, 4))

    @declared(Turns)
    def turned(count: int = Turns.count) -> Any:
        raise AssertionError(count)

    with pytest.raises(InputError, match=r"^count: got 4; allowed 1\.\.3$"):
        turned(4)
