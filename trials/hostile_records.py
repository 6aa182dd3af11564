"""Good records of every kind that the trial of mutated files breaks, short and long."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import io

ROOT = Path(__file__).parents[1]

SHORT, LONG = 288, 4096
"""Samples: of the shortest record that passes the gate and of one whose mesh line has an angle."""

RATE = 12_800.0
JOINED = {"joined channels": "channels", "joined time": "time"}
TACHO = "tacho file"
RECORDS = (
    "plain.csv", "semicolon.txt", "tabs.txt.gz", "clocks.csv", "rig.lvm", "five.mat", "cells.mat",
    "seven.mat", "rig.h5", "rig.npz", "rig.npy", "rig.wav", "rig.tdms", "rig.uff", "rig.mf4",
    *JOINED, TACHO,
)  # fmt: skip

_LVM = """LabVIEW Measurement\t
Separator\tTab
Date\t2020/01/05
***End_of_Header***\t
Channels\t2\t\t
Y_Unit_Label\tg\tg\t
Delta_X\t{step}\t{step}\t
***End_of_Header***\t\t\t
X_Value\ta1\ta2\tComment
"""


def record(kind: str, folder: Path, count: int) -> bytes:
    """The bytes of a good record of a kind, with ``count`` samples a channel."""
    sys.path.insert(0, str(ROOT / "tests" / "measured"))
    import record_makers
    import test_foreign_formats as foreign

    table = _table(record_makers.mesh_train, count, 1 if kind in JOINED else 2)
    foreign.COUNT, foreign.TIME = count, np.arange(count) / foreign.RATE
    foreign.LINE = table[0]
    writers: dict[str, Callable[[Path], object]] = {
        name: lambda path, write=write: write(path, table)
        for name, write in record_makers.WRITERS.items()
    }
    writers |= {"rig.tdms": foreign.tdms, "rig.uff": foreign.uff, "rig.mf4": foreign.mdf}
    writers |= {
        "clocks.csv": lambda path: _clocks(path, table),
        "rig.lvm": lambda path: _lvm(path, table),
        "cells.mat": lambda path: _cells(path, table),
        "joined channels": lambda path: _piece(path, table[0], 0),
        "joined time": lambda path: _piece(path, table[0], count),
        TACHO: lambda path: _piece(path, np.where(np.arange(count) % 29 < 6, 5.0, 0.1), 0),
    }
    path = named(folder, "made", kind)
    writers[kind](path)
    data = path.read_bytes()
    path.unlink()
    return data


def named(folder: Path, word: str, kind: str) -> Path:
    """A file of a kind, its name as its reader wants it."""
    return folder / f"{word}_{kind.replace(' ', '_')}{'' if '.' in kind else '.csv'}"


def command(kind: str, folder: Path, count: int, path: Path) -> list[str]:
    """The words that read ``path``, a file of a kind, with the good files that it stands beside."""
    words = ["measure", str(path)]
    if kind not in JOINED and kind != TACHO:
        return words
    beside = folder / f"good_{count}.csv"
    if not beside.exists():
        sys.path.insert(0, str(ROOT / "tests" / "measured"))
        import record_makers

        _piece(beside, _table(record_makers.mesh_train, count, 1, seed=2)[0], 0)
    if kind == TACHO:
        return ["measure", str(beside), "--tacho", str(path), "--pulses", "1"]
    return ["measure", str(beside), str(path), "--join", JOINED[kind]]


def _table(
    train: Callable[..., NDArray[np.float64]], count: int, channels: int, seed: int = 1
) -> NDArray[np.float64]:
    """A drive train's signal; the short one has too few mesh cycles for an angle."""
    position = 12.0 / count if count == SHORT else 0.0746
    return train(count, position, channels=channels, seed=seed)


def _piece(path: Path, values: NDArray[np.float64], first: int) -> None:
    time = (first + np.arange(values.size)) / RATE
    rows = [f"{t:.9f},{v:.6g}" for t, v in zip(time, values, strict=True)]
    path.write_text("time [s],a1 [g]\n" + "\n".join(rows) + "\n", "utf-8")


def _clocks(path: Path, table: NDArray[np.float64]) -> None:
    rows = [
        f"2024-01-05 12:00:{j / RATE:09.6f},{a:.6g},{b:.6g}"
        for j, (a, b) in enumerate(table.T.tolist())
    ]
    path.write_text("timestamp,a1 [g],a2 [g]\n" + "\n".join(rows) + "\n", "utf-8")


def _lvm(path: Path, table: NDArray[np.float64]) -> None:
    rows = [f"{j / RATE:.9f}\t{a:.6g}\t{b:.6g}" for j, (a, b) in enumerate(table.T.tolist())]
    rows[0] += "\tstart, here"
    head = _LVM.format(step=f"{1.0 / RATE:.9f}")
    path.write_text(head + "\n".join(rows) + "\n", "utf-8")


def _cells(path: Path, table: NDArray[np.float64]) -> None:
    cells = np.empty((1, 2), object)
    cells[0, 0], cells[0, 1] = table
    many = np.zeros((1, 2), dtype=[("x", object), ("word", object)])
    many["x"][0] = [table[0] - table[1], table[0] + table[1]]
    many["word"][0] = ["one", "two"]
    io.savemat(path.with_suffix(".mat"), {"data": cells, "run": many, "dt": 1.0 / RATE},
               do_compression=True)  # fmt: skip
    path.with_suffix(".mat").replace(path)


def forked(words: list[str], _: dict[str, Any]) -> int:
    """The reader of MDF in a fork of this process, which holds what a new one would load."""
    from thermogear.measured import mdf_process

    child = os.fork()
    if child == 0:
        try:
            tempfile.tempdir = words[1]
            with open(os.devnull, "r+b") as nothing:
                for number in (0, 1, 2):
                    os.dup2(nothing.fileno(), number)
            code = mdf_process.main(words)
        except BaseException:
            os._exit(1)
        os._exit(code)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
