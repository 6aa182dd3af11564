"""Mutation testing of the physics: does a changed formula fail a test?

make mutate                                          the sample of checks/records/mutation.md
make mutate MUTATE="--seed 2 --only heat"            another sample, of one floor or one file
make mutate MUTATE=--all                             every mutant of every place (days)

cosmic-ray makes the mutants; this file draws the sample, chooses the tests and counts. A sample
draws, in every module, places (an operator, a number, a condition) without replacement, and of each
place one mutant. Everything runs in a copy of the tree, so a stop leaves no changed source behind;
what is done is kept in .mutate/ and the same command goes on from there.
"""

from __future__ import annotations

import argparse
import ast
import difflib
import hashlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cosmic_ray.plugins
from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from mutation_counts import FLOORS, counted, table, write

ROOT = Path(__file__).parents[1]
STORE = ROOT / ".mutate"
TESTS = [f"tests/{floor}" for floor in ("base", *FLOORS)]
OPERATORS = re.compile(
    r"core/(ReplaceBinaryOperator_(Add|Sub|Mul|Div|Pow)_(Add|Sub|Mul|Div|Pow)"
    r"|ReplaceBinaryOperator_(FloorDiv_Div|Mod_Div|BitAnd_BitOr|BitOr_BitAnd)"
    r"|ReplaceComparisonOperator_(Eq|NotEq|Lt|LtE|Gt|GtE)_(Eq|NotEq|Lt|LtE|Gt|GtE)"
    r"|ReplaceComparisonOperator_(Is_IsNot|IsNot_Is)"
    r"|ReplaceUnaryOperator_(USub_UAdd|Delete_Not)"
    r"|AddNot|Replace(TrueWithFalse|FalseWithTrue|AndWithOr|OrWithAnd)"
    r"|Replace(BreakWithContinue|ContinueWithBreak)|NumberReplacer|ZeroIterationForLoop)"
)


@dataclass(frozen=True)
class Mutant:
    """One change of one line; `place` is where the change starts (line, column)."""

    file: str
    place: tuple[int, int]
    operator: str
    occurrence: int

    def code(self, source: str) -> str | None:
        """The changed module; None if it does not differ or is no Python."""
        line, column = self.place
        if re.match(r"\*\s*,", source.splitlines()[line - 1][column:]):
            return None  # the star of keyword-only arguments
        operator = cosmic_ray.plugins.get_operator(self.operator)()
        code = mutate_code(source, operator, self.occurrence)
        try:
            same = code is None or ast.dump(ast.parse(code)) == ast.dump(ast.parse(source))
        except SyntaxError:
            return None
        return None if same else code


def digest(*texts: bytes) -> str:
    """Short fingerprint of texts."""
    return hashlib.sha256(b"\0".join(texts)).hexdigest()[:16]


def words(source: str) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Spans that hold no physics: annotations, decorators, what an exception says."""
    nodes: list[Any] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Raise):
            nodes.append(node)
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            nodes += node.decorator_list
        nodes += [getattr(node, name, None) for name in ("annotation", "returns")]
    return [
        ((n.lineno, n.col_offset), (n.end_lineno, n.end_col_offset)) for n in nodes if n is not None
    ]


def mutants(file: str, source: str) -> Iterator[Mutant]:
    """Every mutant of a module, in cosmic-ray's order."""
    skipped = words(source)
    tree = get_ast(source)
    for name in filter(OPERATORS.fullmatch, cosmic_ray.plugins.operator_names()):
        operator = cosmic_ray.plugins.get_operator(name)()
        occurrence = -1
        for node in ast_nodes(tree):
            for start, _ in operator.mutation_positions(node):
                occurrence += 1
                if not any(a <= start < b for a, b in skipped):
                    yield Mutant(file, start, name, occurrence)


def sample(file: str, source: str, number: int | None, seed: int) -> Iterator[tuple[Mutant, str]]:
    """`number` places of a module, one mutant of each, with its code; None: all mutants."""
    places = defaultdict(list)
    for mutant in mutants(file, source):
        places[mutant.place].append(mutant)
    if number is None:
        every = [m for place in sorted(places) for m in places[place]]
        yield from ((m, code) for m in every if (code := m.code(source)) is not None)
        return
    draw = random.Random(f"{seed} {file}")
    drawn = 0
    for place in draw.sample(sorted(places), len(places)):
        for mutant in draw.sample(places[place], len(places[place])):
            if (code := mutant.code(source)) is not None:
                yield mutant, code
                drawn += 1
                break
        if drawn == number:
            return


class Worker:
    """The process that runs tests in the copy of the tree."""

    def __init__(self, tree: Path) -> None:
        self.process = subprocess.Popen(
            [ROOT / ".venv" / "bin" / "python", ROOT / "checks" / "mutant_worker.py"],
            cwd=tree, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            env={**os.environ, "PYTHONPATH": str(tree / "src"), "PYTHONDONTWRITEBYTECODE": "1",
                 "OPENBLAS_NUM_THREADS": "1"},
        )  # fmt: skip

    def ask(self, tests: list[str], timeout: float, cold: bool = False) -> dict[str, str]:
        """Outcome of some words for pytest."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(
            json.dumps({"tests": tests, "timeout": timeout, "cold": cold}) + "\n"
        )
        self.process.stdin.flush()
        answer: dict[str, str] = json.loads(self.process.stdout.readline())
        if answer["outcome"] == "broken":
            sys.exit("pytest itself failed; nothing is counted")
        return answer

    def stop(self) -> None:
        self.process.terminate()
        self.process.wait()


class Tests:
    """Which tests touch which line, and how long each takes; once per state of the tree."""

    def __init__(self, tree: Path, worker: Worker) -> None:
        self.tree = tree
        parts = [*TESTS, *(f"src/thermogear/{floor}" for floor in ("base", *FLOORS))]
        sources = sorted(path for part in parts for path in (tree / part).rglob("*.py"))
        stored = STORE / f"tests-{digest(*(p.read_bytes() for p in sources))}.json"
        if not stored.exists():
            self._measure(worker, stored)
        told = json.loads(stored.read_text(encoding="utf-8"))
        self.seconds: dict[str, float] = told["seconds"]
        self.lines: dict[str, dict[str, list[str]]] = told["lines"]
        files = {test.split("::")[0] for test in self.seconds}
        self.digests = {file: digest((tree / file).read_bytes()) for file in files}
        if worker.ask(["--collect-only", *self.seconds], 300.0)["outcome"] != "survived":
            sys.exit("the tests cannot be collected one by one without any mutant")

    def _measure(self, worker: Worker, stored: Path) -> None:
        print("which tests touch what: one run of the physics tests with coverage ...", flush=True)
        cover = "--cov --cov-context=test --cov-report=json:lines.json --cov-config=with.toml"
        words = f"{cover} --junitxml=times.xml -o junit_family=xunit1".split()
        (self.tree / "with.toml").write_text(
            '[tool.coverage]\nrun.source = ["thermogear"]\njson.show_contexts = true\n'
        )
        done = worker.ask([*words, *TESTS], 3600.0)
        if done["outcome"] != "survived":
            sys.exit(f"without any mutant the tests end as {done['outcome']} by {done['by']}")
        seconds = {
            node_id(case): float(case.get("time", 0))
            for case in ET.parse(self.tree / "times.xml").iter("testcase")
        }
        covered = json.loads((self.tree / "lines.json").read_text(encoding="utf-8"))["files"]
        lines = {
            file: {
                line: sorted({c.split("|")[0] for c in contexts if c})
                for line, contexts in found["contexts"].items()
            }
            for file, found in covered.items()
            if file.split("/")[2] in FLOORS
        }
        STORE.mkdir(exist_ok=True)
        stored.write_text(json.dumps({"seconds": seconds, "lines": lines}), encoding="utf-8")

    def _files(self, file: str, seen: frozenset[str] = frozenset()) -> set[str]:
        """Test files that run something of a module; of compiled code, of what imports it."""
        found = {t.split("::")[0] for tests in self.lines.get(file, {}).values() for t in tests}
        if compiled(self.tree / file):
            folder, leaf = Path(file).parent.name, Path(file).stem
            wanted = re.compile(rf"{folder}\.{leaf} import|{folder} import .*\b{leaf}\b")
            for other in self.lines:
                if other not in seen and wanted.search((self.tree / other).read_text("utf-8")):
                    found |= self._files(other, seen | {file})
        return found

    def of(self, mutant: Mutant) -> list[str]:
        """Tests that run the line, quickest first; then the rest of the files with the module."""
        direct = set(self.lines.get(mutant.file, {}).get(str(mutant.place[0]), []))
        files = self._files(mutant.file)
        others = {t for t in self.seconds if t.split("::")[0] in files} - direct
        return sorted(direct, key=self._time) + sorted(others, key=self._time)

    def limit(self, asked: list[str]) -> float:
        """Seconds after which a mutant counts as killed."""
        return 30.0 + 5.0 * sum(map(self._time, asked))

    def _time(self, test: str) -> float:
        return self.seconds.get(test, 1.0)


def node_id(case: ET.Element) -> str:
    """pytest's name of a test of its report."""
    file = case.get("file", "")
    group = case.get("classname", "").removeprefix(file.removesuffix(".py").replace("/", "."))
    return file + group.replace(".", "::") + "::" + case.get("name", "")


def compiled(path: Path) -> bool:
    """Whether numba compiles something of this module."""
    return "numba" in path.read_text(encoding="utf-8")


def key(mutant: Mutant, code: str) -> str:
    """Name of a mutant in the store; another state of its module is another name."""
    return f"{mutant.file}:{mutant.place[0]}:{digest(code.encode())}"


def still_true(verdict: dict[str, str], tests: Tests, asked: list[str]) -> bool:
    """A kill stands while its test file is unchanged; a survival while all its test files are."""
    by = verdict["by"].split("::")[0]
    return verdict["tests"] == (
        tests.digests.get(by, "gone") if by else digest(*(state(tests, asked)))
    )


def state(tests: Tests, asked: list[str]) -> list[bytes]:
    """Fingerprints of all test files of a list of tests."""
    return [tests.digests[f].encode() for f in sorted({t.split("::")[0] for t in asked})]


def change(source: str, code: str) -> tuple[str, str]:
    """The changed line before and after."""
    old, new = source.splitlines(), code.splitlines()
    told = difflib.SequenceMatcher(a=old, b=new, autojunk=False).get_opcodes()
    spans = [(old[a:b], new[c:d]) for tag, a, b, c, d in told if tag != "equal"]
    before, after = (" ".join(" ".join(lines).split()) for lines in spans[0])
    return before, after


def run(
    chosen: list[tuple[Mutant, str]], tests: Tests, worker: Worker | None
) -> Iterator[dict[str, Any]]:
    """A verdict for every mutant, from the store or from its tests; no worker: the known ones."""
    store = STORE / "verdicts.jsonl"
    kept: dict[str, dict[str, str]] = {}
    if store.exists():
        for line in store.read_text(encoding="utf-8").splitlines():
            kept.update(json.loads(line))
    for number, (mutant, code) in enumerate(chosen, 1):
        path = tests.tree / mutant.file
        source = path.read_text(encoding="utf-8")
        before, after = change(source, code)
        name, asked = key(mutant, code), tests.of(mutant)
        verdict = kept.get(name)
        if verdict is None or not still_true(verdict, tests, asked):
            if worker is None:
                continue
            verdict = {"outcome": "survived", "by": ""}
            if asked:
                stamp = path.stat()
                path.write_text(code, encoding="utf-8")
                try:
                    verdict = worker.ask(asked, tests.limit(asked), compiled(path))
                finally:
                    path.write_text(source, encoding="utf-8")
                    os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
            by = verdict["by"].split("::")[0]
            verdict["tests"] = tests.digests[by] if by else digest(*state(tests, asked))
            with store.open("a", encoding="utf-8") as out:
                out.write(json.dumps({name: verdict}) + "\n")
            place = f"{mutant.file}:{mutant.place[0]}"
            print(f"{number}/{len(chosen)} {verdict['outcome']:8} {place}  {before}  ->  {after}")
            sys.stdout.flush()
        yield {"file": mutant.file, "line": mutant.place[0], "before": before, "after": after,
               "outcome": verdict["outcome"]}  # fmt: skip


def main() -> int:
    """Draw, run, count; 130 after Ctrl+C, with what is done kept."""
    words_in = argparse.ArgumentParser(prog="make mutate")
    words_in.add_argument("--per-module", type=int, default=4, help="places drawn in every module")
    words_in.add_argument("--seed", type=int, default=1)
    words_in.add_argument("--all", action="store_true", help="every mutant of every place")
    words_in.add_argument("--only", default="", help="a floor, or a part of a file's path")
    given = words_in.parse_args()
    number = None if given.all else given.per_module
    name = "every mutant" if given.all else f"seed {given.seed}, {number} places per module"
    verdicts: list[dict[str, Any]] = []
    chosen: list[tuple[Mutant, str]] = []
    with tempfile.TemporaryDirectory(prefix="thermogear-mutants-") as folder:
        tree = Path(folder)
        for part in ("src", "tests"):
            shutil.copytree(ROOT / part, tree / part)
        for part in ("pyproject.toml", "README.md"):
            shutil.copy2(ROOT / part, tree / part)
        status, worker = 0, Worker(tree)
        try:
            tests = Tests(tree, worker)
            chosen = [
                drawn
                for floor in FLOORS
                for path in sorted((tree / "src" / "thermogear" / floor).rglob("*.py"))
                if given.only in str(path.relative_to(tree))
                for drawn in sample(
                    str(path.relative_to(tree)), path.read_text("utf-8"), number, given.seed
                )
            ]
            for verdict in run(chosen, tests, worker):
                verdicts.append(verdict)
        except KeyboardInterrupt:
            print("\nstopped; the same command goes on from here")
            verdicts = list(run(chosen, tests, None)) if chosen else []
            status = 130
        finally:
            worker.stop()
    if verdicts and not given.only:
        write(name, verdicts, len(chosen))
    print(*table(counted(verdicts)["floors"]), sep="\n")
    return status


if __name__ == "__main__":
    sys.exit(main())
