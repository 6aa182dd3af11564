"""Run independent blocks of lanes on threads: progress, a clean Ctrl+C, results by block."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait

Progress = Callable[[int, int], None]
"""Called as ``progress(done, total)`` from the calling thread; the unit is lane periods."""

CHUNK = 200_000  # lane periods a kernel call may run before it looks up


class Pace:
    """Counts finished work across threads and says when to stop."""

    def __init__(self, total: int) -> None:
        self.total = total
        self.done = 0
        self._lock = threading.Lock()
        self._stop = threading.Event()

    def stop(self) -> None:
        """Ask every block to end at its next chunk."""
        self._stop.set()

    def chunks(self, periods: int, *, lanes: int) -> Iterator[tuple[int, int]]:
        """(first period, periods) pieces short enough to interrupt; counts them as done."""
        size = max(1, CHUNK // max(1, lanes))
        for first in range(0, periods, size):
            if self._stop.is_set():
                return
            count = min(size, periods - first)
            yield first, count
            with self._lock:
                self.done += count * lanes


def run_blocks(
    work: Sequence[Callable[[Pace], None]],
    total: int,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> None:
    """Run every block of ``work``; the first error, Ctrl+C included, ends them all."""
    pace = Pace(total)
    count = min(threads or os.cpu_count() or 1, len(work))
    with ThreadPoolExecutor(max(1, count)) as pool:
        waiting = {pool.submit(block, pace) for block in work}
        try:
            while waiting:
                ended, waiting = wait(waiting, timeout=0.1, return_when=FIRST_COMPLETED)
                for future in ended:
                    future.result()
                if progress is not None:
                    progress(pace.done, total)
        except BaseException:
            pace.stop()
            for future in waiting:
                future.cancel()
            raise
