"""A rate that a file's time stamps tell: rounded, repeating or jittering; its interval goes on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from thermogear.measured.dataset import figures
from thermogear.measured.readers import read_record
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.measured.traps import read_time


def written(path: Path, rate: float, decimals: int, jitter: float = 0.0, head: str = "") -> Path:
    """A mesh line of 17 teeth at 19.3 turns/s, 2 s; stamps of so many decimals."""
    random = np.random.default_rng(8)
    place = np.arange(int(2 * rate))
    t = place / rate
    turns = 2.0 * np.pi * 19.3 * t
    y = (1.0 + 0.1 * np.cos(turns)) * np.cos(17 * turns) + 0.05 * random.normal(size=t.size)
    stamps = t + random.uniform(-jitter, jitter, t.size) / rate
    rows = [f"{a:.{decimals}f},{b:.5f}" for a, b in zip(np.abs(stamps), y, strict=True)]
    path.write_text(f"{head}time [s],acc [g]\n" + "\n".join(rows) + "\n", "utf-8")
    return path


def mesh_of(found: Measurement) -> tuple[float, float]:
    line = next(one for one in found.lines if one.name == "mesh x 1")
    return line.frequency, line.frequency_half_width


@pytest.mark.parametrize(
    ("rate", "decimals", "jitter"), [(2048.0, 4, 0.0), (5000.0, 3, 0.0), (5000.0, 6, 0.1)]
)
def test_a_usual_rate_is_taken_where_it_alone_fits(
    tmp_path: Path, rate: float, decimals: int, jitter: float
) -> None:
    record = read_record(written(tmp_path / "a.csv", rate, decimals, jitter))
    assert (record.rate, record.rate_half_width) == (rate, 0.0)
    assert ("time_jitters" in [one.code for one in record.notices]) == (jitter > 0.0)
    assert "usual" in record.rate_note
    if rate == 2048.0:
        found = measure(record, teeth=17)
        assert record.rate_note in found.settings["rate"]
        frequency, half = mesh_of(found)
        assert abs(frequency - 17 * 19.3) < half < 2e-3


def test_any_other_rate_takes_its_half_width_along(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", 4873.37, 3, jitter=0.1)
    record = read_record(path)
    assert record.rate == pytest.approx(4873.37, abs=record.rate_half_width)
    assert 0.0 < record.rate_half_width < 5e-4 * 4873.37
    found = measure(record, teeth=17)
    told = figures(found)
    assert told["rate_half_width"] == record.rate_half_width
    line = found.lines[0]
    own = line.position_half_width * record.rate
    assert line.frequency_half_width == pytest.approx(own + line.position * record.rate_half_width)
    assert line.speed_half_width >= line.shaft_speed * record.rate_share
    assert abs(line.frequency - 17 * 19.3) < line.frequency_half_width
    assert abs(line.shaft_speed - 2 * np.pi * 19.3) < line.speed_half_width
    given = record.supplied(rate=4873.37)
    assert (given.rate_half_width, given.rate_note) == (0.0, "")


def test_a_header_that_the_stamps_allow_is_the_rate(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", 4873.37, 4, head="fs: 4873.37 Hz\n")
    record = read_record(path)
    assert (record.rate, record.rate_origin, record.rate_half_width) == (4873.37, "header", 0.0)


def test_stamps_of_no_clock_give_no_rate() -> None:
    random = np.random.default_rng(77)
    for stamps in (
        np.sort(random.uniform(0.0, 3.0, 6000)),
        np.cumsum(random.exponential(2e-4, 6000)),
        np.round(np.cumsum(random.exponential(2e-4, 6000)), 3),
        1e-4 * np.arange(6000.0) ** 1.01,
        np.repeat(np.sort(random.uniform(0.0, 3.0, 600)), 10),
    ):
        assert read_time("t", "s", stamps).rate is None


def run_up(modulation: float, rate: float = 3200.0) -> Record:
    """17 teeth from 8 to 22 turns/s in 5 s."""
    random = np.random.default_rng(9)
    t = np.arange(int(5 * rate)) / rate
    turns = 2.0 * np.pi * (8.0 * t + 1.4 * t**2)
    change = 1.0 + modulation * np.cos(turns)
    y = change * (np.cos(17 * turns) + 0.3 * np.cos(34 * turns + 1.0))
    y += 0.1 * random.normal(size=t.size)
    return Record((Channel("a", y, "g"),), "drawn", rate, "given")


def test_a_run_up_without_a_tacho_names_no_teeth_and_confirms_those_given() -> None:
    found = measure(run_up(0.1), harmonics=1, sidebands=1)
    assert found.slices is not None
    assert (found.teeth, found.slices.of_mesh) == (None, True)
    for teeth, modulation in ((17, 0.1), (19, 0.1), (17, 0.0)):
        gearing = measure(run_up(modulation), teeth=teeth, harmonics=1, sidebands=1).gearing
        assert gearing is not None
        assert gearing.confirmed == (teeth == 17 and modulation > 0.0)


def test_pieces_of_one_run_with_coarse_stamps_join_without_a_gap() -> None:
    """Their starts are those of the lines through all stamps."""
    place = np.arange(9000)
    t = np.round(place / 5000.0 + 0.0003, 3)
    bases = [read_time("t", "s", part) for part in (t[:4001], t[4001:])]
    assert [base.rate for base in bases] == [5000.0, 5000.0]
    assert (bases[1].start - bases[0].start) * 5000.0 == pytest.approx(4001.0, abs=0.2)
