"""``thermogear new --shafts``: two shafts and four bearings of a size that fits."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from thermogear.case.case import gear_case, load_case
from thermogear.case.new import NewCase
from thermogear.front.cli import main

PAIR = ["new", "--teeth", "20", "40", "--module", "3 mm", "--face-width", "30 mm"]


def new(*more: str) -> int:
    return main([*PAIR, "--speed", "3000 rpm", *more])


def test_ten_more_lines_and_bearings_that_fit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plain, mine = tmp_path / "plain.toml", tmp_path / "mine.toml"
    assert new("--torque", "80 N m", "-o", str(plain)) == 0
    assert new("--torque", "80 N m", "--shafts", "-o", str(mine)) == 0
    assert capsys.readouterr().err == ""
    more = mine.read_text().removeprefix(plain.read_text())
    assert len(more.splitlines()) <= 10
    train = gear_case(load_case(mine)).train
    assert train is not None
    assert len(train.bearings) == 4
    assert not list(train.misfits())


@pytest.mark.parametrize("torque", [2.0, 20.0, 80.0, 160.0])
def test_the_shaft_carries_its_torque(torque: float) -> None:
    text = NewCase(
        teeth=(25, 50),
        module="3 mm",
        face_width="30 mm",
        speed="1500 rpm",
        torque=f"{torque} N m",
        shafts=True,
    ).text()
    case = gear_case(load_case(text))
    assert case.train is not None
    for shaft, ratio in zip(case.train.shafts, (1.0, 2.0), strict=True):
        stress = 16.0 * torque * ratio / (math.pi * shaft.sections[0].outer_diameter ** 3)
        assert stress <= 40e6


@pytest.mark.parametrize(("torque", "which"), [("2000 N m", "pinion"), ("300 N m", "wheel")])
def test_no_bearing_of_the_catalogue_is_said(
    torque: str, which: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new("--torque", torque, "--shafts") == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert f"N m on the {which}'s shaft; allowed a bore of 17..40 mm" in said.err
    assert len(said.err.splitlines()) == 1
