"""Runs chosen tests, each time in a fork of one process that has the heavy libraries loaded.

Started by mutate.py with the project's own Python in a copy of the tree. One JSON object a line
comes in: tests (words for pytest), timeout [s], cold (compile every kernel afresh). One goes out:
outcome "killed", "survived", "timeout" or "broken" (pytest itself failed), and by: the test that
failed first, or "" if the tests could not be imported.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import select
import signal
import sys
import tempfile
from typing import Any

import numba
import pytest

WORDS = ("-x", "-q", "-p", "no:cacheprovider", "-W", "ignore::pytest.PytestAssertRewriteWarning")
LIBRARIES = (
    "hypothesis.extra.numpy",
    "scipy.integrate",
    "scipy.interpolate",
    "scipy.optimize",
    "scipy.signal",
    "scipy.sparse.linalg",
    "scipy.stats",
    "xarray",
)
FAILED = 70  # exit code of a child that could not run the tests at all
# passed, failed, stopped while collecting, internal error, conftest not importable, no tests
OUTCOMES = ("survived", "killed", "killed", "broken", "killed", "broken")


class FirstFailure:
    """Remembers the first test that fails."""

    node = ""

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed and not self.node:
            self.node = report.nodeid


def run_here(tests: list[str], cold: bool, answer: int) -> None:
    """Run the tests in this process; write the outcome to the pipe."""
    os.setsid()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    failure = FirstFailure()
    with tempfile.TemporaryDirectory() as folder:
        if cold:
            numba.config.CACHE_DIR = folder
        try:
            status = int(pytest.main([*WORDS, *tests], plugins=[failure]))
        except BaseException:
            status = pytest.ExitCode.INTERNAL_ERROR
    os.write(answer, json.dumps({"outcome": OUTCOMES[status], "by": failure.node}).encode())


def run_in_a_fork(job: dict[str, Any]) -> dict[str, str]:
    """The answer of a child, which is killed with all its own when its time is over."""
    answer, child_answer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            run_here(job["tests"], job["cold"], child_answer)
        except BaseException:  # whatever it is, this process must end here
            os._exit(FAILED)
        os._exit(0)
    os.close(child_answer)
    try:
        ready, _, _ = select.select([answer], [], [], job["timeout"])
        text = os.read(answer, 65536) if ready else b""
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        os.close(answer)
    if text:
        found: dict[str, str] = json.loads(text)
        return found
    if not ready:
        return {"outcome": "timeout", "by": ""}
    # no answer: a mutant that crashed the process, or a failure of ours, which must not count
    crashed = os.WIFSIGNALED(status)
    return {"outcome": "killed" if crashed else "broken", "by": ""}


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for mutate.py, which then ends this
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    for library in LIBRARIES:
        importlib.import_module(library)
    for line in sys.stdin:
        print(json.dumps(run_in_a_fork(json.loads(line))), flush=True)
