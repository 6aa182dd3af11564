"""Several records: what changed beyond its uncertainty, trends, refusals; through the command."""

from __future__ import annotations

import json
import os
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from thermogear.base.errors import InputError
from thermogear.front.measure_commands import measure
from thermogear.front.measuring import measured_among
from thermogear.measured import at_once
from thermogear.measured.at_once import rows_of
from thermogear.measured.reduction import Measurement

RATE = 5120.0
WORDS = (
    "rate", "unit", "scale", "teeth", "speed", "tacho", "tacho_scale", "pulses", "harmonics",
    "sidebands", "decimal", "limit", "sensor_tolerance",
)  # fmt: skip


def write(path: Path, size: float, seed: int) -> None:
    t = np.arange(8000) / RATE
    random = np.random.default_rng(seed)
    x = size * np.cos(2 * np.pi * 400 * t) + 0.5 * np.cos(2 * np.pi * 800 * t + 1)
    x += 0.3 * np.cos(2 * np.pi * 1200 * t) + 0.05 * random.standard_normal(t.size)
    np.savetxt(path, np.column_stack([t, x]), "%.7g", ",", header="time [s],acc [g]", comments="")


def test_a_line_that_grew_is_named_and_the_others_are_not(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    folder.mkdir()
    for number, size in enumerate([1.0, 1.0, 1.05, 1.1, 1.2]):
        write(folder / f"r{number}.csv", size, number)
    (folder / "notes.txt").write_text("no numbers here\n", encoding="utf-8")
    words = [str(folder), "--teeth", "20", "--sidebands", "0", "--baseline", "first", "--json"]
    done = CliRunner().invoke(measure, [*words, "-o", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found["baseline"] == "r0.csv"
    assert [name for name, _ in found["refused"]] == ["notes.txt"]
    changed = {(one["record"], one["name"]): one["change"] for one in found["changed"]}
    for record, size in (("r2.csv", 0.05), ("r3.csv", 0.1), ("r4.csv", 0.2)):
        assert abs(changed[record, "mesh x 1"] - size) < 0.01
    assert ("r1.csv", "mesh x 1") not in changed
    (trend,) = [one for one in found["trends"] if one["name"] == "mesh x 1"]
    assert trend["trend"] > 0.02
    assert (tmp_path / "out" / "records.html").is_file()


def test_damage_of_one_of_several_records_is_told(tmp_path: Path) -> None:
    """Clipped readings are withheld and say so; spikes are a finding; what is whole is compared."""
    for number in range(4):
        write(tmp_path / f"r{number}.csv", 1.0, number)
    table = np.loadtxt(tmp_path / "r1.csv", delimiter=",", skiprows=1)
    table[:, 1] = np.clip(table[:, 1], -0.8, 0.8)
    np.savetxt(tmp_path / "r1.csv", table, "%.7g", ",", header="time [s],acc [g]", comments="")
    table = np.loadtxt(tmp_path / "r2.csv", delimiter=",", skiprows=1)
    table[[1000, 4000, 6000], 1] = 40.0
    np.savetxt(tmp_path / "r2.csv", table, "%.7g", ",", header="time [s],acc [g]", comments="")
    done = CliRunner().invoke(measure, [str(tmp_path), "--teeth", "20", "--sidebands", "0"])
    assert done.exit_code == 0, done.output
    told = [line for line in done.output.splitlines() if line.startswith(("important", "warning"))]
    assert [("r1.csv" in line, "r2.csv" in line) for line in told] == [(True, False), (False, True)]
    words = [str(tmp_path), "--teeth", "20", "--sidebands", "0", "--json"]
    found = json.loads(CliRunner().invoke(measure, words).stdout)
    assert [name for name, _ in found["withheld"]] == ["r1.csv"]
    assert [name for name, _ in found["findings"]] == ["r1.csv", "r2.csv"]
    assert found["compared"] == 6
    for name in ("r0.csv", "r2.csv", "r3.csv"):
        (tmp_path / name).unlink()
    write(tmp_path / "r3.csv", 1.0, 3)
    done = CliRunner().invoke(measure, [str(tmp_path), "--teeth", "20", "--sidebands", "0"])
    assert "clipping" in str(done.exception)  # of the baseline: why nothing can be compared


def test_one_record_has_no_baseline(tmp_path: Path) -> None:
    write(tmp_path / "a.csv", 1.0, 1)
    done = CliRunner().invoke(measure, [str(tmp_path / "a.csv"), "--baseline", "first"])
    assert done.exit_code != 0
    assert "there is one record" in str(done.exception)


@pytest.mark.slow
def test_processes_give_the_same_rows_and_one_that_ends_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = [tmp_path / f"r{number}.csv" for number in range(3)]
    for number, file in enumerate(files):
        write(file, 1.0, number)
    files[1].write_text("nothing\n", encoding="utf-8")
    options = dict.fromkeys(WORDS) | {"channels": (), "orders": (), "method": "line"}
    read = partial(measured_among, options=options)
    told: list[tuple[int, int]] = []
    serial = rows_of(read, files, cores=1, progress=lambda _, done, total: None)
    monkeypatch.setattr(at_once, "_WORTH", 0.0)
    both = rows_of(read, files, cores=2, progress=lambda _, done, total: told.append((done, total)))
    assert both == serial
    assert told == [(1, 3), (2, 3), (3, 3)]
    assert [bool(row.refused) for row in both] == [False, True, False]
    ended = rows_of(ends, files, cores=2, progress=lambda _, done, total: None)
    assert "the process that read it ended" in ended[1].refused
    assert ended[2].refused == "file: got r2.csv; refused"


def ends(path: Path) -> Measurement:
    """Refuses, and ends the process for r1."""
    if path.name == "r1.csv":
        os._exit(1)
    raise InputError("file", path.name, why="refused")
