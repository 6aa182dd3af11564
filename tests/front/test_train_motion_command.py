"""A case with shafts in motion: run shows its train, waterfall runs it up and down."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from thermogear.base.display import number
from thermogear.base.plan import Stopped
from thermogear.base.units import RPM
from thermogear.case.case import GearCase, load_case
from thermogear.case.examples import example_text
from thermogear.front.cli import main
from thermogear.results.result import open_results
from thermogear.study.shafts.motion import train_motion
from thermogear.study.shafts.state import settled
from thermogear.study.shafts.waterfall import waterfall
from thermogear.views.page import lines_of, typed
from thermogear.views.pages.waterfall import jumps, numbers

HELD = """
[temperatures]
pinion_addendum = "90 degC"
pinion_bore = "80 degC"
wheel_addendum = "80 degC"
wheel_bore = "72 degC"
housing = "60 degC"
"""
CHANGES = ('operating.speed="2900 rpm"', "train.elements=6")


@pytest.fixture(scope="module")
def train(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("case") / "train.toml"
    text = example_text("motor-train")
    text = text.replace('name = "ISO VG 100"', 'name = "ISO VG 100"\ntemperature = "70 degC"')
    # nothing at shaft orders: one mesh period is one of the train
    text = text.replace('unbalance = "20 g mm"', "").replace('unbalance = "40 g mm"', "")
    path.write_text(text + HELD, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def case(train: Path) -> GearCase:
    found = load_case(train, overrides=list(CHANGES))
    assert isinstance(found, GearCase)
    return found


def test_the_train_of_a_run(case: GearCase) -> None:
    data, notices = train_motion(case)
    assert notices
    assert (data["status"].values == 0).all()
    assert {str(one) for one in data["label"].values.ravel()} == {"period-1"}
    assert (data["multiplier_modulus"].values < 1.0).all()
    rest = settled(case, [0])
    for s, row in enumerate(rest):
        loads = np.linalg.norm(row[0].rest.bearing_force, axis=1)
        mean = data["mean_bearing_force"].values[s, 0]
        # the mean of a vibrating force is near that at rest, and its peak above it
        assert np.allclose(mean, loads, rtol=0.02)
        assert (data["greatest_bearing_force"].values[s, 0] > mean).all()
    assert (data["reduction_error"].values < 0.02).all()
    lines = data["mesh_force_line"]
    half = np.isclose(data["line_order"].values % 1.0, 0.5)
    assert lines.values[..., half].max() < 1e-3 * lines.values.max()


def test_waterfall_goes_on_where_it_was_stopped(case: GearCase, tmp_path: Path) -> None:
    speeds = np.array([2300.0, 2400.0]) * RPM
    whole = waterfall(case, speeds, duration=0.1).data
    store, calls = tmp_path / "own", 0

    def killed() -> None:
        nonlocal calls
        calls += 1
        if calls > 5:
            raise Stopped

    with pytest.raises(Stopped):
        waterfall(case, speeds, duration=0.1, store=store, threads=1, alive=killed)
    other = waterfall(case, speeds, duration=0.1, store=store).data
    again = waterfall(case, speeds, duration=0.1, store=store).data
    for name in ("mesh_force_rms", "bearing_force_line", "housing_rms"):
        assert np.array_equal(whole[name], other[name])
        assert np.array_equal(again[name], other[name])
    assert np.isfinite(whole["mesh_force_rms"].values).all()
    assert whole.sizes["direction"] == 2


def test_waterfall_leaves_a_store_a_page_and_numbers(
    train: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    words = ["waterfall", str(train), "-o", str(out), "--rpm", "2300:2400:2", "--seconds", "0.1"]
    for change in CHANGES:
        words += ["--set", change]
    assert main([*words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert len(told["speeds_rpm"]) == 2
    assert told["hot"]["up"]["mesh_force_rms_N"][0] > 0.0
    result = open_results(out)
    assert result.kind == "waterfall"
    # where both ways differ a script gets numbers, and a reader the same in words
    stretch = {"from": 240.0, "to": 250.0, "at": 245.0, "up": 1234567.8, "down": 12.3456}
    plain = {"state": 0, "part": 1, "held": 1}
    both = {f"apart_{name}": ("stretch", [value]) for name, value in (stretch | plain).items()}
    data = result.data.drop_dims("stretch", errors="ignore").assign(both)
    (one,) = numbers(data)["apart"]
    assert one["from_rpm"] == pytest.approx(240.0 * 30.0 / np.pi, rel=1e-15)
    assert (one["up_rms_N"], one["down_rms_N"]) == (1234567.8, 12.3456)
    told = lines_of(jumps(data))[-1]
    assert all(typed(number(force)) in told for force in (1234567.8, 12.3456))
    assert (out / "report.html").exists()


@pytest.mark.parametrize(
    ("words", "field"),
    [
        (["rig", "--rpm", "1000:2000:2"], "shafts"),
        (["TRAIN", "--rpm", "0:2000:2"], "rpm"),
        (["TRAIN", "--rpm", "1000:2000:2", "--seconds", "-1"], "duration"),
        (["TRAIN", "--rpm", "1000:2000:2", "--operating", "9"], "operating"),
        (["TRAIN", "--rpm", "1000:2000:2", "--coordinates", "3"], "coordinates"),
    ],
)
def test_what_is_refused_in_one_line(
    words: list[str], field: str, train: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = [str(train) if word == "TRAIN" else word for word in words]
    assert main(["waterfall", *given, "-o", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert field in told
    assert len(told.strip().splitlines()) == 1
