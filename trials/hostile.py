"""Mutated case files and records through the command line: what must never happen, counted.

    python trials/hostile.py            trials/records/hostile.md anew, an hour of processor
    python trials/hostile.py rig.mf4    the row of one kind anew, the others stay
    python trials/hostile.py 200        200 of each kind, printed

Every file goes through ``thermogear check`` or ``thermogear measure`` inside a worker process that
may take one gigabyte more than it takes at rest and ten seconds of processor time for each.
"""

from __future__ import annotations

import contextlib
import gc
import gzip
import importlib
import io
import json
import os
import re
import resource
import select
import signal
import subprocess
import sys
import tempfile
import time
import warnings
import zipfile
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from hostile_records import (
    JOINED,
    LONG,
    RECORDS,
    SHORT,
    TACHO,
    command,
    forked,
    named,
    record,
)

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "trials" / "records" / "hostile.md"
SEED = 14
CASES = "case files"
COUNTS = {CASES: 5000}
COUNT = 5300
"""Files of each kind that is not in ``COUNTS``."""
LONG_SHARE = 0.005
"""Of the records, so long that their mesh line has an angle: what a file costs is that."""
KINDS = (CASES, *RECORDS)
TEXTS = ("plain.csv", "clocks.csv", "rig.lvm", *JOINED, TACHO)
SECONDS = 10.0
MEMORY = 1 << 30
SILENCE = 300.0
"""Seconds after which a worker that says nothing is taken away; its file counts as too slow."""

Random = np.random.Generator
NEVER = ("tracebacks", "over 10 s", "over 1 GB", "a line that names no fault")

# --- mutations -----------------------------------------------------------------------------------

VALUES = [
    "nan", "inf", "-inf", "0", "-1", "1e308", "1e-308", "99999999999999999999", "true", "[]", "{}",
    '""', '"nan mm"', '"1e308 mm"', '"-5 mm"', '"5"', '"5 kg"', '"5 mm mm"', '"inf degC"',
    '"-300 degC"', '"1e999 rpm"', '"0 rpm"', '["1 rpm", 2, "3 N m"]', "1979-05-27", "5e",
    '"' + "9" * 5000 + ' mm"', "[[[[[[[[1]]]]]]]]", '"\\u0000"', '"5\u00a0mm"', "'''", '"hot"',
    "0x7fffffffffff",
    '["motion", "motion"]', '"1/0 mm"', '"5 mm**9**9"', '"1e5 rpm"', '"1e-9 mm"', '"5e3 N m"',
]  # fmt: skip
CELLS = [
    b",", b";", b"\n", b"nan", b'"', b"\0", b"-", b"1e999", b"9" * 400, b"-inf", b"1e308", b"\t",
    b"\xff\xfe", b"time [s]", b"1e-320", b"\r", b"[g]", b" " * 300,
]  # fmt: skip
NUMBERS = (0, 1, -1, 2**31 - 1, 2**32 - 1, 2**40, 2**62, 512, 65535)


def mutated_bytes(data: bytes, rng: Random) -> bytes:
    """Bits flipped, pieces cut, doubled, moved, zeroed, replaced; counts and sizes made huge."""
    raw = bytearray(data)
    for _ in range(int(rng.choice([1, 1, 1, 2, 3, 5]))):
        if not raw:
            break
        place = int(rng.integers(0, len(raw)))
        # the structure of binary formats stands at their ends: hit them often
        if rng.random() < 0.5:
            place = int(rng.integers(0, min(len(raw), 900)))
        elif rng.random() < 0.2:
            place = len(raw) - 1 - int(rng.integers(0, min(len(raw), 300)))
        size = int(rng.integers(1, 1 + max(1, min(64, len(raw) - place))))
        _damage(raw, place, size, rng)
    return bytes(raw)


def _damage(raw: bytearray, place: int, size: int, rng: Random) -> None:
    """One change of ``raw`` in place, of about ``size`` bytes from ``place`` on."""
    match int(rng.integers(0, 11)):
        case 0:
            raw[place] ^= 1 << int(rng.integers(0, 8))
        case 1:
            raw[place : place + size] = rng.bytes(size)
        case 2:
            del raw[place : place + size]
        case 3:
            del raw[place:]
        case 4:
            raw[place:place] = raw[place : place + size]
        case 5:
            raw[place : place + size] = bytes(size)
        case 6:
            wide = int(rng.choice([2, 4, 8]))
            order = "little" if rng.random() < 0.8 else "big"
            number = int(rng.choice(NUMBERS)) % (1 << 8 * wide)
            place -= place % wide
            raw[place : place + wide] = number.to_bytes(wide, order)  # type: ignore[arg-type]
        case 7:
            raw[place:place] = CELLS[int(rng.integers(len(CELLS)))]
        case 8:
            other = int(rng.integers(0, len(raw)))
            piece = bytes(raw[other : other + size])
            raw[place : place + len(piece)] = piece
        case 9:
            raw[place:place] = bytes(raw[place : place + 4096]) * int(rng.integers(1, 20))
        case _:
            raw[place] = int(rng.integers(0, 256))


def mutated_record(name: str, data: bytes, rng: Random) -> bytes:
    """A mutation of the file, or of what is packed in it and then packed anew."""
    if rng.random() < 0.5:
        return mutated_bytes(data, rng)
    if name.endswith(".gz"):
        return gzip.compress(mutated_bytes(gzip.decompress(data), rng), 1)
    if name.endswith(".npz"):
        inside = zipfile.ZipFile(io.BytesIO(data))
        names = inside.namelist()
        hit = names[int(rng.integers(len(names)))]
        whole = io.BytesIO()
        with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
            for member in names:
                content = inside.read(member)
                packed.writestr(member, mutated_bytes(content, rng) if member == hit else content)
        return whole.getvalue()
    if name in ("five.mat", "cells.mat"):
        size = int.from_bytes(data[132:136], "little")
        content = zlib.compress(mutated_bytes(zlib.decompress(data[136 : 136 + size]), rng), 1)
        head = data[:132] + len(content).to_bytes(4, "little")
        return head + content + data[136 + size :]
    if name in TEXTS:
        return mutated_numbers(data, rng)
    return mutated_bytes(data, rng)


def mutated_numbers(data: bytes, rng: Random) -> bytes:
    """Numbers of a text made other numbers, rows lost, doubled, moved, all times shifted."""
    rows = data.decode().split("\n")
    for _ in range(int(rng.choice([1, 1, 2, 5]))):
        place = int(rng.integers(1, len(rows)))
        size = int(rng.choice([1, 1, 2, 20]))
        match int(rng.integers(0, 6)):
            case 0 | 1:
                numbers = list(re.finditer(r"[-+]?[0-9]+(?:[.,][0-9]+)?", rows[place]))
                if numbers:
                    hit = numbers[int(rng.integers(len(numbers)))]
                    word = CELLS[int(rng.integers(len(CELLS)))].decode("latin-1")
                    if rng.random() < 0.7:
                        factor = 10.0 ** float(rng.uniform(-9.0, 9.0)) * float(rng.choice([1, -1]))
                        word = f"{float(hit[0].replace(',', '.')) * factor:.9g}"
                    rows[place] = rows[place][: hit.start()] + word + rows[place][hit.end() :]
            case 2:
                del rows[place : place + size]
                rows.append("")
            case 3:
                rows[place:place] = rows[place : place + size]
            case 4:
                moved = rows[place : place + size]
                del rows[place : place + size]
                at = int(rng.integers(1, len(rows) + 1))
                rows[at:at] = moved
            case _:
                shift = float(rng.choice([1e-6, 1e-3, 0.02, 0.05, 1.0, 1e9]) * rng.choice([1, -1]))
                for number, row in enumerate(rows):
                    found = re.match(r"[0-9]+\.[0-9]+", row)
                    if found:
                        rows[number] = f"{float(found[0]) + shift:.9f}{row[found.end() :]}"
    return "\n".join(rows).encode("latin-1")


def mutated_case(text: str, rng: Random) -> bytes:
    """Values replaced by hostile ones, numbers scaled, lines doubled, moved, lost, bytes broken."""
    lines = text.splitlines()
    for _ in range(int(rng.integers(1, 4))):
        settings = [i for i, line in enumerate(lines) if re.match(r"\s*[\w.]+\s*=", line)]
        if not settings:
            break
        place = settings[int(rng.integers(len(settings)))]
        key, _, value = lines[place].partition("=")
        match int(rng.integers(0, 8)):
            case 0 | 1 | 2:
                lines[place] = f"{key}= {VALUES[int(rng.integers(len(VALUES)))]}"
            case 3 | 4:
                factor = 10.0 ** float(rng.uniform(-6.0, 6.0)) * float(rng.choice([1.0, 1.0, -1.0]))
                whole = rng.random() < 0.3

                def scaled(
                    found: re.Match[str], factor: float = factor, whole: bool = whole
                ) -> str:
                    number = float(found[0]) * factor
                    return f"{round(number)}" if whole else f"{number:.6g}"

                lines[place] = f"{key}={re.sub(r'[0-9]+(?:[.][0-9]+)?', scaled, value, count=3)}"
            case 5:
                other = int(rng.integers(len(lines)))
                lines[place], lines[other] = lines[other], lines[place]
            case 6:
                del lines[place]
            case _:
                lines.insert(int(rng.integers(len(lines))), lines[place])
    data = ("\n".join(lines) + "\n").encode("utf-8", "replace")
    return mutated_bytes(data, rng) if rng.random() < 0.3 else data


# --- what is mutated -----------------------------------------------------------------------------


def cases() -> dict[str, str]:
    """The ready-made cases as they are and with more of their tables filled."""
    from thermogear.case.examples import EXAMPLES, example_text

    return {f"{name}.toml": example_text(name) for name in EXAMPLES}


def jobs_of(kind: str, folder: Path) -> Callable[[Random], tuple[Path, list[str]]]:
    """Makes the next mutated file of a kind, with the command that reads it."""
    if kind == CASES:
        texts = list(cases().values())

        def case(rng: Random) -> tuple[Path, list[str]]:
            path = folder / "bad.toml"
            path.write_bytes(mutated_case(texts[int(rng.integers(len(texts)))], rng))
            return path, ["check", str(path)]

        return case
    good = {count: record(kind, folder, count) for count in (SHORT, LONG)}

    def broken(rng: Random) -> tuple[Path, list[str]]:
        count = LONG if rng.random() < LONG_SHARE else SHORT
        path = named(folder, "bad", kind)
        path.write_bytes(mutated_record(kind, good[count], rng))
        return path, command(kind, folder, count, path)

    return broken


# --- the worker ----------------------------------------------------------------------------------


class TooLong(BaseException):
    """The processor time of one file is spent."""


def _stop(*_: object) -> None:
    raise TooLong


def _held(name: str) -> int:
    """Bytes of a line of the process's own status: VmSize, VmHWM."""
    found = re.search(rf"{name}:\s+(\d+) kB", Path("/proc/self/status").read_text("ascii"))
    return int(found[1]) * 1024 if found else 0


def _spent() -> float:
    """Processor seconds of this process and of those it has waited for."""
    return time.process_time() + sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


@dataclass
class Outcome:
    """What became of one file."""

    kind: str
    number: int
    said: str = ""
    code: int = -1
    seconds: float = 0.0
    memory: int = 0
    broken: list[str] = field(default_factory=list)


def tried(kind: str, number: int, words: list[str], rest: int) -> Outcome:
    """One file through the command line, in this process."""
    from thermogear.front.cli import main

    found = Outcome(kind, number)
    out, err = io.StringIO(), io.StringIO()
    Path("/proc/self/clear_refs").write_text("5", "ascii")  # the peak begins anew
    begun = _spent()
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        with (
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("error")
            found.code = main(words)
    except TooLong:
        found.broken.append("over 10 s")
    except BaseException as error:
        name = "over 1 GB" if isinstance(error, MemoryError) else "tracebacks"
        found.broken.append(name)
        found.said = f"{type(error).__name__}: {error}"[:300]
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    found.seconds = _spent() - begun
    found.memory = max(0, _held("VmHWM") - rest)
    if found.seconds > SECONDS and not found.broken:
        found.broken.append("over 10 s")
    lines = [line for line in err.getvalue().splitlines() if not line.startswith("warning: ")]
    if not found.broken:
        found.said = lines[0][:300] if lines else ""
        if found.code not in (0, 2) or "Traceback" in err.getvalue():
            found.broken.append("tracebacks")
        elif not all(one.startswith("error: ") for one in lines) or (found.code == 2) != bool(
            lines
        ):
            found.broken.append("a line that names no fault")
        if found.memory > MEMORY or re.search("MemoryError|[Uu]nable to allocate", found.said):
            found.broken.append("over 1 GB")
    return found


def _loaded(kind: str, folder: Path, count: int) -> None:
    """Load what reading a file of a kind, of ``count`` samples, needs."""
    from thermogear.measured import optional

    if kind == "rig.mf4":
        importlib.import_module("asammdf")
        optional._run = forked
    path = named(folder, "whole", kind)
    path.write_bytes(record(kind, folder, count))
    done = tried(kind, 0, command(kind, folder, count, path), 0)
    if done.broken or done.code != 0:
        raise RuntimeError(f"the good record of {kind} is not read: {done.said}")


def work(jobs: list[tuple[str, int, int]], seed: int, keep: Path | None) -> None:
    """The files ``start``..``stop`` of each kind, one JSON line each."""
    told = os.fdopen(os.dup(1), "w", buffering=1)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        made = {}
        for kind, _, _ in jobs:
            made[kind] = jobs_of(kind, folder)
            if kind == CASES:
                (folder / "good.toml").write_text(cases()["rig.toml"], "utf-8")
                tried(kind, 0, ["check", str(folder / "good.toml")], 0)
            else:
                # what looks for lines is loaded once, each reader by a record of its own
                _loaded(kind, folder, LONG if len(made) == 1 + (CASES in made) else SHORT)
        gc.collect()
        gc.freeze()  # what is loaded by now need not be gone through for every file
        signal.signal(signal.SIGPROF, _stop)
        size = _held("VmSize") + MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (size, size))
        rest = _held("VmRSS")
        for kind, start, stop in jobs:
            for number in range(start, stop):
                rng = np.random.default_rng([seed, KINDS.index(kind), number])
                path, words = made[kind](rng)
                found = tried(kind, number, words, rest)
                if found.broken and keep is not None:
                    (keep / f"{number}-{path.name}").write_bytes(path.read_bytes())
                print(json.dumps(found.__dict__), file=told, flush=True)


# --- the parent ----------------------------------------------------------------------------------


def batch(
    jobs: list[tuple[str, int, int]], seed: int = SEED, keep: Path | None = None
) -> Iterator[Outcome]:
    """The outcomes of these files, from worker processes; one that hangs or dies is replaced."""
    left = [job for job in jobs if job[1] < job[2]]
    while left:
        words = [sys.executable, __file__, "--worker", json.dumps([left, seed, str(keep or "")])]
        quiet = {"env": os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}}
        with subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **quiet
        ) as one:
            assert one.stdout is not None
            first = True
            while left:
                ready = select.select([one.stdout], [], [], 10 * SILENCE if first else SILENCE)[0]
                line = one.stdout.readline() if ready else b""
                kind, start, stop = left[0]
                if line:
                    found = Outcome(**json.loads(line))
                else:
                    one.kill()
                    assert one.stderr is not None
                    last = one.stderr.read().decode("utf-8", "replace").strip()[-300:]
                    if first:
                        raise RuntimeError(f"the worker does not start: {last}")
                    found = Outcome(kind, start, said=last or "no answer")
                    found.broken = ["tracebacks" if one.wait() > 0 or ready else "over 10 s"]
                left[0] = (kind, start + 1, stop)
                if start + 1 >= stop:
                    left.pop(0)
                yield found
                if not line:
                    break
                first = False


@dataclass
class Sum:
    """What became of the files of one kind."""

    counts: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0
    spent: float = 0.0
    memory: int = 0
    notes: list[str] = field(default_factory=list)

    def add(self, one: Outcome) -> None:
        """Count one file."""
        self.counts["files"] += 1
        self.counts["read" if one.code == 0 else "refused"] += 1
        self.counts.update(one.broken)
        self.seconds = max(self.seconds, one.seconds)
        self.spent += one.seconds
        self.memory = max(self.memory, one.memory)
        if one.broken:
            self.notes.append(f"{one.kind} {one.number}: {', '.join(one.broken)}: {one.said}")


def summed(outcomes: Iterator[Outcome]) -> dict[str, Sum]:
    """The outcomes by kind."""
    found: dict[str, Sum] = {}
    for one in outcomes:
        found.setdefault(one.kind, Sum()).add(one)
    return found


def page(found: dict[str, Sum], kept: dict[str, str]) -> str:
    """The table of trials/records/hostile.md; ``kept`` rows of kinds not tried this time."""
    lines = [
        "# Trial of mutated files",
        "",
        f"Made by `make trial NAME=hostile` (seed {SEED}): case files and records in "
        f"every format with",
        "bits flipped, pieces cut, doubled, moved or zeroed, counts and sizes made huge, numbers",
        "replaced by hostile ones, also inside of what is packed. Each goes through",
        "`thermogear check` or `thermogear measure` (joined: with a good file beside it and",
        "--join; tacho file: as --tacho of a good record); what follows is one result, or exit",
        "code 2 and one line (for a case file one for each fault). Seconds are those of the",
        "processor, bytes what a file takes beside the program at rest; a worker that would take",
        f"a gigabyte more is refused it. Records have {SHORT} samples and too few mesh cycles for",
        "an angle to be found in them, which would take most of the time; one in",
        f"{1 / LONG_SHARE:.0f} has {LONG}.",
        "",
        f"| kind | files | read | refused | {' | '.join(NEVER)} | mean ms | longest s | most MB |",
        "|---|" + "---:|" * (len(NEVER) + 6),
    ]
    for kind in KINDS:
        if kind not in found:
            lines += [kept[kind]] if kind in kept else []
            continue
        one = found[kind]
        numbers = [one.counts[name] for name in ("files", "read", "refused", *NEVER)]
        cells = " | ".join(str(n) for n in numbers)
        mean = 1e3 * one.spent / max(1, one.counts["files"])
        rest = f"{mean:.0f} | {one.seconds:.1f} | {one.memory / 1e6:.0f}"
        lines.append(f"| {kind} | {cells} | {rest} |")
    return "\n".join([*lines, ""])


def main(words: Sequence[str]) -> int:
    if words[:1] == ["--worker"]:
        jobs, seed, keep = json.loads(words[1])
        work(
            [(kind, start, stop) for kind, start, stop in jobs], seed, Path(keep) if keep else None
        )
        return 0
    printed = bool(words) and words[0].isdecimal()
    kinds = list(words[1:] if printed else words) or list(KINDS)
    unknown = [kind for kind in kinds if kind not in KINDS]
    if unknown:
        print(f"error: kind: got {unknown[0]}; allowed {', '.join(KINDS)}", file=sys.stderr)
        return 2
    counts = {kind: int(words[0]) if printed else COUNTS.get(kind, COUNT) for kind in kinds}
    keep = Path(tempfile.mkdtemp(prefix="hostile-"))
    parts = [
        [(kind, start, stop)]
        for kind, count in counts.items()
        for start, stop in pairwise([*range(0, count, 2500), count])
    ]
    found: dict[str, Sum] = {}
    began = time.perf_counter()
    with ThreadPoolExecutor(2) as pool:
        for outcomes in pool.map(lambda part: list(batch(part, keep=keep)), parts):
            for one in outcomes:
                found.setdefault(one.kind, Sum()).add(one)
                for note in found[one.kind].notes:
                    print(note, flush=True)
                found[one.kind].notes.clear()
            done = sum(one.counts["files"] for one in found.values())
            print(f"\r{done} of {sum(counts.values())}", end="", file=sys.stderr, flush=True)
    print(f"\n{time.perf_counter() - began:.0f} s; what broke lies in {keep}", file=sys.stderr)
    if printed:
        print(page(found, {}))
    else:
        old = PAGE.read_text("utf-8").splitlines() if PAGE.exists() else []
        rows = {line.split("|")[1].strip(): line for line in old if line.startswith("| ")}
        PAGE.write_text(page(found, rows), "utf-8")
        print(PAGE.relative_to(ROOT))
    return int(any(one.counts[name] for one in found.values() for name in NEVER))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
