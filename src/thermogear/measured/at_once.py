"""Records measured on the cores that there are: same rows, same order, one process each."""

from __future__ import annotations

import multiprocessing
import os
import signal
import warnings
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.progress import Progress
from thermogear.measured.record import Notice
from thermogear.measured.reduction import Measurement
from thermogear.measured.same_line import Place, places_of

Read = Callable[[Path], Measurement]

_FEW = 8  # files, for which no processes are started: each takes about a second to begin


@dataclass(frozen=True, kw_only=True)
class Row:
    """What is kept of one record: its lines' ``readings`` with half widths and their ``places``,
    names of the ``harmonics`` by rank, ``unit``, why readings are ``withheld``, what
    damage was ``found``; or why it was ``refused``."""

    file: Path
    unit: str = ""
    readings: dict[tuple[str, str], tuple[float, float]] = field(default_factory=dict)
    places: dict[tuple[str, str], Place] = field(default_factory=dict, compare=False)
    harmonics: tuple[str, ...] = ()
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
            for one in found.readings
            if np.isfinite(one.reading)
        },
        places=places_of(found),
        harmonics=found.harmonics,
        withheld="; ".join(f"channel {name!r}: {said}" for name, said in why.items() if said),
        found=found.findings,
        warned=tuple(str(one.message) for one in caught),
    )


def rows_of(read: Read, files: Sequence[Path], *, cores: int, progress: Progress) -> list[Row]:
    """The rows of ``files`` in their order; of many files in ``cores`` processes, which ``read``
    must be one that can be sent to.

    Raises InputError where a process ends by itself.
    """
    rows: list[Row] = []
    with ExitStack() as stack:
        made: Iterable[Row] = (row_of(read, file) for file in files)
        if cores > 1 and len(files) > _FEW:
            pool = ProcessPoolExecutor(
                min(cores, len(files)),
                mp_context=multiprocessing.get_context("spawn"),  # so that no lock is inherited
                initializer=signal.signal,  # Ctrl+C is the parent's
                initargs=(signal.SIGINT, signal.SIG_IGN),
            )
            made = stack.enter_context(pool).map(partial(row_of, read), files)
        try:
            for row in made:
                rows.append(row)
                progress("records", len(rows), len(files))
        except BrokenProcessPool as error:
            why = "a process ended: a file near it is damaged, or too large for the memory"
            raise InputError("file", files[len(rows)].name, why=why, fix="leave it out") from error
    for row in rows:
        for text in row.warned:
            warnings.warn(text, ValidityWarning, stacklevel=2)
    return rows


def cores_here() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
