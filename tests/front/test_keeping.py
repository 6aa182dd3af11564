"""What commands leave behind: whole results or the old ones, and words that are true."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from thermogear.base.files import SCHEMA, held
from thermogear.base.netcdf import write_tree
from thermogear.front.cli import main
from thermogear.results.files import MARK
from thermogear.results.result import Result, result_of
from thermogear.results.work import Step
from thermogear.study import run as running
from thermogear.views.page import Page

TREE = xr.DataTree.from_dict({"points": xr.Dataset({"x": ("point", np.arange(3.0))})})
TREE.attrs = {"thermogear": "0.0.0", "kind": "dimensionless", "title": "Rows", "notices": "[]"}


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """A run without its computing and its page; ``effect`` is raised while the page is drawn."""
    seen: dict[str, Any] = {}

    def render(page: Any) -> str:
        if "effect" in seen:
            raise seen["effect"]
        return "page"

    def page_of(result: Result) -> Page:
        return Page(result, "", [], numbers=lambda: {"thermogear": "0"})

    monkeypatch.setattr(running, "run", lambda case, progress: result_of(TREE))
    monkeypatch.setattr("thermogear.views.write.page_of", page_of)
    monkeypatch.setattr("thermogear.views.write.render", render)
    return seen


def content(directory: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(directory)): path.read_bytes()
        for path in sorted(directory.rglob("*"))
        if path.is_file()
    }


def test_a_run_that_cannot_end_leaves_what_was_there(
    tmp_path: Path, quick: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    for before in ({MARK, "lock"}, None):
        for effect, code, line in (
            (OSError(28, "No space left on device", "x"), 2, "error: x: No space left on device; "
             "make room there and give the same command again\n"),
            (KeyboardInterrupt(), 130,
             f"interrupted: stopped on request; nothing was written to {out}\n"),
        ):  # fmt: skip
            old = content(out)
            quick["effect"] = effect
            assert main(["run", "table-4.2", "-o", str(out)]) == code
            assert capsys.readouterr().err == line
            assert content(out) == old or set(content(out)) == before
        del quick["effect"]
        assert main(["run", "table-4.2", "-o", str(out)]) == 0
        capsys.readouterr()
    assert {"results.nc", "results.nc.sha256", "summary.json", "report.html"} < set(content(out))


@pytest.mark.usefixtures("quick")
def test_two_runs_do_not_write_into_one_directory(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "table-4.2", "-o", str(tmp_path)]) == 0
    capsys.readouterr()
    with held(tmp_path):
        assert main(["run", "table-4.2", "-o", str(tmp_path)]) == 2
    assert capsys.readouterr().err == (
        f"error: output: got {tmp_path}; another process is writing into it; wait for it, or name "
        "another directory\n"
    )


@pytest.mark.parametrize("command", [["measure", "none.csv"], ["compare", "thesis-5.2"],
                                     ["orbit", "table-4.2"]])  # fmt: skip
def test_foreign_directories_are_refused_before_anything_is_read(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """``measured.nc`` and ``orbit.nc`` of somebody else were written over."""
    mine = tmp_path / "mine.nc"
    mine.write_text("mine")
    (tmp_path / "out").mkdir()
    for name in ("measured.nc", "comparison.nc", "orbit.nc"):
        (tmp_path / "out" / name).symlink_to(mine)
    assert main([*command, "-o", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err == (
        f"error: output: got {tmp_path / 'out'}; the directory holds files that are not results of "
        "thermogear; name a new or an empty directory\n"
    )
    assert mine.read_text() == "mine"


def test_compare_replaces_links_in_its_own_directory(tmp_path: Path) -> None:
    out, mine = tmp_path / "out", tmp_path / "mine.nc"
    mine.write_text("mine")
    assert main(["compare", "thesis-5.2", "-o", str(out)]) == 0
    (out / "comparison.nc").unlink()
    (out / "comparison.nc").symlink_to(mine)
    assert main(["compare", "thesis-5.2", "-o", str(out)]) == 0
    assert mine.read_text() == "mine"
    assert not (out / "comparison.nc").is_symlink()


def test_damaged_results_are_not_compared(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_tree(TREE, tmp_path / "results.nc")
    raw = bytearray(path.read_bytes())
    raw[-1] ^= 1
    path.write_bytes(raw)
    for command in (["compare", str(tmp_path), "thesis-5.2"], ["report", str(tmp_path)]):
        assert main(command) == 2
        said = capsys.readouterr().err
        assert said.startswith(f"error: results: got {path}; it is not the file that ")
        assert said.count("\n") == 1


def test_a_stopped_sweep_says_what_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from thermogear.results import work

    def carry_out(plan: object, store: Path, *, report: Any, **options: object) -> None:
        report(Step(done=2, total=7, found=0, elapsed=1.0, remaining=2.0))
        raise KeyboardInterrupt

    monkeypatch.setattr(work, "carry_out", carry_out)
    arguments = ["map", "table-4.2", "--over", "omega=1:1.1:3", "--over", "zeta=0.1:0.2:3"]
    assert main([*arguments, "-o", str(tmp_path)]) == 130
    assert capsys.readouterr().err == (
        f"interrupted: stopped on request; 2 of 7 chunks stay in {tmp_path}, the same command "
        "goes on from there\n"
    )


def test_the_summary_is_of_the_results_beside_it(tmp_path: Path, quick: dict[str, Any]) -> None:
    """A page that cannot be drawn keeps the new numbers from standing beside the old page."""
    assert main(["run", "table-4.2", "-o", str(tmp_path)]) == 0
    old = content(tmp_path)
    quick["effect"] = ValueError("a defect")
    with pytest.raises(ValueError, match="a defect"):
        main(["run", "table-4.2", "-o", str(tmp_path)])
    assert content(tmp_path) == old
    assert json.loads((tmp_path / "summary.json").read_text()) == {
        "schema": SCHEMA,
        "thermogear": "0",
        "title": "Rows",
        "kind": "dimensionless",
        "notices": [],
    }
