"""The console's door: signals, a closed output and a closed input end in one line."""

from __future__ import annotations

import logging
import signal
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from thermogear.front.lines import warnings_as_lines
from thermogear.results.files import claimed

SIGNALS = [getattr(signal, n) for n in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, n)]
# whoever starts the tests in the background has them ignore SIGINT
LOADED = "import os, signal; signal.signal(signal.SIGINT, signal.default_int_handler);"
LOADED += "from thermogear.front import entry;"
KILL = "os.kill(os.getpid(), signal.{})"


def ended(code: str, close: str = "") -> tuple[int, str]:
    """Exit code and error stream of a process that runs ``code``, with a stream closed."""
    words = f'exec "$@" {close}' if close else 'exec "$@"'
    done = subprocess.run(
        ["sh", "-c", words, "sh", sys.executable, "-c", code], capture_output=True, text=True
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize("number", SIGNALS)
def test_before_a_command_is_loaded_a_signal_ends_it_at_once(number: signal.Signals) -> None:
    code, said = ended(LOADED + KILL.format(number.name))
    assert (code, said) == (128 + number, "interrupted: stopped on request; nothing was begun\n")


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_ends_a_command_in_one_line(number: signal.Signals) -> None:
    work = f"""
from thermogear.front import cli
import sys, time
sys.argv[1:] = ["check"]
def invoke(context):
    {KILL.format(number.name)}
    time.sleep(9)
cli.cli.invoke = invoke
raise SystemExit(entry.main())
"""
    code, said = ended(LOADED + work)
    assert (code, said) == (128 + number, "interrupted: stopped on request\n")


def test_what_the_caller_ignores_stays_ignored() -> None:
    ignored = "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN);"
    assert ended(ignored + LOADED + KILL.format("SIGTERM")) == (0, "")


def test_closed_streams_are_said_in_one_line() -> None:
    run = (
        "import sys; sys.argv[1:] = {}; from thermogear.front import entry; sys.exit(entry.main())"
    )
    code, said = ended(run.format(["--version"]), ">&-")
    assert (code, said) == (
        2, "error: output: got a closed standard output; send it to a file\n"
    )  # fmt: skip
    code, said = ended(run.format(["new"]), "<&-")
    assert code == 2
    assert said.startswith("error: --teeth, --module, --face-width, --torque, --speed: got nothing")


def test_what_libraries_say_is_one_line_and_advice_to_programmers_none(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with warnings_as_lines():
        logging.getLogger("some.part").warning("a\x1b[2J\nb")
        warnings.showwarning("odd\nvalue", RuntimeWarning, "numpy.py", 1)
        warnings.showwarning("old name", FutureWarning, "pandas.py", 1)
    assert capfd.readouterr().err.splitlines() == [
        "warning: some says: a?[2J b",
        "warning: a library says (RuntimeWarning): odd value",
    ]


def stopped_in(place: Path) -> None:
    with claimed(place) as folder:
        (folder / "half.csv").write_text("1")
        raise KeyboardInterrupt


def test_a_run_that_is_stopped_takes_away_what_it_made(tmp_path: Path) -> None:
    for place in (tmp_path / "new" / "deep", tmp_path / "empty"):
        (tmp_path / "empty").mkdir(exist_ok=True)
        with pytest.raises(KeyboardInterrupt):
            stopped_in(place)
    assert list(tmp_path.rglob("*")) == [tmp_path / "empty"]
