"""Malformed files: mutations of good ones in every format give a record or one line, no more."""

from __future__ import annotations

import gzip
import warnings
from pathlib import Path

import numpy as np
import pytest
from record_makers import WRITERS, csv_text, mesh_train

from conftest import AtLength
from thermogear.base.errors import InputError
from thermogear.measured.readers import read_record


def good_files(folder: Path) -> dict[str, bytes]:
    table = mesh_train(120)
    found = {}
    for name, write in WRITERS.items():
        write(folder / name, table)
        found[name] = (folder / name).read_bytes()
    found["blanks.txt"] = csv_text(table, " ", ",", units=False).encode()
    found["gbk.csv"] = csv_text(table).replace("time", "时间").encode("gbk")
    return found


def mutated(data: bytes, rng: np.random.Generator) -> bytes:
    """Bits flipped, bytes replaced, pieces cut, doubled, swapped, zeroed or inserted."""
    raw = bytearray(data)
    for _ in range(int(rng.integers(1, 6))):
        if not raw:
            break
        place = int(rng.integers(0, len(raw)))
        # the structure of binary formats stands in their first bytes: hit it often
        if rng.random() < 0.4:
            place = int(rng.integers(0, min(len(raw), 700)))
        size = int(rng.integers(1, 1 + max(1, min(64, len(raw) - place))))
        kind = int(rng.integers(0, 9))
        if kind == 0:
            raw[place] ^= 1 << int(rng.integers(0, 8))
        elif kind == 1:
            raw[place : place + size] = rng.bytes(size)
        elif kind == 2:
            del raw[place : place + size]
        elif kind == 3:
            del raw[place:]
        elif kind == 4:
            raw[place:place] = raw[place : place + size]
        elif kind == 5:
            raw[place : place + size] = bytes(size)
        elif kind == 6:
            raw[place : place + 4] = b"\xff\xff\xff\x7f"
        elif kind == 7:
            raw[place:place] = rng.choice([b",", b";", b"\n", b"nan", b'"', b"\0", b"-", b"1e999"])
        else:
            raw[place] = int(rng.integers(0, 256))
    return bytes(raw)


def hammer(folder: Path, count: int, seed: int) -> tuple[int, list[str]]:
    """``count`` mutated files: how many were read, and what the refusals of the others say."""
    files = good_files(folder)
    names = list(files)
    rng = np.random.default_rng(seed)
    read, refusals = 0, []
    for number in range(count):
        name = names[number % len(names)]
        path = folder / f"bad_{name}"
        path.write_bytes(mutated(files[name], rng))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                record = read_record(path)
            read += record.samples >= 1
        except InputError as error:
            refusals.append(str(error))
    return read, refusals


def test_malformed_files_make_no_traceback(tmp_path: Path) -> None:
    read, refusals = hammer(tmp_path, 330, seed=5)
    assert read + len(refusals) == 330
    assert len(refusals) > 30
    assert [r for r in refusals if "\n" in r or len(r) > 500] == []


@pytest.mark.slow
def test_more_malformed_files_make_no_traceback(tmp_path: Path, at_length: AtLength) -> None:
    count = at_length(400, 10_000, "record files, mutated")
    read, refusals = hammer(tmp_path, count, seed=2)
    assert read + len(refusals) == count
    assert [r for r in refusals if "\n" in r or len(r) > 500] == []


@pytest.mark.parametrize(
    "content", [b"", b"\n\n", b"a,b\n", b"\x1f\x8b", b"\x1f\x8bgarbage", b"PK\x03\x04", b"RIFF"]
)
@pytest.mark.parametrize("name", ["x.csv", "x.npz", "x.mat", "x.h5", "x.wav", "x.npy"])
def test_empty_and_cut_files_are_refused_in_one_line(
    tmp_path: Path, content: bytes, name: str
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=rf"^file: got {name}; cannot be read as "):
        read_record(path)


def test_a_packed_text_that_ends_in_its_first_lines_is_refused(tmp_path: Path) -> None:
    """Bytes without their end that hold fewer characters than are looked at first."""
    random = np.random.default_rng(3)
    rows = "\n".join(f"{a:.9g}\t{b:.9g}" for a, b in random.standard_normal((9000, 2)))
    packed = gzip.compress(("a\tb\n" + rows).encode(), 9)
    for length in range(100, len(packed), len(packed) // 12):
        path = tmp_path / "cut.txt.gz"
        path.write_bytes(packed[:length])
        with pytest.raises(InputError, match="end-of-stream"):
            read_record(path)
