"""``thermogear import``: gearbox files in."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from own_rexs import one_stage, put, replaced, xml
from said import numbers
from thermogear.case.case import load_case
from thermogear.case.duty import read_duty
from thermogear.front.cli import main

Capture = pytest.CaptureFixture[str]


def spectrum() -> str:
    loads = [
        [
            (1, "gear_unit", [("operating_time", "h", hours)]),
            (4, "shaft", [("rotational_speed", "1 / min", speed)]),
            (11, "external_load", [("torque_around_u_axis", "N m", torque)]),
        ]
        for speed, torque, hours in ((1000.0, 20.0, 2.0), (1450.0, 30.0, 1.0))
    ]
    return xml(*one_stage(), loads=loads)


def test_the_list(tmp_path: Path, capsys: Capture) -> None:
    parts, links = one_stage()
    parts.append((3000, "cylindrical_stage", []))
    path = put(tmp_path, xml(parts, links))
    assert main(["import", str(path)]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].startswith("REXS 1.7, XML,")
    shafts = [numbers(line) for line in out if line.startswith("  shaft")]
    assert shafts == [[4.0, 1450.0, 30.0], [5.0, -708.14]]
    stages = [numbers(line) for line in out if "cylindrical_stage" in line]
    assert stages[0] == [1.0, 3.0, 21.0, 43.0, 2.5]
    assert stages[1][:2] == [2.0, 3000.0]
    assert out[-1].split()[1:4] == ["thermogear", "import", str(path)]
    assert main(["import", str(path), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert [one["stage"] for one in content["stages"]] == [1, 2]
    assert content["stages"][0]["refused"] is None
    assert content["stages"][1]["refused"].startswith("stage 2.gears: got no gear")


def test_a_stage_as_a_case_with_its_duty(tmp_path: Path, capsys: Capture) -> None:
    path, mine = put(tmp_path, spectrum()), tmp_path / "mine.toml"
    assert main(["import", str(path), "--stage", "1", "-o", str(mine)]) == 0
    out = capsys.readouterr().out.splitlines()
    duty = tmp_path / "mine-duty.csv"
    assert out[:2] == [str(mine), str(duty)]
    assert out[-1].split() == ["next:", "thermogear", "answers", str(mine)]
    case = load_case(mine)
    work = read_duty(duty, case)  # type: ignore[arg-type]
    assert work.time.tolist() == [0.0, 7200.0, 10800.0]
    assert work.torque.tolist() == [20.0, 30.0]
    assert main(["check", str(mine)]) == 0
    capsys.readouterr()
    assert main(["import", str(path), "--stage", "1", "-o", str(mine)]) == 2
    assert "it is there already" in capsys.readouterr().err


def test_a_stage_printed(tmp_path: Path, capsys: Capture) -> None:
    path = put(tmp_path, xml(*one_stage()))
    assert main(["import", str(path), "--stage", "1", "--speed", "900 rpm"]) == 0
    out = capsys.readouterr().out
    assert 'speed = "900 rpm"   # given: --speed' in out
    assert load_case(out).pair.pinion.teeth == 21  # type: ignore[union-attr]


def test_a_unit_of_another_version_is_one_line(tmp_path: Path, capsys: Capture) -> None:
    path = put(tmp_path, xml(*one_stage("1.2"), "1.2").replace('version="1.2"', 'version="1.7"'))
    assert main(["import", str(path)]) == 0
    heard = capsys.readouterr().err.splitlines()
    assert len(heard) == 1
    assert heard[0].startswith("warning: cylindrical_gear 7.helix_angle_reference_diameter")
    assert heard[0].endswith("got the unit '°'; REXS 1.7 has 'deg'; converted by the unit written")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--stage", "7"], "--stage: got 7; allowed 1..1"),
        (["--stage", "1", "--speed", "fast"], "operating.speed: got 'fast'"),
        (["-o", "nowhere/mine.toml"], "there is no directory nowhere"),
    ],
)
def test_wrong_words(given: list[str], said: str, tmp_path: Path, capsys: Capture) -> None:
    path = put(tmp_path, xml(*one_stage()))
    assert main(["import", str(path), *given]) == 2
    heard = capsys.readouterr().err
    assert len(heard.splitlines()) == 1
    assert said in heard


def test_a_file_that_is_not_there(tmp_path: Path, capsys: Capture) -> None:
    put(tmp_path, xml(*one_stage()))
    assert main(["import", str(tmp_path / "gearbx.rexs")]) == 2
    assert (
        "'gearbx.rexs': got no such file; did you mean 'gearbox.rexs'?" in capsys.readouterr().err
    )
    assert main(["import", str(tmp_path)]) == 2
    assert "a directory" in capsys.readouterr().err


def test_several_stages_want_a_number(tmp_path: Path, capsys: Capture) -> None:
    parts, links = one_stage()
    parts.append((3000, "cylindrical_stage", []))
    path = put(tmp_path, xml(parts, links))
    assert main(["import", str(path), "-o", str(tmp_path / "mine.toml")]) == 2
    assert "--stage: got nothing; allowed 1..2; the file has several" in capsys.readouterr().err


def test_teeth_of_one_gear_alone(tmp_path: Path, capsys: Capture) -> None:
    parts, links = one_stage()
    path = put(tmp_path, xml(replaced(parts, 9, drop=("number_of_teeth",)), links))
    assert main(["import", str(path), "--stage", "1"]) == 2
    said = "error: stage 1.cylindrical_gear 9.number_of_teeth: got nothing; allowed a whole number"
    assert capsys.readouterr().err.strip() == said
