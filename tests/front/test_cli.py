"""The command line does what it says, leaves no traceback, and starts light."""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
import types
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

import pytest

import thermogear
from said import numbers
from thermogear.base.errors import ThermogearError
from thermogear.case.base import Case
from thermogear.case.case import load_case
from thermogear.case.examples import EXAMPLES, example_text
from thermogear.front import cli as command_line
from thermogear.front.cli import main
from thermogear.front.lines import one_line, system_error
from thermogear.front.progress import progress
from thermogear.mesh.model import MeshModel
from thermogear.results.files import MARK
from thermogear.results.result import Result

HEAVY = (
    "numpy",
    "scipy",
    "numba",
    "xarray",
    "h5py",
    "matplotlib",
    "pydantic",
    "pint",
    "rich",
    "jinja2",
)


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    path = tmp_path / "rig.toml"
    path.write_text(example_text("rig"), encoding="utf-8")
    return path


@pytest.fixture
def pretended(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """A run and a report that only note how they were called."""
    seen: dict[str, Any] = {}

    def study(case: Case, *, progress: Callable[[str, int, int], None]) -> Result:
        seen["case"] = case
        progress("mesh cycle", 1, 2)
        progress("mesh cycle", 2, 2)
        if "effect" in seen:
            raise seen["effect"]
        seen["result"] = Result.of("gear", case.title, {}, **case.provenance)
        return seen["result"]

    def page_of(result: Result) -> Any:
        page = types.SimpleNamespace(
            result=result, lines=lambda: ["- two lines"], figures={"kind": "0"}
        )
        page.showing = lambda which, every: page
        return page

    def write(page: Any, folder: Path, *, tables: bool) -> list[Path]:
        assert (folder / "results.nc").is_file()
        seen["reported"] = folder
        seen["tables"] = tables
        return [folder / "report.html"]

    def clear_tables(directory: Path, kept: list[Path]) -> None:
        seen["directory"] = directory

    def write_report(directory: Path, of: str, *, hidden: Collection[str]) -> Path:
        seen["reported"] = directory
        return directory / "report.html"

    def write_tables(page: Any, directory: Path) -> list[Path]:
        return [directory / "csv" / name for name in ("one.csv", "two.csv")]

    made = {
        "thermogear.study.run": {"run": study},
        "thermogear.thesis.errata": {"with_errata": lambda result, case: result},
        "thermogear.views.write": {
            "page_of": page_of, "write": write, "clear_tables": clear_tables,
            "write_report": write_report, "write_pictures": None, "write_tables": write_tables,
        },
    }  # fmt: skip
    for name, functions in made.items():
        module = types.ModuleType(name)
        vars(module).update(functions)
        monkeypatch.setitem(sys.modules, name, module)
    return seen


def started(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "thermogear", *arguments],
        capture_output=True,
        text=True,
        check=False,
        **options,
    )


# --- light ------------------------------------------------------------------------------
def test_checking_a_case_loads_nothing_that_only_a_run_uses() -> None:
    code = (
        "import sys\n"
        "from thermogear.front.cli import main\n"
        "assert main(['check', 'rig']) == 0\n"
        "heavy = ('scipy', 'xarray', 'pandas', 'numba', 'pint', 'jinja2', 'matplotlib')\n"
        "print([m for m in heavy if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"


@pytest.mark.parametrize("study", ["answers.survey", "run"])
def test_before_the_first_computation_numba_alone_is_heavy(study: str) -> None:
    code = (
        "import importlib, sys\n"
        "import thermogear.front.cli, thermogear.front.progress, thermogear.results.files\n"
        "from thermogear.case.case import load_case\n"
        "load_case('rig')\n"
        f"importlib.import_module('thermogear.study.{study}')\n"
        # nor do the teeth, the flash and the convection of a pair load scipy's solvers
        "from thermogear.gears.geometry import Gear\n"
        "from thermogear.gears.tooth import start_angle\n"
        "from thermogear.heat.convection import rotating_disc_flow\n"
        "from thermogear.heat.moving_source import peclet_factor\n"
        "start_angle(Gear(20, 4e-3), '30-degree'), rotating_disc_flow(), peclet_factor(1.0)\n"
        "heavy = ('scipy.linalg', 'scipy.optimize', 'scipy.integrate', 'scipy.interpolate',"
        " 'scipy.special', 'xarray', 'pint', 'jinja2', 'h5py')\n"
        "print([m for m in heavy if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["--version"], ["example"]])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    code = (
        "import sys\n"
        "from thermogear.front.cli import main\n"
        f"assert main({arguments!r}) == 0\n"
        f"print([m for m in {HEAVY!r} if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"
    assert done.stdout.strip()


def test_the_help_lists_every_command_once_in_whole_sentences(
    capsys: pytest.CaptureFixture[str],
) -> None:
    listed = [name for rows in command_line.GROUPS.values() for name in rows]
    assert sorted(listed) == sorted(command_line.cli.commands)
    assert main(["--help"]) == 0
    shown = capsys.readouterr().out.splitlines()
    titles = [shown.index(f"{title}:") for title in command_line.GROUPS]
    assert titles == sorted(titles)
    wide = max(map(len, listed))
    for rows in command_line.GROUPS.values():
        for name, words in rows.items():
            assert f"  {name:<{wide}}  {words}" in shown  # not cut off, not broken
            assert words.endswith(".")
            assert words.count(".") == 1
    assert max(map(len, shown)) <= 80


# --- as a program -------------------------------------------------------------------------
def test_module_and_errors_as_a_program(tmp_path: Path) -> None:
    version = started("--version")
    assert (version.returncode, version.stdout) == (0, f"thermogear {thermogear.__version__}\n")
    wrong = started("check", str(tmp_path / "none.toml"))
    assert wrong.returncode == 2
    assert wrong.stdout == ""
    assert wrong.stderr == (
        "error: none.toml: got no such file; `thermogear example rig -o rig.toml` writes one\n"
    )


def test_a_reader_that_leaves_is_no_error() -> None:
    code = "import sys; from thermogear.front.cli import main; sys.exit(main(['schema']))"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as program:
        assert program.stdout is not None
        assert program.stderr is not None
        program.stdout.close()
        assert program.stderr.read() == b""
        assert program.wait() == 1


# --- commands -----------------------------------------------------------------------------
def test_no_command_shows_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    assert re.search(r"\bthermogear new\b", capsys.readouterr().out)


@pytest.mark.parametrize("name", EXAMPLES)
def test_example_prints_the_file_as_it_is(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["example", name]) == 0
    assert capsys.readouterr().out == example_text(name)


@pytest.mark.parametrize("name", EXAMPLES)
def test_example_writes_the_file_as_it_is(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    assert main(["example", name, "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}\n"
    assert path.read_bytes() == example_text(name).encode("utf-8")
    assert b"\r" not in path.read_bytes()
    assert main(["check", str(path)]) == 0


def test_schema_writes_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.schema.json"
    assert main(["schema", "-o", str(path)]) == 0
    assert "$defs" in json.loads(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("mine.toml", "output: got {path}; it is there already; name a new file"),
        ("", "output: got {path}; it is a directory; name a file in it"),
        ("none/mine.toml", "output: got {path}; there is no directory {folder}"),
    ],
)
def test_example_never_overwrites(
    place: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.toml").write_text("mine")
    path = tmp_path / place
    assert main(["example", "rig", "-o", str(path)]) == 2
    said = capsys.readouterr().err
    assert said == f"error: {message.format(path=path, folder=path.parent)}\n"
    assert (tmp_path / "mine.toml").read_text() == "mine"


def test_example_needs_a_name_to_write(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["example", "-o", "mine.toml"]) == 2
    assert capsys.readouterr().err == (
        f"error: -o needs the NAME of a case: {' | '.join(EXAMPLES)}\n"
    )


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_a_case_is_read_as_windows_writes_it(encoding: str, tmp_path: Path) -> None:
    """PowerShell 5.1's ``>``: UTF-16 with its mark, lines that end with CR LF."""
    text = example_text("rig").replace('title = "', 'title = "Prüfstand µ ').replace("\n", "\r\n")
    mark = "\ufeff" if encoding.endswith(("le", "be")) else ""
    path = tmp_path / "rig.toml"
    path.write_bytes((mark + text).encode(encoding))
    assert load_case(path).title.startswith("Prüfstand µ ")


def test_example_without_a_name_lists_them(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["example"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(EXAMPLES)


def test_schema_is_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert set(schema) >= {"$schema", "$defs", "anyOf", "title"}


def test_check_prints_the_numbers_of_the_case(
    rig: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", str(rig)]) == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    for line in ("contact ratio                          1.714426", "1.227327 kg", "416.6667 Hz"):
        assert line in shown.out


def test_check_as_json(rig: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(rig), "--json", "--set", "gears.pinion.face_width=30 mm"]) == 0
    shown = json.loads(capsys.readouterr().out)
    facts = {f["name"]: f["value"] for f in shown["facts"]}
    assert facts["centre distance"] == pytest.approx(250.0)
    fields = {a["field"] for a in shown["assumptions"]}
    assert "gears.wheel.face_width" in fields
    assert "gears.pinion.face_width" not in fields


def test_warnings_are_lines_said_once(rig: Path, capsys: pytest.CaptureFixture[str]) -> None:
    change = "temperatures.pinion_addendum=190 degC"
    assert main(["check", str(rig), "--set", change]) == 0
    assert capsys.readouterr().err == (
        "warning: temperatures.pinion_addendum: got 190 degC; valid -60..180 degC; "
        "above the tempering temperature of steel\n"
    )


def test_run_hands_case_and_directory_on(
    rig: Path, tmp_path: Path, pretended: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    results = tmp_path / "results"
    assert main(["run", str(rig), "-o", str(results), "--set", "operating.torque=150 N m"]) == 0
    shown = capsys.readouterr()
    assert shown.out == f"- two lines\n{results / 'report.html'}\n"
    assert shown.err == ""
    assert pretended["case"].torques == (150.0,)
    assert pretended["directory"] == results
    assert pretended["reported"] != results
    assert pretended["result"].text("case") == example_text("rig")
    assert pretended["result"].values("overrides") == [["operating.torque", "150 N m"]]


def test_run_without_overrides_hands_the_text_on_as_it_is(
    rig: Path, tmp_path: Path, pretended: dict[str, Any]
) -> None:
    assert main(["run", str(rig), "-o", str(tmp_path / "results")]) == 0
    assert pretended["result"].text("case") == example_text("rig")
    assert pretended["result"].values("overrides") == []
    assert not pretended["tables"]
    assert main(["run", str(rig), "-o", str(tmp_path / "results"), "--curves"]) == 0
    assert pretended["tables"]


def test_run_for_scripts_prints_json_alone(
    rig: Path, tmp_path: Path, pretended: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", str(rig), "-o", str(tmp_path / "results"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["kind"] == "0"
    assert pretended["directory"] == tmp_path / "results"


def test_results_of_ours_are_written_over(
    rig: Path, tmp_path: Path, pretended: dict[str, Any]
) -> None:
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / MARK).write_text("results of thermogear\n", encoding="utf-8")
    assert main(["run", str(rig), "-o", str(tmp_path / "results")]) == 0
    assert "reported" in pretended


def test_a_case_too_large_needs_force(
    rig: Path,
    tmp_path: Path,
    pretended: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("thermogear.case.size.free_bytes", lambda: 2**20)
    results = tmp_path / "results"
    assert main(["run", str(rig), "-o", str(results)]) == 2
    assert "70 % of the free memory" in capsys.readouterr().err
    assert not results.exists()
    assert main(["run", str(rig), "-o", str(results), "--force"]) == 0
    assert pretended["directory"] == results


@pytest.mark.parametrize(
    ("effect", "code", "line"),
    [
        (
            KeyboardInterrupt("nothing was written to results"),
            130,
            "interrupted: stopped on request; nothing was written to results\n",
        ),
        (ThermogearError("it did not\nsettle"), 2, "error: it did not settle\n"),
        (
            PermissionError(13, "Permission denied", "results.nc"),
            2,
            "error: results.nc: Permission denied\n",
        ),
        (
            OSError(28, "No space left on device", "results"),
            2,
            "error: results: No space left on device; make room there and give the same command "
            "again\n",
        ),
        (MemoryError(), 2, "error: MemoryError: the case is too large for this machine\n"),
    ],
)
def test_what_stops_a_run_is_one_line(
    effect: BaseException,
    code: int,
    line: str,
    rig: Path,
    tmp_path: Path,
    pretended: dict[str, Any],
    capsys: pytest.CaptureFixture[str],
) -> None:
    pretended["effect"] = effect
    assert main(["run", str(rig), "-o", str(tmp_path / "results")]) == code
    shown = capsys.readouterr()
    assert shown.err == line
    assert shown.out == ""


def test_a_defect_of_the_program_is_not_hidden(
    rig: Path, tmp_path: Path, pretended: dict[str, Any]
) -> None:
    pretended["effect"] = ZeroDivisionError()
    with pytest.raises(ZeroDivisionError):
        main(["run", str(rig), "-o", str(tmp_path / "results")])


def test_report_draws_the_page_anew(
    tmp_path: Path,
    pretended: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("thermogear.results.result.open_results", lambda place, of: place)
    assert main(["report", str(tmp_path), "--curves"]) == 0
    assert pretended["reported"] == tmp_path
    assert capsys.readouterr().out == f"{tmp_path / 'report.html'}\n{tmp_path / 'csv'}\n"


def test_arguments_come_from_the_program_when_not_given(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(command_line.sys, "argv", ["thermogear", "--version"])
    assert main() == 0
    assert capsys.readouterr().out == f"thermogear {thermogear.__version__}\n"


# --- lines and progress -----------------------------------------------------------------
def test_control_characters_never_reach_the_terminal() -> None:
    assert one_line("a\x1b[31m\r\nb\tc") == "a?[31m b c"
    assert system_error(OSError("odd")) == "odd"


def test_progress_is_silent_where_nobody_watches(capsys: pytest.CaptureFixture[str]) -> None:
    with progress() as report:
        report("mesh cycle", 1, 2)
    assert capsys.readouterr().err == ""


def test_progress_draws_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress() as report:
        report("mesh cycle", 1, 2)
        report("mesh cycle", 2, 2)
        report("motion", 1, 1)
    assert all(part in terminal.getvalue() for part in ("mesh", "cycle", "motion"))


SHORT = """
[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 40
bore_radius = "20 mm"
[operating]
speed = "3000 rpm"
torque = "80 N m"
"""


def test_check_lists_the_defaults_of_a_short_case(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "short.toml"
    path.write_text(SHORT, encoding="utf-8")
    assert main(["check", str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    heads = [line.split(",")[0] for line in lines if line.endswith("left to defaults")]
    assert heads == ["gears", "oil", "heat", "backlash", "flanks", "motion", "model"]
    assert sum("um" in line and "f_Halpha" in line for line in lines) == 4
    told = {line.split()[0]: line for line in lines if line.startswith("  ") and ":" in line}
    assert numbers(told["backlash.value"])[0] == 0.13
    assert numbers(told["gears.pinion.bore_radius"])[:2] == [7.875, 0.3]
    assert numbers(told["gears.roughness"])[0] == 0.4
    assert not any(line.strip().startswith("gears.wheel.bore_radius") for line in lines)
    assert not any(line.strip().startswith(("grid.", "simulation.")) for line in lines)
    assert [10.0] in [numbers(line) for line in lines if line.startswith("numerics:")]
    assert numbers(lines[-1])[0] == 70.0
    choices = [line.split()[0] for line in lines if line.startswith("  model.")]
    assert choices == [f"model.{name}" for name in ("bundle", *MeshModel.consistent().choices())]
    assert told["model.tooth"].split()[1] == "solved:"
    assert numbers(told["model.tooth"]) == [5.0]


def test_what_a_case_states_is_no_default(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "short.toml"
    path.write_text(SHORT + '[oil]\nname = "ISO VG 220"\n[flanks]\naccuracy = 5\n', "utf-8")
    assert main(["check", str(path)]) == 0
    shown = capsys.readouterr().out
    assert not any(line.startswith("oil,") for line in shown.splitlines())
    assert "flanks.accuracy" not in shown
    assert "flanks.seed" in shown


def test_check_of_a_case_with_every_value_declared_lists_no_default(
    rig: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", str(rig)]) == 0
    shown = capsys.readouterr().out
    assert "default" not in shown
    assert numbers(shown.splitlines()[-1])[0] == 63.0
