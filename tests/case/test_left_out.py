"""A field left out on the command line, and a case written anew from its tables."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.own_pair import OWN_PAIR
from tests.own_trains import TRAIN

from thermogear import InputError, load_case
from thermogear.base.toml import overridden, pairs, tables, written
from thermogear.case.case import GearCase, gear_case
from thermogear.case.examples import EXAMPLES, example_text
from thermogear.case.units import KINDS
from thermogear.front.cli import main
from thermogear.study.case_runs import CaseRuns, overrides_of


def own(*changes: str) -> GearCase:
    return gear_case(load_case(OWN_PAIR, changes))


def alike(one: Any, other: Any) -> None:
    """The same case, however its text is written."""
    if isinstance(one, GearCase):  # holds arrays, made of what was read
        assert (one.file, one.title) == (other.file, other.title)
        assert one.assumptions == other.assumptions
    else:
        assert replace(one, text="", overrides=()) == replace(other, text="", overrides=())


def test_a_field_left_out_has_its_default() -> None:
    case = own("gears.pinion.profile_shift=", "oil.temperature=", "temperatures.pinion_addendum=",
               "temperatures.wheel_addendum=")  # fmt: skip
    assert case.pair.pinion.profile_shift == 0.0
    assert case.computed
    assert "gears.pinion.profile_shift" in {one.field for one in case.assumptions}


def test_a_table_left_out_has_its_defaults() -> None:
    case = own("transmission_error=")
    assert case.accuracy == 6
    assert "flanks.accuracy" in {one.field for one in case.assumptions}


def test_the_same_as_a_file_without_the_field() -> None:
    text = OWN_PAIR.replace("damping_ratio = 0.05\n", "")
    assert text != OWN_PAIR
    alike(own("dynamics.damping_ratio="), load_case(text))


def test_a_reason_goes_with_what_is_left_out() -> None:
    text = OWN_PAIR + '[ours."dynamics.damping_ratio"]\nvalue = 0.05\nreason = "felt"\n'
    field = "dynamics.damping_ratio"
    reasons = [
        {one.field: one for one in gear_case(load_case(text, changes)).assumptions}[field]
        for changes in ([], [f"{field}="])
    ]
    assert reasons[0].reason == "felt"
    assert reasons[1].default


def test_a_needed_field_left_out_is_refused_by_its_name() -> None:
    with pytest.raises(InputError, match=r"gears\.pinion\.teeth: got nothing; needed"):
        own("gears.pinion.teeth=")


def test_what_results_keep_makes_the_case_again() -> None:
    case = own("dynamics.damping_ratio=", "operating.speed=1200 rpm")
    kept = json.loads(json.dumps(case.provenance))
    assert kept["overrides"] == [["dynamics.damping_ratio", ""], ["operating.speed", "1200 rpm"]]
    again = load_case(kept["case"], dict(kept["overrides"]))
    assert again == case


def test_numbers_put_into_a_case_with_left_out_fields() -> None:
    case = own("dynamics.damping_ratio=", "backlash=", "gears.wheel.profile_shift=")
    for values in ({"operating.torque": 50.0}, {"dynamics.damping_ratio": 0.03},
                   {"cold_half_backlash": 50e-6}):  # fmt: skip
        changed = case.with_values(values)
        assert load_case(changed.text, dict(changed.overrides)) == changed


def test_a_case_that_runs_again_knows_what_is_left_out() -> None:
    kept = {"backlash": ""}
    with pytest.raises(InputError, match="the case states no such field"):
        overrides_of(OWN_PAIR, kept, "backlash.value", 1.1)
    runs = CaseRuns.of(own("dynamics.damping_ratio="))
    assert runs.case({}).damping_ratio == 0.07


def test_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "own.toml"
    file.write_text(OWN_PAIR, encoding="utf-8")
    left = "dynamics.damping_ratio=", "backlash=", "gears.wheel.profile_shift="
    words = [word for one in left for word in ("--set", one)]
    assert main(["check", str(file), "--json", *words]) == 0
    rows = {one["field"]: one for one in json.loads(capsys.readouterr().out)["assumptions"]}
    assert "dynamics.damping_ratio" in rows
    # a unit is one, counts are whole, real numbers are real
    gap = rows["backlash.value"]
    kind = {"extent": "total", "direction": "normal"}
    assert (gap["unit"], gap["note"].split(", ")) == ("mm", [*kind.values()])
    for name, row in rows.items():
        assert row["unit"] in ("", "um", "l/min", *(kind.shown for kind in KINDS.values()))
        counted = name.startswith(("grid.", "flanks.")) or (
            name.startswith("simulation.") and name != "simulation.initial_state"
        )
        several = row["value"] if isinstance(row["value"], list) else [row["value"]]
        numbers = [one for one in several if isinstance(one, int | float)]
        assert all(isinstance(one, int) == counted for one in numbers), row
    assert rows["gears.wheel.profile_shift"]["value"] == 0.0
    assert main(["check", str(file), "--set", "dynamics.damping="]) == 2
    said = capsys.readouterr().err
    assert "dynamics.damping: got nothing to leave out; [dynamics] of the file" in said
    assert "damping_ratio" in said


@pytest.mark.parametrize("text", [*map(example_text, EXAMPLES), OWN_PAIR, TRAIN])
def test_a_case_written_anew_is_the_same_case(text: str) -> None:
    changes = () if 'kind = "dimensionless"' in text else ("operating.speed=1234.5 rpm",)
    changes += tuple(f"{name}=" for name in ("draw", "gearbox", "ours") if f"\n[{name}]" in text)
    data = overridden(tables("case", text), pairs(changes))
    alike(load_case(written(data)), load_case(text, changes))
