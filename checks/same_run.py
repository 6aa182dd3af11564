"""Commands of thermogear in processes of their own, without the wait for its libraries.

``checks/same.py`` starts it with the sources of one side in PYTHONPATH and writes an order a line,
``{"folder": ..., "steps": [[words], ...]}``; it answers with a line of exit codes and processor
seconds. Each step is a copy (fork) of this process, in which numpy and the others are loaded and
thermogear is not. What a step prints stands in ``said-N.txt`` and ``complained-N.txt``.
"""

from __future__ import annotations

import atexit
import gc
import importlib
import json
import os
import runpy
import sys
import traceback
from contextlib import suppress
from pathlib import Path

LIBRARIES = (
    "numpy pandas scipy.integrate scipy.interpolate scipy.optimize scipy.signal "
    "scipy.sparse.linalg xarray zarr h5netcdf numba pint pydantic click filelock jinja2 "
    "matplotlib.pyplot matplotlib.backends.backend_svg"
)
CODE = "-c"


def carried_out(folder: Path, number: int, words: list[str]) -> tuple[int, float]:
    """Exit code and processor seconds of a step, in a process of its own."""
    process = os.fork()
    if process == 0:
        code = 1
        try:
            os.chdir(folder)
            for stream, name in ((1, "said"), (2, "complained")):
                os.dup2(os.open(f"{name}-{number}.txt", os.O_WRONLY | os.O_CREAT), stream)
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            code = exit_code(words)
        finally:
            os._exit(
                code
            )  # the libraries, which are this process's parent's too, are not torn down
    _, status, used = os.wait4(process, 0)
    return os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime


def exit_code(words: list[str]) -> int:
    """As Python would end after ``-m thermogear`` or ``-c``."""
    sys.argv = ["thermogear", *words]
    code = 0
    try:
        if words[0] == CODE:
            exec(compile(words[1], "<step>", "exec"), {"__name__": "__main__"})
        else:
            runpy.run_module("thermogear", run_name="__main__", alter_sys=True)
    except SystemExit as leaving:
        code = leaving.code if isinstance(leaving.code, int) else int(leaving.code is not None)
    except BaseException:
        traceback.print_exc()
        code = 1
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    return code


def main() -> None:
    for name in LIBRARIES.split():
        with suppress(ImportError):
            importlib.import_module(name)
    gc.collect()
    gc.freeze()
    for line in sys.stdin:
        order = json.loads(line)
        steps = enumerate(order["steps"], start=1)
        folder = Path(order["folder"])
        answer = [carried_out(folder, number, words) for number, words in steps]
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
