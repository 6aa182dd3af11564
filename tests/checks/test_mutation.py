"""Mutation testing: the interval of a score, what is counted, the process that runs tests."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from scripts import ROOT, script

counts = script("mutation_counts")


@pytest.mark.parametrize(
    ("hits", "number", "low", "high"),
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611),
     (1, 29, 0.0061, 0.1718)],
)  # fmt: skip
def test_intervals_are_the_published_ones(hits: int, number: int, low: float, high: float) -> None:
    """Newcombe (1998), Statistics in Medicine 17, table I, score method."""
    assert counts.wilson(hits, number) == pytest.approx((low, high), abs=5e-5)


def test_every_judged_mutant_names_its_line_and_its_reason() -> None:
    judged = counts.tomllib.loads(counts.JUDGED.read_text(encoding="utf-8"))["judged"]
    for entry in judged:
        assert set(entry) == {"file", "before", "after", "reason"}
        source = " ".join((ROOT / entry["file"]).read_text(encoding="utf-8").split())
        assert entry["before"] in source
        assert entry["before"] != entry["after"]
        assert len(entry["reason"]) > 20


def test_a_survivor_judged_equivalent_is_not_counted() -> None:
    entry = counts.tomllib.loads(counts.JUDGED.read_text(encoding="utf-8"))["judged"][0]
    judged = {**entry, "line": 1, "outcome": "survived"}
    found = counts.counted(
        [judged, {**judged, "after": "otherwise"}, {**judged, "outcome": "timeout"}]
    )
    assert found["floors"]["all"] == {"killed": 1, "survived": 1, "equivalent": 1}
    assert [s["after"] for s in found["survivors"]] == ["otherwise"]


@pytest.mark.slow
def test_a_worker_tells_pass_failure_and_endless_from_each_other(tmp_path: Path) -> None:
    (tmp_path / "test_three.py").write_text(
        "def test_right():\n    assert 1 + 1 == 2\n"
        "def test_wrong():\n    assert 1 + 1 == 3\n"
        "def test_endless():\n    while True:\n        pass\n"
        "def test_crash():\n    import os\n    os.kill(os.getpid(), 11)\n",
        encoding="utf-8",
    )
    jobs = [("right", 60), ("wrong", 60), ("endless", 1), ("crash", 60), ("absent", 60)]
    lines = [
        json.dumps({"tests": [f"test_three.py::test_{name}"], "timeout": limit, "cold": True})
        for name, limit in jobs
    ]
    done = subprocess.run(
        [sys.executable, ROOT / "checks" / "mutant_worker.py"],
        cwd=tmp_path, input="\n".join(lines), capture_output=True, text=True, check=True,
    )  # fmt: skip
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    assert [a["outcome"] for a in answers[:4]] == ["survived", "killed", "timeout", "killed"]
    assert answers[1]["by"].endswith("test_three.py::test_wrong")
