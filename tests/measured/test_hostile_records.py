"""Files that claim, unpack to or stand for far more than they are: bounded before they are read."""

from __future__ import annotations

import gzip
import os
import struct
import zipfile
import zlib
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np
import pytest

from thermogear import load_case
from thermogear.base.errors import InputError
from thermogear.case.rexs.container import read_rexs
from thermogear.measured import options
from thermogear.measured.options import LEAST_DECODED, UNPACKED, decoded_limit
from thermogear.measured.readers import read_record


def spent() -> float:
    """Processor seconds of this process and of those it has waited for."""
    return sum(os.times()[:4])


def refusal(path: Path, limit: int | None = None) -> str:
    """What a file is refused with, at once."""
    begun = spent()
    with pytest.raises(InputError) as caught:
        read_record(path, limit=limit)
    assert spent() - begun < 2.0
    return str(caught.value)


def test_a_packed_file_may_become_thirty_two_times_its_size() -> None:
    assert decoded_limit(1000) == LEAST_DECODED
    assert decoded_limit(1 << 24) == UNPACKED << 24
    assert decoded_limit(1 << 40) == 8 << 30


@pytest.mark.parametrize("values", ["0,0", "0,1.5", "3,1.5"])
def test_a_time_that_stands_still_gives_no_rate(tmp_path: Path, values: str) -> None:
    path = tmp_path / "still.csv"
    path.write_text("time [s],acc [g]\n" + f"{values}\n" * 400, encoding="utf-8")
    record = read_record(path)
    assert (record.rate, record.samples) == (None, 400)
    told = record.notices[0]
    assert (told.code, told.data) == ("time_stands_still", {"column": "time"})


def test_a_long_time_that_stands_still_is_seen_at_once(tmp_path: Path) -> None:
    path = tmp_path / "still.csv"
    rows = "".join(f"0,{i % 7}\n" for i in range(100_000))
    path.write_text("time [s],acc [g]\n" + rows, encoding="utf-8")
    begun = spent()
    assert read_record(path).rate is None
    assert spent() - begun < 2.0


@pytest.mark.parametrize("step", ["1e-320", "1e-200", "1e200", "1e307"])
def test_a_time_whose_steps_are_no_record_gives_no_rate(tmp_path: Path, step: str) -> None:
    path = tmp_path / "odd.csv"
    rows = "".join(f"{i * float(step)!r},{i % 7}\n" for i in range(1, 20))
    path.write_text("time [s],acc [g]\n" + rows, encoding="utf-8")
    record = read_record(path)
    assert record.rate is None
    told = record.notices[0]
    codes = "time_stands_still", "time_step_impossible", "time_too_large", "time_holds_gaps"
    assert told.code in codes
    assert told.data["column"] == "time"


def test_rates_that_are_none_are_told_and_left(tmp_path: Path) -> None:
    path = tmp_path / "rate.npz"
    np.savez(path, a=np.sin(np.arange(400.0)), fs=1e308)
    record = read_record(path)
    assert record.rate is None
    assert [(n.code, n.data["rate"]) for n in record.notices] == [("rate_impossible", 1e308)]


@pytest.mark.parametrize("packing", [{}, {"compression": "gzip"}])
def test_an_hdf5_file_that_claims_samples_it_has_not(
    tmp_path: Path, packing: dict[str, str]
) -> None:
    path = tmp_path / "claims.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("a", (2**40,), "f8", chunks=(2**20,), **packing)
    assert path.stat().st_size < 8000
    assert "unpacked it is 8.19e+03 GiB or more; raise --limit" in refusal(path)


def test_an_hdf5_chunk_larger_than_its_data_counts_whole(tmp_path: Path) -> None:
    path = tmp_path / "chunk.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("a", (1000,), "f8", maxshape=(None,), chunks=(2**28,))
    assert "unpacked it is 2 GiB or more" in refusal(path)


def test_many_small_claims_count_together(tmp_path: Path) -> None:
    path = tmp_path / "many.h5"
    with h5py.File(path, "w") as file:
        for i in range(5):
            file.create_dataset(f"a{i}", (2**20,), "f8", chunks=(2**17,))
    assert "raise --limit" in refusal(path, limit=1 << 25)
    assert read_record(path, limit=1 << 26).samples == 2**20


def bomb(path: Path, samples: int) -> None:
    head = {"descr": "<f8", "fortran_order": False, "shape": (samples,)}
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file,
        file.open("a.npy", "w", force_zip64=True) as member,
    ):
        np.lib.format.write_array_header_1_0(member, head)
        for _ in range(samples >> 20):
            member.write(bytes(1 << 23))


def test_an_npz_that_unpacks_to_far_more_than_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "bomb.npz"
    bomb(path, 1 << 20)  # 8 MiB of zeros
    assert path.stat().st_size < 20_000
    assert "unpacked it is 0.00781 GiB or more; raise --limit" in refusal(path, limit=1 << 22)
    monkeypatch.setattr(options, "LEAST_DECODED", 1 << 20)
    assert "unpacked it is 0.00781 GiB or more; raise --limit" in refusal(path)


def mat(path: Path, content: bytes) -> None:
    packed = zlib.compress(content)
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM"
    path.write_bytes(head + struct.pack("<II", 15, len(packed)) + packed)


def test_a_mat_variable_says_its_size_before_it_is_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "claims.mat"
    mat(path, struct.pack("<II", 14, 0xF0000000) + bytes(1000))
    assert "unpacked it is 3.75 GiB or more; raise --limit" in refusal(path)


def test_a_mat_variable_of_nothing_but_elements_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "elements.mat"
    mat(path, struct.pack("<II", 14, 1 << 20) + bytes(1 << 20))
    assert "more than 65536 elements" in refusal(path)


def test_a_gz_that_unpacks_to_far_more_than_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "bomb.csv.gz"
    path.write_bytes(gzip.compress(b"a,b\n" + b"1,2\n" * 1000 + b" " * (2 << 20)))
    assert "line 1002 is longer than 1048576 characters" in refusal(path)
    monkeypatch.setattr(options, "LEAST_DECODED", 1 << 20)
    path.write_bytes(gzip.compress(b"a,b\n" + b"1,2\n" * (1 << 19)))
    assert "unpacked it is 0.000977 GiB or more" in refusal(path)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1" * 300_000 + "x\n1,2\n3,4\n", None),  # digits that end in a letter
        ("[" * 300_000 + "\n1,2\n3,4\n", None),
        (" " * 200_000 + "a b\n1,2\n3,4\n", None),
        ("channels: " + "9" * 6000 + "\na,b\n1,2\n3,4\n", None),
        (("1," * 5000 + "1\n") * 3, "5001 columns; allowed 1..4096"),
    ],
)
def test_long_lines_cost_no_more_than_their_length(
    tmp_path: Path, text: str, why: str | None
) -> None:
    path = tmp_path / "long.csv"
    path.write_text(text, encoding="utf-8")
    begun = spent()
    if why is None:
        with suppress(InputError):
            read_record(path)
    else:
        assert why in refusal(path)
    assert spent() - begun < 2.0


def test_a_name_stored_four_thousand_times_is_sorted_out_at_once(tmp_path: Path) -> None:
    path = tmp_path / "names.csv"
    rows = [",".join(["a"] * 4000)] + [
        ",".join(str(i * j % 7) for i in range(4000)) for j in (1, 2)
    ]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    begun = spent()
    record = read_record(path)
    assert len(set(record.names)) == len(record.names) > 1000
    assert spent() - begun < 5.0


def test_columns_on_disk_are_those_of_the_text(tmp_path: Path) -> None:
    table = np.random.default_rng(3).standard_normal((70_000, 3))
    table[:, 0] = np.arange(len(table)) / 1000.0
    path = tmp_path / "rig.csv"
    np.savetxt(path, table, "%.17g", ",", header="time [s],a [g],b [g]", comments="")
    stored = read_record(path)
    assert stored.samples == len(table)
    for place, channel in enumerate(stored.channels, start=1):
        np.testing.assert_array_equal(channel.values(), table[:, place])
        part = channel.values(32_000, stop=33_500)
        np.testing.assert_array_equal(part, table[32_000:33_500, place])


def test_a_reader_that_crashes_costs_its_own_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "asammdf.py").write_text("import os\nos.abort()\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    path = tmp_path / "rig.mf4"
    path.write_bytes(b"MDF     4.10".ljust(64, b"\0"))
    with pytest.raises(InputError, match=r"cannot be read as MDF: its reader ended with code -6"):
        read_record(path)


def test_a_tdms_that_states_more_than_it_has(tmp_path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    path = tmp_path / "rig.tdms"
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([ChannelObject("rig", "a1", np.arange(500.0))])
    raw = path.read_bytes()
    stated = struct.pack("<Q", 500)
    assert raw.count(stated) == 1
    path.write_bytes(raw.replace(stated, struct.pack("<Q", 1 << 40)))
    assert read_record(path).samples <= 500


def test_groups_nested_without_end_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "deep.h5"
    with h5py.File(path, "w") as file:
        group = file
        for _ in range(70):
            group = group.create_group("g")
        group["a"] = np.arange(8.0)
    with pytest.raises(InputError, match=r"HDF5: groups are nested more than 64 deep"):
        read_record(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_a_pipe_is_refused_without_waiting_for_it(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    told = r"pipe; it is a pipe or a device; write it to a file first"
    for read in (read_record, load_case, read_rexs):
        with pytest.raises(InputError, match=told):
            read(tmp_path / "pipe")
