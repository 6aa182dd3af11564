"""A record larger than a machine likes: made, read and measured by hand, not by the test run.

    python tests/measured/large_trial.py DIR GIGABYTES csv|hdf5

Writes a four-channel record of that size to DIR, reads it in a fresh process and prints seconds
per million samples and the peak memory of that process.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

CHANNELS = 4
BLOCK = 500_000
READ = """
import json, resource, sys, time
from thermogear import read_record
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
start = time.perf_counter()
record = read_record(sys.argv[1], rate=float(sys.argv[2]), unit="m/s^2")
numbers = 0
total = 0.0
for channel in record.channels:
    for block in channel.blocks():
        total += float(block.sum())
        numbers += block.size
seconds = time.perf_counter() - start
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps({"numbers": numbers, "seconds": seconds, "before": before, "peak": peak}))
"""


def block(number: int) -> np.ndarray:
    """One block of a mesh line with noise, (BLOCK, CHANNELS)."""
    rng = np.random.default_rng(number)
    t = (number * BLOCK + np.arange(BLOCK)) / 25600.0
    line = np.sin(2.0 * np.pi * 416.667 * t)[:, None] * np.arange(1, CHANNELS + 1)
    return line + 0.1 * rng.normal(size=(BLOCK, CHANNELS))


def write(path: Path, size: float) -> None:
    """Blocks until the file holds ``size`` bytes."""
    if path.suffix == ".csv":
        with path.open("w", encoding="utf-8") as file:
            file.write(",".join(f"a{i + 1}" for i in range(CHANNELS)) + "\n")
            number = 0
            while file.tell() < size:
                np.savetxt(file, block(number), fmt="%.6f", delimiter=",")
                number += 1
        return
    import h5py

    with h5py.File(path, "w") as file:
        blocks = max(1, round(size / (8.0 * BLOCK * CHANNELS)))
        data = {
            f"a{i + 1}": file.create_dataset(f"a{i + 1}", (blocks * BLOCK,), float)
            for i in range(CHANNELS)
        }
        for number in range(blocks):
            rows = block(number)
            for i, store in enumerate(data.values()):
                store[number * BLOCK : (number + 1) * BLOCK] = rows[:, i]


def main(folder: str, gigabytes: str, kind: str) -> None:
    """Make, read, report."""
    path = Path(folder) / ("large.csv" if kind == "csv" else "large.h5")
    start = time.perf_counter()
    write(path, float(gigabytes) * 1e9)
    made = time.perf_counter() - start
    done = subprocess.run(
        [sys.executable, "-c", READ, str(path), "25600"], capture_output=True, text=True, check=True
    )
    found = json.loads(done.stdout)
    per_million = found["seconds"] / found["numbers"] * 1e6
    print(
        f"{path.stat().st_size / 1e9:.2f} GB {kind}: made in {made:.0f} s; read {found['numbers']} "
        f"numbers in {found['seconds']:.1f} s ({per_million:.3f} s per million), peak memory "
        f"{found['peak'] / 1024:.0f} MB ({found['before'] / 1024:.0f} MB before reading)"
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
