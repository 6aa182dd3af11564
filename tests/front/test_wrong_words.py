"""Options a person gets wrong: one line, exit code 2, and nothing begun with the wrong value."""

import math
import re
import shlex
from pathlib import Path

import pytest

from thermogear.front.cli import main

ZERO = "the mesh stiffness 1 + eps cos would reach zero"
SWEEP = "sweep rig --over temperature=20:900:3 -o out"


@pytest.fixture(autouse=True)
def _here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("x")
    lines = (f"{i / 25600:.7f},{math.sin(0.1 * i):.6f}" for i in range(2560))
    (tmp_path / "record.csv").write_text("time [s],acc [g]\n" + "\n".join(lines) + "\n")
    (tmp_path / "case.json").write_text('{"gears": 1}')
    (tmp_path / "open.toml").write_text('title = "no end\nkind = "gear"\n')


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("sensitivity rig --seed -1", "seed: got -1; allowed 0..4294967295"),
        ("sensitivity rig --speed -100", "--speed: got -10.472 rad/s (-100 rpm); allowed 0..500"),
        ("compare thesis-5.2 --u-data -1", "u_data: got -1 %; allowed 0..1000 %"),
        ("measure record.csv --speed -10", "--speed: got -10 rpm; allowed > 0 .. 500000 rpm"),
        ("measure record.csv -o file", "output: got file; it is a file"),
        ("relief rig -o out --torque 1e9", "--torque: got 1e+09 N m; allowed 0..1e7 N m"),
        ("relief rig -o out --torque 0", "--torque: got 0 N m; allowed > 0 N m"),
        ("relief rig -o out --largest 2000", "--largest: got 0.002 m (2000 um); allowed 0..1000"),
        ("temperature rig -o out --torques 1e8", "--torques: got 1e+08 N m; allowed 0..1e7 N m"),
        ("contact rig -o out --torques 1e8", "--torques: got 1e+08 N m; allowed 0..1e7 N m"),
        ("warmup rig -o out --duty ''", "--duty: got ''; allowed the name of a file"),
        ("warmup rig -o out --measured ' '", "--measured: got ' '; allowed the name of a file"),
        ("relief rig -o out --temperature 1000", "--temperature: got 1000 degC; allowed -70..600"),
        ("runup rig -o out --hot 2000", "hot: got 2000 degC; allowed -70..600 degC"),
        (f"{SWEEP}", "gear_temperature: got 900 degC; allowed -70..600 degC"),
        ("sweep rig --over rpm=1000:2000:3 --state 5000 -o out", "state: got 5000 degC"),
        ("sweep rig --over rpm=1000:2000:3 --state warm -o out", "state: got 'warm'"),
        ("bifurcation table-4.2 --over zeta=-0.1:0.2:3 -o out", "damping_ratio: got -0.1"),
        ("check case.json", "a case file is TOML"),
        ("relief rig -o out --temperature -140", "--temperature: got -140 degC; allowed -70..600"),
        # numbers of the dimensionless equation: the stiffness 1 + eps_T + eps cos stays positive
        ("check table-4.2 --set base.stiffness_amplitude=1", f"got 1; allowed 0..0.999; {ZERO}"),
        ("check table-4.2 --set rows.epsilon.values=[1.2]", f"got 1.2; allowed 0..0.999; {ZERO}"),
        (
            "check table-4.2 --set base.thermal_stiffness=-0.8",
            "got 0.335; allowed < 0.2 (1 + eps_T); the mesh stiffness",
        ),
        ("basins table-4.2 --but eps=1.2 -o out", f"eps: got 1.2; allowed 0..0.999; {ZERO}"),
        ("basins table-4.2 --but zeta=-1 -o out", "zeta: got -1; allowed 0..1000"),
        ("basins table-4.2 --but eps=0.1 --but epsilon=0.2 -o out", "stiffness_amplitude twice"),
        ("bifurcation table-4.2 --over eps=0.1:1.2:3 -o out", f"allowed 0..0.999; {ZERO}"),
        (
            "map table-4.2 --over eps=0.1:0.95:3 --over eps_T=-0.1:0:3 -o out",
            "stiffness_amplitude: got 0.95; allowed < 0.9 (1 + eps_T)",
        ),
        ("orbit table-4.2 --eps 1.2 -o out", f"got 1.2; allowed 0..0.999; {ZERO}"),
        # a continuation refuses its end before it walks
        ("continue table-4.2 --parameter zeta --to -1 -o out", "--to: got -1; allowed 0..1000"),
        ("continue table-4.2 --parameter zeta --to 0.1 --from -1", "--from: got -1; allowed 0.."),
        ("continue table-4.2 --parameter eps --to 1.5", f"got 1.5; allowed 0..0.999; {ZERO}"),
        ("continue table-4.2 --parameter eps-t --to -0.8", "got 0.335; allowed < 0.2 (1 + eps_T)"),
        ("continue rig --parameter torque --to '-3 N m'", "--to: got '-3 N m'; allowed 0..1e7 N m"),
        ("continue rig --parameter temperature --to '140 K'", 'did you mean "140 degC"?'),
        # operating points and axes of gears
        ("runup rig --torque -3 -o out", "pinion_torque: got -3 N m; allowed 0..1e7 N m"),
        ("runup rig --torque 1e9 -o out", "pinion_torque: got 1e+09 N m; allowed 0..1e7 N m"),
        ("sweep rig --over torque=-3:10:3 -o out", "pinion_torque: got -3 N m; allowed 0..1e7 N m"),
        ("sweep rig --over torque=1:2:2 --over pinion_torque=3:4:2 -o out", "pinion_torque twice"),
        ("map table-4.2 --over eps=0.1:0.2:2 --over epsilon=0.3:0.4:2 -o out", "amplitude twice"),
        (
            "sweep rig --over gears.pinion.face_width=20:30:3 -o out",
            "gears.pinion.face_width: got 20; allowed 0.01..10000 mm; the unit is missing; "
            "write it at every value: gears.pinion.face_width=20 mm:TO mm:COUNT",
        ),
        ("sweep rig --over 'gears.pinion.face_width=20 kg:30 kg:3' -o out", "no unit of length"),
        ("sweep rig --over gears.pinion.teeth=20:25:5 -o out", "got 21.25; allowed 5..2000, whole"),
        (
            "sweep rig --over gears.pinion.teeth=10:25:4 -o out",
            "got a radius of 67.5 mm; allowed < 31.7737 mm",
        ),
        ("sweep rig --over gears.pinion.width=1:2:2 -o out", "got an unknown field"),
        ("sweep rig --over model.friction=1:2:2 -o out", "got a field of words"),
        (
            "sweep rig --over rpm=1:2 -o out",
            "allowed NAME=FROM:TO:COUNT, COUNT 1..99999999, or NAME=A,B,C",
        ),
        # places that cannot be written to, and what a file does not need
        ("run rig -o file/x", "output: got file/x; file is a file; name a directory"),
        ("runup rig -o file/x", "store: got file/x; file is a file; name a directory"),
        ("thesis -o file/x", "output: got file/x; file is a file; name a directory"),
        ("thesis rig -o out", "Got unexpected extra argument (rig)"),
        (
            "bifurcation rig --over zeta=.02:.1:5 -o out --branch-perod 0",
            "No such option '--branch-perod'. Did you mean '--branch-period'?",
        ),
        ("measure record.csv -o file/x", "output: got file/x; file is a file; name a directory"),
        (
            "measure record.csv --pulses 0",
            "pulses_per_turn: got 0 pulses per turn; allowed 1e-6..1e7",
        ),
        ("check open.toml", "a text ends with the quote it began with"),
    ],
)
def test_wrong_word_is_one_line(words, said, capsys):
    assert main(shlex.split(words)) == 2
    assert not Path("out").exists()
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    "words",
    [
        "check rig --set 'operating.torque=1e6 N m'",
        "runup rig --torque 1e6 --estimate -o out",
        "sweep rig --over torque=100,1e6 --estimate -o out",
    ],
)
def test_a_torque_that_crushes_any_steel_is_warned_of(words, capsys):
    """p_0 at the pitch point grows as the root of the torque: the limit named lies at 4 GPa."""
    assert main(shlex.split(words)) == 0
    (warning,) = [x for x in capsys.readouterr().err.splitlines() if x.startswith("warning: ")]
    found = re.search(r"got 1e\+06 N m; valid 0\.\.(\S+) N m; (\S+) GPa", warning)
    assert found
    most, pressure = map(float, found.groups())
    assert pressure / 4.0 == pytest.approx((1e6 / most) ** 0.5, rel=5e-3)


def test_pictures_that_cannot_be_written_are_refused_first(capsys):
    assert main(["run", "section-4.1", "--set", "simulation.periods=8", "--set",
                 "simulation.discard=8", "-o", "rows"]) == 0  # fmt: skip
    capsys.readouterr()
    assert main(["report", "rows", "--pictures", "file"]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err == "error: pictures: got file; it is a file; name a directory\n"
