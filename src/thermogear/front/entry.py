"""The console's door: what ends the program is told in one line from the first instant on.

Ctrl+C, SIGTERM and a closed terminal (SIGHUP) end a command alike: what is finished is kept, and
the line says so. Before the command line is loaded nothing is begun, and the process ends at once.
What the caller ignores (``nohup``) stays ignored.
"""

import os
import signal
import sys
from types import FrameType

SIGNALS = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
]
_received = [signal.SIGINT]


def _leave(number: int, _: FrameType | None) -> None:
    os.write(2, b"interrupted: stopped on request; nothing was begun\n")
    os._exit(128 + number)


def _interrupt(number: int, _: FrameType | None) -> None:
    _received[0] = signal.Signals(number)
    raise KeyboardInterrupt


def _answer(handler: "signal._HANDLER") -> None:
    for number in SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, handler)


_answer(_leave)


def main() -> int:
    """The command line, loaded; the exit code, 128 and the signal's number after a signal."""
    from thermogear.front.cli import INTERRUPTED
    from thermogear.front.cli import main as run

    if sys.stdout is None:
        print("error: output: got a closed standard output; send it to a file", file=sys.stderr)
        return 2
    _answer(_interrupt)
    code = run()
    _answer(_leave)
    return 128 + _received[0] if code == INTERRUPTED else code
