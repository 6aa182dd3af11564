"""``new`` with inspection charts, and what ``check`` says of them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import own_chart
from own_chart import END, START, chart, diameter
from thermogear.case.case import GearCase, load_case
from thermogear.front.cli import main

OWN = ["--teeth", "20", "40", "--module", "3 mm", "--face-width", "30 mm"]
OWN += ["--torque", "80 N m", "--speed", "3000 rpm"]
RHO = np.linspace(START, END, 101)
TEXT = chart({"tooth 1 left [um]": 5e3 * (RHO - START) / END}, diameter(RHO)).replace(
    "[um]", "[nm]"
)


def test_new_names_the_chart_beside_the_file_and_check_tells_its_class(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "charts").mkdir()
    (tmp_path / "cases").mkdir()
    (tmp_path / "charts" / "pinion.csv").write_text(TEXT, encoding="utf-8")
    words = ["new", *OWN, "--pinion-flanks", "charts/pinion.csv", "-o", "cases/mine.toml"]
    assert main(words) == 0
    text = Path("cases/mine.toml").read_text(encoding="utf-8")
    assert 'pinion = "../charts/pinion.csv"' in text
    assert "files" not in text
    assert len(text.splitlines()) <= 30
    case = load_case(Path("cases/mine.toml"))
    assert isinstance(case, GearCase)
    assert case.charts[0].flanks[0].figures[0].slope == pytest.approx(4.2e-6, rel=0.02)
    capsys.readouterr()
    assert main(["check", "cases/mine.toml"]) == 0
    told = capsys.readouterr().out
    (drive,) = (line for line in told.splitlines() if re.search(r"\b1 left \(drive\)", line))
    assert re.search(r"class [45]$", drive)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (
            TEXT.replace(" [nm]", ""),
            "error: flanks.pinion: got pinion.csv line 1: column 'tooth 1 left' without a unit; "
            "allowed a unit of length; are the values, up to 4220.98, micrometres? then write "
            "'tooth 1 left [um]'",
        ),
        ("", "error: flanks.pinion: got 'pinion.csv'; allowed a CSV file of an inspection chart"),
        (
            TEXT.replace("diameter", "dimaeter"),
            "error: flanks.pinion: got pinion.csv line 1: column 'dimaeter'; allowed diameter",
        ),
    ],
)
def test_a_chart_that_leaves_a_question_writes_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    text: str,
    line: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("pinion.csv").write_text(text, encoding="utf-8")
    assert main(["new", *OWN, "--pinion-flanks", "pinion.csv", "-o", "mine.toml"]) == 2
    told = capsys.readouterr()
    assert told.err.startswith(line)
    assert told.err.count("\n") == 1
    assert not Path("mine.toml").exists()


def test_both_charts_and_an_override(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.csv").write_text(TEXT, encoding="utf-8")
    Path("b.csv").write_text(TEXT.replace("tooth 1 left", "tooth 2 left"), encoding="utf-8")
    Path("mine.toml").write_text(f'{own_chart.CASE}[flanks]\npinion = "a.csv"\n', encoding="utf-8")
    assert main(["check", "mine.toml", "--set", "flanks.pinion=b.csv"]) == 0
    assert re.search(r"\b2 left \(drive\)", capsys.readouterr().out)
    case = load_case("mine.toml", ["flanks.pinion=b.csv"])
    again = load_case(case.text, case.overrides and dict(case.overrides))
    assert again.text == case.text
