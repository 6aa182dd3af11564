"""``thermogear draw``: files by their ending, and one line for every slip."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from coded import coded
from own_pair import OWN_PAIR
from thermogear.base.display import kind_in_words
from thermogear.front.cli import main
from thermogear.gears.deviations import PitchError


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(OWN_PAIR, "utf-8")
    return path


@pytest.mark.parametrize(("name", "head"), [("a.svg", b"<?xml"), ("a.png", b"\x89PNG")])
def test_it_draws_into_the_file_named(
    case: Path, name: str, head: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    path = case.parent / name
    assert main(["draw", str(case), "-o", str(path), "--phase", "0.5", "--enlarge", "20"]) == 0
    assert path.read_bytes().startswith(head)
    told = capsys.readouterr().out
    assert told.splitlines()[-1] == str(path)
    assert re.search(r"^ *span .* mm$|^ *span .*\d", told, re.MULTILINE)


def test_a_dxf_holds_the_states_asked_for(case: Path) -> None:
    path = case.parent / "a.dxf"
    assert main(["draw", str(case), "-o", str(path), "--show", "hot"]) == 0
    text = path.read_text("utf-8")
    assert text.count("AcDbPolyline") == 2


def test_what_of_the_flanks_is_drawn_is_told_in_words(
    case: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tooth = "gears.pinion.teeth_differ=[{tooth=3, index='5 um'}]"
    words = ["draw", str(case), "-o", str(case.parent / "a.svg"), "--json", "--set", tooth]
    assert main(words) == 0
    notices = coded(json.loads(capsys.readouterr().out)["notices"])
    kind = kind_in_words(PitchError("pinion", (0.0,)))
    assert kind.split() == ["pitch", "error"]
    assert notices["nominal_flanks_drawn"] == [{"deviations": [kind]}]
    assert main([*words, "--part", "case"]) == 0
    notices = coded(json.loads(capsys.readouterr().out)["notices"])
    assert notices["mean_tooth_taken"] == [{"mesh_periods": 19}]
    assert notices["deviations_not_drawn"] == [{"deviations": kind}]


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["-o", "a.stp"], "output: got 'a.stp'; allowed .svg | .png | .pdf | .dxf"),
        (["-o", "gears"], "output: got 'gears'; allowed .svg | .png | .pdf | .dxf; end its name"),
        (["-o", "no/such/a.svg"], "output: got no/such/a.svg; there is no directory no/such"),
        (["--enlarge", "0.5"], "--enlarge: got 0.5; allowed 1..1000"),
        (["--enlarge", "nan"], "--enlarge: got nan; allowed 1..1000"),
        (["--phase", "2"], "phase: got 2; allowed 0..1"),
        (["--operating", "9"], "operating: got 9; allowed 1..1"),
        (["--state", "warm"], "--state: got 'warm'; allowed "),
        (["--turn"], "--turn: got a drawing; its teeth are all alike; leave it out"),
        (["--turn", "--mean-tooth"], "--turn: got gears.period twice; allowed once; leave one of"),
        (
            ["--part", "case", "--set", "gears.part=nominal"],
            "--part case: got gears.part twice; allowed once; leave one of",
        ),
        (["--bundle", "x"], "bundle: got 'x'; allowed consistent"),
    ],
)
def test_a_slip_is_one_line(
    case: Path,
    words: list[str],
    line: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(case.parent)
    assert main(["draw", str(case), *words]) == 2
    told = capsys.readouterr()
    assert told.err.count("\n") == 1
    assert line in told.err
    assert told.out == ""
    assert sorted(path.name for path in case.parent.iterdir()) == ["mine.toml"]
