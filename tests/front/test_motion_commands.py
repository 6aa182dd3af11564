"""orbit, lyapunov and continue on the command line: numbers, files, one-line errors, Ctrl+C."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thermogear.base.notice import Notice
from thermogear.front.cli import main
from thermogear.results.result import open_results

NUMBERS = ["--zeta", "0.1535", "--w", "1.245", "--eps", "0.335", "--fm", "0.017", "--fh", "-1.16"]


def test_the_commands_import_nothing_heavy() -> None:
    heavy = ["numpy", "scipy", "numba", "xarray", "matplotlib", "pydantic", "pint", "jinja2"]
    code = (
        "import sys, thermogear.front.motion_commands; "
        f"print([m for m in {heavy} if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_orbit_prints_stores_and_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "orbit"
    assert main(["orbit", *NUMBERS, "--start", "0,0", "--period", "2", "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "0.511918932" in said
    assert re.search(r"^ +0\.50* +half ", said, re.MULTILINE)
    names = {path.name for path in out.iterdir()}
    assert names >= {"orbit.nc", "orbit.json", "orbit.html", "orbit.svg", "orbit.png"}
    page = (out / "orbit.html").read_text(encoding="utf-8")
    assert "0.511918932" in page
    assert "http" not in page.replace("http-equiv", "").replace("http://www.w3.org", "")
    header = (out / "orbit_sample.csv").read_text(encoding="utf-8").splitlines()[0]
    assert header.startswith("time [1],displacement [1]")
    # the directory is ours, so a second command may write there
    assert main(["orbit", *NUMBERS, "-o", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["contact_losses"] == 2


def test_hidden_notices_are_counted_and_stay_stored(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "orbit"
    asked = ["orbit", *NUMBERS, "--period", "4", "-o", str(out)]
    assert main([*asked, "--json"]) == 0
    codes = [one["code"] for one in json.loads(capsys.readouterr().out)["notices"]]
    assert codes == ["other_period", "back_flank_not_reached"]
    hidden = ["--hide", "other_period", "--hide", "back_flank_not_reached,orbit_unstable"]
    count = Notice.of("notices_hidden", hidden=2, important=0)
    assert main([*asked, "--json", *hidden]) == 0
    assert json.loads(capsys.readouterr().out)["notices"] == [count.as_dict()]
    stored = open_results(out, "orbit")
    assert [one.code for one in stored.notices] == codes
    page = (out / "orbit.html").read_text(encoding="utf-8")
    assert count.text in page
    assert stored.notices[0].text not in page
    assert main(["report", str(out)]) == 0
    assert stored.notices[0].text in (out / "orbit.html").read_text(encoding="utf-8")
    assert main(["report", str(out), *hidden]) == 0
    assert (out / "orbit.html").read_text(encoding="utf-8") == page
    capsys.readouterr()
    assert main([*asked, "--hide", "other_perod"]) == 2
    assert capsys.readouterr().err == (
        "error: --hide: got 'other_perod'; no notice has this code; did you mean 'other_period'?\n"
    )


def test_lyapunov_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["table-4.2", "--row", "zeta", "--point", "4", "--batches", "8"]
    assert main(["lyapunov", *arguments, "--batch-periods", "100", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["sum"] == pytest.approx(-0.2)
    assert said["batches"] == 8


@pytest.mark.slow
def test_one_command_finds_a_whole_cascade(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "branch"
    wanted = ["continue", "table-4.2", "--row", "epsilon", "--parameter", "eps"]
    wanted += ["--to", "0.6", "--switch", "3"]
    assert main([*wanted, "-o", str(out)]) == 0
    said = capsys.readouterr().out
    for value in ("0.2582364", "0.5234473", "0.5627942", "0.5790504"):
        assert value in said
    page = (out / "branch.html").read_text(encoding="utf-8")
    assert "0.5234473" in page
    assert (out / "branch_point.csv").read_text(encoding="utf-8").startswith("period,")


def test_continue_marks_fold_and_grazing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    numbers = ["--zeta", "0.05", "--w", "0.7", "--eps", "0.1", "--fm", "0.1", "--fh", "0.05"]
    numbers += ["--start", "1.1,0", "--parameter", "w", "--to", "0.9"]
    out = tmp_path / "branch"
    assert main(["continue", *numbers, "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "0.773310335" in said
    assert "0.791736889" in said
    assert (out / "branch.html").is_file()


def test_continue_in_a_second_parameter(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Both folds are one curve that turns; stored, drawn, as CSV with the asked values."""
    numbers = ["--zeta", "0.05", "--w", "0.7", "--eps", "0.1", "--fm", "0.1", "--fh", "0.05"]
    numbers += ["--start", "1.1,0", "--parameter", "w", "--to", "0.9", "--and", "zeta=0.05:0.07:3"]
    out = tmp_path / "plane"
    assert main(["continue", *numbers, "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert len(re.findall("^ +1 fold, period 1 ", said, re.MULTILINE)) > 3
    kept = open_results(out)
    assert kept["curve_0"].attrs["kind"] == "fold"
    asked = kept["curve_0"]["second"].values[kept["curve_0"]["asked"].values == 1]
    assert np.isin([0.05, 0.06], asked.round(12)).all()
    rows = (out / "plane_point.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("kind,period,first [1],second [1]")
    assert (out / "branch.html").read_text(encoding="utf-8").count("<figure") == 2


def test_symbols_of_a_branch_are_drawn_not_spelt_as_tags(tmp_path: Path) -> None:
    out = tmp_path / "branch"
    wanted = ["continue", "table-4.2", "--row", "omega", "--parameter", "w", "--to", "1.25"]
    assert main([*wanted, "-o", str(out)]) == 0
    page = (out / "branch.html").read_text(encoding="utf-8")
    assert "ω<sub>h</sub>" in page
    assert "&lt;" not in page


def test_ctrl_c_keeps_what_is_done(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from thermogear.study import orbit as engine

    called = 0
    real = engine.lyapunov_exponents

    def tired(*arguments: Any, **options: Any) -> Any:
        nonlocal called
        called += 1
        if called == 3:
            raise KeyboardInterrupt
        return real(*arguments, **options)

    monkeypatch.setattr(engine, "lyapunov_exponents", tired)
    out = tmp_path / "kept"
    arguments = ["lyapunov", *NUMBERS, "--batches", "20", "--batch-periods", "50", "-o", str(out)]
    assert main(arguments) == 130
    said = capsys.readouterr()
    assert re.search("batches +4 of 50 periods", said.out)
    last = said.err.strip().splitlines()[-1]
    assert last == f"interrupted: stopped on request; what was found so far stays in {out}"
    assert (out / "lyapunov.html").is_file()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["orbit"], "--zeta: got nothing"),
        (["orbit", *NUMBERS, "--start", "1"], "--start: got '1'; allowed two numbers X,V"),
        (["orbit", *NUMBERS, "--period", "0"], "period: got 0; allowed a whole number >= 1"),
        (["orbit", "--zeta", "-1", *NUMBERS[2:]], "damping_ratio: got -1; allowed 0..1000"),
        (["orbit", "nowhere.toml"], "nowhere.toml: got no such file"),
        (["orbit", "rig", "--state", "warm"], "--state: got 'warm'; allowed undeformed | hot"),
        (["lyapunov", *NUMBERS, "--batches", "1"], "--batches: got 1; allowed 4..100000"),
        (["continue", *NUMBERS], "--parameter: got nothing"),
        (["continue", *NUMBERS, "--parameter", "zeta"], "--to: got nothing"),
        (
            ["continue", *NUMBERS, "--parameter", "zetta", "--to", "1"],
            "--parameter: got 'zetta'",
        ),
        (["continue", *NUMBERS, "--parameter", "zeta", "--to", "x"], "--to: got 'x'"),
        (
            ["continue", *NUMBERS, "--parameter", "zeta", "--to", "0.1", "--switch", "9"],
            "--switch: got 9; allowed 0..6",
        ),
        (["orbit", *NUMBERS, "--row", "zeta"], "--row: got zeta; no case is named"),
        (["orbit", *NUMBERS, "--state", "hot"], "--state: got hot; no case is named"),
        (["orbit", "rig", "--point", "2"], "--point: got 2; a gear case has no rows"),
        (
            ["orbit", "table-4.2", "--bundle", "thesis"],
            "--bundle: got thesis; a dimensionless case has no gears",
        ),
        (["report", "somewhere", "--kind", "svg"], "--kind: got svg; no picture is saved"),
        (["compare", "rig", "thesis-5.2", "--samples", "3"], "--samples: got 3; beside no"),
        (["compare", "rig", "thesis-5.2", "--rate", "3"], "--rate: got 3.0; there is no record"),
        (
            ["compare", "thesis-5.2", "--tolerance", "torque=5"],
            "tolerances: got torque; stored lines are not computed anew",
        ),
        (["continue", "rig", "--rigid"], "--rigid: got without shafts; CASE has no [[shafts]]"),
        (["continue", "rig", "--coordinates", "30"], "--coordinates: got 30; CASE has no"),
        (
            ["continue", "motor-train", "--rigid", "--values", "9"],
            "--values: got 9; --rigid leaves the shafts out",
        ),
        (
            ["continue", *NUMBERS, "--parameter", "w", "--to", "1", "--and", "w=1:2:3"],
            "--and: got 'w=1:2:3'; it is --parameter",
        ),
        (
            ["continue", *NUMBERS, "--parameter", "w", "--to", "1", "--and", "zeta"],
            "--and: got 'zeta'; allowed NAME=FROM:TO:COUNT",
        ),
        (
            ["continue", *NUMBERS, "--parameter", "w", "--to", "1", "--and", "zeta=0.1:0.2:1"],
            "--and: got 'zeta=0.1:0.2:1'; allowed two values or more",
        ),
        (
            ["continue", "rig", "--parameter", "speed", "--to", "4000"],
            "--to: got '4000'; allowed 0.1..500000 rpm; the unit is missing",
        ),
    ],
)
def test_errors_are_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.strip().splitlines()
    assert lines[-1].startswith("error: ")
    assert message in lines[-1]


def test_a_foreign_directory_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "holiday.jpg").write_bytes(b"x")
    assert main(["orbit", *NUMBERS, "-o", str(tmp_path)]) == 2
    assert "files that are not results of thermogear" in capsys.readouterr().err
