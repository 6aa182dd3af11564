"""A synthetic rig whose truth is known, and writers of it in every format."""

from __future__ import annotations

import gzip
import wave
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray
from scipy import io

Floats = NDArray[np.float64]

RATE = 12_800.0
TEETH = (32, 80)
MESH_HZ = 955.3
G = 9.80665
SHARED = Path(__file__).parents[3] / "shared" / "data" / "spectraquest_gfd"


def mesh_train(
    count: int = 1 << 16,
    position: float = MESH_HZ / RATE,
    teeth: tuple[int, int, int, int] = (32, 80, 48, 64),
    noise: float = 0.1,
    seed: int = 1,
    channels: int = 2,
    wander: float = 0.03,
) -> Floats:
    """Two meshes on three shafts [g]: pinion/wheel, then a second pair; the phase wanders."""
    rng = np.random.default_rng(seed)
    n = np.arange(count)
    cycles = position * n + wander * np.sin(4 * np.pi * n / count)
    first = cycles / teeth[0]
    second = first * teeth[0] / teeth[1]
    third = second * teeth[2] / teeth[3]
    table = []
    for c in range(channels):
        x = 0.02 * np.cos(2 * np.pi * first + c) + 0.05 * np.cos(2 * np.pi * third)
        swing = 1.0 + 0.25 * np.cos(2 * np.pi * first + c) + 0.12 * np.cos(4 * np.pi * first + 1)
        swing = swing + 0.2 * np.cos(2 * np.pi * second + 0.3 * c)
        swing = swing + 0.07 * np.cos(6 * np.pi * first) + 0.07 * np.cos(4 * np.pi * second)
        for rank, amplitude in ((1, 1.0), (2, 0.6), (3, 0.4), (4, 0.2), (5, 0.1)):
            x = x + amplitude * swing * np.cos(2 * np.pi * rank * cycles + rank + c)
        slow = 1.0 + 0.3 * np.cos(2 * np.pi * third)
        for rank, amplitude in ((1, 0.5), (2, 0.3), (3, 0.2), (4, 0.15)):
            x = x + amplitude * slow * np.cos(2 * np.pi * rank * teeth[2] * second + c)
        table.append(x + noise * rng.standard_normal(count))
    return np.asarray(table)


def quantised(table: Floats, bits: int = 16, full: float = 8.0) -> Floats:
    """What a converter of so many bits leaves over a range of +-``full``."""
    step = full * 2.0 ** (1 - bits)
    return np.clip(np.round(table / step), -(2 ** (bits - 1)), 2 ** (bits - 1) - 1) * step


def csv_text(
    table: Floats,
    separator: str = ",",
    decimal: str = ".",
    units: bool = True,
    time: bool = True,
    rate: float = RATE,
    digits: int = 7,
) -> str:
    names = ["time"] if time else []
    names += [f"a{i + 1}" for i in range(len(table))]
    rows = [separator.join(names)]
    if units:
        rows.append(separator.join((["s"] if time else []) + ["g"] * len(table)))
    for j in range(table.shape[1]):
        cells = [f"{j / rate:.9f}"] if time else []
        cells += [f"{v:.{digits}g}" for v in table[:, j]]
        rows.append(separator.join(cell.replace(".", decimal) for cell in cells))
    return "\n".join(rows) + "\n"


def write_csv(path: Path, table: Floats) -> dict[str, object]:
    path.write_text(csv_text(table), encoding="utf-8")
    return {}


def write_semicolon(path: Path, table: Floats) -> dict[str, object]:
    path.write_text(csv_text(table, ";", ","), encoding="utf-8-sig")
    return {}


def write_gz(path: Path, table: Floats) -> dict[str, object]:
    with gzip.open(path, "wt", encoding="utf-16") as file:
        file.write(csv_text(table, "\t"))
    return {}


def write_mat5(path: Path, table: Floats) -> dict[str, object]:
    content = {"acc": table.T, "fs": RATE}
    io.savemat(path, content, do_compression=True)
    return {"unit": "g"}


def write_mat73(path: Path, table: Floats) -> dict[str, object]:
    with h5py.File(path, "w", userblock_size=512) as file:
        for i, channel in enumerate(table):
            data = file.create_dataset(f"a{i + 1}", data=channel[None, :])
            data.attrs["MATLAB_class"] = np.bytes_("double")
        file.create_dataset("fs", data=np.array([[RATE]]))
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\2IM"
    with path.open("r+b") as raw:
        raw.write(head)
    return {"unit": "g"}


def write_hdf(path: Path, table: Floats) -> dict[str, object]:
    with h5py.File(path, "w") as file:
        for i, channel in enumerate(table):
            data = file.create_dataset(f"rig/a{i + 1}", data=channel, chunks=True)
            data.attrs["units"] = "m/s^2"
            data[...] = channel * G
        file.attrs["sampling_rate"] = RATE
    return {}


def write_npz(path: Path, table: Floats) -> dict[str, object]:
    np.savez_compressed(path, **{f"a{i + 1}": c for i, c in enumerate(table)}, fs=RATE)
    return {"unit": "g"}


def write_npy(path: Path, table: Floats) -> dict[str, object]:
    np.save(path, table)
    return {"unit": "g", "rate": RATE}


def write_wav(path: Path, table: Floats) -> dict[str, object]:
    full = 8.0
    with wave.open(str(path), "wb") as file:
        file.setnchannels(len(table))
        file.setsampwidth(2)
        file.setframerate(int(RATE))
        file.writeframes(np.round(table.T / full * 32768).astype("<i2").tobytes())
    return {"unit": "g", "scale": full}


Writer = Callable[[Path, Floats], dict[str, object]]
WRITERS: dict[str, Writer] = {
    "plain.csv": write_csv,
    "semicolon.txt": write_semicolon,
    "tabs.txt.gz": write_gz,
    "five.mat": write_mat5,
    "seven.mat": write_mat73,
    "rig.h5": write_hdf,
    "rig.npz": write_npz,
    "rig.npy": write_npy,
    "rig.wav": write_wav,
}
