"""Options a person gets wrong: one line, exit code 2, and nothing begun with the wrong value."""

import math

import pytest

from thermogear.front.cli import main

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
        ("sensitivity rig --speed -100", "--speed: got -100 rpm; allowed > 0"),
        ("compare thesis-5.2 --u-data -1", "u_data: got -1 %; allowed >= 0 %"),
        ("measure .", "file: got .; it is a directory"),
        ("measure record.csv --speed -10", "--speed: got -10 rpm; allowed > 0 rpm"),
        ("measure record.csv -o file", "output: got file; it is a file"),
        ("relief rig -o out --torque 1e9", "--torque: got 1e+09; allowed > 0, below 1e9"),
        ("relief rig -o out --temperature 1000", "--temperature: got 1000 degC; allowed -150..600"),
        ("runup rig -o out --hot 2000", "hot: got 2000 degC; allowed -150..600 degC"),
        (f"{SWEEP}", "temperature: got 20 .. 900 degC; allowed -150..600 degC"),
        ("sweep rig --over rpm=1000:2000:3 --state 5000 -o out", "state: got 5000 degC"),
        ("sweep rig --over rpm=1000:2000:3 --state warm -o out", "state: got 'warm'"),
        ("bifurcation table-4.2 --over zeta=-0.1:0.2:3 -o out", "damping_ratio: got -0.1"),
        (
            "bifurcation table-4.2 --over zeta=0.1:0.2:2 --scheduler nowhere -o out",
            "scheduler: got nowhere; allowed tcp://HOST:PORT; the port is missing",
        ),
        ("check case.json", "a case file is TOML"),
        ("check open.toml", "a text ends with the quote it began with"),
    ],
)
def test_wrong_word_is_one_line(words, said, capsys):
    assert main(words.split()) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_refused_axis_leaves_the_directory_free(tmp_path):
    assert main(["bifurcation", "table-4.2", "--over", "zeta=-0.1:0.2:3", "-o", "out"]) == 2
    assert not (tmp_path / "out").exists()
