"""Progress of long work on the error stream, where a person is watching it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from thermogear.base.progress import Progress, silent


class Stopped(KeyboardInterrupt):
    """Ctrl+C after what was finished had been kept; its argument says what, and where."""


@contextmanager
def progress(wanted: bool = True) -> Iterator[Progress]:
    """A reporter that draws a bar with the time left for each stage; silent off a terminal."""
    if not (wanted and sys.stderr.isatty()):
        yield silent
        return
    from rich.console import Console
    from rich.progress import Progress as Bars
    from rich.progress import TaskID, TimeElapsedColumn

    columns = (*Bars.get_default_columns(), TimeElapsedColumn())
    with Bars(*columns, console=Console(stderr=True)) as bars:
        known: dict[str, TaskID] = {}

        def report(stage: str, done: int, total: int) -> None:
            if stage not in known:
                known[stage] = bars.add_task(stage, total=total)
            bars.update(known[stage], completed=done, total=total)

        yield report
