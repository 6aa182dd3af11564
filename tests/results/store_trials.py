"""Trials of the store in processes of their own: kills, a full disk, a cluster that loses workers.

Run as ``python store_trials.py TRIAL DIRECTORY [COUNT]``; prints one JSON line. COUNT: how many
kills or damages, or for a cluster the points of each axis of a map, in tiles of 6.
"""

import hashlib
import json
import os
import random
import resource
import shutil
import signal
import socket
import subprocess
import sys
import time
import traceback
import warnings
from contextlib import suppress
from pathlib import Path

import numpy as np

import thermogear
from thermogear.analysis.maps import MapPlan, map_plan
from thermogear.analysis.settle import Rule
from thermogear.base.errors import InputError, WorkerWarning
from thermogear.base.plan import keys_of
from thermogear.base.stores import read_journal, read_store
from thermogear.dynamics.models import TorsionalModel
from thermogear.results import workers
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


def cluster(directory: Path, count: int) -> dict:
    """Two worker processes, against threads; one of them is killed twice."""
    import dask
    from distributed import Client, LocalCluster

    dask.config.set(
        {
            # a loaded machine may take longer than the default 15 s to start a worker again
            "distributed.deploy.lost-worker-timeout": "10 minutes",
        }
    )

    plan = small_plan(count)
    plan.pilot(0.1, turn=0)
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
        ) as local,
        Client(local) as client,
    ):
        address = local.scheduler_address
        client.run(plan.pilot, 0.1, turn=0)  # kernels
        begun = time.perf_counter()
        calm = carry_out(plan, directory / "calm", scheduler=address)
        on_cluster = time.perf_counter() - begun
        killed: list[int] = []

        def watch(step) -> None:
            if len(killed) < 2 and step.done >= step.total * (0.1, 0.5)[len(killed)]:
                victim = min(client.run(os.getpid).values())
                os.kill(victim, signal.SIGKILL)
                killed.append(victim)

        rough = carry_out(plan, directory / "rough", scheduler=address, report=watch)
    begun = time.perf_counter()
    threads = carry_out(plan, directory / "threads", threads=2)
    on_threads = time.perf_counter() - begun
    chunks = len(keys_of(plan))
    return {
        "chunks": chunks,
        "killed": len(killed),
        "same_calm": numbers(calm) == numbers(threads),
        "same_rough": numbers(rough) == numbers(threads),
        "cluster_ms_per_chunk": 1e3 * on_cluster / chunks,
        "threads_ms_per_chunk": 1e3 * on_threads / chunks,
    }


class Crowd:
    """A scheduler and workers of several kinds, processes of this machine."""

    def __init__(self, directory: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        source = Path(thermogear.__file__).parent
        self.paths = {"good": source.parent}
        for kind in ("old", "bare"):
            self.paths[kind] = directory / kind
            shutil.rmtree(directory / kind, ignore_errors=True)
        shutil.copytree(
            source, directory / "old" / "thermogear", ignore=shutil.ignore_patterns("__pycache__")
        )
        plan = directory / "old" / "thermogear" / "base" / "plan.py"
        words = "dtype=blank.dtype)"
        text = plan.read_text("utf-8")
        assert text.count(words) == 1
        plan.write_text(text.replace(words, f"{words} * 1.001"), "utf-8")
        (directory / "bare" / "thermogear").mkdir(parents=True)
        (directory / "bare" / "thermogear" / "__init__.py").write_text(
            "raise ModuleNotFoundError(\"No module named 'thermogear'\")\n", "utf-8"
        )
        host, port = self.address.removeprefix("tcp://").split(":")
        self.scheduler = self.start("good", "scheduler", "--host", host, "--port", port)
        self.workers: dict[str, subprocess.Popen] = {}

    def start(self, kind: str, *words: str) -> subprocess.Popen:
        """A process of dask that finds the package of this kind."""
        code = "import sys; from dask.__main__ import main; sys.argv[0] = 'dask'; main()"
        return subprocess.Popen(
            [sys.executable, "-c", code, *words, "--no-dashboard"],
            env=os.environ | {"PYTHONPATH": str(self.paths[kind])},
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip

    def hire(self, name: str, kind: str = "good") -> None:
        """A worker process."""
        words = ("--name", name, "--no-nanny", "--nthreads", "1", "--host", "127.0.0.1")
        self.workers[name] = self.start(kind, "worker", self.address, *words)

    def names(self, count: int) -> dict[str, str]:
        """Address to name, once ``count`` workers are there."""
        from distributed import Client

        with Client(self.address, timeout=200, set_as_default=False) as client:
            client.wait_for_workers(count, timeout=400)
            # imports take long on a busy machine: who is slow to load is not who does not answer
            client.run(loaded, on_error="return")
            there = client.scheduler_info(n_workers=-1)["workers"]
            return {address: one["name"] for address, one in there.items()}

    def end(self) -> None:
        """Nobody is left."""
        for one in (self.scheduler, *self.workers.values()):
            one.kill()
            one.wait()


def loaded() -> None:
    """On a worker: load what it is asked with."""
    from thermogear.results.workers import introduced

    introduced()


def crowd(directory: Path, count: int) -> dict:
    """Good, old, bare and dying workers, then a scheduler that dies, then nobody of use."""
    plan = small_plan(count)
    plan.pilot(0.1, turn=0)
    threads = numbers(carry_out(plan, directory / "threads", threads=1))
    found: dict = {"dead": []}
    one = Crowd(directory)
    try:
        for name, kind in (("good", "good"), ("dying", "good"), ("old", "old"), ("bare", "bare")):
            one.hire(name, kind)
        names = one.names(4)

        def watch(step) -> None:
            if step.done >= 0.1 * step.total and not found["dead"]:
                one.workers["dying"].kill()
                found["dead"].append("dying")

        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            data = carry_out(plan, directory / "crowd", scheduler=one.address, report=watch)
        found["same"] = numbers(data) == threads
        texts = [str(w.message) for w in said if issubclass(w.category, WorkerWarning)]
        found["texts"] = texts
        reasons = ("its code is", "it cannot import thermogear")
        found["refused"] = {
            names[address]: reason
            for address in names for text in texts for reason in reasons
            if address in text and reason in text
        }  # fmt: skip
        begun = [0.0]

        def cut(step) -> None:
            if step.done >= 0.5 * step.total and not begun[0]:
                begun[0] = time.monotonic()
                one.scheduler.kill()

        store = directory / "lost"
        found["lost"] = refusal(lambda: carry_out(plan, store, scheduler=one.address, report=cut))
        found["lost_after_s"] = time.monotonic() - begun[0]
        found["kept"] = len({tuple(e["chunk"]) for e in read_journal(store) if "chunk" in e})
    finally:
        one.end()
    two = Crowd(directory)
    grace, workers.GRACE = workers.GRACE, 2.0
    try:
        two.hire("bare", "bare")
        two.names(1)
        started = time.monotonic()
        found["alone"] = refusal(lambda: carry_out(plan, store, scheduler=two.address))
        found["alone_after_s"] = time.monotonic() - started
        workers.GRACE = grace
        two.hire("good")
        two.names(2)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found["same_resumed"] = (
                numbers(carry_out(plan, store, scheduler=two.address)) == threads
            )
    finally:
        two.end()
    return found


def refusal(work) -> str:
    """The one line that ``work`` ends with."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            work()
        except InputError as error:
            return str(error)
    return "nothing"


TRIALS = {
    "kills": kills,
    "corruptions": corruptions,
    "full": full,
    "cluster": cluster,
    "crowd": crowd,
}


def main() -> None:
    name, directory = sys.argv[1], Path(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    directory.mkdir(parents=True, exist_ok=True)
    print(json.dumps(TRIALS[name](directory, count)))


if __name__ == "__main__":
    main()
