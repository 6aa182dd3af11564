"""statics, modes, campbell: files on disk, figures as JSON and CSV, one-line errors."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from thermogear.case.examples import example_text
from thermogear.front.cli import main
from thermogear.views.write import write_report

SMALL = ["--set", 'operating.speed="2900 rpm"', "--set", "train.elements=6"]
KINDS = ("statics", "modes", "campbell")
HELD = """
[temperatures]
pinion_addendum = "90 degC"
pinion_bore = "80 degC"
wheel_addendum = "80 degC"
wheel_bore = "72 degC"
housing = "60 degC"
"""


@pytest.fixture(scope="module")
def train(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("case") / "train.toml"
    text = example_text("motor-train")
    text = text.replace('name = "ISO VG 100"', 'name = "ISO VG 100"\ntemperature = "70 degC"')
    path.write_text(text + HELD, encoding="utf-8")
    return path


@pytest.mark.parametrize("command", KINDS)
def test_a_study_leaves_data_page_pictures_and_numbers(
    command: str, train: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, table = tmp_path / "out", tmp_path / "points.csv"
    words = [command, str(train), "-o", str(out), "--json", "--csv", str(table), *SMALL]
    code = main(words)
    shown = capsys.readouterr()
    assert (code, shown.err) == (0, "")
    told = json.loads(shown.out)
    assert told["notices"]
    names = {path.name for path in out.iterdir()}
    assert {f"{command}.html", f"{command}.nc", f"{command}_sketch.svg"} <= names
    rows = list(csv.reader(table.read_text(encoding="utf-8").splitlines()))
    assert len({len(row) for row in rows}) == 1
    assert any("[" in head for head in rows[0])
    before = (out / f"{command}.html").read_bytes()
    write_report(out)
    assert (out / f"{command}.html").read_bytes() == before
    if command == "statics":
        loads = told["states"]["hot"]["bearings"]
        assert all(one["bearing_load_N"][0] > 100.0 for one in loads.values())
    elif command == "modes":
        hertz = told["states"]["hot"]["natural_frequency_Hz"]
        assert hertz == sorted(hertz)
    else:
        assert {"rpm", "rpm_least", "rpm_greatest", "participation"} <= set(told["critical"][0])


@pytest.mark.parametrize(
    ("words", "field"),
    [
        (["campbell", "TRAIN", "-o", "OUT", "--rpm", "3000"], "--rpm"),
        (["campbell", "TRAIN", "-o", "OUT", "--rpm", "3000:1000"], "--rpm"),
        (["campbell", "TRAIN", "-o", "OUT", "--torque", "-5"], "torque"),
        (["campbell", "TRAIN", "-o", "OUT", "--rpm", "0:nan"], "--rpm"),
        (["modes", "TRAIN", "-o", "OUT", "--count", "0"], "--count"),
        (["modes", "TRAIN", "-o", "OUT", "--operating", "9"], "operating"),
        (["statics", "rig", "-o", "OUT"], "shafts"),
        (["statics", "table-4.2", "-o", "OUT"], "case"),
        (["statics", "nowhere.toml", "-o", "OUT"], "nowhere.toml"),
        (["static", "TRAIN", "-o", "OUT"], "statics"),
        (["modes", "TRAIN", "-o", "OUT", "--set", 'shafts="none"'], "shafts"),
    ],
)
def test_a_wrong_word_is_one_line_and_leaves_nothing(
    words: list[str], field: str, train: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    put = {"TRAIN": str(train), "OUT": str(out)}
    assert main([put.get(word, word) for word in words]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert len(shown.err.strip().splitlines()) == 1
    assert field in shown.err
    assert not list(out.glob("*.nc"))
