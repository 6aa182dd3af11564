"""The page on data: its commands run, and its table is what they print."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from thermogear.front import cli

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "data.md"


@pytest.mark.slow
def test_the_commands_and_the_table_of_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Smaller: the first two values of each axis, whose rows must be those of the page."""
    monkeypatch.chdir(tmp_path)
    text = PAGE.read_text("utf-8")
    blocks = dict(re.findall(r"```(sh|py|text)\n(.*?)```", text, re.DOTALL))
    step = 40.0 + 80.0 / 19.0
    small = blocks["sh"].replace("torque=20:80:20", "torque=20:80:2")
    small = small.replace("temperature=40:120:20", f"temperature=40:{step}:2")
    for line in small.strip().splitlines():
        assert cli.main(shlex.split(line)[1:]) == 0
    capsys.readouterr()
    names: dict[str, object] = {}
    exec(compile(blocks["py"], str(PAGE), "exec"), names)
    printed = capsys.readouterr().out.splitlines()
    table = blocks["text"].splitlines()
    assert printed[0].split() == table[0].split()
    for mine, told in zip(printed[1:3], table[1:3], strict=True):
        one, other = mine.split(), told.split()
        assert one[3] == other[3]
        numbers = [i for i in range(8) if i != 3]
        assert [float(one[i]) for i in numbers] == [float(other[i]) for i in numbers]
    rows = Path("loads.csv").read_text("utf-8").splitlines()
    assert len(rows) == 1 + 4
    assert all(line.count(",") == rows[0].count(",") for line in rows)
