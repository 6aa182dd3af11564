"""Trials of the store in processes of their own: kills, damages, a full disk.

Run as ``python store_trials.py TRIAL DIRECTORY [COUNT]``; prints one JSON line. COUNT: how many
kills or damages.
"""

import hashlib
import json
import os
import random
import resource
import shutil
import signal
import sys
import time
import traceback
from contextlib import suppress
from pathlib import Path

import numpy as np

from thermogear.analysis.maps import MapPlan, map_plan
from thermogear.analysis.settle import Rule
from thermogear.base.errors import InputError
from thermogear.base.stores import read_journal, read_store
from thermogear.dynamics.models import TorsionalModel
from thermogear.results.fingerprint import code_version
from thermogear.results.store import QUARANTINE
from thermogear.results.work import carry_out

MODEL = TorsionalModel(
    damping_ratio=0.05, frequency=1.0, stiffness_amplitude=0.3, mean_force=0.1, force_amplitude=0.3
)


def small_plan(count: int = 30, tile: int = 6) -> MapPlan:
    """Chunks of a few milliseconds: 25, or what ``count`` points of an axis make of ``tile``."""
    axes = {
        "frequency": np.linspace(0.4, 2.2, count),
        "stiffness_amplitude": np.linspace(0.05, 0.9, count),
    }
    return map_plan(MODEL, axes, tile=tile, rule=Rule(cap=128))


def numbers(data) -> str:
    """A hash of every number of a result."""
    digest = hashlib.sha256()
    for name in sorted(map(str, data.variables)):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(data[name].values).tobytes())
    return digest.hexdigest()


def in_child(work) -> int:
    """Run ``work`` in a forked child; its process number."""
    child = os.fork()
    if child == 0:
        code = 1
        try:
            code = 0 if work() else 3
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stderr.flush()
            os._exit(code)
    return child


def kills(directory: Path, count: int) -> dict:
    """Kill a run at random moments, go on, compare: nothing finished may be lost."""
    plan = small_plan()
    plan.pilot(0.1, turn=0)  # loads the kernels once, for every child
    code_version()  # and reads the sources once
    lost = wrong = done = finished = killed_working = 0
    draw = random.Random(6)
    expected_file = directory / "expected"
    child = in_child(lambda: expected_file.write_text(numbers(carry_out(plan, threads=1))) > 0)
    os.waitpid(child, 0)
    expected = expected_file.read_text()
    store = directory / "store"
    longest = 0.6  # seconds: less than a whole run takes
    while done < count:
        before = {tuple(e["chunk"]) for e in read_journal(store) if "chunk" in e}
        begun = time.monotonic()
        threads = draw.choice([1, 2, 3])
        child = in_child(
            lambda threads=threads: numbers(carry_out(plan, store, threads=threads)) == expected
        )
        deadline = begun + draw.uniform(0.0, longest)
        code = None
        while time.monotonic() < deadline:
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                code = os.waitstatus_to_exitcode(status)
                break
            time.sleep(0.001)
        if code is None:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            done += 1
            killed_working += len(before) > 0
        after = {tuple(e["chunk"]) for e in read_journal(store) if "chunk" in e}
        lost += len(before - after)
        lost += (store / QUARANTINE).exists()
        if code is not None:
            finished += 1
            wrong += code != 0
            shutil.rmtree(store)
    child = in_child(lambda: numbers(carry_out(plan, store, threads=2)) == expected)
    _, status = os.waitpid(child, 0)
    wrong += os.waitstatus_to_exitcode(status) != 0
    return {
        "kills": done, "with_chunks": killed_working, "finished": finished + 1,
        "lost": lost, "wrong": wrong,
    }  # fmt: skip


def full(directory: Path, _: int) -> dict:
    """No file may grow beyond a few hundred bytes: the disk refuses in the middle of a chunk."""
    plan = small_plan(36, 18)
    plan.pilot(0.1, turn=0)
    code_version()
    store = directory / "store"

    def refused() -> bool:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1700, resource.RLIM_INFINITY))
        try:
            carry_out(plan, store, threads=1)
        except OSError:
            return True
        return False

    child = in_child(refused)
    _, status = os.waitpid(child, 0)
    stored = len([e for e in read_journal(store) if "chunk" in e])
    again = numbers(carry_out(plan, store, threads=1))
    clean = numbers(carry_out(plan, threads=1))
    return {
        "refused": os.waitstatus_to_exitcode(status) == 0,
        "stored_before": stored,
        "same": again == clean,
    }


def damage(path: Path, draw: random.Random) -> None:
    """Flip a bit, cut, empty, delete or overwrite a file."""
    raw = bytearray(path.read_bytes())
    way = draw.choice(["flip", "cut", "empty", "delete", "noise"])
    if way == "flip" and raw:
        raw[draw.randrange(len(raw))] ^= 1 << draw.randrange(8)
        path.write_bytes(raw)
    elif way == "cut":
        path.write_bytes(raw[: len(raw) // 2])
    elif way == "empty":
        path.write_bytes(b"")
    elif way == "delete":
        path.unlink()
    else:
        path.write_bytes(draw.randbytes(max(len(raw), 1)))


def corruptions(directory: Path, count: int) -> dict:
    """Damage a finished store in one place at a time; repeat the command; compare."""
    plan, store, draw = small_plan(12), directory / "store", random.Random(2)
    truth = numbers(carry_out(plan, store))
    tally = {"repaired": 0, "loud": 0, "silent": 0, "reader_silent": 0}
    for _ in range(count):
        files = sorted(p for p in store.rglob("*") if p.is_file() and p.name != "lock")
        damage(draw.choice(files), draw)
        with suppress(InputError):
            tally["reader_silent"] += numbers(read_store(store)) != truth
        try:
            same = numbers(carry_out(plan, store)) == truth == numbers(read_store(store))
            tally["repaired" if same else "silent"] += 1
        except InputError:
            tally["loud"] += 1
        for old in (store / QUARANTINE).glob("*"):
            old.unlink()
    return tally


TRIALS = {
    "kills": kills,
    "corruptions": corruptions,
    "full": full,
}


def main() -> None:
    name, directory = sys.argv[1], Path(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    directory.mkdir(parents=True, exist_ok=True)
    print(json.dumps(TRIALS[name](directory, count)))


if __name__ == "__main__":
    main()
