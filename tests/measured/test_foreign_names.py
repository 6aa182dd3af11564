"""Names out of foreign files: no byte that leaves the program rewrites a terminal or a page."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import asammdf
import h5py
import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy import io
from test_foreign_formats import uff

from thermogear.front.cli import main

RATE = 12_800.0
TIME = np.arange(4096) / RATE
LINE = np.cos(2.0 * np.pi * 640.0 * TIME) + 0.01 * np.cos(2.0 * np.pi * 3000.0 * TIME)
EVIL = "a\x1b[2J\x1b]0;owned\x07\u202e<script>alert(1)</script>\u2066"
RAW = [b"\x1b[2J", b"\x1b]0;", b"owned\x07", "\u202e".encode(), "\u2066".encode(), b"\\u202e"]


def text(path: Path) -> None:
    rows = "".join(f"{t:.9f},{v:.7g},{v:.7g}\n" for t, v in zip(TIME, LINE, strict=True))
    path.write_text(f"time,{EVIL},=cmd|' /C calc'!A0\ns,{EVIL},g\n{rows}", encoding="utf-8")


def hdf(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name in (EVIL.replace("/", "|"), "=cmd"):
            file[name] = LINE
            file[name].attrs["units"] = EVIL
        file.attrs["sampling_rate"] = RATE
        file.attrs["title"] = EVIL


def packed(path: Path) -> None:
    np.savez(path, **{EVIL.replace("/", "|"): LINE, "=cmd": LINE, "fs": RATE})


def mat(path: Path) -> None:
    content = {"data": LINE, "name": EVIL, "units": EVIL}
    io.savemat(path, {"a": content, "fs": RATE})


def tdms(path: Path) -> None:
    properties = {"wf_increment": 1.0 / RATE, "unit_string": EVIL, "description": EVIL}
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([ChannelObject(EVIL, n, LINE, properties) for n in (EVIL, "=cmd")])


def uff_58(path: Path) -> None:
    uff(path, "\x1b[2J\u202e", "\x1b]0;b\x07")


def mdf(path: Path) -> None:
    file = asammdf.MDF()
    file.append([asammdf.Signal(LINE, TIME, name=n, unit=EVIL) for n in (EVIL, "=cmd")])
    file.save(path)
    file.close()


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("a.csv", text), ("a.h5", hdf), ("a.npz", packed), ("a.mat", mat), ("a.tdms", tdms),
        ("a.uff", uff_58), ("a.mf4", mdf),
    ],
)  # fmt: skip
def test_no_byte_of_a_foreign_name_is_passed_on_raw(
    name: str,
    write: Callable[[Path], None],
    tmp_path: Path,
    capfdbinary: pytest.CaptureFixture[bytes],
) -> None:
    write(tmp_path / name)
    options = ["--unit", "g", "--rate", str(RATE)]
    asked = [["-o", str(tmp_path / "out")], ["--channel", "none"], ["--json"]]
    for words in asked[: 3 if name == "a.csv" else 2]:
        main(["measure", str(tmp_path / name), *options, *words])
    kept = [p for p in sorted((tmp_path / "out").rglob("*")) if p.is_file()]
    out, err = capfdbinary.readouterr()
    assert kept
    for content in (out, err, *(path.read_bytes() for path in kept)):
        for raw in RAW:
            assert raw not in content, content[max(0, content.find(raw) - 60) :][:120]
    pages = [path.read_text("utf-8") for path in kept if path.suffix in {".html", ".svg"}]
    assert not any("<script>alert" in page for page in pages)
    tables = [path.read_text("utf-8") for path in kept if path.suffix == ".csv"]
    assert not any(re.search(r"(?m)(^|,)\"?=cmd", table) for table in tables)
