"""The five tasks of the how-to, each from a clean directory: two commands, answers printed."""

from __future__ import annotations

import re
import shlex
from functools import cache
from pathlib import Path

import pytest

from thermogear.front.cli import main

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "five_tasks.md"
BLOCKS = re.compile(r"^## (.+?)\n\n```sh\n(.+?)\n```\n\n```text\n(.+?)\n```", re.M | re.S)
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
SCREEN = 50
"""Lines of a terminal."""


@cache
def tasks() -> list[tuple[str, tuple[str, ...], list[str]]]:
    """(question, commands, lines of the answer)."""
    return [
        (question, tuple(commands.replace("\\\n", " ").splitlines()), answer.splitlines())
        for question, commands, answer in BLOCKS.findall(PAGE.read_text("utf-8"))
    ]


PRINTED: dict[tuple[str, ...], str] = {}
"""What commands printed; three of the tasks ask the same two."""


def printed(
    commands: tuple[str, ...], folder: Path, capsys: pytest.CaptureFixture[str]
) -> list[str]:
    if commands not in PRINTED:
        assert list(folder.iterdir()) == []
        for command in commands:
            program, *words = shlex.split(command)
            assert program == "thermogear"
            assert main(words) == 0
        PRINTED[commands] = capsys.readouterr().out
    return PRINTED[commands].splitlines()


def words_and_numbers(line: str) -> tuple[str, list[float]]:
    spread = " ".join(line.split())
    return NUMBER.sub("#", spread), [float(one) for one in NUMBER.findall(spread)]


def test_five_tasks_are_told() -> None:
    assert len(tasks()) == 5


@pytest.mark.parametrize("place", range(5))
def test_a_task_takes_two_commands_and_is_answered(
    place: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    _, commands, answer = tasks()[place]
    monkeypatch.chdir(tmp_path)
    assert len(commands) <= 2
    lines = printed(commands, tmp_path, capsys)
    assert len(lines) <= SCREEN
    shown = [words_and_numbers(line) for line in lines]
    for line in answer:
        words, numbers = words_and_numbers(line)
        (found,) = [known for said, known in shown if said == words]
        # the page tells what another machine printed, in rounded figures
        assert found == pytest.approx(numbers, rel=0.03, abs=1.0), line
