"""Dropped blocks against a time column: found, put in as a gap, and nothing else taken for one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from record_makers import mesh_train
from scipy.io import savemat

from thermogear.measured.readers import read_record
from thermogear.measured.reduction import measure
from thermogear.measured.traps import read_time

RATE = 12_800.0


def test_drawn_blocks_are_found_to_the_sample() -> None:
    """Drawn rates, stamps of few digits, blocks of one sample and more at drawn places."""
    random = np.random.default_rng(612)
    for _ in range(60):
        rate, count = random.uniform(200.0, 50_000.0), int(random.integers(4000, 9000))
        place = np.sort(random.choice(np.arange(50, count - 50), int(random.integers(1, 4)), False))
        lost = random.integers(1, 400, place.size)
        step = np.ones(count)
        step[place] += lost
        t = np.round((np.cumsum(step) + random.uniform(0, 99)) / rate * rate * 20) / (20 * rate)
        base = read_time("t", "s", t)
        assert base.rate == pytest.approx(rate, rel=2e-5)
        assert base.gaps == tuple(zip(place.tolist(), lost.tolist(), strict=True))


@pytest.mark.parametrize("jump", [1.4, 2.5, 300.5])
def test_a_jump_by_no_whole_number_of_steps_gives_no_rate(jump: float) -> None:
    t = np.arange(5000.0)
    t[3000:] += jump
    base = read_time("t", "s", t / RATE)
    assert (base.rate, base.gaps) == (None, ())


def test_pauses_of_any_length_are_no_dropped_blocks() -> None:
    """Exact stamps: a drawn pause is a whole number of steps to 2 % in one of 25."""
    random = np.random.default_rng(99)
    taken = 0
    for _ in range(200):
        t = np.arange(3000.0)
        t[int(random.integers(50, 2950)) :] += random.uniform(1.0, 300.0)
        taken += bool(read_time("t", "s", t / RATE).gaps)
    assert taken <= 20


def test_the_row_that_is_named_is_the_files() -> None:
    t = np.arange(3000.0)
    t[2000:] += 5.0
    base = read_time("t", "s", t / RATE)
    assert base.gaps == ((2000, 5),)
    lost = {"column": "t", "places": 1, "first": 2001, "samples": 5}
    assert lost in [one.data for one in base.notices if one.code == "samples_lost"]


def test_uneven_stamps_give_no_rate() -> None:
    t = np.arange(5000) + np.random.default_rng(2).uniform(0.0, 0.9, 5000)
    t[2500:] += 40.0
    assert read_time("t", "s", t / RATE).gaps == ()


@pytest.mark.parametrize("kind", ["csv", "mat"])
def test_a_record_with_a_dropped_block_is_read_as_with_a_gap(tmp_path: Path, kind: str) -> None:
    whole = mesh_train(1 << 15, channels=1)[0]
    keep = np.ones(whole.size, bool)
    keep[10_000:10_777] = False
    t = np.arange(whole.size) / RATE
    path = tmp_path / f"run.{kind}"
    if kind == "csv":
        rows = [f"{a:.9g},{b:.9g}" for a, b in zip(t[keep], whole[keep], strict=True)]
        path.write_text("time [s],a [g]\n" + "\n".join(rows) + "\n")
    else:
        savemat(path, {"time_s": t[keep], "a": whole[keep]})
    record = read_record(path)
    assert record.samples == whole.size
    assert record.rate == pytest.approx(RATE, rel=1e-6)
    values = record.channels[0].values()
    assert np.all(np.isnan(values[10_000:10_777]))
    assert np.sum(np.isnan(values)) == 777
    assert values[keep] == pytest.approx(whole[keep], rel=1e-8)
    found = measure(record, teeth=32)
    assert found.samples == whole.size
    assert found.lines[0].reading == pytest.approx(1.0, rel=0.1)
    assert found.findings


def test_single_rows_lost_here_and_there_are_put_in() -> None:
    """Up to 5 % of the rows: every gap is a whole number of steps."""
    random = np.random.default_rng(7)
    for share in (0.002, 0.01, 0.04):
        kept = np.flatnonzero(random.random(20000) > share)
        base = read_time("t", "s", kept / RATE)
        assert base.rate == pytest.approx(RATE, rel=1e-9)
        assert sum(lost for _, lost in base.gaps) == kept[-1] - kept[0] + 1 - kept.size
