"""friction, temperature, relief, contact: files on disk, figures as JSON, one-line errors."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray as xr

from thermogear.base.errors import InputError
from thermogear.case.examples import example_text
from thermogear.front.cli import cli, main
from thermogear.results.files import MARK, claimed, is_ours
from thermogear.views.write import write_report as write_survey

SMALL = ["--set", "grid.path_positions=41", "--set", 'operating.speed="2000 rpm"']
EXTRA = {
    "friction": [],
    "temperature": ["--speeds", "1000,2000,6000", "--torques", "50:250:3"],
    "warmup": [],
    "relief": ["--symmetric", "--shape", "parabolic"],
    "contact": ["--torques", "20,100"],
}


DUTY = "time [min],speed [rpm],torque [N m]\n0,2000,100\n2,0,0\n3,0,0\n"
RECORD = "time [min],pinion_tooth [degC],thermocouple [degC]\n0.5,23,\n1.5,26,25.4\n2.5,25,25\n"


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("case") / "rig.toml"
    path.write_text(example_text("rig"), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "command", [pytest.param(c, marks=pytest.mark.slow) if c == "temperature" else c for c in EXTRA]
)
def test_a_survey_leaves_data_page_pictures_and_curves(
    command: str, rig: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    extra = list(EXTRA[command])
    if command == "warmup":
        for option, text in (("--duty", DUTY), ("--measured", RECORD)):
            path = tmp_path / f"{option[2:]}.csv"
            path.write_text(text, encoding="utf-8")
            extra += [option, str(path)]
    code = main([command, str(rig), "-o", str(out), "--json", *SMALL, *extra])
    shown = capsys.readouterr()
    assert (code, shown.err) == (0, "")
    told = json.loads(shown.out)
    assert told["notices"]
    names = {path.name for path in out.iterdir()}
    assert {f"{command}.nc", f"{command}.html", MARK} <= names
    assert any(n.endswith(".svg") for n in names)
    assert any(n.endswith(".png") for n in names)
    tables = list(out.glob("*.csv"))
    assert tables
    for table in tables:
        lines = table.read_text(encoding="utf-8").splitlines()
        assert len(lines) > 1
        assert len({line.count(",") for line in lines}) == 1
    text = (out / f"{command}.html").read_text(encoding="utf-8")
    page = ElementTree.fromstring(text.removeprefix("<!DOCTYPE html>").strip())
    assert "http" not in text.replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")
    ids = [e.get("id") for e in page.iter() if e.get("id")]
    assert len(ids) == len(set(ids))
    # the page is drawn from the stored file alone, and the same again
    (out / f"{command}.html").unlink()
    assert write_survey(out, command).read_text(encoding="utf-8") == text
    with xr.open_datatree(out / f"{command}.nc", engine="h5netcdf") as tree:
        for node in tree.subtree:
            for name, values in node.data_vars.items():
                assert values.attrs.get("long_name"), f"{node.path}/{name}"


@pytest.mark.slow
def test_json_figures_of_the_map_are_those_of_its_grid(
    rig: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["--own", "--set", 'operating.torque=["50 N m", "150 N m"]']
    assert main(["temperature", str(rig), "-o", str(tmp_path), "--json", *SMALL, *arguments]) == 0
    told = json.loads(capsys.readouterr().out)
    np.testing.assert_allclose(told["pinion_speed_rpm"], [2000.0])
    assert told["pinion_torque_Nm"] == [50.0, 150.0]
    assert np.shape(told["oil_K"]) == (1, 2)


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ["temperature", "--speeds", "fast"],
            "--speeds: got 'fast'; allowed numbers with commas between; write 500,1000,2000",
        ),
        (["temperature", "--speeds", "-500,500"], "--speeds: got -500; allowed > 0, below 1e9"),
        (
            ["temperature", "--torques", "200,100"],
            "--torques: got '200,100'; allowed strictly rising values",
        ),
        (
            ["temperature", "--torques", "50:100:1"],
            "--torques: got '50:100:1'; allowed FROM:TO:COUNT, COUNT 2..100000; write 500:6000:12",
        ),
        (
            ["temperature", "--torques", "5:100:nan"],
            "--torques: got '5:100:nan'; allowed FROM:TO:COUNT, COUNT 2..100000; write 500:6000:12",
        ),
        (
            ["temperature", "--torques", "1,2:3"],
            "--torques: got '1,2:3'; allowed FROM:TO:COUNT, COUNT 2..100000; write 500:6000:12",
        ),
        (
            ["temperature", "--own", "--speeds", "500"],
            "--own: got speeds or torques beside it; leave one out",
        ),
        (["temperature", "--warm-up", "500,50"], "No such option '--warm-up'"),
        (["warmup", "--at", "500"], "--at: got '500'; allowed RPM,NM; write 2000,150"),
        (["warmup", "--at", "500,1e6"], "--at: got 1e+06 N m; allowed 0..1.045e+04 N m"),
        (["warmup", "--at", "-500,10"], "--at: got -52.3599 rad/s (-500 rpm); allowed 0..500000"),
        (["warmup", "--start", "-300"], "--start: got -300 degC; allowed -70..600"),
        (["warmup", "--duty", "none.csv"], "--duty: got none.csv; there is no such file"),
        (["warmup", "--duty", "a", "--at", "1,1"], "--at: got an operating point beside --duty"),
        (["warmup", "--measured", "none.csv"], "--measured: got none.csv; there is no such file"),
        (["relief", "--torque", "0"], "--torque: got 0 N m; allowed > 0 N m"),
        (["relief", "--torque", "nan"], "--torque: got nan N m; allowed 0..1e7 N m"),
        (["relief", "--temperature", "-300"], "--temperature: got -300 degC; allowed -70..600"),
        (["contact", "--torques", ""], "--torques: got ''; allowed numbers with commas between"),
        (
            ["friction", "--set", 'gears.pinion.tip_relief={amount="9 um", length="30 mm"}'],
            "gears.pinion.tip_relief.length: got 30 mm; allowed <= 25.3061 mm; the tip relief is "
            "longer than the active profile",
        ),
    ],
)
def test_what_is_wrong_is_one_line_and_nothing_is_written(
    arguments: list[str],
    line: str,
    rig: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / "out"
    command, *rest = arguments
    assert main([command, str(rig), "-o", str(out), *rest]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith(f"error: {line}")
    assert shown.err.count("\n") == 1
    assert not out.exists()


def test_a_dimensionless_case_has_no_gears(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "rows.toml"
    path.write_text(example_text("table-4.2"), encoding="utf-8")
    assert main(["friction", str(path), "-o", str(tmp_path / "out")]) == 2
    assert "allowed kind = 'gear'; there is no gear in it" in capsys.readouterr().err


def test_what_an_interrupted_run_leaves_is_still_ours(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with claimed(out) as folder:
        assert (out / MARK).is_file()
        (folder / "results.nc").write_bytes(b"half a file")
        folder.rename(out / ".thermogear-1-1.part")  # what a kill leaves
        folder.mkdir()
    with claimed(out):
        pass
    assert is_ours(out)
    assert sorted(path.name for path in out.iterdir()) == [MARK, "lock"]
    foreign = tmp_path / "foreign"
    foreign.mkdir()
    (foreign / "letter.txt").write_text("mine", encoding="utf-8")
    assert not is_ours(foreign)
    with pytest.raises(InputError, match="not results of thermogear"), claimed(foreign):
        pass
    assert [path.name for path in foreign.iterdir()] == ["letter.txt"]


def test_a_damaged_store_is_refused_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "friction.nc").write_bytes(b"\x89HDF nothing")
    with pytest.raises(InputError, match="it cannot be read as netCDF; it is damaged"):
        write_survey(tmp_path, "friction")
    with pytest.raises(InputError, match="there is no such file"):
        write_survey(tmp_path, "relief")


def test_every_installed_list_is_registered_and_help_stays_light() -> None:
    assert {"run", "friction", "temperature", "relief", "contact"} <= set(cli.commands)
    code = (
        "import sys; from thermogear.front.cli import main; main(['temperature', '--help']);"
        "print([m for m in ('numpy', 'xarray', 'matplotlib', 'scipy') if m in sys.modules],"
        " file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"
