"""Records measured on the cores that there are: same rows, same order, one process each."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.progress import Progress
from thermogear.measured.record import Notice
from thermogear.measured.reduction import Measurement
from thermogear.measured.same_line import Place, places_of

Read = Callable[[Path], Measurement]

_WORTH = 5.0
"""Seconds of work left from which processes are started: each takes about one to begin."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """What is kept of one record: its lines' ``readings`` with half widths and their ``places``,
    ``unit``, why readings are ``withheld``, what
    damage was ``found``; or why it was ``refused``."""

    file: Path
    unit: str = ""
    readings: dict[tuple[str, str], tuple[float, float]] = field(default_factory=dict)
    places: dict[tuple[str, str], Place] = field(default_factory=dict, compare=False)
    refused: str = ""
    withheld: str = ""
    found: tuple[Notice, ...] = ()
    warned: tuple[str, ...] = ()


def row_of(read: Read, file: Path) -> Row:
    """Measure one file; an input that is refused, or that the system or memory fails, is a row."""
    with warnings.catch_warnings(record=True, action="always", category=ValidityWarning) as caught:
        try:
            found = read(file)
        except InputError as error:
            return Row(file=file, refused=str(error))
        except (MemoryError, OSError) as error:
            return Row(file=file, refused=str(error) or "it does not fit in memory")
    why = {one.channel: one.withheld for one in found.lines if np.isnan(one.reading)}
    return Row(
        file=file,
        unit=found.record.channel(found.channels[0]).unit or "",
        readings={
            (one.channel, one.name): (one.reading, one.reading * one.half_width)
            for one in found.lines
            if np.isfinite(one.reading)
        },
        places=places_of(found),
        withheld="; ".join(f"channel {name!r}: {said}" for name, said in why.items() if said),
        found=found.findings,
        warned=tuple(str(one.message) for one in caught),
    )


def rows_of(read: Read, files: Sequence[Path], *, cores: int, progress: Progress) -> list[Row]:
    """The rows of ``files`` in their order, in up to ``cores`` processes.

    Files are measured here, one after another, until it is clear that what is left is worth other
    processes; for those ``read`` must be one that can be sent there. A file whose process ends by
    itself is refused.
    """
    found: dict[Path, Row] = {}
    began = time.perf_counter()
    left = list(files)
    while left:
        if cores > 1 and found and len(left) > 1:
            spent = time.perf_counter() - began
            if spent / len(found) * len(left) > _WORTH:
                break
        found[left[0]] = row_of(read, left[0])
        left.pop(0)
        progress("records", len(found), len(files))
    if left:
        for row in _elsewhere(read, left, min(cores, len(left))):
            found[row.file] = row
            progress("records", len(found), len(files))
    for file in files:
        for text in found[file].warned:
            warnings.warn(text, ValidityWarning, stacklevel=2)
    return [found[file] for file in files]


def _elsewhere(read: Read, files: Sequence[Path], cores: int) -> Iterator[Row]:
    """Rows as they come; files that were lost with another's process are tried again alone."""
    lost: list[Path] = []
    with _pool(cores) as pool:
        work: dict[Future[Row], Path] = {pool.submit(row_of, read, one): one for one in files}
        for done in as_completed(work):
            try:
                yield done.result()
            except BrokenProcessPool:
                lost.append(work[done])
    for file in sorted(lost, key=files.index):
        with _pool(1) as pool:
            try:
                yield pool.submit(row_of, read, file).result()
            except BrokenProcessPool:
                why = "the process that read it ended: it is damaged, or too large for the memory"
                yield Row(file=file, refused=why)


@contextmanager
def _pool(cores: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that start anew, so that no lock is inherited; on an error or Ctrl+C they end."""
    before = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(
        cores,
        mp_context=multiprocessing.get_context("spawn"),
        initializer=signal.signal,  # Ctrl+C is the parent's: it ends its children
        initargs=(signal.SIGINT, signal.SIG_IGN),
    )
    try:
        yield pool
    except BaseException:
        for child in set(multiprocessing.active_children()) - before:
            child.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def cores_here() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
