"""Reads an MDF file for :mod:`thermogear.measured.optional`, as a process of its own.

    python mdf_process.py FILE FOLDER BYTES SECONDS

Its reader, asammdf, decodes in C and may crash on a damaged file; here that costs a process that
nobody misses. FOLDER receives ``parts.json`` and the samples of channel N as ``N.npy``. Beside
what it takes at rest it may take BYTES of memory and SECONDS of the processor.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import logging
import os
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np


def bounded(*, memory: int, seconds: int) -> None:
    """Where the system can: no more than ``memory`` bytes and ``seconds`` beside those taken."""
    try:
        import resource
    except ImportError:  # Windows
        return
    with contextlib.suppress(OSError, ValueError):
        held = int(Path("/proc/self/statm").read_text("ascii").split()[0])
        most = held * os.sysconf("SC_PAGE_SIZE") + memory
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
    used = int(sum(resource.getrusage(resource.RUSAGE_SELF)[:2]))
    resource.setrlimit(resource.RLIMIT_CPU, (used + seconds, used + seconds + 1))


def found_in(asammdf: Any, path: Path, folder: Path) -> dict[str, Any]:
    """Names, units, rates, and which channels have an uneven time; the samples go to ``folder``."""
    channels: list[dict[str, str]] = []
    rates: list[tuple[float, str]] = []
    uneven: list[str] = []
    with asammdf.MDF(str(path)) as file:
        for item in file.iter_channels():
            samples = np.asarray(item.samples)
            stamps = np.asarray(item.timestamps, dtype=float)
            if samples.dtype.kind not in "iuf" or samples.ndim != 1 or stamps.size < 3:
                continue
            steps = np.diff(stamps)
            step = float((stamps[-1] - stamps[0]) / steps.size)
            name = str(item.name)
            if step > 0 and np.max(np.abs(steps - step)) <= 0.5 * step:
                rates.append((1.0 / step, f"time base of {name}"))
            else:
                uneven.append(name)
            np.save(folder / f"{len(channels)}.npy", samples)
            channels.append({"name": name, "unit": str(item.unit or "")})
    return {"channels": channels, "rates": rates, "uneven": uneven}


def main(words: list[str]) -> int:
    """What is found, or why nothing is, as ``parts.json``."""
    path, folder = Path(words[0]), Path(words[1])
    logging.disable(logging.CRITICAL)
    warnings.simplefilter("ignore")
    asammdf = importlib.import_module("asammdf")
    bounded(memory=int(words[2]), seconds=int(words[3]))
    found: dict[str, Any]
    try:
        found = found_in(asammdf, path, folder)
    except MemoryError:
        found = {"error": "it states more values than the memory it may take can hold"}
    except Exception as error:  # a foreign reader's failures are of any type
        found = {"error": str(error) or type(error).__name__}
    (folder / "parts.json").write_text(json.dumps(found), "utf-8")
    return 0


if __name__ == "__main__":
    code = main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(code)  # half-built readers fail again when they are taken away: not here
