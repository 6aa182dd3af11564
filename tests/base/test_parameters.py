"""One table of names: every alias is the same parameter, wherever it is written."""

from __future__ import annotations

from pathlib import Path

import click
import pytest

from thermogear.base.errors import InputError
from thermogear.base.parameters import GEARS, NUMBERS, PARAMETERS, long_name, named
from thermogear.case.allowed import gear_parameter, gear_reader
from thermogear.dynamics.models import TorsionalModel
from thermogear.front.cli import cli, main

ALIASES = {
    "frequency": ("w", "omega", "omega_h", "omega-h", "frequency"),
    "pinion_speed": ("rpm", "speed", "pinion_speed", "pinion-speed"),
    "mean_force": ("fm", "F_m", "mean_force", "mean-force"),
    "force_amplitude": ("fh", "F_h", "f-h"),
    "stiffness_amplitude": ("eps", "epsilon"),
    "thermal_stiffness": ("eps-t", "eps_T", "epsilon_T", "eps_t"),
    "damping_ratio": ("zeta", "damping"),
    "half_backlash": ("b", "b_prime", "b-prime"),
    "pinion_torque": ("torque",),
    "gear_temperature": ("temperature",),
    "cold_half_backlash": ("backlash",),
}


def test_every_alias_is_its_parameter() -> None:
    for name, aliases in ALIASES.items():
        assert {long_name(alias) for alias in aliases} == {name}


def test_no_name_stands_for_two_parameters() -> None:
    names = [alias for one in PARAMETERS.values() for alias in (one.name, *one.aliases)]
    assert len(set(names)) == len(names)


def test_the_numbers_are_those_of_the_equation_in_their_order() -> None:
    assert list(NUMBERS) == list(TorsionalModel.__dataclass_fields__)


@pytest.mark.parametrize("name", GEARS)
def test_a_gear_parameter_has_the_unit_of_every_field_it_stands_for(name: str) -> None:
    for field in PARAMETERS[name].fields:
        reader = gear_reader(field)
        assert gear_parameter(field).unit == PARAMETERS[name].unit
        assert type(reader) is type(gear_reader(name))


def test_what_is_shown_reads_back() -> None:
    for one in PARAMETERS.values():
        assert one.read(one.show(312.5)) == pytest.approx(312.5, rel=1e-14)
    assert PARAMETERS["gear_temperature"].show(373.15) == 100.0
    assert PARAMETERS["pinion_speed"].label.endswith(" [rpm]")
    assert PARAMETERS["frequency"].label.endswith(" ω_h")


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(InputError, match=r"^parameter: got 'omgea'; did you mean 'omega'\?$"):
        named("omgea", NUMBERS)
    with pytest.raises(InputError, match="got 'rpm'; a parameter of gears, and none of these"):
        named("rpm", NUMBERS)
    with pytest.raises(InputError, match="got 'fm'; a number of the dimensionless equation"):
        gear_parameter("fm")


def commands() -> list[click.Command]:
    found: list[click.Command] = []
    waiting: list[click.Command] = [cli]
    while waiting:
        one = waiting.pop()
        if isinstance(one, click.Group):
            waiting += one.commands.values()
        else:
            found.append(one)
    return found


@pytest.mark.parametrize("command", commands(), ids=lambda one: one.name)
def test_no_command_has_two_options_of_one_parameter(command: click.Command) -> None:
    options = [name.lstrip("-") for one in command.params for name in one.opts]
    long = [long_name(name) for name in options]
    assert len(set(long)) == len(long)


@pytest.mark.parametrize("words", ["--zeta --w --eps", "--damping --omega --epsilon",
                                   "--damping_ratio --omega-h --stiffness-amplitude"])  # fmt: skip
def test_options_go_by_every_name(words: str, capsys: pytest.CaptureFixture[str]) -> None:
    zeta, w, eps = words.split()
    told = [zeta, "0.1535", w, "1.245", eps, "0.335", "--F_m", "0.017", "--F-h", "-1.16"]
    assert main(["orbit", *told, "--json"]) == 0
    assert '"damping_ratio": 0.1535' in capsys.readouterr().out


def test_axes_go_by_every_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["map", "table-4.2", "--over", "w=1.1:1.3:2", "--over", "eps-t=0:0.01:2", "--but"]
    assert main([*words, "fm=0.02", "-o", str(tmp_path / "m"), "--json"]) == 0
    assert '"points": 4' in capsys.readouterr().out
    words = ["continue", "table-4.2", "--parameter", "omega_h", "--from", "1.2", "--to", "1.21"]
    assert main([*words, "--json"]) == 0
    assert '"parameter": "frequency"' in capsys.readouterr().out
