"""``thermogear versus``: directories and case files, and every slip in one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from thermogear.case.case import load_example
from thermogear.case.examples import example_text
from thermogear.front.cli import main
from thermogear.study.run import run
from thermogear.views.write import save_results

FEW = [
    "grid.path_positions=21", "grid.mesh_positions=64", "simulation.periods=16",
    "operating.speed=1000 rpm", 'draw.pictures=["motion"]', "model.bundle=thesis",
]  # fmt: skip


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("runs") / "rows"
    save_results(run(load_example("rig", FEW)), place)
    return place


def refused(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    assert main(["versus", *map(str, words)]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    (line,) = told.err.splitlines()
    return line


def test_a_directory_against_a_case_file(
    rows: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = example_text("rig")
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    few = [word for change in FEW for word in ("--set", change)]
    few += ["--set", "simulation.periods=8", "--set", "simulation.samples=32"]
    words = ["versus", str(rows), str(tmp_path / "mine.toml"), *few, "-o", str(out), "--json"]
    assert main(words) == 0
    told = json.loads(capsys.readouterr().out)
    assert [row["field"] for row in told["differences"]] == [
        "simulation.periods", "simulation.samples",
    ]  # fmt: skip
    assert (out / "mine" / "results.nc").is_file()
    assert {"versus.html", "versus.nc", "versus_figures_by_bundle_case_operating_state.csv"} <= {
        p.name for p in out.iterdir()
    }


def test_cases_are_run_as_the_options_say(
    rows: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, few = tmp_path / "out", [word for change in FEW for word in ("--set", change)]
    assert main(["versus", str(rows), "rig", *few, "-o", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["differences"] == []
    line = refused(capsys, rows, rows, "--mean-tooth", "-o", out)
    assert line == (
        "error: overrides: got gears.period=mesh; directories of results stay as they are; name a "
        "case, or none"
    )
    line = refused(capsys, rows, "section-4.1", "--turn", "-o", out)
    assert "--turn, --mean-tooth or --part: got a case without gears; leave it out" in line


def test_slips_are_told_in_one_line(
    rows: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert "got 1 case; allowed 2..6 cases; a comparison takes two" in refused(
        capsys, rows, "-o", out
    )
    assert "got 0 cases" in refused(capsys, "-o", out)
    assert "got 7 cases; allowed 2..6" in refused(capsys, *[rows] * 7, "-o", out)
    assert "no such directory or case file; did you mean 'rows'?" in refused(
        capsys, rows, rows.with_name("rwos"), "-o", out
    )
    line = refused(capsys, rows, "section-4.1", "-o", out)  # the ready-made case, which is read
    assert "allowed kind = 'gear'" in line
    assert "`thermogear run CASE -o DIR`" in refused(capsys, rows, tmp_path / "zzz", "-o", out)
    (tmp_path / "empty").mkdir()
    assert "there is no such file" in refused(capsys, rows, tmp_path / "empty", "-o", out)
    (tmp_path / "row.toml").write_text(example_text("section-4.1"), encoding="utf-8")
    assert "allowed kind = 'gear'" in refused(capsys, rows, tmp_path / "row.toml", "-o", out)
    (tmp_path / "bad.toml").write_text("kind = [", encoding="utf-8")
    refused(capsys, rows, tmp_path / "bad.toml", "-o", out)
    assert not out.exists()


def test_output_among_foreign_files_is_refused(
    rows: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "letter.txt").write_text("mine", encoding="utf-8")
    assert "not results of thermogear" in refused(capsys, rows, rows, "-o", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]
