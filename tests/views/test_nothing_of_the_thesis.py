"""What anybody's pair is told, by any command: no word of the thesis without its bundle."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from in_words import in_words
from own_pair import OWN_PAIR
from thermogear.front.cli import main
from thermogear.gears.relief import optimise_tip_relief
from thermogear.study import relief

pytestmark = [
    pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning"),
    pytest.mark.usefixtures("warmed_once"),
]
FIVE = """[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 40
[operating]
speed = "3000 rpm"
torque = "80 N m"
[flanks]
parts = 16
"""
SMALL = """[grid]
path_positions = 41
mesh_positions = 48
harmonics = 12
[simulation]
periods = 16
samples = 32
discard = 100
"""
PAIRS = {"own": OWN_PAIR + SMALL, "five": FIVE + SMALL}
# words after the case; {out}: a folder of its own
COMMANDS: dict[str, tuple[str, ...]] = {
    "check": (),
    "answers": ("-o", "{out}"),
    "run": ("-o", "{out}"),
    "run all": ("-o", "{out}", "--pictures", "all"),
    "friction": ("-o", "{out}"),
    "sensitivity": ("-o", "{out}", "--samples", "8"),
    "temperature": ("-o", "{out}", "--speeds", "1000,3000", "--torques", "80"),
    "warmup": ("-o", "{out}"),
    "relief": ("-o", "{out}"),
    "contact": ("-o", "{out}"),
    "orbit": ("-o", "{out}"),
    "lyapunov": (),
    "continue": ("-o", "{out}", "--parameter", "speed", "--to", "3100 rpm"),
    "bifurcation": ("-o", "{out}", "--over", "zeta=0.1:0.2:3"),
    "map": ("-o", "{out}", "--over", "zeta=0.1:0.2:3", "--over", "omega=1:2:3"),
    "basins": ("-o", "{out}"),
    "runup": ("-o", "{out}", "--rpm", "2900:3100:3", "--branch-period", "0"),
    "sweep": ("-o", "{out}", "--over", "rpm=2900:3100:3"),
    "versus": ("-o", "{out}"),
}
TEXTS = {".html", ".json", ".csv", ".svg", ".txt", ".md", ".toml"}


@pytest.fixture(autouse=True)
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """A relief is searched for a while only: its words are the same."""
    monkeypatch.setattr(relief, "optimise_tip_relief", partial(optimise_tip_relief, evaluations=40))


@pytest.fixture(autouse=True, scope="module")
def _told() -> Iterator[None]:
    """Pictures are asked for their words, which are the same whether they are drawn or not."""
    with in_words():
        yield


def said(command: str, case: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, str]:
    """Everything that a command shows, by where it stands."""
    words = [word.format(out=out) for word in COMMANDS[command]]
    cases = [str(case), str(case)] if command == "versus" else [str(case)]
    code = main([command.split()[0], *cases, *words])
    shown = capsys.readouterr()
    assert code == 0, shown.err
    found = {"terminal": shown.out + shown.err}
    for path in sorted(out.rglob("*")) if out.exists() else ():
        if path.suffix in TEXTS:
            found[path.name] = path.read_text(encoding="utf-8")
    return found


def places(found: dict[str, str]) -> list[str]:
    return [
        f"{name}: ...{text[max(one.start() - 60, 0) : one.end() + 60]!r}"
        for name, text in found.items()
        for one in re.finditer("thesis", text, re.IGNORECASE)
    ]


LONG = ("run all", "versus", "relief", "warmup", "continue")
ASKED = [
    pytest.param(command, "five", marks=[pytest.mark.slow] * (command in LONG))
    for command in COMMANDS
    if command != "run"  # all pictures hold the few of a run
] + [(command, "own") for command in ("check", "answers", "run")]


@pytest.mark.parametrize(("command", "pair"), ASKED)
def test_a_command_speaks_of_this_pair_alone(
    command: str, pair: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = tmp_path / "pair.toml"
    case.write_text(PAIRS[pair], encoding="utf-8")
    found = said(command, case, tmp_path / "out", capsys)
    assert found["terminal"].strip()
    assert places(found) == []


def test_a_chosen_bundle_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = tmp_path / "pair.toml"
    case.write_text(PAIRS["own"].replace('"consistent"', '"thesis"'), encoding="utf-8")
    assert places(said("answers", case, tmp_path / "out", capsys))
