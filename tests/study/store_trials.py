"""Trials of the store in processes of their own: kills, a full disk, a cluster that loses workers.

Run as ``python store_trials.py TRIAL DIRECTORY [COUNT]``; prints one JSON line.
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
from pathlib import Path

import numpy as np

from thermogear.analysis.maps import MapPlan, map_plan
from thermogear.analysis.settle import Rule
from thermogear.dynamics.models import TorsionalModel
from thermogear.study.fingerprint import code_version
from thermogear.study.store import QUARANTINE, read_journal
from thermogear.study.work import carry_out

MODEL = TorsionalModel(
    damping_ratio=0.05, frequency=1.0, stiffness_amplitude=0.3, mean_force=0.1, force_amplitude=0.3
)


def small_plan(count: int = 30, tile: int = 6) -> MapPlan:
    """25 chunks of a few milliseconds."""
    axes = {
        "frequency": np.linspace(0.4, 2.2, count),
        "stiffness_amplitude": np.linspace(0.05, 0.9, count),
    }
    return map_plan(MODEL, axes, tile=tile, rule=Rule(cap=1024))


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
    plan.pilot(16)  # loads the kernels once, for every child
    code_version()  # and reads the sources once
    lost = wrong = done = finished = killed_working = 0
    draw = random.Random(6)
    expected_file = directory / "expected"
    child = in_child(lambda: expected_file.write_text(numbers(carry_out(plan, threads=1))) > 0)
    os.waitpid(child, 0)
    expected = expected_file.read_text()
    store = directory / "store"
    longest = 1.0
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
    plan.pilot(16)
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


def cluster(directory: Path, _: int) -> dict:
    """Two worker processes, against threads; the one that holds the plan is killed twice."""
    import dask
    from distributed import Client, LocalCluster

    dask.config.set(
        {
            "distributed.scheduler.active-memory-manager.interval": "50ms",
            # a loaded machine may take longer than the default 15 s to start a worker again
            "distributed.deploy.lost-worker-timeout": "10 minutes",
        }
    )

    plan = small_plan(60, 6)
    plan.pilot(16)
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
        ) as local,
        Client(local) as client,
    ):
        address = local.scheduler_address
        client.run(plan.pilot, 16)  # kernels
        begun = time.perf_counter()
        calm = carry_out(plan, directory / "calm", scheduler=address)
        on_cluster = time.perf_counter() - begun
        killed: list[int] = []

        def watch(step) -> None:
            if step.done in (10, 50) and len(killed) < 2:
                time.sleep(0.5)  # the scheduler drops what it holds twice
                held = client.run(lambda dask_worker: (os.getpid(), list(dask_worker.data)))
                victim = next(p for p, keys in held.values() if any("chunk" not in k for k in keys))
                os.kill(victim, signal.SIGKILL)
                killed.append(victim)

        rough = carry_out(plan, directory / "rough", scheduler=address, report=watch)
    begun = time.perf_counter()
    threads = carry_out(plan, directory / "threads", threads=2)
    on_threads = time.perf_counter() - begun
    chunks = 100
    return {
        "killed": len(killed),
        "same_calm": numbers(calm) == numbers(threads),
        "same_rough": numbers(rough) == numbers(threads),
        "cluster_ms_per_chunk": 1e3 * on_cluster / chunks,
        "threads_ms_per_chunk": 1e3 * on_threads / chunks,
    }


TRIALS = {"kills": kills, "full": full, "cluster": cluster}


def main() -> None:
    name, directory = sys.argv[1], Path(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    directory.mkdir(parents=True, exist_ok=True)
    print(json.dumps(TRIALS[name](directory, count)))


if __name__ == "__main__":
    main()
