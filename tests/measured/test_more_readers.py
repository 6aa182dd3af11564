"""LabVIEW files with a comment column, clock stamps, MAT cells and structures, steps, suffixes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from record_makers import RATE, mesh_train
from scipy import io

from thermogear.base.errors import InputError
from thermogear.measured.readers import read_record
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure
from thermogear.measured.verdicts import Row, verdict

HEAD = """LabVIEW Measurement\t
Separator\tTab
Date\t2020/01/05
Time\t12:00:00.123
***End_of_Header***\t
Channels\t2\t\t
Samples\t400\t400\t
Y_Unit_Label\tg\tm/s^2\t
Delta_X\t0.0001\t0.0001\t
***End_of_Header***\t\t\t
X_Value\tacc1\tacc2\tComment
"""


@pytest.mark.parametrize("first", ["\t", "\tstart, here", ""])
def test_labview_with_a_comment_column(tmp_path: Path, first: str) -> None:
    rows = [f"{i * 1e-4:.6f}\t{i % 7}.25\t-{i % 5}.5" for i in range(400)]
    rows[0] += first
    path = tmp_path / "rig.lvm"
    path.write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")
    record = read_record(path)
    assert record.names == ("acc1", "acc2")
    assert [c.unit for c in record.channels] == ["g", "m/s^2"]
    assert record.samples == 400
    assert record.rate == pytest.approx(10_000.0)
    np.testing.assert_allclose(record.channels[1].values()[:3], [-0.5, -1.5, -2.5])


FINE = "1.0000000000000000E-4"
SLOW = "1.0000000000000000E-3"


def lvm(
    folder: Path,
    axis: str,
    steps: Sequence[str],
    *,
    real: Sequence[float] = (1e-4, 1e-4),
    start: str = "0.0000000000000000E+0",
    dimension: str = "Time",
    parted: str = "\t",
    decimal: str = ".",
) -> Path:
    """A LabVIEW file: its X columns are ``axis`` No, One or Multi, samples ``real`` seconds apart
    where they are written, ``steps`` in the header."""
    count, wide = len(steps), 2 * parted if axis == "Multi" else parted
    facts = {
        "Channels": [str(count)],
        "Y_Unit_Label": ["g"] * count,
        "X_Dimension": [dimension] * count,
        "X0": [start] * count,
        "Delta_X": list(steps),
    }
    head = ["LabVIEW Measurement", f"X_Columns{parted}{axis}", "***End_of_Header***"]
    head += [parted.join((key, wide.join(cells), "")) for key, cells in facts.items()]
    names = [f"a{i + 1}" for i in range(count)]
    between = f"{parted}X_Value{parted}" if axis == "Multi" else parted
    head += ["***End_of_Header***", f"X_Value{parted}{between.join(names)}{parted}Comment"]
    for i in range(400):
        cells = [f"{(7 * i + k) % 13 - 6.25}" for k in range(count)]
        stamps = [f"{i * real[k]:.9f}" for k in range(count)]
        row = {"No": ["", *cells], "One": [stamps[0], *cells]}.get(
            axis, [one for pair in zip(stamps, cells, strict=True) for one in pair]
        )
        head.append(parted.join(row))
    text = "\n".join(head) + "\n"
    path = folder / "rig.lvm"
    path.write_text(text.replace(".", decimal), encoding="utf-8")
    return path


@pytest.mark.parametrize("axis", ["No", "One", "Multi"])
@pytest.mark.parametrize(("parted", "decimal"), [("\t", "."), ("\t", ","), (",", ".")])
def test_labview_states_the_step_in_its_header(
    tmp_path: Path, axis: str, parted: str, decimal: str
) -> None:
    record = read_record(lvm(tmp_path, axis, [FINE, FINE], parted=parted, decimal=decimal))
    assert (record.names, record.samples) == (("a1", "a2"), 400)
    assert (record.rate, record.rate_half_width, record.notices) == (10_000.0, 0.0, ())
    assert [c.unit for c in record.channels] == ["g", "g"]
    np.testing.assert_allclose(record.channels[1].values()[:3], [-5.25, 1.75, -4.25])


@pytest.mark.parametrize("axis", ["No", "Multi"])
def test_labview_channels_of_several_rates(tmp_path: Path, axis: str) -> None:
    path = lvm(tmp_path, axis, [FINE, SLOW], real=(1e-4, 1e-3))
    both = read_record(path)
    assert (both.names, both.rate) == (("a1",), 10_000.0)
    (slow,) = both.others
    assert (slow.names, slow.rate) == (("a2",), 1000.0)
    (note,) = both.notices
    assert (note.code, note.data["channels"]) == ("channels_of_own_time", ["a2"])
    assert [read_record(path, channels=[k]).rate for k in ("a1", "a2")] == [10_000.0, 1000.0]
    assert read_record(path, rate=500.0).rate == 500.0


@pytest.mark.parametrize("axis", ["One", "Multi"])
def test_labview_step_against_its_time_column(tmp_path: Path, axis: str) -> None:
    record = read_record(lvm(tmp_path, axis, [SLOW, SLOW]))
    assert record.rate is None
    told = record.notices[0]
    assert {one.code for one in record.notices} == {"rate_stated_twice"}
    rates = told.data["rate"], told.data["other_rate"]
    assert rates == pytest.approx((1000.0, 10_000.0))
    # a step of few decimals contradicts no rate that rounds to it: the time column is finer
    rounded = read_record(lvm(tmp_path, axis, ["0.000078"] * 2, real=(1 / 12800, 1 / 12800)))
    assert (rounded.rate, rounded.notices) == (12_800.0, ())


@pytest.mark.parametrize("rate", [4096.0, 10_000.0, 12_800.0, 51_200.0])
@pytest.mark.parametrize("decimals", [6, 9, 12])
def test_labview_step_of_few_decimals(tmp_path: Path, rate: float, decimals: int) -> None:
    path = lvm(tmp_path, "No", [f"{1.0 / rate:.{decimals}f}"])
    record = read_record(path)
    assert record.rate is not None
    assert abs(record.rate - rate) <= record.rate_half_width + 1e-9 * rate
    assert record.rate_half_width <= 0.6 * 10.0**-decimals * rate**2
    given = read_record(path, rate=rate)
    assert (given.rate, given.rate_half_width, given.rate_doubt) == (rate, 0.0, "")


def test_labview_start_and_steps_that_are_none(tmp_path: Path) -> None:
    assert read_record(lvm(tmp_path, "No", [FINE], start="1.5")).start == 1.5
    for step in ("0.000000", "-1E-4", "NaN", "1E-300"):
        record = read_record(lvm(tmp_path, "No", [step]))
        assert record.rate is None
        assert [(n.code, n.data["channel"]) for n in record.notices] == [
            ("step_gives_no_rate", "a1")
        ]
    with pytest.raises(InputError, match=r"it holds spectra, as 'a1', and no samples over time"):
        read_record(lvm(tmp_path, "No", [FINE], dimension="Frequency"))
    record = read_record(lvm(tmp_path, "No", [FINE], dimension="Length"))
    assert record.rate is None
    told = [(n.code, n.data) for n in record.notices]
    assert ("step_is_no_time", {"dimension": "Length", "channel": "a1"}) in told


@pytest.mark.parametrize("stamp", ["2024-01-05 12:00:{:09.6f}", "12:00:{:09.6f}"])
def test_clock_stamps_are_a_time(tmp_path: Path, stamp: str) -> None:
    rows = [f"{stamp.format(i * 1e-3)},{i % 7}.5" for i in range(1000)]
    path = tmp_path / "clock.csv"
    path.write_text("timestamp,a [g]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    record = read_record(path)
    assert (record.names, record.samples) == (("a",), 1000)
    assert record.rate == pytest.approx(1000.0, rel=1e-4)


def test_units_behind_an_underscore_of_times_and_speeds(tmp_path: Path) -> None:
    rows = [f"{i * 1e-3:.4f},{1000 + i % 3},{i % 7}.5" for i in range(400)]
    path = tmp_path / "a.csv"
    path.write_text("time_s,speed_rpm,acc_g\n" + "\n".join(rows) + "\n", encoding="utf-8")
    record = read_record(path)
    assert record.rate == pytest.approx(1000.0)
    assert [c.unit for c in record.channels] == ["rpm", None]


def test_cells_arrays_of_structures_and_a_step(tmp_path: Path) -> None:
    a = np.arange(500.0)
    cells = np.empty((1, 2), object)
    cells[0, 0], cells[0, 1] = a, a + 1
    many = np.zeros((1, 2), dtype=[("x", object), ("word", object)])
    many["x"][0] = [a + 2, a + 3]
    many["word"][0] = ["one", "two"]
    io.savemat(tmp_path / "c.mat", {"data": cells, "run": many, "dt": 1e-4})
    record = read_record(tmp_path / "c.mat")
    assert record.names == ("data{1}", "data{2}", "run(1).x", "run(2).x")
    assert record.rate == pytest.approx(10_000.0)
    assert [c.values()[0] for c in record.channels] == [0.0, 1.0, 2.0, 3.0]


def test_a_structure_states_the_unit_of_its_numbers(tmp_path: Path) -> None:
    t = np.arange(500) / 1000.0
    own = {"time_s": t, "acc": np.cos(t), "unit": "m/s^2", "range": 5.0}
    inner = {"values": np.sin(t), "units": "g"}
    io.savemat(tmp_path / "s.mat", {"own": own, "outer": {"inner": inner, "unit": "V"}})
    record = read_record(tmp_path / "s.mat")
    assert {c.name: c.unit for c in record.channels} == {
        "own.acc": "m/s^2",
        "outer.inner.values": "g",
    }
    assert record.rate == pytest.approx(1000.0)


def test_a_unit_that_is_none_is_kept_and_told(tmp_path: Path) -> None:
    acc = np.cos(0.7 * np.arange(500.0))
    io.savemat(tmp_path / "s.mat", {"s": {"acc": acc, "unit": "furlong", "fs": 1000.0}})
    record = read_record(tmp_path / "s.mat")
    assert [(c.unit, c.strange) for c in record.channels] == [(None, "furlong")]
    told = [(n.code, n.data) for n in measure(record).notices]
    assert ("unit_not_known", {"unit": "furlong"}) in told


def test_a_rate_stated_beside_a_time_without_a_unit(tmp_path: Path) -> None:
    t = np.arange(500) / 1000.0
    io.savemat(tmp_path / "t.mat", {"acc": np.cos(700.0 * t), "t": t, "fs": 1000.0})
    record = read_record(tmp_path / "t.mat")
    assert record.rate == 1000.0
    assert [n.code for n in record.notices] == ["time_unit_not_needed"]


@pytest.mark.parametrize("name", ["c.mat", "c.npz"])
def test_complex_numbers_are_no_record(tmp_path: Path, name: str) -> None:
    wave = np.exp(0.7j * np.arange(500.0))
    write = io.savemat if name.endswith("mat") else lambda path, table: np.savez(path, **table)
    write(tmp_path / name, {"acc": wave, "fs": 1000.0})
    with pytest.raises(InputError, match=r"complex numbers .*: acc;"):
        read_record(tmp_path / name)
    write(tmp_path / name, {"acc": wave, "b": wave.real, "fs": 1000.0})
    record = read_record(tmp_path / name)
    assert record.names == ("b",)
    told = [(n.code, n.data) for n in record.notices]
    assert ("complex_left_aside", {"arrays": ["acc"]}) in told


def test_a_vibration_as_the_tacho_is_refused_by_its_name() -> None:
    turns = 1e-2 * np.arange(8000) + 2e-6 * np.arange(8000) ** 2
    noise = np.random.default_rng(3).normal(size=8000)
    channels = Channel("acc", np.sin(2.0 * np.pi * turns), "g"), Channel("p", noise, "V")
    record = Record(channels, "x", RATE, tacho="acc")
    with pytest.raises(InputError, match=r"^record: got no line; .*'acc'.*--tacho"):
        measure(record)


def test_a_speed_that_no_shaft_has_asks_for_the_rate() -> None:
    x = mesh_train(1 << 14, channels=1)[0]
    codes = []
    for rate in (RATE, 1000.0 * RATE):
        found = measure(Record((Channel("a", x, "g"),), "x", rate, "given"), teeth=32)
        codes += [n.code for n in found.notices if n.data.get("rate") == rate]
    assert codes == ["speed_by_rate", "speed_impossible"]


def test_a_velocity_has_acceleration_and_displacement() -> None:
    t = np.arange(40_000) / 10_000.0
    random = np.random.default_rng(1)
    v = 5.0 * np.cos(2 * np.pi * 400 * t) + 2.0 * np.cos(2 * np.pi * 800 * t)
    v += 0.05 * random.standard_normal(t.size)
    found = measure(Record((Channel("v", v, "mm/s"),), "x", 10_000.0, "made"), teeth=20)
    line = found.lines[0]
    assert line.displacement == pytest.approx(5e-3 / (2 * np.pi * 400), rel=1e-3)
    assert line.acceleration == pytest.approx(5e-3 * 2 * np.pi * 400, rel=1e-3)


def test_no_model_is_preferred_where_all_are_far() -> None:
    far, near = (
        Row(speed=1.0, quantity="dte", measured=1.0, simulated=(5.0, second), u_data=0.1)
        for second in (3.5, 1.5)
    )
    assert verdict(far, ["a", "b"]) == "no preference: all are more than 100 % away"
    assert verdict(near, ["a", "b"]) == "b better"
