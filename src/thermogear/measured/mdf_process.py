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


_AXES = {2: "angle", 3: "distance", 4: "index"}
"""What a master channel counts by its type of synchronisation, where that is no time."""


def read_from(asammdf: Any, path: Path, folder: Path) -> dict[str, Any]:
    """Names, units and groups of the channels; samples, and stamps of each group, go to ``folder``.

    Samples that the file marks as invalid are NaN.
    """
    channels: list[dict[str, Any]] = []
    with asammdf.MDF(str(path)) as file:
        for item in file.iter_channels():
            samples = np.asarray(item.samples)
            stamps = np.asarray(item.timestamps, dtype=float)
            if samples.dtype.kind not in "iuf" or samples.ndim != 1 or stamps.size < 3:
                continue
            if item.invalidation_bits is not None and np.any(item.invalidation_bits):
                samples = np.where(np.asarray(item.invalidation_bits), np.nan, samples)
            group = int(item.group_index)
            axis = _AXES.get((item.master_metadata or ("", 1))[1], "time")
            np.save(folder / f"stamps{group}.npy", stamps)
            np.save(folder / f"{len(channels)}.npy", samples)
            whole = file.groups[group]
            master = file.masters_db.get(group)
            label = "" if master is None else str(whole.channels[master].unit or "")
            count = int(whole.channel_group.cycles_nr)
            facts = {"name": str(item.name), "unit": str(item.unit or ""), "axis": axis}
            channels.append(facts | {"group": group, "count": count, "axis_unit": label})
    return {"channels": channels}


def main(words: list[str]) -> int:
    """What is found, or why nothing is, as ``parts.json``."""
    path, folder = Path(words[0]), Path(words[1])
    logging.disable(logging.CRITICAL)
    warnings.simplefilter("ignore")
    asammdf = importlib.import_module("asammdf")
    bounded(memory=int(words[2]), seconds=int(words[3]))
    read: dict[str, Any]
    try:
        read = read_from(asammdf, path, folder)
    except MemoryError:
        read = {"error": "it states more values than the memory it may take can hold"}
    except Exception as error:  # a foreign reader's failures are of any type
        read = {"error": str(error) or type(error).__name__}
    (folder / "parts.json").write_text(json.dumps(read), "utf-8")
    return 0


if __name__ == "__main__":
    code = main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(code)  # half-built readers fail again when they are taken away: not here
