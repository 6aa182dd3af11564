"""``make same``: do all commands still store the same numbers, to the last bit?

python checks/same.py                      this tree beside ced7e69
python checks/same.py REF --only run-rig   beside another commit, some cases
python checks/same.py --list               the cases

For changes that move and rename and leave the arithmetic alone. Small cases of every command
(``checks/same_cases.py``) run with the sources of the reference and with those of this tree, in the
same environment; every stored variable must be equal. What else is told (attributes, JSON, CSV,
pages, what is printed) is counted beside it. What the reference stored stays in ``.same/``: later
runs cost this tree's side alone.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from functools import partial
from importlib.metadata import version
from itertools import chain, zip_longest
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

import numpy as np
from filelock import FileLock
from same_cases import CASES, Case
from same_digest import Array, Digest, Stored, digest, values

ROOT = Path(__file__).parents[1]
STORE = ROOT / ".same"
REFERENCE = "ced7e69"
RENAMED: dict[str, str] = {"*radial_clearance*": "*radial_internal_clearance*"}
"""Stored things that have another name now: path of the reference to path of this tree.

A path is ``case/file:group/variable``; dimensions and columns of tables have such paths too. A
``*`` stands for any text and keeps it: ``{"*/results.nc:mesh/*": "*/results.nc:cycle/*"}``.
"""
SETTINGS = {
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "PYTHONHASHSEED": "0",
    "MPLBACKEND": "Agg",
    "LC_ALL": "C.UTF-8",
    "TZ": "UTC",
    "COLUMNS": "100",
}
"""Environment of every command, beside this process's own."""


# --- one side -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Outcome:
    """What a case did on one side: exit codes, processor seconds, what it left."""

    codes: tuple[int, ...]
    seconds: float
    digest: Digest


class Side:
    """The sources below ``home``/src, and the folders of what they made.

    ``reference``: whether a case's earlier words are taken.
    """

    def __init__(self, home: Path, *, reference: bool) -> None:
        self.home, self.reference = home, reference
        self.machine_code = home / f"numba-{kernels(home / 'src')[:12]}"
        self._idle: SimpleQueue[subprocess.Popen[str]] = SimpleQueue()
        self._started: list[subprocess.Popen[str]] = []

    def folder(self, case: Case) -> Path:
        return self.home / "out" / case.name

    def words(self, case: Case) -> list[list[str]]:
        """The words of every step."""
        steps = case.before if self.reference and case.before is not None else case.steps
        return [shlex.split(step) for step in steps]

    def run(self, case: Case) -> Outcome:
        """The case from its beginning."""
        folder = self.folder(case)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for name, content in case.files.items():
            raw = content if isinstance(content, bytes) else content.encode()
            (folder / name).write_bytes(raw)
        answer = self._ask({"folder": str(folder), "steps": self.words(case)})
        return Outcome(
            tuple(code for code, _ in answer), sum(spent for _, spent in answer), self.digest(case)
        )

    def digest(self, case: Case) -> Digest:
        return digest(self.folder(case), case.name, without=case.files)

    def _ask(self, order: dict[str, Any]) -> list[tuple[int, float]]:
        """Of one of the processes that wait, or of a new one."""
        try:
            process = self._idle.get_nowait()
        except Empty:
            process = subprocess.Popen(
                [sys.executable, "-P", Path(__file__).with_name("same_run.py")],
                env=self._environment(), text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            )  # fmt: skip
            self._started.append(process)
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(json.dumps(order) + "\n")
        process.stdin.flush()
        line = process.stdout.readline()
        if not line:
            raise SystemExit(f"{order['folder']}: the process that carries its steps out has ended")
        self._idle.put(process)
        return [(int(code), float(spent)) for code, spent in json.loads(line)]

    def close(self) -> None:
        for process in self._started:
            process.communicate()

    def _environment(self) -> dict[str, str]:
        kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "NUMBA"))}
        return kept | SETTINGS | {
            "PYTHONPATH": str(self.home / "src"),
            "PYTHONPYCACHEPREFIX": str(STORE / "pycache"),
            "NUMBA_CACHE_DIR": str(self.machine_code),
            "MPLCONFIGDIR": str(STORE / "matplotlib"),
        }  # fmt: skip


def kernels(sources: Path) -> str:
    """One hash of all compiled sources and of what they import: numba sees single files alone."""
    texts = {path: path.read_text("utf-8") for path in sorted(sources.rglob("*.py"))}
    chosen = [path for path, text in texts.items() if re.search(r"\b(numba|llvmlite)\b", text)]
    for path in chosen:
        for module in re.findall(r"from (thermogear[\w.]*) import", texts[path]):
            other = sources / f"{module.replace('.', '/')}.py"
            if other in texts and other not in chosen:
                chosen.append(other)
    content = hashlib.sha256()
    for path in sorted(chosen):
        content.update(f"{path.relative_to(sources)}\n{texts[path]}".encode())
    return content.hexdigest()


def this_tree() -> Side:
    """A copy of the sources as they stand, so that they may be edited meanwhile."""
    home = STORE / "new"
    # Python knows compiled modules by second and size: an edit within one second would be stale
    for old in (home / "src", home / "out", STORE / "pycache" / home.relative_to(home.anchor)):
        shutil.rmtree(old, ignore_errors=True)
    shutil.copytree(ROOT / "src", home / "src", ignore=shutil.ignore_patterns("__pycache__"))
    side = Side(home, reference=False)
    for old in set(home.glob("numba-*")) - {side.machine_code}:
        shutil.rmtree(old)
    return side


def of_commit(name: str, store: Path) -> Side:
    """The sources of a commit."""
    home = store / name
    if not (home / "src").is_dir():
        raw = subprocess.run(
            ["git", "archive", name, "src"], cwd=ROOT, check=True, capture_output=True
        ).stdout
        draft = home / "draft"
        shutil.rmtree(draft, ignore_errors=True)
        with tarfile.open(fileobj=io.BytesIO(raw)) as packed:
            packed.extractall(draft, filter="data")
        (draft / "src").replace(home / "src")
        draft.rmdir()
    return Side(home, reference=True)


# --- the reference, once --------------------------------------------------------------------


def kept(side: Side, case: Case, *, fresh: bool) -> Outcome:
    """What the reference made of a case; run where that is not known, or not of this machine."""
    file = side.home / f"{case.name}.json"
    asked, reading = _asked(side, case), _reading()
    entry = json.loads(file.read_text("utf-8")) if file.is_file() and not fresh else {}
    if entry.get("asked") != asked or not side.folder(case).is_dir():
        found = side.run(case)
        print(f"{case.name:<22} by the reference {found.seconds:.1f} s", file=sys.stderr)
    elif entry["reading"] != reading:
        found = Outcome(tuple(entry["codes"]), entry["seconds"], side.digest(case))
    else:
        return Outcome(tuple(entry["codes"]), entry["seconds"], Digest.of_plain(entry["digest"]))
    content = {
        "asked": asked,
        "reading": reading,
        "codes": found.codes,
        "seconds": found.seconds,
        "digest": found.digest.plain(),
    }
    draft = file.with_suffix(".part")
    draft.write_text(json.dumps(content), "utf-8")
    draft.replace(file)
    return found


def _asked(side: Side, case: Case) -> str:
    """What decides the numbers of the reference: the case, the libraries, the machine."""
    libraries = [version(name) for name in ("numpy", "scipy", "numba", "xarray", "zarr")]
    kind = [platform.python_version(), platform.machine(), os.environ.get("OPENBLAS_CORETYPE")]
    files = sorted(case.files.items())
    asked = [side.words(case), files, libraries, kind, SETTINGS]
    return hashlib.sha256(repr(asked).encode()).hexdigest()


def _reading() -> str:
    return hashlib.sha256(Path(__file__).with_name("same_digest.py").read_bytes()).hexdigest()


# --- both sides -----------------------------------------------------------------------------


@dataclass
class Verdict:
    """A case beside its reference: how many variables and texts are equal, and what is not."""

    case: str
    variables: int = 0
    equal: int = 0
    told: int = 0
    told_equal: int = 0
    seconds: float = 0.0
    differences: list[str] = field(default_factory=list)
    otherwise: list[str] = field(default_factory=list)
    renamed: dict[str, str] = field(default_factory=dict)


def new_path(path: str, renamed: Mapping[str, str]) -> str:
    """Where ``path`` of the reference stands now."""
    for old, new in renamed.items():
        found = re.fullmatch("(.*)".join(map(re.escape, old.split("*"))), path)
        if found is not None:
            return "".join(chain(*zip_longest(new.split("*"), found.groups(), fillvalue="")))
    return path


def compare(
    case: str, old: Digest, new: Digest, renamed: Mapping[str, str], how: Callable[[str, str], str]
) -> Verdict:
    """``how(old path, new path)`` says by how much two variables differ."""
    found = Verdict(case)
    _compare_variables(found, old, new, renamed, how)
    _compare_told(found, old, new, renamed)
    return found


def _compare_variables(
    found: Verdict,
    old: Digest,
    new: Digest,
    renamed: Mapping[str, str],
    how: Callable[[str, str], str],
) -> None:
    left = dict(new.variables)
    for path, one in old.variables.items():
        found.variables += 1
        now = new_path(path, renamed)
        if now != path:
            found.renamed[path] = now
        other = left.pop(now, None)
        if other is None:
            found.differences.append(f"{path}: missing")
            continue
        dims = tuple(new_path(dim, renamed) for dim in one.dims)
        if one == other or (dims, one.shape, one.dtype, one.sha256) == (
            other.dims, other.shape, other.dtype, other.sha256
        ):  # fmt: skip
            found.equal += 1
            continue
        words = _otherwise(one, dims, other, partial(how, path, now))
        found.differences.append(f"{now}: {words}")
    for path in left:
        found.variables += 1
        found.differences.append(f"{path}: new")


def _otherwise(one: Stored, dims: tuple[str, ...], other: Stored, how: Callable[[], str]) -> str:
    words = []
    if one.dtype != other.dtype:
        words.append(f"{one.dtype} is {other.dtype} now")
    if one.shape != other.shape or dims != other.dims:
        before, now = (
            ", ".join(f"{d.rpartition(':')[2]} {n}" for d, n in zip(names, shape, strict=True))
            for names, shape in ((dims, one.shape), (other.dims, other.shape))
        )
        words.append(f"({before}) is ({now}) now")
    if one.shape == other.shape and one.sha256 != other.sha256:
        words.append(how())
    return "; ".join(words)


def apart(old: Array, new: Array) -> str:
    """By how much two arrays of one shape differ."""
    if old.dtype.kind not in "biuf" or new.dtype.kind not in "biuf":
        texts = zip(old.astype(str).ravel(), new.astype(str).ravel(), strict=True)
        other = [f"{str(a)!r} is {str(b)!r} now" for a, b in texts if a != b]
        return f"{len(other)} of {old.size} texts differ, first {other[0]}"
    a, b = old.astype(float), new.astype(float)
    same = (a == b) & (np.signbit(a) == np.signbit(b)) | np.isnan(a) & np.isnan(b)
    words = [f"{int(np.sum(~same))} of {a.size} numbers differ"]
    both = np.isfinite(a) & np.isfinite(b)
    if np.any(both & ~same):
        off = np.abs(a - b)[both]
        scale = np.maximum(np.abs(a), np.abs(b))[both]
        relative = np.divide(off, scale, out=np.zeros_like(off), where=scale > 0.0)
        words.append(f"by up to {off.max():.3g}, relative {relative.max():.3g}")
    if np.any(np.isfinite(a) != np.isfinite(b)):
        words.append(f"{int(np.sum(np.isfinite(a) != np.isfinite(b)))} finite on one side alone")
    return ", ".join(words)


def _compare_told(found: Verdict, old: Digest, new: Digest, renamed: Mapping[str, str]) -> None:
    left = dict(new.told)
    for path, texts in old.told.items():
        place, sign, rest = path.partition("@")
        now = new_path(place, renamed) + sign + rest
        _compare_texts(found, now, texts, left.pop(now, []))
    for path, texts in left.items():
        _compare_texts(found, path, [], texts)


def _compare_texts(found: Verdict, path: str, old: list[str], new: list[str]) -> None:
    """Place by place; where some are missing or new, as they follow each other."""
    pairs: list[tuple[str | None, str | None]] = list(zip_longest(old, new))
    if len(old) != len(new):
        pairs = []
        for _, i, j, k, m in SequenceMatcher(None, old, new).get_opcodes():
            pairs += zip_longest(old[i:j], new[k:m])
    other = [f"{_told(a)} is {_told(b)} now" for a, b in pairs if a != b]
    found.told += len(pairs)
    found.told_equal += len(pairs) - len(other)
    found.otherwise += [f"{path}: {words}" for words in other]


def _told(text: str | None) -> str:
    return "nothing" if text is None else repr(text)


def judged(case: Case, one: Side, before: Outcome, two: Side, after: Outcome) -> Verdict:
    """A case's verdict; other exit codes than 0 on both sides are differences."""

    def how(old: str, new: str) -> str:
        a = values(one.folder(case), old.partition("/")[2])
        return apart(a, values(two.folder(case), new.partition("/")[2]))

    found = compare(case.name, before.digest, after.digest, RENAMED, how)
    found.seconds = after.seconds
    for side, name, outcome in ((one, "the reference", before), (two, "this tree", after)):
        for number, code in enumerate(outcome.codes, start=1):
            if code != 0:
                told = (side.folder(case) / f"complained-{number}.txt").read_text("utf-8").strip()
                last = told.splitlines()[-1] if told else "nothing said"
                found.differences.append(f"step {number} of {name}: exit code {code}: {last}")
    return found


# --- the command ----------------------------------------------------------------------------


def chosen(only: str | None) -> list[Case]:
    """The cases named, each by its name or the beginning of it."""
    if only is None:
        return list(CASES)
    names = only.split(",")
    for name in names:
        if not any(case.name.startswith(name) for case in CASES):
            raise SystemExit(f"--only: got {name}; allowed: {', '.join(c.name for c in CASES)}")
    return [case for case in CASES if case.name.startswith(tuple(names))]


def verdicts(
    cases: Sequence[Case], reference: Side, *, fresh: bool, jobs: int
) -> Iterator[tuple[Verdict, float]]:
    """Each with the reference's processor seconds; the sides never at once."""
    with FileLock(reference.home / "lock"), ThreadPoolExecutor(jobs) as crew:
        before = list(crew.map(lambda case: kept(reference, case, fresh=fresh), cases))
        reference.close()
    now = this_tree()
    with ThreadPoolExecutor(jobs) as crew, closing(now):
        for case, one, two in zip(cases, before, crew.map(now.run, cases), strict=True):
            yield judged(case, reference, one, now, two), one.seconds


def main(words: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(description="Do all commands store the same numbers?")
    parser.add_argument("ref", nargs="?", default=REFERENCE, help=f"a commit [{REFERENCE}]")
    parser.add_argument("--only", metavar="NAME,...", help="cases, by the beginning of their names")
    parser.add_argument("--list", action="store_true", help="print the cases and stop")
    parser.add_argument("--fresh", action="store_true", help="run the reference anew")
    parser.add_argument("--strict", action="store_true", help="told differences fail too")
    parser.add_argument("--verbose", action="store_true", help="show each that is told differently")
    parser.add_argument("--jobs", type=int, default=1, help="cases at once [1]")
    parser.add_argument("--store", type=Path, default=STORE, help="home of the reference [.same]")
    options = parser.parse_args(words)
    cases = chosen(options.only)
    if options.list:
        for case in cases:
            print(f"{case.name:<22} {'; '.join(case.steps)}")
        return 0
    name = subprocess.run(
        ["git", "rev-parse", "--short", f"{options.ref}^{{commit}}"],
        cwd=ROOT, check=True, capture_output=True, text=True,
    ).stdout.strip()  # fmt: skip
    home = options.store.resolve() / name
    home.mkdir(parents=True, exist_ok=True)
    reference = of_commit(name, home.parent)
    began, all_found, before = time.monotonic(), [], 0.0
    for found, spent in verdicts(cases, reference, fresh=options.fresh, jobs=max(options.jobs, 1)):
        all_found.append(found)
        before += spent
        _tell(found, each=options.verbose)
    for old, new in RENAMED.items():
        count = sum(new_path(p, {old: new}) == q for f in all_found for p, q in f.renamed.items())
        print(f"renamed {old} -> {new}: {count} variables")
    different = sum(len(f.differences) for f in all_found)
    otherwise = sum(f.told - f.told_equal for f in all_found)
    print(
        f"{len(all_found)} cases beside {name}: {sum(f.equal for f in all_found)} of "
        f"{sum(f.variables for f in all_found)} variables equal, {different} differences, "
        f"{otherwise} told differently; {sum(f.seconds for f in all_found):.0f} s of processor "
        f"time (the reference took {before:.0f} s), {time.monotonic() - began:.0f} s in all"
    )
    return int(different > 0 or (options.strict and otherwise > 0))


def _tell(found: Verdict, *, each: bool) -> None:
    print(
        f"{found.case:<22} variables {found.equal:>4} of {found.variables:<4} "
        f"told {found.told_equal:>6} of {found.told:<6} {found.seconds:6.1f} s",
        flush=True,
    )
    for text in found.differences:
        print(f"    DIFFERENT {text}")
    for text in found.otherwise if each else ():
        print(f"    told {text}")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
