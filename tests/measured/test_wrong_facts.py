"""Facts that are wrong by a tooth, by two or by a rate: nothing is asserted with them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.measured.parts import later
from thermogear.measured.readers import read_record
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure

RATE, TEETH, SHAFT = 12_800.0, 23, 24.9
TURN = 2.0 * np.pi


def signal() -> np.ndarray:
    """A mesh line and two harmonics that swell with their shaft, the shaft's own line, noise."""
    random = np.random.default_rng(20261128)
    turns = SHAFT * np.arange(60_000) / RATE
    swell = 1.0 + 0.2 * np.cos(TURN * turns + 1.0) + 0.1 * np.cos(TURN * 2 * turns + 2.0)
    lines = [swell / k * np.cos(TURN * k * TEETH * turns + k) for k in (1, 2, 3)]
    shaft = 0.3 * np.cos(TURN * turns)
    noise = 0.1 * random.normal(size=turns.size)
    return np.asarray(np.sum(lines, axis=0) + shaft + noise)


VALUES = signal()


def read(rate: float = RATE, **facts: float) -> Measurement:
    record = Record((Channel("a", VALUES, "g"),), "made", rate, "made")
    return measure(record, **facts)  # type: ignore[arg-type]


def test_right_facts_are_confirmed() -> None:
    found = read(teeth=TEETH, speed=TURN * SHAFT)
    assert (found.teeth, found.gearing is not None and found.gearing.confirmed) == (TEETH, True)


@pytest.mark.parametrize("teeth", [22, 24, 2 * TEETH])
def test_other_teeth_are_held_against_those_that_the_speed_names(teeth: int) -> None:
    found = read(teeth=teeth, speed=TURN * SHAFT)
    told = {one.code: one.data for one in found.notices}["teeth_contradicted"]
    assert (found.teeth, told["teeth"], told["named"]) == (None, teeth, TEETH)
    assert told["line"] == pytest.approx(TEETH * SHAFT / RATE, rel=1e-5)
    assert all(np.isnan(line.shaft_speed) for line in found.lines)


@pytest.mark.parametrize("factor", [0.5, 0.8, 2.0])
@pytest.mark.parametrize("teeth", [None, TEETH])
def test_a_wrong_rate_is_named_with_the_one_that_fits(factor: float, teeth: int | None) -> None:
    facts = {"speed": TURN * SHAFT} | ({} if teeth is None else {"teeth": teeth})
    found = read(factor * RATE, **facts)
    data = {one.code: one.data for one in found.notices}
    told = data.get("shaft_by_lines") or data["speed_contradicts_rate"]
    assert told["ratio"] == pytest.approx(factor, rel=1e-3)
    assert told["fitting"] == pytest.approx(RATE, rel=1e-3)
    assert "speed_by_rate" not in data or "speed_contradicts_rate" in data


def test_a_shafts_speed_by_its_own_line_has_that_lines_half_width() -> None:
    """The speed given alone is off by 1 %; an electric line at no whole order tells no speed."""
    time = np.arange(60_000) / RATE
    values = 0.1 * np.random.default_rng(5).normal(size=time.size)
    values += 0.5 * np.cos(TURN * SHAFT * time)
    values += np.sum([np.cos(TURN * 100.0 * k * time + k) / k for k in (1, 2, 3)], axis=0)
    record = Record((Channel("a", values, "g"),), "made", RATE, "made")
    line = measure(record, speed=1.01 * TURN * SHAFT).lines[0]
    off = abs(line.shaft_speed - TURN * SHAFT)
    assert line.kind == "line"
    assert off < line.speed_half_width < TURN * 1.01 * RATE / time.size


@pytest.mark.parametrize(
    ("fields", "speed", "code"),
    [
        ({"rpm": 1494.0}, TURN * SHAFT, "speed_of_file"),
        ({"shaft_speed_hz": SHAFT}, TURN * SHAFT, "speed_of_file"),
        ({"speed": 1494.0}, None, "speed_without_unit"),
        ({"rpm": 1494.0, "shaft_speed_hz": 30.0}, None, "speeds_stated"),
    ],
)
def test_a_speed_that_a_file_states(
    tmp_path: Path, fields: dict[str, float], speed: float | None, code: str
) -> None:
    path = tmp_path / "stated.npz"
    np.savez(path, fs=RATE, a=VALUES, **fields)  # type: ignore[arg-type]
    record = read_record(path)
    assert (record.speed or 0.0) == pytest.approx(speed or 0.0)
    found = measure(record)
    assert code in [one.code for one in found.notices]
    assert found.teeth == (None if speed is None else TEETH)


def test_a_speed_above_the_columns_of_a_text(tmp_path: Path) -> None:
    path = tmp_path / "stated.csv"
    rows = "\n".join(f"{k / RATE:.9f},{VALUES[k]:.6f}" for k in range(1000))
    path.write_text(f"# shaft speed: 1494 rpm\ntime [s],a [g]\n{rows}\n")
    assert read_record(path).speed == pytest.approx(TURN * SHAFT)


def test_a_later_piece_of_a_record_keeps_its_time() -> None:
    whole = Record((Channel("a", np.arange(1000.0), "g"),), "made", 100.0, "made", start=2.0)
    piece = later(whole, 4.0)
    assert (piece.start, piece.samples, piece.channels[0].values()[0]) == (6.0, 600, 400.0)
    with pytest.raises(InputError, match=r"start: got 10 s; allowed 0\.\.10 s"):
        later(whole, 10.0)
