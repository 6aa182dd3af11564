"""What ``thermogear measure`` costs: one record by its length, stage by stage, a folder.

    python bench/measured.py            printed
    python bench/measured.py --write    bench/records/measure_cost.md anew

Processor seconds of the whole command, start included, and the most memory that one process
held; the machine's clock is shown for the folder alone.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "bench" / "records" / "measure_cost.md"
LENGTHS = (10_000, 100_000, 1_000_000, 2_000_000)
RECORDS, LENGTH = 100, 100_000
STAGES = {
    "gate": "passed",
    "tacho or tracked line": "read_in_angle",
    "mesh line found": "stated_gearing",
    "mesh line's turns": "mesh_turns",
    "lines": "channel_lines",
}

sys.path.insert(0, str(ROOT / "tests" / "measured"))


def made(path: Path, count: int, seed: int = 1) -> None:
    """A record of a drive train, two channels, 12 800 samples a second."""
    import record_makers as makers

    position = (makers.MESH_HZ + 0.1 * seed) / makers.RATE
    makers.write_npz(path, makers.mesh_train(count, position, seed=seed))


_PEAK = """
import json, resource, sys
from thermogear.front.cli import main
code = main(sys.argv[1:])
own, other = (resource.getrusage(one) for one in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
spent = sum(one.ru_utime + one.ru_stime for one in (own, other))
print(json.dumps([spent, max(own.ru_maxrss, other.ru_maxrss) / 1e3]), file=sys.stderr)
sys.exit(code)
"""


def spent(words: Sequence[str], cores: int | None = None) -> tuple[float, float, float, str]:
    """Processor seconds, peak MB of a process, seconds of the clock, and what was printed."""

    def pinned() -> None:
        os.sched_setaffinity(0, set(sorted(os.sched_getaffinity(0))[:cores]))

    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", _PEAK, "measure", *words],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        preexec_fn=pinned if cores else None,
    )
    used, held = json.loads(done.stderr.splitlines()[-1])
    return used, held, time.perf_counter() - began, done.stdout


def stages(path: Path) -> dict[str, float]:
    """Processor seconds of each stage of one record."""
    from thermogear.measured import reduction
    from thermogear.measured.readers import read_record

    found: Counter[str] = Counter()

    def timed(name: str, work: Callable[..., Any]) -> Callable[..., Any]:
        def call(*given: Any, **named: Any) -> Any:
            began = time.process_time()
            try:
                return work(*given, **named)
            finally:
                found[name] += time.process_time() - began

        return call

    reduction.measure(path, teeth=32)  # loads what it needs
    kept = {own: getattr(reduction, own) for own in STAGES.values()}
    for name, own in STAGES.items():
        setattr(reduction, own, timed(name, kept[own]))
    began = time.process_time()
    record = read_record(path, unit="g")
    found["read"] = time.process_time() - began
    reduction.measure(record)
    total = time.process_time() - began
    for own, work in kept.items():
        setattr(reduction, own, work)
    return {**found, "the rest": total - sum(found.values())}


def page() -> str:
    """The tables."""
    lines = [
        "# What `measure` costs", "",
        "Made by `make bench NAME=measured`: drawn drive trains of two channels, "
        "whole commands with",
        f"their start; {platform.python_implementation()} {platform.python_version()}, numpy "
        f"{np.__version__}, one thread a process.", "",
        "| samples a channel | processor s | s per million samples of a channel | most MB |",
        "|---:|---:|---:|---:|",
    ]  # fmt: skip
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for count in LENGTHS:
            made(folder / "one.npz", count)
            used, held, _, _ = spent([str(folder / "one.npz"), "--unit", "g"])
            lines.append(f"| {count} | {used:.1f} | {used / (2e-6 * count):.1f} | {held:.0f} |")
        lines += ["", "Where it goes, in processor seconds:", ""]
        split = {}
        for count in LENGTHS[1:3]:
            made(folder / "one.npz", count)
            split[count] = stages(folder / "one.npz")
        names = list(split[LENGTHS[1]])
        lines += [f"| samples | {' | '.join(names)} |", "|---:|" + "---:|" * len(names)]
        for count, parts in split.items():
            lines.append(f"| {count} | {' | '.join(f'{parts[name]:.2f}' for name in names)} |")
        (folder / "one.npz").unlink()
        for number in range(RECORDS):
            made(folder / f"r{number}.npz", LENGTH, number)
        here = len(os.sched_getaffinity(0))
        words = [str(folder), "--unit", "g", "--json"]
        used, _, clock, both = spent(words)
        for number in range(10, RECORDS):
            (folder / f"r{number}.npz").unlink()
        few, _, few_clock, ten = spent(words)
        one, _, one_clock, alone = spent(words, cores=1)
    same = "the same" if ten == alone else "NOT the same"
    lines += [
        "",
        f"A folder of {RECORDS} records of {LENGTH} samples on {here} cores: {used:.0f} processor",
        f"s ({used / RECORDS:.1f} a record), {clock:.0f} s by the clock,",
        f"{json.loads(both)['lines']} lines. Ten of them: {few:.0f} processor s,",
        f"{few_clock:.0f} s by the clock; on one core {one:.0f} and {one_clock:.0f} s; the",
        f"results are {same}. The clock counts what else the machine did.",
        "",
    ]
    return "\n".join(lines)


def main(words: Sequence[str]) -> int:
    if list(words) not in ([], ["--write"]):
        print(f"error: got {' '.join(words)}; allowed nothing or --write", file=sys.stderr)
        return 2
    text = page()
    if list(words) == ["--write"]:
        PAGE.write_text(text, "utf-8")
        print(PAGE.relative_to(ROOT))
    else:
        print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
