"""Several records: what changed beyond its uncertainty, trends, refusals; through the command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from click.testing import CliRunner

from thermogear.front.measure_commands import measure

RATE = 5120.0


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


def test_one_record_has_no_baseline(tmp_path: Path) -> None:
    write(tmp_path / "a.csv", 1.0, 1)
    done = CliRunner().invoke(measure, [str(tmp_path / "a.csv"), "--baseline", "first"])
    assert done.exit_code != 0
    assert "there is one record" in str(done.exception)
