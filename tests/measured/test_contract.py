"""One signal in every format, with every defect: read alike, or refused alike."""

from __future__ import annotations

import gc
import json
import struct
import sys
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import asammdf
import h5py
import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from numpy.typing import NDArray
from record_makers import write_wav
from scipy import io

from thermogear.base.errors import InputError
from thermogear.measured import optional
from thermogear.measured.mdf_process import read_from
from thermogear.measured.readers import read_record
from thermogear.measured.record import Record

Floats = NDArray[np.float64]
RATE = 2048.0
COUNT = 600
TIME = np.arange(COUNT) / RATE
LINE = np.cos(2.0 * np.pi * 301.7 * TIME)
PULSES = 5.0 * (np.arange(COUNT) % 60 < 20)


@dataclass(frozen=True)
class Made:
    """A channel to write: its stamps (even where ``step`` is told by the header alone)."""

    name: str
    values: Floats
    unit: str = "g"
    stamps: Floats | None = None
    step: float = 1.0 / RATE
    start: float = 0.0

    @property
    def x(self) -> Floats:
        even = self.start + self.step * np.arange(self.values.size)
        return even if self.stamps is None else self.stamps


def lvm(path: Path, channels: Sequence[Made], axis: str = "Time") -> None:
    """X_Columns Multi: each channel with its own X column."""
    facts = {
        "Samples": [str(c.values.size) for c in channels],
        "Y_Unit_Label": [c.unit for c in channels],
        "X_Dimension": [axis for c in channels],
        "X0": [f"{c.x[0]:.16E}" for c in channels],
        "Delta_X": [f"{c.step:.16E}" for c in channels],
    }
    head = ["LabVIEW Measurement", "***End_of_Header***"]
    head += ["\t".join([key, *("\t".join((cell, "")) for cell in cells)])
             for key, cells in facts.items()]  # fmt: skip
    head += ["***End_of_Header***", "\t".join(f"X_Value\t{c.name}" for c in channels) + "\tComment"]
    for i in range(max(c.values.size for c in channels)):
        cells = [
            f"{c.x[i]:.9f}\t{c.values[i]:.9f}" if i < c.values.size else "\t" for c in channels
        ]
        head.append("\t".join(cells))
    path.write_text("\n".join(head) + "\n", "utf-8")


def csv(path: Path, channels: Sequence[Made]) -> None:
    table = np.column_stack([channels[0].x, *(c.values for c in channels)])
    head = ",".join(["time [s]", *(f"{c.name} [{c.unit}]" for c in channels)])
    np.savetxt(path, table, fmt="%.9f", delimiter=",", header=head, comments="")


def tdms(path: Path, channels: Sequence[Made], axis: tuple[str, str] = ("Time", "s")) -> None:
    items = []
    for c in channels:
        said: dict[str, object] = {"unit_string": c.unit}
        if c.stamps is None:
            said |= {"wf_increment": c.step, "wf_start_offset": c.start}
            said |= {"wf_xname": axis[0], "wf_xunit_string": axis[1]}
        else:
            items.append(ChannelObject(c.name, "Time", c.x, properties={"unit_string": "s"}))
        items.append(ChannelObject(c.name, "y", c.values, properties=said))
    with TdmsWriter(str(path)) as writer:
        writer.write_segment(items)


def uff(path: Path, channels: Sequence[Made], function: int = 1, axis: str = "s") -> None:
    """Sets 58 as the format has them: lines of 80 columns, steps and stamps of six digits."""
    lines = []
    for c in channels:
        even = c.stamps is None
        lines += ["    -1", "    58", f"{c.name:80}", *["NONE"] * 4]
        lines.append(f"{function:5}{0:10}{0:5}{0:10} {c.name:10}{1:10}{3:4} {'NONE':10}{0:10}{0:4}")
        lines.append(f"{2:10}{c.values.size:10}{int(even):10}{c.x[0] if even else 0:13.5E}"
                     f"{c.step if even else 0:13.5E}{0:13.5E}")  # fmt: skip
        lines.append(f"{17 if axis == 's' else 18 if axis == 'Hz' else 0:10}" + f"{0:5}" * 3
                     + f" {'x':20} {axis:20}")  # fmt: skip
        lines.append(f"{12:10}" + f"{0:5}" * 3 + f" {'Acc':20} {c.unit:20}")
        lines += [f"{0:10}" + f"{0:5}" * 3 + f" {'NONE':20} {'NONE':20}"] * 2
        numbers = c.values if even else np.column_stack([c.x, c.values]).reshape(-1)
        lines += ["".join(f"{v:13.5E}" for v in numbers[k : k + 6])
                  for k in range(0, numbers.size, 6)]  # fmt: skip
        lines.append("    -1")
    path.write_text("\n".join(lines) + "\n", "ascii")


def mdf(path: Path, channels: Sequence[Made], sync: int = 1) -> None:
    file = asammdf.MDF()
    for c in channels:
        kept = {"name": c.name, "unit": c.unit, "master_metadata": ("x", sync)}
        file.append([asammdf.Signal(c.values, c.x, **kept)])
    file.save(path, overwrite=True)
    file.close()


def mat5(path: Path, channels: Sequence[Made]) -> None:
    """A structure for each channel, with its time or its rate."""
    io.savemat(path, {c.name: structure(c) for c in channels})


def structure(c: Made) -> dict[str, object]:
    timed = {"fs": 1.0 / c.step} if c.stamps is None and not c.start else {"time_s": c.x}
    return {"y": c.values, "unit": c.unit, **timed}


def mat73(path: Path, channels: Sequence[Made]) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        for c in channels:
            for key, value in structure(c).items():
                text = isinstance(value, str)
                data = [[ord(sign)] for sign in value] if text else np.atleast_2d(value)
                stored = file.create_dataset(f"{c.name}/{key}", data=np.asarray(
                    data, "u2" if text else "f8"))  # fmt: skip
                stored.attrs["MATLAB_class"] = np.bytes_("char" if text else "double")
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\2IM")


def hdf(path: Path, channels: Sequence[Made]) -> None:
    with h5py.File(path, "w") as file:
        for c in channels:
            group = file.create_group(c.name)
            group["y"] = c.values
            group["y"].attrs["units"] = c.unit
            if c.stamps is None and not c.start:
                group.attrs["sampling_rate"] = 1.0 / c.step
            else:
                group["time"] = c.x
                group["time"].attrs["units"] = "s"


def npz(path: Path, channels: Sequence[Made]) -> None:
    np.savez(path, **{f"{c.name} [{c.unit}]": c.values for c in channels}, time_s=channels[0].x)


Writer = Callable[[Path, Sequence[Made]], None]
WRITERS: dict[str, Writer] = {
    "a.csv": csv, "a.lvm": lvm, "a.tdms": tdms, "a.uff": uff, "a.mf4": mdf, "five.mat": mat5,
    "seven.mat": mat73, "a.h5": hdf, "a.npz": npz,
}  # fmt: skip
EACH_ITS_OWN = ("a.lvm", "a.tdms", "a.uff", "a.mf4", "five.mat", "seven.mat", "a.h5")
"""Formats whose channels have a time each."""
ACC = Made("acc", LINE)


@pytest.fixture(autouse=True)
def mdf_read_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """MDF without a process of its own, which takes a second to begin."""

    def run(words: list[str], environment: dict[str, str]) -> int:
        try:
            with warnings.catch_warnings(action="ignore"):
                read = read_from(asammdf, Path(words[0]), Path(words[1]))
        except Exception as error:  # as the process itself has it
            read = {"error": str(error)}
        gc.collect()  # what is left of a reader that failed fails again: here, unheard
        (Path(words[1]) / "parts.json").write_text(json.dumps(read), "utf-8")
        return 0

    monkeypatch.setattr(optional, "_run", run)
    monkeypatch.setattr(sys, "unraisablehook", lambda _: None)


def record(folder: Path, name: str, *channels: Made, **options: object) -> Record:
    WRITERS[name](folder / name, channels)
    return read_record(folder / name, **options)  # type: ignore[arg-type]


def codes(found: Record) -> set[str]:
    return {one.code for one in found.notices}


def values(found: Record) -> Floats:
    return found.channels[0].values()


@pytest.mark.parametrize("name", WRITERS)
def test_a_whole_record_needs_no_word(tmp_path: Path, name: str) -> None:
    found = record(tmp_path, name, ACC)
    assert (found.rate, found.rate_half_width) == (RATE, 0.0)
    assert [c.unit for c in found.channels] == ["g"]
    assert codes(found) <= {"time_unit"}
    np.testing.assert_allclose(values(found), LINE, atol=6e-6)


@pytest.mark.parametrize("name", WRITERS)
def test_lost_samples_are_missing(tmp_path: Path, name: str) -> None:
    kept = np.r_[0:200, 260:COUNT]
    found = record(tmp_path, name, Made("acc", LINE[kept], stamps=TIME[kept]))
    assert found.rate == RATE
    assert np.flatnonzero(np.isnan(values(found))).tolist() == list(range(200, 260))
    assert "samples_lost" in codes(found)


@pytest.mark.parametrize("name", WRITERS)
def test_a_pause_leaves_the_longest_stretch(tmp_path: Path, name: str) -> None:
    found = record(tmp_path, name, Made("acc", LINE, stamps=TIME + 0.3e-3 * (TIME > 0.1)))
    assert (found.rate, found.samples) == (RATE, COUNT - 205)
    assert "time_pauses" in codes(found)


@pytest.mark.parametrize("name", [name for name in WRITERS if name != "a.lvm"])
def test_uneven_stamps_give_no_rate(tmp_path: Path, name: str) -> None:
    found = record(tmp_path, name, Made("acc", LINE, stamps=TIME * (1.0 + TIME)))
    assert (found.rate, found.samples) == (None, COUNT)
    assert "time_not_uniform" in codes(found)


@pytest.mark.parametrize("name", WRITERS)
def test_an_unknown_unit_is_kept_as_written(tmp_path: Path, name: str) -> None:
    found = record(tmp_path, name, replace(ACC, unit="furlong"))
    if name in ("a.csv", "a.npz"):  # in brackets behind the name, it stays there
        assert found.names == ("acc [furlong]",)
    else:
        assert [(c.unit, c.strange) for c in found.channels] == [(None, "furlong")]


@pytest.mark.parametrize("name", EACH_ITS_OWN)
def test_channels_that_start_apart_are_cut_to_their_common_time(tmp_path: Path, name: str) -> None:
    late = 100
    tacho = Made("tacho", PULSES[late:], "V", TIME[late:], start=TIME[late])
    for place, one in enumerate((tacho, replace(tacho, stamps=None))):
        (tmp_path / str(place)).mkdir()
        first = replace(ACC, stamps=TIME if one.stamps is not None else None)
        found = record(tmp_path / str(place), name, first, one)
        assert (found.samples, found.start) == (COUNT - late, pytest.approx(TIME[late]))
        np.testing.assert_allclose(values(found), LINE[late:], atol=6e-6)
        np.testing.assert_allclose(found.channels[1].values(), PULSES[late:], atol=1e-4)
        assert "cut_to_common_start" in codes(found)


@pytest.mark.parametrize("name", EACH_ITS_OWN)
def test_a_slower_channel_keeps_its_own_time(tmp_path: Path, name: str) -> None:
    slow = Made("n_in", np.full(60, 1500.0), "rpm", step=10.0 / RATE)
    found = record(tmp_path, name, ACC, slow, tacho=None)
    assert (found.rate, len(found.channels), found.samples) == (RATE, 1, COUNT)
    (other,) = found.others
    assert (other.rate, other.samples) == (pytest.approx(RATE / 10.0), 60)
    assert "channels_of_own_time" in codes(found)
    own = other.names[0]
    by_speed = read_record(tmp_path / name, tacho=own)
    assert by_speed.others[0].tacho == own
    assert read_record(tmp_path / name, channels=[own]).rate == pytest.approx(RATE / 10.0)


def test_spectra_are_called_spectra(tmp_path: Path) -> None:
    lvm(tmp_path / "a.lvm", [ACC], axis="Frequency")
    tdms(tmp_path / "a.tdms", [ACC], axis=("Frequency", "Hz"))
    uff(tmp_path / "a.uff", [ACC], function=12, axis="Hz")
    for name in ("a.lvm", "a.tdms", "a.uff"):
        with pytest.raises(InputError, match="it holds spectra, as"):
            read_record(tmp_path / name)


def test_an_angle_gives_orders_and_no_rate(tmp_path: Path) -> None:
    by_degree = replace(ACC, step=3.0)
    tdms(tmp_path / "a.tdms", [by_degree], axis=("Angle", "deg"))
    uff(tmp_path / "a.uff", [by_degree], axis="deg")
    mdf(tmp_path / "a.mf4", [by_degree], sync=2)
    for name in ("a.tdms", "a.uff", "a.mf4"):
        found = read_record(tmp_path / name)
        assert (found.rate, found.per_turn) == (None, pytest.approx(120.0))
        assert codes(found) == {"x_is_angle"}


@pytest.mark.parametrize("rate", [2048.0, 51_200.0, 25_000.7])
def test_a_step_is_known_by_its_digits(tmp_path: Path, rate: float) -> None:
    found = record(tmp_path, "a.uff", replace(ACC, step=1.0 / rate))
    assert found.rate is not None
    assert abs(found.rate - rate) <= found.rate_half_width
    assert found.rate_half_width <= 6e-6 * rate
    assert found.rate_half_width == 0.0 or rate == 25_000.7


def test_a_scaling_that_was_not_applied_withholds_the_unit(tmp_path: Path) -> None:
    said = {"wf_increment": 1.0 / RATE, "unit_string": "g", "NI_Number_Of_Scales": 1}
    said |= {"NI_Scale[0]_Scale_Type": "Unheard_Of", "NI_Scaling_Status": "unscaled"}
    with TdmsWriter(str(tmp_path / "a.tdms")) as writer:
        writer.write_segment([ChannelObject("rig", "acc", LINE, properties=said)])
    found = read_record(tmp_path / "a.tdms")
    assert "scaling_not_applied" in codes(found)
    assert found.channels[0].unit is None
    given = read_record(tmp_path / "a.tdms", unit="g")
    with pytest.raises(InputError, match="give --scale"):
        _ = given.channels[0].si_factor


def test_samples_marked_invalid_are_missing(tmp_path: Path) -> None:
    file = asammdf.MDF()
    wrong = (np.arange(COUNT) >= 50) & (np.arange(COUNT) < 90)
    file.append([asammdf.Signal(LINE, TIME, name="acc", unit="g", invalidation_bits=wrong)])
    file.save(tmp_path / "a.mf4")
    file.close()
    found = read_record(tmp_path / "a.mf4")
    assert np.array_equal(np.isnan(values(found)), wrong)


def element(kind: int, content: bytes) -> bytes:
    return struct.pack("<II", kind, len(content)) + content + bytes(-len(content) % 8)


@pytest.mark.parametrize("beside", [False, True])
@pytest.mark.parametrize("name", ["five.mat", "seven.mat"])
def test_tables_of_matlab_are_named_with_the_way_out(
    tmp_path: Path, name: str, beside: bool
) -> None:
    """A table is an object: its numbers lie in a variable without a name, or in #subsystem#."""
    path = tmp_path / name
    if name == "five.mat":
        io.savemat(path, {"acc": LINE} if beside else {})
        words = b"T", b"MCOS", b"table"
        table = element(6, struct.pack("<II", 17, 0)) + b"".join(element(1, w) for w in words)
        hidden = element(6, struct.pack("<II", 9, 0)) + element(5, struct.pack("<ii", 1, 4000))
        hidden += element(1, b"") + element(2, bytes(4000))
        path.write_bytes(path.read_bytes() + element(14, table) + element(14, hidden))
    else:
        with h5py.File(path, "w") as file:
            file["T"] = np.zeros((1, 6), "u4")
            file["T"].attrs["MATLAB_class"] = np.bytes_("table")
            file["T"].attrs["MATLAB_object_decode"] = 3
            if beside:
                file["acc"] = LINE
    if beside:
        found = read_record(path)
        assert found.names == ("acc",)
        assert [one.data for one in found.notices if one.code == "objects_left_aside"] == [
            {"arrays": ["T (table)"]}
        ]
    else:
        with pytest.raises(InputError, match=r"T \(table\); .*table2struct"):
            read_record(path)


def test_cells_and_arrays_of_structures_of_seven_are_those_of_five(tmp_path: Path) -> None:
    many = np.zeros((1, 2), dtype=[("y", object), ("unit", object)])
    many["y"][0], many["unit"][0] = [LINE, -LINE], ["g", "g"]
    cells = np.empty((1, 2), object)
    cells[0, 0], cells[0, 1] = 2.0 * LINE, 3.0 * LINE
    io.savemat(tmp_path / "five.mat", {"c": cells, "run": many, "fs": RATE})
    with h5py.File(tmp_path / "seven.mat", "w") as file:
        kept = []
        for k, value in enumerate((2.0 * LINE, 3.0 * LINE, LINE, -LINE, "g", "g")):
            text = isinstance(value, str)
            data = np.array([[ord("g")]], "u2") if text else np.atleast_2d(value)
            file[f"#refs#/{k}"] = data
            file[f"#refs#/{k}"].attrs["MATLAB_class"] = np.bytes_("char" if text else "double")
            kept.append(file[f"#refs#/{k}"].ref)
        for at, first in (("c", 0), ("run/y", 2), ("run/unit", 4)):
            pair = np.array([kept[first : first + 2]], h5py.ref_dtype).T
            file.create_dataset(at, data=pair, dtype=h5py.ref_dtype)
        file["c"].attrs["MATLAB_class"] = np.bytes_("cell")
        file["run"].attrs["MATLAB_class"] = np.bytes_("struct")
        file["fs"] = [[RATE]]
    five, seven = (read_record(tmp_path / f"{name}.mat") for name in ("five", "seven"))
    assert sorted(five.names) == sorted(seven.names) == ["c{1}", "c{2}", "run(1).y", "run(2).y"]
    assert five.rate == seven.rate == RATE
    for channel in five.channels:
        twin = seven.channel(channel.name)
        assert twin.unit == channel.unit == ("g" if "run" in channel.name else None)
        np.testing.assert_array_equal(twin.values(), channel.values())


def test_each_block_under_one_header_is_a_record(tmp_path: Path) -> None:
    path = tmp_path / "a.lvm"
    lvm(path, [ACC])
    head, rows = path.read_text().split("Comment\n")
    path.write_text(head + "Comment\n" + rows + rows.replace("-", ""))
    first = read_record(path)
    assert (first.samples, first.rate) == (COUNT, RATE)
    assert "several_blocks" in codes(first)
    second = read_record(path, channels=["acc (block 2)"])
    np.testing.assert_allclose(values(second), np.abs(LINE), atol=1e-6)


@pytest.mark.parametrize("name", [*WRITERS, "a.wav"])
def test_what_a_file_states_and_does_not_hold_is_told(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    if name == "a.wav":
        write_wav(path, LINE[None])
    else:
        WRITERS[name](path, [ACC, Made("b", PULSES, "V")])
    whole = path.read_bytes()
    marks = {"data_cut_off", "last_row_dropped", "last_row_unended", "cut_to_shortest"}
    for share in (0.1, 0.3, 0.45, 0.7, 0.85, 0.95, 0.99):
        path.write_bytes(whole[: int(share * len(whole))])
        try:
            found = read_record(path)
        except InputError:
            continue
        assert codes(found) & marks, share
        assert found.samples < COUNT or len(found.channels) < 2
