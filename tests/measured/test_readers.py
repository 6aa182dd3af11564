"""Readers: the same synthetic rig read back blind through every format."""

from __future__ import annotations

import struct
import sys
import wave
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from record_makers import RATE, WRITERS, G, csv_text, mesh_train, quantised
from scipy import io

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.measured.readers import format_of, read_record
from thermogear.measured.record import Channel, Record
from thermogear.measured.shaft import Shaft, given_shaft


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_gives_the_same_record(tmp_path: Path, name: str, compared: Compared) -> None:
    table = quantised(mesh_train(3000))
    path = tmp_path / name
    said = WRITERS[name](path, table)
    record = read_record(path, **said)  # type: ignore[arg-type]
    assert record.rate == pytest.approx(RATE, rel=1e-7)
    assert record.samples == 3000
    assert len(record.channels) == 2
    for channel, truth in zip(record.channels, table, strict=True):
        acceleration = channel.values() * channel.si_factor
        assert acceleration.shape == truth.shape
        compared(
            "samples of a record in every file format",
            "the record written",
            acceleration / G - truth,
            2e-6 + 1e-7 * np.abs(truth).max(),
            "g",
        )
    assert [n for n in record.notices if n.level == "important"] == []


@pytest.mark.parametrize("name", WRITERS)
def test_blocks_and_slices_agree_with_the_whole(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    said = WRITERS[name](path, quantised(mesh_train(1000)))
    channel = read_record(path, **said).channels[1]  # type: ignore[arg-type]
    whole = channel.values()
    np.testing.assert_array_equal(np.concatenate(list(channel.blocks(77))), whole)
    np.testing.assert_array_equal(channel.values(10, stop=20), whole[10:20])


def test_the_bytes_tell_the_format_not_the_name(tmp_path: Path) -> None:
    table = mesh_train(300)
    (tmp_path / "a.npz").write_text(csv_text(table))
    WRITERS["five.mat"](tmp_path / "five.mat", table)
    assert format_of(tmp_path / "five.mat") == "MAT"
    np.savez(tmp_path / "b.npz", a=table[0])
    (tmp_path / "b.npz").rename(tmp_path / "b.csv")
    assert format_of(tmp_path / "b.csv") == "NPZ"


@pytest.mark.parametrize("bits", [8, 16, 24, 32])
def test_wave_integers_become_fractions_of_full_scale(tmp_path: Path, bits: int) -> None:
    x = np.linspace(-1.0, 1.0, 300, endpoint=False)
    whole = np.round(x * 2 ** (bits - 1)).astype(np.int64)
    path = tmp_path / "x.wav"
    width = bits // 8
    data = (whole + (128 if bits == 8 else 0)) % 2**bits
    raw = b"".join(int(v).to_bytes(width, "little") for v in data)
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(width)
        file.setframerate(1000)
        file.writeframes(raw)
    record = read_record(path)
    np.testing.assert_allclose(record.channels[0].values(), whole / 2 ** (bits - 1), atol=1e-15)
    message = r"scale: got none; samples are fractions of full scale, so g alone does not"
    with pytest.raises(InputError, match=message):
        _ = read_record(path, unit="g").channels[0].si_factor


def test_wave_floats_keep_their_values_and_rf64_its_length(tmp_path: Path) -> None:
    x = np.linspace(-3, 3, 101).astype("<f4")
    form = struct.pack("<HHIIHH", 3, 1, 500, 2000, 4, 32)
    body = b"WAVE" + b"ds64" + struct.pack("<IQQQI", 28, 0, x.nbytes, 101, 0)
    body += b"fmt " + struct.pack("<I", 16) + form
    body += b"data" + struct.pack("<I", 0xFFFFFFFF) + x.tobytes()
    path = tmp_path / "x.wav"
    path.write_bytes(b"RF64" + struct.pack("<I", 0xFFFFFFFF) + body)
    record = read_record(path)
    np.testing.assert_array_equal(record.channels[0].values(), x)
    assert (record.rate, record.channels[0].unit) == (500.0, None)


def test_mat_structures_big_endian_and_uncompressed(tmp_path: Path) -> None:
    x = np.arange(50.0)
    path = tmp_path / "s.mat"
    io.savemat(path, {"run": {"acc": x, "fs": 100.0, "who": "me"}, "n": np.int8(3)})
    record = read_record(path)
    assert record.names == ("run.acc",)
    assert record.rate == 100.0
    np.testing.assert_array_equal(record.channels[0].values(), x)


def test_npz_refuses_bombs_pickles_and_lies(tmp_path: Path) -> None:
    path = tmp_path / "bomb.npz"
    np.savez_compressed(path, a=np.zeros(4_000_000))
    message = r"^file: got bomb\.npz; allowed up to 0\.000977 GiB; unpacked it is 0\.0298 GiB"
    with pytest.raises(InputError, match=message):
        read_record(path, limit=1 << 20)
    np.savez(tmp_path / "p.npz", a=np.array([{}] * 10, dtype=object))
    with pytest.raises(InputError, match=r"p\.npz; cannot be read as NPZ: it holds no array"):
        read_record(tmp_path / "p.npz")
    with zipfile.ZipFile(tmp_path / "lie.npz", "w") as file:
        head = b"{'descr': '<f8', 'fortran_order': False, 'shape': (999999999,), }"
        head = head.ljust(117) + b"\n"
        file.writestr("a.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head)
    with pytest.raises(InputError, match=r"a member states 7999999992 bytes and has 128$"):
        read_record(tmp_path / "lie.npz")


def test_gzip_bomb_is_stopped_while_it_unpacks(tmp_path: Path) -> None:
    import gzip

    path = tmp_path / "b.csv.gz"
    with gzip.open(path, "wb") as file:
        file.write(b"a\n" + b"1.5\n" * 2_000_000)
    with pytest.raises(InputError, match=r"allowed up to 0\.00391 GiB"):
        read_record(path, limit=4 << 20)


@pytest.mark.parametrize(("name", "module"), [("a.tdms", "nptdms"), ("a.uff", "pyuff")])
def test_a_missing_extra_is_one_line_that_names_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, module: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    (tmp_path / name).write_bytes(b"TDSm" if name.endswith("tdms") else b"    -1\n")
    with pytest.raises(InputError, match=rf"needs {module}; .*\[measure\]") as caught:
        read_record(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_a_missing_mdf_reader_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "asammdf", None)
    (tmp_path / "a.mf4").write_bytes(b"MDF     4.10")
    with pytest.raises(InputError, match=r"needs asammdf; in the checkout of thermogear"):
        read_record(tmp_path / "a.mf4")


def test_tdms_channels_keep_rate_and_unit(tmp_path: Path) -> None:
    said = {"wf_increment": 1 / 2048, "unit_string": "m/s^2"}
    channels = [
        ChannelObject("g", name, values, said)
        for name, values in (("x", np.arange(20.0)), ("y", np.ones(20)))
    ]
    with TdmsWriter(str(tmp_path / "a.tdms")) as writer:
        writer.write_segment(channels)
    record = read_record(tmp_path / "a.tdms")
    assert record.names == ("g/x", "g/y")
    assert record.rate == pytest.approx(2048.0)
    assert record.channels[0].unit == "m/s^2"


def test_records_refuse_the_impossible() -> None:
    with pytest.raises(InputError, match=r"^record: got x; it holds no channel of numbers$"):
        Record((), "x")
    one, two = Channel("a", np.zeros(5)), Channel("b", np.zeros(6))
    with pytest.raises(InputError, match=r"^record: got channels of \[5, 6\] samples; allowed one"):
        Record((one, two), "x")
    with pytest.raises(InputError, match=r"^channel: got 'c'; allowed 1..1 or a name; known: a$"):
        Record((one,), "x").channel("c")
    with pytest.raises(InputError, match=r"^channel: got '2'; allowed 1\.\.1 or a name; known: a$"):
        Record((one,), "x").channel(2)
    with pytest.raises(InputError, match=r"^unit: got 'm/s\^3'; did you mean 'm/s\^2'\?$"):
        Record((one,), "x").supplied(unit="m/s^3")
    with pytest.raises(
        InputError, match=r"^rate: got -1 samples/s; allowed 1e-6\.\.1e\+12 samples/s$"
    ):
        Record((one,), "x").supplied(rate=-1)
    with pytest.raises(InputError, match=r"unit: got none; the file states no unit"):
        _ = one.si_factor
    with pytest.raises(InputError, match=r"^file: got nowhere\.csv; there is no such file$"):
        read_record("nowhere.csv")


@pytest.mark.parametrize("keep", [(), ("a",)])
def test_a_tacho_that_is_neither_file_nor_channel(tmp_path: Path, keep: tuple[str, ...]) -> None:
    path = tmp_path / "a.csv"
    path.write_text("a [g],b [g]\n" + "1.5,2.5\n2.5,1.5\n" * 20)
    with pytest.raises(InputError, match=r"^tacho: got '/nope.csv'; .* no such file .*: a, b$"):
        read_record(path, tacho="/nope.csv", channels=keep)


@pytest.mark.parametrize("count", [0, 1, 2, 7])
def test_too_few_pulses_are_counted(count: int) -> None:
    pulses = np.zeros(4000)
    pulses[500 * np.arange(1, count + 1)] = 5.0
    shaft = shaft_of(pulses)
    assert shaft.turns.size == 0
    (told,) = shaft.told
    noun = "pulse" if count == 1 else "pulses"
    assert told.code == "tacho_not_used"
    assert f"got {count} {noun}; allowed >= 8 " in told.data["reason"]


@pytest.mark.parametrize(("width", "spike"), [(200, 5.0), (200, 90.0), (3, 5.0)])
def test_pulses_of_any_width_are_seen(width: int, spike: float) -> None:
    place = np.arange(8000)
    pulses = 5.0 * (place % 500 < width) + 0.02 * np.cos(place**2)
    pulses[750] = spike if spike > 5.0 else pulses[750]
    shaft = shaft_of(pulses)
    assert shaft.turns[-1] - shaft.turns[0] == pytest.approx((shaft.turns.size - 1) / 500, rel=1e-3)
    assert shaft.turns.size >= 7000


def shaft_of(pulses: np.ndarray) -> Shaft:
    """The shaft by a record's tacho."""
    channels = Channel("a", np.cos(np.arange(pulses.size)), "g"), Channel("p", pulses, "V")
    record = Record(channels, "x", 1000.0, tacho="p")
    shaft = given_shaft(record, samples=pulses.size, start=0, pulses_per_turn=1.0)
    assert shaft is not None
    return shaft


def test_groups_of_other_files_and_text_are_not_followed(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["secret"] = np.arange(100.0)
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["link"] = h5py.ExternalLink("other.h5", "/secret")
        file["x"] = np.arange(64.0)
        file["note"] = "text"
    assert read_record(path).names == ("x",)
