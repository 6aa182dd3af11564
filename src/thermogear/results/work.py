"""Carry a plan out: estimate, threads, a store or memory, progress, Ctrl+C."""

from __future__ import annotations

import math
import os
import shutil
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

from numba.core.event import install_timer

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.memory import SHARE, free_bytes
from thermogear.base.plan import (
    Alive,
    Plan,
    bytes_of,
    computed,
    gather,
    keep_going,
    keys_of,
)
from thermogear.base.progress import duration
from thermogear.results.store import Store

WORKSPACE = 48 * 2**20
"""Bytes that one thread's kernels and maps take, about."""

SPENT = 1.0 / 20.0
"""Share of the work's time that an estimate takes, about."""
BRIEF, LONG = 1.0, 5.0
"""Seconds that every estimate may take, and those from which its first points must do."""


@dataclass(frozen=True, kw_only=True)
class Step:
    """How far the work is: chunks ``done`` of ``total`` (``found`` of them were there before),
    ``elapsed`` and ``remaining`` seconds (NaN while unknown)."""

    done: int
    total: int
    found: int
    elapsed: float
    remaining: float


Report = Callable[[Step], None]


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """What a plan will take: ``points``, ``chunks``, bytes of memory and disk, seconds.

    ``behind``: in words what follows behind the chunks, whose number they tell.
    """

    points: int
    chunks: int
    memory: int
    disk: int
    seconds: float
    behind: str = ""

    def __str__(self) -> str:
        return (
            f"{self.points} points in {self.chunks} chunks, about {duration(self.seconds)}, "
            f"{self.memory / 2**20:.3g} MiB of memory, {self.disk / 2**20:.3g} MiB of disk"
            + self.behind
        )


def points_of(plan: Plan) -> int:
    """How many points a plan has, as a whole Python integer."""
    return math.prod(int(plan.sizes[name]) for name in plan.variables()["status"].dims)


def estimate(plan: Plan, *, threads: int | None = None) -> Estimate:
    """What ``plan`` will take, from its sizes and from a part of it that is done now.

    The part grows up to a twentieth of the whole (:data:`SPENT`), on as many threads as the work
    will have; compiling kernels does not count. Points near borders cost more than others: the
    time is a guess within a factor of about 2.
    """
    behind = getattr(plan, "behind", str)
    seconds = _seconds(plan, threads or os.cpu_count() or 1)
    return replace(_sizes(plan, threads), seconds=seconds, behind=behind())


def _sizes(plan: Plan, threads: int | None) -> Estimate:
    """The estimate without a time."""
    size = bytes_of(plan)
    return Estimate(
        points=points_of(plan),
        chunks=math.prod(-(-plan.sizes[name] // length) for name, length in plan.cuts.items()),
        memory=2 * size + (threads or os.cpu_count() or 1) * WORKSPACE,
        disk=size,
        seconds=float("inf"),
    )


def _seconds(plan: Plan, threads: int) -> float:
    """Seconds of the whole work, from larger and larger parts of it."""
    width = max(1, min(threads, sum(plan.needs(key) is None for key in keys_of(plan))))
    share = spent = 0.0
    with ThreadPoolExecutor(width) as pool:
        for step in count():
            compiling: list[float] = []
            begun = time.perf_counter()
            with install_timer("numba:compile", compiling.append):
                turns = range(step * width, (step + 1) * width)
                parts = [pool.submit(plan.pilot, share / width, turn=turn) for turn in turns]
                done = sum(one.result() for one in parts)
            took = time.perf_counter() - begun - sum(compiling)
            if step == 0 and took < LONG:
                continue  # it loaded what is loaded once
            share, spent = 2.0 * done, spent + took
            if done >= 0.5 or spent + 2.0 * took > max(BRIEF, SPENT * took / done):
                break
    return max(took, 0.0) / done


def require_space(
    plan: Plan, directory: Path | None, *, threads: int | None = None, forced: bool = False
) -> Estimate:
    """Refuse what does not fit into 70 % of the free memory or of the free disk."""
    needed = _sizes(plan, threads)
    free = free_bytes()
    if needed.memory > SHARE * free and not forced:
        raise InputError(
            "grid",
            f"{needed.points} points, about {needed.memory / 2**30:.3g} GiB of memory",
            allowed=f"0..{SHARE * free / 2**30:.3g} GiB (70 % of the free memory)",
            fix="take fewer points, or pass --force",
        )
    if directory is not None:
        place = next(p for p in (directory.absolute(), *directory.absolute().parents) if p.exists())
        room = shutil.disk_usage(place).free
        if needed.disk > SHARE * room and not forced:
            raise InputError(
                "grid",
                f"{needed.points} points, about {needed.disk / 2**30:.3g} GiB of disk",
                allowed=f"0..{SHARE * room / 2**30:.3g} GiB (70 % of the free disk)",
                fix="take fewer points, another disk, or pass --force",
            )
    return needed


def carry_out(
    plan: Plan,
    store: str | Path | None = None,
    *,
    threads: int | None = None,
    report: Report | None = None,
    forced: bool = False,
    alive: Alive = keep_going,
    title: str = "",
) -> Dataset:
    """Compute ``plan`` and return it as one labelled Dataset.

    With a ``store`` directory every chunk is written as it is ready, and the same call goes on
    where an earlier one ended; without one it stays in memory. ``threads``: all cores if left out;
    the result is the same to the last bit on any number. ``title``: the case's, kept beside the
    store. Ctrl+C, and ``alive`` when it raises,
    keep what is stored.
    """
    directory = None if store is None else Path(store)
    require_space(plan, directory, threads=threads, forced=forced)
    clock = _Clock(len(keys_of(plan)), report)
    if directory is None:
        return gather(plan, threads=threads, progress=lambda done, _: clock.step(done), alive=alive)
    with Store(directory, plan) as kept:
        there = kept.finished()
        clock.found = len(there)
        wanted = [key for key in keys_of(plan) if key not in there]
        clock.step(len(there))
        source = computed(plan, wanted, kept.load, threads=threads, alive=alive)
        done = len(there)
        try:
            for key, arrays in source:
                alive()
                kept.write(key, arrays)
                done += 1
                clock.step(done)
        finally:
            source.close()
        return kept.complete(title)


class _Clock:
    """Elapsed and remaining time."""

    def __init__(self, total: int, report: Report | None) -> None:
        self.total = total
        self.report = report
        self.found = 0
        self.begun = time.monotonic()

    def step(self, done: int) -> None:
        if self.report is None:
            return
        elapsed = time.monotonic() - self.begun
        own = done - self.found
        left = elapsed / own * (self.total - done) if own > 0 else float("nan")
        self.report(
            Step(done=done, total=self.total, found=self.found, elapsed=elapsed, remaining=left)
        )
