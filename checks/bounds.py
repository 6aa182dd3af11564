"""Do the declared bounds of the dependencies hold? The demo and the quick tests at both ends.

``make lowest`` installs the package with all its extras twice, each in an environment of its own
below .bounds-venv: every direct dependency at its declared minimum, and the newest that the
declaration allows. In both it runs a case from its file to a report and quick
tests of each floor, and writes checks/records/bounds.md. ``python checks/bounds.py 3.12 3.13``
tries these versions of Python with the newest libraries instead, and prints the table.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
PLACE = ROOT / ".bounds-venv"
PAGE = ROOT / "checks" / "records" / "bounds.md"
UV = ROOT / ".venv" / "bin" / "uv"
EXTRAS = ("measure", "sensitivity", "app", "cad")
TOOLS = ("pytest", "pytest-xdist", "hypothesis", "axe-core-python")
"""What the tests need beside the package; always the newest, no bound of ours."""
QUICK = (
    "tests/base",
    "tests/case/test_case.py",
    "tests/case/test_charts.py",
    "tests/case/test_duty.py",
    "tests/case/test_rexs.py",
    "tests/gears/test_loaded.py",
    "tests/heat/test_heat_units.py",
    "tests/mesh/test_mesh_nan.py",
    "tests/dynamics/test_exact.py",
    "tests/analysis/test_labels.py",
    "tests/signals",
    "tests/measured/test_readers.py",
    "tests/measured/test_foreign_formats.py",
    "tests/shafts/test_bearings.py",
    "tests/results/test_store.py",
    "tests/results/test_workers.py",
    "tests/study/test_sensitivity.py",
    "tests/study/test_warm_up_study.py",
    "tests/views/test_netcdf.py",
    "tests/views/test_report.py",
    "tests/front/test_cli.py",
    "tests/front/test_draw_command.py",
    "tests/front/test_measure_commands.py",
    "tests/front/app/test_security.py",
)
"""Tests of each floor; those that are slow are left out."""
TEST = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-n", "2", "--dist", "loadfile")


@dataclass(frozen=True)
class Tried:
    """One environment: its name, versions by package, how the demo and the tests ended."""

    name: str
    versions: dict[str, str]
    demo: str
    tests: str
    failed: list[str]


def declared() -> list[str]:
    """Names of the direct dependencies, as written, extras included."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    lines = [*project["dependencies"]]
    for extra in EXTRAS:
        lines += project["optional-dependencies"][extra]
    return [re.split(r"[<>=!~ ]", line)[0] for line in lines]


def run(*words: str | Path, place: Path = ROOT, venv: Path | None = None) -> tuple[int, str]:
    """Exit code and output of a command, without this checkout on Python's path."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    if venv is not None:
        environment["VIRTUAL_ENV"] = str(venv)
    done = subprocess.run(
        [str(word) for word in words],
        cwd=place, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    return done.returncode, done.stdout


def tried(name: str, resolution: str, python: str = "") -> Tried:
    """The package in an environment of its own, the demo and the quick tests in it."""
    venv = PLACE / name
    run(UV, "venv", "-q", "--clear", *(["--python", python] if python else []), venv)
    package = f"{ROOT}[{','.join(EXTRAS)}]"
    for words in (["--resolution", resolution, "-e", package], TOOLS):
        code, output = run(UV, "pip", "install", "-q", *words, venv=venv)
        if code:
            return Tried(name, {}, output.strip().splitlines()[0], "not begun", [])
    _, listed = run(UV, "pip", "list", "--format", "freeze", venv=venv)
    versions = dict(line.lower().split("==") for line in listed.splitlines() if "==" in line)
    scripts = venv / "bin"
    (PLACE / "rig.toml").write_text(run(scripts / "thermogear", "example", "rig")[1], "utf-8")
    code, output = run(scripts / "thermogear", "run", PLACE / "rig.toml", "-o", venv / "demo")
    demo = "passed" if code == 0 else output.strip().splitlines()[-1]
    code, output = run(scripts / "python", *TEST, "-m", "not slow", *QUICK)
    summary = output.strip().splitlines()[-1].strip("= ")
    failed = [line.split(" ")[1] for line in output.splitlines() if line.startswith("FAILED")]
    return Tried(name, versions, demo, summary, failed)


def table(every: list[Tried]) -> list[str]:
    """The page's rows: each environment, then the versions of each direct dependency."""
    lines = ["| | demo | quick tests |", "|---|---|---|"]
    lines += [f"| {one.name} | {one.demo} | {one.tests} |" for one in every]
    lines += ["", "| package | " + " | ".join(one.name for one in every) + " |"]
    lines += ["|---|" + "---|" * len(every)]
    for package in declared():
        versions = [one.versions.get(package.lower(), "–") for one in every]
        lines.append(f"| {package} | " + " | ".join(versions) + " |")
    for one in every:
        lines += ["", f"Failed with {one.name}:", ""] if one.failed else []
        lines += [f"- `{test}`" for test in one.failed]
    return lines


def main(pythons: list[str]) -> int:
    """Print the table; write the page where both ends of the bounds were tried."""
    if pythons:
        every = [tried(f"Python {version}", "highest", version) for version in pythons]
    else:
        every = [tried("lowest", "lowest-direct"), tried("newest", "highest")]
    rows = table(every)
    print("\n".join(rows))
    if not pythons:
        head = ["# Declared bounds", ""]
        head += ["Made by `make lowest`: every direct dependency at its declared minimum, and the"]
        head += ["newest that the declaration allows, with all extras, on Linux.", ""]
        PAGE.write_text("\n".join([*head, *rows, ""]), "utf-8")
    return int(any(one.failed or one.demo != "passed" for one in every))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
