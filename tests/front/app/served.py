"""The app in a process of its own, as a user starts it, for tests."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

HERE = "import sys; from thermogear.front.cli import main; sys.exit(main(sys.argv[1:]))"


@dataclass
class Served:
    """A running server: its address with the token, its process."""

    address: str
    process: subprocess.Popen[str]

    @property
    def host(self) -> str:
        return self.address.split("/")[2]

    @property
    def token(self) -> str:
        return self.address.partition("token=")[2]

    def end(self) -> int:
        """Press Ctrl+C; the exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(20)


@contextmanager
def served(*arguments: str, code: str = HERE, folder: Path | None = None) -> Iterator[Served]:
    """``thermogear app ... --no-browser``, ended at the end."""
    process = subprocess.Popen(
        [sys.executable, "-c", code, "app", *arguments, "--no-browser"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    try:
        assert process.stdout is not None
        line = process.stdout.readline().strip()
        if not re.match(r"http://127\.0\.0\.1:\d+/\?token=[0-9a-f]{32}$", line):
            process.wait(20)
            assert process.stderr is not None
            raise AssertionError(f"no address: {line!r} {process.stderr.read()}")
        yield Served(line, process)
    finally:
        if process.poll() is None:
            process.kill()
        process.wait(20)
        for stream in (process.stdout, process.stderr):
            if stream is not None:
                stream.close()
